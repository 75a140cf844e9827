"""What tests of redrawing share."""

from __future__ import annotations

import numpy as np
import pytest
from support.outlines import engine_for, on_a4


@pytest.fixture(scope="session")
def kernels_are_loaded() -> None:
    """Load the compiled kernels, and compile them if nobody has, so that no test takes longer for it."""
    shape = on_a4([np.array([(0, 0), (3, 0), (3, 2), (0, 1)])])
    engine = engine_for(shape)
    points = np.concatenate(shape.loops)
    engine.assess(points, (4,), 1.0)
    engine.solve(points, (4,), [])
    engine.is_good(points, (4,))
