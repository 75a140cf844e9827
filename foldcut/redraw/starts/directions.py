"""Sets of directions for sides: those of long straight sides, and the gaps between them divided evenly."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from foldcut.core.arrays import Floats
from foldcut.redraw.starts.chains import Axis

__all__ = ["direction_set", "straight_directions"]

SAME = math.radians(6)
"""Directions nearer than this are one."""


def straight_directions(loops: Sequence[Floats], least: float, axes: Sequence[Axis] = ()) -> list[float]:
    """Return the directions, in radians from 0 to pi, of drawn sides longer than ``least`` mm, longest first.

    Those along and across mirror axes come first.
    """
    steps = np.concatenate([np.roll(loop, -1, axis=0) - loop for loop in loops])
    length = np.hypot(*steps.T)
    own: list[float] = []
    for axis in axes[:1]:
        own += [axis.angle % math.pi, (axis.angle + math.pi / 2) % math.pi]
    for k in np.argsort(-length).tolist():
        if length[k] < least:
            break
        angle = math.atan2(steps[k, 1], steps[k, 0]) % math.pi
        if all(abs(math.remainder(angle - other, math.pi)) > SAME for other in own):
            own.append(angle)
    return own


def direction_set(own: Sequence[float], step: float, phase: float = 0.0) -> Floats:
    """Return left normals ``(d, 2)`` of lines of the directions ``own`` and others between them, about ``step`` apart.

    Without own directions they are even, turned by ``phase`` steps.
    """
    if own:
        first = sorted(own)
        angles = []
        for a, b in zip(first, [*first[1:], first[0] + math.pi], strict=True):
            parts = max(1, round((b - a) / step))
            angles += [a + (b - a) * k / parts for k in range(parts)]
    else:
        parts = max(2, round(math.pi / step))
        angles = [math.pi * (k + phase) / parts for k in range(parts)]
    both = np.array(angles + [angle + math.pi for angle in angles])
    return np.column_stack([-np.sin(both), np.cos(both)])
