"""The arrays that all stages use: their types, functions that make them read-only, and ``Ragged`` lists of lists.

Points are ``(n, 2)`` float64. Indices are int32, and -1 means none. Arrays that pass between stages are read-only.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
"""Coordinates and other measures."""

Ints = NDArray[np.int32]
"""Indices as they pass between stages."""

Indices = NDArray[np.intp]
"""Indices as numpy's own functions return them."""

Numbers = NDArray[np.signedinteger[Any]]
"""Integers of any width."""

Bools = NDArray[np.bool_]
"""Masks: which elements are meant."""

Chars = NDArray[np.str_]
"""Letters, such as the assignments of edges."""

Bytes = NDArray[np.int8]
"""Small integers, one byte each."""

Scalar = TypeVar("Scalar", bound=np.generic)

BLOCK = 1 << 13
"""The number of rows handled at a time where the arrays on the way to a result need more memory than the result."""


def blocks(count: int, size: int = BLOCK) -> Iterator[slice]:
    """Yield slices that divide ``count`` rows into blocks of ``size``; the last one may reach past the end."""
    for first in range(0, count, size):
        yield slice(first, first + size)


def points_array(points: ArrayLike) -> Floats:
    """Return a read-only copy of ``points``, ``(n, 2)`` float64."""
    array = np.array(points, dtype=np.float64)
    array.setflags(write=False)
    return array.reshape(-1, 2)


def sealed(array: NDArray[Scalar]) -> NDArray[Scalar]:
    """Make an array that nothing else refers to read-only, and return it; nothing is copied."""
    array.setflags(write=False)
    return array


def index_array(indices: ArrayLike) -> Ints:
    """Return a read-only copy of ``indices``, int32."""
    array = np.array(indices, dtype=np.int32)
    array.setflags(write=False)
    return array


@dataclass(frozen=True, eq=False)
class Ragged:
    """A list of lists of integers, of different lengths, stored as values and offsets.

    ``values`` is ``(m,)`` int32, ``offsets`` ``(n + 1,)`` int32; row i is ``values[offsets[i]:offsets[i + 1]]``.
    """

    values: Ints
    offsets: Ints

    @classmethod
    def from_rows(cls, rows: Iterable[Iterable[int]]) -> Ragged:
        """Build from any iterable of iterables of integers."""
        lists = [list(row) for row in rows]
        offsets = np.zeros(len(lists) + 1, dtype=np.int32)
        np.cumsum([len(row) for row in lists], out=offsets[1:])
        flat = [value for row in lists for value in row]
        return cls(index_array(flat), index_array(offsets))

    def __len__(self) -> int:
        return len(self.offsets) - 1

    def __getitem__(self, row: int) -> Ints:
        if not 0 <= row < len(self):
            raise IndexError(row)
        return self.values[self.offsets[row] : self.offsets[row + 1]]

    def __iter__(self) -> Iterator[Ints]:
        for start, end in pairwise(self.offsets):
            yield self.values[start:end]

    def to_lists(self) -> list[list[int]]:
        """Return plain Python lists."""
        flat = self.values.tolist()
        ends = self.offsets.tolist()
        return [flat[start:end] for start, end in pairwise(ends)]

    def take(self, rows: Numbers) -> Ragged:
        """Return these rows, ``(k,)``, in this order."""
        offsets = np.zeros(len(rows) + 1, dtype=np.int32)
        np.cumsum(self.lengths[rows], out=offsets[1:])
        values = np.empty(offsets[-1], dtype=np.int32)
        for some in blocks(len(rows)):
            ends = offsets[some.start : some.stop + 1]
            back = self.offsets[:-1][rows[some]] - ends[:-1]
            places = np.arange(ends[0], ends[-1]) + np.repeat(back, np.diff(ends))
            values[ends[0] : ends[-1]] = self.values[places]
        return Ragged(sealed(values), sealed(offsets))

    def alike(self, most: int = BLOCK) -> Iterator[tuple[Indices, Ints]]:
        """Yield the rows grouped by length, short ones first, at most ``most`` of them at a time.

        Each group is the row numbers, ``(k,)``, and the values, ``(length, k)``: one column for each row.
        """
        lengths = self.lengths
        for length in np.flatnonzero(np.bincount(lengths)).tolist():
            same = np.flatnonzero(lengths == length)
            for some in blocks(len(same), most):
                rows = same[some]
                yield rows, self.values[self.offsets[rows] + np.arange(length)[:, None]]

    @property
    def lengths(self) -> Ints:
        """The length of every row, ``(n,)``."""
        return np.diff(self.offsets)

    @property
    def following(self) -> Numbers:
        """For every value the place of the next one in its row, cyclically, ``(m,)``; no row may be empty."""
        following = np.arange(1, len(self.values) + 1)
        following[self.offsets[1:] - 1] = self.offsets[:-1]
        return following

    @property
    def rows(self) -> Ints:
        """The row number of every value, ``(m,)``."""
        return np.repeat(np.arange(len(self), dtype=np.int32), self.lengths)
