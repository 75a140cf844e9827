"""The files that a user names: what is read of them, and whether two paths lead to one file.

Only ordinary files are read, and standard input: a device has no end, and a named pipe waits for ever.
"""

from __future__ import annotations

import hashlib
import os
import stat
import sys
from pathlib import Path

from foldcut.core.errors import FileFormatError

__all__ = ["NOT_ORDINARY", "STANDARD_INPUT", "hash_of", "identity", "is_standard_input", "read_bytes"]

STANDARD_INPUT = "-"
"""The path that stands for standard input, as ``/dev/stdin`` does."""

NOT_ORDINARY = "is not an ordinary file; give one, or - for standard input"
"""What is wrong with a device, a named pipe or a socket."""


def is_standard_input(path: Path | str) -> bool:
    """Whether a path stands for standard input."""
    return str(path) in (STANDARD_INPUT, "/dev/stdin")


def read_bytes(path: Path, most: int) -> bytes:
    """Return the bytes of an ordinary file or of standard input, but no more than ``most + 1`` of them.

    Raises FileFormatError: it is another kind of file. Raises OSError: it cannot be opened.
    """
    if is_standard_input(path):
        return b"" if sys.stdin is None else sys.stdin.buffer.read(most + 1)
    if not path.is_dir() and not stat.S_ISREG(path.stat().st_mode):  # before it is opened: a pipe would wait
        raise FileFormatError(NOT_ORDINARY)
    with open(path, "rb", opener=_open_at_once) as file:
        if not stat.S_ISREG(os.fstat(file.fileno()).st_mode):
            raise FileFormatError(NOT_ORDINARY)
        data: bytes | None = file.read(most + 1)
    if data is None:  # it calls itself ordinary, and would wait, as /proc/kmsg does
        raise FileFormatError(NOT_ORDINARY)
    return data


def _open_at_once(path: str, flags: int) -> int:
    """Open a file without waiting, should it have become a pipe meanwhile."""
    return os.open(path, flags | getattr(os, "O_NONBLOCK", 0))


def hash_of(path: Path) -> str:
    """Return the SHA-256 of a file."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def identity(path: Path) -> tuple[int, int] | None:
    """Return what is the same for all paths that lead to one file: device and number; None if there is no file."""
    try:
        found = os.fstat(0) if is_standard_input(path) else path.stat()
    except (OSError, ValueError):
        return None
    return found.st_dev, found.st_ino
