"""``foldcut make FILE --again``: make a file that foldcut wrote once more, from the recipe in it.

The recipe is found, the drawing is looked for and its hash compared, the command is run in a temporary folder, and what
it wrote is compared with the file. Files are written only where there was none, or where the user says so.
"""

from __future__ import annotations

import hashlib
import io
import os
import tempfile
from argparse import Namespace
from collections.abc import Iterator
from contextlib import redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from foldcut.cli import options
from foldcut.cli.commands import load
from foldcut.cli.console import DONE
from foldcut.cli.parser import Parser, parse
from foldcut.core.errors import BadInputError, FileFormatError
from foldcut.core.files import hash_of, is_standard_input, read_bytes

if TYPE_CHECKING:
    from foldcut.output.recipe import Recipe

REPEATED = ("make", "view", "draw", "guide", "coupon", "solve")
"""The commands that a recipe may have."""
LARGEST = 2**29
"""A file that is made again has no more bytes than this."""
NEVER = ("-o", "--output", "--force", "--preview", "--so-far", "--again", "--timeout", "--json", "--quiet")
"""Options that no recipe has: they say where files go, or how to report."""


def make_again(args: Namespace) -> int:
    """Make a file again; say whether it is the same, and write what is missing."""
    from foldcut.output.atomic import Inputs, write_files
    from foldcut.output.recipe import version_now

    path, given = asked(args)
    recipe = recipe_of(path)
    if given and not recipe.drawing:
        raise BadInputError(f"{path} was made of no drawing; leave {given} out")
    if recipe.command == "solve" and not recipe.drawing:
        raise BadInputError(
            f"{path} was made of standard input, whose hash it does not have; give the pattern and its options "
            f"instead: {recipe.lines()[0].partition(': ')[2]}"
        )
    drawing = None if not recipe.drawing else found_drawing(recipe, path, given)
    with tempfile.TemporaryDirectory(prefix="foldcut-") as folder:
        made = run(recipe, drawing, path, Path(folder))
    if made is None:
        return 1
    now = version_now()
    other = f"made with foldcut {recipe.version}, and this is {now}" if recipe.version != now else ""
    own = made.pop(recipe.file, None)
    if own is None:
        raise BadInputError(f"{path}: its recipe makes no file {recipe.file}, but {', '.join(made) or 'none'}")
    same = own == path.read_bytes()
    target = path if args.output is None else Path(args.output[0])
    contents = {} if same and target == path else {target: own}
    beside = {path.parent / name: data for name, data in made.items()} if args.output is None else {}
    there = [place for place in beside if place.exists()]
    changed = [place for place in there if not place.is_file() or place.read_bytes() != beside[place]]
    contents |= {place: data for place, data in beside.items() if place not in there}
    if not same and target == path and not args.force:
        reason = other or "it was changed since, or the computer or its libraries are others"
        raise BadInputError(
            f"{path} is not what its recipe makes here: {reason}; write what it makes beside it with -o NAME, or "
            "replace it with --force"
        )
    files = [{"path": str(name), "bytes": len(data), "replaced": name.exists()} for name, data in contents.items()]
    inputs = Inputs([*([] if drawing is None else [drawing.path]), *files_beside(recipe, path)])
    for place in changed:
        inputs.refuse(place)
    if changed and not args.force:
        names = " and ".join(map(str, changed))
        have, them = ("has", "it") if len(changed) == 1 else ("have", "them")
        raise BadInputError(
            f"{path} is the same, but {names} beside it, made by the same command, {have} other bytes; move "
            f"{them} away to have {them} made again, or use --force, which replaces only {path.name}"
        )
    write_files(contents, replace=args.force, inputs=inputs)
    report = {"ok": True, "again": str(path), "same": same, "foldcut": recipe.version, "files": files}
    report["changed"] = list(map(str, changed))
    report |= {"made": recipe.lines()[0], "drawing": None if drawing is None else str(drawing.path)}
    lines = [
        str(path),
        f"  made      {recipe.lines()[0]}",
        *([f"  drawing   {drawing.path}, the same bytes"] if drawing else []),
        *([f"  warning   {other}"] if other else []),
        *(f"  warning   {place}, which the same command makes, has other bytes and is left" for place in changed),
        f"  again     {'the same bytes' if same else 'other bytes'}, {len(own):,} of them",
        *(f"  written   {file['path']} ({file['bytes']:,} bytes)" for file in files),
    ]
    options.console(args).report(report, lines)
    return DONE


def asked(args: Namespace) -> tuple[Path, str]:
    """Return the file to make again, and the drawing that the user gives for it, or ""."""
    given = args.again
    shape = args.shape or given
    if not shape:
        raise BadInputError("--again makes a file again that foldcut wrote: foldcut make FILE --again [DRAWING]")
    given = given if args.shape else ""
    groups = (options.add_source, options.add_folding, options.add_machine, options.add_solid)
    wrong = [name for add in groups for name in options.given(args, add) if name not in ("--shape", "--progress")]
    wrong += ["--so-far"] if args.so_far is not None else []
    wrong += ["--preview"] if args.preview else []
    if wrong:
        raise BadInputError(f"{', '.join(wrong)}: --again takes all options from the file; leave them out")
    path = Path(shape)
    if not path.is_file():
        what = "is a folder; give a file in it" if path.is_dir() else "there is no such file"
        raise BadInputError(f"{path}: {what}; --again needs a file that foldcut wrote")
    if args.output is not None and len(args.output) > 1:
        raise BadInputError("--again makes one file; give one -o")
    if args.output is not None and Path(args.output[0]).suffix.lower() != path.suffix.lower():
        raise BadInputError(f"{args.output[0]}: --again makes a {path.suffix} file; give a name that ends in it")
    return path, given


