"""What the command line imports and how long it takes: a Markdown table of packages, from ``python -X importtime``.

``python tests/bench/start.py``: seconds of ``foldcut --help`` and of ``foldcut make star``, the least of ``RUNS``, in
processor time and on the clock, and milliseconds that each package's own modules take to import in the second.
Modules are compiled once, as they are for everybody, also where ``PYTHONDONTWRITEBYTECODE`` is set.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

RUNS = 7
ENVIRONMENT = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
COMMANDS = {
    "foldcut --help": ["--help"],
    "foldcut make star.svg -o star.dxf --profile laser-dxf --effort fast": [
        "make",
        str(Path(__file__).parents[2] / "samples" / "star.svg"),
        *("-o", "star.dxf", "--profile", "laser-dxf", "--effort", "fast", "--force"),
    ],
}


def run(arguments: list[str], *options: str) -> tuple[float, float, str]:
    """Return the processor seconds and the seconds of a command, and what it printed on standard error."""
    with tempfile.TemporaryDirectory() as folder:
        before, started = os.times(), time.perf_counter()
        done = subprocess.run(
            [sys.executable, *options, "-m", "foldcut.cli", *arguments],
            cwd=folder,
            env=ENVIRONMENT,
            capture_output=True,
            text=True,
            check=True,
        )
        wall, after = time.perf_counter() - started, os.times()
    spent = after.children_user + after.children_system - before.children_user - before.children_system
    return spent, wall, done.stderr


def import_times(printed: str) -> Counter[str]:
    """Return the microseconds that the modules of each package take themselves."""
    spent: Counter[str] = Counter()
    for own, name in re.findall(r"import time:\s+(\d+) \|\s+\d+ \|\s+([\w.]+)", printed):
        package = name.partition(".")[0]
        spent["Python's own" if package.lstrip("_") in sys.stdlib_module_names else package] += int(own)
        spent["all"] += int(own)
    return spent


def main() -> None:
    print(f"load {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores\n")
    print("| command | processor s | wall s | modules |\n| --- | --- | --- | --- |")
    for text, arguments in COMMANDS.items():
        runs = [run(arguments) for _ in range(RUNS)]
        modules = len(re.findall("^import time: +[0-9]", run(arguments, "-X", "importtime")[2], re.MULTILINE))
        print(f"| `{text}` | {min(r[0] for r in runs):.2f} | {min(r[1] for r in runs):.2f} | {modules} |")
    samples = [import_times(run(arguments, "-X", "importtime")[2]) for _ in range(RUNS)]
    least = {name: min(sample[name] for sample in samples) for name in samples[0]}
    print("\n| package | ms |\n| --- | --- |")
    for name, spent in sorted(least.items(), key=lambda row: -row[1]):
        if spent >= 1000:
            print(f"| {name} | {spent / 1000:.0f} |")


if __name__ == "__main__":
    main()
