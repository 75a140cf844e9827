"""Whether a crease pattern folds flat, in this layer order, so that one cut cuts out this shape.

Crease pattern, layer order and shape on the sheet (mm) -> findings; none means valid. Nothing is believed:
the folded state is worked out anew from the creases, however the pattern was made.

The checks, each resting on those before it: the arrays make sense; the faces tile the sheet; angles and
mountains around every vertex (Kawasaki, Maekawa); every face's folded place agrees with its neighbours';
the layers can lie in their order (``stacking``); the shape's boundary comes to lie on one line (``cutline``).
"""

from __future__ import annotations

import numpy as np
import shapely

from foldcut.core.arrays import Bools, Floats, Ints, Numbers
from foldcut.core.model import CreasePattern, Finding, Shape
from foldcut.geometry.planar_graph import (
    Keys,
    edge_lengths,
    edge_sides,
    faces_of_sides,
    half_edges,
    pair_keys,
    signed_areas,
)
from foldcut.pattern.face_maps import FaceMaps, fold_faces, folded_edges
from foldcut.proof.cut import check_cut
from foldcut.proof.layers import check_layer_order, check_mountains, check_stacking
from foldcut.proof.tolerance import COINCIDENT

__all__ = ["CHECKS", "verify"]


CHECKS = (
    "arrays",
    "planar",
    "kawasaki",
    "maekawa",
    "closure",
    "layers",
    "mountain-valley",
    "taco-tortilla",
    "tortilla-tortilla",
    "taco-taco",
    "cut",
)
"""What findings are called, in the order of the checks."""

BATCH = 1 << 13
"""Faces looked at together; bounds the memory, not the result."""

ASSIGNMENTS = ("B", "M", "V", "F", "U")


def verify(pattern: CreasePattern, layers: Ints | None, shape: Shape | None = None) -> list[Finding]:
    """Return everything that keeps the pattern from folding flat and being cut; an empty list means valid.

    ``layers`` are the face numbers from bottom to top, up being the normal of face 0; ``shape`` is on the
    sheet, in mm. Without a shape the cut is not checked; without layers the pattern is not verified, and the
    findings say so. Edges assigned F or U are taken as not folded.
    """
    findings = _check_arrays(pattern)
    if findings:
        return findings
    diagonal = float(np.hypot(*np.ptp(pattern.vertices_coords, axis=0)))
    coarse, *finer = (share * diagonal for share in COINCIDENT)
    lengths, loose = edge_lengths(pattern), _check_edges(pattern)

    def found_within(tolerance: float, *, places: bool) -> list[Finding]:
        findings = _short_edges(pattern, lengths, tolerance) + loose
        return findings or _verify_within(tolerance, pattern, layers, shape, places=places)

    findings = found_within(coarse, places=True)
    return findings if findings and all(found_within(tolerance, places=False) for tolerance in finer) else []


def _verify_within(
    tolerance: float, pattern: CreasePattern, layers: Ints | None, shape: Shape | None, *, places: bool
) -> list[Finding]:
    """Verify with one tolerance, in mm; without ``places`` crossings that come of something else are not looked for."""
    sides = edge_sides(pattern)
    faces_of_edges = faces_of_sides(pattern, sides)
    findings = _check_planar(pattern, sides, faces_of_edges, tolerance, places=places)
    if findings:
        return findings
    del sides
    maps = fold_faces(pattern, faces_of_edges)
    findings = _check_closure(pattern, faces_of_edges, maps, tolerance)
    if findings or not _is_flat_at_vertices(pattern, faces_of_edges, maps, tolerance):
        findings = [*_check_vertices(pattern, faces_of_edges, tolerance), *findings]
    if findings:
        return findings
    if layers is None:
        findings = [Finding("layers", "no layer order: whether the layers can lie flat is not verified")]
    else:
        findings = check_layer_order(layers, len(pattern.faces_vertices))
        if not findings:
            findings = [
                *check_mountains(pattern, faces_of_edges, maps, layers),
                *check_stacking(pattern, faces_of_edges, maps, layers, tolerance),
            ]
    if shape is not None:
        findings += check_cut(pattern, faces_of_edges, maps, shape, tolerance)
    return findings


