"""The options that several commands share: each group is added to a parser, and read back as one value.

For a group "thing" there is ``add_thing(parser)``, which gives a command its options, and ``thing(args)``, which
returns what the user said as one typed, immutable value, or raises BadInputError. Only these functions and the
commands' own ``run`` see the parsed arguments.
"""

from __future__ import annotations

import math
from argparse import ArgumentParser, Namespace
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from foldcut.cli.console import Console
from foldcut.cli.parser import Parser, nearest, output_name
from foldcut.core.errors import BadInputError
from foldcut.core.files import NOT_ORDINARY, hash_of, is_standard_input
from foldcut.methods import AUTO, CHOICES, DEFAULT_METHOD, EFFORTS, METHODS
from foldcut.redraw.bounds import FEWEST, HANDS_CREASE_MM, HANDS_FOLDS, LEVELS, SMALL_PARTS, TOLERANCES

if TYPE_CHECKING:
    from foldcut.core.model import Sheet
    from foldcut.options import Options
    from foldcut.output.recipe import Recipe
    from foldcut.output.render import JobOptions
    from foldcut.profiles import Profile
    from foldcut.readers import Drawing, ReadOptions

PATTERN_SUFFIX = ".fold"
"""A source with this ending is a pattern that is folded already, not a drawing."""
PATTERN_STEM = "-creases"
"""``foldcut make`` puts this behind the drawing's name when it names a pattern itself."""
LONGEST_STEM = 40
"""A file that is named after a text gets this many of its letters."""
FILES_OF = {"--font": "", "--profile": ".toml"}
"""The options that may name a file, and what its name ends in."""
NOT_REPEATED = ("shape", "progress")
"""What has no part in what files are made of, or is not an option."""
USUAL_SOLID = "scored-sheet"
"""The profile for solids when the one that is named has none."""
USUAL_SHEET = "a4"
"""The sheet if neither the user nor a machine has another."""
USUAL_MARGIN_MM = 10.0
"""The margin, unless the machine cannot reach a wider one."""


# ---- reports ----


def add_console(command: ArgumentParser) -> None:
    """Add the options on how to report."""
    command.add_argument("--json", action="store_true", help="print the report as JSON on stdout, for programs")
    command.add_argument("--quiet", action="store_true", help="print nothing but errors")


def console(args: Namespace) -> Console:
    """Return how to report."""
    return Console(args.json, args.quiet)


def add_force(command: ArgumentParser) -> None:
    """Add the option that lets a command replace files; ``args.force`` is its value."""
    command.add_argument("--force", action="store_true", help="replace files that exist already")


def add_timeout(command: ArgumentParser) -> None:
    """Add the time limit, which ``cli.main`` reads and keeps."""
    command.add_argument(
        "--timeout", metavar="S", type=float, help="give up with an error after this many seconds (default: never)"
    )


# ---- what is folded ----


@dataclass(frozen=True)
class Source:
    """What is folded: a drawing's file, a ``text`` in a ``font``, or a pattern that foldcut wrote.

    ``path`` is the file's, or "-" for standard input; a text has one only to name outputs after. ``joined``: how the
    letters of a text are joined, None if they are not.
    """

    path: Path
    text: str | None = None
    font: str = ""
    joined: str | None = None

    def files(self) -> list[Path]:
        """Return the files that are read: the drawing's, or that of the font."""
        if self.text is None:
            return [self.path]
        from foldcut.readers.typed_text import font_file

        found = font_file(self.font)
        return [] if found is None else [found]

    @property
    def is_word(self) -> bool:
        """Whether this is a text of several letters."""
        return self.text is not None and len("".join(self.text.split())) > 1

    @property
    def is_pattern(self) -> bool:
        """Whether this is a pattern that is folded already."""
        return self.text is None and self.path.suffix.lower() == PATTERN_SUFFIX

    @property
    def stem(self) -> str:
        """What outputs are called: after the drawing, also where the source is a pattern that is named after one."""
        stem = self.path.stem.removesuffix(PATTERN_STEM) if self.is_pattern else self.path.stem
        return "drawing" if is_standard_input(self.path) else stem or self.path.stem

    def read(self, options: ReadOptions) -> Drawing:
        """Return the drawing."""
        if self.text is None:
            from foldcut.readers.apart import read_shape_apart

            return read_shape_apart(self.path, options)
        from foldcut.readers.apart import apart
        from foldcut.readers.typed_text import draw_text

        text = self.text
        return apart(lambda: draw_text(text, self.font, options, self.joined), options.limits, self.font)


