"""The search for the compact pattern with the fewest creases.

Loop on the sheet -> the best verified ``Compact`` pattern.

First the layout: corners are added on sides until all can keep the clearance (most shapes need none). Then reaches are
tried one linear program after the other: feet where the skeleton's nodes stand over the sides, for many choices of the
root, of the nodes, and of weights; each answer is folded, counted and, if it is the best so far, verified. The number
of creases comes first; a pattern with a crease that nobody can fold is taken only if there is no other.

Deterministic unless a time is given: the number of trials depends on the effort and the number of corners alone.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import count as count_up

import numpy as np

from foldcut.compact import Chain, Molecules, build_molecules, fold_molecules, molecule_faults
from foldcut.errors import UnfoldableError
from foldcut.model import Bools, CreasePattern, Floats, FoldedState, Shape, Sheet
from foldcut.reaches import Layout, Program, Solution
from foldcut.skeleton import Node, side_nodes
from foldcut.verify import verify

EFFORTS = {"fast": 0.7, "normal": 6.0, "best": 60.0}
"""Seconds that an effort is meant to take, by the model of ``_trial_seconds``."""

CLEARANCES = (0.02, 0.01, 0.004, 0.0015)
"""How much nearer than their distance two corners' ways must be, relative; they are tried in turn."""

FOLDABLE_MM, SHORTEST_MM = 3.0, 0.5
MOST_DISKS = 1500
IN_VAIN_COST = 0.3  # of a trial, for a program without a solution
IN_VAIN = 120  # programs without a solution, before corners are added


@dataclass(frozen=True, eq=False)
class Compact:
    """What the search found: the pattern, its chain and molecules, and how many trials it took."""

    creases: CreasePattern
    folded: FoldedState
    chain: Chain
    molecules: Molecules
    tried: int
    interrupted: bool


@dataclass(frozen=True, eq=False)
class _Found:
    key: tuple[bool, float, float]
    creases: CreasePattern
    folded: FoldedState
    chain: Chain
    molecules: Molecules


def fold_compact(
    loop: Floats,
    sheet: Sheet,
    *,
    ribbon: float = 0.0,
    effort: str = "normal",
    seconds: float | None = None,
    progress: Callable[[str, float], None] | None = None,
) -> Compact:
    """Return the verified pattern with the fewest creases that the search finds.

    ``loop`` ``(n, 2)`` is the shape's boundary on the sheet in mm, counter-clockwise; ``ribbon`` a half-width in mm
    that has to stay free of all but straight creases; ``effort`` one of ``EFFORTS``; ``seconds`` a time limit instead.
    ``progress`` is called with a text and the part done. Ctrl-C ends the search with the best pattern so far.
    Raises ``UnfoldableError`` when no pattern is found.
    """
    shape = Shape((loop,), (-1,))
    best: _Found | None = None
    tried = 0
    interrupted = False
    started = time.monotonic()
    budget = EFFORTS[effort] / _trial_seconds(len(loop))
    try:
        for source in (_plain_solutions, _crowded_solutions):
            spent = 0.0
            for solution in source(loop):
                tried += 1
                spent += 1.0 if solution is not None else IN_VAIN_COST
                found = _fold(solution, shape, sheet, ribbon, best) if solution is not None else None
                best = found or best
                elapsed = time.monotonic() - started
                part = elapsed / seconds if seconds is not None else spent / budget
                if seconds is None and elapsed > 8 * EFFORTS[effort]:
                    part = 1.0  # a slow machine must not keep anybody waiting
                if progress is not None:
                    count = f"{best.creases.crease_count} creases" if best else "no pattern yet"
                    progress(f"searching: {count}", min(0.99, part))
                if part >= 1:
                    break
            if best is not None:
                break
    except KeyboardInterrupt:
        if best is None:
            raise
        interrupted = True
    if best is None:
        x, y = loop.mean(axis=0)
        raise UnfoldableError(
            f"no compact pattern was found in {tried} trials for the shape around ({x:.1f}, {y:.1f}) mm; "
            "try a higher effort, --simplify, or the paper's method"
        )
    return Compact(best.creases, best.folded, best.chain, best.molecules, tried, interrupted)


def _trial_seconds(corners: int) -> float:
    """A model of what one trial takes, so that effort means the same number of trials on every machine."""
    return 0.012 + 0.0008 * corners + 0.00002 * corners**2


def _fold(solution: Solution, shape: Shape, sheet: Sheet, ribbon: float, best: _Found | None) -> _Found | None:
    """Fold one solution and return it if it is better than the best so far, and verified."""
    chain = solution.chain()
    try:
        molecules = build_molecules(chain, sheet)
        if min(molecules.inside.lowest_event, molecules.outside.lowest_event) <= ribbon or molecule_faults(molecules):
            return None
        creases, folded = fold_molecules(molecules, sheet)
    except (UnfoldableError, AssertionError, KeyError, StopIteration):
        return None
    key = _rank(creases)
    if best is not None and key >= best.key:
        return None
    if verify(creases, folded.layers, shape):
        return None
    return _Found(key, creases, folded, chain, molecules)


