"""Many drawings, each folded and written on its own, on all cores or on a cluster.

Folders, glob patterns and a ``Recipe`` -> a folder with the files of every drawing, ``results.csv`` with a row for
each, a contact sheet, and the journal ``foldcut-batch.jsonl``. Once a drawing's files are in place its record goes into
the journal and is flushed to the disk; the same batch run again goes on after the last record. The files do not depend
on the order in which drawings are done. docs/batch.md has the reasons.
"""

from __future__ import annotations

import errno
import os
from collections import Counter
from collections.abc import Callable, Collection, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

from foldcut.batch.cluster import work_on_cluster
from foldcut.batch.cores import work_on_cores
from foldcut.batch.drawings import Item, find_drawings
from foldcut.batch.journal import JOURNAL, Journal, Record
from foldcut.batch.nest import BEDS, NestedBed, Nesting, beds_of_before, nested_files
from foldcut.batch.results import (
    COLUMNS,
    CONTACT_SHEET,
    PARQUET,
    RESULTS,
    Row,
    contact_sheet_file,
    csv_table,
    parquet_table,
)
from foldcut.batch.worker import BAD_INPUT, MADE, Outcome, Recipe
from foldcut.core.errors import BadInputError
from foldcut.exporters.pictures.contact_sheet import Thumbnail
from foldcut.output.atomic import InputError, Inputs, OutputError, check_targets, write_files

TIMEOUT_S = 300.0
"""A drawing that takes longer is given up, unless the caller gives another time."""

Progress = Callable[[str, float], None]


class TakenError(OutputError):
    """A file of somebody else's is where one of the batch's would be."""


@dataclass(frozen=True)
class Batch:
    """A finished batch.

    ``rows``: one for every drawing, sorted by name; ``resumed``: how many of them were done before; ``written``: the
    paths of the table, the contact sheet and the files of the ``beds``, on which sheets lie together.
    """

    rows: tuple[Row, ...]
    resumed: int
    written: tuple[Path, ...]
    beds: tuple[NestedBed, ...] = ()

    @property
    def counts(self) -> dict[str, int]:
        """How many drawings have each status."""
        return dict(Counter(str(row["status"]) for row in self.rows).most_common())


