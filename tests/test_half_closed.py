"""Sheets that have begun to close: they keep their lengths, nothing crosses, and creases bend their own way."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.folded import folded_sample
from support.patterns import book_fold

from foldcut.core.arrays import Floats, points_array
from foldcut.folding_steps.half_closed import MOST_STRAIN_MM, HalfClosed, _go_through, _Net, half_closed


def check(flat: Floats, sheet: HalfClosed) -> None:
    """Check lengths and crossings without the code that made the sheet."""
    corners = sheet.points[sheet.triangles]
    for k in range(3):
        one, other = sheet.triangles[:, k], sheet.triangles[:, (k + 1) % 3]
        before = np.hypot(*(flat[one] - flat[other]).T)
        after = np.linalg.norm(sheet.points[one] - sheet.points[other], axis=1)
        assert np.abs(after - before).max() <= sheet.strain_mm + 1e-12 <= MOST_STRAIN_MM
    for number, triangle in enumerate(corners):
        for k in range(3):
            start, end = triangle[k], triangle[(k + 1) % 3]
            for other, (a, b, c) in enumerate(corners):
                if set(sheet.triangles[number].tolist()) & set(sheet.triangles[other].tolist()):
                    continue
                matrix = np.column_stack([b - a, c - a, start - end])
                if abs(np.linalg.det(matrix)) > 1e-9:  # u, v in the triangle and t along the segment
                    u, v, t = np.linalg.solve(matrix, start - a)
                    assert not (min(u, v, t) > 0 and u + v < 1 and t < 1)


@pytest.mark.parametrize("name", ["bolt", "letter-l"])
def test_a_sheet_keeps_its_lengths_does_not_cross_itself_and_most_creases_have_begun(name: str) -> None:
    creases = folded_sample(name).creases
    found = half_closed(creases)
    assert found is not None
    check(creases.vertices_coords, found)
    net = _Net(creases)
    turned = (net._angles(found.points)[0] * net.way)[net.way != 0]
    assert np.median(turned) > np.radians(15)
    assert (turned < -0.05).mean() < 0.1
    again = half_closed(creases)
    assert again is not None
    assert (again.points == found.points).all()


def test_a_book_opens_towards_its_valley_and_a_mountain_the_other_way() -> None:
    book = book_fold().creases
    swapped = np.where(book.edges_assignment == "V", "M", book.edges_assignment)
    for creases, way in ((book, 1), (replace(book, edges_assignment=swapped), -1)):
        found = half_closed(creases)
        assert found is not None
        crease = creases.edges_vertices[np.isin(creases.edges_assignment, ("M", "V"))][0]
        others = np.setdiff1d(np.arange(len(found.points)), crease)
        assert way * (found.points[others, 2].mean() - found.points[crease, 2].mean()) > 5


def test_slopes_are_those_of_the_angles() -> None:
    net = _Net(folded_sample("letter-l").creases)
    random = np.random.default_rng(1)
    points = np.column_stack([net.flat, np.zeros(len(net.flat))]) + random.normal(size=(len(net.flat), 3))
    way = random.normal(size=points.shape)
    angles, slopes = net._angles(points)
    expected = sum((slope * way[net.hinges[:, k]]).sum(axis=1) for k, slope in enumerate(slopes))
    np.testing.assert_allclose((net._angles(points + 1e-7 * way)[0] - angles) / 1e-7, expected, atol=1e-4)


def test_what_crosses_or_stretches_is_seen_and_not_returned(monkeypatch: pytest.MonkeyPatch) -> None:
    triangle = np.array([(0.0, 0, 0), (3, 0, 0), (0, 3, 0)])
    start = np.array([(1.0, 1, 1), (3, 3, 1), (1, 1, 2)])
    end = np.array([(1.0, 1, -1), (3, 3, -1), (1, 1, 1)])
    assert _go_through(start, end, triangle).tolist() == [True, False, False]
    creases = folded_sample("letter-l").creases
    monkeypatch.setattr(_Net, "crosses", lambda *_: True)
    assert half_closed(creases) is None
    monkeypatch.undo()
    monkeypatch.setattr(_Net, "strain", lambda *_: 2 * MOST_STRAIN_MM)
    assert half_closed(creases) is None


def test_a_face_without_an_area_gives_no_picture_and_no_warning() -> None:
    book = book_fold().creases
    coords = np.array(book.vertices_coords)
    coords[:, 1] = 0
    assert half_closed(replace(book, vertices_coords=points_array(coords))) is None
