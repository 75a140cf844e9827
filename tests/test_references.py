"""Where folds go without a printed line: what a sentence names is measured here on the folded sheet."""

from __future__ import annotations

import re
from functools import cache

import numpy as np
import pytest
from support.folded import folded_sample

from foldcut.core.arrays import Floats, index_array
from foldcut.core.model import FoldedPattern, FoldedState
from foldcut.folding_steps import FoldingStep, folding_steps
from foldcut.folding_steps.references import reference

POINT = (
    r"(corner [A-D]|edge [A-D]{2}, [\d.]+ mm from [A-D]|the point [\d.]+ mm from edge DA and [\d.]+ mm from edge AB)"
)


@cache
def folds_of(name: str) -> tuple[FoldedPattern, list[tuple[FoldedState, FoldingStep]]]:
    """Return a sample, and its simple folds with the state before each."""
    pattern = folded_sample(name)
    count = len(pattern.creases.faces_vertices)
    state, folds = FoldedState(pattern.creases.vertices_coords, index_array(np.arange(count))), []
    for step in folding_steps(pattern):
        folds += [(state, step)] if step.line is not None else []
        state = step.state
    return pattern, folds


def corner(pattern: FoldedPattern, name: str) -> int:
    place = pattern.sheet.corners["ABCD".index(name)]
    return int(np.hypot(*(pattern.creases.vertices_coords - place).T).argmin())


def on_sheet(pattern: FoldedPattern, words: str) -> Floats:
    """Return the place on the flat sheet that a part of a sentence names."""
    corners = dict(zip("ABCD", pattern.sheet.corners, strict=True))
    numbers = [float(number) for number in re.findall(r"[\d.]+(?= mm)", words)]
    if words.startswith("corner"):
        return corners[words[-1]]
    if words.startswith("edge"):
        start = corners[words[-1]]
        other = corners[words[5:7].replace(words[-1], "")]
        return start + numbers[0] * (other - start) / np.hypot(*(other - start))
    return np.array(numbers)


@pytest.mark.parametrize("name", ["star", "tree", "ring", "square", "plus", "letter-t"])
def test_what_is_said_of_a_fold_is_so(name: str) -> None:
    pattern, folds = folds_of(name)
    flat = pattern.creases.vertices_coords
    assert folds
    for before, step in folds:
        text = reference(pattern, before, step)
        assert step.line is not None
        if "comes to lie on" in text:
            for ones, others in re.findall(r"([A-D]+)(?: comes to lie)? on ([A-D]+)", text):
                landed = step.state.vertices_coords[[corner(pattern, one) for one in ones]]
                stays = before.vertices_coords[[corner(pattern, other) for other in others]]
                assert np.abs(landed[:, None] - stays[None]).max() < 1e-3
            continue
        found = re.fullmatch(rf"The line goes from {POINT}, to {POINT}\.", text)
        assert found, text
        named = np.array([on_sheet(pattern, words) for words in found.groups()])
        for place, end in zip(named, step.line, strict=True):
            away = np.hypot(*(flat - place).T)
            assert away.min() < 0.15, "in mm, rounded to tenths"
            assert np.hypot(*(before.vertices_coords[int(away.argmin())] - end)) < 1e-3


def test_the_first_fold_of_a_star_brings_corners_on_corners_and_an_edge_may_lie_along_an_edge() -> None:
    pattern, folds = folds_of("star")
    assert reference(pattern, *folds[0]) == "B comes to lie on A and C on D."
    pattern, folds = folds_of("letter-l")
    assert "Edge BC comes to lie along edge DA." in [reference(pattern, *fold) for fold in folds]
