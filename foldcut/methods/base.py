"""What a method is given and what it returns: ``fold(problem, effort) -> Made``.

The data that passes between the pipeline and the methods; ``foldcut.methods`` has the table of them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

from foldcut.core.arrays import Floats
from foldcut.core.errors import BadInputError, RibbonError, UnfoldableError
from foldcut.core.model import CreasePattern, FoldedState, Region, Shape, Sheet
from foldcut.drawing.laying import Laid
from foldcut.methods import EFFORTS
from foldcut.methods.progress import Stages
from foldcut.pattern.foldability import crease_numbers
from foldcut.pattern.ranking import Goal

__all__ = ["AS_TOLERATED", "Effort", "Made", "Problem", "Wishes", "require_one_loop"]


AS_TOLERATED = float("inf")
"""How far corners may be off for a mirror axis where that is as far as the tolerance goes."""

FILE_ROUNDING = 2e-4
"""How far corners are off oblique axes in a file with rounded numbers, at most, relative to the shape's size."""


@dataclass(frozen=True)
class Effort:
    """How long a method may search: as ``name``, one of ``EFFORTS``, says, or if they are given, for ``seconds``.

    ``share``: the part of that time that the method gets; ``goal``: what ends the search before. Raises
    ``BadInputError`` for an unknown name or a limit that is not positive.
    """

    name: str = "normal"
    seconds: float | None = None
    share: float = 1.0
    goal: Goal = field(default_factory=Goal)

    def __post_init__(self) -> None:
        if self.name not in EFFORTS:
            raise BadInputError(f"unknown effort {self.name!r}; known: {', '.join(EFFORTS)}")
        if self.seconds is not None and not 0 < self.seconds < float("inf"):
            raise BadInputError(f"the time to search is {self.seconds} s; give a positive number")

    def part(self, share: float) -> Effort:
        """Return this part of the effort."""
        return replace(self, share=self.share * share)


@dataclass(frozen=True)
class Wishes:
    """What a pattern is to be like, in mm; each method heeds those wishes that concern it.

    ``ribbon``: the half-width of the strip along the shape's boundary that is not folded, None for the method's
    default; ``min_crease``: the shortest crease allowed, None for the method's default; ``symmetry``: how far corners
    may be off for a mirror axis, ``AS_TOLERATED`` before it is known how far that is; ``adjust``: how far corners may
    be moved so that creases meet, None for a part of the drawing's size.

    Raises ``BadInputError`` for a negative or infinite number, for the ribbon the subclass ``RibbonError``.
    """

    ribbon: float | None = None
    min_crease: float | None = None
    symmetry: float = 0.0
    adjust: float | None = None

    def __post_init__(self) -> None:
        for value, what, error in (
            (self.ribbon, "the ribbon's half-width", RibbonError),
            (self.min_crease, "the shortest crease allowed", BadInputError),
            (
                0.0 if self.symmetry == AS_TOLERATED else self.symmetry,
                "the deviation from symmetry allowed",
                BadInputError,
            ),
            (self.adjust, "how far corners may be moved", BadInputError),
        ):
            if value is not None and not 0 <= value < float("inf"):
                raise error(f"{what} is {value} mm; give 0 or a positive number")

    def axes_off(self, size: float) -> float:
        """Return how far corners of a shape, ``size`` mm across, may be off several axes through one point, in mm.

        Oblique axes are never exact in a file with rounded numbers, so a little is allowed if corners may be moved.
        """
        return max(self.symmetry, 0.0 if self.adjust == 0 else FILE_ROUNDING * size)

    @property
    def free_ribbon(self) -> float:
        """The half-width in mm for methods that need no ribbon."""
        return self.ribbon or 0.0


@dataclass(frozen=True, eq=False)
class Problem:
    """A shape on its sheet, and what is wished for.

    ``lay`` lays the shape anew, turned by so many degrees more; ``may_turn``: a method may do so. ``stages`` times and
    reports what a method does.
    """

    laid: Laid
    lay: Callable[[float], Laid]
    wishes: Wishes = field(default_factory=Wishes)
    may_turn: bool = False
    stages: Stages = field(default_factory=Stages)

    @property
    def shape(self) -> Shape:
        """The shape in the sheet's mm."""
        return self.laid.shape

    @property
    def sheet(self) -> Sheet:
        """The sheet that the shape lies on."""
        return self.laid.sheet


@dataclass(frozen=True, eq=False)
class Made:
    """What a method made of a shape; not verified yet unless the method has done so.

    ``laid``: the shape that was folded, on its sheet. ``ribbon``: the half-width in mm that the pattern has.
    ``actions``: how many straight folds a person makes, through one layer or more. ``first_folds``: lines across all of
    the sheet, ``(2, 2)`` mm each, that are folded before all else. ``regions``: where the molecules lie, as a tree.
    ``told``: how the pattern was made, in words, a line each; ``numbers``: the same for programs, by name.
    ``min_crease_mm``: the shortest crease that the pattern may have unless told otherwise, None for the method's.
    ``interrupted``: Ctrl-C ended the search before it was complete. ``detail``: what the method's own stages made.
    """

    method: str
    creases: CreasePattern
    folded: FoldedState
    laid: Laid
    ribbon: float
    actions: int
    told: tuple[str, ...]
    numbers: Mapping[str, float]
    first_folds: tuple[Floats, ...] = ()
    regions: tuple[Region, ...] = ()
    min_crease_mm: float | None = None
    interrupted: bool = False
    detail: object = None


def straight_folds(creases: CreasePattern) -> int:
    """Return how many straight folds a pattern takes, each through one layer."""
    return crease_numbers(creases).lines


def require_one_loop(shape: Shape) -> None:
    """Raise ``UnfoldableError``, naming the loops, unless the shape has exactly one boundary loop.

    With more loops the joining rule has no flat-folded state in general (see docs/assignment.md).
    """
    if len(shape.loops) == 1:
        return
    names = []
    for number, loop in enumerate(shape.loops, start=1):
        role = "outer boundary" if shape.depth(number - 1) % 2 == 0 else "hole"
        x, y = loop.mean(axis=0)
        names.append(f"loop {number} ({role}, {len(loop)} corners, around ({x:.4g}, {y:.4g}))")
    raise UnfoldableError(
        f"the shape has {len(names)} boundary loops, and this method folds only one: {', '.join(names)}; "
        "try --method auto, or cut the loops from separate sheets"
    )
