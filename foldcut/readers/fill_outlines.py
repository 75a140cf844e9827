"""What outlines fill, and what several of them fill together: fill rules, overlaps, and white over other colours.

Loops of single outlines -> even-odd sets of loops (``fill``); sets -> one set (``unite``). Loops that touch nothing
keep their numbers to the last digit. Only where outlines cross or touch does shapely make new ones. What is in the
result no more, since others cover it, is told with its name and its place.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum
from functools import cached_property

import numpy as np
import shapely

from foldcut.core.arrays import Floats, points_array
from foldcut.drawing.shape import polygon_loops
from foldcut.geometry.crossings import are_tangled, faces_of_lines, winding
from foldcut.geometry.union_find import groups

MOST_NAMED = 5
"""A note names this many outlines; the others are counted."""

MOST_JUDGED = 2_000
"""Of more outlines that are united with each other, it is not told which of them are covered."""

ALL = 1 - 1e-9
"""An outline is covered if more than this share of its area is."""

Place = Callable[[Floats], str]
"""Tells a point in the coordinates of the file."""


class Paint(Enum):
    """How the area of an outline is painted, as far as it matters for what is seen on white paper."""

    DARK = "any colour but white"
    WHITE = "white"
    WHITE_WITH_STROKE = "white, with a stroke of another colour around it"


@dataclass(frozen=True, eq=False)
class Part:
    """What one outline fills, as an even-odd set of loops, and its name and paint."""

    loops: Sequence[Floats]
    name: str = "an outline"
    paint: Paint = Paint.DARK

    @cached_property
    def area(self) -> shapely.Geometry:
        """The area."""
        return _filled_area(self.loops, _closed_lines(self.loops), True)


@dataclass(frozen=True, eq=False)
class United:
    """The loops of several parts as one even-odd set, what was done in words, and the loops that are in it no more."""

    loops: list[Floats]
    notes: list[str]
    lost: list[Floats]


def fill(loops: Sequence[Floats], *, even_odd: bool) -> list[Floats]:
    """Return the boundary of what an outline of several loops fills, as an even-odd set."""
    if len(loops) == 1 and len(loops[0]) == 3:
        return list(loops)
    rings = _closed_lines(loops)
    if rings is None:
        return list(loops)
    if shapely.is_simple(shapely.multilinestrings(rings)) and min(map(len, loops)) > 2:
        return list(loops) if even_odd or len(loops) == 1 else _nonzero(loops)
    if are_tangled(loops):
        return list(loops)
    return list(polygon_loops(shapely.get_parts(_filled_area(loops, rings, even_odd))))


def unite(parts: Sequence[Part], place: Place) -> United:
    """Return the loops of several even-odd sets, in the order in which they are painted, as one set.

    Sets whose outlines meet are united; where one of them is white and painted over another, it is cut out. An outline
    that lies within another without touching it is its hole. What is white and not over anything is left out if there
    is anything else.
    """
    parts = [part for part in parts if part.loops]
    loops = [loop for part in parts for loop in part.loops]
    rings = _closed_lines(loops)
    if len(parts) < 2 or rings is None:
        return United(loops, [], [])
    is_simple = bool(shapely.is_simple(shapely.multilinestrings(rings)))
    mixed = len({part.paint is Paint.WHITE for part in parts}) == 2
    if (is_simple and not mixed) or (not is_simple and are_tangled(loops)):
        return United(loops, [], [])
    groups = [[number] for number in range(len(parts))] if is_simple else _groups(parts)
    ground = _Ground(parts) if mixed else None
    united, told = list[Floats](), _Told(place)
    for group in groups:
        members = [parts[number] for number in group]
        on_others = ground is not None and ground.is_under(parts[group[0]], group)
        if len(members) > 1:
            united += _together(members, on_others, told)
        elif ground is not None and members[0].paint is Paint.WHITE and not on_others:
            told.on_paper += members
        else:
            united += members[0].loops
    return United(united, told.notes(), [loop for part in told.lost() for loop in part.loops])


def _groups(parts: Sequence[Part]) -> list[list[int]]:
    """Return the numbers of the parts whose outlines meet, directly or through others, in order."""
    lines = np.array([shapely.multilinestrings(_closed_lines(part.loops)) for part in parts])
    one, other = shapely.STRtree(lines).query(lines, predicate="intersects")
    pairs = list(zip(one.tolist(), other.tolist(), strict=True))
    members: dict[int, list[int]] = {}
    for number, first in enumerate(groups(len(parts), pairs)):
        members.setdefault(first, []).append(number)
    return list(members.values())


class _Ground:
    """What white can be painted over."""

    def __init__(self, parts: Sequence[Part]) -> None:
        self.numbers = [number for number, part in enumerate(parts) if part.paint is not Paint.WHITE]
        self.tree = shapely.STRtree([parts[number].area for number in self.numbers])
        self.order = {id(part): number for number, part in enumerate(parts)}

    def is_under(self, part: Part, group: Sequence[int]) -> bool:
        """Whether another part that is not of its group was painted before, around a part."""
        found = self.tree.query(shapely.points(part.loops[0][0]), predicate="within").tolist()
        numbers = (self.numbers[at] for at in found)
        return any(number < self.order[id(part)] and number not in group for number in numbers)


def _together(members: Sequence[Part], on_others: bool, told: _Told) -> list[Floats]:
    """Return the loops of parts that meet, in the order in which they are painted."""
    dark = [part for part in members if part.paint is Paint.DARK]
    if not dark or len(dark) == len(members):
        told.united += len(members)
        told.covered += _covered(members)
        return list(polygon_loops(shapely.get_parts(shapely.union_all([part.area for part in members]))))
    whole = shapely.box(*shapely.total_bounds([part.area for part in members])).buffer(1.0)
    area = whole if on_others else shapely.Polygon()
    for part in members:
        over = _share_in(area, part)
        if part.paint is Paint.DARK or (part.paint is Paint.WHITE_WITH_STROKE and over < ALL):
            area = shapely.union(area, part.area)
        else:
            (told.cut_out if over > 1 - ALL else told.on_paper).append(part)
            area = shapely.difference(area, part.area)
    if len(dark) > 1:
        told.united += len(dark)
    gone = [part for part in dark if _share_in(area, part) < 1 - ALL]
    told.covered += gone + [part for part in _covered(dark) if all(part is not one for one in gone)]
    if on_others:
        area = shapely.difference(whole, area)
    return list(polygon_loops(one for one in shapely.get_parts(area) if isinstance(one, shapely.Polygon)))


def _share_in(area: shapely.Geometry, part: Part) -> float:
    """Return how much of a part lies in an area, from 0 to 1."""
    return float(shapely.area(shapely.intersection(area, part.area)) / shapely.area(part.area))


def _covered(parts: Sequence[Part]) -> list[Part]:
    """Return those parts, and those holes of parts, that the others cover; of two that are the same, the second."""
    if len(parts) < 2 or len(parts) > MOST_JUDGED:
        return []
    areas = [part.area for part in parts]
    tree = shapely.STRtree(areas)
    found: list[Part] = []
    left = np.ones(len(parts), dtype=bool)
    for number in sorted(range(len(parts)), key=lambda number: (areas[number].area, -number)):
        near = tree.query(areas[number], predicate="intersects")
        others = shapely.union_all([areas[one] for one in near.tolist() if left[one] and one != number])
        if shapely.intersection(areas[number], others).area >= ALL * areas[number].area:
            left[number] = False
            found.append(parts[number])
            continue
        rings = [ring for polygon in shapely.get_parts(areas[number]) for ring in polygon.interiors]
        for ring in rings:
            hole = shapely.Polygon(ring)
            if shapely.intersection(hole, others).area >= ALL * hole.area:
                loop = points_array(shapely.get_coordinates(ring)[:-1])
                found.append(Part([loop], f"a hole of {parts[number].name}"))
    return found


class _Told:
    """Collects what is told of outlines that were united."""

    def __init__(self, place: Place) -> None:
        self.place, self.united = place, 0
        self.covered: list[Part] = []
        self.cut_out: list[Part] = []
        self.on_paper: list[Part] = []

    def lost(self) -> list[Part]:
        """Return what the result has no loop of."""
        return [*self.covered, *self.on_paper]

    def notes(self) -> list[str]:
        """Return a sentence for each kind of change."""
        united = f"{self.united} outlines that overlap or touch were united" if self.united else ""
        kinds = (
            ("left out {}, which others cover", self.covered),
            ("cut out {}, white over another colour", self.cut_out),
            ("left out {}, white on white paper", self.on_paper),
        )
        told = [words.format(named(parts, self.place)) for words, parts in kinds if parts]
        return [united, *told] if united else told


def named(parts: Sequence[Part], place: Place) -> str:
    """Return the names and the places of the first few parts, and how many more there are."""
    names = [f"{part.name} at {place(_middle(part))}" for part in parts[:MOST_NAMED]]
    more = len(parts) - len(names)
    return ", ".join(names) + (f" and {more} more" if more else "")


def _middle(part: Part) -> Floats:
    """Return the middle of the box around a part."""
    points = np.concatenate(part.loops)
    middle: Floats = (points.min(axis=0) + points.max(axis=0)) / 2
    return middle


def _closed_lines(loops: Sequence[Floats]) -> list[shapely.LineString] | None:
    """Return the loops as closed lines, or None if there are none or if a number is not finite."""
    if not loops or not all(len(loop) > 1 and np.isfinite(loop).all() for loop in loops):
        return None
    return [shapely.linestrings(np.concatenate([loop, loop[:1]])) for loop in loops]


def _filled_area(
    loops: Sequence[Floats], lines: Sequence[shapely.LineString] | None, even_odd: bool
) -> shapely.Geometry:
    """Return the area that the loops fill: those faces between all lines whose winding number says so."""
    faces, inside = faces_of_lines(lines or ())
    turns = sum((winding(inside, loop) for loop in loops), np.zeros(len(inside), dtype=np.int64))
    return shapely.union_all(faces[turns % 2 == 1 if even_odd else turns != 0])


def _nonzero(loops: Sequence[Floats]) -> list[Floats]:
    """Return those of some disjoint loops that have a winding number of zero on exactly one side."""
    rings = shapely.linearrings(np.concatenate(loops), indices=np.repeat(np.arange(len(loops)), list(map(len, loops))))
    own = np.where(shapely.is_ccw(rings), 1, -1)
    polygons, starts = shapely.polygons(rings), shapely.points([loop[0] for loop in loops])
    # A loop is not within itself, since it starts on its own edge.
    inside, around = shapely.STRtree(polygons).query(starts, predicate="within")
    outside = np.bincount(inside, weights=own[around], minlength=len(loops))
    return [loop for loop, kept in zip(loops, (outside == 0) != (outside + own == 0), strict=True) if kept]
