"""Write files so that each is either complete or untouched.

Every file first goes to a temporary name in its own folder, is flushed to the disk, and only when all are
there are they moved into place. Whatever happens before that, an interrupt included, leaves nothing behind.
"""

from __future__ import annotations

import errno
import os
import secrets
import stat
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from foldcut.errors import FileFormatError


class OutputError(FileFormatError):
    """A file cannot be written where it was asked for."""


_REMEDIES = {
    errno.ENOENT: "its folder does not exist; create it first",
    errno.ENOTDIR: "part of its path is no folder; choose another place",
    errno.EACCES: "the folder is not writable; change its permissions or choose another place",
    errno.EPERM: "the folder is not writable; change its permissions or choose another place",
    errno.EROFS: "the folder is not writable; choose another place",
    errno.ENOSPC: "the disk is full; make room and try again",
    errno.EDQUOT: "the disk quota is used up; make room and try again",
    errno.ENAMETOOLONG: "its name is too long; choose a shorter one",
}


def check_targets(paths: Iterable[Path]) -> None:
    """Raise where a file could not be written, before any long work; only the disk may still be full.

    Raises OutputError: a folder is missing or not writable, a path is a folder, or two are the same.
    """
    seen = set()
    for path in paths:
        target = _resolved(path)
        if target in seen:
            raise OutputError(f"{path} is named twice; give every output its own name")
        seen.add(target)
        with _explained(path):
            if target.exists() and not target.is_file():
                what = "a folder" if target.is_dir() else "no regular file"
                raise OutputError(f"cannot write {path}: it is {what}; give a file name")
            folder = os.stat(target.parent)
            if not stat.S_ISDIR(folder.st_mode):
                raise OSError(errno.ENOTDIR, "")
            if not os.access(target.parent, os.W_OK | os.X_OK):
                raise OSError(errno.EACCES, "")


def write_files(contents: Mapping[Path, bytes]) -> None:
    """Write all files, replacing what is there; if one cannot be written, none is.

    A replaced file keeps its permissions, and a link is followed. Only a failure while the finished files
    are moved into place, one after the other, can leave some new and some old; each one is whole even then.

    Raises OutputError: a file cannot be written; the message says which, why and what to do.
    """
    check_targets(contents)
    moves: list[tuple[Path, Path, Path]] = []
    try:
        for path, data in contents.items():
            target = _resolved(path)
            # A short name of its own: one as long as the target's plus an ending might be too long.
            temporary = target.with_name(f".foldcut-{secrets.token_hex(8)}.tmp")
            moves.append((path, temporary, target))
            with _explained(path):
                _write_flushed(temporary, data, like=target)
        for path, temporary, target in moves:
            with _explained(path):
                os.replace(temporary, target)
    finally:
        for _, temporary, _ in moves:
            temporary.unlink(missing_ok=True)


def _write_flushed(path: Path, data: bytes, like: Path) -> None:
    """Create ``path`` with ``data`` on the disk, with the permissions of ``like`` if that exists."""
    with path.open("xb") as file:
        if like.exists():
            os.chmod(path, stat.S_IMODE(like.stat().st_mode))
        file.write(data)
        file.flush()
        os.fsync(file.fileno())


def _resolved(path: Path) -> Path:
    """Return where ``path`` leads, links followed."""
    return Path(os.path.realpath(path))


@contextmanager
def _explained(path: Path) -> Iterator[None]:
    """Turn an ``OSError`` into an ``OutputError`` that says what to do."""
    try:
        yield
    except OSError as error:
        reason = _REMEDIES.get(error.errno or 0) or f"{error.strerror or error}; choose another place"
        raise OutputError(f"cannot write {path}: {reason}") from error