def add_source(command: ArgumentParser) -> None:
    """Add the drawing: a SHAPE or a text."""
    command.add_argument(
        "shape",
        metavar="SHAPE",
        nargs="?",
        help="a drawing (.svg, .dxf, .pdf, .png, .jpg, .json, .geojson, .wkt, .wkb, .csv), the name of a sample, a "
        "pattern that foldcut wrote (.fold), or - for standard input",
    )
    add_text(command, "draw this text instead of a SHAPE, all letters on one sheet")
    command.add_argument(
        "--joined",
        choices=("bar", "baseline"),
        help="make one piece of the letters of --text; bar: they stand on a bar; baseline: a bar as high as a stroke "
        "goes through their feet. Dots and accents stay apart (default: every letter is a piece of its own)",
    )


def add_text(command: ArgumentParser, what: str) -> None:
    """Add a text and its font; ``what`` the text is for."""
    command.add_argument("--text", help=what)
    command.add_argument(
        "--font",
        default="sans",
        help="the font of --text: the path of a font file, the name of a family, or foldcut, a font made for "
        "folding: A to Z, a to z and digits with at most 25 folds each (default: %(default)s)",
    )


def source(args: Namespace) -> Source:
    """Return what is folded."""
    if (args.text is None) == (not args.shape):
        raise BadInputError(f"give a SHAPE or a --text{'' if args.text is None else ', not both'}")
    if args.text is None:
        if args.joined is not None:
            raise BadInputError("--joined joins the letters of a --text; give one")
        return named_source(args.shape)
    stem = "".join(letter for letter in args.text if letter.isalnum())[:LONGEST_STEM]
    return Source(Path(stem or "text"), args.text, args.font, args.joined)


def named_source(shape: str) -> Source:
    """Return the source that is meant by a path, the name of a sample, or "-"."""
    from foldcut.samples import sample_names, sample_path

    path = Path(shape)
    if is_standard_input(shape) or path.is_file():
        return Source(path)
    if shape in sample_names(lines=True):
        return Source(sample_path(shape))
    if path.is_dir():
        raise BadInputError(f"{shape}: is a folder; give a drawing, or give the folder to foldcut batch")
    if path.exists():
        raise BadInputError(f"{shape}: {NOT_ORDINARY}")
    remedy = "give a drawing or one of the samples, which foldcut samples lists"
    raise BadInputError(
        f"{shape}: there is no such file; {nearest(shape, sample_names(lines=True), 'the sample ') or remedy}"
    )


# ---- how it is read ----


def add_reading(command: ArgumentParser) -> None:
    """Add how a drawing's file is read."""
    reading = command.add_argument_group("the drawing")
    reading.add_argument(
        "--from", metavar="SUFFIX", help="the drawing's format, such as svg (default: the ending of its name)"
    )
    reading.add_argument(
        "--layer", metavar="NAME", action="append", default=[], help="read only this layer (repeatable)"
    )
    reading.add_argument("--id", metavar="ID", action="append", default=[], help="read only this element (repeatable)")
    reading.add_argument(
        "--flatten",
        metavar="LENGTH",
        default="0.05mm",
        help="how far a curve may be from the segments that replace it, both at the drawing's own size and scaled to "
        "200 mm (default: %(default)s)",
    )
    reading.add_argument(
        "--threshold",
        metavar="T",
        type=float,
        default=0.5,
        help="how light the shape in a picture may be, from 0, black, to 1, white (default: %(default)s)",
    )
    reading.add_argument(
        "--join",
        metavar="LENGTH",
        help="join ends of lines that are no farther apart than this, at the drawing's own size; if it states none, a "
        "mm is a unit of the drawing (default: 0.05mm, both at its own size and scaled to 200 mm)",
    )
    reading.add_argument(
        "--open",
        action="store_true",
        help="cut along every line that is drawn: open lines, lines that cross, and sides that two outlines share "
        "(default: cut out what closed outlines enclose)",
    )
    reading.add_argument(
        "--strokes",
        choices=("lines", "outline"),
        default="lines",
        help="read strokes as lines without width, or as the outline of what they cover (default: %(default)s)",
    )
    reading.add_argument(
        "--limit",
        metavar="NAME=NUMBER",
        action="append",
        default=[],
        help="allow larger drawings: bytes (default: 20 MiB), points (100000), loops (1000), "
        "pixels (40 million), nesting (100); and longer reading: seconds of the processor (10), megabytes (1024); "
        "repeatable",
    )


