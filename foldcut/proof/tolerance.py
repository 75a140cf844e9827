"""How close is touching: the tolerances of verification."""

from __future__ import annotations

COINCIDENT = (1e-8, 1e-10, 1e-12)
"""What lies this close, relative to the sheet's diagonal, is taken as touching: the first that fits the pattern.

Patterns are made to about 1e-13 and paper is cut to about 1e-4; whatever is between the two does. But needles and
narrow slits, and the closest of a million disks, have creases as short as a coarse tolerance, so what fails there is
tried again with a finer one. That is no loophole: layers that touch may overlap by the tolerance, folds may gape by it,
and a finer one allows less.
"""
