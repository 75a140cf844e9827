"""The bench of redrawn drawings sees what it is there to see: outlines that are off, shares that are missed."""

from __future__ import annotations

import importlib
import json
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from support.places import TESTS
from support.samples import TESTED

from foldcut.drawing.shape import make_shape

SQUARE = np.array([[0.0, 0.0], [100, 0], [100, 100], [0, 100]])
HOLE = np.array([[30.0, 30.0], [30, 70], [70, 70], [70, 30]])


@pytest.fixture
def bench(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(str(TESTS / "bench"))
    return importlib.import_module("redraw")


def level(tolerance: float, folds: int | None, shortest: float = 5.0, **more: Any) -> dict[str, Any]:
    made = {"verified": folds is not None, "layers": 10, "corners": 9, "off_by_mm": tolerance, "failure": ""}
    return {"tolerance_mm": tolerance, "folds": folds, "shortest_mm": shortest} | made | more


def row(*levels: dict[str, Any], **more: Any) -> dict[str, Any]:
    usual = {"name": "x", "kind": "icons", "failure": "", "taken": len(levels) - 1, "first_s": 0.5, "seconds": 2.0}
    return usual | {"levels": list(levels), "warned_of_layers": False} | more


@pytest.mark.parametrize("moved", [(1.9, 0), (0, 1.9), (-1.4, 1.3)])
def test_an_outline_within_the_tolerance_has_no_fault(bench: ModuleType, moved: tuple[float, float]) -> None:
    outline = SQUARE.copy()
    outline[2] += moved
    assert bench.faults([outline, HOLE], [SQUARE, HOLE], 2.0, symmetric=False) == []


@pytest.mark.parametrize("moved", [(2.2, 0), (0, -2.2), (1.6, 1.6)])
def test_an_outline_that_is_too_far_off_is_found_both_ways(bench: ModuleType, moved: tuple[float, float]) -> None:
    outline = SQUARE.copy()
    outline[2] += moved
    found = " ".join(bench.faults([outline], [SQUARE], 2.0, symmetric=False))
    assert "mm off" in found
    assert "by GEOS" in found
    spike = np.array([*SQUARE[:2], [100, 49], [104, 50], [100, 51], *SQUARE[2:]])
    assert any(fault.startswith("the outline") for fault in bench.faults([spike], [SQUARE], 2.0, symmetric=False))
    assert any(fault.startswith("the drawing") for fault in bench.faults([SQUARE], [spike], 2.0, symmetric=False))


@pytest.mark.parametrize(
    ("outline", "fault"),
    [
        ([SQUARE], "1 loops were 2"),
        ([SQUARE, HOLE + np.array([100, 0])], "loops lie in each other in another way"),
        ([SQUARE, HOLE + np.array([30, 0])], "two loops touch"),
        ([SQUARE[[0, 2, 1, 3]], HOLE], "loop 1 crosses itself"),
    ],
    ids=["lost", "outside", "touching", "crossing"],
)
def test_another_topology_is_found(bench: ModuleType, outline: list[np.ndarray], fault: str) -> None:
    assert fault in bench.faults(outline, [SQUARE, HOLE], 200.0, symmetric=False)


@pytest.mark.parametrize("corner", [0, 1, 3])
def test_lost_symmetry_is_found(bench: ModuleType, corner: int) -> None:
    kite = np.array([[50.0, 0], [100, 60], [50, 100], [0, 60]])
    assert bench.faults([kite + np.array([0, 1])], [kite], 2.0, symmetric=True) == []
    bent = kite.copy()
    bent[corner] += (0.3, 0.4)
    assert bench.faults([bent], [kite], 2.0, symmetric=True) == ["the drawing is symmetric, the outline is not"]


def test_shares_count_what_is_for_two_hands_within_a_tolerance(bench: ModuleType) -> None:
    rows = [
        row(level(0.0, 100), level(2.0, 60, 3.0)),
        row(level(2.0, 61), level(4.0, 50)),
        row(level(2.0, 40, 2.9), level(4.0, 130)),
        row(level(2.0, None), level(4.0, 130, layers=40), kind="letters", name="y"),
    ]
    text = "\n".join(bench.shares(rows, []))
    assert "within 2 mm | at least 70 % | 25 % |" in text
    assert "within 4 mm | at least 90 % | 50 % |" in text
    assert "more than 120 folds within 4 mm | none | 1: y |" in text
    assert "at the cut without a warning | none | 1: y |" in text
    assert "median of icons | at most 45 | 60 |" in text
    assert "median of letters | at most 35 | inf |" in text


def test_a_drawing_that_was_refused_counts_against_every_share_and_time(bench: ModuleType) -> None:
    refused = row(failure="not done in 9 s", levels=[], first_s=None, seconds=9.0, name="z")
    text = "\n".join(bench.shares([refused], []))
    assert "refused | none | 1: z |" in text
    assert "0 % |" in text
    assert "inf and inf s" in text


@pytest.mark.parametrize(
    ("folds", "shortest", "said"),
    [(10, 5.0, ""), (9, 9.0, ""), (11, 5.0, "11 folds instead of 10"), (10, 4.9, "4.90 mm instead of 5.00")],
)
def test_worse_than_before_is_more_folds_or_a_shorter_crease(
    bench: ModuleType, folds: int, shortest: float, said: str
) -> None:
    was = {"folds": 10, "shortest_mm": 5.0, "failure": ""}
    found = bench.worse(level(0.25, folds, shortest), was)
    assert said in found
    assert bool(found) == bool(said)
    assert bench.worse(None, was) == bench.worse(level(0.25, None), was) == "no pattern"


NEWER = {"paper-chain", "rosette", "snowflake"}
"""Samples that were drawn later than the record."""


def test_what_was_before_is_known_of_every_sample() -> None:
    before = json.loads((TESTS / "bench" / "before_redraw.json").read_text())
    assert set(TESTED) - NEWER <= set(before)
    assert all(row["failure"] or (row["folds"] > 0 and row["seconds"] > 0) for row in before.values())


def test_random_drawings_are_shapes_the_same_every_time_and_symmetric_where_they_say_so(bench: ModuleType) -> None:
    drawings = list(bench.random_drawings(40))
    for (name, drawing, symmetric), (_, again, _) in zip(drawings, bench.random_drawings(40), strict=True):
        make_shape(drawing.loops)
        assert all(map(np.array_equal, drawing.loops, again.loops)), name
        assert bench.is_symmetric(drawing.loops, drawing.loops, 0) == symmetric, name
    assert sum(symmetric for *_, symmetric in drawings) == 20
    assert sum(len(drawing.loops) == 2 for _, drawing, _ in drawings) == 10


def test_icons_are_chosen_by_their_names(bench: ModuleType) -> None:
    names = ["key", "key-fill", "key-outline", "dog-side", "numeric", "numeric-1", "fill", "abacus"]
    assert [name for name in names if bench.is_simple(name)] == [
        *("key", "key-fill", "key-outline", "numeric", "fill", "abacus")
    ]


def test_every_share_is_taken_once(bench: ModuleType) -> None:
    shares = [list(bench.shared(iter(range(10)), bench.share_of(f"{k}/3"))) for k in (1, 2, 3)]
    assert sorted(number for share in shares for number in share) == list(range(10))
    assert [share[0] for share in shares] == [0, 1, 2]
