"""Make outlines of several kinds: dense loops, a tolerance and axes -> ``Start``s, the most promising first."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from foldcut.core.arrays import Floats
from foldcut.core.model import Shape
from foldcut.redraw.starts import pieces
from foldcut.redraw.starts.arcs import fit_bends, straight_parts
from foldcut.redraw.starts.bends import lead_in_bends
from foldcut.redraw.starts.chains import Axis, Chain, Chains, Line, chains_of
from foldcut.redraw.starts.circles import circles_of, regular_lines
from foldcut.redraw.starts.directions import direction_set, straight_directions
from foldcut.redraw.starts.disks import fit_disks
from foldcut.redraw.starts.fitting import ANY, End, Sides, fit, straight_as_far_as
from foldcut.redraw.starts.following import follow, lead_of
from foldcut.redraw.starts.near import Near
from foldcut.redraw.starts.strips import Pairs, Strip, find_strips, recut_chains

__all__ = ["KINDS", "Kind", "Start", "all_starts", "starts"]

FOLLOWING = 0.97
"""How far the edge of a strip that follows the other may be off, as a part of the tolerance."""


FOLLOWED = 0.75
"""A side of the leading edge is so short that the other edge is this straight beside it, in parts of the tolerance."""


FARTHEST = 2.5
"""How far off a loose outline is at most, in tolerances."""


LEAST_ROOM = 0.4
"""The least part of the tolerance that is left where images of a drawing are off from it."""

LONG = 4.0, 2.0
"""A straight side stays where it is if it is longer than the first, in mm, and than so many tolerances."""


class Kind(NamedTuple):
    """How an outline is made.

    ``edges``: which strips are fitted as such: "" none, "in" and "out" those of paper inside or outside.
    ``step``: degrees between directions, 0 for any direction. ``part``: of the tolerance, how far lines may be off.
    ``arcs``: sides around a bend are tangents of one circle. ``disks``: edges of a strip are tangents of common disks.
    ``lead``: 1 or 2, the inner (shorter) or outer edge of a strip is fitted first, and the other so that it follows it;
    3: the inner edge of every bend; 0: both at once. ``regular``: circles become regular polygons, with a "side" or a
    "corner" on the axis. ``best``: each strip as it has the fewest sides.
    ``exact``: straight sides of the drawing stay where they are.
    ``weight``: what a side costs more that is off by all of the tolerance. ``loose``: it is fitted within so many times
    the tolerance, and has to be tightened.
    """

    edges: str
    step: float
    part: float
    arcs: bool = False
    disks: bool = False
    lead: int = 0
    best: bool = False
    exact: bool = False
    regular: str = ""
    weight: float = 0.3
    loose: float = 1.0

    def __str__(self) -> str:
        words = [self.edges or "sides", f"{self.step:g}" if self.step else "any", f"{self.part:g}", self.regular]
        words += (
            ["arcs"] * self.arcs
            + ["disks"] * self.disks
            + ["best"] * self.best
            + ["exact"] * self.exact
            + [f"lead {self.lead}"] * (self.lead > 0)
        )
        words += [f"weight {self.weight:g}"] * (self.weight != 0.3)
        words += [f"loose {self.loose:g}"] * (self.loose > 1)
        return " ".join(word for word in words if word)


@dataclass(frozen=True, eq=False)
class Start:
    """An outline in mm of the frame, the kind it is, how many lines were fitted, and how symmetric it is."""

    shape: Shape
    kind: Kind
    axes: tuple[Axis, ...]


BEST = (
    Kind("in", 0.0, 0.95, lead=2),
    Kind("in", 0.0, 0.95, lead=1),
    Kind("in", 0.0, 0.95, arcs=True, lead=3),
    Kind("in", 0.0, 0.95, arcs=True, lead=2),
    Kind("in", 0.0, 0.95, disks=True),
)
"""How strips are fitted of which the best fitting is taken."""

TAPER = 0.4
"""What a side of a strip costs more whose edges are not parallel, where the best fitting is chosen."""

KINDS = (
    Kind("in", 0.0, 0.95, best=True),
    Kind("in", 0.0, 0.95, arcs=True, lead=3),
    Kind("in", 0.0, 0.8, arcs=True, lead=3),
    Kind("in", 0.0, 0.95, lead=1),
    Kind("in", 0.0, 0.95, arcs=True, lead=2),
    Kind("in", 0.0, 0.95, disks=True),
    Kind("in", 0.0, 0.7, lead=2),
    Kind("in", 0.0, 0.95, disks=True, weight=1.5),
    Kind("", 0.0, 0.95, exact=True),
    Kind("", 0.0, 0.95, arcs=True, exact=True),
    Kind("", 0.0, 0.95),
    Kind("", 0.0, 0.95, arcs=True),
    Kind("in", 0.0, 0.7, lead=1),
    Kind("in", 0.0, 0.7, arcs=True, lead=2),
    Kind("in", 0.0, 0.65, arcs=True, lead=3),
    Kind("", 0.0, 0.7, arcs=True, exact=True),
    Kind("", 0.0, 0.7),
    Kind("in", 0.0, 0.7, disks=True),
    Kind("", 0.0, 0.7, arcs=True),
    *(Kind("", step, 0.95) for step in (15.0, 18.0, 22.5, 30.0)),
    Kind("in", 0.0, 0.5, lead=1),
    Kind("", 0.0, 0.5),
)
"""The kinds of outlines: those first that were the best, or nearly, for most letters."""

FIRM_KINDS = (Kind("", 0.0, 0.95, arcs=True, exact=True), Kind("", 18.0, 0.95))
"""Kinds that are no better where they are loose."""

LOOSE_KINDS = tuple(
    kind._replace(loose=loose) for loose in (1.4, 1.15) for kind in KINDS if kind.part >= 0.8 and kind not in FIRM_KINDS
)
"""The kinds that are fitted within a larger tolerance: the corners may come nearer together, or become fewer."""


def starts(drawn: Shape, tolerance: float, axes: Sequence[Axis] = ()) -> Iterator[Shape]:
    """Yield outlines within ``tolerance`` mm of a drawing's dense loops, the most promising first.

    ``drawn``: the loops in mm of the frame, flattened to 0.02 mm or so. ``axes``: mirror axes to keep exactly, as
    for ``chains_of``. Each outline has the same loops, nested in the same way.
    """
    for start in all_starts(drawn, tolerance, axes):
        yield start.shape


def all_starts(drawn: Shape, tolerance: float, axes: Sequence[Axis] = (), *, loose: bool = False) -> Iterator[Start]:
    """Yield outlines as ``starts`` does, with how they were made.

    ``loose``: also such as are farther off than the tolerance, from which outlines within it may be made.
    """
    near = Near(drawn)
    seen: list[Floats] = []
    for some in [tuple(axes), ()] if axes else [()]:
        chains = chains_of(drawn, tolerance, some)
        if chains is None:
            continue
        fitter = _Fitter(drawn, chains, max(LEAST_ROOM * tolerance, tolerance - near.asymmetry(some)))
        for kind in fitter.kinds(loose=loose):
            lines = fitter.lines(kind)
            if lines is None:
                continue
            shape = fitter.shape(near, lines, tolerance * (FARTHEST if kind.loose > 1 else 1.0))
            if shape is None or _is_known(shape, seen, 0.05 * tolerance):
                continue
            yield Start(shape, kind, some)


def _is_known(shape: Shape, seen: list[Floats], same: float) -> bool:
    """Tell whether an outline has been seen, and remember it."""
    corners = np.concatenate(shape.loops)
    order = np.lexsort(np.round(corners, 3).T)
    corners = corners[order]
    for other in seen:
        if len(other) == len(corners) and np.abs(other - corners).max() < same:
            return True
    seen.append(corners)
    return False


Fitted = list[tuple[int, list[Line]]]
"""Fitted lines, by the number of their chain."""


class _Fitter:
    """Fits the chains of one drawing; what several kinds need is found once."""

    def __init__(self, drawn: Shape, chains: Chains, tolerance: float) -> None:
        self._pairs = Pairs(chains)
        within = find_strips(self._pairs, inside=True)
        recut = recut_chains(chains, within)
        if recut is not chains:
            self._pairs = Pairs(recut)
            within = find_strips(self._pairs, inside=True)
        self.drawn, self.chains, self.tolerance = drawn, recut, tolerance
        self._circles = circles_of(recut.chains, tolerance)
        self._strips: dict[str, list[Strip]] = {"in": within}
        self._fitted: dict[tuple[object, ...], Fitted] = {}
        self._straight = straight_directions(drawn.loops, max(12.0, 3 * tolerance), chains.axes)

    def kinds(self, *, loose: bool) -> Iterator[Kind]:
        """Yield the kinds of outlines, those with regular polygons for circles first, those that are loose last."""
        for kind in (*KINDS, *(LOOSE_KINDS if loose else ())):
            if self._circles:
                for regular in ("side", "corner"):
                    yield kind._replace(regular=regular)
            if len(self._circles) < len(self.chains.chains):
                yield kind

    def strips(self, edges: str) -> list[Strip]:
        """Return the strips for a kind, of which no two overlap."""
        if not edges:
            return []
        if edges not in self._strips:
            self._strips[edges] = find_strips(self._pairs, inside=edges == "in")
        return self._strips[edges]

    def shape(self, near: Near, lines: list[list[Line]], tolerance: float) -> Shape | None:
        """Return the outline of fitted lines, or None if it is no shape near enough."""
        for true_corners in (False, True):
            loops = self.chains.loops(lines, self.tolerance, true_corners=true_corners)
            shape = None if loops is None else near.shape(loops, tolerance)
            if shape is not None:
                return shape
        return None

    def lines(self, kind: Kind) -> list[list[Line]] | None:
        """Return the lines of an outline of a kind, chain by chain, or None where there is none."""
        strips = self.strips(kind.edges)
        if kind.edges and not strips:
            return None
        directions = None
        if kind.step:
            directions = direction_set(self._straight, math.radians(kind.step))
        tolerance = kind.part * kind.loose * self.tolerance
        lines: list[list[Line]] = [[] for _ in self.chains.chains]
        circles = self._circles if kind.regular else []
        regular = {circle.chain for circle in circles}
        for circle in circles:
            chain = self.chains.chains[circle.chain]
            lines[circle.chain] = regular_lines(chain, circle, circle.sides(tolerance), flat=kind.regular == "side")
        strips = [strip for strip in strips if not regular.intersection(strip.chains)]
        matched = False
        for strip in strips:
            some = self._lines_of(strip, kind)
            matched |= bool(some)
            if kind.lead and not some:
                some = self._lines_of(strip, BEST[-1]._replace(loose=kind.loose))
            for number, more in some:
                lines[number] += more
        if strips and not matched:
            return None
        if kind.exact:
            lines = [self._straight_sides(chain) for chain in self.chains.chains]
        fitted = []
        for number, (chain, known) in enumerate(zip(self.chains.chains, lines, strict=True)):
            if number in regular:
                fitted.append(known)
                continue
            whole = _filled(chain, known, tolerance, directions, kind)
            if whole is None:
                return None
            fitted.append(whole)
        return fitted

    def _straight_sides(self, chain: Chain) -> list[Line]:
        """Return the lines of a chain's long straight sides."""
        sides = []
        for a, b in straight_parts(chain.points, max(LONG[0], LONG[1] * self.tolerance)):
            ahead = chain.points[b] - chain.points[a]
            normal = np.array([-ahead[1], ahead[0]]) / np.hypot(*ahead)
            sides.append(Line(a, b, normal, float(normal @ chain.points[a])))
        return sides

    def _lines_of(self, strip: Strip, kind: Kind) -> Fitted:
        """Return the lines of both edges of a strip, with the numbers of their chains; nothing if there are none."""
        if kind.best:
            every = [some for one in BEST if (some := self._lines_of(strip, one._replace(loose=kind.loose)))]
            return min(every, key=_price, default=[])
        key = (id(strip), kind.arcs, kind.disks, kind.lead, kind.part, kind.weight, kind.loose)
        if key not in self._fitted:
            self._fitted[key] = self._fitted_strip(strip, kind)
        return self._fitted[key]

    def _fitted_strip(self, strip: Strip, kind: Kind) -> Fitted:
        """Fit both edges of a strip as a kind says."""
        chains = [self.chains.chains[number] for number in strip.chains]
        rows, tolerance = strip.rows(self.chains.chains), kind.part * kind.loose * self.tolerance
        first = last = ANY
        (a0, b0), (a1, b1) = strip.places[0], strip.places[-1]
        if a0 == 0 and b0 == len(chains[1].points) - 1 and chains[0].ends[0] is not None:
            first = _across(chains[0].ends[0], rows[0, 1] - rows[0, 0])
        if b1 == 0 and a1 == len(chains[0].points) - 1 and chains[0].ends[1] is not None:
            last = _across(chains[0].ends[1], rows[0, -1] - rows[0, -2])
        along = strip.disks * (1.0, 1.0, 0.5 if strip.inside else -0.5)
        if kind.lead:
            sides = self._following(rows, along, tolerance, kind, first, last)
        else:
            sides = fit_disks(rows, along, tolerance, kind.weight, paired=strip.paired, first=first, last=last)
            if sides is None:
                return self._fitted_strip(strip.trimmed(), kind) if strip.can_be_trimmed else []
        if sides is None:
            return []
        front, back = [], []
        for s, (normal, other) in enumerate(zip(*sides.normals, strict=True)):
            start, end = strip.places[sides.cuts[s]], strip.places[sides.cuts[s + 1]]
            front.append(Line(int(start[0]), int(end[0]), normal, float(sides.offsets[0, s])))
            back.append(Line(int(end[1]), int(start[1]), -other, -float(sides.offsets[1, s])))
        return [(strip.chains[0], front), (strip.chains[1], back[::-1])]

    def _following(
        self, rows: Floats, along: Floats, tolerance: float, kind: Kind, first: End, last: End
    ) -> Sides | None:
        """Return the lines of a strip of which one edge leads."""
        if kind.lead == 3:
            known = lead_in_bends(
                rows, tolerance, FOLLOWED * kind.loose * self.tolerance, kind.weight, first=first, last=last
            )
            if known is None:
                return None
            return follow(rows, along, known, FOLLOWING * kind.loose * self.tolerance, first=first, last=last)
        longer = np.hypot(*np.diff(rows, axis=1).transpose(2, 0, 1)).sum(axis=1)
        edge = int(bool(longer[1] < longer[0]) == (kind.lead == 1))
        fitted = fit_bends if kind.arcs else fit
        reach = straight_as_far_as(rows[1 - edge], FOLLOWED * kind.loose * self.tolerance)
        lead = fitted(rows[edge], tolerance, kind.weight, reach=reach, first=first, last=last)
        if lead is None:
            return None
        return follow(rows, along, lead_of(lead, edge), FOLLOWING * kind.loose * self.tolerance, first=first, last=last)


