"""The area that strokes cover (SVG 2, section 13.5): widths, line caps, line joins and their limit.

An element of an SVG and its flattened outline -> outlines of the area of its stroke, and of its fill if that has
another paint. Dashes are read as whole lines.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import shapely
from svgelements import CubicBezier, Move, QuadraticBezier

from foldcut.core.arrays import Floats, points_array
from foldcut.core.units import MM_PER_UNIT
from foldcut.drawing.shape import polygon_loops
from foldcut.readers.fill_outlines import Paint, fill
from foldcut.readers.join_outlines import Outline
from foldcut.readers.svg_page import Element

WIDE_STROKE = 0.01
"""Strokes that are wider than this, relative to the size of the drawing, are told."""

_CAPS = {"butt": "flat", "round": "round", "square": "square"}
_SMALL = 1e-3
"""How far a bevel reaches into the stroke, relative to its width, so that the two are one."""


def with_strokes(
    outline: Outline, element: Element, flip: Floats, tolerance: float, unit_mm: float | None
) -> list[Outline]:
    """Return what an element covers with its stroke: one outline, or two if fill and stroke have different paints.

    ``flip``, ``(2, 2)``: from the element's place in the drawing to the points of the outline. ``unit_mm``: mm to a
    unit of the drawing, if that is known.
    """
    matrix = np.eye(3)
    matrix[:2] = flip @ element.matrix[:2]
    width = element.own_width
    if element.fixed:  # its width is in px of the screen, whatever the transform
        width *= MM_PER_UNIT["px"] / unit_mm if unit_mm else 1.0
        lines, matrix = [(points_array(points), closed) for points, closed in outline.lines], np.eye(3)
    else:
        lines = _own_lines(element, tolerance)
    scale = float(np.linalg.norm(matrix[:2, :2], 2)) if np.isfinite(matrix).all() else 0.0
    if not (scale and all(np.isfinite(points).all() for points, _ in lines)):
        return [outline]  # make_shape says where
    stroke = _moved(stroke_area(lines, width, element.style, tolerance / scale), matrix)
    covered = Outline(_rings(stroke), filled=True, name=outline.name, paint=element.stroke_paint)
    if not element.filled:
        return [covered]
    if outline.paint is Paint.DARK and covered.paint is Paint.DARK:
        filled = fill([points for points, _ in outline.lines if len(points) > 2], even_odd=outline.even_odd)
        area = shapely.make_valid(shapely.MultiPolygon([shapely.Polygon(loop) for loop in filled[:1]]))
        for loop in filled[1:]:
            area = shapely.symmetric_difference(area, shapely.make_valid(shapely.Polygon(loop)))
        return [replace(covered, lines=_rings(shapely.union(area, stroke)))]
    return [replace(outline, paint=Paint.WHITE if outline.paint is not Paint.DARK else Paint.DARK), covered]


def stroke_area(
    lines: Sequence[tuple[Floats, bool]], width: float, style: dict[str, str], tolerance: float
) -> shapely.Geometry:
    """Return what a stroke along lines, ``(n, 2)`` and whether each is closed, covers; all lengths in one unit."""
    half = width / 2
    cap = _CAPS.get(style.get("stroke-linecap", "butt").lower(), "flat")
    join = style.get("stroke-linejoin", "miter").lower()
    limit = max(float(style.get("stroke-miterlimit", "4")), 1.0)
    step = math.acos(max(1 - tolerance / half, 0.0)) if half > tolerance else math.pi / 4
    quarter = {"quad_segs": min(max(math.ceil(math.pi / 4 / step), 2), 200)}
    areas: list[shapely.Geometry] = []
    for points, closed in lines:
        points = _without_repeats(points, closed)
        if len(points) < 2:
            if cap != "flat" and len(points):
                areas.append(shapely.buffer(shapely.points(points[0]), half, cap_style=cap, **quarter))
            continue
        closed = closed and len(points) > 2
        around = np.concatenate([points, points[:1]]) if closed else points
        if join == "round":
            areas.append(_buffered(around, half, closed, cap, join_style="round", **quarter))
            continue
        sharp = _sharp_corners(points, closed, 1.0 if join == "bevel" else limit)
        areas += _mitred(around, half, closed, cap, sharp, max(limit, 2.0), quarter)
    return shapely.union_all(areas)


def _mitred(
    points: Floats, half: float, closed: bool, cap: str, sharp: list[int], limit: float, quarter: dict[str, int]
) -> Iterable[shapely.Geometry]:
    """Yield pieces of a stroke with mitred corners, and the bevels of those corners that are too sharp for that."""
    style = {"join_style": "mitre", "mitre_limit": limit, **quarter}
    if not sharp:
        yield _buffered(points, half, closed, cap, **style)
        return
    if closed:  # begin at a sharp corner
        points = np.concatenate([points[sharp[0] : -1], points[: sharp[0] + 1]])
        cuts = [0, *(corner - sharp[0] for corner in sharp[1:]), len(points) - 1]
    else:
        cuts = [0, *sharp, len(points) - 1]
    if closed and len(sharp) == 1:  # in two pieces with one side in both, since one piece would be a ring
        yield _buffered(points[: len(points) // 2 + 1], half, False, "flat", **style)
        yield _buffered(points[len(points) // 2 - 1 :], half, False, "flat", **style)
    for first, last in pairwise(cuts) if not closed or len(sharp) > 1 else ():
        yield _buffered(points[first : last + 1], half, False, "flat", **style)
    inner = cuts[1:-1] + ([0] if closed else [])
    for corner in inner:
        before = points[corner - 1] if corner else points[-2]
        yield _bevel(before, points[corner], points[corner + 1], half)
    if not closed and cap != "flat":
        for end, neighbour in ((points[0], points[1]), (points[-1], points[-2])):
            stub = np.array([end, end + (neighbour - end) * min(1.0, half / np.hypot(*(neighbour - end)) / 2)])
            yield _buffered(stub, half, False, cap, **style).intersection(_beyond(end, neighbour, half))


def _beyond(end: Floats, neighbour: Floats, half: float) -> shapely.Polygon:
    """Return the square at the end of a line that its cap lies in, and a little of the line."""
    along = (end - neighbour) / np.hypot(*(end - neighbour)) * half
    across = np.array([-along[1], along[0]]) * 1.1
    back = end - _SMALL * along
    return shapely.Polygon([back + across, back - across, end + 1.1 * along - across, end + 1.1 * along + across])


def _bevel(before: Floats, corner: Floats, after: Floats, half: float) -> shapely.Geometry:
    """Return the triangle between the outer edges of two parts of a stroke."""
    one, other = corner - before, after - corner
    one, other = one / np.hypot(*one), other / np.hypot(*other)
    side = -half if one[0] * other[1] - one[1] * other[0] > 0 else half
    outer = [corner + side * np.array([-way[1], way[0]]) for way in (one, other)]
    inner = corner + _SMALL * half * (other - one) / max(np.hypot(*(other - one)), 1e-12)
    return shapely.Polygon([*outer, inner])


def _buffered(points: Floats, half: float, closed: bool, cap: str, **style: object) -> shapely.Geometry:
    line = shapely.linearrings(points) if closed else shapely.linestrings(points)
    return shapely.buffer(line, half, cap_style=cap, **style)


def _sharp_corners(points: Floats, closed: bool, limit: float) -> list[int]:
    """Return which corners of a line have a mitre that is longer than the limit allows; smooth ones never do."""
    ahead = np.roll(points, -1, axis=0) - points
    back = np.roll(ahead, 1, axis=0)
    turn = np.abs(np.arctan2(back[:, 0] * ahead[:, 1] - back[:, 1] * ahead[:, 0], (back * ahead).sum(axis=1)))
    with np.errstate(divide="ignore"):
        sharp = (1 / np.cos(turn / 2) > limit) & (turn > 0.2)
    if not closed:
        sharp[[0, -1]] = False
    return np.flatnonzero(sharp).tolist()


def _without_repeats(points: Floats, closed: bool) -> Floats:
    kept = np.concatenate([[True], np.abs(np.diff(points, axis=0)).max(axis=1) > 0])
    points = points[kept]
    return points[:-1] if closed and len(points) > 1 and np.array_equal(points[0], points[-1]) else points


def _own_lines(element: Element, tolerance: float) -> list[tuple[Floats, bool]]:
    """Return the lines of an element in its own units."""
    scale = float(np.linalg.norm(element.matrix[:2, :2], 2)) if np.isfinite(element.matrix).all() else 0.0
    own = replace(element, matrix=np.eye(3))
    lines = [
        (points_array(points.T), closed) for points, closed, _ in own.lines(tolerance / scale if scale else math.inf)
    ]
    return [*lines, *((points_array([dot]), False) for dot in _dots(element.path))]


def _dots(path: list[Any]) -> Iterator[tuple[float, float]]:
    """Yield the places of the subpaths without length, of which only caps are drawn."""
    start: tuple[float, float] | None = None
    is_dot = False
    for segment in [*path, Move(end=(0.0, 0.0))]:
        end = float(segment.end.x), float(segment.end.y)
        if isinstance(segment, Move):
            if is_dot and start is not None:
                yield start
            start, is_dot = end, False
        else:
            is_dot = end == start and not isinstance(segment, CubicBezier | QuadraticBezier)
            start = start if is_dot else None


def _moved(area: shapely.Geometry, matrix: Floats) -> shapely.Geometry:
    return shapely.transform(area, lambda points: points @ matrix[:2, :2].T + matrix[:2, 2])


def _rings(area: shapely.Geometry) -> list[tuple[Floats, bool]]:
    polygons = (part for part in shapely.get_parts(area) if isinstance(part, shapely.Polygon) and part.area)
    return [(loop, True) for loop in polygon_loops(polygons)]
