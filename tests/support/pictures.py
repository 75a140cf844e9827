"""Pictures of loops, to be compared with those that other programs paint."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from PIL import Image, ImageDraw

from foldcut.core.arrays import Floats

FINE = 8
"""A pixel is divided into so many along each side."""


def painted(loops: Iterable[Floats], size: tuple[int, int]) -> Floats:
    """Return how dark each pixel is, from 0 to 1, if what loops enclose is black; they are in pixels, y down."""
    width, height = size
    picture = np.zeros((height * FINE, width * FINE), dtype=bool)
    for loop in loops:
        one = Image.new("1", (width * FINE, height * FINE))
        ImageDraw.Draw(one).polygon([(x * FINE - 0.5, y * FINE - 0.5) for x, y in loop.tolist()], fill=1)
        picture ^= np.asarray(one)
    return picture.reshape(height, FINE, width, FINE).mean(axis=(1, 3))


def assert_alike(seen: Floats, read: Floats) -> None:
    """Assert that two pictures, neither of them empty, differ only by smoothing along outlines."""
    assert seen.sum() > 500
    assert np.abs(seen - read).sum() < 0.02 * seen.sum() + 60
    assert (np.abs(seen - read) > 0.6).sum() < 10
