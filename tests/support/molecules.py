"""Single molecules of the disk method."""

from __future__ import annotations

import numpy as np

from foldcut.core.arrays import Ragged
from foldcut.methods.disks.molecules import Molecules, build_molecules
from foldcut.methods.disks.packing import Packing
from foldcut.methods.disks.tolerance import Tolerance


def one_molecule(centres: list[tuple[float, float]], radii: list[float]) -> Molecules:
    """Fold a single gap of free disks inside a shape."""
    count = len(radii)
    packing = Packing(
        np.array(centres, dtype=float),
        np.array(radii, dtype=float),
        np.arange(count, dtype=np.int32),
        Ragged.from_rows([range(count)]),
        np.zeros(1, dtype=np.int32),
        np.array([True]),
        Ragged.from_rows([]),
        0.0,
        0,
    )
    return build_molecules(packing, Tolerance(1e-8, 1e-12))
