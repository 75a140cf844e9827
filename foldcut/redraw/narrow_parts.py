"""Parts of a drawing that are smaller than a tolerance: which they are, and the drawing with them gone or larger.

``Target`` and tolerance -> ``SmallPart``s. An outline that may be off by the tolerance need not have a hole, a part, a
slit or a neck that is hardly wider; so these are named before they go, and can be kept by making them wider.

Holes and parts are loops. Slits and gaps are what a disc as wide as the tolerance cannot reach from outside the shape
(its morphological closing); necks and tails are what it cannot reach inside (its opening). The tips of corners are left
out: a corner can be kept, however sharp it is.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from foldcut.core.arrays import Floats
from foldcut.core.errors import ShapeError
from foldcut.drawing.curved import curves_of
from foldcut.drawing.shape import make_shape, polygon_loops
from foldcut.redraw.target import Target

__all__ = ["SmallPart", "enlarged", "small_parts", "treated", "without"]

SMALL = 0.01
"""What a disc cannot reach is no part if its area is less than this, relative to the square of the disc's width."""

TIP = 0.65
"""The tip of a corner fills about half of its length times the width of its mouth; a slit fills more than this."""

ROOM = 0.01
"""What is made larger is made a little larger than asked for, relative to its width."""

OVERLAP_MM = 1e-5
"""By how much areas are made to overlap before they are united, in mm of the frame."""

FLAT_MM = 3e-3
"""How far loops that were changed may be off for having fewer corners, in mm of the frame."""

MOST_ROUNDS = 4
"""How often small parts are looked for in what is left without others."""

_MITRE = {"join_style": "mitre", "mitre_limit": 3.0}

KINDS = {
    "hole": "a hole",
    "part": "a part",
    "slit": "a slit",
    "gap": "a gap between two sides",
    "neck": "a neck",
    "tail": "a thin end",
}
"""What small parts are called. A slit ends in the shape and a gap goes through; a neck joins what a tail ends."""


@dataclass(frozen=True, eq=False)
class SmallPart:
    """A part of a drawing that is smaller than a tolerance.

    ``kind`` is one of ``KINDS``; ``width`` is in mm; ``place`` ``(2,)`` is in its middle. ``loop``: the loop of the
    target that it is, or None. ``area`` is what it covers: of paper for a part, neck or tail, and else of the space.
    """

    kind: str
    width: float
    place: Floats
    area: shapely.Geometry
    loop: int | None = None

    @property
    def name(self) -> str:
        """What it is and where, in words, in mm of the frame."""
        return self.named(self.place, 1.0)

    def named(self, place: Floats, scale: float) -> str:
        """Return what it is in words, for a sheet on which it lies at ``place`` and is ``scale`` times as large."""
        x, y = np.round(place, 1).tolist()
        return f"{KINDS[self.kind]} {self.width * scale:.2g} mm wide at ({x:g}, {y:g})"


def small_parts(target: Target, tolerance: float) -> list[SmallPart]:
    """Return what is smaller than ``tolerance`` mm, from the narrowest to the widest.

    These are loops in which no disc of the radius ``tolerance`` fits, and slits, gaps, necks and thin ends that are
    narrower than ``tolerance``. What lies in a hole or part that is returned is not returned again.
    """
    found = list(_small_loops(target, tolerance))
    area = _without_loops(target, {part.loop for part in found if part.loop is not None})
    if not area.is_empty:
        half = tolerance / 2
        closed = area.buffer(half).buffer(-half)
        low, high = np.array(area.bounds).reshape(2, 2) + np.array([[-1], [1]]) * 10 * tolerance
        page = shapely.box(*low, *high)
        found += _narrow(page.difference(area), page.difference(closed), tolerance, ("slit", "gap"))
        found += _narrow(area, area.buffer(-half).buffer(half), tolerance, ("tail", "neck"))
    return sorted(found, key=lambda part: part.width)


def treated(target: Target, tolerance: float, treatment: str) -> tuple[Target, list[SmallPart]]:
    """Return a target whose small parts were treated, and these parts.

    ``treatment``: "drop" leaves them out, "enlarge" makes them twice as wide as ``tolerance`` where there is room, and
    "keep" leaves them alone. If nothing else is there, the widest stays.
    """
    parts = small_parts(target, tolerance)
    if treatment == "enlarge":
        return enlarged(target, parts, 2 * tolerance)[0], parts
    if treatment == "keep":
        return target, parts
    found: list[SmallPart] = []
    for _ in range(MOST_ROUNDS):  # what is left when a neck has gone may be small
        outer = {number for number, parent in enumerate(target.parent) if parent < 0}
        if outer <= {part.loop for part in parts}:
            parts.remove(max((part for part in parts if part.loop in outer), key=lambda part: part.width))
        if not parts:
            break
        found += parts
        target = without(target, parts)
        parts = small_parts(target, tolerance)
    return target, found


def without(target: Target, parts: Sequence[SmallPart]) -> Target:
    """Return a target without some of its small parts; loops that are not touched keep their curves.

    Raises ``ShapeError`` if nothing is left, or nothing that is a shape.
    """
    gone = _with_inner(target, {part.loop for part in parts if part.loop is not None})
    others = [part for part in parts if part.loop is None]
    kept = [number for number in range(len(target.loops)) if number not in gone]
    if not kept:
        raise ShapeError("every part of the drawing is smaller than the tolerance; give a smaller tolerance")
    if not others:
        number_of = {old: new for new, old in enumerate(kept)}
        parent = [number_of.get(target.parent[old], -1) for old in kept]
        return Target.of_curves([target.curves[old] for old in kept], parent)
    area = _without_loops(target, gone)
    for part in others:
        area = _with_change(area, part, 0.0)
    return _target(target, area)


