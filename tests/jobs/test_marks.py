"""Marks of a job: where they are, and that they are the right ones."""

from __future__ import annotations

import dataclasses
from functools import cache

import numpy as np
import pytest
import shapely
from support.folded import folded_sample
from support.patterns import book_fold

from foldcut.core.arrays import Floats
from foldcut.core.model import FoldedPattern
from foldcut.geometry.planar_graph import edge_faces
from foldcut.jobs import marks
from foldcut.jobs.job import make_jobs
from foldcut.jobs.marks import MARKS
from foldcut.pattern.cut_line import fold_boundary
from foldcut.pattern.face_maps import fold_faces
from foldcut.pattern.first_folds import first_fold_count
from foldcut.pipeline import fold
from foldcut.profiles import load_profile
from foldcut.samples import sample_path

LASER = load_profile("laser-dxf")


@cache
def folded(name: str, method: str = "auto") -> FoldedPattern:
    return folded_sample(name, method=method)


def length(lines: list[Floats]) -> float:
    return float(sum(np.hypot(*np.diff(line, axis=0).T).sum() for line in lines))


def outline_pieces(pattern: FoldedPattern) -> list[tuple[int, Floats, Floats]]:
    """The outline cut up by faces: for each piece the face's layer, and the ends on the sheet and folded."""
    creases = pattern.creases
    maps = fold_faces(creases, edge_faces(creases))
    pieces, faces, landed = fold_boundary(creases, maps, pattern.shape, 1e-8 * pattern.sheet.diagonal)
    rank = {int(face): place for place, face in enumerate(pattern.folded.layers.tolist())}
    return [(rank[int(face)], piece, place) for face, piece, place in zip(faces, pieces, landed, strict=True)]


@pytest.mark.parametrize("name", ["bolt", "letter-a", "ring"])
def test_all_marks_lie_on_the_sheet(name: str) -> None:
    pattern = folded(name)
    for mark in MARKS.values():
        for line in mark(pattern):
            assert line.shape[1:] == (2,)
            assert (line >= -1e-9).all()
            assert (line <= (pattern.sheet.width + 1e-9, pattern.sheet.height + 1e-9)).all()


@pytest.mark.parametrize("name", ["bolt", "letter-a", "star"])
def test_the_cut_line_is_a_part_of_the_outline_as_long_as_the_folded_cut_on_both_sides(name: str) -> None:
    pattern = folded(name)
    outline = shapely.union_all([shapely.LinearRing(loop) for loop in pattern.shape.loops])
    seen = marks.cut_line(pattern)
    assert all(shapely.LineString(line).within(outline.buffer(1e-6)) for line in seen)
    landed = [place for _, _, place in outline_pieces(pattern)]
    along = max((place[1] - place[0] for place in landed), key=lambda line: float(np.hypot(*line)))
    along /= np.hypot(*along)
    heights = (np.array(landed) - landed[0][0]) @ np.array([-along[1], along[0]])
    assert np.abs(heights).max() < 1e-6, "the outline folds onto the cut line"
    spans = [np.column_stack([(place - landed[0][0]) @ along, [0.0, 0.0]]) for place in landed]
    cut = shapely.union_all([shapely.LineString(np.round(span, 6)) for span in spans]).length
    assert length(seen) == pytest.approx(2 * cut, rel=1e-4)
    assert length(seen) < 0.7 * outline.length


def test_a_layer_that_is_covered_is_not_seen() -> None:
    pattern = folded("star")
    pieces = outline_pieces(pattern)
    top = max(rank for rank, *_ in pieces)
    (best,) = [piece for rank, piece, _ in pieces if rank == top][:1]
    line = shapely.LineString(best)
    assert any(shapely.LineString(seen).buffer(1e-6).contains(line) for seen in marks.cut_line(pattern))


def test_numbers_are_beside_lines_in_front_of_the_first_fold() -> None:
    pattern = folded("letter-a", "mirror")
    (first,) = pattern.first_folds
    axis = first[0, 0]
    strokes = marks.numbers(pattern)
    assert strokes
    beside = [stroke for stroke in strokes if stroke[:, 0].max() > axis]
    # the first fold's own number stands beside it; all others are on the right half
    assert len(strokes) - len(beside) <= 1
    assert marks.numbers(folded("bolt"))


