"""Device and layout profiles: one TOML file each, read into a frozen dataclass.

A profile holds what an exporter must not decide: colours, line widths, dash lengths, sizes of the legend.
Names end in their unit. A key that is missing, unknown or of the wrong kind is an error.
"""

from __future__ import annotations

import dataclasses
import re
import tomllib
from functools import cache
from importlib import resources

from foldcut.errors import FileFormatError


@dataclasses.dataclass(frozen=True)
class Profile:
    """How a drawing looks: colours as ``#rrggbb``, lengths in mm."""

    mountain_colour: str
    valley_colour: str
    border_colour: str
    shape_colour: str
    legend_colour: str
    crease_stroke_mm: float
    border_stroke_mm: float
    shape_stroke_mm: float
    legend_stroke_mm: float
    dash_mm: float
    gap_mm: float
    dot_mm: float
    text_mm: float
    inset_mm: float
    sample_mm: float
    ruler_mm: float
    small_ruler_mm: float
    small_sheet_mm: float


def parse_profile(text: str, name: str) -> Profile:
    """Read a profile from TOML text; ``name`` is what errors call it.

    Raises FileFormatError: the text is no TOML, or a key is missing, unknown or of the wrong kind.
    """
    try:
        values = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise FileFormatError(f"profile {name} is not valid TOML: {error}") from error
    known = {field.name for field in dataclasses.fields(Profile)}
    if unknown := sorted(values.keys() - known):
        raise FileFormatError(f"profile {name} has unknown keys: {', '.join(unknown)}; remove or correct them")
    if missing := sorted(known - values.keys()):
        raise FileFormatError(f"profile {name} lacks the keys: {', '.join(missing)}; add them")
    for key, value in values.items():
        _check_value(name, key, value)
    return Profile(**values)


@cache
def load_profile(name: str = "plain") -> Profile:
    """Return the profile ``name`` that comes with foldcut.

    Raises FileFormatError: there is no such profile, or it is not valid.
    """
    folder = resources.files(__package__)
    names = sorted(entry.name[:-5] for entry in folder.iterdir() if entry.name.endswith(".toml"))
    if name not in names:
        raise FileFormatError(f"there is no profile {name!r}; choose one of {', '.join(names)}")
    return parse_profile(folder.joinpath(f"{name}.toml").read_text("utf-8"), name)


def _check_value(name: str, key: str, value: object) -> None:
    """Raise unless ``value`` is what the key's ending promises."""
    if key.endswith("_colour"):
        if not (isinstance(value, str) and re.fullmatch("#[0-9a-f]{6}", value)):
            raise FileFormatError(f"profile {name}: {key} = {value!r} is no colour; write it as #rrggbb")
    elif isinstance(value, bool) or not (isinstance(value, int | float) and 0 < value < float("inf")):
        raise FileFormatError(f"profile {name}: {key} = {value!r} is no length; give a number of mm above 0")
