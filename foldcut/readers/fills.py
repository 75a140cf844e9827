"""From drawn outlines to loops of one even-odd set: fill rules, overlaps, chains of lines.

Loops that touch nothing keep their numbers to the last digit; only where outlines cross or touch does shapely make
new ones.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from foldcut.errors import FileFormatError
from foldcut.model import Floats, points_array
from foldcut.shape import polygon_loops

MOST_CROSSINGS = 10_000
"""Outlines with more crossings are left as they are: ``make_shape`` refuses them by place."""

_BATCH = 256


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


def join(chains: Sequence[Floats], gap: float) -> list[Floats]:
    """Return the closed loops that open lines form whose ends are no more than ``gap`` apart.

    Raises ``FileFormatError`` with the place where an end is alone or three meet.
    """
    if not chains:
        return []
    ends = np.array([end for chain in chains for end in (chain[0], chain[-1])])
    if not np.isfinite(ends).all():
        raise FileFormatError("a line ends at a place that is not finite; give finite numbers")
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import KDTree

    pairs = KDTree(ends).query_pairs(gap, output_type="ndarray")
    links = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(ends), len(ends)))
    _, node = connected_components(links, directed=False)
    meeting: dict[int, list[int]] = {}
    for end, at in enumerate(node.tolist()):
        meeting.setdefault(at, []).append(end)
    for members in meeting.values():
        x, y = ends[members[0]].tolist()
        if len(members) == 1:
            distances, _ = KDTree(ends).query(ends[members[0]], k=min(2, len(ends)))
            raise FileFormatError(
                f"a line ends at ({x:g}, {y:g}), {np.max(distances):.3g} from the next end; close the outline, "
                "or join ends that are farther apart with --join"
            )
        if len(members) > 2:
            raise FileFormatError(f"{len(members)} lines end at ({x:g}, {y:g}); leave two, that go on in each other")
    loops, left = [], set(range(len(chains)))
    while left:
        end, points = 2 * min(left), list[Floats]()
        while end // 2 in left:
            left.discard(end // 2)
            chain = chains[end // 2] if end % 2 == 0 else chains[end // 2][::-1]
            points.append(chain[:-1])
            far = end ^ 1
            first, second = meeting[int(node[far])]
            end = second if first == far else first
        loops.append(points_array(np.concatenate(points)))
    return loops


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
