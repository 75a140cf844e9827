"""Paper folded through all its layers, line by line: flat-folded states that are right by construction."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from foldcut.core.arrays import Floats, Ints, Ragged, index_array, points_array
from foldcut.core.model import CreasePattern, Shape

Point = tuple[float, float]


@dataclass(frozen=True, eq=False)
class Layer:
    """One layer: its outline on the sheet, and the map ``x -> turn @ x + shift`` to where it lies."""

    outline: Floats
    turn: Floats
    shift: Floats

    @property
    def folded(self) -> Floats:
        return self.outline @ self.turn.T + self.shift

    @property
    def is_up(self) -> bool:
        return float(np.linalg.det(self.turn)) > 0


class Paper:
    """A convex sheet, and its layers from bottom to top."""

    def __init__(self, corners: Sequence[Point]) -> None:
        self.layers = [Layer(np.array(corners, dtype=float), np.eye(2), np.zeros(2))]

    def fold(self, through: Point, direction: Point, *, over: bool = True) -> Paper:
        """Fold what lies right of a line over (or under) what lies left of it."""
        kept, moved = self._divide(through, direction)
        along = np.array(direction) / np.hypot(*direction)
        mirror = 2 * np.outer(along, along) - np.eye(2)
        offset = np.array(through) - mirror @ through
        turned = [Layer(x.outline, mirror @ x.turn, mirror @ x.shift + offset) for x in moved if x][::-1]
        stay = [layer for layer in kept if layer]
        self.layers = stay + turned if over else turned + stay
        return self

    def divide(self, through: Point, direction: Point) -> Paper:
        """Draw a line through all layers without folding it."""
        kept, moved = self._divide(through, direction)
        self.layers = [layer for pair in zip(kept, moved, strict=True) for layer in pair if layer]
        return self

    def _divide(self, through: Point, direction: Point) -> tuple[list[Layer | None], list[Layer | None]]:
        left: list[Layer | None] = []
        right: list[Layer | None] = []
        for layer in self.layers:
            x, y = (layer.folded - through).T
            side = (direction[0] * y - direction[1] * x) / np.hypot(*direction)
            side[np.abs(side) < 1e-9] = 0
            left.append(_part(layer, side))
            right.append(_part(layer, -side))
        return left, right

    def pattern(self, order: Sequence[int] | None = None) -> tuple[CreasePattern, Ints]:
        """Return the crease pattern, its faces numbered by ``order`` (of layers), and the layer order."""
        layers = self.layers
        order = range(len(layers)) if order is None else order
        places: dict[Point, int] = {}
        coords: list[Floats] = []

        def vertex(point: Floats) -> int:
            key = (round(point[0], 6) + 0.0, round(point[1], 6) + 0.0)
            if key not in places:
                places[key] = len(coords)
                coords.append(point)
            return places[key]

        faces = [[vertex(point) for point in layers[at].outline] for at in order]
        rank = list(order)
        owner = {side: face for face, ring in enumerate(faces) for side in zip(ring, ring[1:] + ring[:1], strict=True)}
        edges, letters = [], []
        for (tail, head), face in owner.items():
            other = owner.get((head, tail))
            if other is None:
                edges.append((tail, head))
                letters.append("B")
            elif tail < head:
                edges.append((tail, head))
                letters.append(_assignment(layers, rank[face], rank[other]))
        bottom_up = np.argsort(rank)
        if not layers[rank[0]].is_up:
            bottom_up = bottom_up[::-1]
        pattern = CreasePattern(points_array(coords), index_array(edges), np.array(letters), Ragged.from_rows(faces))
        return pattern, index_array(bottom_up)


def square_paper(size: float = 100.0) -> Paper:
    return Paper([(0, 0), (size, 0), (size, size), (0, size)])


def rectangle_fold(width: float, height: float, sheet: float = 100.0) -> tuple[Paper, Shape]:
    """Return paper folded so that a cut at its only crossing line cuts out a rectangle in its middle.

    Quarter the sheet, then fold along the bisector of the rectangle's corner.
    """
    middle = sheet / 2
    paper = square_paper(sheet).fold((middle, 0), (0, -1)).fold((0, middle), (1, 0))
    x, y = middle + width / 2, middle + height / 2
    paper.fold((x, y), (1, 1))
    return paper, box_shape((sheet - x, sheet - y, x, y))


def box_shape(*boxes: tuple[float, float, float, float], parent: Iterable[int] | None = None) -> Shape:
    """Return the shape of boxes (x0, y0, x1, y1)."""
    loops = tuple(points_array([(a, b), (c, b), (c, d), (a, d)]) for a, b, c, d in boxes)
    return Shape(loops, tuple(parent) if parent is not None else (-1,) * len(boxes))


def random_paper(rng: np.random.Generator, folds: int, lines: int = 0) -> Paper:
    """Return a square of side 1 folded at random, with lines that are not folded in between."""
    paper = square_paper(1.0)
    kinds = rng.permutation([True] * folds + [False] * lines)
    for is_fold in kinds:
        folded = np.concatenate([layer.folded for layer in paper.layers])
        low, high = folded.min(axis=0), folded.max(axis=0)
        through = tuple(low + (high - low) * rng.uniform(0.3, 0.7, 2))
        # Right angles and repeated directions make creases that coincide.
        angle = rng.choice([0, 0.25, 0.5, 0.75, rng.uniform(0, 1)]) * np.pi
        direction = (float(np.cos(angle)), float(np.sin(angle)))
        if is_fold:
            paper.fold(through, direction, over=bool(rng.integers(2)))
        else:
            paper.divide(through, direction)
    return paper


def _part(layer: Layer, side: Floats) -> Layer | None:
    """Return the part of the layer where ``side``, given at its corners, is not negative."""
    if side.max() <= 0:
        return None
    if side.min() >= 0:
        return layer
    points = []
    for here, there, a, b in zip(
        layer.outline, np.roll(layer.outline, -1, axis=0), side, np.roll(side, -1), strict=True
    ):
        if a >= 0:
            points.append(here)
        if a * b < 0:
            points.append((here * b - there * a) / (b - a))
    return Layer(np.array(points), layer.turn, layer.shift)


def _assignment(layers: list[Layer], one: int, other: int) -> str:
    if layers[one].is_up == layers[other].is_up:
        return "F"
    upper, lower = (one, other) if layers[one].is_up else (other, one)
    return "V" if lower > upper else "M"