def reading(args: Namespace) -> ReadOptions:
    """Return how a drawing's file is read."""
    from foldcut.core.units import parse_length
    from foldcut.drawing.limits import parse_limits
    from foldcut.readers import ReadOptions

    return ReadOptions(
        flatten_mm=parse_length(args.flatten),
        join_mm=None if args.join is None else parse_length(args.join),
        layers=tuple(args.layer),
        ids=tuple(args.id),
        suffix=vars(args)["from"] or "",
        threshold=args.threshold,
        strokes=args.strokes,
        open_lines=args.open,
        limits=parse_limits(args.limit),
    )


# ---- how it is laid on the sheet, folded and mended ----


def add_folding(command: ArgumentParser) -> None:
    """Add where a drawing lies on the sheet, how it is read and mended, and how to search for its pattern."""
    command.add_argument(
        "--sheet",
        help="a paper size such as a4, turned to suit the drawing, or a4-landscape, or WIDTHxHEIGHT. A drawing that "
        "leaves much of it free may get a pattern for less paper; the report then says to what size to cut the sheet "
        f"down first. With --offset that never happens (default: the machine's own, or {USUAL_SHEET})",
    )
    command.add_argument(
        "--margin",
        help=f"room kept free along the sheet's edges (default: {USUAL_MARGIN_MM:g}mm, or as much as the machine "
        "cannot reach)",
    )
    command.add_argument(
        "--scale",
        help="fit, or a factor on the size of the drawing such as 1.5 or 1:2 (default: fit, within the margin)",
    )
    command.add_argument("--width", metavar="LENGTH", help="scale the drawing to this width, turned as --rotate says")
    command.add_argument(
        "--height",
        metavar="LENGTH",
        help="scale it to this height; with --width, to the largest size that exceeds neither: it is never stretched",
    )
    command.add_argument(
        "--offset",
        metavar="X,Y",
        help="where the lower left corner of the drawing lies on the sheet (default: centred)",
    )
    command.add_argument(
        "--rotate",
        metavar="DEG",
        help="turn the drawing counter-clockwise; best: to the angle at which it is largest on the sheet (default: a "
        "quarter turn if that gives it more room, and whatever its mirror axes need; 0 forbids both)",
    )
    command.add_argument(
        "--method",
        choices=CHOICES,
        default=DEFAULT_METHOD,
        help=_method_help(),
    )
    command.add_argument(
        "--effort",
        choices=EFFORTS,
        default="normal",
        help="how long to search for fewer and longer creases (default: %(default)s)",
    )
    command.add_argument(
        "--seconds", metavar="S", type=float, help="stop the search after this many seconds (default: as --effort says)"
    )
    command.add_argument(
        "--progress", action="store_true", help="print progress on stderr, as lines of JSON for programs"
    )
    command.add_argument(
        "--ribbon",
        metavar="WIDTH",
        help="half the width of an unfolded ribbon along the cut (default: none; with the methods "
        f"{_joined(method.name for method in METHODS.values() if method.needs_ribbon)}, which need one, 0.25mm or "
        "as much as the drawing has room for)",
    )
    command.add_argument(
        "--min-crease",
        metavar="LENGTH",
        help=f"refuse patterns with a shorter crease (default: {_shortest_creases()})",
    )
    add_nearness(command)
    add_reading(command)
    mend = command.add_argument_group("the drawing; every change is reported")
    mend.add_argument("--strict", action="store_true", help="refuse a drawing that has to be mended, and say why")
    mend.add_argument(
        "--min-feature",
        metavar="LENGTH",
        default="0mm",
        help="drop parts and close gaps that are narrower than this, on the sheet",
    )
    mend.add_argument(
        "--separate",
        metavar="LENGTH",
        default="0mm",
        help="if loops touch, move all edges inward until they are this far apart",
    )
    mend.add_argument("--mirror", action="store_true", help="turn the drawing over, left to right")


