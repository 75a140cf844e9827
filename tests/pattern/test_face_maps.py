"""Ways from face to face: the simple code is as good as scipy's."""

from __future__ import annotations

import numpy as np

from foldcut.pattern.face_maps import paths_by_scipy, short_paths


def test_paths_between_few_faces_are_as_short_as_scipys() -> None:
    chance = np.random.default_rng(8)
    for count in (1, 2, 30, 200):
        low, high = np.triu_indices(count, 1)
        some = chance.random(len(low)) < 6 / count
        low, high = low[some], high[some]
        cost = chance.random(len(low)) + 0.01
        ours, before = short_paths(low, high, cost, count)
        theirs, before_theirs = paths_by_scipy(low, high, cost, count)
        assert np.allclose(ours, theirs, rtol=1e-12)
        assert (before < 0).tolist() == (before_theirs < 0).tolist()
