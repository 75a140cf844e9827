"""Disk packing: disks are added until every gap between them has three or four sides.

``BoundaryDisks`` -> ``Packing`` (paper section 2, second half).

A gap is bounded by chains of disks that touch in a row (``chains``). A growing disk that rolls into the gap from two of
them gives the largest disk that touches both and a third (``rolling``). Of these the largest that helps is placed, with
a tangency edge to every disk that it touches, and divides the gap (``dividing``). Gaps of a single chain can be filled
by compiled code instead (``packing_compiled``), which gives the same disks bit for bit.

Invariants: consecutive disks of a gap touch; disks of a face do not overlap; every gap has 3 or 4 visits; the polygons
of the gaps tile the sheet (less the ribbon).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np

from foldcut.core.arrays import Bools, Floats, Ints, Ragged, index_array, points_array
from foldcut.core.compiled import COMPILED
from foldcut.core.errors import UnfoldableError
from foldcut.geometry.vectors import signed_area
from foldcut.methods.disks.boundary import BoundaryDisks
from foldcut.methods.disks.chains import Chain, StuckError, flat
from foldcut.methods.disks.disk_pairs import overlapping_disks
from foldcut.methods.disks.dividing import NEARLY, Divider
from foldcut.methods.disks.rolling import EQUAL, GrowingDisks, RolledOneByOne, RolledTogether
from foldcut.methods.disks.tolerance import Tolerance

if TYPE_CHECKING:
    from foldcut.methods.disks.packing_compiled import GapFiller

__all__ = ["COMPILING", "MANY_DISKS", "Packing", "Progress", "fill_gaps", "packing_faults"]

MANY_DISKS = 1_000
"""From this many boundary disks on, compiled code saves more time than loading it takes."""

COMPILING = "compiling, once on this machine"
"""What ``progress`` says before the first use of compiled code."""

OFTEN = 64
"""After this many finished gaps progress is reported."""

Progress = Callable[[float, str], None]
"""Called with the part done, 0 to 1, and a remark, mostly empty."""


@dataclass(frozen=True, eq=False)
class Packing:
    """The finished packing.

    ``centres`` ``(n, 2)`` and ``radii`` ``(n,)`` in mm; ``node`` ``(n,)``: two disks on either side of one boundary
    point share a node; ``gaps`` ragged: the disks of each gap counter-clockwise, ``gap_face`` ``(gaps,)`` its face;
    ``face_inside`` ``(faces,)`` and ``loop_nodes`` as in ``BoundaryDisks``; ``ribbon``: its half-width in mm;
    ``boundary_count``: how many disks lie on boundaries (they come first).
    """

    centres: Floats
    radii: Floats
    node: Ints
    gaps: Ragged
    gap_face: Ints
    face_inside: Bools
    loop_nodes: Ragged
    ribbon: float
    boundary_count: int


def fill_gaps(boundary: BoundaryDisks, tolerance: Tolerance, progress: Progress | None = None) -> Packing:
    """Add disks until all gaps are 3-gaps or 4-gaps.

    ``progress`` gets an estimate of the part done. Raises ``UnfoldableError`` with the place where a gap cannot be
    divided further. Source: paper section 2; Bern, Mitchell and Ruppert 1995 for the choice of disks.
    """
    packer = _Packer(boundary, tolerance, progress)
    values: list[Ints] = []
    lengths: list[Ints] = []
    faces: list[Ints] = []
    for face in range(len(boundary.face_inside)):
        chains = [
            row.tolist() for row, its_face in zip(boundary.chains, boundary.chain_face, strict=True) if its_face == face
        ]
        try:
            for its_values, its_lengths in packer.fill(chains):
                values.append(its_values)
                lengths.append(its_lengths)
                faces.append(np.full(len(its_lengths), face, dtype=np.int32))
        except StuckError as error:
            raise _unfoldable(error) from None
    disks = packer.disks
    count = disks.count
    offsets = np.concatenate([[0], np.cumsum(np.concatenate(lengths))])
    new_nodes = np.arange(count - len(boundary.node), dtype=np.int32) + int(boundary.node.max()) + 1
    return Packing(
        points_array(disks.centres[:count]),
        disks.radii[:count].copy(),
        index_array(np.concatenate([boundary.node, new_nodes])),
        Ragged(index_array(np.concatenate(values)), index_array(offsets)),
        index_array(np.concatenate(faces)),
        boundary.face_inside,
        boundary.loop_nodes,
        boundary.ribbon,
        len(boundary.radii),
    )


def _unfoldable(error: StuckError) -> UnfoldableError:
    x, y = error.place
    sizes = " and ".join(str(len(chain)) for chain in error.chains)
    return UnfoldableError(
        f"no disk divides the gap of {sizes} disks near ({x:.3f}, {y:.3f}) mm; "
        "move the drawing or its corners a little, or use a bigger sheet"
    )


class _Packer:
    """Fills one face after the other."""

    def __init__(self, boundary: BoundaryDisks, tolerance: Tolerance, progress: Progress | None) -> None:
        self.disks = GrowingDisks(boundary.centres, boundary.radii)
        self._progress = progress
        self._boundary_count = self.disks.count
        compiled = _compiled_filler(tolerance) if COMPILED.pays(self.disks.count, MANY_DISKS) else None
        self._one_chain: _OneChain
        if compiled is None:
            self._divider = Divider(self.disks, RolledOneByOne(self.disks, tolerance), tolerance)
            self._one_chain = _ByDivision(self._divider, self._report)
        else:
            self._divider = Divider(self.disks, RolledTogether(self.disks, tolerance, compiled), tolerance)
            self._one_chain = _ByCompiledCode(self.disks, compiled, self._report)

    def fill(self, chains: list[Chain]) -> Iterator[tuple[Ints, Ints]]:
        """Yield the finished gaps of the face between ``chains``: their disks, and how many each has."""
        self._one_chain.begin(chains)
        stack = self._divider.split_at_touching_disks(chains)
        done: list[Chain] = []
        while stack:
            gap = stack.pop()
            if len(gap) > 1:
                stack.extend(self._divider.divide(gap))
            elif len(gap[0]) > 4:
                yield flat(done)
                done = []
                yield self._one_chain.fill(gap[0])
            else:
                _finish(gap[0], done, self._divider)
        yield flat(done)

    def _report(self, remark: str = "") -> None:
        if self._progress is not None:  # about as many disks are added as lie on boundaries
            part = (self.disks.count - self._boundary_count) / max(1, self._boundary_count)
            self._progress(min(0.99, part), remark)


def _finish(chain: Chain, done: list[Chain], divider: Divider) -> None:
    """Add a gap of at most four disks to those that are done. Raises ``StuckError`` where there are fewer than 3."""
    if len(chain) < 3:
        raise StuckError([chain], divider.middle([chain]))
    done.append(chain)


class _OneChain(Protocol):
    """What fills the gap inside a single chain."""

    def begin(self, chains: list[Chain]) -> None:
        """Begin a face with these boundary chains."""

    def fill(self, chain: Chain) -> tuple[Ints, Ints]:
        """Return the finished gaps: their disks, and how many each has. Raises ``StuckError``."""


class _ByDivision:
    """``_OneChain`` in numpy: divide until no gap is left."""

    def __init__(self, divider: Divider, report: Callable[[], None]) -> None:
        self._divider = divider
        self._report = report
        self._finished = 0

    def begin(self, chains: list[Chain]) -> None:
        """Nothing has to be done."""

    def fill(self, chain: Chain) -> tuple[Ints, Ints]:
        """See ``_OneChain``."""
        stack = [[chain]]
        done: list[Chain] = []
        while stack:
            gap = stack.pop()
            if len(gap[0]) > 4:
                stack.extend(self._divider.divide(gap))
                continue
            _finish(gap[0], done, self._divider)
            self._finished += 1
            if self._finished % OFTEN == 0:
                self._report()
        return flat(done)


class _ByCompiledCode:
    """``_OneChain`` in compiled code, with the same disks in the same order."""

    def __init__(self, disks: GrowingDisks, filler: GapFiller, report: Callable[[str], None]) -> None:
        self._disks = disks
        self._filler = filler
        self._report = report

    def begin(self, chains: list[Chain]) -> None:
        """Give the boundary disks to the compiled code; say so where it has to be compiled first."""
        mine = np.unique(np.concatenate(chains).astype(np.int32))
        if self._filler.start(mine, self._disks.centres, self._disks.radii, self._disks.count):
            self._report(COMPILING)

    def fill(self, chain: Chain) -> tuple[Ints, Ints]:
        """See ``_OneChain``."""
        self._filler.add(self._disks.centres, self._disks.radii, self._disks.count)
        filled = self._filler.fill(np.array(chain, dtype=np.int32), lambda: self._report(""))
        self._disks.extend(filled.centres, filled.radii)
        return filled.values, np.diff(filled.offsets)


def _compiled_filler(tolerance: Tolerance) -> GapFiller | None:
    """Return what fills large gaps in compiled code, or None where numba does not work."""
    try:
        from foldcut.methods.disks.packing_compiled import GapFiller
    except ImportError:
        return None
    return GapFiller(tolerance.tie, tolerance.rounding, NEARLY, EQUAL)


def packing_faults(packing: Packing, area: float, tolerance: Tolerance) -> list[str]:
    """List what breaks the packing's invariants; ``area`` in mm^2 is what the gaps must tile.

    The invariants are those of the module's docstring; empty means valid.
    """
    faults = []
    total = 0.0
    for number, gap in enumerate(packing.gaps):
        polygon = packing.centres[gap]
        total += signed_area(polygon)
        if len(gap) not in (3, 4):
            faults.append(f"gap {number} has {len(gap)} sides")
        if signed_area(polygon) <= 0:
            faults.append(f"gap {number} is not counter-clockwise")
        side = np.roll(polygon, -1, axis=0) - polygon
        radii = packing.radii[gap]
        off = np.hypot(side[:, 0], side[:, 1]) - radii - np.roll(radii, -1)
        if np.abs(off).max() > 4 * tolerance.touching(radii, np.roll(radii, -1)).max():
            faults.append(f"gap {number}: consecutive disks are {np.abs(off).max():.3g} mm from touching")
    if abs(total - area) > 1e-9 * area:
        faults.append(f"the gaps cover {total:.9g} of {area:.9g} mm^2")
    for face in range(len(packing.face_inside)):
        mine = np.unique(packing.gaps.values[np.isin(packing.gaps.rows, np.flatnonzero(packing.gap_face == face))])
        left, _ = overlapping_disks(
            packing.centres[mine], packing.radii[mine], np.zeros(len(mine), dtype=np.int32), tolerance
        )
        if len(left):
            faults.append(f"{len(left)} pairs of disks overlap in face {face}")
    return faults