def run_batch(
    inputs: Sequence[str | Path],
    out: Path,
    recipe: Recipe,
    *,
    letters: Sequence[Item] = (),
    inputs_beside: Sequence[Path] = (),
    jobs: int | None = None,
    timeout: float = TIMEOUT_S,
    cluster: str | None = None,
    replace: bool = False,
    retry: bool = False,
    parquet: bool = False,
    sheet: str = ".svg",
    nesting: Nesting | None = None,
    progress: Progress | None = None,
) -> Batch:
    """Fold every drawing that ``inputs`` name and write its files into the folder ``out``.

    ``inputs``: folders, which are searched with their subfolders, glob patterns such as ``"icons/*.svg"``, and files.
    ``letters``: drawings that are in no file, of ``batch.drawings.letters_of``, instead of ``inputs``.
    ``inputs_beside``: other files that are read, such as a font; like the drawings they are never replaced.
    ``jobs``: the number of processes, by default one for each core; ``cluster``: the address of a dask scheduler, whose
    workers then do the work instead. ``timeout``: seconds for a drawing.

    A drawing that is done in ``out`` is not done again, unless it changed or its files are gone. ``retry``: do again
    what failed. ``replace``: do everything again and replace files, and remove beds of an earlier call. ``sheet``: the
    contact sheet as ".svg" or ".png"; ``parquet``: write the table as Parquet, too. ``nesting``: lay the sheets of all
    drawings on beds of the recipe's machine; the recipe has to write ".fold". ``progress`` is called with a sentence
    and the fraction done.

    No drawing ends the batch: what goes wrong with it becomes its status and error. An exception such as
    ``KeyboardInterrupt`` does end it; what is done by then is in place, and the next call goes on from there.

    Raises BadInputError: there are no drawings, or ``out`` has a batch of another recipe, or an extra is missing.
    Raises OutputError: a file cannot be written. Raises WorkerError: no process starts. Raises ClusterError: the
    scheduler does not answer.
    """
    if not 0 < timeout < 1e8:
        raise BadInputError(f"the timeout is {timeout} s; give a positive number")
    if jobs is not None and jobs < 1:
        raise BadInputError(f"there are {jobs} jobs; give 1 or more")
    if sheet not in (".svg", ".png"):
        raise BadInputError(f"a contact sheet cannot be {sheet}; choose .svg or .png")
    arrow = _extra("pyarrow") if parquet else None
    dask = _extra("distributed") if cluster else None
    items = list(letters) or find_drawings(inputs, out)
    if out.exists() and not out.is_dir():
        raise OutputError(f"{out} is a file, and a batch is written into a folder; give another name")
    out.mkdir(parents=True, exist_ok=True)
    read = Inputs([*(item.path for item in items if item.data is None), *inputs_beside])
    ours = [out / name for name in (JOURNAL, RESULTS, f"{CONTACT_SHEET}{sheet}", *([PARQUET] if parquet else []))]
    check_targets(ours, replace=True, inputs=read)
    if not (out / JOURNAL).exists() or not (out / JOURNAL).stat().st_size:
        beds_too = [] if nesting is None else [BEDS, *(f"bed-1{ending}" for ending in nesting.endings)]
        _check_free(out, items, recipe, [f"{CONTACT_SHEET}{sheet}", RESULTS, *beds_too], replace=replace)
    with Journal(out / JOURNAL, recipe.fingerprint, replace=replace) as journal:
        left = [item for item in items if not _is_done(journal.rows.get(item.stem), item, out, recipe, retry=retry)]
        undone = {item.stem for item in left}
        made = {name for record in journal.rows.values() for name in record.get("outputs", ())}
        before = {item.stem: journal.rows[item.stem] for item in items if item.stem not in undone}
        done = resumed = len(before)
        failed = sum(record["status"] != MADE for record in before.values())
        if dask is not None:
            outcomes = work_on_cluster(dask, str(cluster), left, recipe, timeout)
        else:
            outcomes = work_on_cores(left, recipe, timeout, min(jobs or os.cpu_count() or 1, len(left)))
        try:
            for item, digest, outcome in outcomes:
                record = _keep(item, digest, outcome, out, read, known=None if replace else made)
                journal.add(item.stem, record)
                done += 1
                failed += record["status"] != MADE
                if progress is not None:
                    progress(f"{done} of {len(items)} drawings, {failed} failed", done / len(items))
        finally:
            outcomes.close()
            known = before | journal.added()  # as read from the disk: an interruption may come at any moment
            records = [known[item.stem] | {"file": str(item.path)} for item in items if item.stem in known]
            rows = tuple({name: record[name] for name in COLUMNS} for record in records)
            write_files({out / RESULTS: csv_table(rows)}, replace=True, inputs=read)
        pictures = [(record["stem"], Thumbnail(**record["thumbnail"])) for record in records if record["thumbnail"]]
        written = {out / f"{CONTACT_SHEET}{sheet}": contact_sheet_file(pictures, sheet)}
        if arrow is not None:
            written[out / PARQUET] = parquet_table(arrow, rows)
        beds: list[NestedBed] = []
        stale: list[Path] = []
        if nesting is not None and recipe.profile is not None:
            if progress is not None:
                progress("laying sheets on beds", 1.0)
            beds, files, stale = nested_files(out, records, nesting, recipe.profile, recipe.job)
            written |= files
        elif replace:
            kept = {name for record in records for name in record["outputs"]} | {item.path.name for item in items}
            stale = [path for path in beds_of_before(out) if path.name not in kept]
            stale += [out / BEDS] if stale else []
        write_files(written, replace=True, inputs=read)
        for path in stale:
            path.unlink(missing_ok=True)
    return Batch(rows, resumed, (out / RESULTS, *written), tuple(beds))


