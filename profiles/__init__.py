"""Device profiles: one TOML file for each machine, read into one schema.

A profile holds what an exporter must not decide: the size of the bed, colours, layers, pens, speeds, dashes. The names
of quantities end in their unit. ``base`` lists files in ``base/`` whose tables a profile extends. Every number has a
source: an entry in ``sources`` for its key or for a table around it. Unknown, missing and wrong keys are errors.
"""

from __future__ import annotations

import difflib
import math
import os
import tomllib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator
from pydantic_core import PydanticCustomError

from foldcut.core.errors import FileFormatError
from foldcut.core.files import read_bytes
from foldcut.core.text import is_control

Colour = Annotated[str, Field(pattern="^#[0-9a-f]{6}$")]
Millimetres = Annotated[float, Field(ge=0.001, le=100_000)]
"""A length: from a micrometre, finer than any machine, to the longest sheet that there is."""
Dashing = Annotated[float, Field(ge=0.01, le=1000)]
"""A length of which there are as many as find room on a crease."""
Speed = Annotated[float, Field(ge=0.01, le=10_000)]
"""In mm/s."""
Height = Annotated[float, Field(ge=-1000, le=1000)]
"""Where a pen is on the Z axis, in mm."""
Count = Annotated[int, Field(ge=0, le=1_000_000)]
"""A number of a plotter's units, or of steps of a servo or of a laser's power."""

Role = Literal["mark", "mountain", "valley", "cut"]
"""What the lines of a step are: marks, creases of either kind, or the outline of the sheet."""

Treatment = Literal["score", "perforate", "draw"]
"""What is made of a crease: an unbroken line, a row of cuts, or the dashes of the origami notation."""

Action = Literal["mark", "score", "perforate", "draw", "cut"]
"""What is done with the lines of a step: marks are marked, creases treated, and the outline of the sheet is cut."""

Registration = Literal["jig", "corners", "holes", "pins"]
"""What lines the back up with the front: the hole that the sheet was cut out of, marks in the corners, holes for pegs,
or pinholes."""

MarkName = Literal["outline", "first-folds", "cut-line", "numbers", "title", "ruler"]
"""The marks that a job can have."""

LARGEST = 2**20
"""A profile has no more bytes than this."""

UNITS = {"_mm_s2": "mm/s2", "_mm_s": "mm/s", "_mm": "mm", "_s": "s", "_g": "g", "_percent": "%", "_units": "units"}
"""The units that the names of quantities end in."""

DEEPEST = 8
"""A key of a profile has no more parts between dots than this."""

SHOWN = 100
"""How much of an override an error shows."""

TOO_LARGE = "a number has thousands of digits, or brackets are nested too deep; write it in a shorter way"
"""What is wrong with numbers and brackets that Python gives up on."""

UNVERIFIED = "unverified"
"""A source begins with this word if nobody has compared its number with what the machine's maker says."""


