"""The same drawing at many sizes has the same pattern: how large it is decides nothing.

``FOLDCUT_WIDTHS`` says at how many widths from 40 to 260 mm; 50 take some minutes.
"""

from __future__ import annotations

import os
from typing import Any

import numpy as np
import pytest

import foldcut
from foldcut import pipeline
from foldcut.core.model import Sheet
from foldcut.pattern.crop import crop
from foldcut.samples import sample_path

WIDTHS = np.linspace(40.0, 260.0, int(os.environ.get("FOLDCUT_WIDTHS", "2"))).tolist()

DOG = [
    [(30, 110), (50, 85), (55, 65), (70, 77), (80, 97), (140, 97), (165, 72), (173, 78), (151, 108)],
    [(151, 180), (133, 180), (133, 135), (78, 135), (78, 180), (60, 180), (60, 118), (50, 108), (35, 108)],
]
DRAWINGS = {
    "dog": [[(float(x), float(-y)) for row in DOG for x, y in row]],
    "fish": sample_path("fish"),
}


def creases_in_widths(result: foldcut.Result, width: float, beyond: float) -> tuple[list[list[float]], list[str]]:
    """Return the creases' ends and kinds in order, as parts of the width, no farther than ``beyond`` from the shape."""
    pattern = result.folded_pattern
    corners = np.concatenate(pattern.shape.loops)
    low, high = corners.min(axis=0), corners.max(axis=0)
    creases, _ = crop(pattern.creases, pattern.folded, low - beyond * width, high + beyond * width)
    folded = creases.edges_assignment != "B"
    ends = ((creases.vertices_coords - low) / width).round(6)[creases.edges_vertices[folded]]
    rows = [[*min(pair), *max(pair)] for pair in ends.tolist()]
    order = sorted(range(len(rows)), key=lambda k: rows[k])
    return [rows[k] for k in order], creases.edges_assignment[folded][order].tolist()


@pytest.mark.parametrize("name", ["fish"])
def test_a_drawing_and_its_sheet_may_have_any_size(name: str) -> None:
    found = []
    for width in WIDTHS:
        sheet = Sheet(1.15 * width, 1.1 * width)
        result = foldcut.fold(
            DRAWINGS[name], sheet, width=width, margin=0.02 * width, method="skeleton", effort="fast", min_crease=0.0
        )
        assert result.findings == ()
        found.append(creases_in_widths(result, width, beyond=0.02))
    assert len(found[0][0]) > 50
    for ends, kinds in found[1:]:
        assert kinds == found[0][1]
        np.testing.assert_allclose(ends, found[0][0], atol=2e-6)


@pytest.mark.parametrize("name", ["dog"])
def test_one_sheet_for_all_sizes_is_cut_down_where_that_takes_fewer_folds(name: str) -> None:
    found = []
    for width in WIDTHS:
        result = foldcut.fold(DRAWINGS[name], "a3", width=width, effort="fast")
        assert result.findings == ()
        sheet = result.folded_pattern.sheet
        note = f"cut the sheet down to {sheet.width:g} by {sheet.height:g} mm first"
        assert any(text.startswith(note) for text in result.notes) == (sheet.width < 420.0)
        found.append(creases_in_widths(result, width, beyond=0.02))
    for ends, kinds in found[1:]:
        assert kinds == found[0][1]
        np.testing.assert_allclose(ends, found[0][0], atol=2e-6)


def test_ctrl_c_while_less_paper_is_tried_keeps_the_pattern_for_the_whole_sheet(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(pipeline, "HANDS_FOLDS", 1)
    fold_in_turn, turns = pipeline._folded, []

    def folded(*problem: Any) -> Any:
        turns.append(problem)
        if len(turns) == 2:
            raise KeyboardInterrupt
        return fold_in_turn(*problem)

    monkeypatch.setattr(pipeline, "_folded", folded)
    result = foldcut.fold(sample_path("star"), "a4-landscape", width=60.0, method="skeleton", effort="fast")
    assert len(turns) == 2
    assert result.verified
    assert result.folded_pattern.sheet.width == 297.0
    stages = {name: seconds for name, seconds in result.seconds.items() if name not in ("build", "verify")}
    assert result.seconds["build"] == pytest.approx(sum(stages.values()))


def test_a_drawing_that_is_to_lie_at_a_place_keeps_its_sheet() -> None:
    loops = DRAWINGS["dog"]
    result = foldcut.fold(loops, "a4-landscape", width=150.0, offset=(20.0, 20.0), method="skeleton", effort="fast")
    assert (result.folded_pattern.sheet.width, result.folded_pattern.sheet.height) == (297.0, 210.0)


def test_the_same_sheet_around_drawings_that_differ_a_little_in_size_only_ends_creases_elsewhere() -> None:
    found = []
    for width in np.linspace(190.0, 215.0, len(WIDTHS)).tolist():
        result = foldcut.fold(DRAWINGS["dog"], "a4-landscape", width=width, method="skeleton", effort="fast")
        assert result.findings == ()
        found.append(creases_in_widths(result, width, beyond=0.02))
    for ends, kinds in found[1:]:
        assert kinds == found[0][1]
        np.testing.assert_allclose(ends, found[0][0], atol=2e-6)


@pytest.mark.parametrize("rotation", [90.0, 180.0])
def test_a_quarter_turn_turns_the_pattern(rotation: float) -> None:
    sheet = Sheet(200.0, 200.0)
    straight, turned = (
        foldcut.fold(
            sample_path("swan"),
            sheet,
            rotation=angle,
            width=120.0 if angle % 180 == 0 else None,
            height=None if angle % 180 == 0 else 120.0,
            method="skeleton",
            effort="fast",
        )
        for angle in (0.0, rotation)
    )
    assert turned.findings == ()
    assert turned.folded_pattern.creases.crease_count == straight.folded_pattern.creases.crease_count
    assert turned.actions == straight.actions


def test_corners_are_moved_in_proportion_unless_a_limit_is_given() -> None:
    sheets = {width: Sheet(1.2 * width, 1.2 * width) for width in (50.0, 200.0)}

    def moved(width: float, adjust: float | None) -> float:
        result = foldcut.fold(
            sample_path("swan"), sheets[width], width=width, margin=1.0, method="skeleton", effort="fast", adjust=adjust
        )
        return result.numbers["moved_mm"]

    assert moved(200.0, None) == pytest.approx(4 * moved(50.0, None))
    assert 0 < moved(50.0, None) <= 50.0 / 350
    assert moved(200.0, 0.1) <= 0.1
    assert moved(50.0, 0.02) <= 0.02


def test_reasons_name_places_and_lengths_on_the_sheet_that_was_asked_for() -> None:
    loops = [[(0, 0), (12, 0), (12, 12), (0, 12)], [(4, 4), (8, 4), (8, 8), (4, 8)]]
    with pytest.raises(foldcut.UnfoldableError, match=r"meet 5 mm from the cut, within the ribbon of 6 mm"):
        foldcut.fold(loops, Sheet(70.0, 70.0), width=30.0, method="skeleton", ribbon=6.0)
