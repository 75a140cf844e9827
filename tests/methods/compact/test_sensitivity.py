"""Systems that are solved full or sparse."""

from __future__ import annotations

import numpy as np

from foldcut.methods.compact.sensitivity import solve_dense, solve_sparse


def test_full_and_sparse_matrices_have_the_same_solution() -> None:
    chance = np.random.default_rng(8)
    matrix = chance.normal(size=(90, 60)) * (chance.random((90, 60)) < 0.2) + np.eye(90, 60)
    rows, columns = matrix.nonzero()
    given = chance.normal(size=(12, 3))
    entries = (rows, columns, matrix[rows, columns])
    full, sparse = (solve(entries, matrix.shape, given) for solve in (solve_dense, solve_sparse))
    assert full.shape == (48, 3)
    assert np.allclose(full, sparse, rtol=1e-9, atol=1e-9)
