"""How many simple folds a person makes, and how many creases close together: steps, counted and in words.

Pattern and its steps -> ``Phase`` after ``Phase``; creases that lie on each other count as one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from foldcut.core.arrays import Floats, Ints
from foldcut.core.model import FoldedPattern
from foldcut.folding_steps.steps import MOST_CREASES, FoldingStep
from foldcut.methods.simple.lines import merged_sides
from foldcut.pattern.difficulty import Difficulty, difficulty
from foldcut.pattern.foldability import Foldability
from foldcut.pattern.straight_lines import straight_lines

__all__ = ["Phase", "difficulty_of", "in_words", "lines_of", "phases"]

SAME = 1e-6
"""Creases that are this near each other, relative to the sheet's diagonal, lie on each other."""


@dataclass(frozen=True)
class Phase:
    """A row of simple folds, ``count`` of them, or, if ``together``, so many creases that close at the same time."""

    count: int
    together: bool


def phases(pattern: FoldedPattern, steps: Sequence[FoldingStep]) -> tuple[Phase, ...]:
    """Return the phases of folding a pattern by its ``folding_steps``."""
    found: list[Phase] = []
    at = pattern.creases.vertices_coords
    for step in steps:
        if step.line is None:
            found.append(Phase(len(lines_of(pattern, at, step.edges)), together=True))
        elif found and not found[-1].together:
            found[-1] = Phase(found[-1].count + 1, together=False)
        else:
            found.append(Phase(1, together=False))
        at = step.state.vertices_coords
    return tuple(found)


def in_words(some: Sequence[Phase]) -> str:
    """Return phases in words: "2 simple folds, then 30 creases that close together"."""
    return ", then ".join(_in_words(phase) for phase in some)


def difficulty_of(some: Sequence[Phase], numbers: Foldability, folds: int | None = None) -> Difficulty:
    """Return how difficult a pattern is; ``folds``: how many there are, where nobody has counted the phases."""
    counted = numbers.lines if folds is None else folds
    together = sum(phase.count for phase in some if phase.together) if some else None
    total = sum(phase.count for phase in some) if some else counted
    return difficulty(total, together, numbers.layers_at_cut, numbers.shortest_crease_mm)


def _in_words(phase: Phase) -> str:
    if not phase.together:
        return f"{phase.count} simple fold{'s' * (phase.count != 1)}"
    return f"{phase.count} creases that close together" if phase.count != 1 else "1 crease that closes"


def lines_of(pattern: FoldedPattern, at: Floats, edges: Ints) -> list[Floats]:
    """Return the lines, ``(2, 2)`` mm each, on which creases lie when the vertices are ``at`` ``(v, 2)``.

    Creases that lie on each other, in several layers, or go straight on are one line; of more than ``MOST_CREASES``
    those that share no end stay apart.
    """
    points = pattern.creases.edges_vertices[edges]
    if len(edges) > MOST_CREASES:
        return [at[list(ends)] for ends in straight_lines(at, points.tolist())]
    lines, _, _ = merged_sides(at[points], np.arange(len(edges)), SAME * pattern.sheet.diagonal)
    return list(lines)
