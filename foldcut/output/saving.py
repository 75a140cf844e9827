"""The files that a program saves: the same bytes that the command line writes for the same options.

A ``FoldedPattern``, the name of a file and a machine -> the names and bytes of files. Nothing is written here.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

from foldcut.core.errors import BadInputError
from foldcut.core.files import hash_of
from foldcut.core.model import FoldedPattern, Sheet
from foldcut.drawing.placement import parse_sheet
from foldcut.exporters import check_suffix
from foldcut.output.recipe import Recipe
from foldcut.output.render import JobOptions, Maker
from foldcut.profiles import Profile, load_profile

__all__ = ["USUAL_MACHINES", "guide_exporter", "guide_file", "letter_is_usual", "pattern_files", "usual_machine"]

USUAL_MACHINES = {".dxf": ("laser-dxf",), ".pdf": ("printer-a4", "printer-letter", "print-shop-a3")}
"""The profiles for files with these endings when no machine is named; among printers the one for the sheet is taken."""

LETTER_COUNTRIES = frozenset(("BZ", "CA", "CL", "CO", "CR", "GT", "MX", "NI", "PA", "PH", "PR", "SV", "US", "VE"))
"""Where letter paper is usual: Unicode CLDR, supplemental data, paperSize US-Letter."""


def usual_machine(ending: str, sheet: Sheet | str) -> str:
    """Return the machine for an ending: of several the one for the sheet, or for the paper of the user's country.

    ``sheet``: what is asked for, "" if nothing is.
    """
    names = USUAL_MACHINES[ending]
    usual = "letter" if letter_is_usual() else "a4"
    wanted = sheet if isinstance(sheet, Sheet) else parse_sheet(sheet or usual)
    for name in names:
        own = parse_sheet(load_profile(name).sheet)
        if sorted((own.width, own.height)) == sorted((wanted.width, wanted.height)):
            return name
    return names[1] if len(names) > 1 and letter_is_usual() else names[0]


def letter_is_usual() -> bool:
    """Whether letter paper is usual where the user lives, by the locale."""
    locale = next((os.environ[name] for name in ("LC_ALL", "LC_PAPER", "LANG") if os.environ.get(name)), "")
    return locale.partition(".")[0].partition("_")[2] in LETTER_COUNTRIES


def pattern_files(
    pattern: FoldedPattern,
    path: Path,
    recipe: Recipe | None,
    sheet: Sheet | str,
    machine: str | Profile | None = None,
    job: JobOptions | None = None,
) -> dict[Path, bytes]:
    """Return the files that ``path`` stands for, with how they are made, if ``recipe`` says it.

    ``machine``: whom they are for, by name; a profile itself may have been changed, so that no recipe says how its
    files are made. ``sheet``: what was asked for. Errors as of the exporters.
    """
    ending = path.suffix.lower()
    if machine is None and ending in USUAL_MACHINES:
        machine = usual_machine(ending, sheet)
    profile = load_profile(machine) if isinstance(machine, str) else machine
    with_jobs = profile is not None and bool(profile.operations)
    if job is not None and not with_jobs:
        raise BadInputError(f"{path}: its job needs a machine; name one, such as profile='laser-dxf'")
    job = job or JobOptions()
    check_suffix(path.suffix, profile if with_jobs else None, profile, pattern.sheet)
    if recipe is not None and machine is not None:
        recipe = None if isinstance(machine, Profile) else _with_machine(recipe, machine, job)
    return Maker(pattern, profile, job, recipe).named_files(path)


def _with_machine(recipe: Recipe, machine: str, job: JobOptions) -> Recipe:
    """Return a recipe with the machine and what is asked of its job."""
    own = Path(machine)
    is_file = machine.endswith(".toml") and own.is_file()
    words = (f"--profile={own.name if is_file else machine}", *job.words())
    return recipe.also(words, {"--profile": hash_of(own)} if is_file else {})


def guide_exporter(path: Path) -> Callable[[FoldedPattern], bytes]:
    """Return what makes a guide in the format that a name's ending says; raises ``BadInputError`` for other endings."""
    from foldcut.exporters.pictures.guide import GUIDES

    export = GUIDES.get(path.suffix.lower())
    if export is None:
        raise BadInputError(
            f"{path}: guides are PDF, HTML or animated SVG; give a name that ends in {', '.join(GUIDES)}"
        )
    return export


def guide_file(pattern: FoldedPattern, path: Path, recipe: Recipe | None) -> bytes:
    """Return how a person folds a pattern, as the name's ending says; raises ``BadInputError`` for other endings."""
    data = guide_exporter(path)(pattern)
    return data if recipe is None else recipe.put_into(data, path.name, path.name)
