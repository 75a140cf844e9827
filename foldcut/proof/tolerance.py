"""The tolerances of verification: how close counts as touching."""

from __future__ import annotations

COINCIDENT = (1e-8, 1e-10, 1e-12)
"""What lies this close, relative to the sheet's diagonal, counts as touching; a pattern has to pass with one of them.

Patterns are computed to about 1e-13, and paper is cut to about 1e-4; any tolerance between the two would do. But
needles, narrow slits, and the closest of a million disks have creases as short as a coarse tolerance, so a pattern that
fails with it is tried again with a finer one. That is no loophole: touching layers may overlap by the tolerance, and
folds may gape by it, so a finer one allows less.
"""