@pytest.mark.parametrize(("sample", "count"), [("rosette", 8), ("plus", 4)])
def test_numbers_of_first_folds_that_cross_do_not_lie_on_each_other(sample: str, count: int) -> None:
    pattern = folded(sample, "mirror")
    assert len(pattern.first_folds) == count
    bare = dataclasses.replace(pattern, creases=book_fold().creases)  # no lines but the first folds
    boxes = [shapely.box(*shapely.LineString(stroke).bounds) for stroke in marks.numbers(bare)]
    labels = shapely.get_parts(shapely.unary_union(shapely.buffer(boxes, 1.0)))
    assert len(labels) >= count


@pytest.mark.parametrize(("sample", "folds"), [("rosette", "12334444"), ("plus", "1233"), ("letter-a", "1")])
def test_the_numbers_of_first_folds_are_those_of_the_folds_that_crease_them(
    sample: str, folds: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    pattern = folded(sample, "mirror")
    bare = dataclasses.replace(pattern, creases=book_fold().creases, sheet=book_fold().sheet)
    written: list[str] = []
    monkeypatch.setattr(marks, "text", lambda words, size: written.append(words) or [np.zeros((2, 2))])
    marks.numbers(bare)
    first = first_fold_count(pattern.first_folds)
    assert written[: len(folds)] == [*folds]
    assert written[len(folds) :] in ([], [str(first + 1)]), "what comes next is the next fold"


def test_arrowheads_point_at_both_ends_of_each_first_fold() -> None:
    pattern = fold(sample_path("ring"), effort="fast", method="mirror").require_verified()
    assert len(marks.first_folds(pattern)) == 2 * len(pattern.first_folds) > 0
    assert marks.first_folds(folded("bolt")) == []
    tips = np.array([arrow[1] for arrow in marks.first_folds(pattern)])
    ends = np.concatenate(pattern.first_folds)
    assert np.abs(tips - ends).max() == pytest.approx(0.5)


def test_the_ruler_is_as_long_as_it_says() -> None:
    line = marks.ruler(folded("bolt"))[0]
    assert line[1, 0] - line[0, 0] == 100
    small = book_fold()
    if small.sheet.width < 60:
        assert marks.ruler(small) == [] or marks.ruler(small)[0][1, 0] <= small.sheet.width


def test_text_is_as_high_as_asked_and_skips_what_has_no_strokes() -> None:
    strokes = marks.text("Hx", 4.0, (10.0, 20.0))
    every = np.concatenate(strokes)
    assert every[:, 0].min() >= 10
    assert 20 <= every[:, 1].min() < every[:, 1].max() <= 24 + 1e-9
    assert marks.text("\u65e5", 4.0) == []


@pytest.mark.parametrize(("kind", "diameter"), [("holes", 3.0), ("pins", 1.0)])
def test_registration_holes_are_cut_once_and_lie_under_the_backs_crosses(kind: str, diameter: float) -> None:
    pattern = folded("bolt")
    front, back = make_jobs(pattern, LASER, two_sided=True, registration=kind, marks=())  # type: ignore[arg-type]
    cuts = {step.role: step.strokes for step in front.steps}["cut"]
    assert len(cuts) == 3
    centres = sorted((tuple(np.round(hole[:-1].mean(axis=0), 6)) for hole in cuts), key=str)
    assert all(np.ptp(hole, axis=0) == pytest.approx(diameter) for hole in cuts)
    assert all((hole[0] == hole[-1]).all() for hole in cuts)
    crosses = {step.role: step.strokes for step in back.steps}["mark"]
    places = {tuple(np.round(cross.mean(axis=0), 6)) for cross in crosses}
    width = pattern.sheet.width
    turned = {(round(width - x, 6), y) for x, y in centres}
    if front.turned:
        height = pattern.sheet.height
        turned = {(x, round(width - y, 6)) for x, y in centres}
        assert height
    assert places == turned


def test_only_the_marks_that_are_asked_for_are_there() -> None:
    pattern = folded("letter-a", "mirror")

    def count(*names: str) -> int:
        (job,) = make_jobs(pattern, LASER, marks=names)
        return sum(len(step.strokes) for step in job.steps if step.role == "mark")

    assert count() == 0
    assert count("outline") == 2
    assert count("outline", "first-folds") == 4
    assert count("title", "ruler") > 10
    assert count("outline", "cut-line") == count("outline"), "nothing is drawn twice"
    assert count("cut-line") > 0