def _check_arrays(pattern: CreasePattern) -> list[Finding]:
    """Find numbers that point nowhere, and letters that mean nothing."""
    coords, edges, faces = pattern.vertices_coords, pattern.edges_vertices, pattern.faces_vertices
    if not len(coords) or not len(edges) or not len(faces):
        return [Finding("arrays", "the pattern has no vertices, no edges or no faces; give all three")]
    findings = [
        Finding("arrays", f"vertex {vertex} is not at a finite place")
        for vertex in np.flatnonzero(~np.isfinite(coords).all(axis=1)).tolist()
    ]
    for name, values in (("edges_vertices", edges), ("faces_vertices", faces.values)):
        wrong = values[(values < 0) | (values >= len(coords))]
        if wrong.size:
            findings.append(Finding("arrays", f"{name} names vertex {wrong[0]}; there are {len(coords)}"))
    if len(pattern.edges_assignment) != len(edges):
        counts = f"{len(pattern.edges_assignment)} assignments for {len(edges)} edges"
        findings.append(Finding("arrays", f"there are {counts}; give one each"))
    else:
        findings += [
            Finding(
                "arrays",
                f"edge {edge} is assigned {str(pattern.edges_assignment[edge])!r}; use B, M, V, F or U",
            )
            for edge in np.flatnonzero(~np.isin(pattern.edges_assignment, ASSIGNMENTS)).tolist()
        ]
    findings += [
        Finding("arrays", f"face {face} has {faces.lengths[face]} vertices; a face has at least three")
        for face in np.flatnonzero(faces.lengths < 3).tolist()
    ]
    return findings


def _check_planar(
    pattern: CreasePattern, sides: Numbers, faces_of_edges: Ints, tolerance: float, *, places: bool
) -> list[Finding]:
    """Find whatever keeps the faces from tiling a sheet with one simple outline, edge to edge.

    Why this is enough: each face is a simple counter-clockwise polygon, the sides of two faces at an inner
    edge cancel, and what remains is one simple counter-clockwise closed curve. So the winding numbers of the
    faces add up to 1 inside that curve and to 0 outside: every point of the sheet is covered once. Then areas
    add up, V - E + F = 1, edges do not cross, and no vertex lies inside an edge or a face, since the faces
    around every vertex already fill a full turn. Crossings are searched for only where that fails: to name the place.

    No vertex may come within the tolerance of an edge, either. The way from one that does leaves it through a face, or
    along an edge, which is longer; so it comes within the tolerance of an edge of that face, and only these are asked.
    """
    convex, close = _look_at_faces(pattern, tolerance)
    findings = [*_check_face_outlines(pattern, convex), *_check_sides(pattern, sides, faces_of_edges)]
    if not findings and close:
        findings = _vertices_on_edges(pattern, tolerance)
        if findings:
            return findings
    if findings:
        return [*findings, *_check_crossings(pattern, tolerance)] if places else findings
    findings = _check_outline(pattern, sides)
    return findings and (_check_crossings(pattern, tolerance) or findings)


def _short_edges(pattern: CreasePattern, lengths: Floats, tolerance: float) -> list[Finding]:
    """Find edges without length."""
    return [
        _at_edge(pattern, edge, "planar", f"edge {edge} is only {lengths[edge]:.3g} mm long; merge its vertices")
        for edge in np.flatnonzero(lengths <= tolerance).tolist()
    ]


def _check_edges(pattern: CreasePattern) -> list[Finding]:
    """Find edges given twice, and vertices that no edge reaches."""
    coords, (one, other) = pattern.vertices_coords, pattern.edges_vertices.T
    findings = [
        _at_edge(pattern, edge, "planar", f"edge {edge} repeats another edge; leave one out")
        for edge in _repeated(pair_keys(np.minimum(one, other), np.maximum(one, other))).tolist()
    ]
    reached = np.zeros(len(coords), dtype=np.bool_)
    reached[one] = reached[other] = True
    lonely = np.flatnonzero(~reached)
    findings += [
        _finding("planar", f"vertex {vertex} is on no edge; leave it out", coords[vertex]) for vertex in lonely.tolist()
    ]
    return findings


