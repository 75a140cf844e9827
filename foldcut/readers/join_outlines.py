"""From drawn outlines to loops of one even-odd set: gaps, chains of lines, fill rules, overlaps, strays.

Loops that touch nothing keep their numbers to the last digit; only where outlines cross or touch does shapely make
new ones.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from foldcut.core.arrays import Floats, Ints, index_array, points_array
from foldcut.core.errors import FileFormatError
from foldcut.drawing.shape import polygon_loops
from foldcut.readers.base import Drawing, ReadOptions, counted

MOST_CROSSINGS = 10_000
"""Outlines with more crossings are left as they are: ``make_shape`` refuses them by place."""

MOST_MEETING = 50
"""Where more ends of lines than this meet on average, they are no outline, and joining them would take long."""

ROUNDING = 2e-6
"""Gaps smaller than this, relative to the drawing's size, are rounding and not told."""

FLAT = 1e-12
"""A loop that is thinner than this, relative to its length, is one line."""

LARGEST = 1e100
"""Lines that end farther away are refused."""

_BATCH = 256


@dataclass(frozen=True, eq=False)
class Outline:
    """What one element of a file draws: lines ``(n, 2)``, and whether each is closed; closed ones may repeat a point.

    ``filled``: its open lines are closed, too; others are joined with those of other elements.
    """

    lines: Sequence[tuple[Floats, bool]]
    filled: bool = False
    even_odd: bool = True


@dataclass(frozen=True, eq=False)
class Loops:
    """Closed loops of one even-odd set, how they were found, and what had to be mended."""

    loops: tuple[Floats, ...]
    notes: tuple[str, ...]
    repairs: tuple[str, ...]


def loops_of(outlines: Sequence[Outline], options: ReadOptions, unit_mm: float | None, extent: float) -> Loops:
    """Return the loops that outlines bound; ``extent``: the drawing's longer side.

    Ends that are no more than ``options.join_mm`` apart are joined. What bounds no area is left out, unless there is
    nothing else: then it is a ``FileFormatError``.
    """
    gap = options.units(options.join_mm, unit_mm, extent)
    parts: list[list[Floats]] = []
    chains: list[Floats] = []
    gaps: list[float] = []
    flat = 0
    for outline in outlines:
        closed: list[Floats] = []
        for points, is_closed in outline.lines:
            end = _end_gap(points)
            if end <= gap and (is_closed or len(points) > 2):
                gaps.append(end)
                closed.append(points[:-1])
            elif is_closed or (outline.filled and len(points) > 2):
                closed.append(points)
            elif end <= gap:
                flat += 1
            else:
                chains.append(points)
        whole = [loop for loop in closed if not _is_flat(loop)]
        flat += len(closed) - len(whole)
        parts.append(fill(whole, even_odd=outline.even_odd))
        flat += 0 if parts[-1] else len(whole)
    loops, united = unite(parts)
    joined, more, stray = join(chains, gap, alone=not loops)
    whole = [loop for loop in joined if not _is_flat(loop)]
    flat += len(joined) - len(whole)
    if not loops and not whole:
        raise FileFormatError("the outlines of the file enclose no area; draw at least one closed outline")
    notes = [f"{united} outlines that overlap or touch were united"] if united else []
    nothing = f"left out {flat} outline{'s' * (flat > 1)} without area" if flat else ""
    repairs = filter(None, [_closed([*gaps, *more], extent, unit_mm), stray, nothing])
    return Loops((*loops, *whole), tuple(notes), tuple(repairs))


def closed_rings(
    rings: Sequence[Floats], options: ReadOptions, unit_mm: float | None
) -> tuple[tuple[Floats, ...], tuple[str, ...]]:
    """Return rings that are closed, without a last point that is nearly the first one, and what was mended."""
    points = np.concatenate([ring[np.isfinite(ring).all(axis=1)] for ring in rings])
    extent = float(np.ptp(points, axis=0).max()) if len(points) else 0.0
    gap = options.units(options.join_mm, unit_mm, extent)
    ends = [_end_gap(ring) if len(ring) > 3 else 0.0 for ring in rings]
    told = _closed([end for end in ends if end <= gap], extent, unit_mm)
    shut = (ring[:-1] if 0 < end <= gap else ring for ring, end in zip(rings, ends, strict=True))
    return tuple(map(points_array, shut)), (told,) if told else ()


