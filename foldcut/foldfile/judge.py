"""Judge a FOLD file: the pattern, and whether every field that other programs read agrees with it.

``FoldFile`` and a shape -> findings; none means that the file can be relied on, whichever of its fields is read. The
pattern is verified first, so that the fields are compared with a sheet that folds flat. A field that is not there says
nothing; a layer order that leaves faces which lie on each other without an order proves nothing.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from foldcut.core.arrays import Bools, Floats, Ints, Numbers
from foldcut.core.model import CreasePattern, Finding, Shape
from foldcut.foldfile.claims import INCIDENCES
from foldcut.foldfile.read import FoldFile
from foldcut.geometry.planar_graph import edge_faces, edge_lengths, pair_keys
from foldcut.pattern.face_maps import fold_faces
from foldcut.pattern.overlaps import OVERLAP_TOLERANCE, overlaps
from foldcut.proof.tolerance import COINCIDENT
from foldcut.proof.verify import verify

__all__ = ["FIELDS", "judge", "judge_fields"]

FIELDS = "fields"
"""The check that findings about fields are named after."""

ANGLES = {"M": -180.0, "V": 180.0}
"""The fold angle of a crease in degrees; 0 for other edges."""

ANGLE_SLACK = 0.01
"""Angles may be rounded to this many degrees."""

LENGTH_SLACK = 1e-3
"""``edges_length`` may be rounded to this part of a length."""

MOST_PAIRS = 2_000_000
"""With more pairs of faces that lie on each other than this, nobody finds out whether a file orders them all."""

MOST_FACES = 20_000
"""With more faces than this, an order that follows only from others, through faces between, is not looked for."""

MOST_FINDINGS = 100
"""Each field is reported for this many of its entries at most."""


def judge(file: FoldFile, shape: Shape | None = None) -> list[Finding]:
    """Return all that keeps a file from folding flat as it says, and from being cut right; empty means valid.

    ``shape`` is what the cut must give, on the sheet in mm; without one the cut is not checked.
    """
    return verify(file.pattern, file.layers, shape) or judge_fields(file)


def judge_fields(file: FoldFile, near_mm: float | None = None) -> list[Finding]:
    """Return which fields do not agree with a pattern that has been verified.

    ``near_mm``: how far folded vertices may be from where the creases put them; by default as far as when verifying.
    """
    if near_mm is None:
        near_mm = 2 * COINCIDENT[0] * float(np.hypot(*np.ptp(file.pattern.vertices_coords, axis=0)))
    found = [finding for check in CHECKS for finding in check(file)]
    return [*found, *_folded(file, near_mm)]


def _angles(file: FoldFile) -> Iterator[Finding]:
    """Find creases that ``edges_foldAngle`` does not fold flat, or folds the other way."""
    letters = file.pattern.edges_assignment
    wanted = np.zeros(len(letters))
    for letter, angle in ANGLES.items():
        wanted[letters == letter] = angle
    for name, angles in file.claims.angles.items():
        for edge in _first(np.abs(angles - wanted) > ANGLE_SLACK):  # NaN is not
            kind = f"{letters[edge]}, which folds flat by {wanted[edge]:g}" if wanted[edge] else f"{letters[edge]}: 0"
            message = f"{name}[{edge}] is {angles[edge]:g} degrees, but the edge is {kind}; make them agree"
            yield _at(file.pattern, edge, message)


def _letters(file: FoldFile) -> Iterator[Finding]:
    """Find edges to which another frame gives another assignment."""
    letters = file.pattern.edges_assignment
    for name, others in file.claims.letters.items():
        for edge in _first(others != letters):
            message = f"{name}[{edge}] is {others[edge]!s:.8}, but {letters[edge]} in the first frame; make them agree"
            yield _at(file.pattern, edge, message)


def _folded(file: FoldFile, near_mm: float) -> Iterator[Finding]:
    """Find vertices that a folded frame has elsewhere than the creases put them; the whole may be moved or turned."""
    pattern = file.pattern
    maps = fold_faces(pattern, edge_faces(pattern))
    used = np.unique(pattern.faces_vertices.values)
    ours = _complex(maps.apply(_a_face_of_each_vertex(pattern), pattern.vertices_coords)[used])
    for name, places in file.claims.folded.items():
        theirs = _complex(places[used] * file.unit_mm)
        off = min((_off(way, theirs) for way in (ours, ours.conj())), key=np.max)
        if off.max() > near_mm:
            vertex = int(used[off.argmax()])
            x, y = pattern.vertices_coords[vertex].tolist()
            message = f"{name}[{vertex}] is {off.max():.3g} mm from where the creases put the vertex"
            yield Finding(FIELDS, message, (x, y), float(off.max()))


def _orders(file: FoldFile) -> Iterator[Finding]:
    """Find faces that a list of face orders lays the other way round than the layer order that was verified."""
    layers = file.layers
    if layers is None or file.turned is None:
        return
    by = "foldcut:layers" if file.own_layers else next(iter(file.claims.orders), "")
    rank = np.argsort(layers)
    up = fold_faces(file.pattern, edge_faces(file.pattern)).up != file.turned
    for name, rows in file.claims.orders.items():
        f, g, side = rows.T
        over = (side > 0) == up[g]
        for row in _first((side != 0) & ((over != (rank[f] > rank[g])) | (f == g))):
            one, other = int(f[row]), int(g[row])
            message = (
                f"{name}[{row}] lays face {one} {'over' if over[row] else 'under'} face {other}, {by} the other way "
                "round; make them agree"
            )
            yield Finding(FIELDS, message, _middle(file.pattern, one))


def _complete(file: FoldFile) -> Iterator[Finding]:
    """Find faces that lie on each other and have no order, if the file's only layer order is a list of face orders."""
    if file.layers is None or file.turned is None or file.own_layers or not file.claims.orders:
        return
    name, rows = next(iter(file.claims.orders.items()))
    pattern = file.pattern
    diagonal = float(np.hypot(*np.ptp(pattern.vertices_coords, axis=0)))
    maps = fold_faces(pattern, edge_faces(pattern))
    places = maps.apply(_a_face_of_each_vertex(pattern), pattern.vertices_coords)
    pairs = overlaps(places, pattern.faces_vertices, 10 * OVERLAP_TOLERANCE * diagonal, MOST_PAIRS)
    if pairs is None:
        yield Finding(FIELDS, f"more than {MOST_PAIRS:,} pairs of faces lie on each other: {name} cannot be judged")
        return
    rank = np.argsort(file.layers)
    said = rows[rows[:, 2] != 0, :2]
    low, high = np.where(rank[said[:, :1]] < rank[said[:, 1:]], said, said[:, ::-1]).T
    unsaid = pairs[~np.isin(pair_keys(*pairs.T), pair_keys(np.minimum(low, high), np.maximum(low, high)))]
    if len(unsaid) and len(rank) <= MOST_FACES:
        unsaid = unsaid[~_follows(unsaid, low, high, rank, file.layers)]
    if len(unsaid):
        f, g = unsaid[0].tolist()
        more = f", nor in {len(unsaid) - 1} other pairs" if len(unsaid) > 1 else ""
        message = (
            f"faces {f} and {g} lie on each other, and {name} does not say which is above{more}; order all of them"
        )
        yield Finding("layers", message, _middle(pattern, f))


