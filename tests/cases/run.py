"""Run every case through the command line, in one process: ``python -m cases.run`` in an empty folder prints JSON."""

from __future__ import annotations

import contextlib
import io
import json
import os
import time
import traceback

from support.measured import peak_bytes

from cases.table import CASES
from foldcut.cli.main import main


def arguments(name: str) -> list[str]:
    """Return the command for a file."""
    if name.endswith(".fold"):
        return ["check", name]
    return ["make", name, "--effort", "fast", "--min-crease", "0mm", "--sheet", "200x200", "-o", "out.fold"]


def run() -> None:
    status: int | str
    found = {}
    for name, case in CASES.items():
        with open(name, "wb") as file:
            file.write(case.data)
        out, error, started = io.StringIO(), io.StringIO(), time.process_time()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(error):
            try:
                status = main(arguments(name))
            except Exception:
                status = traceback.format_exc()
        seconds = time.process_time() - started
        os.unlink(name)
        left = sorted(os.listdir())
        for rest in left:
            os.unlink(rest)
        found[name] = {
            "status": status, "out": out.getvalue(), "error": error.getvalue(), "seconds": seconds, "left": left
        }  # fmt: skip
    print(json.dumps({"cases": found, "gigabytes": peak_bytes() / 1e9}))


if __name__ == "__main__":
    run()
