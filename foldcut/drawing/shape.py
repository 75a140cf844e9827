"""Make a valid shape from drawn loops, or say where the drawing is at fault.

Closed loops in the drawing's own units -> ``Shape``. Nothing is moved: the corners keep their numbers. Only repeated
and collinear ones are left out, and clockwise loops are reversed. What can be repaired has been repaired by
``drawing.mend`` before.

Invariants of the result, which ``invariant_faults`` checks: every loop is simple and counter-clockwise and has at least
three corners, no three corners in a row are collinear, no two loops cross or touch, and ``parent`` names the innermost
loop around each loop. No feature is smaller than the tolerances below. These are relative to the diagonal of the
drawing's bounding box. All decisions are made in coordinates that are centred on that box and divided by its diagonal,
so that scale and position do not matter.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import NoReturn

import numpy as np
import shapely
from numpy.typing import ArrayLike

from foldcut.core.arrays import Floats, Ints, blocks, index_array, points_array
from foldcut.core.errors import ShapeError, TouchError
from foldcut.core.model import Shape
from foldcut.geometry.vectors import signed_area

COLLINEAR_TOLERANCE = 1e-7
"""A corner that is nearer than this to the line between its neighbours is left out (relative to the diagonal)."""

FEATURE_TOLERANCE = 1e-6
"""No corner may come nearer than this to an edge that does not end in it (relative to the diagonal)."""

SHARPEST_CORNER = 0.01
"""No corner may be sharper than this, in degrees."""

ROUNDING_LIMIT = 1e-8
"""The rounding error of the coordinates may not exceed this (relative to the diagonal)."""

LARGEST_NUMBER = 1e100
"""Coordinates beyond this overflow when they are multiplied; in a drawing smaller than its inverse they underflow."""

_BATCH = 256
"""The number of corners or edges in one query; it bounds the memory that a tangle of edges can take."""

Place = tuple[float, float]


def polygon_loops(polygons: Iterable[shapely.Polygon]) -> tuple[Floats, ...]:
    """Return the outlines and holes of polygons as loops, without repeated last points."""
    rings = [ring for polygon in polygons for ring in (polygon.exterior, *polygon.interiors)]
    return tuple(points_array(shapely.get_coordinates(ring)[:-1]) for ring in rings)


def make_shape(loops: Sequence[ArrayLike], *, y_down: bool = False) -> Shape:
    """Return the shape that ``loops`` enclose by the even-odd rule.

    ``loops`` are sequences of x, y points in the drawing's units, in either direction, with or without a repeated last
    point, nested to any depth. Raises ``ShapeError`` with the number of the loop, from 1, and the place.
    ``y_down``: the y axis of the file points down, and y, which has changed its sign, gets it back in the error.
    """
    own_y = -1.0 if y_down else 1.0
    drawn = [_number_pairs(loop, number, own_y) for number, loop in enumerate(loops, start=1)]
    if not drawn:
        raise ShapeError("the drawing has no loops; draw at least one closed outline")
    frame = _Frame.around(drawn, own_y)
    corners: list[Floats] = []
    for number, points in enumerate(drawn, start=1):
        kept = points[_corner_indices(frame.to_unit(points), number, frame)]
        clockwise = signed_area(frame.to_unit(kept)) < 0
        corners.append(points_array(np.roll(kept[::-1], 1, axis=0) if clockwise else kept))
    boundary = _Boundary.of([frame.to_unit(loop) for loop in corners])
    _refuse_repeated(corners, frame)
    _refuse_spikes(boundary, frame)
    _refuse_crossings(boundary, frame)
    _refuse_small_features(boundary, frame)
    return Shape(tuple(corners), parents_of([frame.to_unit(loop) for loop in corners]))


def minimum_feature(shape: Shape) -> tuple[float, Place]:
    """Return the smallest distance from a corner to an edge that does not end in it, and the place of that corner.

    Both are in the units of ``shape``. No edge is shorter than this distance.
    """
    frame = _Frame.around(shape.loops)
    distance, corner, _ = _smallest_feature(_Boundary.of([frame.to_unit(loop) for loop in shape.loops]))
    x, y = np.concatenate(shape.loops)[corner].tolist()
    return distance * frame.diagonal, (x, y)


def invariant_faults(shape: Shape) -> list[str]:
    """Return which of the invariants of this module ``shape`` breaks; an empty list means none."""
    if not shape.loops or len(shape.parent) != len(shape.loops):
        return [f"{len(shape.loops)} loops with {len(shape.parent)} parents"]
    faults: list[str] = []
    for number, loop in enumerate(shape.loops, start=1):
        if loop.dtype != np.float64 or loop.ndim != 2 or loop.shape[1] != 2 or len(loop) < 3:
            return [f"loop {number} is {loop.dtype} {loop.shape}"]
        if not np.isfinite(loop).all():
            return [f"loop {number} has a number that is not finite"]
        if loop.flags.writeable:
            faults.append(f"loop {number} can be written to")
    frame = _Frame.around(shape.loops)
    unit_loops = [frame.to_unit(loop) for loop in shape.loops]
    for number, loop in enumerate(unit_loops, start=1):
        before, after = np.roll(loop, 1, axis=0), np.roll(loop, -1, axis=0)
        if signed_area(loop) <= 0:
            faults.append(f"loop {number} is not counter-clockwise")
        if not shapely.is_valid(shapely.polygons(loop)):
            faults.append(f"loop {number}: {shapely.is_valid_reason(shapely.polygons(loop))}")
        if (_distance_to_segment(loop, before, after) <= COLLINEAR_TOLERANCE).any():
            faults.append(f"loop {number} has a corner between two collinear edges")
    return faults + _nesting_faults(unit_loops, shape.parent)


def _nesting_faults(loops: Sequence[Floats], parent: Sequence[int]) -> list[str]:
    """Return which loops touch or have the wrong parent."""
    outlines = [shapely.linearrings(loop) for loop in loops]
    one, other = shapely.STRtree(outlines).query(outlines, predicate="intersects")
    faults = [f"loops {a + 1} and {b + 1} touch" for a, b in zip(one, other, strict=True) if a < b]
    polygons = shapely.polygons(outlines)
    inside, around = shapely.STRtree(polygons).query(polygons, predicate="within")
    depths = np.bincount(inside, minlength=len(loops)) - 1  # every polygon is within itself
    containers = set(zip(inside.tolist(), around.tolist(), strict=True))
    for loop, above in enumerate(parent):
        nested = (loop, above) in containers and depths[above] == depths[loop] - 1
        if not (nested if above >= 0 else above == -1 and depths[loop] == 0):
            faults.append(f"loop {loop + 1} has the wrong parent {above}")
    return faults


@dataclass(frozen=True)
class _Frame:
    """The bounding box of the drawing, which takes its coordinates to centred ones of unit size and back."""

    centre: Floats
    diagonal: float
    own_y: float = 1.0
    """What y is multiplied by to be that of the file."""

    @classmethod
    def around(cls, loops: Sequence[Floats], own_y: float = 1.0) -> _Frame:
        points = np.concatenate(loops)
        low, high = points.min(axis=0), points.max(axis=0)
        largest = float(np.abs(points).max())
        if largest > LARGEST_NUMBER:
            raise ShapeError(
                f"the drawing has the coordinate {largest:.3g}; scale it until all are below {LARGEST_NUMBER:g}"
            )
        diagonal = float(np.hypot(*(high - low)))
        if diagonal < 1 / LARGEST_NUMBER:
            x, y = (points[0] * (1.0, own_y) + 0.0).tolist()
            raise ShapeError(f"all points of the drawing are at ({x:.6g}, {y:.6g}); draw a loop that encloses an area")
        if largest * float(np.finfo(np.float64).eps) > ROUNDING_LIMIT * diagonal:
            raise ShapeError(
                f"the drawing is {diagonal:.3g} across but lies {largest:.3g} from the origin, too far away "
                "for its details to survive rounding; move it nearer to (0, 0)"
            )
        return cls((low + high) / 2, diagonal, own_y)

    def to_unit(self, points: Floats) -> Floats:
        unit: Floats = (points - self.centre) / self.diagonal
        return unit

    def at(self, point: Floats) -> str:
        """Return a place in words, in the drawing's coordinates, to a ten-thousandth of the drawing's size."""
        decimals = 4 - int(np.floor(np.log10(self.diagonal)))
        place = np.round(point * self.diagonal + self.centre, decimals)
        x, y = (place * (1.0, self.own_y) + 0.0).tolist()
        return f"({x:.12g}, {y:.12g})"

    def length(self, distance: float) -> str:
        return f"{distance * self.diagonal:.3g}"


@dataclass(frozen=True)
class _Boundary:
    """All loops together: edge k runs from corner k to corner ``after[k]``, both of loop ``number[k]``, from 1."""

    corners: Floats
    after: Ints
    number: Ints

    @classmethod
    def of(cls, loops: Sequence[Floats]) -> _Boundary:
        starts = np.cumsum([0] + [len(loop) for loop in loops[:-1]])
        after = [start + np.roll(np.arange(len(loop)), -1) for start, loop in zip(starts, loops, strict=True)]
        number = np.repeat(np.arange(1, len(loops) + 1), [len(loop) for loop in loops])
        return cls(np.concatenate(loops), index_array(np.concatenate(after)), index_array(number))

    @property
    def segments(self) -> Floats:
        """The edges, ``(k, 2, 2)``."""
        return np.stack([self.corners, self.corners[self.after]], axis=1)

    def pair(self, one: int, other: int) -> tuple[str, str]:
        """Return the subject and the object of a sentence about the loops that two edges belong to."""
        a, b = sorted((int(self.number[one]), int(self.number[other])))
        return f"loop {b}", "itself" if a == b else f"loop {a}"


def _number_pairs(loop: ArrayLike, number: int, own_y: float) -> Floats:
    try:
        points = np.array(loop, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        points = np.zeros(())
    if points.size and (points.ndim != 2 or points.shape[1] != 2):
        raise ShapeError(f"loop {number} is not a list of x, y points; give loops, each of points, each of two numbers")
    points = points.reshape(-1, 2)
    wrong = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if len(wrong):
        x, y = points[wrong[0]] * (1.0, own_y)
        raise ShapeError(f"point {wrong[0] + 1} of loop {number} is ({x:g}, {y:g}); give finite numbers")
    if len(np.unique(points, axis=0)) < 3:
        where = f" near ({points[0, 0]:.6g}, {points[0, 1] * own_y + 0.0:.6g})" if len(points) else ""
        raise ShapeError(f"loop {number} has fewer than 3 corners{where}; remove it or draw at least 3")
    return points


def _corner_indices(unit: Floats, number: int, frame: _Frame) -> list[int]:
    """Return which points are corners: all others are near an edge between corners, and no corner is straight.

    Near means within the tolerance. Where points beside a corner were left out, and the corner then turns out to be
    straight itself, it means within a few times the tolerance.
    """
    points = [complex(x, y) for x, y in unit.tolist()]
    start = int(np.hypot(*unit.T).argmax())  # the outermost point is a corner, unless all coincide
    kept, slack = [start], [0.0]  # slack[k]: the distance of the points left out before corner k
    for index in [*range(start + 1, len(points)), *range(start + 1)]:
        edge_slack = 0.0
        while len(kept) > 1:
            off = _deviation(points[kept[-2]], points[kept[-1]], points[index])
            if off + max(slack[-1], edge_slack) > COLLINEAR_TOLERANCE:
                break
            edge_slack = off + max(slack.pop(), edge_slack)
            kept.pop()
        kept.append(index)
        slack.append(edge_slack)
    corners = sorted(set(kept))
    while len(corners) > 2:  # some may have been kept only because of points left out beside them
        left = unit[corners]
        distances = _distance_to_segment(left, np.roll(left, 1, axis=0), np.roll(left, -1, axis=0))
        straight = distances <= COLLINEAR_TOLERANCE
        if not straight.any():
            break
        even = straight & (np.arange(len(left)) % 2 == 0)  # not two neighbours at once
        corners = np.array(corners)[~(even if even.any() else straight)].tolist()
    if len(corners) < 3:
        raise ShapeError(
            f"loop {number} encloses no area near {frame.at(unit[start])}: its points lie on one line; "
            "remove it, or draw at least 3 corners that do not"
        )
    return corners


def _deviation(start: complex, point: complex, end: complex) -> float:
    """Return the distance of ``point`` from the segment between ``start`` and ``end``."""
    along, chord = point - start, end - start
    square = chord.real**2 + chord.imag**2
    share = (along * chord.conjugate()).real / square if square else 0.0
    return abs(along - min(max(share, 0.0), 1.0) * chord)


def _distance_to_segment(points: Floats, starts: Floats, ends: Floats) -> Floats:
    """Return the distance of each point from the segment of the same row, ``(n,)``."""
    along, chord = points - starts, ends - starts
    square = (chord**2).sum(axis=1)
    share = np.divide((along * chord).sum(axis=1), square, out=np.zeros(len(points)), where=square > 0)
    distances: Floats = np.hypot(*(along - share.clip(0, 1)[:, None] * chord).T)
    return distances


def _refuse_repeated(loops: Sequence[Floats], frame: _Frame) -> None:
    seen: dict[bytes, int] = {}
    for number, loop in enumerate(loops, start=1):
        first = seen.setdefault(np.unique(loop, axis=0).tobytes(), number)
        if first != number:
            raise ShapeError(
                f"loop {number} repeats loop {first} at {frame.at(frame.to_unit(loop[0]))}; remove one of them"
            )


def _refuse_spikes(boundary: _Boundary, frame: _Frame) -> None:
    ahead = boundary.corners[boundary.after] - boundary.corners
    back = np.empty_like(ahead)
    back[boundary.after] = -ahead
    sine = np.abs(ahead[:, 0] * back[:, 1] - ahead[:, 1] * back[:, 0])
    angles = np.degrees(np.arctan2(sine, (ahead * back).sum(axis=1)))
    sharpest = int(angles.argmin())
    if angles[sharpest] < SHARPEST_CORNER:
        raise ShapeError(
            f"loop {boundary.number[sharpest]} folds back on itself at "
            f"{frame.at(boundary.corners[sharpest])}: the corner has {angles[sharpest]:.2g} degrees; "
            f"remove the spike or open it to at least {SHARPEST_CORNER} degrees"
        )


def _refuse_crossings(boundary: _Boundary, frame: _Frame) -> None:
    segments = boundary.segments
    edges = shapely.linestrings(segments)
    tree = shapely.STRtree(edges)
    for batch in blocks(len(edges), _BATCH):
        one, other = tree.query(edges[batch], predicate="intersects")
        one += batch.start
        apart = (one < other) & (boundary.after[one] != other) & (boundary.after[other] != one)
        if apart.any():
            first = np.lexsort((other[apart], one[apart]))[0]
            _refuse_crossing(boundary, frame, int(one[apart][first]), int(other[apart][first]))


def _refuse_crossing(boundary: _Boundary, frame: _Frame, one: int, other: int) -> NoReturn:
    """Raise ``ShapeError`` for two edges that meet."""
    pair = boundary.segments[[one, other]]
    ends, targets = pair.reshape(4, 2), np.repeat(pair[::-1], 2, axis=0)
    reaches = _distance_to_segment(ends, targets[:, 0], targets[:, 1])
    if reaches.min() > COLLINEAR_TOLERANCE:
        verb, place = "crosses", shapely.get_coordinates(shapely.intersection(*shapely.linestrings(pair)))[0]
    else:
        verb, place = "touches", ends[reaches.argmin()]
    subject, target = boundary.pair(one, other)
    remedy = ", or all that touch with --separate" if verb == "touches" else ""
    error = TouchError if verb == "touches" else ShapeError
    raise error(
        f"{subject} {verb} {target} at {frame.at(place)}; "
        f"separate the two edges by at least {frame.length(FEATURE_TOLERANCE)}{remedy}"
    )


def _refuse_small_features(boundary: _Boundary, frame: _Frame) -> None:
    distance, corner, edge = _smallest_feature(boundary)
    if distance < FEATURE_TOLERANCE:
        subject, target = boundary.pair(corner, edge)
        touches = distance <= COLLINEAR_TOLERANCE
        verb = "touches" if touches else f"comes within {frame.length(distance)} of"
        error = TouchError if touches else ShapeError
        raise error(
            f"{subject} {verb} {target} at {frame.at(boundary.corners[corner])}; keep corners and edges at "
            f"least {frame.length(FEATURE_TOLERANCE)} apart ({FEATURE_TOLERANCE:g} of the drawing's size)"
        )


def _smallest_feature(boundary: _Boundary) -> tuple[float, int, int]:
    """Return the smallest distance of a corner from an edge that does not end in it, and the corner and the edge."""
    corners, after, segments = boundary.corners, boundary.after, boundary.segments
    index = np.arange(len(corners))
    # Neighbours come first: they bound the radius within which others need to be looked for.
    corner = np.concatenate([index, after[after]])
    edge = np.concatenate([after, index])
    best = _nearest(corners, segments, corner, edge)
    tree, points = shapely.STRtree(shapely.linestrings(segments)), shapely.points(corners)
    for batch in blocks(len(corners), _BATCH):
        corner, edge = tree.query(points[batch], predicate="dwithin", distance=best[0])
        corner += batch.start
        apart = (edge != corner) & (after[edge] != corner)
        if apart.any():
            best = min(best, _nearest(corners, segments, corner[apart], edge[apart]))
    return best


def _nearest(corners: Floats, segments: Floats, corner: Ints, edge: Ints) -> tuple[float, int, int]:
    distances = _distance_to_segment(corners[corner], segments[edge, 0], segments[edge, 1])
    least = int(distances.argmin())
    return float(distances[least]), int(corner[least]), int(edge[least])


def parents_of(loops: Sequence[Floats]) -> tuple[int, ...]:
    """Return the innermost loop around each loop, or -1; loops may touch at corners.

    It is the smallest of those larger ones that contain a point within the loop.
    """
    polygons = np.array([shapely.Polygon(loop) for loop in loops], dtype=np.object_)
    areas = shapely.area(polygons)
    inside, around = shapely.STRtree(polygons).query(shapely.point_on_surface(polygons), predicate="within")
    larger = areas[around] > areas[inside]
    inside, around = inside[larger], around[larger]
    parents = np.full(len(loops), -1)
    by_area = np.argsort(-areas[around], kind="stable")
    parents[inside[by_area]] = around[by_area]  # the smallest is written last
    return tuple(parents.tolist())
