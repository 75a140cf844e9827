"""Many drawings, each folded and written on its own: on all cores, or on a cluster.

Folders, patterns of names and a ``Recipe`` -> in a folder the files of every drawing, ``results.csv`` with a row for
each, a contact sheet, and the journal ``foldcut-batch.jsonl``. A drawing's row goes into the journal, flushed to the
disk, once its files are in place; the same batch run again goes on after the last row. The files do not depend on the
order in which drawings are done. docs/batch.md says why it is so.
"""

from __future__ import annotations

import csv
import errno
import glob
import hashlib
import io
import json
import os
import queue
import threading
import unicodedata
from collections import Counter
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from types import ModuleType, TracebackType
from typing import Any

from foldcut.batch.worker import BAD_INPUT, CRASHED, MADE, Outcome, Process, Recipe, Task, work_apart
from foldcut.core.errors import BadInputError, FoldcutError
from foldcut.exporters.pictures.contact import Thumbnail, contact_sheet
from foldcut.output.atomic import OutputError, check_targets, write_files
from foldcut.profiles import load_profile
from foldcut.readers import READERS

__all__ = ["JOURNAL", "RESULTS", "Batch", "Row", "run_batch"]

JOURNAL, RESULTS, PARQUET = "foldcut-batch.jsonl", "results.csv", "results.parquet"
CONTACT_SHEET = "contact-sheet"

TIMEOUT_S = 300.0
"""A drawing that takes longer is given up unless the caller says otherwise."""

AHEAD = 500
"""How many drawings a cluster is given at once."""

Row = dict[str, Any]
"""What ``results.csv`` says of a drawing: the values of ``COLUMNS``."""

COLUMNS = ("file", "status", "method", "creases", "folds", "shortest_crease_mm", "seconds", "error", "outputs")

Progress = Callable[[str, float], None]


@dataclass(frozen=True)
class Item:
    """A drawing: where it is, and what its files in the folder of the batch are called, without an ending."""

    path: Path
    stem: str

    def task(self, most: int) -> Task:
        """Read the drawing, but no more than it takes to see that it has more than ``most`` bytes."""
        with self.path.open("rb") as file:
            return Task(str(self.path), self.stem, file.read(most + 1))


@dataclass(frozen=True)
class Batch:
    """A finished batch: the row of every drawing in the order of their names, how many were done before, and files."""

    rows: tuple[Row, ...]
    resumed: int
    written: tuple[Path, ...]

    @property
    def counts(self) -> dict[str, int]:
        """How many drawings have each status."""
        return dict(Counter(str(row["status"]) for row in self.rows).most_common())


def run_batch(
    inputs: Sequence[str | Path],
    out: Path,
    recipe: Recipe,
    *,
    jobs: int | None = None,
    timeout: float = TIMEOUT_S,
    cluster: str | None = None,
    replace: bool = False,
    retry: bool = False,
    parquet: bool = False,
    sheet: str = ".svg",
    progress: Progress | None = None,
) -> Batch:
    """Fold every drawing that ``inputs`` name and write its files into the folder ``out``.

    ``inputs``: folders, which are searched with all below, patterns such as ``"icons/*.svg"``, and files. ``jobs``:
    how many processes, all cores unless given; ``cluster``: the address of a dask scheduler whose workers do it
    instead. ``timeout``: seconds for a drawing. What ``out`` has of the same recipe is not done again unless its
    drawing changed or its files are gone; ``retry``: but for what failed; ``replace``: all is done anew, and files are
    replaced. ``sheet``: ".svg" or ".png". ``progress`` is called with a sentence and the part that is done.

    No drawing ends the batch: it has a status and an error. An exception such as ``KeyboardInterrupt`` does; what is
    done is in place then, and the next call goes on.

    Raises BadInputError: there are no drawings, or ``out`` has a batch of another recipe. Raises OutputError: a file
    cannot be written. Raises WorkerError: no process starts. Raises ClusterError: dask is missing or out of reach.
    """
    if not 0 < timeout < 1e8:
        raise BadInputError(f"the timeout is {timeout} s; give a positive number")
    if jobs is not None and jobs < 1:
        raise BadInputError(f"there are {jobs} jobs; give 1 or more")
    if sheet not in (".svg", ".png"):
        raise BadInputError(f"a contact sheet cannot be {sheet}; choose .svg or .png")
    arrow = _extra("pyarrow") if parquet else None
    dask = _extra("distributed") if cluster else None
    items = find_drawings(inputs, out)
    if out.exists() and not out.is_dir():
        raise OutputError(f"{out} is a file, and a batch is written into a folder; give another name")
    out.mkdir(parents=True, exist_ok=True)
    if not (out / JOURNAL).exists() or not (out / JOURNAL).stat().st_size:
        _check_free(out, items, recipe, [f"{CONTACT_SHEET}{sheet}", RESULTS], replace=replace)
    with _Journal(out / JOURNAL, recipe.fingerprint, replace=replace) as journal:
        left = [item for item in items if not _is_done(journal.rows.get(item.stem), item, out, recipe, retry=retry)]
        undone = {item.stem for item in left}
        before = {item.stem: journal.rows[item.stem] for item in items if item.stem not in undone}
        done = resumed = len(before)
        failed = sum(row["status"] != MADE for row in before.values())
        if dask is not None:
            outcomes = _on_cluster(dask, str(cluster), left, recipe, timeout)
        else:
            outcomes = _on_cores(left, recipe, timeout, min(jobs or os.cpu_count() or 1, len(left)))
        try:
            for item, digest, outcome in outcomes:
                row = _keep(item, digest, outcome, out)
                journal.add(item.stem, row)
                done += 1
                failed += row["status"] != MADE
                if progress is not None:
                    progress(f"{done} of {len(items)} drawings, {failed} failed", done / len(items))
        finally:
            outcomes.close()
            known = before | journal.added()  # as read from the disk: an interruption may come at any moment
            records = [known[item.stem] | {"file": str(item.path)} for item in items if item.stem in known]
            rows = tuple({name: record[name] for name in COLUMNS} for record in records)
            write_files({out / RESULTS: _csv(rows)}, replace=True)
        pictures = [(record["stem"], Thumbnail(**record["thumbnail"])) for record in records if record["thumbnail"]]
        written = {out / f"{CONTACT_SHEET}{sheet}": _contact(pictures, sheet)}
        if arrow is not None:
            written[out / PARQUET] = _parquet(arrow, rows)
        write_files(written, replace=True)
    return Batch(rows, resumed, (out / RESULTS, *written))