def drawing_of(
    rings: Sequence[Floats], lines: Sequence[Floats], title: str, options: ReadOptions, ignored: Counter[str]
) -> Drawing:
    """Return the drawing of polygons' rings or, where there are none, of the loops that lines form; without a unit."""
    if rings:
        shut, repairs = closed_rings(rings, options, None)
        return Drawing(shut, None, title, ignored=counted(ignored + Counter(line=len(lines))), repairs=repairs)
    points = np.concatenate(lines)
    finite = points[np.isfinite(points).all(axis=1)]
    extent = float(np.ptp(finite, axis=0).max()) if len(finite) else 0.0
    found = loops_of([Outline([(line, False) for line in lines])], options, None, extent)
    return Drawing(found.loops, None, title, found.notes, ignored=counted(ignored), repairs=found.repairs)


def _end_gap(points: Floats) -> float:
    """Return how far the ends of a line are from each other."""
    with np.errstate(all="ignore"):
        return float(np.hypot(*(points[-1] - points[0])))


def _is_flat(loop: Floats) -> bool:
    """Whether a loop is a point, or there and back on one line."""
    if not np.isfinite(loop).all():
        return False  # make_shape says where
    if len(loop) < 3:
        return True
    along = loop - loop[0]
    far = along[np.abs(along).sum(axis=1).argmax()]
    with np.errstate(all="ignore"):
        return bool((np.abs(along[:, 0] * far[1] - along[:, 1] * far[0]) <= FLAT * (far**2).sum()).all())


def _closed(gaps: Sequence[float], extent: float, unit_mm: float | None) -> str:
    """Return in words which gaps were closed; lengths are in the drawing's units where mm are unknown."""
    gaps = [gap for gap in gaps if gap > ROUNDING * extent]
    if not gaps:
        return ""
    most = f"{max(gaps):.2g}" if unit_mm is None else f"{max(gaps) * unit_mm:.2g} mm"
    return f"closed {len(gaps)} gap{'s' * (len(gaps) > 1)} of at most {most} between ends of lines"


def fill(loops: Sequence[Floats], *, even_odd: bool) -> list[Floats]:
    """Return the boundary, as an even-odd set, of what one outline with several loops fills."""
    if len(loops) == 1 and len(loops[0]) == 3:
        return list(loops)
    rings = _rings(loops)
    if rings is None:
        return list(loops)
    if shapely.is_simple(shapely.multilinestrings(rings)) and min(map(len, loops)) > 2:
        return list(loops) if even_odd or len(loops) == 1 else _nonzero(loops)
    if _crossings(rings) > MOST_CROSSINGS:
        return list(loops)
    return list(polygon_loops(shapely.get_parts(_region(loops, rings, even_odd))))


def unite(parts: Sequence[Sequence[Floats]]) -> tuple[list[Floats], int]:
    """Return the loops of several even-odd sets as one, and how many of the sets were united with others.

    Sets whose outlines meet are united; an outline that lies within another without touching it is its hole.
    """
    parts = [part for part in parts if part]
    loops = [loop for part in parts for loop in part]
    rings = _rings(loops)
    if len(parts) < 2 or rings is None or shapely.is_simple(shapely.multilinestrings(rings)):
        return loops, 0
    if _crossings(rings) > MOST_CROSSINGS:
        return loops, 0
    lines = np.array([shapely.multilinestrings(_rings(part)) for part in parts])
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
        regions = [_region(part, _rings(part), True) for part in members]
        united += polygon_loops(shapely.get_parts(shapely.union_all(regions)))
    return united, touched