def _is_done(record: Mapping[str, Any] | None, item: Item, out: Path, recipe: Recipe, *, retry: bool) -> bool:
    """Return whether a drawing's record still holds: the drawing is unchanged, and its files are there."""
    if (
        record is None
        or not record.keys() >= {*COLUMNS, "sha256", "thumbnail"} - {"file"}
        or (retry and record["status"] != MADE)
    ):
        return False
    for name, size in record["outputs"].items():
        try:
            if (out / name).stat().st_size != size:
                return False
        except OSError:
            return False
    return bool(record["sha256"] == item.read(recipe.reading.limits.bytes)[1])


def _keep(
    item: Item, digest: str, outcome: Outcome, out: Path, inputs: Inputs, *, known: Collection[str] | None
) -> Record:
    """Write the files of a drawing, but not over ``inputs``, and return its record.

    ``known``: the names of files that the batch has made, which it may replace; None: it may replace any.
    """
    status, error, files = outcome.status, outcome.error, dict(outcome.files)
    try:
        for name, data in files.items():
            if known is not None and name not in known:
                _check_own(out / name, data)
            (out / name).parent.mkdir(parents=True, exist_ok=True)
        write_files({out / name: data for name, data in files.items()}, replace=True, inputs=inputs)
    except (OutputError, OSError) as problem:
        cause = problem if isinstance(problem, OSError) else problem.__cause__
        of_this_drawing = (errno.ENAMETOOLONG, errno.ENOTDIR, errno.EEXIST)
        at_fault = isinstance(cause, OSError) and cause.errno in of_this_drawing
        if not at_fault and not isinstance(problem, InputError | TakenError):
            raise  # the next drawing would meet it as well: a full disk, for example
        status, error, files = BAD_INPUT, str(problem), {}
    made = status == MADE
    return {
        "status": status,
        "method": outcome.method if made else "",
        "creases": outcome.creases if made else None,
        "folds": outcome.folds if made else None,
        "shortest_crease_mm": outcome.shortest_crease_mm if made else None,
        "off_by_mm": outcome.off_by_mm if made else None,
        "for_hands": outcome.for_hands if made else None,
        "difficulty": outcome.difficulty if made else "",
        "seconds": round(outcome.seconds, 3),
        "error": error,
        "outputs": {name: len(data) for name, data in files.items()},
        "sha256": digest,
        "thumbnail": asdict(outcome.thumbnail) if made and outcome.thumbnail is not None else None,
    }


def _check_own(path: Path, data: bytes) -> None:
    """Raise TakenError if there is a file that the batch cannot have written just before it was killed."""
    taken = False
    with suppress(OSError):  # writing says what is wrong with the path
        taken = path.is_file() and (path.stat().st_size != len(data) or path.read_bytes() != data)
    if taken:
        raise TakenError(f"cannot write {path}: it is there already; move it away and try again with --retry")


def _check_free(out: Path, items: Sequence[Item], recipe: Recipe, names: Sequence[str], *, replace: bool) -> None:
    """Raise OutputError if a new batch would replace a file without being asked to."""
    targets = [out / name for name in names]
    for item in items:
        for ending in recipe.endings:
            targets += [out / path for path in recipe.job.targets(Path(item.stem + ending), recipe.profile)]
    check_targets([target for target in targets if os.path.exists(target)], replace=replace)


def _extra(name: str) -> ModuleType:
    """Import a module of the extra ``batch``; raise BadInputError if it is not installed."""
    from importlib import import_module

    try:
        return import_module(name)
    except ModuleNotFoundError as error:
        raise BadInputError(f"this needs the extra 'batch' ({error.name}): pip install 'foldcut[batch]'") from None