def _check_face_outlines(pattern: CreasePattern, convex: Bools) -> list[Finding]:
    """Find faces that are not simple polygons, or run clockwise; those surely convex are neither."""
    coords = pattern.vertices_coords
    unsure = np.flatnonzero(~convex)
    rest = pattern.faces_vertices.take(unsure)
    rings = shapely.linearrings(coords[rest.values], indices=rest.rows)
    simple = shapely.is_valid(shapely.polygons(rings))
    clockwise = signed_areas(coords, rest) <= 0
    findings = []
    for at in np.flatnonzero(~simple | clockwise).tolist():
        problem = "runs clockwise; reverse it" if simple[at] else "is not a simple polygon; its sides cross or touch"
        findings.append(_finding("planar", f"face {unsure[at]} {problem}", coords[rest[at]].mean(axis=0)))
    return findings


MANY_SIDES = 64
"""The sides of faces with more are looked for in a tree, those of the others compared all with all."""


def _look_at_faces(pattern: CreasePattern, tolerance: float) -> tuple[Bools, bool]:
    """Which faces are surely convex, and whether a vertex comes close to a side of its face.

    Surely convex, so simple and counter-clockwise: it turns left at every corner by more than rounding can feign, and
    once around. Close: within the tolerance of a side that does not end there.
    """
    coords, faces = pattern.vertices_coords, pattern.faces_vertices
    convex = np.zeros(len(faces), dtype=np.bool_)
    close = False
    # a difference of coordinates of the sheet's size is off by this much
    off = 4 * np.finfo(np.float64).eps * float(np.abs(coords).max())
    lengths = faces.lengths
    for count in np.flatnonzero(np.bincount(lengths)).tolist():
        alike = np.flatnonzero(lengths == count)
        for first in range(0, len(alike), BATCH):
            some = alike[first : first + BATCH]
            rings = faces.values[faces.offsets[some] + np.arange(count)[:, None]]
            x, y = np.moveaxis(coords[rings], 2, 0)  # (corners, faces)
            convex[some] = _turn_left(x, y, off)
            if count > MANY_SIDES:
                close = close or any(_comes_close(coords, ring, tolerance) for ring in rings.T)
            else:
                close = close or _come_close(x, y, tolerance)
    return convex, close


def _turn_left(x: Floats, y: Floats, off: float) -> Bools:
    """Which polygons, ``(corners, polygons)``, are surely convex, the coordinates' differences being off so much."""
    following = np.append(np.arange(1, len(x)), 0)
    ax, ay = x[following] - x, y[following] - y
    bx, by = ax[following], ay[following]
    turn = ax * by - ay * bx
    size = np.abs(ax) + np.abs(ay)
    convex: Bools = (turn > 2 * off * (size + size[following] + off)).all(axis=0)
    if len(x) > 4:  # less cannot go around twice
        convex &= np.arctan2(turn, ax * bx + ay * by).sum(axis=0) < 3 * np.pi
    return convex


def _come_close(x: Floats, y: Floats, tolerance: float) -> bool:
    """Whether of some polygon, ``(corners, polygons)``, a corner comes close to a side that it does not end."""
    count = len(x)
    corners = np.arange(count)
    ax, ay = x[(corners + 1) % count] - x, y[(corners + 1) % count] - y
    square = ax * ax + ay * ay
    for step in range(2, count):  # from each side to the corners that do not end it
        to = (corners + step) % count
        to_x, to_y = x[to] - x, y[to] - y
        share = ((to_x * ax + to_y * ay) / square).clip(0, 1)
        away_x, away_y = to_x - share * ax, to_y - share * ay
        if (away_x * away_x + away_y * away_y).min() <= (tolerance * (1 + 1e-9)) ** 2:
            return True
    return False


def _comes_close(coords: Floats, ring: Ints, tolerance: float) -> bool:
    ends = np.stack([ring, np.roll(ring, -1)], axis=1)
    tree = shapely.STRtree(shapely.linestrings(coords[ends]))
    vertex, side = tree.query(shapely.points(coords[ring]), predicate="dwithin", distance=tolerance * (1 + 1e-9))
    return bool((ends[side] != ring[vertex][:, None]).all(axis=1).any())