def _price(fitted: Fitted) -> float:
    """Return what the sides of a strip cost: those whose edges are not parallel cost more."""
    (_, front), (_, back) = fitted
    tapered = [
        abs(float(a.normal[0] * b.normal[1] - a.normal[1] * b.normal[0])) > 1e-9
        for a, b in zip(front, back[::-1], strict=True)
    ]
    return len(tapered) + TAPER * sum(tapered)


def _across(axis: Axis, ahead: Floats) -> End:
    """Return what a piece is that begins or ends on an axis, and runs ``ahead``: best at a right angle to it."""
    normal = axis.along
    if float(ahead[0] * normal[1] - ahead[1] * normal[0]) < 0:
        normal = -normal
    x, y = normal.tolist()
    return End(pieces.DIRECTED, (x, y), price=0.5)


def _filled(
    chain: Chain, known: list[Line], tolerance: float, directions: Floats | None, kind: Kind
) -> list[Line] | None:
    """Return lines for a whole chain: those known, in order, and between them the fewest that fit."""
    known = sorted(known, key=lambda line: (line.start, line.end))
    runs: list[list[Line]] = []
    for line in known:
        if runs and runs[-1][-1].end == line.start:
            runs[-1].append(line)
        else:
            runs.append([line])
    whole: list[Line] = []
    here, behind = 0, None
    for run in [*runs, None]:
        there = run[0].start if run else len(chain.points) - 1
        if there < here:
            return None
        if there > here:
            between = _between(chain, here, there, behind, run[0] if run else None, tolerance, directions, kind)
            if between is None:
                return None
            for line in between:
                if whole and line.normal is whole[-1].normal:
                    whole[-1] = Line(whole[-1].start, line.end, line.normal, line.offset)
                else:
                    whole.append(line)
        if run:
            if whole and run[0].normal is whole[-1].normal:
                whole[-1] = Line(whole[-1].start, run[0].end, run[0].normal, run[0].offset)
                whole += run[1:]
            else:
                whole += run
            here, behind = run[-1].end, run[-1]
    return whole


