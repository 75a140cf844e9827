"""How a drawing is laid on the sheet, mended and folded: everything that ``foldcut.fold`` can be told, as one value.

``Options`` -> the words that mean the same on the command line, so that a file that Python saved can be made again by
``foldcut make --again``.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields, replace
from difflib import get_close_matches
from typing import Any

from foldcut.core.model import Sheet
from foldcut.core.units import Length
from foldcut.drawing.limits import Limits
from foldcut.drawing.mend import Preparation
from foldcut.drawing.placement import parse_sheet
from foldcut.methods import DEFAULT_METHOD

__all__ = ["Options"]


@dataclass(frozen=True)
class Options:
    """How a drawing is laid on the sheet, mended and folded. Lengths are in mm, or texts such as "10mm" or "0.5in".

    One value can be used for many drawings, and ``dataclasses.replace`` makes another of it:

        >>> import foldcut
        >>> small = foldcut.Options(sheet="a6", margin="5mm", effort="fast")
        >>> foldcut.fold("star", small, margin=8)
        <Result Five-pointed star on A6 landscape (148 x 105 mm): 4 folds, 10 creases by simple, verified>
    """

    sheet: Sheet | str = "a4"
    """The paper: a size such as "a4", turned to suit the drawing, or "a4-landscape", or "200x150mm"."""
    margin: Length = 10.0
    """Room that is kept free along the sheet's edges."""
    scale: str | float = "fit"
    """The text "fit", or a factor, also as 1:2, on the size that the file states (mm per unit where it states none)."""
    offset: tuple[Length, Length] | None = None
    """Where the drawing's lower left corner lies on the sheet; None: centred."""
    rotation: str | float | None = None
    """Degrees counter-clockwise, or "best" for the angle at which the drawing is largest.

    None gives it a quarter turn if it then fits larger, and lets a method turn it so that its mirror axes are parallel
    to the sheet's sides.
    """
    width: Length | None = None
    """How wide the drawing may be at most; instead of ``scale``."""
    height: Length | None = None
    """How high the drawing may be at most; instead of ``scale``."""
    tolerance: Length | None = None
    """How far the outline may be from the drawing at most; None: 4 mm on A4, in proportion on other sheets."""
    level: str = ""
    """A name for a tolerance: "exact" (none), "fine" (0.5 mm on A4), "normal" (2), "easy" (4).

    "easy" takes the fewest folds, not the most exact outline.
    """
    exact: bool | None = None
    """Whether no corner moves at all. None: so it is for the methods "paper" and "gate" unless a tolerance is given."""
    folds: int | None = None
    """How many folds a pattern for two hands may have; None: 60."""
    small_parts: str = "drop"
    """What becomes of parts that are narrower than the tolerance: "drop", "keep" or "enlarge" them."""
    method: str = DEFAULT_METHOD
    """One of ``foldcut.methods.CHOICES``.

    "mirror" folds the shape's mirror axes first and the rest through all layers; "simple" folds across the whole sheet
    only; "compact" makes few creases; "skeleton" is the method of Demaine, Demaine and Lubiw; "paper" is that of Bern,
    Demaine, Eppstein and Hayes, and "gate" the same for several loops. "auto" takes the pattern of the first four that
    is easiest to fold; those of the last two have thousands of folds and are made only where they are asked for.
    """
    ribbon: Length | None = None
    """The half-width of the strip along the shape's boundary that is not folded.

    None is the method's default, which for "paper" and "gate" is a narrow one, since without it creases fold onto the
    cut line.
    """
    min_crease: Length | None = None
    """The shortest crease allowed; None: 0.5 mm for "compact" and where "mirror" folds the half like that, else 0."""
    simplify: Length = 0.0
    """Leave out corners of the drawing first if that moves the outline by no more than this.

    Without a ``tolerance``, no outline is farther off than this, either.
    """
    symmetry: Length = 0.0
    """How far corners may be off in a drawing that is taken as mirror-symmetric, and made so.

    "auto": as far as the tolerance or the level that is given, or 0.5 mm on A4. 0: only rounding errors.
    """
    adjust: Length | None = None
    """How far "skeleton" may move corners so that creases meet; None: about 1/500 of the drawing's size."""
    effort: str = "normal"
    """How long to search: "fast", "normal" or "best"."""
    seconds: float | None = None
    """End the search after this many seconds; None: as ``effort`` says."""
    title: str = ""
    """What the pattern is called; by default as its file."""
    limits: Limits | None = None
    """How large a file may be."""
    preparation: Preparation | None = None
    """How the drawing is mended and simplified; None: it must be a valid shape as it is."""
    next_level: bool = True
    """Also try the tolerance after the one that is taken, to say what it would cost."""

    @property
    def paper(self) -> Sheet:
        """The sheet itself; raises ``SheetError`` for one that there is not."""
        return parse_sheet(self.sheet) if isinstance(self.sheet, str) else self.sheet

    def but(self, changes: dict[str, Any]) -> Options:
        """Return these options with some of them changed; raises ``TypeError`` for a name that is none of theirs."""
        known = [one.name for one in fields(self)]
        for name in changes:
            if name not in known:
                near = get_close_matches(name, known, n=1)
                remedy = f"did you mean {near[0]!r}?" if near else "foldcut.Options lists them"
                raise TypeError(f"there is no option {name!r}; {remedy}")
        return replace(self, **changes)

    def words(self) -> tuple[str, ...] | None:
        """Return the options as the command line writes them into recipes; None if it cannot say the same.

        The sheet and the margin are there in any case, all others only if they are not as by default.
        """
        if self.title or self.limits is not None:
            return None
        return tuple(self._words())

    def _words(self) -> Iterator[str]:
        sheet = self.sheet
        yield f"--sheet={sheet if isinstance(sheet, str) else f'{sheet.width!r}x{sheet.height!r}mm'}"
        yield f"--margin={_typed(self.margin)}"
        if self.scale != "fit":
            yield f"--scale={self.scale}"
        yield from _lengths(self, "width", "height")
        if self.offset is not None:
            yield f"--offset={','.join(map(_typed, self.offset))}"
        if self.rotation is not None:
            yield f"--rotate={self.rotation if isinstance(self.rotation, str) else f'{self.rotation:g}'}"
        yield from self._others("method", "effort", "seconds")
        yield from _lengths(self, "ribbon", "min_crease", "tolerance")
        if self.exact:
            yield "--exact"
        yield from self._others("level", "folds", "small_parts")
        yield from _lengths(self, "simplify", "symmetry", "adjust")
        preparation = self.preparation or Preparation()
        if preparation.corners is not None:
            yield f"--corners={preparation.corners}"
        if preparation.strict:
            yield "--strict"
        yield from _lengths(preparation, "min_feature", "separate")
        if preparation.mirror:
            yield "--mirror"

    def _others(self, *names: str) -> Iterator[str]:
        for name in names:
            value = getattr(self, name)
            if value != getattr(Options, name):
                yield f"--{name.replace('_', '-')}={value}"


def _lengths(options: Options | Preparation, *names: str) -> Iterator[str]:
    """Yield the lengths among the options that are given, and are not 0, as they are typed."""
    for name in names:
        value = getattr(options, name)
        if value is not None and value != 0:
            yield f"--{name.replace('_', '-')}={_typed(value)}"


def _typed(length: Length) -> str:
    """Return a length as it is typed: texts as they are, numbers in mm."""
    if isinstance(length, str):
        return length
    short = f"{length:g}"
    return f"{short if float(short) == length else repr(float(length))}mm"
