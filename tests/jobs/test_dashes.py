"""Dashes: perforations and the notation's dashes fit their creases, and no crease is lost."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose
from support.patterns import letter_fold

from foldcut.jobs.dashes import Cuts, crease_pieces, mountain_pieces, perforation, perforations, valley_pieces
from foldcut.profiles import Dash, Treatment, load_profile

PLAIN = load_profile().drawing


@pytest.mark.parametrize("length", [0.3, 1.0, 2.0, 5.0, 7.3, 100.0])
def test_perforations_fit_their_crease(length: float) -> None:
    dash = Dash(dash_mm=1.0, gap_mm=0.5, clearance_mm=0.4)
    pieces = np.array(perforation(np.array([[0.0, 0.0], [length, 0.0]]), dash))[:, :, 0]
    assert len(pieces)
    assert pieces[0, 0] == pytest.approx(length - pieces[-1, 1])
    assert pieces[0, 0] >= min(0.4, length / 4) - 1e-9
    gaps = pieces[1:, 0] - pieces[:-1, 1]
    assert (gaps > 0.2).all()


@pytest.mark.parametrize("length", [0.01, 1.0, 2.9, 3.1, 5.0, 7.3, 12.0, 100.0, 297.0])
@pytest.mark.parametrize("pieces_of", [valley_pieces, mountain_pieces])
def test_dashes_have_ink_at_both_ends_and_run_along_the_crease(pieces_of: object, length: float) -> None:
    line = np.array([[10.0, 20.0], [10.0 + 0.6 * length, 20.0 + 0.8 * length]])
    pieces = pieces_of(line, PLAIN)
    assert pieces[0, 0].tolist() == line[0].tolist()
    assert pieces[-1, 1].tolist() == line[1].tolist()
    along = (pieces - line[0]) @ [0.6, 0.8]
    assert (np.diff(along.ravel()) > 0).all()
    assert_allclose((pieces - line[0]) @ [-0.8, 0.6], 0, atol=1e-12)


def test_dashes_are_stretched_by_less_than_the_eye_sees() -> None:
    for length in np.linspace(20, 60, 41):
        line = np.array([[0.0, 0.0], [length, 0.0]])
        dashes = np.diff(valley_pieces(line, PLAIN)[..., 0], axis=1)
        assert_allclose(dashes, PLAIN.dash_mm, rtol=0.15)


def test_mountains_alternate_dash_and_dot() -> None:
    line = np.array([[0.0, 0.0], [40.0, 0.0]])
    lengths = np.diff(mountain_pieces(line, PLAIN)[..., 0], axis=1).ravel()
    assert (lengths[0::2] > 5 * lengths[1]).all()
    assert_allclose(lengths[1::2], lengths[1])


def test_a_treatment_decides_what_is_made_of_a_crease() -> None:
    creases = letter_fold().creases
    lines = creases.vertices_coords[creases.edges_vertices[creases.edges_assignment == "V"]]
    dash = Dash(dash_mm=1.0, gap_mm=0.5, clearance_mm=0.4)
    treatments: tuple[Treatment, ...] = ("score", "draw")
    score, draw = (list(crease_pieces(creases, "V", treatment, PLAIN)) for treatment in treatments)
    perforate = perforations(creases, Cuts({"V": dash}))[0]["V"]
    assert len(lines) == len(score) == len(perforate) == len(draw) == 2
    for line, whole, cuts, dashes in zip(lines, score, perforate, draw, strict=True):
        assert np.sort(whole[0], axis=0).tolist() == np.sort(line, axis=0).tolist()
        assert np.array(cuts).tolist() == np.array(perforation(line, dash)).tolist()
        assert np.array(dashes).tolist() == valley_pieces(whole[0], PLAIN).tolist()
    assert list(crease_pieces(creases, "M", "score", PLAIN)) == []
