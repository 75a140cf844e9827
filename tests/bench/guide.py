"""The states of the guide of every sample, checked: the numbers of ``docs/guide.md``.

Run it with ``python tests/bench/guide.py [SAMPLE ...]``. Samples are folded by the default command. It prints how
many straight folds each has, and whether every flat state after a step passes all checks and keeps the lengths of its
edges. Of each collapse: how many creases it has; how far lengths are off in the picture on the way, how many of the
creases bend the other way in it, by how much faces bend at most, the seconds of the processor; and how many parts of
the creases could lie flat without the others by the theorems of Kawasaki and Maekawa, counted by a solver up to 99.
Exits with 1 if a state is not as it should be.
"""

from __future__ import annotations

import sys
import time

import numpy as np
from pysat.solvers import Cadical153

from foldcut.core.model import CreasePattern, FoldedPattern, FoldedState
from foldcut.exporters.pictures.folded_paper import FoldedPaper
from foldcut.folding_steps import FoldingStep, folding_steps
from foldcut.folding_steps.crease_sets import CreaseSets
from foldcut.folding_steps.half_closed import _Net, half_closed
from foldcut.folding_steps.state import SheetData
from foldcut.geometry.vectors import signed_area
from foldcut.pipeline import fold
from foldcut.proof.verify import verify
from foldcut.samples import sample_names, sample_path

MOST_SETS = 99
"""So many sets of creases are counted."""


def is_sound(pattern: FoldedPattern, state: FoldedState, folded: np.ndarray) -> bool:
    """Whether a flat state is one that paper can have, with only the creases ``folded``."""
    creases = pattern.creases
    inner = np.isin(creases.edges_assignment, ("M", "V"))
    kinds = np.where(inner & ~folded, "F", creases.edges_assignment)
    some = CreasePattern(creases.vertices_coords, creases.edges_vertices, kinds, creases.faces_vertices)
    ends = creases.edges_vertices
    lengths = [
        np.hypot(*(at[ends[:, 1]] - at[ends[:, 0]]).T) for at in (creases.vertices_coords, state.vertices_coords)
    ]
    up = signed_area(state.vertices_coords[creases.faces_vertices[0]]) > 0
    layers = state.layers if up else state.layers[::-1]  # the verifier looks at face 0 from its front
    return not verify(some, layers) and bool(np.abs(lengths[0] - lengths[1]).max() < 1e-6 * pattern.sheet.diagonal)


def on_the_way(pattern: FoldedPattern, state: FoldedState, folded: np.ndarray, step: FoldingStep) -> str:
    """Return the numbers of the picture on the way."""
    top = FoldedPaper(pattern).top(state, folded, step.edges)
    started = time.process_time()
    found = None if top is None else half_closed(top[0])
    seconds = time.process_time() - started
    if top is None or found is None:
        return "no picture on the way"
    net = _Net(top[0])
    angles = np.degrees(net._angles(found.points)[0])
    closing, within = (angles * net.way)[net.way != 0], np.abs(angles[net.way == 0])
    return (
        f"off {found.strain_mm:.4f} mm, {(closing < -1).sum()} of {len(closing)} the other way, "
        f"faces bend {within.max(initial=0):.0f} degrees, {seconds:.2f} s"
    )


def flat_parts(pattern: FoldedPattern, folded: np.ndarray, step: FoldingStep) -> int:
    """Return how many sets of some of a step's creases every vertex allows to lie flat without the others."""
    sheet = SheetData(pattern)
    target = folded.copy()
    target[step.edges] = True
    solver = Cadical153()
    last = len(target)
    for edge in range(len(target)):
        if not target[edge] or folded[edge]:
            solver.add_clause([edge + 1 if folded[edge] else -(edge + 1)])
    for edges, subsets in CreaseSets(sheet, folded, target).at:
        chosen = []
        for subset in subsets:
            last += 1
            chosen.append(last)
            for edge, on in zip(edges.tolist(), subset.tolist(), strict=True):
                solver.add_clause([-last, (edge + 1) if on else -(edge + 1)])
        solver.add_clause(chosen)
    free = [edge + 1 for edge in step.edges.tolist()]
    solver.add_clause(free)
    solver.add_clause([-edge for edge in free])
    count = 0
    while count < MOST_SETS and solver.solve():
        model = set(solver.get_model() or ())
        solver.add_clause([-edge if edge in model else edge for edge in free])
        count += 1
    return count


def main() -> int:
    """Print the table; return 1 if a state is wrong."""
    wrong = 0
    for name in sys.argv[1:] or sample_names(lines=True):
        pattern = fold(sample_path(name), symmetry="auto", next_level=False).folded_pattern
        state, folded = FoldedPaper(pattern).unfolded, np.zeros(len(pattern.creases.edges_vertices), dtype=np.bool_)
        told, folds, sound = [], 0, True
        for step in folding_steps(pattern):
            if step.line is None:
                told.append(f"{len(step.edges)} creases: {on_the_way(pattern, state, folded, step)}, ")
                told[-1] += f"{flat_parts(pattern, folded, step)} parts that may lie flat"
            folds += step.line is not None
            folded = folded.copy()
            folded[step.edges] = True
            state = step.state
            sound &= is_sound(pattern, state, folded)
        wrong += not sound
        print(f"{name:<15} {folds} folds, {'all states sound' if sound else 'NOT SOUND'}", *told, sep="; ", flush=True)
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main())
