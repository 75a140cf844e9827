"""What the page sends -> words of the command line.

Every value is one of a list that is known here, or a sheet, a length or a text that is checked, so no request can name
a file of the server or slip in another option.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from functools import cache
from typing import get_args

from foldcut.core.units import parse_length
from foldcut.drawing.placement import parse_sheet
from foldcut.exporters import JOB_EXPORTERS
from foldcut.jobs.marks import MARKS
from foldcut.profiles import Treatment, known_profiles, load_profile
from foldcut.readers.folding_font import NAME as FOLDING_FONT
from foldcut.readers.typed_text import font_families
from foldcut.redraw.bounds import LEVELS, SMALL_PARTS
from foldcut.samples import sample_names
from foldcut.web.errors import RefusedError

__all__ = ["Wanted", "fonts", "machines", "read_query", "require_known"]

EFFORTS = ("fast", "normal")
"""How long to search: the command line's "best" takes longer than people wait for a page."""
LENGTHS = ("margin", "tolerance", "simplify", "min-crease", "symmetry", "ribbon")
"""The options whose value is a length."""
MOST_FOLDS = 10_000
"""The largest number of folds that can be asked for."""
LONGEST_NAME = 50
"""Letters of a drawing's name that its files have: the longest name of a file has 255 bytes."""
LONGEST_TEXT = 100
"""Letters that a text may have."""


@dataclass(frozen=True)
class Wanted:
    """What the page asks for, as words of ``foldcut make``.

    ``source``: the sample or the text, empty where a drawing is uploaded; ``options``: sheet, lengths and effort;
    ``machine``: the profile and how to use it, empty for none, and ``machine_format``, the ending of its files without
    the dot; ``quick``: a look at a drawing that is still being changed; ``name``: what the drawing and its files are
    called.
    """

    source: tuple[str, ...]
    options: tuple[str, ...]
    machine: tuple[str, ...] = ()
    machine_format: str = ""
    quick: bool = False
    name: str = "drawing"


def read_query(query: Mapping[str, str], *, uploaded: bool) -> Wanted:
    """Return what the parameters of a request ask for; ``uploaded``: the drawing comes as the request's body.

    Raises ``RefusedError`` for an unknown name, and ``BadInputError`` for a sheet or a length that cannot be read.
    """
    machine, machine_format = _machine(query)
    source = () if uploaded else _source(query)
    return Wanted(source, _options(query), machine, machine_format, "quick" in query, _name(query))


def _name(query: Mapping[str, str]) -> str:
    """Return what to call a drawing: letters, digits and a few signs of its own name, so that it can name files."""
    wished = query.get("name") or query.get("sample") or query.get("text") or ""
    kept = "".join(letter if letter.isalnum() or letter in " ._-()" else "-" for letter in wished)
    return kept[:LONGEST_NAME].strip(" .-") or "drawing"


def _source(query: Mapping[str, str]) -> tuple[str, ...]:
    """Return the words that name a sample or a text."""
    if sample := query.get("sample"):
        return (require_known(sample, "sample", sample_names()),)
    text, font = query.get("text", ""), query.get("font", "")
    if not text.isprintable() or not 0 < len(text.strip()) <= LONGEST_TEXT:
        raise RefusedError(400, f"give a text of 1 to {LONGEST_TEXT} letters")
    return (f"--text={text}", f"--font={require_known(font, 'font', fonts())}")


def _options(query: Mapping[str, str]) -> tuple[str, ...]:
    """Return the words for sheet, effort, how near the outline stays to the drawing, and lengths."""
    sheet, effort = query.get("sheet", "a4"), query.get("effort", "normal")
    parse_sheet(sheet)
    lengths = {name: query[name] for name in LENGTHS if query.get(name)}
    near = ["--open"] if query.get("open") else []
    if level := query.get("level", ""):
        near += ["--level", require_known(level, "level", tuple(LEVELS))]
    if parts := query.get("small-parts", ""):
        near += ["--small-parts", require_known(parts, "treatment of small parts", SMALL_PARTS)]
    if folds := query.get("folds", ""):
        if not folds.isascii() or not folds.isdigit() or not 0 < int(folds[:9]) <= MOST_FOLDS:
            raise RefusedError(400, f"give a number of folds from 1 to {MOST_FOLDS}")
        near += ["--folds", folds]
    return (
        *("--sheet", sheet, "--effort", "fast" if "quick" in query else require_known(effort, "effort", EFFORTS)),
        *near,
        *(f"--{name}={parse_length(length)!r}mm" for name, length in lengths.items()),
    )


def _machine(query: Mapping[str, str]) -> tuple[tuple[str, ...], str]:
    """Return the words for a machine, its material, how it makes creases, and marks; and the format of its files."""
    name = query.get("profile", "")
    if not name:
        return (), ""
    words = ["--profile", require_known(name, "machine", machines())]
    profile = load_profile(name)
    if material := query.get("material", ""):
        words += ["--material", require_known(material, "material", tuple(profile.materials))]
    if treatment := query.get("treatment", ""):
        words += ["--treatment", require_known(treatment, "treatment", get_args(Treatment))]
    if marks := query.get("marks", ""):
        known = ("none", *MARKS)
        words += ["--marks", ",".join(require_known(mark, "mark", known) for mark in marks.split(","))]
    return tuple(words), profile.format


def require_known(name: str, what: str, names: Collection[str]) -> str:
    """Return a name that is one of a list; raises ``RefusedError`` for any other."""
    if name not in names:
        raise RefusedError(400, f"there is no {what} {name!r}; choose one of the list")
    return name


@cache
def machines() -> tuple[str, ...]:
    """Return the names of the profiles that jobs are made for."""
    profiles, _ = known_profiles()
    return tuple(name for name, p in profiles.items() if p.operations and f".{p.format}" in JOB_EXPORTERS)


@cache
def fonts() -> tuple[str, ...]:
    """Return the fonts that a text may have; only foldcut's own where the system cannot list its fonts."""
    families = font_families()
    return ("sans", "serif", "monospace", FOLDING_FONT, *families) if families else (FOLDING_FONT,)