class _Table(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", strict=False)


class LineStyle(_Table):
    """How the lines and words of a drawing look: colours as ``#rrggbb``, lengths in mm; the table ``drawing``."""

    mountain_colour: Colour
    valley_colour: Colour
    border_colour: Colour
    shape_colour: Colour
    legend_colour: Colour
    crease_stroke_mm: Millimetres
    border_stroke_mm: Millimetres
    shape_stroke_mm: Millimetres
    legend_stroke_mm: Millimetres
    dash_mm: Dashing
    gap_mm: Dashing
    dot_mm: Dashing
    text_mm: Millimetres
    inset_mm: Millimetres
    sample_mm: Millimetres
    ruler_mm: Millimetres
    small_ruler_mm: Millimetres
    small_sheet_mm: Millimetres


class Bed(_Table):
    """The area that the machine reaches, and the corner where the sheet is put."""

    width_mm: Millimetres
    height_mm: Millimetres
    origin: Literal["lower-left", "upper-left"] = "lower-left"


class Operation(_Table):
    """What the machine calls the lines of a role, their colour, and the pen or tool that makes them."""

    # the letters and the length that DXF allows
    layer: Annotated[str, Field(max_length=60, pattern=r'^[^<>/\\":;?*|=`\x00-\x1f]+$')]
    colour: Colour
    pen: Annotated[int, Field(ge=1, le=8)] | None = None


class Setting(_Table):
    """Speed, a laser's power in percent of its maximum or a blade's force in grams, and the number of passes."""

    speed_mm_s: Speed
    power_percent: Annotated[float, Field(ge=0, le=100)] | None = None
    force_g: Annotated[float, Field(gt=0, le=5000)] | None = None
    passes: Annotated[int, Field(ge=1, le=20)] = 1


class Dash(_Table):
    """A perforation: cuts and gaps in turn; ``clearance_mm``: the distance of cuts from the ends of a crease."""

    dash_mm: Dashing
    gap_mm: Dashing
    clearance_mm: Annotated[float, Field(ge=0, le=1000)]


class Material(_Table):
    """What a sheet is made of: its thickness, its perforations, and the machine's settings, if it has any.

    ``web_mm``: how much paper stays between the cuts of two creases, beside the kerf.
    """

    thickness_mm: Millimetres
    web_mm: Annotated[float, Field(ge=0, lt=10)] = 0.0
    mountain: Dash
    valley: Dash
    mark: Setting | None = None
    score: Setting | None = None
    perforate: Setting | None = None
    cut: Setting | None = None


class Hpgl(_Table):
    """The size of a plotter's unit of length, and how it changes its tool.

    ``tools``: "select" if the machine obeys SP and changes the tool itself; "separate" if every tool gets a file of its
    own, since the machine has one holder and takes no notice of SP. ``pause``: an instruction on which the machine
    waits before it goes on with another tool, such as "NR;"; none if empty.
    """

    unit_mm: Annotated[float, Field(ge=0.001, le=1)]
    tools: Literal["select", "separate"] = "select"
    pause: Annotated[str, Field(pattern="^([A-Z!][^;]*;)?$")] = ""


class Paper(_Table):
    """A paper of a plotter: its size as it lies, and the part of it that the pen reaches.

    ``origin_x_mm``, ``origin_y_mm``: where the plotter's (0, 0) is, from the paper's lower left corner; ``x_units``,
    ``y_units``: the hard-clip limits, from there; ``set_ps``: the number that the instruction PS selects it by;
    ``final_x_units``, ``final_y_units``: where the pen goes at the end, out of the way.
    """

    width_mm: Millimetres
    height_mm: Millimetres
    origin_x_mm: Annotated[float, Field(ge=0, le=1000)]
    origin_y_mm: Annotated[float, Field(ge=0, le=1000)]
    x_units: Annotated[int, Field(gt=0, le=1_000_000)]
    y_units: Annotated[int, Field(gt=0, le=1_000_000)]
    set_ps: Annotated[int, Field(ge=0, le=127)] | None = None
    final_x_units: Count
    final_y_units: Count

    @model_validator(mode="after")
    def _ends_on_the_paper(self) -> Paper:
        """The pen stays where it can go."""
        if self.final_x_units > self.x_units or self.final_y_units > self.y_units:
            raise PydanticCustomError("paper", "the last place is beyond x_units and y_units")
        return self


class Blade(_Table):
    """A blade that trails its holder, and swivels round in corners.

    ``offset_mm``: how far it trails; cuts shorter than that are not given to it. ``overcut_mm``: how far a closed line
    is cut beyond its start. ``compensate``: whether foldcut leads the holder so that the blade follows the lines;
    otherwise the machine or its software does.
    """

    offset_mm: Annotated[float, Field(ge=0, lt=5)]
    overcut_mm: Annotated[float, Field(ge=0, lt=10)] = 0.0
    compensate: bool = False


class Solid(_Table):
    """The scored sheet as a solid: its thickness, and the width and depth of its grooves.

    ``groove``: what they look like, "v" or "u"; ``groove_angle_deg``: the angle of a V, which makes it as wide as it
    has to be. ``one_sided``: valleys have their grooves on top, too. ``folded``: not the flat sheet but the stack of
    its layers when it is folded, without grooves.
    """

    thickness_mm: Millimetres
    groove_width_mm: Millimetres
    groove_depth_mm: Millimetres
    groove: Literal["v", "u"] = "v"
    groove_angle_deg: Annotated[float, Field(ge=10, le=170)] | None = None
    one_sided: bool = False
    folded: bool = False

    @property
    def width_mm(self) -> float:
        """How wide the grooves are at the surface."""
        if self.groove == "u" or self.groove_angle_deg is None:
            return self.groove_width_mm
        return 2 * self.groove_depth_mm * math.tan(math.radians(self.groove_angle_deg) / 2)


class Page(_Table):
    """The margin that a printer leaves white, and how far the pages of a large sheet overlap."""

    margin_mm: Annotated[float, Field(ge=0, lt=50)]
    overlap_mm: Annotated[float, Field(ge=0, lt=50)]


class Gcode(_Table):
    """How the tool is switched on and off: a laser by its power, a pen by Z in mm or by a servo's S value.

    ``most_power``: the S value of full power, ``$30``. ``pen_up``, ``pen_down``: Z in mm, and ``plunge_mm_s`` how fast
    the pen goes down. ``servo_up``, ``servo_down``: S values, and ``dwell_s`` how long the servo takes to get there.
    """

    tool: Literal["laser", "z", "servo"]
    most_power: Annotated[int, Field(gt=0, le=1_000_000)] = 1000
    pen_up: Height = 5.0
    pen_down: Height = 0.0
    plunge_mm_s: Speed = 10.0
    servo_up: Count = 300
    servo_down: Count = 700
    dwell_s: Annotated[float, Field(ge=0, le=10)] = 0.25
    draw_mm_s: Speed = 40.0

    @model_validator(mode="after")
    def _moves(self) -> Gcode:
        """A pen that is where it was is never lifted."""
        if self.tool == "z" and self.pen_up <= self.pen_down:
            raise PydanticCustomError("pen", "pen_up has to be above pen_down, or the pen draws all the way")
        if self.tool == "servo" and self.servo_up == self.servo_down:
            raise PydanticCustomError("pen", "servo_up and servo_down are the same, so the pen would never move")
        return self


class Motion(_Table):
    """How fast a machine moves, which says how long a job takes.

    ``travel_mm_s``: how fast between strokes; ``work_mm_s``: how fast in strokes whose material has no speed;
    ``acceleration_mm_s2``: how fast it gets faster and slower; ``corner_mm``: how far its path may stray in a corner,
    by which GRBL and others say how fast it goes through (``$11``, junction deviation); ``lift_s``: how long it takes
    to put the tool down, and as long to lift it; 0 if it works without a stop.
    """

    travel_mm_s: Speed
    work_mm_s: Speed | None = None
    acceleration_mm_s2: Annotated[float, Field(ge=1, le=1_000_000)]
    corner_mm: Annotated[float, Field(ge=0, lt=10)] = 0.01
    lift_s: Annotated[float, Field(ge=0, le=10)] = 0.0


class Profile(_Table):
    """A machine, and how foldcut makes jobs for it.

    ``sheet``: what it is fed with unless another sheet is asked for. ``stroke_mm``: how wide lines are in its files.
    ``marks`` and ``registration``: those of its jobs unless others are asked for. ``instructions``: what the operator
    does; what each layer is for is said after the first of them, in the words of ``does``. ``palette``: the colours
    that its software tells apart, if these are few. ``pause_prefix``: what a layer's name begins with if the pen has
    to be changed before it.
    """

    title: str
    kind: Literal["laser", "cutter", "plotter", "printer", "software"]
    format: Literal["svg", "dxf", "hpgl", "gcode", "pdf", "stl", "lbrn2"]
    treatment: Treatment
    cut_outline: bool
    sheet: str = "a4"
    stroke_mm: Millimetres | None = None
    marks: tuple[MarkName, ...] = ()
    registration: Registration = "corners"
    kerf_mm: Annotated[float, Field(ge=0, lt=5)] = 0.0
    dxf_version: Literal["R12", "R2000"] = "R2000"
    instructions: Annotated[tuple[str, ...], Field(min_length=1)]
    does: dict[Action, str] = {}
    palette: tuple[Colour, ...] = ()
    pause_prefix: str = ""
    drawing: LineStyle
    bed: Bed | None = None
    papers: dict[str, Paper] = {}
    operations: dict[Role, Operation] = {}
    materials: dict[str, Material] = {}
    page: Page | None = None
    solid: Solid | None = None
    hpgl: Hpgl | None = None
    gcode: Gcode | None = None
    blade: Blade | None = None
    motion: Motion | None = None
    sources: dict[str, str]

    @property
    def draws(self) -> bool:
        """Whether the machine puts ink on the sheet, and neither scores nor cuts it."""
        return self.kind in ("plotter", "printer")

    @property
    def unverified(self) -> tuple[str, ...]:
        """The keys of the numbers that nobody has compared with what the machine's maker says."""
        return tuple(key for key, source in self.sources.items() if source.startswith(UNVERIFIED))

    @property
    def line_mm(self) -> float:
        """How wide lines are in the machine's files."""
        return self.stroke_mm or self.drawing.crease_stroke_mm


def profile_names() -> tuple[str, ...]:
    """Return the names of the profiles that come with foldcut or are in the user's folder, sorted."""
    folder = user_folder()
    users = [path.stem for path in folder.glob("*.toml")] if folder.is_dir() else []
    return tuple(sorted({*_names(resources.files(__package__).iterdir()), *users}))


def known_profiles() -> tuple[dict[str, Profile], dict[str, str]]:
    """Return all profiles by name, and of those that cannot be read, what is wrong with them."""
    known: dict[str, Profile] = {}
    broken: dict[str, str] = {}
    for name in profile_names():
        try:
            known[name] = load_profile(name)
        except FileFormatError as error:
            broken[name] = str(error)
        except OSError as error:
            broken[name] = f"profile {name}: {error.strerror}"
    return known, broken


def user_folder() -> Path:
    """Return the folder of the user's own profiles: ``foldcut/profiles`` in the configuration folder."""
    # "~" stays where nobody knows the home: then there is no such folder
    home = os.environ.get("XDG_CONFIG_HOME") or os.path.expanduser("~/.config")
    return Path(home) / "foldcut" / "profiles"


def load_profile(name: str = "plain", overrides: Sequence[str] = ()) -> Profile:
    """Return a profile by its name or by the path of a TOML file, with ``key=value`` overrides.

    Raises FileFormatError: there is no such profile, or the profile or an override is not valid.
    """
    return _parsed(_profile_text(name), name, tuple(overrides))


def parse_profile(text: str, name: str, overrides: Sequence[str] = ()) -> Profile:
    """Read a profile from TOML text; errors call it ``name``.

    Raises FileFormatError: the text is not TOML, a key is missing, unknown or wrong, or a number has no source.
    """
    return _parsed(text, name, tuple(overrides))


@cache
def _parsed(text: str, name: str, overrides: tuple[str, ...]) -> Profile:
    own = _toml(text, name)
    bases = own.pop("base", [])
    if not (isinstance(bases, list) and all(isinstance(base, str) for base in bases)):
        raise FileFormatError(f"profile {name}: base must be a list of names")
    values: dict[str, Any] = {}
    folder = resources.files(__package__) / "base"
    for base in bases:
        if base not in (known := _names(folder.iterdir())):
            raise FileFormatError(f"profile {name}: there is no base {base!r}; choose from {', '.join(sorted(known))}")
        values = _merged(values, _toml((folder / f"{base}.toml").read_text("utf-8"), base))
    values = _merged(values, own)
    for override in overrides:
        values = _merged(values, _override(override))
    try:
        profile = Profile.model_validate(values)
    except ValidationError as error:
        raise FileFormatError(f"profile {name}: {_explained(error)}") from error
    for place, text in _texts(values):
        if any(map(is_control, text)):
            raise FileFormatError(f"profile {name}: {place} has a control character or a line break; leave it out")
    changed = {override.partition("=")[0].strip() for override in overrides}
    for key in _numbers(values):
        around = [key.rsplit(".", n)[0] for n in range(key.count(".") + 1)]
        if not any(place in profile.sources for place in around) and key not in changed:
            raise FileFormatError(f"profile {name}: the number {key} has no source; add {key!r} to [sources]")
    return profile


def profile_file(name: str) -> Path:
    """Return the path of the user's own profile that goes by this name; there need be no such file."""
    path = Path(name)
    return path if path.suffix == ".toml" else user_folder() / f"{name}.toml"


def _profile_text(name: str) -> str:
    path, own = Path(name), profile_file(name)
    if own.is_file():
        data = read_bytes(own, LARGEST)
        if len(data) > LARGEST:
            raise FileFormatError(f"profile {own} has more than {LARGEST / 2**20:g} MiB; give a smaller one")
        try:
            return data.decode("utf-8")
        except UnicodeDecodeError as error:
            raise FileFormatError(f"profile {own} is not UTF-8 text") from error
    if path.suffix == ".toml":
        raise FileFormatError(f"there is no profile file {name}")
    known = profile_names()
    if name not in known:
        near = difflib.get_close_matches(name, known, 1)
        hint = f"; did you mean {near[0]}?" if near else f"; choose one of {', '.join(known)}"
        raise FileFormatError(f"there is no profile {name!r}{hint}")
    return resources.files(__package__).joinpath(f"{name}.toml").read_text("utf-8")


def _names(entries: Iterable[Any]) -> set[str]:
    return {entry.name[:-5] for entry in entries if entry.name.endswith(".toml")}


def _toml(text: str, name: str) -> dict[str, Any]:
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise FileFormatError(f"profile {name} is not valid TOML: {error}") from error
    except (ValueError, RecursionError):
        raise FileFormatError(f"profile {name}: {TOO_LARGE}") from None


def _override(text: str) -> dict[str, Any]:
    """Return the nested table that ``a.b=value`` means; a value that is not TOML is taken as text."""
    key, equals, value = text.partition("=")
    if not equals or not key.strip():
        said = " ".join(text.split())
        raise FileFormatError(f"--set {said} is no KEY=VALUE; write for example --set bed.width_mm=300")
    shown = text if len(text) <= SHOWN else f"{text[:SHOWN]}..."
    try:
        read = tomllib.loads(f"value = {value}")
        parsed: Any = read["value"] if len(read) == 1 else value
    except tomllib.TOMLDecodeError:
        parsed = value
    except (ValueError, RecursionError):
        raise FileFormatError(f"--set {shown}: {TOO_LARGE}") from None
    *tables, last = _split(key.strip())
    if len(tables) >= DEEPEST:
        raise FileFormatError(f"--set {shown}: a key has at most {DEEPEST} parts; foldcut profiles show has them all")
    nested: dict[str, Any] = {last: parsed}
    for table in reversed(tables):
        nested = {table: nested}
    return nested


def _split(key: str) -> list[str]:
    """Split a key at its dots; names in quotes keep theirs."""
    try:
        table: Any = tomllib.loads(f"{key} = 0")
    except (ValueError, RecursionError):  # what tomllib raises, or Python about long numbers and many brackets
        table = {}
    names = []
    while isinstance(table, dict) and len(table) == 1:
        name, table = next(iter(table.items()))
        names.append(name)
    if isinstance(table, dict):
        raise FileFormatError(f"--set {key}: this is no key; write for example bed.width_mm")
    return names


def _merged(one: Mapping[str, Any], other: Mapping[str, Any]) -> dict[str, Any]:
    """Return both tables merged; where both have a value, that of ``other`` counts."""
    merged = dict(one)
    for key, value in other.items():
        both = isinstance(value, dict) and isinstance(merged.get(key), dict)
        merged[key] = _merged(merged[key], value) if both else value
    return merged


def _numbers(values: Mapping[str, Any], prefix: str = "") -> Iterator[str]:
    """Yield the dotted keys of all numbers in a table."""
    for key, value in values.items():
        if isinstance(value, dict):
            yield from _numbers(value, f"{prefix}{key}.")
        elif isinstance(value, int | float) and not isinstance(value, bool):
            yield f"{prefix}{key}"


def _texts(values: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, str]]:
    """Yield the dotted keys of a table, each with itself and, if it is text, with its value."""
    for key, value in values.items():
        yield "a key", key
        if isinstance(value, dict):
            yield from _texts(value, f"{prefix}{key}.")
        for text in value if isinstance(value, list) else [value]:
            if isinstance(text, str):
                yield f"{prefix}{key}", text


