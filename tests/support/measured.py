"""``python -m support.measured ARGUMENTS``: run foldcut and print, last, its peak of memory in bytes (Linux)."""

from __future__ import annotations

import sys
from pathlib import Path

from foldcut.cli.main import main


def peak_bytes() -> int:
    """Return the most memory that this process has had.

    ``getrusage`` counts what the parent had, too, when it started the process.
    """
    return int(Path("/proc/self/status").read_text().partition("VmHWM:")[2].split()[0]) * 1024


if __name__ == "__main__":
    status = main(sys.argv[1:])
    print(peak_bytes())
    sys.exit(status)