def add_nearness(command: ArgumentParser) -> None:
    """Add how near the outline stays to the drawing, and what is asked of the pattern in return."""
    hands = f"at most {HANDS_FOLDS} folds, no crease under {HANDS_CREASE_MM:g} mm"
    steps = ", ".join(f"{tolerance:g}" for tolerance in TOLERANCES[:-1])
    near = command.add_argument_group(
        "how near the outline stays to the drawing",
        f"The drawing is tried as it is. If that is not for two hands ({hands} on A4), outlines are drawn anew that "
        f"are at most {steps} and {TOLERANCES[-1]:g} mm off on A4, on other sheets in proportion, and the most exact "
        "one for two hands is taken; if there is none, the one that is easiest to fold. The report has them all. "
        "--tolerance bounds all moves together; --simplify, --symmetry and --adjust bound one kind of move each, and "
        "--corners the number of corners, within the same search.",
    )
    near.add_argument(
        "--tolerance",
        metavar="LENGTH",
        help="how far the outline may be from the drawing at most, and the drawing from it, in mm on the sheet, all "
        f"moves together (default: {TOLERANCES[-1]:g} mm on A4)",
    )
    near.add_argument(
        "--exact", action="store_true", help="move no corner at all: the outline is the drawing (as --tolerance 0mm)"
    )
    near.add_argument(
        "--level",
        choices=LEVELS,
        help="a name for a tolerance on A4: exact: no moves; "
        + "; ".join(f"{name}: at most {most:g} mm" for name, most in LEVELS.items() if most)
        + f"; and {FEWEST} takes the fewest folds, not the most exact outline (default: none)",
    )
    near.add_argument(
        "--folds",
        metavar="N",
        type=int,
        help=f"take the most exact outline with at most N folds (default: {HANDS_FOLDS})",
    )
    near.add_argument(
        "--small-parts",
        choices=SMALL_PARTS,
        default=SMALL_PARTS[0],
        help="what becomes of parts that are narrower than the tolerance, such as an eye: they are named, and left "
        "out, kept as they are, or enlarged to the tolerance (default: %(default)s)",
    )
    near.add_argument(
        "--simplify",
        metavar="LENGTH",
        default="0mm",
        help="leave out corners of the drawing first, if that moves the outline by no more than this on the sheet; "
        "unless --tolerance or --level is given, this is the tolerance, too (default: none)",
    )
    near.add_argument(
        "--symmetry",
        metavar="LENGTH|auto",
        default="0mm",
        help="how far corners may be off in a drawing that is taken as mirror-symmetric, and made exactly so; auto: as "
        "far as --tolerance or --level goes, or 0.5 mm on A4 (default: in the drawing as it is only rounding errors, "
        "in an outline drawn anew as far as the tolerance goes)",
    )
    near.add_argument(
        "--adjust",
        metavar="LENGTH",
        help="how far a method may move corners at last, to make creases meet (default: about 1/500 of the drawing's "
        "size, within the tolerance)",
    )
    near.add_argument(
        "--corners",
        metavar="N",
        type=int,
        help="at most this many corners: they are left out of the drawing until N are left, and no outline has more",
    )


def _method_help() -> str:
    """Return what each method does, from the table of methods."""
    rows = [f"{AUTO}: the easiest to fold of the patterns that methods of few creases make"]
    rows += [f"{method.name}: {method.summary}" for method in METHODS.values()]
    return "; ".join(rows) + " (default: %(default)s)"


def _shortest_creases() -> str:
    """Return the shortest crease that each method allows, such as "0.5mm with mirror and compact; 0mm with paper"."""
    names: dict[float, list[str]] = {}
    for method in METHODS.values():
        names.setdefault(method.min_crease_mm, []).append(method.name)
    return "; ".join(f"{length:g}mm with {_joined(some)}" for length, some in names.items())


def _joined(names: Iterable[str]) -> str:
    """Return names as words: "a", "a and b", "a, b and c"."""
    *most, last = names
    return f"{', '.join(most)} and {last}" if most else last


def folding(args: Namespace) -> Options:
    """Return how a drawing is laid on the sheet, mended and folded."""
    from foldcut.core.units import parse_length
    from foldcut.drawing.mend import Preparation
    from foldcut.drawing.placement import parse_sheet
    from foldcut.options import Options

    def length(text: str | None) -> float | None:
        return None if text is None else parse_length(text)

    sheet = parse_sheet(args.sheet or _usual_sheet(args))
    return Options(
        sheet=sheet,
        margin=_usual_margin(args, sheet) if args.margin is None else parse_length(args.margin),
        scale=_scale(args.scale, args.width, args.height),
        offset=None if args.offset is None else parse_pair(args.offset, "--offset"),
        rotation=_rotation(args.rotate),
        width=length(args.width),
        height=length(args.height),
        method=args.method,
        ribbon=length(args.ribbon),
        min_crease=length(args.min_crease),
        tolerance=length(args.tolerance),
        level=args.level or "",
        exact=args.exact or None,
        folds=args.folds,
        small_parts=args.small_parts,
        simplify=parse_length(args.simplify),
        symmetry=AUTO if args.symmetry == AUTO else parse_length(args.symmetry),
        adjust=length(args.adjust),
        effort=args.effort,
        seconds=args.seconds,
        preparation=Preparation(
            corners=args.corners,
            min_feature=parse_length(args.min_feature),
            separate=parse_length(args.separate),
            mirror=args.mirror,
            strict=args.strict,
        ),
    )