def find_drawings(inputs: Sequence[str | Path], out: Path) -> list[Item]:
    """Return the drawings that ``inputs`` name, sorted, but for what is in ``out``; each has a stem of its own.

    Stems are those of the files, in the folders that they are in. Where that is the same for two, as for ``a.svg``
    and ``a.dxf``, or ``A.svg`` and ``a.svg`` where case does not count, both keep their endings, and a number follows
    where even that is the same.

    Raises BadInputError: there is nothing of that name, or there are no drawings in it.
    """
    found: dict[str, tuple[Path, Path]] = {}
    ours = Path(os.path.abspath(out))
    for text in map(str, inputs):
        for path, relative in _matches(text):
            absolute = Path(os.path.abspath(path))
            if ours not in absolute.parents:
                found.setdefault(str(absolute), (path, relative))
    if not found:
        raise BadInputError(f"{', '.join(map(str, inputs))}: there are no drawings; they end in {', '.join(READERS)}")
    order = [found[absolute] for absolute in sorted(found, key=lambda absolute: (found[absolute][1], absolute))]
    shared = Counter(_same_name(relative.with_suffix("").as_posix()) for _, relative in order)
    taken = {_same_name(name) for name in (CONTACT_SHEET, Path(RESULTS).stem, Path(JOURNAL).stem)}
    items = []
    for path, relative in order:
        stem = relative.with_suffix("").as_posix()
        if shared[_same_name(stem)] > 1 or _same_name(stem) in taken:
            stem = relative.as_posix()
        unique, number = stem, 1
        while _same_name(unique) in taken:
            number += 1
            unique = f"{stem}-{number}"
        taken.add(_same_name(unique))
        items.append(Item(path, unique))
    return items


def _matches(text: str) -> Iterator[tuple[Path, Path]]:
    """Yield the drawings that one input names, and where they are in its folder."""
    place = Path(text)
    if place.is_dir():
        for path in place.rglob("*"):
            relative = path.relative_to(place)
            if path.suffix.lower() in READERS and path.is_file() and not any(p.startswith(".") for p in relative.parts):
                yield path, relative
    elif place.exists():
        yield place, Path(place.name)
    elif glob.has_magic(text):
        fixed = []
        for part in place.parts[:-1]:
            if glob.has_magic(part):
                break
            fixed.append(part)
        for name in glob.iglob(text, recursive=True):
            if (path := Path(name)).is_file():
                yield path, path.relative_to(Path(*fixed))
    else:
        raise BadInputError(f"{text}: there is no such file or folder; give a folder, a file, or a pattern of names")


def _same_name(text: str) -> str:
    """Return the same text for names that are one and the same file on some system."""
    return unicodedata.normalize("NFC", text).casefold()