def _explained(error: ValidationError) -> str:
    """Return a line about the first key that is wrong."""
    # an unknown key before a missing one: the missing one may just be misspelt
    first = min(error.errors(), key=lambda found: found["type"] != "extra_forbidden")
    *around, last = [str(part) for part in first["loc"] if part != "[key]"]
    key = ".".join([*around, last])
    if first["type"] == "extra_forbidden":
        known = _fields(around)
        near = difflib.get_close_matches(last, known, 1)
        return f"unknown key {key}" + (f"; did you mean {near[0]}?" if near else f"; known: {', '.join(known)}")
    if first["type"] == "pen":
        return str(first["msg"])
    if first["type"] == "paper":
        return f"{key}: {first['msg']}"
    if first["type"] == "missing":
        return f"the key {key} is missing"
    if first["type"] == "string_pattern_mismatch":
        rule = (
            "is no colour; write it as #rrggbb"
            if last.endswith("colour")
            else "has letters that DXF layers may not have"
        )
        return f"{key} = {first['input']!r} {rule}"
    return f"{key} = {_shown(first['input'])}: {_rule(first, last)}"


def _shown(value: object) -> str:
    """Return a value as an error shows it."""
    try:
        text = repr(value)
    except ValueError:  # a number of thousands of digits
        return "a very long number"
    return text if len(text) <= SHOWN else f"{text[:SHOWN]}..."


