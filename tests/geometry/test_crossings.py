"""Tangles are found before anything is done with them that takes long for many crossings."""

from __future__ import annotations

import json
import time
from pathlib import Path

import numpy as np
import pytest

from foldcut.cli.main import main
from foldcut.core.arrays import Floats
from foldcut.drawing.mend import Preparation, prepare
from foldcut.geometry.crossings import are_tangled


def star(points: int) -> Floats:
    """Return a star of nearly the most crossings: every side goes nearly half of the way around."""
    angles = np.arange(points) * (points // 2) / points * 2 * np.pi
    return np.column_stack([np.cos(angles), np.sin(angles)]) * 50 + 50


def zigzags(count: int) -> list[Floats]:
    """Return one loop with many teeth upwards and one with as many to the side, over each other."""
    at = np.arange(count)
    teeth = np.column_stack([at, np.where(at % 2, 100.0, 0.0)]) * (100 / count, 1)
    one = np.concatenate([teeth, [(100.0, -5.0), (0.0, -5.0)]])
    return [one, one[:, ::-1] + 0.003]


def scribble(count: int) -> Floats:
    return np.random.default_rng(3).random((count, 2)) * 100


@pytest.mark.parametrize("loops", [[star(2001)], zigzags(600), [scribble(1500)]], ids=["star", "zigzags", "scribble"])
def test_a_tangle_is_refused_soon_and_with_its_place(
    loops: list[Floats], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert are_tangled(loops)
    path = tmp_path / "tangle.json"
    path.write_text(json.dumps({"loops": [loop.tolist() for loop in loops]}))
    for options in ([], ["--min-feature", "1mm"], ["--corners", "20"]):
        started = time.process_time()
        assert main(["make", str(path), *options, "-o", str(tmp_path / "a.svg")]) == 2
        assert time.process_time() - started < 5
        error = capsys.readouterr().err
        assert " cross" in error or "folds back" in error
        assert error.count("\n") == 1


@pytest.mark.parametrize("loops", [[star(101)], [star(5), star(5) + 1]], ids=["small star", "two stars"])
def test_fewer_crossings_are_mended(loops: list[Floats]) -> None:
    assert not are_tangled(loops)
    assert "made one by the even-odd rule" in " ".join(prepare(loops, Preparation()).changes)


def test_a_loop_drawn_many_times_is_no_tangle() -> None:
    angles = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    circle = np.column_stack([np.cos(angles), np.sin(angles)]) * 50
    prepared = prepare([circle] * 60, Preparation())
    assert len(prepared.loops) == 1
    assert len(prepared.changes) == 59
