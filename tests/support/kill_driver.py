"""Replace a FOLD, an SVG and a DXF file by the command line, again and again, and be killed; print what is left.

``python -m support.kill_driver KILLS [careless|whole]`` in an empty folder. Patterns are folded once; a forked child
then runs ``foldcut make --force`` with them in turns, until SIGTERM or SIGKILL ends it at a random moment.
``careless`` writes the files in place, in two halves, to show that torn files are found. ``whole``: every run reads,
searches and writes, and is killed at a moment within the time that one takes, ``run_s``.
"""

from __future__ import annotations

import json
import os
import random
import signal
import sys
import time
from collections.abc import Mapping
from functools import partial
from itertools import cycle
from pathlib import Path

import ezdxf

from foldcut import pipeline
from foldcut.cli import main as cli
from foldcut.foldfile.read import read_fold
from foldcut.output import atomic as files
from support.patterns import square_out_of_square

SIZES = ("60x60", "64x64")
OUTPUTS = [Path("box.fold"), Path("box.svg"), Path("box.dxf")]
COMMAND = ["make", "box.json", "--profile", "laser-dxf", "--force", "--quiet"]
LONGEST_S = 0.15


def write_carelessly(contents: Mapping[Path, bytes], *, replace: bool, inputs: object) -> None:
    """Write in place, half of each file first."""
    for path, data in contents.items():
        with path.open("wb", buffering=0) as file:
            file.write(data[: len(data) // 2])
            time.sleep(0.005)
            file.write(data[len(data) // 2 :])


def main(kills: int, mode: str) -> None:
    loop = square_out_of_square().shape.loops[0]
    Path("box.json").write_text(json.dumps({"loops": [loop.tolist()]}))
    fold = partial(pipeline.fold, method="compact", effort="fast")
    made = {size: fold("box.json", size) for size in SIZES} if mode != "whole" else {}
    versions: dict[Path, list[bytes]] = {path: [] for path in OUTPUTS}

    def run(size: str) -> int:
        if mode != "whole":
            pipeline.fold = lambda *_, **__: made[size]  # type: ignore[assignment]
        return cli.main(
            [*COMMAND, "--sheet", size, "--method", "compact", "--effort", "fast", *(f"-o{path}" for path in OUTPUTS)]
        )

    longest_s = LONGEST_S
    for size in SIZES:
        started = time.monotonic()
        assert run(size) == 0
        longest_s = time.monotonic() - started if mode == "whole" else LONGEST_S
        for path in OUTPUTS:
            versions[path].append(path.read_bytes())
    if mode == "careless":
        files.write_files = write_carelessly  # type: ignore[assignment]

    chance = random.Random(6)
    torn, statuses, left, seen = [], [], [], set()
    for kill in range(kills):
        number = signal.SIGKILL if kill % 2 else signal.SIGTERM
        child = os.fork()
        if child == 0:
            for size in cycle(SIZES if kill % 4 < 2 else SIZES[::-1]):
                status = run(size)
                if status:
                    os._exit(status)
        time.sleep(chance.uniform(0, 1.3 * longest_s if mode == "whole" else longest_s))
        os.kill(child, number)
        code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        statuses.append([number.name, code])
        for path in OUTPUTS:
            data = path.read_bytes()
            if data in versions[path]:
                seen.add((path.name, versions[path].index(data)))
            else:
                torn.append(path.name)
        hidden = [path for path in Path().iterdir() if path.name.startswith(".")]
        left += [[number.name, path.name] for path in hidden]
        for path in hidden:
            path.unlink()
    if not torn:
        read_fold("box.fold")
        ezdxf.readfile("box.dxf")
    print(json.dumps({"torn": torn, "statuses": statuses, "left": left, "seen": sorted(seen), "run_s": longest_s}))


if __name__ == "__main__":
    main(int(sys.argv[1]), "".join(sys.argv[2:]))