def _rule(found: Mapping[str, Any], name: str) -> str:
    """Return what a value has to be that pydantic found wrong, with the unit of the quantity ``name``."""
    unit = next((f" {unit}" for ending, unit in UNITS.items() if name.endswith(ending)), "")
    unit = " mm" if name in ("pen_up", "pen_down") else unit
    rules = {"greater_than_equal": "at least {ge:g}", "less_than_equal": "at most {le:g}"}
    rules |= {"greater_than": "more than {gt:g}", "less_than": "less than {lt:g}"}
    if isinstance(found["input"], float) and not math.isfinite(found["input"]):
        return f"give a finite number{unit and ' of'}{unit}"
    if found["type"] in rules:
        return f"give {rules[found['type']].format(**found['ctx'])}{unit}"
    if found["type"] in ("float_parsing", "float_type", "int_parsing", "int_type") and unit:
        return f"give a number of{unit}, without the unit"
    return str(found["msg"])


def _fields(path: Sequence[str]) -> list[str]:
    """Return the keys that the schema knows in the table at a path."""
    table: Any = Profile
    tables = {
        "drawing": LineStyle,
        "bed": Bed,
        "hpgl": Hpgl,
        "gcode": Gcode,
        "page": Page,
        "solid": Solid,
        "blade": Blade,
        "motion": Motion,
        "papers": Paper,
        "operations": Operation,
    }
    tables |= {"mountain": Dash, "valley": Dash, "materials": Material}
    settings = dict.fromkeys(("mark", "score", "perforate", "cut"), Setting)
    for depth, name in enumerate(path):
        if depth and path[0] == "operations":
            continue
        table = (settings if depth > 1 and name in settings else tables).get(name, table)
    return list(table.model_fields)
