"""Random shapes with several mirror axes through one point: stars, snowflakes with branches, rosettes with holes."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from foldcut.core.arrays import Floats
from support.strategies import Points

COUNTS = (3, 4, 5, 6, 8, 12)
"""The numbers of axes."""


@dataclass(frozen=True)
class DihedralShape:
    """A shape: its ``kind``, its axes, its loops, and how many of its corners lie in one sector or on its borders."""

    kind: str
    axes: int
    seed: int
    loops: tuple[Points, ...]
    sector_corners: int

    @property
    def name(self) -> str:
        """The shape in words."""
        return f"{self.kind} with {self.axes} axes, seed {self.seed}"


def dihedral_shapes(seeds: range) -> list[DihedralShape]:
    """Return shapes of all kinds in turn; each number of axes with each kind comes up soon."""
    kinds = list(KINDS)
    return [dihedral_shape(kinds[seed % len(kinds)], COUNTS[seed // len(kinds) % len(COUNTS)], seed) for seed in seeds]


def dihedral_shape(kind: str, axes: int, seed: int) -> DihedralShape:
    """Return the shape of a kind with so many axes: the same for the same seed."""
    chains = KINDS[kind](axes, np.random.default_rng(seed))
    loops = tuple(_around(chain, axes) for chain in chains)
    return DihedralShape(kind, axes, seed, loops, sum(map(len, chains)))


def _around(chain: Floats, axes: int) -> Points:
    """Return a loop from what lies of it in a sector, ``(n, 2)``: radii, and angles as parts of the sector's angle."""
    step = math.pi / axes
    corners: list[tuple[float, float]] = []
    for sector in range(2 * axes):
        part = chain if sector % 2 == 0 else [(radius, 1 - share) for radius, share in chain[::-1]]
        corners += [(float(radius), (sector + float(share)) * step) for radius, share in part]
    kept = [one for k, one in enumerate(corners) if k == 0 or not _same(one, corners[k - 1])]
    if _same(kept[-1], kept[0]):
        kept.pop()
    return [(radius * math.cos(angle), radius * math.sin(angle)) for radius, angle in kept]


def _same(one: tuple[float, float], other: tuple[float, float]) -> bool:
    return one[0] == other[0] and abs(math.remainder(one[1] - other[1], math.tau)) < 1e-9


def _star(axes: int, random: np.random.Generator) -> list[Floats]:
    """A tip and a notch, on the borders of the sector, and perhaps a corner between them."""
    tip, notch = 1.0, random.uniform(0.35, 0.75) * math.cos(math.pi / axes)
    chain = [(tip, 0.0), (notch, 1.0)]
    if random.random() < 0.5:
        middle = (tip + notch) / 2 * random.uniform(0.8, 0.95)
        chain.insert(1, (middle, random.uniform(0.35, 0.65)))
    return [np.array(chain)]


def _snowflake(axes: int, random: np.random.Generator) -> list[Floats]:
    """An arm along the first border with a branch or two; half of it, since the border is in its middle."""
    step = math.pi / axes
    half = random.uniform(0.25, 0.45) * math.tan(step) * 0.35
    points = [(1.0, 0.0), (1.0, half)]
    places = np.sort(random.uniform(0.5, 0.85, int(random.integers(1, 3))))[::-1]
    if len(places) == 2 and places[0] - places[1] < 0.2:
        places = places[:1]
    for place in places:
        slope, width = random.uniform(math.radians(45), math.radians(75)), random.uniform(0.05, 0.09)
        reach = min(0.35, 0.8 * place * math.tan(step) / math.sin(slope)) * random.uniform(0.4, 0.7)
        along, across = np.array([math.cos(slope), math.sin(slope)]), np.array([-math.sin(slope), math.cos(slope)])
        root = np.array([place, half])
        out = root + reach * along
        points += [tuple(root), tuple(out), tuple(out + width * across)]
        # back to the arm's side, along the branch
        back = out + width * across
        points.append((float(back[0] - (back[1] - half) / math.tan(slope)), half))
    points.append((half / math.tan(step), half))
    return [_polar(np.array(points), step)]


def _rosette(axes: int, random: np.random.Generator) -> list[Floats]:
    """Petals, a hole around the centre, and perhaps a hole in each petal."""
    tip, notch = 1.0, random.uniform(0.6, 0.8) * math.cos(math.pi / axes)
    outer = np.array([(tip, 0.0), (random.uniform(0.88, 0.95), random.uniform(0.35, 0.6)), (notch, 1.0)])
    inner = random.uniform(0.2, 0.35)
    hole = np.array([(inner, 0.0), (inner * random.uniform(0.7, 0.9) * math.cos(math.pi / axes), 1.0)])
    return [outer, hole]


def _polar(points: Floats, step: float) -> Floats:
    return np.column_stack([np.hypot(*points.T), np.arctan2(points[:, 1], points[:, 0]) / step])


KINDS: dict[str, Callable[[int, np.random.Generator], list[Floats]]] = {
    "star": _star,
    "snowflake": _snowflake,
    "rosette": _rosette,
}
"""The kinds, and what makes the chains of one in a sector."""
