"""The animation of a guide: straight folds move from one state to the next, and every picture has its time."""

from __future__ import annotations

import xml.etree.ElementTree as ET

import numpy as np
import pytest
from support.folded import fold_sample

from foldcut.core.arrays import index_array
from foldcut.core.model import FoldedState
from foldcut.exporters.pictures.animation import _Drawing, export_animation
from foldcut.exporters.pictures.pictures import pieces
from foldcut.folding_steps import folding_steps

SVG = "{http://www.w3.org/2000/svg}"


@pytest.mark.parametrize("sample", ["star", "letter-t"])
def test_a_straight_fold_moves_from_one_state_to_the_next(sample: str) -> None:
    pattern = fold_sample(sample).folded_pattern
    parts = [(face, inside, outline) for face, inside, outline, _ in pieces(pattern)]
    draw = _Drawing(pattern, parts)
    flat = pattern.creases.vertices_coords
    state = FoldedState(flat, index_array(np.arange(len(pattern.creases.faces_vertices))))
    folds = 0
    for step in folding_steps(pattern):
        if step.line is not None:
            folds += 1
            for part, there in ((0.0, state), (1.0, step.state)):
                key = [polygon.round(6).tolist() for polygon, _ in draw.turning(state, step, part)]
                assert sorted(key) == sorted(polygon.round(6).tolist() for polygon, _ in draw.at(there))
            widest = max(np.ptp(polygon, axis=0).max() for polygon, _ in draw.turning(state, step, 0.5))
            assert widest <= pattern.sheet.diagonal
        state = step.state
    assert folds


def test_every_picture_has_its_time_and_one_is_seen_where_nothing_moves() -> None:
    pattern = fold_sample("letter-t").folded_pattern
    made = export_animation(pattern)
    assert made == export_animation(pattern)
    root = ET.fromstring(made)
    groups = root.findall(f"{SVG}g")
    assert [group.get("visibility") for group in groups] == ["visible"] + ["hidden"] * (len(groups) - 1)
    ends = [0.0]
    for group in groups:
        (animate,) = group.findall(f"{SVG}animate")
        times = [float(time) for time in animate.get("keyTimes", "").split(";")]
        values = animate.get("values", "").split(";")
        assert times == sorted(times)
        assert times[0] == 0
        shown = values.index("visible")
        assert times[shown] == pytest.approx(ends[-1])
        ends.append(times[shown + 1] if shown + 1 < len(times) else 1.0)
    assert ends[-1] == 1.0
    words = [group.findtext(f"{SVG}text") for group in groups]
    steps = len(folding_steps(pattern))
    assert words[0] == words[-1] == pattern.title
    assert words[-2] == "cut once, along the line"
    assert f"{steps} of {steps}" in str(words[-3])
