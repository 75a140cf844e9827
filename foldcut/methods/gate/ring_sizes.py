"""Folding a shape with several loops: rings of several sizes are tried, the first verified pattern is taken.

Shape, sheet -> ``Gated`` (docs/several-loops.md).
"""

from __future__ import annotations

import time
from dataclasses import dataclass, replace

import numpy as np

from foldcut.core.arrays import Ints, Ragged, index_array
from foldcut.core.errors import UnfoldableError
from foldcut.core.model import CreasePattern, FoldedState, Shape, Sheet
from foldcut.methods.disks.boundary import boundary_disks
from foldcut.methods.disks.disk_pairs import overlapping_disks
from foldcut.methods.disks.molecules import Molecules, build_molecules
from foldcut.methods.disks.packing import Packing, fill_gaps
from foldcut.methods.disks.tolerance import Tolerance
from foldcut.methods.gate.joining import join
from foldcut.methods.gate.parts import Parts, divide_faces
from foldcut.methods.gate.rings import Ring, plan_rings, small_at_gates
from foldcut.proof.verify import verify

__all__ = ["MOST_DISKS", "ROOMS", "Gated", "build_gated", "fold_gated"]

ROOMS = (2.6, 3.5, 5.0)
"""The sizes of rings that are tried: the room on either side of a ring, in radii of its disks."""

MOST_DISKS = {"fast": 10_000, "normal": 20_000, "best": 60_000}
"""By effort, how many disks of rings and of boundaries may be packed for all sizes together.

A disk makes about 33 creases; 4,000 disks take about a second, including verification.
"""


@dataclass(frozen=True, eq=False)
class Gated:
    """What the method made.

    ``excess``: by how much the facets beside the paths exceed the crevice triangles, relative to these;
    ``parent`` ``(m,)``: the molecules' parents in T_M, -1 at roots.
    """

    packing: Packing
    molecules: Molecules
    rings: list[Ring]
    creases: CreasePattern
    folded: FoldedState
    excess: float
    parent: Ints


def fold_gated(
    shape: Shape, sheet: Sheet, ribbon: float, effort: str = "normal", seconds: float | None = None
) -> Gated:
    """Fold a shape with several loops by rings of equal disks; try smaller and smaller rings until one is verified.

    ``shape`` is in the sheet's mm, ``ribbon`` is the half-width in mm; ``effort`` is a key of ``MOST_DISKS``, and
    ``seconds`` a time limit instead of it. Raises ``UnfoldableError`` with the reason where there is no room, the
    layers cross, or too many disks are needed.
    """
    if len(shape.loops) < 2:
        raise UnfoldableError("the shape has one boundary loop; a gate joins several")
    budget = _Budget(effort, seconds)
    reasons = []
    for room in ROOMS:
        try:
            made = build_gated(shape, sheet, ribbon, room, budget=budget)
        except UnfoldableError as error:
            reasons.append(str(error))
            if budget.over:
                break
            continue
        findings = verify(made.creases, made.folded.layers, shape)
        if not findings:
            return made
        reasons.append(f"the pattern fails verification ({findings[0]})")
    why = reasons[0] if len(reasons) == 1 or not budget.over else f"{reasons[0]}; with smaller rings {reasons[-1]}"
    raise UnfoldableError(f"the shape's {len(shape.loops)} loops cannot be joined by gates: {why}")


class _Budget:
    """How many disks may be packed, and for how long."""

    def __init__(self, effort: str, seconds: float | None) -> None:
        self.effort, self.seconds = effort, seconds
        self.most = self.left = MOST_DISKS["best" if seconds is not None else effort]
        self.start = time.perf_counter()
        self.over = False

    def take(self, disks: int) -> None:
        """Count more disks. Raises ``UnfoldableError`` if they are too many."""
        self.left -= disks
        if self.left < 0:
            self.over = True
            more = "" if self.most == MOST_DISKS["best"] else "give --effort best, "
            raise UnfoldableError(
                f"{disks:,} disks would be needed, and all that is tried may have {self.most:,}; {more}"
                "move the loops apart, or use a bigger sheet or fewer corners"
            )
        self.look()

    def look(self, _: float = 0.0, __: str = "") -> None:
        """Raise ``UnfoldableError`` if the time is over; this can be called as a ``packing.Progress``."""
        if self.seconds is not None and time.perf_counter() - self.start > self.seconds:
            self.over = True
            raise UnfoldableError(f"the {self.seconds:g} seconds are over; give more --seconds")


def build_gated(
    shape: Shape, sheet: Sheet, ribbon: float, room: float, *, move_layers: bool = True, budget: _Budget | None = None
) -> Gated:
    """Build the pattern with one size of ring, not verified.

    ``room`` is one of ``ROOMS``. Without ``move_layers`` the pattern has no gate (for tests).
    """
    tolerance = Tolerance.for_sheet(sheet)
    root, rings = plan_rings(shape, sheet, ribbon, room)
    most = budget.left if budget else MOST_DISKS["best"]
    boundary = boundary_disks(shape, sheet, ribbon, tolerance, small_at_gates(rings), most)
    parts = divide_faces(boundary, rings)
    _require_apart(parts, tolerance)
    if budget is not None:
        budget.take(len(parts.boundary.radii))
    packed = fill_gaps(parts.boundary, tolerance, budget.look if budget else None)
    packing = with_molecules(packed, parts)
    molecules = build_molecules(packing, tolerance)
    joined = join(molecules, packing.face_inside.tolist(), parts, root, rings, move_layers=move_layers)
    return Gated(packing, molecules, rings, joined.creases, joined.folded, joined.excess, joined.parent)


def _require_apart(parts: Parts, tolerance: Tolerance) -> None:
    """Raise ``UnfoldableError`` where disks overlap before packing: they give no pattern."""
    boundary = parts.boundary
    each = np.stack([boundary.chain_face[boundary.chains.rows], boundary.chains.values], axis=1)
    face, disk = np.unique(each, axis=0).T
    one, _ = overlapping_disks(boundary.centres[disk], boundary.radii[disk], face, tolerance)
    if len(one):
        x, y = boundary.centres[disk[one[0]]]
        raise UnfoldableError(
            f"disks of the rings overlap near ({x:.4g}, {y:.4g}); move the loops apart or use a bigger sheet"
        )


def with_molecules(packing: Packing, parts: Parts) -> Packing:
    """Return the packing, with the triangles at the rings among its gaps."""
    triangles = 3 * np.arange(1, len(parts.molecules) + 1)
    offsets = np.append(packing.gaps.offsets, packing.gaps.offsets[-1] + triangles)
    return replace(
        packing,
        gaps=Ragged(np.append(packing.gaps.values, parts.molecules), index_array(offsets)),
        gap_face=np.append(packing.gap_face, parts.parts),
    )
