"""The arrays of every stage: points are ``(n, 2)`` float64, indices int32, -1 means none; ragged lists have offsets."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]


Ints = NDArray[np.int32]


Numbers = NDArray[np.signedinteger[Any]]


Bools = NDArray[np.bool_]


Chars = NDArray[np.str_]


Bytes = NDArray[np.int8]


Scalar = TypeVar("Scalar", bound=np.generic)


# So many rows are done at a time where results are large and what leads to them is larger.
BLOCK = 1 << 13


def points_array(points: ArrayLike) -> Floats:
    """Return ``points`` as a read-only ``(n, 2)`` float64 array of its own."""
    array = np.array(points, dtype=np.float64)
    array.setflags(write=False)
    return array.reshape(-1, 2)


def sealed(array: NDArray[Scalar]) -> NDArray[Scalar]:
    """Return the very same array, read-only from now on: for an array that nobody else has."""
    array.setflags(write=False)
    return array


def index_array(indices: ArrayLike) -> Ints:
    """Return ``indices`` as a read-only int32 array of its own."""
    array = np.array(indices, dtype=np.int32)
    array.setflags(write=False)
    return array


@dataclass(frozen=True, eq=False)
class Ragged:
    """A list of integer lists of different lengths, as values and offsets.

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
        """Return plain Python lists, for loops and for JSON."""
        flat = self.values.tolist()
        ends = self.offsets.tolist()
        return [flat[start:end] for start, end in pairwise(ends)]

    def take(self, rows: Numbers) -> Ragged:
        """Return these rows, ``(k,)``, in this order."""
        offsets = np.zeros(len(rows) + 1, dtype=np.int32)
        np.cumsum(self.lengths[rows], out=offsets[1:])
        values = np.empty(offsets[-1], dtype=np.int32)
        for low in range(0, len(rows), BLOCK):
            ends = offsets[low : low + BLOCK + 1]
            back = self.offsets[:-1][rows[low : low + BLOCK]] - ends[:-1]
            places = np.arange(ends[0], ends[-1]) + np.repeat(back, np.diff(ends))
            values[ends[0] : ends[-1]] = self.values[places]
        return Ragged(sealed(values), sealed(offsets))

    @property
    def lengths(self) -> Ints:
        """The length of every row, ``(n,)``."""
        return np.diff(self.offsets)

    @property
    def following(self) -> Numbers:
        """For every value the place of the next one in its row, after the last the first, ``(m,)``; no row is empty."""
        following = np.arange(1, len(self.values) + 1)
        following[self.offsets[1:] - 1] = self.offsets[:-1]
        return following

    @property
    def rows(self) -> Ints:
        """The row number of every value, ``(m,)``."""
        return np.repeat(np.arange(len(self), dtype=np.int32), self.lengths)