def enlarged(target: Target, parts: Sequence[SmallPart], width: float) -> tuple[Target, list[SmallPart]]:
    """Return a target in which some small parts are ``width`` mm wide, and those that there is no room for.

    Those stay as they are. Loops that are not touched keep their curves.
    """
    area, left = target.area, []
    for part in parts:
        grown = _with_change(area, part, max((1 + ROOM) * width - part.width, 0.0) / 2, keep=True)
        if _topology(grown) == _topology(area):
            area = grown
        else:
            left.append(part)
    return (_target(target, area) if len(left) < len(parts) else target), left


def _target(target: Target, area: shapely.Geometry) -> Target:
    """Return the target for an area made from that of another one."""
    polygons = [part for part in shapely.get_parts(area) if isinstance(part, shapely.Polygon) and part.area > 0]
    corners = np.concatenate(target.loops) @ (1, 1j)
    loops = []
    for loop in polygon_loops(polygons):
        if not np.isin(loop @ (1, 1j), corners).all():  # it was changed, and may have corners very near to each other
            loop = shapely.get_coordinates(shapely.simplify(shapely.Polygon(loop), FLAT_MM))[:-1]
        if len(loop) > 2:
            loops.append(loop)
    shape = make_shape(loops)
    return Target.of(shape, curves_of(shape, target.loops, target.curves))


def _with_change(area: shapely.Geometry, part: SmallPart, grow: float, *, keep: bool = False) -> shapely.Geometry:
    """Return an area without a small part or, to ``keep`` it, with the part wider by ``grow`` on both sides."""
    is_paper = part.kind in ("part", "neck", "tail")
    reach = part.area.buffer(grow + OVERLAP_MM, **_MITRE)
    return area.union(reach) if is_paper == keep else area.difference(reach)


def _topology(area: shapely.Geometry) -> tuple[int, int]:
    """Return how many parts and holes an area has."""
    parts = shapely.get_parts(area)
    return len(parts), int(shapely.get_num_interior_rings(parts).sum())


def _with_inner(target: Target, loops: set[int]) -> set[int]:
    """Return loops and all that lie within them."""
    found = set(loops)
    for number in sorted(range(len(target.loops)), key=target.shape.depth):
        if target.parent[number] in found:
            found.add(number)
    return found


def _without_loops(target: Target, loops: set[int]) -> shapely.Geometry:
    gone = _with_inner(target, loops)
    if not gone:
        return target.area
    area = shapely.Polygon()
    for number in range(len(target.loops)):
        if number not in gone:
            area = area.symmetric_difference(shapely.Polygon(target.loops[number]))
    return area


def _small_loops(target: Target, tolerance: float) -> Iterator[SmallPart]:
    """Yield the loops in which no disc of the radius ``tolerance`` fits, but none within another one."""
    polygons = [shapely.Polygon(loop) for loop in target.loops]
    small = {number for number, one in enumerate(polygons) if one.buffer(-tolerance).is_empty}
    inner = {number for number in _with_inner(target, small) if target.parent[number] in _with_inner(target, small)}
    for number in sorted(small - inner):
        kind = "hole" if target.shape.depth(number) % 2 else "part"
        one = polygons[number]
        yield SmallPart(kind, _widest(one, tolerance), _middle(one), one, number)


def _widest(polygon: shapely.Polygon, tolerance: float) -> float:
    """Return the diameter of the largest disc in a polygon."""
    return 2 * float(shapely.maximum_inscribed_circle(polygon, tolerance=1e-3 * tolerance).length)


def _middle(polygon: shapely.Polygon) -> Floats:
    """Return the point of a polygon that is nearest to its middle."""
    return np.array(shapely.shortest_line(polygon, polygon.centroid).coords[0])


def _narrow(
    area: shapely.Geometry, reached: shapely.Geometry, tolerance: float, kinds: tuple[str, str]
) -> Iterator[SmallPart]:
    """Yield the places of an area that a disc of the diameter ``tolerance`` does not reach, except tips of corners.

    ``kinds``: what a place is called that is reached from one end, and one that is reached from several.
    """
    for place in shapely.get_parts(area.difference(reached)):
        if not isinstance(place, shapely.Polygon) or place.area < SMALL * tolerance**2:
            continue
        slack = 1e-3 * tolerance
        mouths = [one for one in shapely.get_parts(reached.intersection(place.buffer(slack))) if one.area > 0]
        if not mouths:  # all of a loop or part, which is told apart by its width
            continue
        corners = shapely.points(shapely.get_coordinates(place))
        if len(mouths) > 1:
            sides = shapely.get_parts(
                shapely.line_merge(place.exterior.difference(shapely.union_all(mouths).buffer(2 * slack)))
            )
            sides = sorted((one for one in sides if one.length > 2 * slack), key=lambda one: -one.length)[:2]
            if len(sides) == 2:
                width = float(shapely.distance(*sides))
                yield SmallPart(kinds[1], width, _middle(place), place)
            continue
        length = float(shapely.distance(corners, mouths[0]).max())
        if length > tolerance and place.area > TIP * length * _mouth_width(mouths[0], slack):
            yield SmallPart(kinds[0], _widest(place, tolerance), _middle(place), place)


def _mouth_width(mouth: shapely.Geometry, slack: float) -> float:
    """Return the width of the thin band along which a narrow place is reached."""
    corners = shapely.get_coordinates(mouth.minimum_rotated_rectangle)
    return float(np.hypot(*np.diff(corners, axis=0).T).max(initial=0.0)) - 2 * slack
