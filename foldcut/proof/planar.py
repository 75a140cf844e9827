"""Whether the faces of a pattern tile one sheet, edge to edge.

Pattern -> findings. ``check_planar`` needs arrays that make sense; the other checks of ``proof.verify`` need a pattern
in which it finds nothing.
"""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from foldcut.core.arrays import Bools, Floats, Indices, Ints, Numbers, Ragged, blocks
from foldcut.core.model import CreasePattern, Finding
from foldcut.geometry.planar_graph import Keys, half_edges, pair_keys, signed_areas
from foldcut.proof.findings import MOST_FINDINGS, at_edge, finding, first

__all__ = ["check_edges", "check_planar", "short_edges"]

_BATCH = 256
"""The number of edges or vertices in one query, which bounds the memory that a tangle takes."""

MANY_SIDES = 64
"""In faces with more sides than this, a tree finds sides that a corner comes close to; else all pairs are compared."""

MOST_NEAR = 10_000_000
"""No more pairs of things whose boxes meet are looked at one by one: that takes some 2 s."""

MOST_PLACES = 2_000_000
"""The same where it is only looked for the places of a fault that is known."""

SAMPLE = 64
"""From so many things it is concluded how many boxes all of them meet."""


def check_planar(
    pattern: CreasePattern, sides: Numbers, faces_of_edges: Ints, tolerance: float, *, places: bool
) -> tuple[list[Finding], bool]:
    """Find all that keeps the faces from tiling a sheet with one simple outline, edge to edge.

    Also returns whether any other tolerance would find it, too.

    ``sides`` is ``edge_sides(pattern)``, ``faces_of_edges`` its faces, and ``tolerance`` is in mm. With ``places``,
    crossings are also looked for, which say where a fault comes from.

    These checks suffice: each face is a simple counter-clockwise polygon, the sides of two faces at an inner edge
    cancel, and what remains is one simple counter-clockwise closed curve. So the winding numbers of the faces add up to
    1 inside that curve and to 0 outside it: the faces cover every point of the sheet once. It follows that areas add
    up, that V - E + F = 1, that edges do not cross, and that no vertex lies inside an edge or a face, since the faces
    around each vertex already fill a full turn.

    Nor may a vertex come within the tolerance of an edge that it does not end. The shortest way from the vertex to such
    an edge starts through a face at the vertex, or along an edge, which is longer than the tolerance. So the vertex
    comes within the tolerance of a side of that face, and only the sides of its own faces need to be asked.
    """
    convex, close = _look_at_faces(pattern, tolerance)
    findings = [*_check_face_outlines(pattern, convex), *_check_sides(pattern, sides, faces_of_edges)]
    if not findings and (close or _large_faces_come_close(pattern, tolerance)):
        findings = _vertices_on_edges(pattern, tolerance)
        if findings:
            return findings, False
    if findings:
        return [*findings, *_check_crossings(pattern, tolerance)] if places else findings, True
    findings = _check_outline(pattern, sides)
    return findings and (_check_crossings(pattern, tolerance) or findings), True


def short_edges(pattern: CreasePattern, lengths: Floats, tolerance: float) -> list[Finding]:
    """Find edges that are no longer than ``tolerance``; ``lengths`` is ``(e,)``, all in mm."""
    return [
        at_edge(pattern, edge, "planar", f"edge {edge} is only {lengths[edge]:.3g} mm long; merge its vertices")
        for edge in first(lengths <= tolerance)
    ]


def check_edges(pattern: CreasePattern) -> list[Finding]:
    """Find edges that are given twice, and vertices that no edge reaches."""
    coords, (one, other) = pattern.vertices_coords, pattern.edges_vertices.T
    findings = [
        at_edge(pattern, edge, "planar", f"edge {edge} repeats another edge; leave one out")
        for edge in _repeated(pair_keys(np.minimum(one, other), np.maximum(one, other)))[:MOST_FINDINGS].tolist()
    ]
    reached = np.zeros(len(coords), dtype=np.bool_)
    reached[one] = reached[other] = True
    findings += [
        finding("planar", f"vertex {vertex} is on no edge; leave it out", coords[vertex]) for vertex in first(~reached)
    ]
    return findings


