"""Whether a crease pattern folds flat, in the given layer order, so that one cut cuts out the given shape.

Crease pattern, layer order and shape on the sheet (mm) -> findings; none means valid. Nothing is taken on trust: the
folded state is computed anew from the creases, however the pattern was made.

The checks, each of which relies on those before it:

- the arrays make sense (here);
- the faces tile the sheet (``proof.planar``);
- each face, folded, meets its neighbours (here);
- angles, mountains and valleys around every vertex fold flat (``proof.vertices``);
- the layers can lie in their order (``proof.layers``; an order of pairs: ``proof.pairwise``);
- the boundary of the shape comes to lie on one line, and nothing else does (``proof.cut``).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from foldcut.core.arrays import Bools, Ints, Numbers, blocks
from foldcut.core.model import CreasePattern, Finding, Shape
from foldcut.geometry.planar_graph import edge_lengths, edge_sides, faces_of_sides
from foldcut.pattern.face_maps import FaceMaps, fold_faces, folded_edges
from foldcut.proof.cut import check_cut
from foldcut.proof.findings import at_edge, first
from foldcut.proof.layers import check_layer_order, check_mountains, check_stacking
from foldcut.proof.pairwise import check_pairs
from foldcut.proof.planar import check_edges, check_planar, short_edges
from foldcut.proof.tolerance import COINCIDENT
from foldcut.proof.vertices import check_vertices, is_flat_at_vertices

__all__ = ["CHECKS", "PairOrder", "verify"]

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
"""The names of the checks, as findings give them, in their order."""

MANY_SIDES = 100_000
"""Faces with more sides than this are counted first."""

ASSIGNMENTS = ("B", "M", "V", "F", "U")
"""FOLD's letters for edges: border, mountain, valley, flat and unassigned; cuts and joins are not supported."""


@dataclass(frozen=True, eq=False)
class PairOrder:
    """An order of faces that need not be one list: ``pairs`` ``(n, 2)``, in each of which the first face is above."""

    pairs: Numbers


def verify(
    pattern: CreasePattern,
    layers: Ints | PairOrder | None,
    shape: Shape | None = None,
    tolerances: Sequence[float] = COINCIDENT,
) -> list[Finding]:
    """Return all that keeps the pattern from folding flat and from being cut right; an empty list means valid.

    ``layers`` are the face numbers from bottom to top, where up is the side that the front of face 0 shows, or the
    order of pairs of faces; ``shape`` is on the sheet, in mm. Without a shape, the cut is not checked. Without layers,
    the pattern is not verified, and a finding says so. Edges assigned F or U count as not folded. One of the
    ``tolerances``, relative to the sheet's diagonal, the coarsest first, has to find nothing.
    """
    findings = check_arrays(pattern) or check_sides_at_most(pattern)
    if findings:
        return findings
    diagonal = float(np.hypot(*np.ptp(pattern.vertices_coords, axis=0)))
    coarse, *finer = (share * diagonal for share in tolerances)
    lengths, loose = edge_lengths(pattern), check_edges(pattern)

    def found_within(tolerance: float, *, places: bool) -> tuple[list[Finding], bool]:
        findings = short_edges(pattern, lengths, tolerance) + loose
        return (findings, bool(loose)) if findings else _verify_within(tolerance, pattern, layers, shape, places=places)

    findings, for_all = found_within(coarse, places=True)
    for tolerance in finer:
        if for_all or not findings:
            break
        found, for_all = found_within(tolerance, places=False)
        findings = findings if found else []
    return findings


