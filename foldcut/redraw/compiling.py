"""The compiled code that outlines are searched with: whether it is there, and how it is made ahead.

It is compiled once on a machine, by ``foldcut compile`` or when the first outline is drawn anew, and kept in numba's
cache. Where that cannot be written, each process compiles it.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from functools import cache

import numpy as np

from foldcut.core.arrays import Floats, points_array
from foldcut.core.compiled import compiled_copy, forget_unreadable, is_ready
from foldcut.core.model import Shape
from foldcut.geometry.straight_skeleton import wavefront
from foldcut.geometry.straight_skeleton.skeleton import use_compiled
from foldcut.redraw import proxy_kernel, ties_kernel
from foldcut.redraw.proxy import Engine, Field, Meeting
from foldcut.redraw.starts import all_starts, arcs_code, disks_code, pieces

__all__ = ["COMPILING", "compile_ahead", "get_ready", "is_compiled"]

COMPILING = "compiling the search for outlines: once, about a minute"
"""What ``progress`` says while the code is compiled."""

ENTRIES = (
    (wavefront, ("run", "gather_faces")),
    (proxy_kernel, ("assess",)),
    (ties_kernel, ("is_simple", "deviation", "solve", "tighten")),
    (pieces, ("fit_freely", "fit_directed", "straight_as_far_as")),
    (arcs_code, ("fit_arcs",)),
    (disks_code, ("fit_disks",)),
)
"""The modules, and those of their functions that are called from outside."""


def get_ready(progress: Callable[[str], None]) -> float:
    """Compile what is not compiled yet, and return the seconds that took; ``progress`` is told before that.

    From then on all skeletons of this process are made in compiled code.
    """
    seconds = 0.0
    if not is_compiled():
        started = time.monotonic()
        progress(COMPILING)
        compile_ahead()
        seconds = time.monotonic() - started
    use_compiled()
    return seconds


def is_compiled() -> bool:
    """Tell whether all that is called is in memory, or in numba's cache for this machine."""
    return all(is_ready(vars(compiled_copy(module))[name]) for module, names in ENTRIES for name in names)


@cache
def compile_ahead() -> None:
    """Compile everything, and keep it in numba's cache; some seconds of the processor, once on a machine."""
    for module, _ in ENTRIES:
        forget_unreadable(compiled_copy(module))
    turns = np.linspace(0, 2 * math.pi, 40, endpoint=False)
    loop = 100 + 50 * np.column_stack([np.cos(turns), np.sin(turns)])
    engine = Engine(Field((loop,), 200.0, 200.0, 2.0))
    corners, sizes = loop[::5].copy(), (8,)
    engine.assess(corners, sizes)
    engine.deviation(corners, sizes)
    engine.tighten(corners, sizes, [(0, 2, 4, 6)])
    engine.solve(corners, sizes, [(0, 2, 4, 6)], [Meeting((0, 2, 4), (0,), (0, 2, 6))])
    # a bent strip, which has every kind of outline
    strip = np.concatenate([_bend(50.0), _bend(40.0)[::-1]])
    for _ in all_starts(Shape((points_array(strip),), (-1,)), 2.0):
        pass


def _bend(radius: float) -> Floats:
    """Return a quarter of a circle, ``(20, 2)`` mm."""
    turns = np.linspace(0, math.pi / 2, 20)
    return radius * np.column_stack([np.cos(turns), np.sin(turns)])
