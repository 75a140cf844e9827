"""What ``make``, ``view``, ``draw`` and ``guide`` do alike: fold a drawing or open a pattern, write files, report."""

from __future__ import annotations

import dataclasses
import shlex
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from foldcut.cli.console import Console
from foldcut.cli.options import FoldRequest, OpenRequest, Request, Source
from foldcut.core.errors import BadInputError, FileFormatError, ShapeError, UnfoldableError
from foldcut.core.files import hash_of

if TYPE_CHECKING:
    from foldcut.cli.outputs import MadeFor
    from foldcut.foldfile.reopen import Reopened
    from foldcut.output.atomic import Inputs
    from foldcut.output.recipe import Recipe
    from foldcut.pipeline import Result
    from foldcut.redraw.ladder import Level

NOT_VERIFIED = "nothing is written"
"""What an error says beside the findings: no file is written for a pattern that is not verified."""


def fold_or_open(request: Request, console: Console, targets: Iterable[Path]) -> Result | Reopened:
    """Return the pattern of a drawing, or the one that was folded already."""
    return opened(request) if isinstance(request, OpenRequest) else folded(request, console, targets)


def folded(request: FoldRequest, console: Console, targets: Iterable[Path]) -> Result:
    """Read a drawing and fold it, with progress on stderr.

    ``targets``: the files that will be written; the patterns so far may go into none of them.
    """
    from foldcut import pipeline
    from foldcut.cli.progress import ProgressLines, progress_for
    from foldcut.output.atomic import Inputs, check_targets

    if request.so_far is not None:
        check_targets([*targets, request.so_far], replace=True, inputs=Inputs(request.source.files()))
    with progress_for(console) as bar:
        progress = ProgressLines(sys.stderr) if request.progress_lines else bar

        def found(level: Level) -> None:
            if request.so_far is not None:
                _write_so_far(request, request.so_far, level)
            progress.found(level)

        drawing = request.source.read(request.reading)
        try:
            return pipeline.fold(drawing, request.folding, progress=progress, on_pattern=found)
        except ShapeError as error:
            if request.source.text is not None:
                raise
            raise ShapeError(f"{request.source.path}: {error}") from error
        except UnfoldableError as error:
            if request.source.is_word:
                error.args = (f"{error}; or fold the letters one by one: {one_by_one(request.source)}",)
            raise


def _write_so_far(request: FoldRequest, path: Path, level: Level) -> None:
    """Write a verified pattern while better ones are looked for."""
    from foldcut.exporters import export
    from foldcut.output.atomic import Inputs, write_files

    assert level.pattern is not None
    data = export(level.pattern, path.suffix.lower())
    write_files({path: data}, replace=True, inputs=Inputs(request.source.files()))


def one_by_one(source: Source) -> str:
    """Return the command that folds each letter of a text on a sheet of its own."""
    font = "" if source.font == "sans" else f" --font {shlex.quote(source.font)}"
    return f"foldcut batch --text {shlex.quote(source.text or '')}{font} -o letters"


def opened(request: OpenRequest) -> Reopened:
    """Open a FOLD file that foldcut wrote, and verify it anew."""
    from foldcut.foldfile.read import read_fold_apart
    from foldcut.foldfile.reopen import reopen

    try:
        return reopen(read_fold_apart(request.source.path))
    except FileFormatError:
        raise
    except BadInputError as error:
        raise BadInputError(f"{request.source.path}: {error}") from None


def recipe_of(recipe: Recipe, request: Request, result: Result | Reopened) -> Recipe:
    """Return a recipe with the hash of the drawing, or of the pattern, that the result was made of."""
    from foldcut.foldfile.reopen import Reopened

    if isinstance(result, Reopened):
        return dataclasses.replace(recipe, sha256=hash_of(request.source.path))
    return dataclasses.replace(recipe, sha256="" if result.drawing is None else result.drawing.sha256)


def fold_and_write(
    request: Request,
    output: Path,
    content: Callable[[Result | Reopened], bytes],
    console: Console,
    recipe: Recipe,
    *,
    replace: bool,
) -> int:
    """Fold a drawing, or open a pattern, and write one file about it; return the exit status."""
    from foldcut.jobs.last_door import check_pattern
    from foldcut.output.atomic import Inputs, check_targets

    inputs = Inputs(request.source.files())
    check_targets([output], replace=replace, inputs=inputs)
    result = fold_or_open(request, console, [output])
    if not result.verified:
        return write_and_report(result, {}, console, replace=replace, inputs=inputs)
    check_pattern(result.folded_pattern)
    data = recipe_of(recipe, request, result).put_into(content(result), output.name, output.name)
    return write_and_report(result, {output: data}, console, replace=replace, inputs=inputs)


def write_and_report(
    result: Result | Reopened,
    contents: Mapping[Path, bytes],
    console: Console,
    *,
    replace: bool,
    inputs: Inputs,
    made: Sequence[MadeFor] = (),
) -> int:
    """Write the files of a verified result and print its report; return the exit status.

    ``inputs`` are not replaced. ``made``: the machines that there are files for, and their jobs.
    """
    from foldcut.cli import report
    from foldcut.exporters.recipe_place import NO_PLACE
    from foldcut.foldfile.reopen import Reopened
    from foldcut.output.atomic import write_files

    files: list[dict[str, Any]] = [
        {"path": str(p), "bytes": len(data), "replaced": p.exists(), "no_recipe": NO_PLACE.get(p.suffix.lower())}
        for p, data in contents.items()
    ]
    write_files(contents, replace=replace, inputs=inputs)
    if isinstance(result, Reopened):
        told = report.reopened_report(result, files, made)
        return console.verdict(told, report.reopened_lines(told), result.findings, NOT_VERIFIED)
    told = report.make_report(result, files, made)
    return console.verdict(told, report.make_lines(told), result.findings, NOT_VERIFIED)
