"""The journal of a batch: what is done, kept so that an interrupted batch goes on where it stopped.

Records <-> the lines of a file. docs/batch.md says what a line promises after a power cut or a kill.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Sequence
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Any

from foldcut.core.errors import BadInputError

JOURNAL = "foldcut-batch.jsonl"
"""The name of the journal."""

HEAD = b'{"foldcut_batch": '
"""What a journal begins with."""

Record = dict[str, Any]
"""A line of the journal: a drawing's ``stem``, what its row says, the sizes of its files, its hash and thumbnail."""


class Journal:
    """An append-only file of JSON lines: a head with the recipe, then a record for each drawing that is done.

    ``rows``: the last record of each stem at the time the file was opened; a last line that a crash cut short is
    removed then. ``added`` returns what came later.
    """

    def __init__(self, path: Path, recipe: str, *, replace: bool) -> None:
        """Open the journal of the batch with this recipe's fingerprint; with ``replace`` begin it anew.

        Raises BadInputError: the file is another recipe's, or another batch is writing to it.
        """
        self.path, self.rows = path, dict[str, Record]()
        self._file = os.open(path, os.O_RDWR | os.O_CREAT | getattr(os, "O_CLOEXEC", 0), 0o666)
        try:
            _lock(self._file, path)
            with open(self._file, "rb", closefd=False) as file:
                data = b"" if replace else file.read()
            whole = data[: data.rfind(b"\n") + 1]
            if whole:
                self._read(whole.splitlines(), recipe)
            elif data and not HEAD.startswith(data[: len(HEAD)]):
                raise self._foreign()
            os.ftruncate(self._file, len(whole))
            self._end = os.lseek(self._file, 0, os.SEEK_END)
            if not whole:
                self._append({"foldcut_batch": 1, "recipe": recipe})
        except BaseException:
            os.close(self._file)
            raise

    def _read(self, lines: Sequence[bytes], recipe: str) -> None:
        records = _records(lines)
        if not records or "foldcut_batch" not in records[0]:
            raise self._foreign()
        if records[0].get("recipe") != recipe:
            raise BadInputError(
                f"{self.path.parent} has a batch made with other options; use the same options, another folder, or "
                "--force to start again"
            )
        self.rows.update((record["stem"], record) for record in records if isinstance(record.get("stem"), str))

    def _foreign(self) -> BadInputError:
        return BadInputError(f"{self.path} is no journal of a batch; move it away, or write into another folder")

    def add(self, stem: str, record: Record) -> None:
        """Append a record and return when it is on the disk."""
        self._append({"stem": stem} | record)

    def added(self) -> dict[str, Record]:
        """Return the records added since the file was opened, by stem, as they are on the disk."""
        with self.path.open("rb") as file:
            file.seek(self._end)
            data = file.read()
        records = _records(data[: data.rfind(b"\n") + 1].splitlines())
        return {record["stem"]: record for record in records if isinstance(record.get("stem"), str)}

    def _append(self, record: Record) -> None:
        try:
            line = json.dumps(record, ensure_ascii=False).encode() + b"\n"
        except UnicodeEncodeError:  # a name that is no UTF-8, or half a letter in an error
            line = json.dumps(record).encode() + b"\n"
        while line:
            line = line[os.write(self._file, line) :]
        os.fsync(self._file)

    def __enter__(self) -> Journal:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        os.close(self._file)


def _records(lines: Iterable[bytes]) -> list[Record]:
    """Return the records in lines; a line that a damaged disk garbled is left out, and its drawing is done again."""
    records: list[Record] = []
    for line in lines:
        with suppress(ValueError, RecursionError):
            record = json.loads(line.decode("utf-8", "surrogateescape"))  # as earlier versions wrote such names
            if isinstance(record, dict):
                records.append(record)
    return records


def _lock(file: int, path: Path) -> None:
    """Keep other batches out of the folder until the file is closed, on systems that can."""
    try:
        import fcntl
    except ModuleNotFoundError:
        return
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        raise BadInputError(
            f"another batch is writing into {path.parent}; wait for it, or give another folder"
        ) from None
