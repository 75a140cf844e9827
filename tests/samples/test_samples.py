"""The samples: all are valid shapes of modest detail, and are found by name."""

from __future__ import annotations

import numpy as np
import pytest
from support.samples import GALLERY
from support.strategies import Points

from foldcut.core.errors import BadInputError
from foldcut.drawing.placement import parse_sheet, place
from foldcut.drawing.shape import invariant_faults, make_shape, minimum_feature
from foldcut.geometry.dihedral import dihedral
from foldcut.readers import read_shape
from foldcut.samples import sample_names, sample_path

NAMES = sample_names()
MIRRORED = {
    "triangle": 0, "square": 0, "hexagon": 0, "star": 0, "heart": 0, "letter-t": 0, "letter-a": 0, "ring": 0,
    "two-triangles": 0, "tree": 0, "plus": 0, "kite": 0, "arrow": 1,
    **{name: 0 for name in GALLERY if name != "whale"},
}  # fmt: skip
COMPONENTS = {"two-triangles": (-1, -1), "ring": (-1, 0), "letter-a": (-1, 0), "rosette": (-1, 0)}
AXES = {"snowflake": 6, "rosette": 8, "hexagon": 6, "star": 5, "square": 4, "plus": 4, "triangle": 3}


def test_there_are_at_least_eighteen_samples_in_alphabetical_order() -> None:
    assert len(NAMES) >= 18
    assert list(NAMES) == sorted(set(NAMES))
    assert {"fish", "marlin", "swan", "cat", "star", "letter-a", "two-triangles", "ring"} <= set(NAMES)


def test_the_samples_cover_every_format() -> None:
    assert {sample_path(name).suffix for name in NAMES} == {".svg", ".json", ".wkt"}


def test_an_unknown_sample_is_refused_with_the_known_ones() -> None:
    with pytest.raises(BadInputError, match=r"no sample 'shark'; give one of arrow, .*fish"):
        sample_path("shark")


@pytest.mark.parametrize("name", NAMES)
def test_a_sample_is_a_valid_shape_of_modest_detail(name: str) -> None:
    drawing = read_shape(sample_path(name))
    shape = make_shape(drawing.loops)
    assert invariant_faults(shape) == []
    assert shape.corner_count == sum(len(loop) - (loop[0] == loop[-1]).all() for loop in drawing.loops)
    many = name == "paper-chain" or AXES.get(name, 0) >= 6
    assert shape.corner_count <= (40 if many else 20)
    assert shape.parent == COMPONENTS.get(name, (-1,))
    size = np.ptp(np.concatenate(shape.loops), axis=0).max()
    assert minimum_feature(shape)[0] >= (0.04 if name in {"marlin", "paper-chain", "rosette"} else 0.06) * size
    assert drawing.notes == ()
    assert drawing.title
    assert drawing.unit_mm == (None if name == "kite" else 1.0)


@pytest.mark.parametrize("name", NAMES)
def test_a_sample_fits_a4_at_its_true_size(name: str) -> None:
    place(make_shape(read_shape(sample_path(name)).loops), parse_sheet("a4"), scale=1.0)


@pytest.mark.parametrize(("name", "axis"), MIRRORED.items())
def test_a_symmetric_sample_is_symmetric_to_the_last_digit(name: str, axis: int) -> None:
    corners = np.concatenate(make_shape(read_shape(sample_path(name)).loops).loops)
    mirrored = corners.copy()
    mirrored[:, axis] = corners[:, axis].min() + corners[:, axis].max() - corners[:, axis]

    def rows(points: np.ndarray) -> Points:
        return sorted((round(x, 9), round(y, 9)) for x, y in points.tolist())

    assert rows(mirrored) == rows(corners)


@pytest.mark.parametrize(("name", "count"), AXES.items())
def test_a_sample_has_so_many_axes_through_one_point(name: str, count: int) -> None:
    found = dihedral(make_shape(read_shape(sample_path(name)).loops))
    assert found is not None
    assert found.count == count
