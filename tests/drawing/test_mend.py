"""A drawing is mended and simplified, and every change is reported."""

from __future__ import annotations

import json
from functools import reduce
from pathlib import Path

import numpy as np
import pytest
import shapely

from foldcut.cli.main import main
from foldcut.core.arrays import Floats, points_array
from foldcut.core.errors import BadInputError, ShapeError
from foldcut.drawing.mend import Preparation, prepare, preview
from foldcut.drawing.shape import invariant_faults, make_shape


def square(x: float, y: float, side: float) -> Floats:
    return points_array([(x, y), (x + side, y), (x + side, y + side), (x, y + side)])


def area(loops: tuple[Floats, ...]) -> float:
    """Return the even-odd area of loops that do not cross."""
    return float(reduce(shapely.symmetric_difference, map(shapely.Polygon, loops)).area)


def circle(count: int, radius: float = 50.0) -> Floats:
    angles = np.linspace(0, 2 * np.pi, count, endpoint=False)
    return points_array(radius * np.column_stack([np.cos(angles), np.sin(angles)]))


def test_a_valid_drawing_comes_back_as_it_is() -> None:
    loops = (square(0, 0, 40), square(10, 10, 10))
    for preparation in (Preparation(), Preparation(corners=8, min_feature=5, separate=1, strict=True)):
        prepared = prepare(loops, preparation)
        assert prepared.changes == ()
        assert [loop.tolist() for loop in prepared.loops] == [loop.tolist() for loop in loops]


MENDED = {
    "overlap": ([square(0, 0, 40), square(20, 20, 40)], "2 -> ", None),
    "bow tie": ([points_array([(0, 0), (40, 40), (40, 0), (0, 40)])], "cross or overlap", 800),
    "common side": ([square(0, 0, 40), points_array([(40, 0), (60, 0), (60, 40), (40, 40)])], "2 -> 1 loops", 2400),
    "repeated": ([square(0, 0, 40), square(0, 0, 40)], "dropped loop 2: it repeats loop 1", 1600),
    "a line": ([square(0, 0, 40), points_array([(5, 5), (6, 6)])], "dropped loop 2: it bounds no area", 1600),
    "a flat loop": ([square(0, 0, 40), points_array([(5, 5), (6, 6), (9, 9)])], "dropped loop 2: it bounds", 1600),
    "a sliver": (
        [square(0, 0, 40), points_array([(39, 0), (80, 0), (80, 0.01), (39, 0.01)])],
        "dropped 1 sliver",
        None,
    ),
    "a spike": ([points_array([(0, 0), (40, 0), (40, 20), (60, 20), (40, 20), (40, 40), (0, 40)])], "-> 1 loops", 1600),
}


def test_a_loop_repeats_another_only_if_it_is_drawn_along_the_same_corners() -> None:
    box = square(0, 0, 40)
    for again in (box[::-1], np.roll(box, 1, axis=0), np.concatenate([box, box[:1]])):
        assert prepare([box, again], Preparation()).changes == ("dropped loop 2: it repeats loop 1",)
    bow_tie = box[[0, 2, 1, 3]]
    prepared = prepare([box, bow_tie], Preparation())
    assert not any("repeats" in change for change in prepared.changes)
    assert area(prepared.loops) == pytest.approx(800)


@pytest.mark.parametrize("name", MENDED)
def test_what_is_mended_is_said_and_refused_when_strict(name: str) -> None:
    loops, words, expected = MENDED[name]
    prepared = prepare(loops, Preparation())
    assert words in "; ".join(prepared.changes)
    if expected is not None:
        assert area(prepared.loops) == pytest.approx(expected)
    with pytest.raises(ShapeError, match="the drawing has to be mended: .*; leave out --strict"):
        prepare(loops, Preparation(strict=True))


@pytest.mark.parametrize("loops", [[square(0, 0, 40), square(40, 40, 40)], MENDED["bow tie"][0]])
def test_touching_loops_are_set_apart_only_on_request(loops: list[Floats]) -> None:
    with pytest.raises(ShapeError):
        make_shape(prepare(loops, Preparation()).loops)
    prepared = prepare(loops, Preparation(separate=0.5))
    assert "set 0.5 mm apart: every edge went inward by 0.25 mm" in prepared.changes[-1]
    shape = make_shape(prepared.loops)
    one, other = (shapely.Polygon(loop) for loop in shape.loops)
    assert one.distance(other) >= 0.5 - 1e-9