def _look_at_faces(pattern: CreasePattern, tolerance: float) -> tuple[Bools, bool]:
    """Return which faces are surely convex, ``(f,)``, and whether a corner of any face comes close to a side of it.

    Faces with more than ``MANY_SIDES`` are not looked at for that.
    A face is surely convex, and so simple and counter-clockwise, if it turns left at every corner by more than rounding
    can account for, and goes around once. Close means within the tolerance of a side that does not end in the corner.
    """
    coords, faces = pattern.vertices_coords, pattern.faces_vertices
    convex = np.zeros(len(faces), dtype=np.bool_)
    close = False
    # The error of a difference between coordinates as large as the sheet's.
    off = 4 * np.finfo(np.float64).eps * float(np.abs(coords).max())
    for some, outlines in faces.alike():
        x, y = np.moveaxis(coords[outlines], 2, 0)  # (corners, faces)
        following = np.append(np.arange(1, len(x)), 0)
        ax, ay = x[following] - x, y[following] - y  # from each corner to the next one
        convex[some] = _turn_left(ax, ay, following, off)
        if len(outlines) <= MANY_SIDES:
            close = close or _come_close(x, y, ax, ay, tolerance)
    return convex, close


def _turn_left(ax: Floats, ay: Floats, following: Indices, off: float) -> Bools:
    """Return which polygons are surely convex.

    ``ax`` and ``ay``, ``(corners, polygons)``, are the sides from each corner to the ``following`` one, with an error
    of ``off`` in each number.
    """
    bx, by = ax[following], ay[following]
    turn = ax * by - ay * bx
    size = np.abs(ax) + np.abs(ay)
    convex: Bools = (turn > 2 * off * (size + size[following] + off)).all(axis=0)
    if len(ax) > 4:  # with fewer sides it cannot go around twice
        convex &= np.arctan2(turn, ax * bx + ay * by).sum(axis=0) < 3 * np.pi
    return convex


def _come_close(x: Floats, y: Floats, ax: Floats, ay: Floats, tolerance: float) -> bool:
    """Whether a corner of any polygon comes close to a side that it does not end.

    ``x`` and ``y`` are the corners, ``ax`` and ``ay`` the sides that start in them, all ``(corners, polygons)``.
    """
    count = len(x)
    corners = np.arange(count)
    square = ax * ax + ay * ay
    for step in range(2, count):  # from each side to the corners that do not end it
        to = (corners + step) % count
        to_x, to_y = x[to] - x, y[to] - y
        share = ((to_x * ax + to_y * ay) / square).clip(0, 1)
        away_x, away_y = to_x - share * ax, to_y - share * ay
        if (away_x * away_x + away_y * away_y).min() <= (tolerance * (1 + 1e-9)) ** 2:
            return True
    return False


def _large_faces_come_close(pattern: CreasePattern, tolerance: float) -> bool:
    """Whether a corner of a face with many sides comes close to a side that it does not end; the faces are simple."""
    faces = pattern.faces_vertices
    large = np.flatnonzero(faces.lengths > MANY_SIDES).tolist()
    return any(_comes_close(pattern.vertices_coords, faces[face], tolerance) for face in large)


def _comes_close(coords: Floats, outline: Ints, tolerance: float) -> bool:
    """Whether a corner of one polygon comes close to a side that it does not end, or there are too many to ask."""
    ends = np.stack([outline, np.roll(outline, -1)], axis=1)
    tree = shapely.STRtree(shapely.linestrings(coords[ends]))
    corners = shapely.points(coords[outline])
    if _few_enough(tree, corners) < len(corners):
        return True
    for some in blocks(len(outline), _BATCH):
        vertex, side = tree.query(corners[some], predicate="dwithin", distance=tolerance * (1 + 1e-9))
        if (ends[side] != outline[some][vertex][:, None]).all(axis=1).any():
            return True
    return False