def _follows(pairs: Ints, low: Ints, high: Ints, rank: Numbers, layers: Ints) -> Bools:
    """Return for which pairs the order follows from that of others: one lies over a face that lies over the other.

    ``low`` and ``high`` are the faces of each order that the file gives.
    """
    over: list[list[int]] = [[] for _ in range(len(layers))]
    for one, other in zip(low.tolist(), high.tolist(), strict=True):
        over[one].append(other)
    below = [0] * len(layers)  # the faces under each face, as the bits of a number
    for face in layers.tolist():
        here = below[face] | 1 << face
        for higher in over[face]:
            below[higher] |= here
    return np.array(
        [
            bool(below[max(pair, key=rank.__getitem__)] >> min(pair, key=rank.__getitem__) & 1)
            for pair in pairs.tolist()
        ],
        dtype=np.bool_,
    )


def _lengths(file: FoldFile) -> Iterator[Finding]:
    """Find edges that are not as long as ``edges_length`` says."""
    real = edge_lengths(file.pattern)
    for name, lengths in file.claims.lengths.items():
        said = lengths * file.unit_mm
        for edge in _first(np.abs(said - real) > LENGTH_SLACK * real):
            yield _at(
                file.pattern, edge, f"{name}[{edge}] says {said[edge]:.6g} mm; the edge is {real[edge]:.6g} mm long"
            )


