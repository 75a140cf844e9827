"""Outlines on A4 and walks around them, for the tests of the compact method."""

from __future__ import annotations

import numpy as np

from foldcut.core.arrays import Floats
from foldcut.core.model import Sheet
from foldcut.drawing.placement import parse_sheet, place
from foldcut.drawing.shape import make_shape
from foldcut.methods.compact.cover import with_more_turns
from foldcut.methods.compact.linear_program import Program
from foldcut.methods.compact.outline import Outline
from foldcut.methods.compact.turns import Solution, Turns

A4 = parse_sheet("a4")


def loop_of(points: list[tuple[float, float]], sheet: Sheet = A4) -> Floats:
    """Return the outline of a polygon placed on a sheet, ``(n, 2)`` mm."""
    return place(make_shape([points]), sheet)[0].loops[0]


def plain_turns(loop: Floats, root: int = 0) -> Turns:
    """Return the turns of the plan with no pocket turned, and the root on a side."""
    return Turns.build(np.ones(len(loop), dtype=bool), root, at_corner=False)


def covered(loop: Floats, clearance: float = 0.02) -> tuple[Outline, Program, Solution]:
    """Return a solution that leaves nothing of the outline out, by adding turns as the search does."""
    outline = Outline(loop)
    program = Program(outline, plain_turns(loop))
    solution = program.solve(program.evenly(), clearance=clearance)
    while solution is not None and solution.left_out.any():
        turns, along = with_more_turns(outline, program.turns, solution)
        program = Program(outline, turns)
        solution = program.solve(along, clearance=clearance)
    assert solution is not None
    return outline, program, solution


def many_corners() -> Floats:
    """Return a wavy star of 160 corners on A4."""
    random = np.random.default_rng(1)
    angles = (np.arange(160) + random.uniform(0.1, 0.9, 160)) * 2 * np.pi / 160
    reach = 80 + 15 * np.sin(7 * angles)
    return loop_of(list(zip(reach * np.cos(angles), reach * np.sin(angles), strict=True)))