def _is_done(row: Mapping[str, Any] | None, item: Item, out: Path, recipe: Recipe, *, retry: bool) -> bool:
    """Whether a drawing's row stands: the drawing is the same, and its files are there."""
    if row is None or (retry and row["status"] != MADE):
        return False
    for name, size in row["outputs"].items():
        try:
            if (out / name).stat().st_size != size:
                return False
        except OSError:
            return False
    return bool(row["sha256"] == _read(item, recipe)[1])


def _read(item: Item, recipe: Recipe) -> tuple[Task | None, str, str]:
    """Return a drawing's task, its hash, and what is wrong when there is none."""
    try:
        task = item.task(recipe.reading.limits.bytes)
    except OSError as error:
        return None, "", f"{item.path}: {error.strerror}; check the path and its permissions"
    return task, hashlib.sha256(task.data).hexdigest(), ""


def _keep(item: Item, digest: str, outcome: Outcome, out: Path) -> Row:
    """Write the files of a drawing and return its record."""
    status, error, files = outcome.status, outcome.error, dict(outcome.files)
    try:
        for name in files:
            (out / name).parent.mkdir(parents=True, exist_ok=True)
        write_files({out / name: data for name, data in files.items()}, replace=True)
    except (OutputError, OSError) as problem:
        cause = problem if isinstance(problem, OSError) else problem.__cause__
        if not isinstance(cause, OSError) or cause.errno not in (errno.ENAMETOOLONG, errno.ENOTDIR, errno.EEXIST):
            raise  # as a full disk, which the next drawing meets as well
        status, error, files = BAD_INPUT, str(problem), {}
    made = status == MADE
    return {
        "status": status,
        "method": outcome.method if made else "",
        "creases": outcome.creases if made else None,
        "folds": outcome.folds if made else None,
        "shortest_crease_mm": outcome.shortest_crease_mm if made else None,
        "seconds": round(outcome.seconds, 3),
        "error": error,
        "outputs": {name: len(data) for name, data in files.items()},
        "sha256": digest,
        "thumbnail": asdict(outcome.thumbnail) if made and outcome.thumbnail is not None else None,
    }


def _check_free(out: Path, items: Sequence[Item], recipe: Recipe, names: Sequence[str], *, replace: bool) -> None:
    """Raise OutputError where a new batch would replace a file without being asked to."""
    targets = [out / name for name in names]
    for item in items:
        for ending in recipe.endings:
            targets += [out / path for path in recipe.job.sides(Path(item.stem + ending)).values()]
    check_targets([target for target in targets if os.path.exists(target)], replace=replace)


# --- who does the work


Outcomes = Generator[tuple[Item, str, Outcome], None, None]
"""Drawings with the hashes of their bytes and what came of them."""


def _on_cores(items: Sequence[Item], recipe: Recipe, timeout: float, jobs: int) -> Outcomes:
    """Yield what comes of each drawing, in the order they are done; each thread waits for a process of its own."""
    waiting: queue.SimpleQueue[Item] = queue.SimpleQueue()
    for item in items:
        waiting.put(item)
    done: queue.SimpleQueue[tuple[Item, str, Outcome] | BaseException] = queue.SimpleQueue()
    processes = [Process() for _ in range(jobs)]
    stopped = threading.Event()

    def serve(process: Process) -> None:
        try:
            while not stopped.is_set():
                item = waiting.get_nowait()
                task, digest, error = _read(item, recipe)
                outcome = Outcome(BAD_INPUT, error) if task is None else process.run(recipe, task, timeout)
                done.put((item, digest, outcome))
        except queue.Empty:
            pass
        except BaseException as error:
            done.put(error)
        finally:
            process.stop()

    threads = [threading.Thread(target=serve, args=(process,), daemon=True) for process in processes]
    for thread in threads:
        thread.start()
    try:
        for _ in items:
            came = done.get()
            if isinstance(came, BaseException):
                raise came
            yield came
    finally:
        stopped.set()
        for process in processes:
            process.cancel()
        for thread in threads:
            thread.join()


