"""Files are written whole or not at all."""

from __future__ import annotations

import errno
import os
import signal
import time
from pathlib import Path

import pytest

from foldcut.core.errors import BadInputError
from foldcut.output.atomic import OutputError, check_targets, write_files


def contents(folder: Path) -> dict[str, bytes]:
    """Return every file of a folder, temporary ones too."""
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


def test_files_are_written_and_replaced(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(b"old")
    write_files({tmp_path / "a": b"one", tmp_path / "b": b"two"}, replace=True)
    assert contents(tmp_path) == {"a": b"one", "b": b"two"}


def test_permissions_are_the_umasks_and_a_replaced_files_own(tmp_path: Path) -> None:
    old = os.umask(0o022)
    try:
        (tmp_path / "a").write_bytes(b"old")
        (tmp_path / "a").chmod(0o600)
        write_files({tmp_path / "a": b"one", tmp_path / "b": b"two"}, replace=True)
    finally:
        os.umask(old)
    assert [(tmp_path / name).stat().st_mode & 0o777 for name in "ab"] == [0o600, 0o644]


def test_a_link_is_followed(tmp_path: Path) -> None:
    (tmp_path / "real").write_bytes(b"old")
    (tmp_path / "link").symlink_to("real")
    write_files({tmp_path / "link": b"new"}, replace=True)
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "real").read_bytes() == b"new"


def test_nothing_is_replaced_unless_asked_for(tmp_path: Path) -> None:
    (tmp_path / "b").write_bytes(b"old")
    with pytest.raises(OutputError, match=r"b: it is there already; replace it with --force"):
        check_targets([tmp_path / "a", tmp_path / "b"])
    with pytest.raises(OutputError, match=r"b: it is there already"):
        write_files({tmp_path / "a": b"new", tmp_path / "b": b"new"})
    assert contents(tmp_path) == {"b": b"old"}


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_signals_wait_while_files_are_moved(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, number: signal.Signals
) -> None:
    class Came(BaseException):
        pass

    def raise_came(*_: object) -> None:
        raise Came

    replace, before = os.replace, signal.signal(number, raise_came)

    def signalled(source: Path, target: Path) -> None:
        signal.raise_signal(number)
        replace(source, target)

    monkeypatch.setattr(os, "replace", signalled)
    (tmp_path / "a").write_bytes(b"old")
    try:
        with pytest.raises(Came):
            write_files({tmp_path / name: b"new" for name in "abc"}, replace=True)
        assert signal.getsignal(number) is raise_came
    finally:
        signal.signal(number, before)
    assert contents(tmp_path) == dict.fromkeys("abc", b"new")


def test_what_a_killed_process_left_is_removed_an_hour_later(tmp_path: Path) -> None:
    new, old, other = (tmp_path / f".foldcut-{name}.tmp" for name in ("0" * 16, "1" * 16, "mine"))
    for path in (new, old, other):
        path.write_bytes(b"half")
    for path in (old, other):
        os.utime(path, (time.time() - 4000,) * 2)
    write_files({tmp_path / "a": b"new"})
    assert set(contents(tmp_path)) == {"a", new.name, other.name}


def test_a_full_disk_leaves_the_old_file_and_no_other(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """/dev/full takes no byte: the system's own error, while writing."""
    full = Path("/dev/full")
    if not full.exists():
        pytest.skip("the system has no /dev/full")
    (tmp_path / "a").write_bytes(b"old")
    opened = Path.open

    def on_a_full_disk(path: Path, mode: str) -> object:
        opened(path, mode).close()
        return opened(full, "wb")

    monkeypatch.setattr(Path, "open", on_a_full_disk)
    with pytest.raises(OutputError, match="the disk is full; make room"):
        write_files({tmp_path / "a": b"new"}, replace=True)
    monkeypatch.undo()
    assert contents(tmp_path) == {"a": b"old"}


@pytest.mark.parametrize("failing", [0, 1, 2])
@pytest.mark.parametrize("error", [OSError(errno.ENOSPC, "No space left on device"), KeyboardInterrupt()])
def test_a_failure_before_all_are_written_leaves_everything_as_it_was(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, failing: int, error: BaseException
) -> None:
    (tmp_path / "b").write_bytes(b"old")
    calls = iter(range(10))
    flush = os.fsync

    def fsync(descriptor: int) -> None:
        if next(calls) == failing:
            raise error
        flush(descriptor)

    monkeypatch.setattr(os, "fsync", fsync)
    with pytest.raises((OutputError, KeyboardInterrupt)) as caught:
        write_files({tmp_path / name: b"new" for name in "abc"}, replace=True)
    assert contents(tmp_path) == {"b": b"old"}
    if isinstance(error, OSError):
        assert (
            str(caught.value) == f"cannot write {tmp_path / 'abc'[failing]}: the disk is full; make room and try again"
        )


def test_a_failure_while_moving_leaves_whole_files_and_no_others(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "b").write_bytes(b"old")
    replace = os.replace

    def refuse_b(source: Path, target: Path) -> None:
        if target.name == "b":
            raise PermissionError(errno.EPERM, "Operation not permitted")
        replace(source, target)

    monkeypatch.setattr(os, "replace", refuse_b)
    with pytest.raises(OutputError, match=r"cannot write .*b: the folder is not writable"):
        write_files({tmp_path / "a": b"new", tmp_path / "b": b"new"}, replace=True)
    assert contents(tmp_path) == {"a": b"new", "b": b"old"}


def test_targets_that_cannot_be_written_are_named_with_the_remedy(tmp_path: Path) -> None:
    (tmp_path / "file").write_bytes(b"")
    (tmp_path / "link").symlink_to("file")
    cases = {
        "its folder does not exist; create it first": [tmp_path / "missing" / "a"],
        "part of its path is not a folder": [tmp_path / "file" / "a"],
        "it is a folder; give a file name": [tmp_path],
        "it is not a regular file": [Path(os.devnull)],
        "its name is too long": [tmp_path / ("a" * 300)],
        "is named twice": [tmp_path / "file", tmp_path / "link"],
    }
    for message, paths in cases.items():
        with pytest.raises(OutputError, match=message):
            check_targets(paths, replace=True)
        with pytest.raises(OutputError, match=message):
            write_files(dict.fromkeys(paths, b"new"), replace=True)
    assert contents(tmp_path) == {"file": b"", "link": b""}
    assert issubclass(OutputError, BadInputError)


def test_a_folder_without_write_permission_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # Not by chmod: root may write everywhere.
    monkeypatch.setattr(os, "access", lambda *_: False)
    with pytest.raises(OutputError, match="the folder is not writable"):
        check_targets([tmp_path / "a"])


def test_a_name_of_the_longest_length_can_be_written(tmp_path: Path) -> None:
    name = "a" * 255
    write_files({tmp_path / name: b"new"}, replace=True)
    assert contents(tmp_path) == {name: b"new"}