def recipe_of(path: Path) -> Recipe:
    """Return the recipe in a file; raises FileFormatError: there is none, or it is damaged or asks for other things."""
    from foldcut.exporters.recipe_place import NO_PLACE, recipe_in
    from foldcut.output.recipe import read_recipe

    suffix = path.suffix.lower()
    data = read_bytes(path, LARGEST)
    if len(data) > LARGEST:
        raise FileFormatError(f"{path} has more than {LARGEST / 2**20:g} MiB; give a file that foldcut wrote")
    text = recipe_in(data, suffix)
    if not text:
        why = "foldcut did not write it, or it has several drawings, or a program has saved it since"
        if suffix in NO_PLACE:
            why = f"{NO_PLACE[suffix]}; give another file that was made with it, or give the drawing and its options"
        raise FileFormatError(f"{path} has no recipe: {why}")
    try:
        recipe = read_recipe(text)
        check(recipe)
    except FileFormatError as error:
        raise FileFormatError(f"{path}: {error}; give the drawing and its options instead") from None
    return recipe


def check(recipe: Recipe) -> None:
    """Raise FileFormatError unless a recipe, which anybody may have written, reads and writes only what it may."""
    names = [recipe.drawing, recipe.output, recipe.file]
    if recipe.command not in REPEATED or not recipe.output or not all(map(is_name, filter(None, names))):
        raise FileFormatError("its recipe is damaged")
    parser = Parser(add_help=False)
    load(recipe.command).add_options(parser)
    known = {*parser.option_strings()} - {*NEVER}  # whole names: argparse would take a part of one
    for word in recipe.options:
        name, _, value = word.partition("=")
        if name not in known or (name in options.FILES_OF and not is_name(value)) or "\0" in word:
            raise FileFormatError(f"its recipe has {word!r}, which no recipe has")


def is_name(text: str) -> bool:
    """Whether a text is the name of a file, without a folder."""
    try:
        os.fsencode(text)
    except UnicodeEncodeError:
        return False
    return Path(text).name == text and text != ".." and "\0" not in text


@dataclass(frozen=True)
class Found:
    """The drawing of a recipe: its ``path``, "-" for standard input, and its bytes."""

    path: Path
    data: bytes


def found_drawing(recipe: Recipe, path: Path, given: str) -> Found:
    """Return the drawing of a recipe: the one that is given, or else beside the file, or else a sample.

    Raises BadInputError: there is none, or it has changed.
    """
    candidates = [options.named_source(given).path] if given else list(places(recipe, path))
    for place in candidates:
        data = read_bytes(place, LARGEST)
        if hashlib.sha256(data).hexdigest() == recipe.sha256:
            return Found(place, data)
    if candidates:
        name = "standard input" if is_standard_input(candidates[0]) else candidates[0]
        other = "is another drawing, or has changed" if given else "has changed"
        raise BadInputError(
            f"{name} {other} since {path} was made of it; give the drawing as it was: foldcut make {path} "
            f"--again DRAWING, or make a new file: {recipe.lines()[0].partition(': ')[2]}"
        )
    raise BadInputError(
        f"{recipe.drawing}, which {path} was made of, is not beside it; say where it is: foldcut make {path} "
        "--again DRAWING"
    )


def places(recipe: Recipe, path: Path) -> Iterator[Path]:
    """Yield files that may be the drawing of a recipe."""
    from foldcut.samples import sample_names, sample_path

    for place in (path.parent / recipe.drawing, Path(recipe.drawing)):
        if place.is_file() and not place.samefile(path):
            yield place
    stem = Path(recipe.drawing).stem
    if stem in sample_names(lines=True) and sample_path(stem).name == recipe.drawing:
        yield sample_path(stem)


def files_beside(recipe: Recipe, path: Path) -> list[Path]:
    """Return the other files that a recipe names, which have to be beside its file: a profile, a font."""
    parted = (word.partition("=") for word in recipe.options)
    return [path.parent / value for name, _, value in parted if name in recipe.hashes and name in options.FILES_OF]


def run(recipe: Recipe, drawing: Found | None, path: Path, folder: Path) -> dict[str, bytes] | None:
    """Run the command of a recipe in a folder; return what it wrote, by name, or None if it is not verified."""
    into, out = folder / "in", folder / "out"
    into.mkdir()
    out.mkdir()
    words = [recipe.command]
    if drawing is not None:
        (into / recipe.drawing).write_bytes(drawing.data)
        words.append(str(into / recipe.drawing))
    for word in recipe.options:
        name, _, value = word.partition("=")
        if name in recipe.hashes and name in options.FILES_OF:
            beside = path.parent / value
            if not beside.is_file() or hash_of(beside) != recipe.hashes[name]:
                state = "has changed since" if beside.is_file() else "is not there"
                raise BadInputError(f"{beside}, for {name} of {path}, {state}; put it there as it was")
            (into / value).write_bytes(beside.read_bytes())
            word = f"{name}={into / value}"
        words.append(word)
    command, args = parse([*words, "-o", str(out / recipe.output), "--quiet"])
    with redirect_stdout(io.StringIO()):
        if command.run(args) != DONE:
            return None
    return {written.name: written.read_bytes() for written in sorted(out.iterdir())}
