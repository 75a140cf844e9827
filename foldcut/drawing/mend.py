"""Mend a drawing so that it is a valid shape, and on request make it easier to fold.

Loops in mm, even-odd -> ``Prepared``: loops in mm, and one line with numbers for each change. A valid drawing for which
nothing is requested comes back as it is. Each step is skipped where it is not needed:

1. Loops that repeat another or that enclose no area are dropped.
2. Outlines that cross or overlap are made into one by the even-odd rule, and slivers and spikes are dropped.
3. On request, narrow parts and gaps go, touching loops are set apart, and corners are left out (``drawing.simplify``).
4. On request, the drawing is mirrored.

Whether the result is a shape is for ``drawing.shape`` to say.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import ArrayLike

from foldcut.core.arrays import Floats, points_array
from foldcut.core.errors import BadInputError, ShapeError
from foldcut.core.model import Shape
from foldcut.drawing.shape import SHARPEST_CORNER, make_shape, polygon_loops
from foldcut.drawing.simplify import simplify
from foldcut.geometry.crossings import are_tangled, faces_of_lines, winding

__all__ = ["Preparation", "Prepared", "prepare", "preview"]

SLIVER_MM = 0.05
"""When a drawing is mended, parts and holes that are thinner than this on average are dropped."""

LARGEST_MM = 1e9
"""A drawing with coordinates beyond this is not mended."""

MANY = 1_000
"""With more corners than this, the algorithm of Douglas and Peucker first leaves out what is hardly seen, for speed."""

MANY_CROSSINGS = 1_000
"""With more crossings than this, a loop is divided into its faces: making it valid takes their square in time."""

_MITRE = {"join_style": "mitre", "mitre_limit": 20.0}
"""How shapely moves edges: corners stay sharp, unless they would reach out farther than 20 times the distance."""


@dataclass(frozen=True)
class Preparation:
    """What may be done to a drawing; lengths in mm.

    ``corners``: leave out corners until at most this many are left. ``min_feature``: drop parts and close gaps that are
    narrower than this. ``separate``: if loops touch, move every edge inward until they are this far apart. ``mirror``:
    swap left and right. ``strict``: refuse a drawing that has to be mended; the other options still apply.
    """

    corners: int | None = None
    min_feature: float = 0.0
    separate: float = 0.0
    mirror: bool = False
    strict: bool = False

    def __post_init__(self) -> None:
        for name in ("min_feature", "separate"):
            if not 0 <= getattr(self, name) < float("inf"):
                raise BadInputError(f"{name} is {getattr(self, name)} mm; give 0 or a positive number")
        if self.corners is not None and self.corners < 3:
            raise BadInputError(f"a budget of {self.corners} corners is too small; give at least 3")


@dataclass(frozen=True, eq=False)
class Prepared:
    """Loops in mm, as ``drawn`` and as prepared, and one line of text for each change.

    ``whole``: the prepared loops with all of their corners, if some were left out to keep to a number.
    """

    drawn: tuple[Floats, ...]
    loops: tuple[Floats, ...]
    changes: tuple[str, ...]
    whole: tuple[Floats, ...] | None = None


class _TangledError(Exception):
    """Outlines cross so often that dividing the plane by them would take long; ``make_shape`` says where they do."""


def prepare(loops: Sequence[ArrayLike], preparation: Preparation) -> Prepared:
    """Return ``loops``, in mm, mended and simplified; ``make_shape`` says whether they then are a shape.

    Raises ``ShapeError`` if something would have to be mended and ``strict`` is set, and if the drawing cannot have so
    few corners.
    """
    drawn = tuple(points_array(loop) for loop in loops)
    if not all(np.isfinite(loop).all() and np.abs(loop).max(initial=0.0) < LARGEST_MM for loop in drawn):
        return Prepared(drawn, drawn, ())  # not a drawing at all: make_shape says why
    try:
        valid = _shape(drawn) is not None
        if not valid and (any(are_tangled([loop]) for loop in drawn) or not any(map(_ring_areas, drawn))):
            return Prepared(drawn, drawn, ())  # make_shape says why here, too
        return _prepared(drawn, preparation, valid=valid)
    except _TangledError:
        return Prepared(drawn, drawn, ())
    except shapely.errors.GEOSException as error:
        raise ShapeError(f"the drawing is too tangled to be mended: {error}; draw it simpler") from error


def _prepared(drawn: tuple[Floats, ...], preparation: Preparation, *, valid: bool) -> Prepared:
    mended, changes = (drawn, []) if valid else _mended(drawn)
    if preparation.strict:
        refuse_changes(changes)
    if preparation.min_feature:
        mended = _noted(changes, *_without_narrow_parts(mended, preparation.min_feature))
    if preparation.separate:
        mended = _noted(changes, *_set_apart(mended, preparation.separate))
    whole = mended
    if preparation.corners is not None:
        mended = _noted(changes, *_within_budget(mended, preparation.corners))
    fewer = mended is not whole
    if preparation.mirror:
        mended, whole = (tuple(points_array(loop * (-1.0, 1.0)) for loop in loops) for loops in (mended, whole))
        changes.append("mirrored, left to right")
    return Prepared(drawn, mended, tuple(changes), whole if fewer else None)


def refuse_changes(changes: Sequence[str]) -> None:
    """Raise ``ShapeError`` if a drawing had to be mended by these changes; this is what ``strict`` asks for."""
    if changes:
        raise ShapeError(f"the drawing has to be mended: {'; '.join(changes)}; leave out --strict, or mend it yourself")


def preview(before: Sequence[Floats], after: Sequence[Floats], lost: Sequence[Floats] = ()) -> bytes:
    """Return an SVG in true size of loops in mm: ``before`` in red, ``after`` in black on grey, ``lost`` ones in blue.

    ``lost``: outlines that the file has and that are in neither, since others cover them.
    """
    points = np.concatenate([*before, *after, *lost])
    low, high = points.min(axis=0) - 5, points.max(axis=0) + 5
    (width, height), path = high - low, ""
    styles = (
        (after, "fill:#ddd;stroke:#000"),
        (before, "fill:none;stroke:#e00;stroke-dasharray:1"),
        (lost, "fill:none;stroke:#06f;stroke-dasharray:.5"),
    )
    for loops, style in styles:
        if not loops:
            continue
        data = " ".join(f"M{' '.join(f'{x - low[0]:.4f},{high[1] - y:.4f}' for x, y in loop)}Z" for loop in loops)
        path += f'<path d="{data}" style="{style};stroke-width:.2;fill-rule:evenodd"/>\n'
    size = f'width="{width:.3f}mm" height="{height:.3f}mm" viewBox="0 0 {width:.3f} {height:.3f}"'
    return f'<svg xmlns="http://www.w3.org/2000/svg" {size}>\n{path}</svg>\n'.encode()


def _noted(changes: list[str], loops: tuple[Floats, ...], change: str) -> tuple[Floats, ...]:
    if change:
        changes.append(change)
    return loops


def _shape(loops: Sequence[Floats]) -> Shape | None:
    """Return the shape that loops make, or None if they make none."""
    try:
        return make_shape(loops)
    except ShapeError:
        return None


def _mended(loops: tuple[Floats, ...]) -> tuple[tuple[Floats, ...], list[str]]:
    """Return loops that neither cross nor overlap nor repeat, and the changes that this took.

    Raises ``_TangledError`` if they cross too often.
    """
    changes: list[str] = []
    kept: list[Floats] = []
    seen: dict[bytes, int] = {}
    for number, loop in enumerate(loops, start=1):
        if not _ring_areas(loop):
            changes.append(f"dropped loop {number}: it bounds no area")
            continue
        first = seen.setdefault(_walk(loop), number)
        if first != number:
            changes.append(f"dropped loop {number}: it repeats loop {first}")
            continue
        kept.append(loop)
    if _shape(kept) is not None:
        return tuple(kept), changes
    if are_tangled(kept):
        raise _TangledError
    area = _area(kept)
    parts = _areas(area)
    solid = [part for part in parts if not _thin(part)]
    holes = sum(len(part.interiors) for part in solid)
    solid = [
        shapely.Polygon(part.exterior, [hole for hole in part.interiors if not _thin(shapely.Polygon(hole))])
        for part in solid
    ]
    if thin := len(parts) - len(solid) + holes - sum(len(part.interiors) for part in solid):
        changes.append(f"dropped {thin} sliver{'s' * (thin > 1)} thinner than {SLIVER_MM:g} mm")
    outlines = polygon_loops(solid)
    before, after = sum(map(len, kept)), sum(map(len, outlines))
    changes.append(
        f"outlines that cross or overlap were made one by the even-odd rule: {len(kept)} -> {len(outlines)} loops, "
        f"{before} -> {after} corners"
    )
    if _shape(outlines) is None:
        outlines = _noted(changes, *_without_spikes(outlines))
    return outlines, changes


def _walk(loop: Floats) -> bytes:
    """Return a key that is the same for a loop wherever it begins and whichever way around it is drawn."""
    points = (loop[:-1] if np.array_equal(loop[0], loop[-1]) else loop) + 0.0  # turns -0.0 into 0.0
    start = int(np.lexsort(points.T)[0])
    onward = np.roll(points, -start, axis=0)
    return min(onward.tobytes(), np.roll(onward[::-1], 1, axis=0).tobytes())


def _without_spikes(loops: tuple[Floats, ...]) -> tuple[tuple[Floats, ...], str]:
    """Return loops without corners that are too sharp for a shape: lines that go out and come back the same way."""
    left: list[Floats] = []
    for loop in loops:
        points = loop
        while len(points) > 3:
            back, ahead = np.roll(points, 1, axis=0) - points, np.roll(points, -1, axis=0) - points
            sine = np.abs(back[:, 0] * ahead[:, 1] - back[:, 1] * ahead[:, 0])
            angles = np.degrees(np.arctan2(sine, (back * ahead).sum(axis=1)))
            if angles.min() >= SHARPEST_CORNER:
                break
            points = np.delete(points, angles.argmin(), axis=0)
        left.append(points_array(points))
    dropped = sum(map(len, loops)) - sum(map(len, left))
    return tuple(left), f"dropped {dropped} point{'s' * (dropped > 1)} of spikes without width" if dropped else ""


def _areas(geometry: shapely.Geometry) -> list[shapely.Polygon]:
    """Return the polygons of a geometry that have an area."""
    parts = shapely.get_parts(shapely.get_parts([geometry]))  # twice: a collection of multipolygons
    return [part for part in parts if isinstance(part, shapely.Polygon) and part.area]


def _ring_areas(loop: Floats) -> list[shapely.Polygon]:
    """Return the areas that a loop encloses by the even-odd rule."""
    if len(loop) > 2 and are_tangled([loop], MANY_CROSSINGS):
        faces, inside = faces_of_lines([shapely.LinearRing(loop)])
        return list(faces[winding(inside, loop) % 2 == 1])
    return _areas(shapely.make_valid(shapely.Polygon(loop), method="linework")) if len(loop) > 2 else []


def _thin(polygon: shapely.Polygon) -> bool:
    """Whether a polygon is a sliver: its mean thickness is about twice its area divided by its perimeter."""
    return bool(2 * polygon.area < SLIVER_MM * polygon.length)


def _area(loops: Sequence[Floats]) -> shapely.Geometry:
    """Return the area that loops enclose together by the even-odd rule."""
    areas = np.array([shapely.union_all(_ring_areas(loop)) for loop in loops] or [shapely.Polygon()])
    while len(areas) > 1:  # combining them in pairs is much faster than one by one
        pairs = shapely.symmetric_difference(areas[: len(areas) // 2], areas[len(areas) // 2 : len(areas) // 2 * 2])
        areas = np.concatenate([pairs, areas[len(areas) // 2 * 2 :]])
    area: shapely.Geometry = areas[0]
    return area


def _without_narrow_parts(loops: tuple[Floats, ...], width: float) -> tuple[tuple[Floats, ...], str]:
    """Return loops without parts, gaps and holes that are narrower than ``width``; other corners stay in place."""
    area, half = _area(loops), width / 2
    closed = area.buffer(half, **_MITRE).buffer(-half, **_MITRE)
    opened = closed.buffer(-half, **_MITRE).buffer(half, **_MITRE)
    parts = _areas(opened)
    if not parts:
        raise ShapeError(f"no part of the drawing is {width:g} mm wide; give a smaller --min-feature or a larger sheet")
    changed = shapely.symmetric_difference(area, opened).buffer(-1e-6 * width)
    if changed.is_empty:
        return loops, ""
    outlines = polygon_loops([part.simplify(1e-4 * width) for part in parts])
    filled, dropped = closed.difference(area).area, closed.difference(opened).area
    return outlines, (
        f"parts and gaps narrower than {width:g} mm: closed {filled:.3g} mm2, dropped {dropped:.3g} mm2, "
        f"{len(loops)} -> {len(outlines)} loops"
    )


def _set_apart(loops: tuple[Floats, ...], distance: float) -> tuple[tuple[Floats, ...], str]:
    """Return loops that do not touch; if any touch, every edge of the drawing goes inward by half ``distance``."""
    if _shape(loops) is not None:
        return loops, ""
    area = _area(loops)
    parts = _areas(area.buffer(-distance / 2, **_MITRE))
    if not parts:
        raise ShapeError(
            f"nothing is left of the drawing when loops are set {distance:g} mm apart; give a smaller --separate"
        )
    return polygon_loops(parts), (
        f"loops that touch were set {distance:g} mm apart: every edge went inward by {distance / 2:g} mm, "
        f"{len(loops)} -> {len(parts)} parts"
    )


def _within_budget(loops: tuple[Floats, ...], budget: int) -> tuple[tuple[Floats, ...], str]:
    """Return loops with at most ``budget`` corners, made with the smallest tolerance found to be enough."""
    before = sum(map(len, loops))
    size = float(np.ptp(np.concatenate(loops), axis=0).max())
    coarse, off = loops, 0.0
    while sum(map(len, coarse)) > MANY and off < 0.01 * size:
        off = max(2 * off, 1e-5 * size)
        coarse = polygon_loops([shapely.simplify(shapely.Polygon(loop), off) for loop in loops])
    shape = make_shape(coarse)
    if shape.corner_count <= budget:
        most, reached = 0.0, shape
    else:
        low, high = 0.0, 1e-3 * size
        while (found := simplify(shape, high)).corners_after > budget:
            if high > size:
                raise ShapeError(
                    f"the drawing has {found.corners_after} corners that keep its loops apart, more than the "
                    f"{budget} of --corners; allow more, or draw fewer loops"
                )
            low, high = high, 2 * high
        for _ in range(5):  # a smaller tolerance may do
            middle = (low + high) / 2
            trial = simplify(shape, middle)
            if trial.corners_after <= budget:
                found, high = trial, middle
            else:
                low = middle
        most, reached = found.deviation, found.shape
    if reached.corner_count == before:
        return loops, ""
    return reached.loops, f"simplified: {before} -> {reached.corner_count} corners, at most {most + off:.2g} mm off"
