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
            os.ftruncate(self._file, len(whole))
            self._end = os.lseek(self._file, 0, os.SEEK_END)
            if not whole:
                self._append({"foldcut_batch": 1, "recipe": recipe})
            self._read(whole.splitlines(), recipe)
        except BaseException:
            os.close(self._file)
            raise

    def _read(self, lines: Sequence[bytes], recipe: str) -> None:
        records = _records(lines)
        if records and records[0].get("recipe") != recipe:
            folder = self.path.parent
            raise BadInputError(
                f"{folder} has a batch made with other options; use the same options, another folder, or --force to "
                "start again"
            )
        self.rows.update((record["stem"], record) for record in records if "stem" in record)

    def add(self, stem: str, record: Record) -> None:
        """Append a record and return when it is on the disk."""
        self._append({"stem": stem} | record)

    def added(self) -> dict[str, Record]:
        """Return the records added since the file was opened, by stem, as they are on the disk."""
        with self.path.open("rb") as file:
            file.seek(self._end)
            data = file.read()
        records = _records(data[: data.rfind(b"\n") + 1].splitlines())
        return {record["stem"]: record for record in records if "stem" in record}

    def _append(self, record: Record) -> None:
        line = json.dumps(record, ensure_ascii=False).encode("utf-8", "surrogateescape") + b"\n"
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
        with suppress(json.JSONDecodeError, UnicodeDecodeError):
            records.append(json.loads(line))
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