def _on_cluster(dask: ModuleType, address: str, items: Sequence[Item], recipe: Recipe, timeout: float) -> Outcomes:
    """Yield what comes of each drawing on the workers of a dask cluster; a lost worker's drawings go to another."""
    try:
        client = dask.Client(address, timeout="20s", set_as_default=False)
    except (OSError, ValueError) as error:
        raise ClusterError(
            f"the scheduler {address} does not answer ({error}); start one with `dask scheduler`"
        ) from None
    with client:
        waiting = iter(items)
        known: dict[Any, tuple[Item, str]] = {}
        futures = dask.as_completed(loop=client.loop)

        def submit() -> Outcomes:
            """Give the cluster the next drawing; yields those that cannot even be read."""
            for item in waiting:
                task, digest, error = _read(item, recipe)
                if task is None:
                    yield item, digest, Outcome(BAD_INPUT, error)
                    continue
                future = client.submit(work_apart, recipe, task, timeout, pure=False)
                known[future.key] = (item, digest)
                futures.add(future)
                return

        for _ in range(AHEAD):
            yield from submit()
        for future in futures:
            item, digest = known.pop(future.key)
            yield item, digest, _outcome_of(future)
            yield from submit()


def _outcome_of(future: Any) -> Outcome:
    """Return what a cluster made of a drawing; raises what ends the batch."""
    error = future.exception()
    if error is None:
        outcome: Outcome = future.result()
        return outcome
    if type(error).__name__ == "KilledWorker":
        return Outcome(CRASHED, "every worker that had this drawing was lost")
    raise error


class ClusterError(FoldcutError, RuntimeError):
    """An extra is missing, or a cluster is out of reach."""


def _extra(name: str) -> ModuleType:
    """Return a module of the extra "batch"."""
    from importlib import import_module

    try:
        return import_module(name)
    except ModuleNotFoundError as error:
        raise BadInputError(f"this needs the extra 'batch' ({error.name}): pip install 'foldcut[batch]'") from None


# --- what is kept


class _Journal:
    """An append-only file of JSON lines: a head with the recipe, then a record for each drawing that is done.

    ``rows`` has the last record of each stem when the file is opened, and a line that a crash cut off is taken away
    then; ``added`` returns what came later.
    """

    def __init__(self, path: Path, recipe: str, *, replace: bool) -> None:
        self.path, self.rows = path, dict[str, Row]()
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
                f"{folder} has a batch made with other options; give these, another folder, or --force to begin anew"
            )
        self.rows.update((record["stem"], record) for record in records if "stem" in record)

    def add(self, stem: str, row: Row) -> None:
        """Append a record and return when it is on the disk."""
        self._append({"stem": stem} | row)

    def added(self) -> dict[str, Row]:
        """Return the records since the file was opened, by their stems."""
        with self.path.open("rb") as file:
            file.seek(self._end)
            data = file.read()
        records = _records(data[: data.rfind(b"\n") + 1].splitlines())
        return {record["stem"]: record for record in records if "stem" in record}

    def _append(self, record: Row) -> None:
        line = json.dumps(record, ensure_ascii=False).encode("utf-8", "surrogateescape") + b"\n"
        while line:
            line = line[os.write(self._file, line) :]
        os.fsync(self._file)

    def __enter__(self) -> _Journal:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        os.close(self._file)


def _records(lines: Iterable[bytes]) -> list[Row]:
    """Return the records that lines hold."""
    records: list[Row] = []
    for line in lines:
        with suppress(ValueError):  # a damaged disk: what the line said is done again
            records.append(json.loads(line))
    return records


def _lock(file: int, path: Path) -> None:
    """Keep other batches out of the folder until the file is closed, where the system can."""
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


def _csv(rows: Iterable[Row]) -> bytes:
    """Return the rows as CSV (RFC 4180); of several outputs the names are apart by a space."""
    text = io.StringIO(newline="")
    writer = csv.DictWriter(text, COLUMNS)
    writer.writeheader()
    for row in rows:
        writer.writerow(row | {"outputs": " ".join(row["outputs"])})
    return text.getvalue().encode("utf-8", "backslashreplace")


def _parquet(arrow: ModuleType, rows: Sequence[Row]) -> bytes:
    """Return the rows as Parquet; ``outputs`` is a list of names."""
    import pyarrow.parquet

    kinds = {"creases": arrow.int64(), "folds": arrow.int64(), "outputs": arrow.list_(arrow.string())}
    kinds |= {"shortest_crease_mm": arrow.float64(), "seconds": arrow.float64()}
    schema = arrow.schema([(name, kinds.get(name, arrow.string())) for name in COLUMNS])
    table = arrow.Table.from_pylist([row | {"outputs": list(row["outputs"])} for row in rows], schema=schema)
    out = io.BytesIO()
    pyarrow.parquet.write_table(table, out)
    return out.getvalue()


def _contact(pictures: Sequence[tuple[str, Thumbnail]], sheet: str) -> bytes:
    """Return the contact sheet."""
    svg, size = contact_sheet(pictures, f"{len(pictures)} crease patterns", load_profile().drawing)
    if sheet == ".svg":
        return svg
    from foldcut.exporters.pattern.png import rendered

    return rendered(svg, size)