def _beside(file: FoldFile) -> Iterator[Finding]:
    """Find elements that lie beside others than a field says."""
    if not file.claims.beside:
        return
    real = incidences(file.pattern)
    for name in INCIDENCES:
        said = file.claims.beside.get(name)
        if said is None:
            continue
        wrong = [at for at, (one, other) in enumerate(zip(said, real[name], strict=True)) if one != other]
        for at in wrong[:MOST_FINDINGS]:
            extra, absent = sorted(said[at] - real[name][at]), sorted(real[name][at] - said[at])
            what = f"lists {extra[0]}" if extra else f"leaves out {absent[0]}"
            yield Finding(FIELDS, f"{name}[{at}] {what}, which {'is not' if extra else 'is'} beside it in the pattern")


def incidences(pattern: CreasePattern) -> dict[str, list[set[int]]]:
    """Return for each field of ``INCIDENCES`` what lies beside each vertex, edge or face."""
    counts = (len(pattern.vertices_coords), len(pattern.edges_vertices), len(pattern.faces_vertices))
    found: dict[str, list[set[int]]] = {
        name: [set() for _ in range(counts[("vertices", "edges", "faces").index(name.split("_")[0])])]
        for name in INCIDENCES
    }
    sides = edge_faces(pattern).tolist()
    for edge, ((a, b), faces) in enumerate(zip(pattern.edges_vertices.tolist(), sides, strict=True)):
        found["vertices_vertices"][a].add(b)
        found["vertices_vertices"][b].add(a)
        for vertex in (a, b):
            found["vertices_edges"][vertex].add(edge)
        there = {face for face in faces if face >= 0}
        found["edges_faces"][edge] = there
        for face in there:
            found["faces_edges"][face].add(edge)
            found["faces_faces"][face] |= there - {face}
    for face, outline in enumerate(pattern.faces_vertices.to_lists()):
        for vertex in outline:
            found["vertices_faces"][vertex].add(face)
    return found


CHECKS = (_angles, _letters, _orders, _complete, _lengths, _beside)
"""What is compared with the pattern, in this order."""


def _first(wrong: Bools) -> list[int]:
    """Return where something is wrong, as many places as are reported."""
    places: list[int] = np.flatnonzero(wrong)[:MOST_FINDINGS].tolist()
    return places


def _at(pattern: CreasePattern, edge: int, message: str) -> Finding:
    """Return a finding in the middle of an edge."""
    x, y = pattern.vertices_coords[pattern.edges_vertices[edge]].mean(axis=0).tolist()
    return Finding(FIELDS, message, (x, y))


def _middle(pattern: CreasePattern, face: int) -> tuple[float, float]:
    """Return the middle of the corners of a face."""
    x, y = pattern.vertices_coords[pattern.faces_vertices[face]].mean(axis=0).tolist()
    return x, y


def _a_face_of_each_vertex(pattern: CreasePattern) -> Ints:
    """Return the number of a face that each vertex belongs to; 0 where there is none."""
    face = np.zeros(len(pattern.vertices_coords), dtype=np.int32)
    face[pattern.faces_vertices.values] = pattern.faces_vertices.rows
    return face


Complex = np.ndarray[tuple[int], np.dtype[np.complex128]]


def _complex(points: Floats) -> Complex:
    return points[:, 0] + 1j * points[:, 1]


def _off(ours: Complex, theirs: Complex) -> Floats:
    """Return how far points are from others when ours are moved and turned onto them."""
    ours, theirs = ours - ours.mean(), theirs - theirs.mean()
    turn = complex(np.vdot(ours, theirs))
    turn = turn / abs(turn) if turn else 1.0
    off: Floats = np.abs(turn * ours - theirs)
    return off