def _check_face_outlines(pattern: CreasePattern, convex: Bools) -> list[Finding]:
    """Find faces that are not simple polygons, or that run clockwise; the ``convex`` ones need no check."""
    coords = pattern.vertices_coords
    unsure = np.flatnonzero(~convex)
    rest = pattern.faces_vertices.take(unsure)
    simple = _names_no_vertex_twice(rest)  # GEOS takes the square of the corners for one that does
    asked = np.flatnonzero(simple)
    outlines = rest.take(asked)
    rings = shapely.linearrings(coords[outlines.values], indices=outlines.rows)
    simple[asked] = shapely.is_valid(shapely.polygons(rings))
    clockwise = signed_areas(coords, rest) <= 0
    findings = []
    for at in first(~simple | clockwise):
        problem = "runs clockwise; reverse it" if simple[at] else "is not a simple polygon; its sides cross or touch"
        findings.append(finding("planar", f"face {unsure[at]} {problem}", coords[rest[at]].mean(axis=0)))
    return findings


def _names_no_vertex_twice(faces: Ragged) -> Bools:
    """Return which faces name each of their vertices once, ``(f,)``."""
    keys = pair_keys(faces.rows, faces.values)
    once = np.ones(len(faces), dtype=np.bool_)
    once[faces.rows[_repeated(keys)]] = False
    return once


def _check_sides(pattern: CreasePattern, sides: Numbers, faces_of_edges: Ints) -> list[Finding]:
    """Find edges and sides of faces that do not match: an edge has two faces, or one at the border of the sheet."""
    matched = np.zeros(len(pattern.faces_vertices.values), dtype=np.bool_)
    matched[sides[sides >= 0]] = True
    findings = [] if matched.all() else _unmatched_sides(pattern)
    borders = (faces_of_edges >= 0).sum(axis=1)
    border = pattern.edges_assignment == "B"
    for wrong, problem in (
        (borders == 0, "borders no face"),
        ((borders == 1) & ~border, "has a face on one side only; assign B at the sheet's border"),
        (
            (borders == 2) & border,
            "is assigned B but has faces on both sides; cuts in the sheet are not supported",
        ),
    ):
        findings += [at_edge(pattern, edge, "planar", f"edge {edge} {problem}") for edge in first(wrong)]
    return findings


def _unmatched_sides(pattern: CreasePattern) -> list[Finding]:
    """Find sides of faces that occur twice, and sides that are not edges."""
    start, end = half_edges(pattern.faces_vertices)
    rows = pattern.faces_vertices.rows
    keys = pair_keys(start, end)
    findings = []
    for side in _repeated(keys)[:MOST_FINDINGS].tolist():
        message = f"face {rows[side]} lies on the same side of an edge as another face; faces must not overlap"
        findings.append(_at_side(pattern, start[side], end[side], message))
    known = pair_keys(*np.sort(pattern.edges_vertices, axis=1).T)
    sides = pair_keys(np.minimum(start, end), np.maximum(start, end))
    for side in first(~_is_among(sides, known)):
        message = f"face {rows[side]} has a side, vertices {start[side]} to {end[side]}, that is not an edge"
        findings.append(_at_side(pattern, start[side], end[side], message))
    return findings


def _repeated(keys: Keys) -> Numbers:
    """Return the indices of keys that repeat an earlier one, ascending."""
    ordered = np.sort(keys)
    if (ordered[1:] != ordered[:-1]).all():
        return np.empty(0, dtype=np.intp)
    order = np.argsort(keys, kind="stable")
    return np.sort(order[1:][keys[order[1:]] == keys[order[:-1]]])


def _is_among(keys: Keys, known: Keys) -> Bools:
    """Return which ``keys`` are among the ``known`` ones."""
    known = np.sort(known)
    at = np.minimum(np.searchsorted(known, keys), len(known) - 1)
    found: Bools = known[at] == keys
    return found