def join(chains: Sequence[Floats], gap: float, *, alone: bool) -> tuple[list[Floats], list[float], str]:
    """Return the closed loops of open lines whose ends are no more than ``gap`` apart, the gaps, and what is left out.

    Lines that repeat others, or that end where no other goes on, are left out. Raises ``FileFormatError`` with the
    place where three meet, and where an end is alone if there is no loop then: ``alone`` says that there is no other.
    """
    if not chains:
        return [], [], ""
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
        stray = "; ".join(filter(None, [stray, f"left out {what} where no other goes on, {place}"]))
    for members in meeting.values():
        if len(members) > 2:
            x, y = ends[members[0]].tolist()
            raise FileFormatError(f"{len(members)} lines end at ({x:g}, {y:g}); leave two, that go on in each other")
    loops, gaps = [], []
    for start in sorted(left):
        end, points = 2 * start, list[Floats]()
        while end // 2 in left:
            left.discard(end // 2)
            chain = chains[end // 2] if end % 2 == 0 else chains[end // 2][::-1]
            points.append(chain[:-1])
            far = end ^ 1
            first, second = meeting[int(node[far])]
            end = second if first == far else first
            gaps.append(float(np.hypot(*(ends[end] - ends[far]))))
        if points:
            loops.append(points_array(np.concatenate(points)))
    return loops, gaps, stray


def _without_strays(chains: Sequence[Floats], nodes: Ints) -> tuple[set[int], list[int], int]:
    """Return the lines that go on at both ends, the ends that do not of those that are left out, and how many repeat.

    ``nodes`` ``(n, 2)``: where the ends of each line are.
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
    for end in waiting:  # it grows
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


def _rings(loops: Sequence[Floats]) -> list[shapely.LineString] | None:
    """Return the loops as closed lines, or None where there is none or a number that is not finite."""
    if not loops or not all(len(loop) > 1 and np.isfinite(loop).all() for loop in loops):
        return None
    return [shapely.linestrings(np.concatenate([loop, loop[:1]])) for loop in loops]


def _crossings(rings: Sequence[shapely.LineString]) -> int:
    """Return how many pairs of segments meet, beside neighbours; stops counting past the most that are allowed."""
    coords = [shapely.get_coordinates(ring) for ring in rings]
    segments = shapely.linestrings(np.concatenate([np.stack([line[:-1], line[1:]], axis=1) for line in coords]))
    tree, count, start, batch = shapely.STRtree(segments), 0, 0, 1
    segments = np.random.default_rng(0).permutation(segments)  # where all lie in one place, a few tell
    while start < len(segments) and count <= 2 * MOST_CROSSINGS:
        asked = segments[start : start + batch]
        one, _ = tree.query(asked, predicate="intersects")
        count += max(len(one) - 3 * len(asked), 0)
        start, batch = start + batch, min(2 * batch, _BATCH)
    return count // 2


def _region(loops: Sequence[Floats], rings: Sequence[shapely.LineString] | None, even_odd: bool) -> shapely.Geometry:
    """Return what the loops fill: the faces between all lines whose winding number says so."""
    faces = shapely.get_parts(shapely.polygonize([shapely.union_all(rings)]))
    inside = shapely.get_coordinates(shapely.point_on_surface(faces))
    winding = sum((_winding(inside, loop) for loop in loops), np.zeros(len(inside), dtype=np.int64))
    return shapely.union_all(faces[winding % 2 == 1 if even_odd else winding != 0])


def _winding(points: Floats, loop: Floats) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
    """Return how often ``loop`` goes around each point, counter-clockwise."""
    (x, y), (to_x, to_y) = loop.T, np.roll(loop, -1, axis=0).T
    turns = np.zeros(len(points), dtype=np.int64)
    for number, (px, py) in enumerate(points.tolist()):
        left = (to_x - x) * (py - y) - (px - x) * (to_y - y)
        turns[number] = np.sum((y <= py) & (to_y > py) & (left > 0)) - np.sum((y > py) & (to_y <= py) & (left < 0))
    return turns


def _nonzero(loops: Sequence[Floats]) -> list[Floats]:
    """Return those of disjoint loops across which the winding number begins or ceases to be zero."""
    rings = shapely.linearrings(np.concatenate(loops), indices=np.repeat(np.arange(len(loops)), list(map(len, loops))))
    own = np.where(shapely.is_ccw(rings), 1, -1)
    polygons, starts = shapely.polygons(rings), shapely.points([loop[0] for loop in loops])
    inside, around = shapely.STRtree(polygons).query(starts, predicate="within")  # not itself: it starts on its edge
    outside = np.bincount(inside, weights=own[around], minlength=len(loops))
    return [loop for loop, kept in zip(loops, (outside == 0) != (outside + own == 0), strict=True) if kept]