def _rank(creases: CreasePattern) -> tuple[bool, float, float]:
    """Patterns in order: those with all creases long enough to fold at all, then fewer creases, then longer ones."""
    ends = creases.vertices_coords[creases.edges_vertices[creases.edges_assignment != "B"]]
    shortest = float(np.hypot(*(ends[:, 1] - ends[:, 0]).T).min())
    count = creases.crease_count * (1.0 if shortest >= FOLDABLE_MM else 1.15)
    return shortest < SHORTEST_MM, count, -shortest


def _plain_solutions(loop: Floats) -> Iterator[Solution | None]:
    """Yield solutions without added corners, promising ones first; None for each program that has none."""
    yield from _star_like(loop)
    rng = np.random.default_rng(len(loop))
    inside, outside = side_nodes(loop), side_nodes(loop, outside=True)
    heights = np.zeros(len(loop))
    for node in inside:
        heights[node.side] = max(heights[node.side], node.height)
    roots = np.argsort(-heights, kind="stable").tolist()
    layout = Layout.build(loop, [0] * len(loop))
    pockets = np.flatnonzero(_reflex(loop)).tolist()
    count = len(loop)
    possible = False
    for number in count_up():
        if number > IN_VAIN and not possible:
            return
        root = roots[0] if number % 3 == 0 else int(rng.choice(roots))
        second = roots[1 + number % (count - 1)]
        valleys: set[int] = set()
        if number % 2:
            # the root may also be a corner, the lowest valley of all
            root, second = (second - 1) % count, second
            valleys.add(second)
        elif root == second:
            continue
        # all pockets as valleys, none, or some of them; never two in a row nor one beside a foot that is the root
        share = (1.0, 0.0, 0.5)[number // 2 % 3] if number < 18 else float(rng.choice([0.0, 0.3, 0.7, 1.0]))
        for corner in pockets:
            ends = {(corner - 1) % count, (corner + 1) % count}
            beside_root = not number % 2 and root in (corner, (corner - 1) % count)
            if rng.random() < share and not ends & valleys and not beside_root:
                valleys.add(corner)
        clearance = CLEARANCES[(number // 3) % len(CLEARANCES)]
        wish = _wishes(layout, inside, outside, rng, plain=number < 12)
        for valley in valleys:
            wish[[valley - 1, valley]] = np.nan
        weight = np.ones(count) if number < 12 else rng.uniform(0.2, 1.8, count)
        program = Program(layout, root, second, clearance=clearance, valleys=frozenset(valleys))
        solution = program.solve(wish, weight)
        possible = possible or solution is not None
        yield solution


def _crowded_solutions(loop: Floats) -> Iterator[Solution | None]:
    """Yield solutions with corners added on the sides: first many, then fewer."""
    rng = np.random.default_rng(len(loop))
    inside, outside = side_nodes(loop), side_nodes(loop, outside=True)
    clearance = CLEARANCES[0]
    for shrunk in (0.0, 0.01, 0.03, 0.06):
        # the exact ties of symmetric shapes are where a molecule may not close; a little noise undoes them
        yield crowded_chain(loop, clearance, shrink=shrunk * rng.random(len(loop)))
    start = crowded_chain(loop, clearance)
    for fewer in _fewer_corners(start, clearance):
        start = fewer or start
        yield fewer
    layout, root = start.layout, start.root
    lowest = [int(k) for k in np.flatnonzero(start.depth <= 1e-9) if k != root]
    for number in count_up():
        wish = _wishes(layout, inside, outside, rng, plain=number == 0)
        weight = rng.uniform(0.2, 1.8, len(layout))
        second = lowest[number % len(lowest)]
        yield Program(layout, root, second, clearance=clearance).solve(wish, weight, start)


def _reflex(loop: Floats) -> Bools:
    before, after = loop - np.roll(loop, 1, axis=0), np.roll(loop, -1, axis=0) - loop
    reflex: Bools = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0] < 0
    return reflex


def _star_like(loop: Floats) -> Iterator[Solution]:
    """Try all reflex corners as valleys: a star then folds like a fan, through its middle."""
    reflex = _reflex(loop)
    if not reflex.any() or (reflex & np.roll(reflex, 1)).any():
        return
    layout = Layout.build(loop, [0] * len(loop))
    valleys = frozenset(np.flatnonzero(reflex).tolist())
    for root in sorted(valleys):
        program = Program(layout, (root - 1) % len(loop), root, clearance=0.0, valleys=valleys, free=True)
        solution = program.solve(np.full(len(loop), np.nan))
        if solution is not None:
            yield solution
            return


def crowded_chain(loop: Floats, clearance: float, shrink: Floats | float = 0.0) -> Solution:
    """Cover the boundary with disks that keep apart, all on one hub: always a solution, and many corners.

    Vertex disks take nearly half the way to the nearest other side; stretches between them are halved until no two
    disks come near each other; ``shrink`` makes vertex disks smaller by these parts. Source: paper section 2.
    """
    count = len(loop)
    along = np.roll(loop, -1, axis=0) - loop
    length = np.hypot(*along.T)
    direction = along / length[:, None]
    to_corner = loop[:, None] - loop[None]
    part = np.clip(np.sum(to_corner * direction[None], axis=2), 0, length[None])
    away = np.hypot(*np.moveaxis(to_corner - part[:, :, None] * direction[None], 2, 0))
    row = np.arange(count)
    away[row, row] = away[row, row - 1] = np.inf
    radius = (1 - shrink) * (0.5 - clearance) * np.minimum(away.min(axis=1), np.minimum(length, np.roll(length, 1)))
    stretches = [[(float(radius[s]), float(length[s] - radius[(s + 1) % count]))] for s in range(count)]
    while True:
        side = np.array([s for s, pieces in enumerate(stretches) for _ in pieces])
        ends = np.array([piece for pieces in stretches for piece in pieces])
        middle = loop[side] + direction[side] * ends.mean(axis=1)[:, None]
        half = (ends[:, 1] - ends[:, 0]) / 2
        centres, radii = np.concatenate([middle, loop]), np.concatenate([half, radius])
        owner = np.concatenate([side, -1 - row])
        apart = centres[:, None] - centres[None]
        near = np.hypot(apart[:, :, 0], apart[:, :, 1]) * (1 - 2 * clearance) < radii[:, None] + radii[None]
        same = owner[:, None] == owner[None]
        for s in range(count):
            here = np.flatnonzero((owner == s) | (owner == -1 - s) | (owner == -1 - (s + 1) % count))
            same[np.ix_(here, here)] = True
        larger = (radii[:, None] >= radii[None] * (1 - 1e-9)) | (owner[None] < 0)
        crowded = (near & ~same & larger).any(axis=1)[: len(side)]
        if not crowded.any():
            break
        if len(side) > MOST_DISKS:
            x, y = loop[side[int(half.argmin())]]
            raise UnfoldableError(
                f"a feature near ({x:.2f}, {y:.2f}) mm is so fine that over {MOST_DISKS} disks would be needed; "
                "simplify the drawing there"
            )
        flags = iter(crowded.tolist())
        stretches = [
            [half for a, b in pieces for half in ([(a, (a + b) / 2), ((a + b) / 2, b)] if next(flags) else [(a, b)])]
            for pieces in stretches
        ]
    layout = Layout.build(loop, [len(pieces) for pieces in stretches])
    reach = [r for s in range(count) for r in (float(radius[s]), *((b - a) / 2 for a, b in stretches[s]))]
    return Solution(layout, np.array(reach), np.zeros(len(reach)), clearance, len(reach) - 1, frozenset())


def _fewer_corners(start: Solution, clearance: float) -> Iterator[Solution | None]:
    """Take added corners away one by one as long as the clearance can be kept; yield each smaller solution."""
    best = start
    failed: set[tuple[int, int]] = set()  # side, how many corners it had
    while True:
        layout = best.layout
        length = best.reach + np.roll(best.reach, -1) - 2 * best.depth
        flap = 2 * best.reach - best.depth - np.roll(best.depth, 1)
        choices = [
            corner
            for corner in np.argsort(flap / length.max(), kind="stable").tolist()
            if layout.place[corner] and (int(layout.side[corner]), layout.added[layout.side[corner]]) not in failed
        ]
        if not choices:
            return
        corner = choices[0]
        lowest = [
            k for k in np.flatnonzero(best.depth <= 1e-9 * float(np.ptp(layout.loop))) if k not in (corner - 1, corner)
        ]
        fewer = None
        if len(lowest) > 1:
            for first, second in ((lowest[-1], lowest[0]), (lowest[len(lowest) // 2], lowest[0])):
                if first != second:
                    fewer = Program(layout, int(first), int(second), clearance=clearance).without(best, corner)
                if fewer is not None:
                    break
        if fewer is None:
            failed.add((int(layout.side[corner]), layout.added[layout.side[corner]]))
        else:
            best = fewer
        yield fewer


def _wishes(
    layout: Layout, inside: list[Node], outside: list[Node], rng: np.random.Generator, *, plain: bool
) -> Floats:
    """For each side one of the nodes over it, or none: how far along the foot on it should be."""
    wish = np.full(len(layout), np.nan)
    following = np.roll(layout.loop, -1, axis=0) - layout.loop
    length = np.hypot(*following.T)
    for corner in np.flatnonzero(layout.place == 0):
        side = int(layout.side[corner])
        if layout.added[side]:
            continue
        nodes = [n for n in (*inside, *outside) if n.side == side and 0 < n.along < length[side]]
        if nodes:
            wish[corner] = (nodes[0] if plain else nodes[int(rng.integers(len(nodes)))]).along
    return wish