def _scale(text: str | None, width: str | None, height: str | None) -> str | float:
    """Return "fit", or the factor that "1.5" or "1:2" (half size) means."""
    from foldcut.drawing.placement import parse_scale

    if text is not None and (width is not None or height is not None):
        other = "--width" if width is not None else "--height"
        raise BadInputError(f"--scale and {other} both say how large the drawing is; give one of them")
    return parse_scale(text or "fit")


def parse_pair(text: str, option: str) -> tuple[float, float]:
    """Return (x, y) in mm from "X,Y", each a length that may be negative; ``option`` is where it was given."""
    from foldcut.core.units import parse_length

    parts = [part.strip() for part in text.split(",")]
    if len(parts) != 2:
        raise BadInputError(f"{option} {text} is not a pair; give X,Y such as 30,40 or 3cm,5mm")
    x, y = (-parse_length(part[1:]) if part.startswith("-") else parse_length(part) for part in parts)
    return x, y


def _rotation(text: str | None) -> str | float | None:
    """Return degrees or "best"; None if nothing is asked for."""
    if text is None or text == "best":
        return text
    try:
        return float(text)
    except ValueError:
        raise BadInputError(f"--rotate {text} is not an angle; give degrees such as 45, or best") from None


# ---- a source and how to fold it ----


@dataclass(frozen=True)
class FoldRequest:
    """A drawing and how to read and fold it; ``progress_lines``: tell programs on stderr how far the work is."""

    source: Source
    reading: ReadOptions
    folding: Options
    progress_lines: bool
    so_far: Path | None = None


@dataclass(frozen=True)
class OpenRequest:
    """A pattern that is folded already."""

    source: Source


Request = FoldRequest | OpenRequest


def add_request(command: ArgumentParser) -> None:
    """Add what to fold and how."""
    add_force(command)
    add_source(command)
    add_timeout(command)
    add_folding(command)
    command.add_argument(
        "--so-far",
        metavar="FILE",
        type=output_name,
        help="while the search goes on, write there each pattern that is better than the ones before, in the format "
        "that its ending names (.html, .svg, .fold ...); an earlier one is replaced",
    )


def request(args: Namespace) -> Request:
    """Return what to fold and how; for a pattern, options on how to read, lay and fold a drawing are errors."""
    asked = source(args)
    if not asked.is_pattern:
        return FoldRequest(asked, reading(args), folding(args), args.progress, so_far(args))
    for_drawings = [name for add in (add_source, add_folding) for name in given(args, add)]
    for_drawings = [name for name in for_drawings if name not in ("--shape", "--progress")]
    for_drawings += ["--so-far"] if args.so_far is not None else []
    for_drawings += ["--preview"] if getattr(args, "preview", None) else []
    if for_drawings:
        raise BadInputError(
            f"{', '.join(for_drawings)}: only for drawings; {asked.path} has its sheet and creases already"
        )
    return OpenRequest(asked)


def given(args: Namespace, add_options: Callable[[ArgumentParser], None]) -> list[str]:
    """Return the options of a group that have a value of their own, not empty, in the group's order."""
    parser = Parser(add_help=False)
    add_options(parser)
    defaults = vars(parser.parse_args([]))
    values = vars(args)
    return [f"--{name.replace('_', '-')}" for name in defaults if values[name] not in (defaults[name], "")]


def so_far(args: Namespace) -> Path | None:
    """Return where patterns go while the search goes on; raises ``BadInputError`` for a format that has no pattern."""
    from foldcut.exporters import PATTERN_EXPORTERS

    if args.so_far is None:
        return None
    path = Path(args.so_far)
    if path.suffix.lower() not in PATTERN_EXPORTERS:
        raise BadInputError(f"--so-far {args.so_far}: give a name that ends in one of {', '.join(PATTERN_EXPORTERS)}")
    return path


