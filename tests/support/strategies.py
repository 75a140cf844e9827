"""Polygons for the tests of every stage: exact regular ones, seeded random ones, and hypothesis strategies.

All are lists of (x, y), counter-clockwise, about 2 across and around the origin unless they say otherwise.
"""

from __future__ import annotations

import math

import numpy as np
from hypothesis import settings
from hypothesis import strategies as st

from foldcut.core.errors import ShapeError
from foldcut.drawing.shape import make_shape, minimum_feature

Points = list[tuple[float, float]]

MAX_TRIES = 2000

# A slow machine is no fault of the code.
settings.register_profile("foldcut", deadline=None, derandomize=True)
settings.load_profile("foldcut")


def unit_point(k: int, n: int) -> tuple[float, float]:
    """Return the point at k/n of a turn on the unit circle, exactly symmetric about axes and diagonals."""
    k %= n
    if 2 * k > n:
        x, y = unit_point(n - k, n)
        return x, -y
    if 4 * k > n:
        x, y = unit_point(n - 2 * k, 2 * n)
        return -x, y
    if 8 * k > n:
        x, y = unit_point(n - 4 * k, 4 * n)
        return y, x
    if 8 * k == n:
        return math.sqrt(0.5), math.sqrt(0.5)
    angle = math.tau * k / n
    return math.cos(angle), math.sin(angle)


def regular(n: int) -> Points:
    """Return the regular n-gon of circumradius 1, its first corner on the x axis."""
    return [unit_point(k, n) for k in range(n)]


def star(n: int, ratio: float) -> Points:
    """Return the star with n tips at radius 1 and its dents at radius ``ratio``."""
    corners = regular(2 * n)
    return [(x, y) if k % 2 == 0 else (ratio * x, ratio * y) for k, (x, y) in enumerate(corners)]


def rectangle(width: float, height: float) -> Points:
    """Return the rectangle of this size around the origin."""
    x, y = width / 2, height / 2
    return [(-x, -y), (x, -y), (x, y), (-x, y)]


def cross() -> Points:
    """Return the Greek cross of five unit squares."""
    quarter = [(1.5, -0.5), (1.5, 0.5), (0.5, 0.5)]
    return [turned for turns in range(4) for turned in (_quarter_turns(point, turns) for point in quarter)]


def star_shaped(rng: np.random.Generator, n: int, min_feature: float = 0.005) -> Points:
    """Return a random polygon with n corners that is seen whole from the origin.

    ``min_feature`` is the least distance of a corner from an edge that does not end in it, as a part of the
    bounding box's diagonal.
    """
    for _ in range(MAX_TRIES):
        angles = math.tau * (np.arange(n) + 0.7 * rng.random(n)) / n
        radii = 0.3 + 0.7 * rng.random(n)
        points = np.column_stack([radii * np.cos(angles), radii * np.sin(angles)])
        if _is_good(points, min_feature):
            return _as_list(points)
    raise AssertionError(f"no star-shaped polygon with {n} corners and features of {min_feature}")


def two_opt(rng: np.random.Generator, n: int, min_feature: float = 0.005) -> Points:
    """Return a random polygon with n corners: a tour that reversals of its parts made short, so simple.

    ``min_feature`` is as for ``star_shaped``.
    """
    for _ in range(MAX_TRIES):
        points = 2 * rng.random((n, 2)) - 1
        apart = np.hypot(*(points[:, None] - points[None]).transpose(2, 0, 1)) + 9 * np.eye(n)
        if apart.min() < 4 * min_feature:
            continue
        points = _uncrossed(points)
        if _is_good(points, min_feature):
            return _as_list(points)
    raise AssertionError(f"no polygon with {n} corners and features of {min_feature}")


def _quarter_turns(point: tuple[float, float], turns: int) -> tuple[float, float]:
    x, y = point
    for _ in range(turns):
        x, y = -y, x
    return x, y