def _repeated(keys: Keys) -> Numbers:
    """The places of keys that have come before, ascending."""
    ordered = np.sort(keys)
    if (ordered[1:] != ordered[:-1]).all():
        return np.empty(0, dtype=np.intp)
    order = np.argsort(keys, kind="stable")
    return np.sort(order[1:][keys[order[1:]] == keys[order[:-1]]])


def _is_among(keys: Keys, known: Keys) -> Bools:
    """Which keys are known ones."""
    known = np.sort(known)
    at = np.minimum(np.searchsorted(known, keys), len(known) - 1)
    found: Bools = known[at] == keys
    return found


def _check_sides(pattern: CreasePattern, sides: Numbers, faces_of_edges: Ints) -> list[Finding]:
    """Find sides of faces that do not pair up at the edges."""
    at_edge = np.zeros(len(pattern.faces_vertices.values), dtype=np.bool_)
    at_edge[sides[sides >= 0]] = True
    findings = [] if at_edge.all() else _unmatched_sides(pattern)
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
        findings += [
            _at_edge(pattern, edge, "planar", f"edge {edge} {problem}") for edge in np.flatnonzero(wrong).tolist()
        ]
    return findings


def _unmatched_sides(pattern: CreasePattern) -> list[Finding]:
    """Find sides that are there twice, or are no edges."""
    start, end = half_edges(pattern.faces_vertices)
    rows = pattern.faces_vertices.rows
    keys = pair_keys(start, end)
    findings = []
    for side in _repeated(keys).tolist():
        message = f"face {rows[side]} lies on the same side of an edge as another face; faces must not overlap"
        findings.append(_at_side(pattern, start[side], end[side], message))
    known = pair_keys(*np.sort(pattern.edges_vertices, axis=1).T)
    sides = pair_keys(np.minimum(start, end), np.maximum(start, end))
    for side in np.flatnonzero(~_is_among(sides, known)).tolist():
        message = f"face {rows[side]} has a side, vertices {start[side]} to {end[side]}, that is not an edge"
        findings.append(_at_side(pattern, start[side], end[side], message))
    return findings


def _check_crossings(pattern: CreasePattern, tolerance: float) -> list[Finding]:
    """Find edges that cross, and vertices that lie on an edge without being an end of it."""
    coords, edges = pattern.vertices_coords, pattern.edges_vertices
    lines = shapely.linestrings(coords[edges])
    tree = shapely.STRtree(lines)
    one, other = tree.query(lines, predicate="crosses")
    once = one < other
    one, other = one[once], other[once]
    places = shapely.get_coordinates(shapely.centroid(shapely.intersection(lines[one], lines[other])))
    findings = [
        _finding("planar", f"edges {a} and {b} cross; divide both there", place)
        for a, b, place in zip(one.tolist(), other.tolist(), places, strict=True)
    ]
    return [*findings, *_vertices_on_edges(pattern, tolerance, tree)]


def _vertices_on_edges(pattern: CreasePattern, tolerance: float, tree: shapely.STRtree | None = None) -> list[Finding]:
    """Find vertices that lie on an edge without being an end of it; ``tree`` has the edges."""
    coords, edges = pattern.vertices_coords, pattern.edges_vertices
    tree = tree or shapely.STRtree(shapely.linestrings(coords[edges]))
    vertex, edge = tree.query(shapely.points(coords), predicate="dwithin", distance=tolerance)
    apart = (edges[edge] != vertex[:, None]).all(axis=1)
    return [
        _finding("planar", f"vertex {v} lies on edge {e}; divide the edge there", coords[v])
        for v, e in zip(vertex[apart].tolist(), edge[apart].tolist(), strict=True)
    ]