# ---- how files were made ----


class Words(NamedTuple):
    """Options as they can be typed again, and the hashes of the files that they name, by the option."""

    options: tuple[str, ...] = ()
    hashes: Mapping[str, str] = {}


NO_WORDS = Words()
"""Nothing that is not as by default."""


def words(args: Namespace, add_options: Callable[[ArgumentParser], None], **instead: str | None) -> Words:
    """Return the options of a group that are not as by default; ``instead``: values to take for those in ``args``.

    Files are named without their folders.
    """
    parser = Parser(add_help=False)
    add_options(parser)
    options: list[str] = []
    hashes: dict[str, str] = {}
    for action in parser.options():
        value = instead.get(action.dest, getattr(args, action.dest))
        if value in (action.default, "") or action.dest in NOT_REPEATED:
            continue
        name = action.option_strings[-1]
        if name in FILES_OF and value.endswith(FILES_OF[name]) and Path(value).is_file():
            hashes[name] = hash_of(Path(value))
            value = Path(value).name
        values = value if isinstance(value, list) else [value]
        options += [name if one is True else f"{name}={one}" for one in values]
    return Words(tuple(options), hashes)


def recipe(args: Namespace) -> Recipe:
    """Return how the files of a command are made, but for its machine and the drawing's hash.

    The sheet and the margin are there even if they were not asked for: they hang on the other outputs.
    """
    from foldcut.output.recipe import UNNAMED, Recipe

    asked = source(args)
    name = "" if asked.text is not None else UNNAMED if is_standard_input(asked.path) else asked.path.name
    made = Recipe(args.command, drawing=name).also(*words(args, add_source))
    return made if asked.is_pattern else made.also(*folding_words(args))


def folding_words(args: Namespace) -> Words:
    """Return the options on how a drawing is folded, with the sheet and the margin in any case."""
    from foldcut.drawing.placement import parse_sheet

    sheet = args.sheet or _usual_sheet(args)
    margin = args.margin or f"{_usual_margin(args, parse_sheet(sheet)):g}mm"
    return words(args, add_folding, sheet=sheet, margin=margin)


# ---- the machine ----


@dataclass(frozen=True)
class Machine:
    """Whom files are made for: the ``profile`` that goes by this ``name``, none if None, and how its job is made.

    ``words``: the options that say so.
    """

    name: str | None
    profile: Profile | None
    job: JobOptions
    words: Words = NO_WORDS

    def output_name(self, stem: str) -> str:
        """Return what the file for this machine is called, in its format, when none is asked for; "" without one."""
        return f"{stem}-{Path(self.name).stem}.{self.profile.format}" if self.name and self.profile else ""

    @property
    def with_jobs(self) -> Profile | None:
        """The profile, if it is a machine's that carries out jobs, and not of the pattern alone."""
        return self.profile if self.profile is not None and self.profile.operations else None


def add_machine(command: ArgumentParser) -> None:
    """Add the machine and how its job is made."""
    machine = command.add_argument_group("the machine")
    machine.add_argument(
        "--profile",
        metavar="NAME",
        help="write the job for this machine; see foldcut profiles (default: none, any laser for DXF, the home printer "
        "for PDF)",
    )
    machine.add_argument(
        "--set", metavar="KEY=VALUE", action="append", default=[], help="change a value of the profile (repeatable)"
    )
    machine.add_argument("--material", metavar="NAME", help="what the sheet is made of (default: the profile's first)")
    machine.add_argument(
        "--treatment",
        choices=("score", "perforate", "draw"),
        help="how creases are made; score: unbroken lines; perforate: cuts with gaps; draw: dashed and dash-dotted "
        "lines (default: the profile's)",
    )
    machine.add_argument(
        "--two-sided",
        action="store_true",
        help="mountains on the front, valleys on the back, as two files, or as one PDF to print on both sides",
    )
    machine.add_argument(
        "--registration",
        choices=("jig", "corners", "holes", "pins"),
        help="what lines the back up with the front: a jig, the hole that the sheet is cut out of before it is turned "
        "over; corner marks; 3 mm holes for pegs; or 1 mm holes for needles (default: a jig where the machine cuts, "
        "corners where it draws)",
    )
    machine.add_argument(
        "--marks",
        metavar="NAME,...",
        help="what else is marked: outline (where the cut will be), first-folds, cut-line (only what can be seen of "
        "the outline when the sheet is folded), numbers (the order to press creases), title, ruler (PDF has both "
        "anyway); or none (default: outline,first-folds where the machine draws, none where it cuts)",
    )
    machine.add_argument(
        "--tile", action="store_true", help="print a sheet that is larger than the printer's paper on several pages"
    )
    machine.add_argument(
        "--at",
        metavar="X,Y",
        help="where on the bed the sheet's corner lies, from the bed's zero, to the right and away from it, such as "
        "30,2cm; the file is then for the whole bed (default: in the bed's corner)",
    )
    machine.add_argument(
        "--copies", metavar="N", type=int, default=1, help="make this many beside each other on the bed (default: 1)"
    )
    machine.add_argument(
        "--tabs",
        metavar="NxWIDTH",
        help="leave the sheet's outline uncut at N tabs of this width, such as 4x0.5mm, evenly spaced and away from "
        "corners, so that it stays in the stock",
    )
    machine.add_argument(
        "--frame",
        action="store_true",
        help="also write NAME-frame, which goes round the job with the laser off or the pen up (G-code and HPGL)",
    )