def _check_crossings(pattern: CreasePattern, tolerance: float) -> list[Finding]:
    """Find edges that cross, and vertices that lie on an edge without being one of its ends."""
    coords, edges = pattern.vertices_coords, pattern.edges_vertices
    lines = shapely.linestrings(coords[edges])
    tree = shapely.STRtree(lines)
    findings: list[Finding] = []
    start, size, end = 0, 1, _few_enough(tree, lines, MOST_PLACES)
    while start < end and len(findings) < MOST_FINDINGS:  # a few at first: each may cross all others
        some = slice(start, min(start + size, end))
        start, size = some.stop, min(2 * size, _BATCH)
        one, other = tree.query(lines[some], predicate="crosses")
        one = one + some.start
        once = np.flatnonzero(one < other)[: MOST_FINDINGS - len(findings)]
        one, other = one[once], other[once]
        places = shapely.get_coordinates(shapely.centroid(shapely.intersection(lines[one], lines[other])))
        findings += [
            finding("planar", f"edges {a} and {b} cross; divide both there", place)
            for a, b, place in zip(one.tolist(), other.tolist(), places, strict=True)
        ]
    if len(findings) >= MOST_FINDINGS:
        return findings
    return [*findings, *_vertices_on_edges(pattern, tolerance, tree)]


def _few_enough(tree: shapely.STRtree, asked: NDArray[np.object_], most: int = MOST_NEAR) -> int:
    """Return how many of the geometries, from the first on, may be asked what in the tree they come near to.

    So many that some ``most`` boxes meet theirs, as a sample of them says.
    """
    sample = asked[:: max(1, len(asked) // SAMPLE)][:SAMPLE]
    near = sum(len(tree.query(one)) for one in sample) / len(sample)
    return min(len(asked), int(most / max(near, 1.0)))


def _vertices_on_edges(pattern: CreasePattern, tolerance: float, tree: shapely.STRtree | None = None) -> list[Finding]:
    """Find vertices that lie on an edge without being one of its ends.

    ``tree`` holds all edges; it is given where other findings decide, and only the first places are wanted.
    """
    coords, edges, decides = pattern.vertices_coords, pattern.edges_vertices, tree is None
    tree = tree or shapely.STRtree(shapely.linestrings(coords[edges]))
    points = shapely.points(coords)
    findings: list[Finding] = []
    enough = _few_enough(tree, points, MOST_NEAR if decides else MOST_PLACES)
    for some in blocks(enough, _BATCH):
        vertex, edge = tree.query(points[some], predicate="dwithin", distance=tolerance)
        vertex = vertex + some.start
        apart = np.flatnonzero((edges[edge] != vertex[:, None]).all(axis=1))[: MOST_FINDINGS - len(findings)]
        findings += [
            finding("planar", f"vertex {v} lies on edge {e}; divide the edge there", coords[v])
            for v, e in zip(vertex[apart].tolist(), edge[apart].tolist(), strict=True)
        ]
        if len(findings) >= MOST_FINDINGS:
            break
    if decides and enough < len(points) and not findings:
        what = "edges run past so many vertices that it was not found out whether these lie on them"
        findings = [finding("planar", f"{what}; divide long edges", coords[0])]
    return findings


def _check_outline(pattern: CreasePattern, sides: Numbers) -> list[Finding]:
    """Find what keeps the border edges from being one simple counter-clockwise curve."""
    start, end = half_edges(pattern.faces_vertices)
    border = np.sort(sides[(sides < 0).any(axis=1)].max(axis=1))
    following = dict(zip(start[border].tolist(), end[border].tolist(), strict=True))
    if len(following) < len(border):
        values, counts = np.unique(start[border], return_counts=True)
        place = pattern.vertices_coords[values[counts > 1][0]]
        return [finding("planar", "the sheet's border meets itself; the sheet must be one piece there", place)]
    first = next(iter(following))
    outline = [first]
    while following[outline[-1]] != first:
        outline.append(following[outline[-1]])
    coords = pattern.vertices_coords
    if len(outline) < len(following):
        known = set(outline)
        rest = next(vertex for vertex in following if vertex not in known)
        message = "the sheet has a second border; it must be one piece without holes"
        return [finding("planar", message, coords[rest])]
    curve = shapely.linearrings(coords[outline])
    if not shapely.is_simple(curve) or not shapely.is_ccw(curve):
        return [finding("planar", "the sheet's border crosses itself", coords[first])]
    return []


def _at_side(pattern: CreasePattern, start: int, end: int, message: str) -> Finding:
    """Return a finding at the middle of a side of a face, given by its vertices."""
    return finding("planar", message, pattern.vertices_coords[[start, end]].mean(axis=0))
