"""How soon the page of ``foldcut serve`` has a first pattern for drawings of 20 corners, in seconds of its worker.

``python tests/bench/live.py``: each of ``COUNT`` random drawings is folded by the command that the server runs for a
quick look, and ended when its first verified pattern is written. Seconds are of the processor, with start-up and
imports; Linux only.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

COUNT = 20
CORNERS = 20
TICKS = os.sysconf("SC_CLK_TCK")
WITHIN_S = 60.0
"""A drawing without a pattern after so many seconds of the clock counts as infinite."""


def drawing(seed: int) -> list[list[float]]:
    """Return a random polygon whose corners lie around one point, each between 40 and 80 mm away."""
    rng = np.random.default_rng(seed)
    angles = np.linspace(0, 2 * np.pi, CORNERS, endpoint=False) + rng.uniform(-0.1, 0.1, CORNERS)
    far = rng.uniform(40, 80, CORNERS)
    points: list[list[float]] = (far[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])).round(2).tolist()
    return points


def spent(pid: int) -> float:
    """Return the processor seconds of a process and of the children that it has waited for."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return sum(map(int, fields[11:15])) / TICKS


def first_pattern(points: list[list[float]], folder: Path) -> tuple[float, int]:
    """Return the seconds until the first pattern, and its folds; infinite and 0 where there is none."""
    (folder / "d.json").write_text(json.dumps({"loops": [points], "units": "mm"}))
    command = [sys.executable, "-m", "foldcut.cli", "make", "d.json", "--sheet=a4", "--effort=fast", "--progress"]
    command += ["--so-far=so-far.html", "-o=d.html", "-o=d.fold", "--force", f"--timeout={WITHIN_S:g}"]
    with subprocess.Popen(command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as process:
        assert process.stderr is not None
        for line in process.stderr:
            told = json.loads(line) if line.startswith("{") else {}
            if "pattern" in told:
                seconds = spent(process.pid)
                process.kill()
                return seconds, told["pattern"]["folds"]
    return float("inf"), 0


def main() -> None:
    """Print a table, the median and the 95th percentile."""
    print(
        f"load {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores\n\n"
        "| drawing | processor s | folds |\n| --- | --- | --- |"
    )
    seconds = []
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(COUNT):
            took, folds = first_pattern(drawing(seed), Path(folder))
            seconds.append(took)
            print(f"| {seed} | {took:.2f} | {folds} |", flush=True)
    low, high = np.percentile(seconds, [50, 95], method="inverted_cdf")
    print(f"\nmedian {low:.2f} s, 95 of 100 within {high:.2f} s")


if __name__ == "__main__":
    main()