def machine(args: Namespace, default: str | None = None) -> Machine:
    """Return the machine and how its job is made; ``default`` names the profile when the user names none.

    Options that only a machine can follow are errors without one.
    """
    from foldcut.jobs.arrange import BedLayout
    from foldcut.jobs.tabs import parse_tabs
    from foldcut.output.render import JobOptions
    from foldcut.profiles import load_profile

    name = default if args.profile is None else args.profile
    profile = None if name is None else load_profile(name, args.set)
    if profile is None or not profile.operations:
        allowed = ("--profile",) if profile is None else ("--profile", "--set")
        wrong = [option for option in given(args, add_machine) if option not in allowed]
        if wrong:
            one = len(wrong) == 1
            if profile is None:
                what = f"{'goes' if one else 'go'} with a machine: name it with --profile"
            else:
                what = f"{'is' if one else 'are'} for a machine, and {name} is not one"
            raise BadInputError(f"{' and '.join(wrong)} {what}; see foldcut profiles")
    if args.registration and not args.two_sided:
        raise BadInputError("--registration lines the back up with the front: it goes with --two-sided")
    job = JobOptions(
        material=args.material,
        treatment=args.treatment,
        two_sided=args.two_sided,
        registration=args.registration,
        marks=_marks(args.marks),
        tile=args.tile,
        layout=BedLayout(None if args.at is None else parse_pair(args.at, "--at"), args.copies),
        tabs=None if args.tabs is None else parse_tabs(args.tabs),
        framed=args.frame,
    )
    return Machine(name, profile, job, words(args, add_machine, profile=name) if name else NO_WORDS)


def usual_machines(args: Namespace, endings: Iterable[str]) -> dict[str, Machine]:
    """Return the machines for files with these endings that have an obvious one, if the user names none."""
    from foldcut.output.saving import USUAL_MACHINES, usual_machine

    if args.profile is not None:
        return {}
    known = {ending.lower() for ending in endings} & USUAL_MACHINES.keys()
    return {ending: machine(args, default=usual_machine(ending, args.sheet or "")) for ending in sorted(known)}


# ---- solids ----


def add_solid(command: ArgumentParser) -> None:
    """Add what the solids look like."""
    solid = command.add_argument_group("solids (STL, 3MF, STEP)")
    solid.add_argument(
        "--groove",
        metavar="FORM",
        help="v: as wide and as deep as the profile says; v90, or another angle in degrees: as wide as that makes it; "
        "u: with a round bottom (default: v)",
    )
    solid.add_argument(
        "--one-sided", action="store_true", help="all grooves on top, those of valleys too (default: these are below)"
    )
    solid.add_argument(
        "--folded",
        action="store_true",
        help="not the flat sheet but the folded one, as a stack of its layers in the order that was proven, to see how "
        "thick it gets",
    )