def _check_outline(pattern: CreasePattern, sides: Numbers) -> list[Finding]:
    """Find out whether the border edges make one simple counter-clockwise curve."""
    start, end = half_edges(pattern.faces_vertices)
    border = np.sort(sides[(sides < 0).any(axis=1)].max(axis=1))
    following = dict(zip(start[border].tolist(), end[border].tolist(), strict=True))
    if len(following) < len(border):
        values, counts = np.unique(start[border], return_counts=True)
        place = pattern.vertices_coords[values[counts > 1][0]]
        return [_finding("planar", "the sheet's border meets itself; the sheet must be one piece there", place)]
    first = next(iter(following))
    outline = [first]
    while following[outline[-1]] != first:
        outline.append(following[outline[-1]])
    coords = pattern.vertices_coords
    if len(outline) < len(following):
        known = set(outline)
        rest = next(vertex for vertex in following if vertex not in known)
        message = "the sheet has a second border; it must be one piece without holes"
        return [_finding("planar", message, coords[rest])]
    ring = shapely.linearrings(coords[outline])
    if not shapely.is_simple(ring) or not shapely.is_ccw(ring):
        return [_finding("planar", "the sheet's border crosses itself", coords[first])]
    return []


def _is_flat_at_vertices(pattern: CreasePattern, faces_of_edges: Ints, maps: FaceMaps, tolerance: float) -> bool:
    """Whether ``_check_vertices`` would find nothing for sure, of a pattern whose closure has no findings.

    Then creases part faces that show different sides, so as many go around every inner vertex as have to: an even
    number. And the angles that are every other one are those of the faces that show the same side.
    """
    coords, faces, edges = pattern.vertices_coords, pattern.faces_vertices, pattern.edges_vertices
    excess = np.zeros(len(coords))  # twice what every other angle is more than a half turn
    lengths = faces.lengths
    for count in np.flatnonzero(np.bincount(lengths)).tolist():
        alike = np.flatnonzero(lengths == count)
        following = np.append(np.arange(1, count), 0)
        for first in range(0, len(alike), BATCH):
            some = alike[first : first + BATCH]
            rings = faces.values[faces.offsets[some] + np.arange(count)[:, None]]
            x, y = np.moveaxis(coords[rings], 2, 0)
            ax, ay = x[following] - x, y[following] - y
            bx, by = ax[following], ay[following]
            angle = np.pi - np.arctan2(ax * by - ay * bx, ax * bx + ay * by)
            np.add.at(excess, rings[following], np.where(maps.up[some], angle, -angle))
    excess = np.abs(excess) / 2
    inner = np.ones(len(coords), dtype=np.bool_)
    inner[edges[(faces_of_edges[:, 0] < 0) | (faces_of_edges[:, 1] < 0)]] = False
    surplus = np.zeros(len(coords), dtype=np.int32)
    creased = np.zeros(len(coords), dtype=np.bool_)
    flat = np.zeros(len(coords), dtype=np.bool_)
    for kind, sign in (("M", 1), ("V", -1)):
        crease = edges[pattern.edges_assignment == kind]
        surplus += sign * np.bincount(crease.ravel(), minlength=len(coords)).astype(np.int32)
        for first in range(0, len(crease), BATCH):
            some = crease[first : first + BATCH]
            along = coords[some[:, 1]] - coords[some[:, 0]]
            length = np.hypot(along[:, 0], along[:, 1])
            creased[some] = True
            # one crease short enough will do; the margin is for sums in another order
            flat[some[excess[some] * length[:, None] <= tolerance / 2]] = True
    return bool((flat & (np.abs(surplus) == 2))[inner & creased].all())