def _uncrossed(points: np.ndarray) -> np.ndarray:
    """Return ``points`` in an order that no reversal of a part shortens: such a tour does not cross."""
    while True:
        after = np.roll(points, -1, axis=0)
        old = np.hypot(*(after - points).T)
        across = np.hypot(*(points[:, None] - points[None]).transpose(2, 0, 1))
        gain = old[:, None] + old[None] - across - np.roll(across, (-1, -1), axis=(0, 1))
        np.fill_diagonal(gain, 0.0)
        i, j = sorted(map(int, np.unravel_index(gain.argmax(), gain.shape)))
        if gain[i, j] < 1e-9:
            return points
        points = np.concatenate([points[: i + 1], points[i + 1 : j + 1][::-1], points[j + 1 :]])


def _is_good(points: np.ndarray, min_feature: float) -> bool:
    try:
        shape = make_shape([points])
    except ShapeError:
        return False
    diagonal = float(np.hypot(*np.ptp(points, axis=0)))
    return shape.corner_count == len(points) and minimum_feature(shape)[0] >= min_feature * diagonal


def _as_list(points: np.ndarray) -> Points:
    shape = make_shape([points])
    return [(x, y) for x, y in shape.loops[0].tolist()]


def simple_polygons(
    min_corners: int = 4, max_corners: int = 60, min_feature: float = 0.005
) -> st.SearchStrategy[Points]:
    """Return a strategy for random simple polygons, which shrinks to fewer corners."""
    return st.builds(
        lambda make, n, seed: make(np.random.default_rng(seed), n, min_feature),
        st.sampled_from([star_shaped, two_opt]),
        st.integers(min_corners, max_corners),
        st.integers(0, 2**32 - 1),
    )


def near_collinear_polygons(off: float = 1e-3) -> st.SearchStrategy[Points]:
    """Return a strategy for polygons with a corner on an edge, or up to ``off`` of its length beside it."""

    def bent(points: Points, edge: int, share: float, shift: float) -> Points:
        edge %= len(points)
        start, end = np.array(points[edge]), np.array(points[(edge + 1) % len(points)])
        along = end - start
        x, y = (start + share * along + shift * np.array([-along[1], along[0]])).tolist()
        return [*points[: edge + 1], (x, y), *points[edge + 1 :]]

    shifts = st.sampled_from([0.0, 1e-15, -1e-12, 1e-9, -3e-5, 1e-4, off])  # none is at the tolerance itself
    return st.builds(bent, simple_polygons(4, 20), st.integers(0, 19), st.floats(0.2, 0.8), shifts)


def similarities() -> st.SearchStrategy[tuple[float, float, tuple[float, float]]]:
    """Return a strategy for (scale, rotation in radians, shift): 1e-3 to 1e3 in size, up to 1e4 away."""
    far = st.floats(-1e4, 1e4)
    return st.tuples(st.sampled_from([1e-3, 0.37, 1.0, 12.5, 1e3]), st.floats(0, math.tau), st.tuples(far, far))


def moved(points: Points, similarity: tuple[float, float, tuple[float, float]]) -> Points:
    """Return ``points`` scaled, turned and shifted."""
    scale, angle, shift = similarity
    turned = [complex(x, y) * scale * complex(math.cos(angle), math.sin(angle)) for x, y in points]
    return [(point.real + shift[0], point.imag + shift[1]) for point in turned]


RING = [[(0, 0), (30, 0), (30, 30), (0, 30)], [(10, 10), (20, 10), (20, 20), (10, 20)]]
ISLAND = [*RING, [(13, 13), (17, 13), (17, 17), (13, 17)]]

# Loops that the disks of the paper's method are tried on, by name.
DISK_SHAPES = {
    "triangle": [[(0, 0), (4, 0), (1, 3)]],
    "needle": [[(0, 0), (40, 0), (0, 4)]],
    "square": [rectangle(1, 1)],
    "long rectangle": [rectangle(7, 1)],
    "hexagon": [regular(6)],
    "star": [star(5, 0.4)],
    "random": [star_shaped(np.random.default_rng(3), 24)],
    "ring": RING,
    "ring with an island": ISLAND,
    "two triangles": [[(0, 0), (4, 0), (1, 3)], [(6, 0), (9, 1), (6, 4)]],
}

# Single loops, by name.
SINGLE_LOOPS = {
    "triangle": [(0, 0), (4, 0), (1, 3)],
    "hexagon": regular(6),
    "long rectangle": rectangle(5, 1),
    "star": star(5, 0.4),
    "random": star_shaped(np.random.default_rng(8), 15),
}