def _between(
    chain: Chain,
    here: int,
    there: int,
    behind: Line | None,
    ahead: Line | None,
    tolerance: float,
    directions: Floats | None,
    kind: Kind,
) -> list[Line] | None:
    """Return the fewest lines from sample ``here`` to ``there`` of a chain, between two known ones, which may go on."""
    points = chain.points[here : there + 1]
    start, end = chain.ends
    first = last = ANY
    if behind is not None and not chain.corners[here]:
        first = _going_on(behind)
    elif here == 0 and start is not None:
        first = _across(start, points[1] - points[0])
    if ahead is not None and not chain.corners[there]:
        last = _going_on(ahead)
    elif there == len(chain.points) - 1 and end is not None:
        last = _across(end, points[-1] - points[-2])
    breaks = chain.corners[here : there + 1]
    sides, weight = None, kind.weight
    if kind.arcs:
        sides = fit_bends(points, tolerance, weight, breaks=breaks, first=first, last=last)
    if sides is None:
        sides = fit(points, tolerance, weight, breaks=breaks, first=first, last=last, directions=directions)
    if sides is None:
        return None
    lines = [
        Line(int(here + sides.cuts[s]), int(here + sides.cuts[s + 1]), normal, float(sides.offsets[0, s]))
        for s, normal in enumerate(sides.normals[0])
    ]
    if behind is not None and lines and _is_same(lines[0], behind):
        lines[0] = Line(lines[0].start, lines[0].end, behind.normal, behind.offset)
    if ahead is not None and lines and _is_same(lines[-1], ahead):
        lines[-1] = Line(lines[-1].start, lines[-1].end, ahead.normal, ahead.offset)
    return lines


def _going_on(line: Line) -> End:
    x, y = line.normal.tolist()
    return End(pieces.GIVEN, (x, y), line.offset)


def _is_same(a: Line, b: Line) -> bool:
    return bool((a.normal == b.normal).all()) and a.offset == b.offset
