"""Gaps as lists of numbers: chains of disks that touch in a row, and how a chain is cut and joined.

A *gap* is a set of *chains*. A chain is a cyclic sequence of *visits* to disks, each of which touches the next, with
the gap on its left; it may visit a disk more than once. A *leaf* is a pair of consecutive visits, named by their disks.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from foldcut.core.arrays import Ints

__all__ = [
    "TURN",
    "Chain",
    "Leaf",
    "Places",
    "StuckError",
    "Visit",
    "angle_between",
    "arc",
    "flat",
    "leaves",
    "places_of_disk",
    "places_of_disks",
    "walk_from",
]

Chain = list[int]
"""The disks that a chain visits."""

Leaf = tuple[int, int]
"""The disks of two consecutive visits."""

Visit = tuple[int, int]
"""The number of a chain of the gap, and the position in it."""

Places = dict[int, list[Visit]]
"""The visits to each disk."""

TURN = 2 * math.pi
"""A full turn in radians."""


class StuckError(Exception):
    """No disk divides a gap: ``chains`` are the gap's, ``place`` is in its middle, in mm."""

    def __init__(self, chains: list[Chain], place: tuple[float, float]) -> None:
        super().__init__(chains, place)
        self.chains = chains
        self.place = place


def leaves(gap: list[Chain]) -> list[Leaf]:
    """Return the leaves of all chains; a chain of a single disk has none."""
    return [leaf for chain in gap if len(chain) > 1 for leaf in zip(chain, chain[1:] + chain[:1], strict=True)]


def places_of_disk(gap: list[Chain], disk: int) -> Iterator[Visit]:
    """Yield the visits to one disk."""
    for number, chain in enumerate(gap):
        position = -1
        for _ in range(chain.count(disk)):
            position = chain.index(disk, position + 1)
            yield number, position


def places_of_disks(gap: list[Chain]) -> Places:
    """Return the visits to every disk of a gap."""
    places: Places = {}
    for number, chain in enumerate(gap):
        for position, disk in enumerate(chain):
            places.setdefault(disk, []).append((number, position))
    return places


def walk_from(chain: Chain, position: int) -> Chain:
    """Return the chain once around, from a visit back to the same disk."""
    if len(chain) == 1:
        return chain
    return chain[position:] + chain[: position + 1]


def arc(chain: Chain, start: int, stop: int, *, whole: bool = False) -> Chain:
    """Return the visits from ``start`` to ``stop``, both included; ``whole``: once around from ``start``."""
    if whole:
        return walk_from(chain, start)
    return chain[start : stop + 1] if start <= stop else chain[start:] + chain[: stop + 1]


def flat(gaps: list[Chain]) -> tuple[Ints, Ints]:
    """Return gaps of one chain each as the disks of all, and how many disks each one has."""
    values = np.fromiter((disk for gap in gaps for disk in gap), dtype=np.int32)
    return values, np.fromiter(map(len, gaps), dtype=np.int32, count=len(gaps))


def angle_between(start: tuple[float, float], end: tuple[float, float]) -> float:
    """Return the counter-clockwise angle from one vector to another, in [0, 2 pi)."""
    across = start[0] * end[1] - start[1] * end[0]
    return math.atan2(across, start[0] * end[0] + start[1] * end[1]) % TURN