def solid_machines(args: Namespace, endings: Iterable[str], bundles: Iterable[str] = ()) -> dict[str, Machine]:
    """Return whom files with the endings of solids are made for, if the user asks for another solid than usual.

    ``bundles``: the endings of archives and folders, which have a solid in them if that is the profile's format. Raises
    BadInputError: there is no solid among the files, the named profile has none, or the groove has no such form.
    """
    from foldcut.exporters import SOLIDS
    from foldcut.output.render import JobOptions
    from foldcut.profiles import load_profile

    asked = given(args, add_solid)
    if not asked:
        return {}
    named = None if args.profile is None else load_profile(args.profile, args.set)
    solid = None if named is None else named.solid
    own = solid is not None
    in_bundles = {*bundles} if named is not None and own and f".{named.format}" in SOLIDS else set()
    known = sorted({ending.lower() for ending in endings} & {*SOLIDS} | in_bundles)
    if not known:
        verb = "is" if len(asked) == 1 else "are"
        raise BadInputError(f"{', '.join(asked)} {verb} for solids: give an -o that ends in {', '.join(SOLIDS)}")
    if named is not None and not own:
        raise BadInputError(
            f"{', '.join(asked)}: {args.profile} makes no solids; make them by a command of their own, without "
            f"--profile or with --profile {USUAL_SOLID}"
        )
    folded = args.folded or (solid is not None and solid.folded)
    if folded and (args.groove or args.one_sided):
        which = "--groove" if args.groove else "--one-sided"
        raise BadInputError(f"{which} is for the flat sheet, and a folded one has no grooves; leave one of them out")
    name = args.profile if own else USUAL_SOLID
    changes = [*(args.set if own else ()), *_groove(args.groove)]
    changes += [f"solid.{key}=true" for key in ("one_sided", "folded") if getattr(args, key)]
    profile = load_profile(name, changes)
    said, more = (
        words(args, add_solid),
        words(args, add_machine, profile=name) if own else Words((f"--profile={name}",)),
    )
    made = Machine(name, profile, JobOptions(), Words(more.options + said.options, more.hashes))
    return dict.fromkeys(known, made)


def _groove(form: str | None) -> list[str]:
    """Return what a form of groove changes in the profile."""
    if form is None or form == "v":
        return []
    if form == "u":
        return ["solid.groove=u"]
    angle = form.removeprefix("v").removesuffix("deg")
    if form[0:1] != "v" or not angle.replace(".", "", 1).isdecimal() or not 10 <= float(angle) <= 170:
        raise BadInputError(f"--groove {form} is no form; give v, u, or v and an angle from 10 to 170 such as v90")
    return [f"solid.groove_angle_deg={float(angle)!r}"]


def no_machine() -> Machine:
    """Return what files of the pattern alone are made for."""
    from foldcut.output.render import JobOptions

    return Machine(None, None, JobOptions())


def _profile_asked_for(args: Namespace) -> Profile | None:
    """Return the profile that decides on the sheet: the named one, or that of an output; above all a printer's."""
    from foldcut.output.saving import USUAL_MACHINES, usual_machine
    from foldcut.profiles import load_profile

    if not hasattr(args, "profile"):
        return None
    if args.profile is not None:
        return load_profile(args.profile, args.set)
    outputs = [args.output] if isinstance(args.output, str) else args.output or []
    formats = [f".{name.strip()}" for name in (getattr(args, "formats", None) or "").split(",")]
    endings = {*(Path(output).suffix.lower() for output in outputs), *formats} & USUAL_MACHINES.keys()
    profiles = [load_profile(usual_machine(ending, args.sheet or ""), args.set) for ending in sorted(endings)]
    return min(profiles, key=lambda profile: profile.page is None, default=None)


def _usual_sheet(args: Namespace) -> str:
    """Return the sheet if none is asked for: the machine's own, or A4."""
    profile = _profile_asked_for(args)
    return USUAL_SHEET if profile is None else profile.sheet


def _usual_margin(args: Namespace, sheet: Sheet) -> float:
    """Return the margin if none is asked for, in mm: as wide as what the machine cannot reach."""
    from foldcut.jobs.bed import unreached
    from foldcut.jobs.errors import JobError

    profile = _profile_asked_for(args)
    if profile is None or not profile.operations or args.tile:
        return USUAL_MARGIN_MM
    try:
        return max(USUAL_MARGIN_MM, math.ceil(10 * unreached(sheet, profile)) / 10)
    except JobError:  # it does not fit, which is said where files are checked
        return USUAL_MARGIN_MM


def _marks(text: str | None) -> tuple[str, ...] | None:
    """Return the names of marks, None for those of the machine; raises JobError for an unknown one."""
    from foldcut.jobs.errors import JobError
    from foldcut.jobs.marks import MARKS

    if text is None:
        return None
    names = () if text == "none" else tuple(name.strip() for name in text.split(","))
    for name in names:
        if name not in MARKS:
            raise JobError(f"there is no mark {name!r}; choose from {', '.join(MARKS)}, or none")
    return names