@pytest.mark.parametrize("count", [100, 3_000, 100_000])
def test_corners_are_left_out_down_to_the_budget(count: int) -> None:
    drawn, hole = circle(count), circle(12, 20.0)
    prepared = prepare([drawn, hole], Preparation(corners=20))
    shape = make_shape(prepared.loops)
    assert invariant_faults(shape) == []
    assert 10 <= shape.corner_count <= 20
    assert shape.parent == (-1, 0)
    (change,) = prepared.changes
    assert f"simplified: {count + 12} -> {shape.corner_count} corners, at most " in change
    said = float(change.split()[-3])
    off = max(
        shapely.hausdorff_distance(shapely.LinearRing(loop), shapely.LinearRing(new))
        for loop, new in zip((drawn, hole), shape.loops, strict=True)
    )
    assert off <= said * 1.1
    with pytest.raises(ShapeError, match="[67] corners that keep its loops apart, more than the 5 of --corners"):
        prepare([drawn, hole], Preparation(corners=5))


def test_narrow_parts_and_gaps_go() -> None:
    # A square with a thin tail to the right and a thin slot from above.
    tail, slot = [(40, 10), (70, 10), (70, 11), (40, 11)], [(20.5, 40), (20.5, 20), (20, 20), (20, 40)]
    loop = points_array([(0, 0), (40, 0), *tail, (40, 40), *slot, (0, 40)])
    prepared = prepare([loop], Preparation(min_feature=2))
    assert prepared.changes == ("parts and gaps narrower than 2 mm: closed 10 mm2, dropped 30 mm2, 1 -> 1 loops",)
    assert area(prepared.loops) == pytest.approx(1600, rel=1e-3)
    with pytest.raises(ShapeError, match="no part of the drawing is 50 mm wide"):
        prepare([loop], Preparation(min_feature=50))


def test_mirroring_turns_left_to_right() -> None:
    prepared = prepare([square(10, 0, 5)], Preparation(mirror=True))
    assert prepared.loops[0].tolist() == [[-10, 0], [-15, 0], [-15, 5], [-10, 5]]
    assert prepared.changes == ("mirrored, left to right",)


def test_the_preview_has_both() -> None:
    svg = preview([square(0, 0, 40)], [square(0, 0, 20)]).decode()
    assert svg.count("<path") == 2
    assert 'width="50.000mm"' in svg


@pytest.mark.parametrize("options", [{"corners": 2}, {"min_feature": -1}, {"separate": float("nan")}])
def test_options_that_make_no_sense_are_refused(options: dict[str, float]) -> None:
    with pytest.raises(BadInputError):
        Preparation(**options)  # type: ignore[arg-type]


def test_the_command_mends_reports_and_previews(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    loops = [[[0, 0], [40, 0], [40, 20], [0, 20]], [[40, 0], [50, 10], [40, 20]]]
    Path("house.json").write_text(json.dumps({"loops": loops}))
    options = ["make", "house.json", "--sheet", "80x60", "--effort", "fast"]
    assert main([*options, "--strict"]) == 2
    assert "the drawing has to be mended: outlines that cross or overlap" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["house.json"]
    assert main([*options, "-o", "house.fold", "--mirror", "--preview", "both.svg"]) == 0
    out = capsys.readouterr().out
    assert "note      outlines that cross or overlap were made one by the even-odd rule: 2 -> 1 loops, 7 -> " in out
    assert "note      mirrored, left to right" in out
    assert Path("both.svg").read_text().count("<path") == 2
    assert main([*options, "-o", "other.fold", "--preview", "both.svg"]) == 2
    assert "both.svg: it is there already" in capsys.readouterr().err
    # The mended mirror image is compared with the drawing itself, mended by hand.
    mended = [[0, 0], [40, 0], [50, 10], [40, 20], [0, 20]]
    Path("mended.json").write_text(json.dumps({"loops": [mended]}))
    assert main(["check", "house.fold", "--shape", "mended.json", "--quiet"]) == 0