def _check_vertices(pattern: CreasePattern, faces_of_edges: Ints, tolerance: float) -> list[Finding]:
    """Find inner vertices where the creases' angles or kinds rule out flat folding.

    Kawasaki: every other angle adds up to a half turn. The error allowed is one that moves the end of the
    vertex's shortest crease by ``tolerance``. Maekawa: mountains and valleys differ by two.
    """
    coords = pattern.vertices_coords
    inner = np.ones(len(coords), dtype=np.bool_)
    inner[pattern.edges_vertices[(faces_of_edges < 0).any(axis=1)]] = False
    crease = folded_edges(pattern)
    tail, head = np.concatenate([pattern.edges_vertices[crease], pattern.edges_vertices[crease][:, ::-1]]).T
    kind = np.tile(np.where(pattern.edges_assignment[crease] == "M", 1, -1), 2)
    dx, dy = (coords[head] - coords[tail]).T
    angle, length = np.arctan2(dy, dx), np.hypot(dx, dy)
    # by vertex, then by angle; angles nearer to each other than 6e-12 may lie in either order
    order = np.argsort(
        (tail.astype(np.int64) << 40) + ((angle + np.pi) * ((2**40 - 1) / (2 * np.pi + 1e-9))).astype(np.int64)
    )
    tail, angle, kind, length = tail[order], angle[order], kind[order], length[order]

    count = len(coords)
    degree = np.bincount(tail, minlength=count)
    position = np.arange(len(tail)) - (np.cumsum(degree) - degree)[tail]
    # Of the angles a0 <= a1 <= ..., all signs alternating, the sum is minus a half turn.
    alternating = np.bincount(tail, weights=np.where(position % 2, -angle, angle), minlength=count)
    excess = alternating + np.pi
    shortest = np.full(count, np.inf)
    starts = np.flatnonzero(np.append(True, tail[1:] != tail[:-1])) if len(tail) else np.empty(0, dtype=np.intp)
    if len(tail):
        shortest[tail[starts]] = np.minimum.reduceat(length, starts)
    surplus = np.bincount(tail, weights=kind, minlength=count)

    creased = inner & (degree > 0)
    findings = []
    for vertex in np.flatnonzero(creased & (degree % 2 == 1)).tolist():
        message = f"{degree[vertex]} creases meet; an even number must"
        findings.append(_finding("kawasaki", message, coords[vertex], 1.0))
    off = creased & (degree % 2 == 0)
    bent = off & (np.abs(excess) * np.where(off, shortest, 0) > tolerance)
    for vertex in np.flatnonzero(bent).tolist():
        degrees = float(np.degrees(abs(excess[vertex])))
        message = f"every other angle adds up to {degrees:.3g} degrees more or less than 180"
        findings.append(_finding("kawasaki", message, coords[vertex], degrees))
    for vertex in np.flatnonzero(off & (np.abs(surplus) != 2)).tolist():
        mountains = int(degree[vertex] + surplus[vertex]) // 2
        message = f"{mountains} mountains and {degree[vertex] - mountains} valleys; they must differ by two"
        findings.append(_finding("maekawa", message, coords[vertex], abs(abs(surplus[vertex]) - 2)))
    return findings


def _check_closure(pattern: CreasePattern, faces_of_edges: Ints, maps: FaceMaps, tolerance: float) -> list[Finding]:
    """Find edges whose two faces, folded, do not meet, or are not turned as the edge's assignment says."""
    inner = np.flatnonzero((faces_of_edges[:, 0] >= 0) & (faces_of_edges[:, 1] >= 0))
    left, right = faces_of_edges[inner].T
    gap = np.empty(len(inner))
    for first in range(0, len(inner), BATCH):
        some = slice(first, first + BATCH)
        ends = pattern.vertices_coords[pattern.edges_vertices[inner[some]]]
        apart = maps.apply(left[some, None], ends) - maps.apply(right[some, None], ends)
        gap[some] = np.hypot(apart[:, :, 0], apart[:, :, 1]).max(axis=1)
    turned: Bools = (maps.up[left] != maps.up[right]) == folded_edges(pattern)[inner]
    findings = []
    for at in np.flatnonzero((gap > tolerance) | ~turned).tolist():
        faces = f"faces {left[at]} and {right[at]}"
        problem = f"fold to places {gap[at]:.3g} mm apart" if turned[at] else "cannot be turned as it says"
        findings.append(
            _at_edge(pattern, int(inner[at]), "closure", f"at edge {inner[at]}, {faces} {problem}", gap[at])
        )
    return findings


def _finding(check: str, message: str, place: Floats, size: float = 0.0) -> Finding:
    return Finding(check, message, (float(place[0]), float(place[1])), float(size))


def _at_edge(pattern: CreasePattern, edge: int, check: str, message: str, size: float = 0.0) -> Finding:
    middle = pattern.vertices_coords[pattern.edges_vertices[edge]].mean(axis=0)
    return _finding(check, message, middle, size)


def _at_side(pattern: CreasePattern, start: int, end: int, message: str) -> Finding:
    return _finding("planar", message, pattern.vertices_coords[[start, end]].mean(axis=0))
