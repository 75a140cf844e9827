"""Writes files so that each is either complete or untouched.

Every file is first written under a temporary name in its own folder and flushed to the disk; only when all are there
are they moved into place. Whatever goes wrong before that, an interrupt included, leaves nothing behind. Signals wait
while files are moved, so that all are new or all are old. Only SIGKILL or a crash can leave a temporary file,
``.foldcut-*.tmp``; the next write into that folder removes it once it is an hour old.
"""

from __future__ import annotations

import errno
import os
import secrets
import stat
import time
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path

from foldcut.core.errors import FileFormatError
from foldcut.core.files import identity, is_standard_input
from foldcut.core.signals import signals_wait


class OutputError(FileFormatError):
    """A file cannot be written to the place that was asked for."""


class InputError(OutputError):
    """A file is read, and would be replaced."""


class Inputs:
    """The files that a command reads. None of them is ever replaced, by whatever path: links, hard links, other case.

    ``paths`` may have some that do not exist; the one of standard input is "-".
    """

    def __init__(self, paths: Iterable[Path] = ()) -> None:
        self._paths = {found: path for path in paths if (found := identity(path)) is not None}

    def refuse(self, target: Path) -> None:
        """Raise InputError if ``target`` leads to one of them."""
        path = self._paths.get(identity(target) or (-1, -1)) if self._paths else None
        if path is None:
            return
        what = "standard input" if is_standard_input(path) else str(path)
        same = f" (as {what})" if what != str(target) else ""
        raise InputError(f"cannot write {target}: it is read{same}, and would be lost; write to another name or folder")


STALE_S = 3600.0
"""A temporary file older than this, in seconds, was left behind by a process that was killed."""

_REMEDIES = {
    errno.ENOENT: "its folder does not exist; create it first",
    errno.ENOTDIR: "part of its path is not a folder; choose another place",
    errno.EACCES: "the folder is not writable; change its permissions or choose another place",
    errno.EPERM: "the folder is not writable; change its permissions or choose another place",
    errno.EROFS: "the folder is not writable; choose another place",
    errno.ENOSPC: "the disk is full; make room and try again",
    errno.EDQUOT: "the disk quota is used up; make room and try again",
    errno.ENAMETOOLONG: "its name is too long; choose a shorter one",
}
"""What a message says about an error of the operating system: what is wrong, and what to do."""


def check_targets(paths: Iterable[Path], *, replace: bool = False, inputs: Inputs | None = None) -> None:
    """Check, before any long work, that files can be written; a full disk is found out only later.

    Raises OutputError: a folder is missing or not writable, a path is a folder, two paths are the same, or, without
    ``replace``, a file exists already. Raises InputError: a file is one of the ``inputs``.
    """
    seen = set()
    for path in paths:
        target = _resolved(path)
        if target in seen:
            raise OutputError(f"{path} is named twice; give every output its own name")
        seen.add(target)
        with _explained(path):
            if inputs is not None:
                inputs.refuse(path)
            if target.exists() and not target.is_file():
                what = "a folder" if target.is_dir() else "not a regular file"
                raise OutputError(f"cannot write {path}: it is {what}; give a file name")
            if target.exists() and not replace:
                remedy = "replace it with --force, or choose another name"
                raise OutputError(f"cannot write {path}: it is there already; {remedy}")
            folder = os.stat(target.parent)
            if not stat.S_ISDIR(folder.st_mode):
                raise OSError(errno.ENOTDIR, "")
            if not os.access(target.parent, os.W_OK | os.X_OK):
                raise OSError(errno.EACCES, "")


def write_files(contents: Mapping[Path, bytes], *, replace: bool = False, inputs: Inputs | None = None) -> None:
    """Write all files, or none if one cannot be written; ``replace`` allows existing files to be replaced.

    The ``inputs`` never are. A replaced file keeps its permissions, and links are followed. Only a failure while the
    finished files are moved into place, one after the other, can leave some new and some old; even then each of them is
    whole.

    Raises OutputError: a file cannot be written; the message says which one, why, and what to do.
    """
    check_targets(contents, replace=replace, inputs=inputs)
    moves: list[tuple[Path, Path, Path]] = []
    try:
        for path, data in contents.items():
            target = _resolved(path)
            # A short name: the target's own plus an ending might be too long.
            temporary = target.with_name(f".foldcut-{secrets.token_hex(8)}.tmp")
            moves.append((path, temporary, target))
            with _explained(path):
                _write_flushed(temporary, data, like=target)
        with signals_wait():
            for path, temporary, target in moves:
                with _explained(path):
                    os.replace(temporary, target)
    finally:
        with signals_wait():
            for _, temporary, _ in moves:
                temporary.unlink(missing_ok=True)
    for folder in {target.parent for _, _, target in moves}:
        _remove_stale(folder)


def _remove_stale(folder: Path) -> None:
    """Remove what killed processes left behind; what cannot be removed stays."""
    for left in folder.glob(".foldcut-" + "[0-9a-f]" * 16 + ".tmp"):
        with suppress(OSError):
            if time.time() - left.stat().st_mtime > STALE_S:
                left.unlink()


def _write_flushed(path: Path, data: bytes, like: Path) -> None:
    """Create ``path`` with ``data``, flushed to the disk, and with the permissions of ``like`` if that exists."""
    with path.open("xb") as file:
        if like.exists():
            os.chmod(path, stat.S_IMODE(like.stat().st_mode))
        file.write(data)
        file.flush()
        os.fsync(file.fileno())


def _resolved(path: Path) -> Path:
    """Return where ``path`` leads when links are followed."""
    return Path(os.path.realpath(path))


@contextmanager
def _explained(path: Path) -> Iterator[None]:
    """Turn an ``OSError`` into an ``OutputError`` that says what to do."""
    try:
        yield
    except OSError as error:
        reason = _REMEDIES.get(error.errno or 0) or f"{error.strerror or error}; choose another place"
        raise OutputError(f"cannot write {path}: {reason}") from error