def _verify_within(
    tolerance: float, pattern: CreasePattern, layers: Ints | PairOrder | None, shape: Shape | None, *, places: bool
) -> tuple[list[Finding], bool]:
    """Verify with one tolerance, in mm; also return whether any other would find faults, too.

    With ``places``, also find where edges cross, the cause of many faults.
    """
    sides = edge_sides(pattern)
    faces_of_edges = faces_of_sides(pattern, sides)
    findings, for_all = check_planar(pattern, sides, faces_of_edges, tolerance, places=places)
    if findings:
        return findings, for_all
    del sides
    maps = fold_faces(pattern, faces_of_edges)
    findings = check_closure(pattern, faces_of_edges, maps, tolerance)
    if findings or not is_flat_at_vertices(pattern, faces_of_edges, maps, tolerance):
        findings = [*check_vertices(pattern, faces_of_edges, tolerance), *findings]
    if findings:
        return findings, False
    if layers is None:
        findings = [Finding("layers", "no layer order: whether the layers can lie flat is not verified")]
    elif isinstance(layers, PairOrder):
        findings = check_pairs(pattern, faces_of_edges, maps, layers.pairs, tolerance)
    else:
        findings = check_layer_order(layers, len(pattern.faces_vertices))
        if not findings:
            findings = [
                *check_mountains(pattern, faces_of_edges, maps, layers),
                *check_stacking(pattern, faces_of_edges, maps, layers, tolerance),
            ]
    if shape is not None:
        findings += check_cut(pattern, faces_of_edges, maps, shape, tolerance)
    return findings, False


def check_arrays(pattern: CreasePattern) -> list[Finding]:
    """Find indices that are out of range, places that are not finite, and letters that mean nothing."""
    coords, edges, faces = pattern.vertices_coords, pattern.edges_vertices, pattern.faces_vertices
    if not len(coords) or not len(edges) or not len(faces):
        return [Finding("arrays", "the pattern has no vertices, no edges or no faces; give all three")]
    findings = [
        Finding("arrays", f"vertex {vertex} is not at a finite place")
        for vertex in first(np.logical_not(np.isfinite(coords).all(axis=1)))
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
            for edge in first(~np.isin(pattern.edges_assignment, ASSIGNMENTS))
        ]
    findings += [
        Finding("arrays", f"face {face} has {faces.lengths[face]} vertices; a face has at least three")
        for face in first(faces.lengths < 3)
    ]
    return findings


def check_sides_at_most(pattern: CreasePattern) -> list[Finding]:
    """Find, before anything takes long, that faces have more sides than the edges can have.

    Of fewer than ``MANY_SIDES`` sides those that are wrong are found one by one.
    """
    sides, edges = len(pattern.faces_vertices.values), len(pattern.edges_vertices)
    if sides <= max(2 * edges, MANY_SIDES):
        return []
    problem = f"the faces have {sides:,} sides, and {edges:,} edges have two sides each"
    return [Finding("planar", f"{problem}; name each side of a face once, and list its edge")]


def check_closure(pattern: CreasePattern, faces_of_edges: Ints, maps: FaceMaps, tolerance: float) -> list[Finding]:
    """Find edges whose two faces do not meet when folded, or are not turned over as the assignment says."""
    inner = np.flatnonzero((faces_of_edges[:, 0] >= 0) & (faces_of_edges[:, 1] >= 0))
    left, right = faces_of_edges[inner].T
    gap = np.empty(len(inner))
    for some in blocks(len(inner)):
        ends = pattern.vertices_coords[pattern.edges_vertices[inner[some]]]
        apart = maps.apply(left[some, None], ends) - maps.apply(right[some, None], ends)
        gap[some] = np.hypot(apart[:, :, 0], apart[:, :, 1]).max(axis=1)
    turned: Bools = (maps.up[left] != maps.up[right]) == folded_edges(pattern)[inner]
    findings = []
    for at in first((gap > tolerance) | ~turned):
        faces = f"faces {left[at]} and {right[at]}"
        problem = f"fold to places {gap[at]:.3g} mm apart" if turned[at] else "cannot be turned as it says"
        findings.append(at_edge(pattern, int(inner[at]), "closure", f"at edge {inner[at]}, {faces} {problem}", gap[at]))
    return findings
