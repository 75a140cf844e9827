"""From drawn outlines to loops of one even-odd set: fill rules, overlaps, gaps, chains of lines and stray lines.

``Outline``s as the readers find them -> ``Loops`` (``loops_of``); ``closed_loops`` is for formats that have loops
already. Loops that touch nothing keep their numbers to the last digit. Only where outlines cross or touch does shapely
make new ones.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise, repeat

import numpy as np
import shapely

from foldcut.core.arrays import Floats, Ints, index_array, points_array
from foldcut.core.errors import FileFormatError
from foldcut.drawing.shape import polygon_loops
from foldcut.geometry.curves import CurvedLoop, Line, Segment
from foldcut.readers.base import Drawing, ReadOptions, counted
from foldcut.readers.cut_curves import CutCurves

MOST_CROSSINGS = 10_000
"""Outlines with more crossings are left as they are; ``make_shape`` refuses them and says where."""

MOST_MEETING = 50
"""If more ends of lines than this meet on average, they are not an outline, and joining them would take long."""

ROUNDING = 2e-6
"""Gaps that are smaller than this, relative to the size of the drawing, are rounding and are not reported."""

FLAT = 1e-12
"""A loop that is thinner than this, relative to its length, is a line and has no area."""

LARGEST = 1e100
"""Lines that end farther away than this are refused."""

_BATCH = 256
"""The greatest number of segments in one query."""


@dataclass(frozen=True, eq=False)
class Outline:
    """What one element of a file draws: lines, ``(n, 2)``, and whether each is closed.

    Closed lines may repeat their first point. ``filled``: open lines are closed, too; if they are not filled, they are
    joined with those of other elements. ``even_odd``: the fill rule; else it is nonzero. ``curves``: the segments that
    each line was flattened from, from its first point to its last, or none if they are straight; it may be left out.
    """

    lines: Sequence[tuple[Floats, bool]]
    filled: bool = False
    even_odd: bool = True
    curves: Sequence[Sequence[Segment]] = ()


@dataclass(frozen=True, eq=False)
class Loops:
    """Closed loops of one even-odd set, ``notes`` on how they were found, and ``repairs`` that were needed.

    ``curves``: the loops before they were flattened; nothing if all are polygons.
    """

    loops: tuple[Floats, ...]
    notes: tuple[str, ...]
    repairs: tuple[str, ...]
    curves: tuple[CurvedLoop, ...] = ()


def loops_of(outlines: Sequence[Outline], options: ReadOptions, unit_mm: float | None, extent: float) -> Loops:
    """Return the loops that outlines enclose; ``extent`` is the longer side of the drawing.

    Ends that are no more than ``options.join_mm`` apart are joined. What encloses no area is left out. Raises
    ``FileFormatError`` if nothing is left then.
    """
    gap = options.units(options.join_mm, unit_mm, extent)
    parts: list[list[Floats]] = []
    chains: list[Floats] = []
    chain_curves: list[Sequence[Segment]] = []
    gaps: list[float] = []
    # by the id of the loop, which is kept alive: what is neither cut nor joined stays the same array
    curved: dict[int, tuple[Floats, CurvedLoop]] = {}
    flat = 0
    for outline in outlines:
        closed: list[Floats] = []
        for (points, is_closed), curve in zip(outline.lines, outline.curves or repeat(()), strict=False):
            end = _end_gap(points)
            if end <= gap and (is_closed or len(points) > 2):
                gaps.append(end)
                closed.append(points[:-1])
            elif is_closed or (outline.filled and len(points) > 2):
                closed.append(points)
            elif end <= gap:
                flat += 1
                continue
            else:
                chains.append(points)
                chain_curves.append(curve)
                continue
            if curve:
                curved[id(closed[-1])] = closed[-1], _closed_curve(curve, extent)
        whole = [loop for loop in closed if not _is_flat(loop)]
        flat += len(closed) - len(whole)
        parts.append(fill(whole, even_odd=outline.even_odd))
        flat += 0 if parts[-1] else len(whole)
    loops, united = unite(parts)
    joined, more, stray, trails = join(chains, gap, alone=not loops)
    for loop, trail in zip(joined, trails, strict=True):
        if any(chain_curves[number] for number, _ in trail):
            curved[id(loop)] = loop, _closed_curve(_joined_curves(chains, chain_curves, trail), extent)
    whole = [loop for loop in joined if not _is_flat(loop)]
    flat += len(joined) - len(whole)
    if not loops and not whole:
        raise FileFormatError("the outlines of the file enclose no area; draw at least one closed outline")
    notes = [f"{united} outlines that overlap or touch were united"] if united else []
    nothing = f"left out {flat} outline{'s' * (flat > 1)} without area" if flat else ""
    repairs = filter(None, [_closed_gaps([*gaps, *more], extent, unit_mm), stray, nothing])
    found = (*loops, *whole)
    return Loops(found, tuple(notes), tuple(repairs), _curves_of(found, curved))


def closed_loops(
    drawn: Sequence[Floats], options: ReadOptions, unit_mm: float | None
) -> tuple[tuple[Floats, ...], tuple[str, ...]]:
    """Return drawn loops without a last point that nearly repeats the first one, and the repairs that were needed."""
    points = np.concatenate([loop[np.isfinite(loop).all(axis=1)] for loop in drawn])
    extent = float(np.ptp(points, axis=0).max()) if len(points) else 0.0
    gap = options.units(options.join_mm, unit_mm, extent)
    ends = [_end_gap(loop) if len(loop) > 3 else 0.0 for loop in drawn]
    repair = _closed_gaps([end for end in ends if end <= gap], extent, unit_mm)
    closed = (loop[:-1] if 0 < end <= gap else loop for loop, end in zip(drawn, ends, strict=True))
    return tuple(map(points_array, closed)), (repair,) if repair else ()


def drawing_of(
    rings: Sequence[Floats], lines: Sequence[Floats], title: str, options: ReadOptions, ignored: Counter[str]
) -> Drawing:
    """Return a drawing, its unit unknown: the rings of polygons or, if there are none, the loops that lines form."""
    if rings:
        closed, repairs = closed_loops(rings, options, None)
        return Drawing(closed, None, title, ignored=counted(ignored + Counter(line=len(lines))), repairs=repairs)
    points = np.concatenate(lines)
    finite = points[np.isfinite(points).all(axis=1)]
    extent = float(np.ptp(finite, axis=0).max()) if len(finite) else 0.0
    found = loops_of([Outline([(line, False) for line in lines])], options, None, extent)
    return Drawing(found.loops, None, title, found.notes, ignored=counted(ignored), repairs=found.repairs)


def _curves_of(loops: Sequence[Floats], curved: dict[int, tuple[Floats, CurvedLoop]]) -> tuple[CurvedLoop, ...]:
    """Return the curve of each loop; nothing if all are polygons. ``curved``: by id, loops and what they were."""
    if not curved:
        return ()
    found = [curved[id(loop)][1] if id(loop) in curved else None for loop in loops]
    if not all(found):
        known = CutCurves(*zip(*curved.values(), strict=True))
        found = [curve or known.curve_of(loop) for curve, loop in zip(found, loops, strict=True)]
    if not any(found):
        return ()
    return tuple(curve or CurvedLoop.of_points(loop) for curve, loop in zip(found, loops, strict=True))


def _closed_curve(segments: Sequence[Segment], extent: float) -> CurvedLoop:
    """Return the loop that segments make, with lines over the gaps between them and from the end to the start."""
    loop: list[Segment] = []
    for segment, following in zip(segments, [*segments[1:], segments[0]], strict=True):
        loop.append(segment)
        if float(np.hypot(*(following.start - segment.end))) > FLAT * extent:
            loop.append(Line(segment.end, following.start))
    return CurvedLoop(tuple(loop))


def _joined_curves(
    chains: Sequence[Floats], curves: Sequence[Sequence[Segment]], trail: Sequence[tuple[int, bool]]
) -> list[Segment]:
    """Return the segments of chains in the order and the direction in which they were joined."""
    segments: list[Segment] = []
    for number, backwards in trail:
        own = curves[number] or [Line(one, other) for one, other in pairwise(chains[number])]
        segments += [segment.reversed() for segment in own[::-1]] if backwards else own
    return segments


def _end_gap(points: Floats) -> float:
    """Return the distance between the ends of a line."""
    with np.errstate(all="ignore"):
        return float(np.hypot(*(points[-1] - points[0])))


def _is_flat(loop: Floats) -> bool:
    """Whether a loop has no area: a point, or a line drawn there and back."""
    if not np.isfinite(loop).all():
        return False  # make_shape says where
    if len(loop) < 3:
        return True
    along = loop - loop[0]
    far = along[np.abs(along).sum(axis=1).argmax()]
    with np.errstate(all="ignore"):
        return bool((np.abs(along[:, 0] * far[1] - along[:, 1] * far[0]) <= FLAT * (far**2).sum()).all())


def _closed_gaps(gaps: Sequence[float], extent: float, unit_mm: float | None) -> str:
    """Return a sentence on the gaps that were closed, in mm or, if the unit is unknown, in drawing units."""
    gaps = [gap for gap in gaps if gap > ROUNDING * extent]
    if not gaps:
        return ""
    most = f"{max(gaps):.2g}" if unit_mm is None else f"{max(gaps) * unit_mm:.2g} mm"
    return f"closed {len(gaps)} gap{'s' * (len(gaps) > 1)} of at most {most} between ends of lines"


def fill(loops: Sequence[Floats], *, even_odd: bool) -> list[Floats]:
    """Return the boundary of what an outline of several loops fills, as an even-odd set."""
    if len(loops) == 1 and len(loops[0]) == 3:
        return list(loops)
    rings = _closed_lines(loops)
    if rings is None:
        return list(loops)
    if shapely.is_simple(shapely.multilinestrings(rings)) and min(map(len, loops)) > 2:
        return list(loops) if even_odd or len(loops) == 1 else _nonzero(loops)
    if _crossings(rings) > MOST_CROSSINGS:
        return list(loops)
    return list(polygon_loops(shapely.get_parts(_filled_area(loops, rings, even_odd))))


def unite(parts: Sequence[Sequence[Floats]]) -> tuple[list[Floats], int]:
    """Return the loops of several even-odd sets as one set, and the number of sets that were united with others.

    Sets whose outlines meet are united. An outline that lies within another without touching it is its hole.
    """
    parts = [part for part in parts if part]
    loops = [loop for part in parts for loop in part]
    rings = _closed_lines(loops)
    if len(parts) < 2 or rings is None or shapely.is_simple(shapely.multilinestrings(rings)):
        return loops, 0
    if _crossings(rings) > MOST_CROSSINGS:
        return loops, 0
    lines = np.array([shapely.multilinestrings(_closed_lines(part)) for part in parts])
    one, other = shapely.STRtree(lines).query(lines, predicate="intersects")
    from scipy.sparse import coo_array  # a quarter of a second to import
    from scipy.sparse.csgraph import connected_components

    count, group = connected_components(coo_array((np.ones(len(one)), (one, other)), shape=(len(parts), len(parts))))
    united: list[Floats] = []
    touched = 0
    for number in range(count):
        members = [parts[index] for index in np.flatnonzero(group == number).tolist()]
        if len(members) == 1:
            united += members[0]
            continue
        touched += len(members)
        areas = [_filled_area(part, _closed_lines(part), True) for part in members]
        united += polygon_loops(shapely.get_parts(shapely.union_all(areas)))
    return united, touched


def join(
    chains: Sequence[Floats], gap: float, *, alone: bool
) -> tuple[list[Floats], list[float], str, list[list[tuple[int, bool]]]]:
    """Return the loops that open lines form if ends no more than ``gap`` apart are joined.

    With them come the lengths of all gaps, a sentence on what was left out (lines that repeat others, and lines with an
    end where no other line continues), and for each loop its lines in order: their numbers, and whether they run
    backwards. Raises ``FileFormatError`` with the place where three lines meet, and, if
    there is no loop at all, with that of an end where no line continues; ``alone`` means that these lines are all there
    is.
    """
    if not chains:
        return [], [], "", []
    ends = np.array([(chain[0], chain[-1]) for chain in chains]).reshape(-1, 2)
    if not (np.abs(ends) < LARGEST).all():  # distances overflow
        raise FileFormatError(f"a line ends at a place that is not finite; give numbers below {LARGEST:g}")
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import KDTree

    tree = KDTree(ends)
    if tree.count_neighbors(tree, gap) > MOST_MEETING * len(ends):
        raise FileFormatError("too many lines end at the same places; draw an outline, or give a smaller --join")
    pairs = tree.query_pairs(gap, output_type="ndarray")
    links = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(ends), len(ends)))
    _, node = connected_components(links, directed=False)
    left, free, repeated = _without_strays(chains, index_array(node.reshape(-1, 2)))
    meeting: dict[int, list[int]] = {}
    for number in sorted(left):
        for end in (2 * number, 2 * number + 1):
            meeting.setdefault(int(node[end]), []).append(end)
    stray = f"left out {repeated} line{'s' * (repeated > 1)} drawn twice" if repeated else ""
    if free:
        x, y = ends[free[0]].tolist()
        distance = np.max(tree.query(ends[free[0]], k=2)[0])
        place = f"at ({x:g}, {y:g}), {distance:.3g} from the next end"
        if alone and not left:
            raise FileFormatError(
                f"a line ends {place}; close the outline, or join ends that are farther apart with --join"
            )
        what = f"{len(free)} lines that end" if len(free) > 1 else "a line that ends"
        stray = "; ".join(filter(None, [stray, f"left out {what} where no other continues, {place}"]))
    for members in meeting.values():
        if len(members) > 2:
            x, y = ends[members[0]].tolist()
            raise FileFormatError(
                f"{len(members)} lines end at ({x:g}, {y:g}); keep only two, so that one continues the other"
            )
    loops, gaps, trails = [], [], []
    for start in sorted(left):
        end, points, trail = 2 * start, list[Floats](), list[tuple[int, bool]]()
        while end // 2 in left:
            left.discard(end // 2)
            trail.append((end // 2, end % 2 == 1))
            chain = chains[end // 2] if end % 2 == 0 else chains[end // 2][::-1]
            points.append(chain[:-1])
            far = end ^ 1
            first, second = meeting[int(node[far])]
            end = second if first == far else first
            gaps.append(float(np.hypot(*(ends[end] - ends[far]))))
        if points:
            loops.append(points_array(np.concatenate(points)))
            trails.append(trail)
    return loops, gaps, stray, trails


def _without_strays(chains: Sequence[Floats], nodes: Ints) -> tuple[set[int], list[int], int]:
    """Return the lines that continue at both ends, the loose ends of those that do not, and the number of repetitions.

    ``nodes`` ``(n, 2)``: the place of each end of each line, as a number. Taking a line away may make its neighbour's
    end a loose one.
    """
    left: set[int] = set()
    seen: set[tuple[bytes, ...]] = set()
    for number, chain in enumerate(chains):
        drawn = tuple(sorted((chain.tobytes(), chain[::-1].tobytes())))
        if drawn not in seen:
            left.add(number)
        seen.add(drawn)
    repeated = len(chains) - len(left)
    at: dict[int, set[int]] = {}
    for number in sorted(left):
        for end in (0, 1):
            at.setdefault(int(nodes[number, end]), set()).add(2 * number + end)
    free: list[int] = []
    waiting = [next(iter(members)) for members in at.values() if len(members) == 1]
    for end in waiting:  # the list grows in the loop
        if end // 2 not in left:
            continue
        left.discard(end // 2)
        free.append(end)
        for one in (end, end ^ 1):
            members = at[int(nodes[one // 2, one % 2])]
            members.discard(one)
            if len(members) == 1:
                waiting += members
    return left, free, repeated


def _closed_lines(loops: Sequence[Floats]) -> list[shapely.LineString] | None:
    """Return the loops as closed lines, or None if there are none or if a number is not finite."""
    if not loops or not all(len(loop) > 1 and np.isfinite(loop).all() for loop in loops):
        return None
    return [shapely.linestrings(np.concatenate([loop, loop[:1]])) for loop in loops]


def _crossings(rings: Sequence[shapely.LineString]) -> int:
    """Return how many pairs of segments meet that are not neighbours; stop counting beyond ``MOST_CROSSINGS``."""
    coords = [shapely.get_coordinates(ring) for ring in rings]
    segments = shapely.linestrings(np.concatenate([np.stack([line[:-1], line[1:]], axis=1) for line in coords]))
    tree, count, start, batch = shapely.STRtree(segments), 0, 0, 1
    segments = np.random.default_rng(0).permutation(segments)  # at random: if all lie in one place, a few suffice
    while start < len(segments) and count <= 2 * MOST_CROSSINGS:
        asked = segments[start : start + batch]
        one, _ = tree.query(asked, predicate="intersects")
        count += max(len(one) - 3 * len(asked), 0)
        start, batch = start + batch, min(2 * batch, _BATCH)
    return count // 2


def _filled_area(
    loops: Sequence[Floats], lines: Sequence[shapely.LineString] | None, even_odd: bool
) -> shapely.Geometry:
    """Return the area that the loops fill: those faces between all lines whose winding number says so."""
    faces = shapely.get_parts(shapely.polygonize([shapely.union_all(lines)]))
    inside = shapely.get_coordinates(shapely.point_on_surface(faces))
    winding = sum((_winding(inside, loop) for loop in loops), np.zeros(len(inside), dtype=np.int64))
    return shapely.union_all(faces[winding % 2 == 1 if even_odd else winding != 0])


def _winding(points: Floats, loop: Floats) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
    """Return the winding number of ``loop`` around each point: how often it goes around it, counter-clockwise."""
    (x, y), (to_x, to_y) = loop.T, np.roll(loop, -1, axis=0).T
    turns = np.zeros(len(points), dtype=np.int64)
    for number, (px, py) in enumerate(points.tolist()):
        left = (to_x - x) * (py - y) - (px - x) * (to_y - y)
        turns[number] = np.sum((y <= py) & (to_y > py) & (left > 0)) - np.sum((y > py) & (to_y <= py) & (left < 0))
    return turns


def _nonzero(loops: Sequence[Floats]) -> list[Floats]:
    """Return those of some disjoint loops that have a winding number of zero on exactly one side."""
    rings = shapely.linearrings(np.concatenate(loops), indices=np.repeat(np.arange(len(loops)), list(map(len, loops))))
    own = np.where(shapely.is_ccw(rings), 1, -1)
    polygons, starts = shapely.polygons(rings), shapely.points([loop[0] for loop in loops])
    # A loop is not within itself, since it starts on its own edge.
    inside, around = shapely.STRtree(polygons).query(starts, predicate="within")
    outside = np.bincount(inside, weights=own[around], minlength=len(loops))
    return [loop for loop, kept in zip(loops, (outside == 0) != (outside + own == 0), strict=True) if kept]
