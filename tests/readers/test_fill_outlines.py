"""Outlines that are painted over each other: white is cut out, and what is covered is told with its name and place."""

from __future__ import annotations

from functools import reduce
from pathlib import Path

import ezdxf
import pytest
import shapely

from foldcut.cli.main import main
from foldcut.core.errors import ShapeError
from foldcut.drawing.mend import preview
from foldcut.drawing.shape import make_shape
from foldcut.readers import Drawing, read_shape

HOUSE = '<path id="house" fill="#333" d="M20 90V45L50 15L80 45V90Z"/>'
HOUSE_AREA = 60 * 45 + 30 * 30


def read(folder: Path, body: str, attributes: str = 'width="100mm" viewBox="0 0 100 100"') -> Drawing:
    path = folder / "a.svg"
    path.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" {attributes}>{body}</svg>')
    return read_shape(path)


def area(drawing: Drawing) -> float:
    return float(reduce(shapely.symmetric_difference, map(shapely.Polygon, drawing.loops)).area)


def rect(x: float, y: float, width: float, height: float, more: str = "") -> str:
    return f'<rect x="{x}" y="{y}" width="{width}" height="{height}" {more}/>'


CUT = "cut out {}, white over another colour"
COVERED = "left out {}, which others cover"
UNITED = "{} outlines that overlap or touch were united"


@pytest.mark.parametrize(
    ("body", "expected", "notes"),
    [
        (
            HOUSE + rect(40, 60, 15, 30, 'id="door" fill="#FFF"'),
            HOUSE_AREA - 450,
            (CUT.format('rect "door" at (47.5, 75)'),),
        ),
        (
            HOUSE + rect(40, 60, 15, 30, 'id="door" fill="#a00"'),
            HOUSE_AREA,
            (UNITED.format(2), COVERED.format('rect "door" at (47.5, 75)')),
        ),
        (
            HOUSE + rect(40, 60, 15, 40, 'fill="white" stroke="white"'),
            HOUSE_AREA - 450,
            (CUT.format("rect number 1 at (47.5, 80)"),),
        ),
        # white with a stroke over dark: a hole; beside it: an outline of its own
        (HOUSE + rect(40, 60, 15, 30, 'fill="white" stroke="black"'), HOUSE_AREA - 450, None),
        (HOUSE + rect(70, 60, 30, 10, 'fill="white" stroke="black"'), HOUSE_AREA + 200, None),
        # nothing is white in a drawing that is white altogether
        (rect(10, 10, 40, 40, 'fill="white"') + rect(40, 20, 40, 20, 'fill="white"'), 1600 + 600, (UNITED.format(2),)),
        # a hole that does not touch its outline is one in any colour
        (HOUSE + rect(40, 60, 15, 20, 'fill="white"'), HOUSE_AREA - 300, ()),
        (HOUSE + rect(40, 60, 15, 20, 'fill="#a00"'), HOUSE_AREA - 300, ()),
        # in the order in which they are painted
        (rect(40, 60, 15, 30, 'fill="white"') + HOUSE, HOUSE_AREA, None),
        (HOUSE + rect(40, 60, 15, 30, 'fill="white"') + rect(45, 60, 5, 30), HOUSE_AREA - 300, None),
        # several in one place
        (
            HOUSE + rect(20, 80, 10, 10) + rect(70, 80, 10, 10, 'id="b"'),
            HOUSE_AREA,
            (UNITED.format(3), COVERED.format('rect "b" at (75, 85), rect number 1 at (25, 85)')),
        ),
        (
            rect(10, 10, 20, 20) + rect(10, 10, 20, 20),
            400,
            (UNITED.format(2), COVERED.format("rect number 2 at (20, 20)")),
        ),
        # a hole that another outline fills
        (
            '<path fill-rule="evenodd" d="M10 10H90V90H10ZM40 40H60V60H40Z"/>' + rect(40, 35, 30, 30),
            6400,
            (UNITED.format(2), COVERED.format("a hole of path number 1 at (50, 50)")),
        ),
        # outlines that are in nothing else are kept, and none is told
        (rect(10, 10, 40, 40) + rect(40, 20, 40, 20), 2200, (UNITED.format(2),)),
    ],
)
def test_what_is_painted_over_others(tmp_path: Path, body: str, expected: float, notes: tuple[str, ...] | None) -> None:
    drawing = read(tmp_path, body)
    assert area(drawing) == pytest.approx(expected)
    make_shape(drawing.loops)
    if notes is not None:
        assert drawing.notes == notes
        assert bool(drawing.lost) == any("left out" in note for note in notes)


def test_white_on_white_paper_is_left_out_and_told(tmp_path: Path) -> None:
    drawing = read(tmp_path, HOUSE + rect(85, 5, 10, 10, 'id="sun" fill="white"'))
    assert area(drawing) == pytest.approx(HOUSE_AREA)
    assert drawing.notes == ('left out rect "sun" at (90, 10), white on white paper',)
    (lost,) = drawing.lost
    assert lost.min(axis=0).tolist() == [85, -15]


def test_what_the_fill_rule_fills_over_is_told(tmp_path: Path) -> None:
    drawing = read(tmp_path, '<path d="M10 10H90V90H10ZM40 40H60V60H40Z"/>')
    assert area(drawing) == pytest.approx(6400)
    assert drawing.notes == (
        "left out loops that the fill rule nonzero fills over, since they run the same way round: "
        "path number 1 at (50, 50)",
    )


def test_entities_of_a_dxf_that_others_cover_are_told(tmp_path: Path) -> None:
    document = ezdxf.new(units=4)
    document.modelspace().add_lwpolyline([(0, 0), (40, 0), (40, 40), (0, 40)], close=True)
    door = document.modelspace().add_lwpolyline([(10, 0), (20, 0), (20, 20), (10, 20)], close=True)
    document.saveas(tmp_path / "a.dxf")
    drawing = read_shape(tmp_path / "a.dxf")
    assert drawing.notes[-1] == COVERED.format(f"LWPOLYLINE #{door.dxf.handle} at (15, 10)")


def test_the_preview_shows_what_is_covered(tmp_path: Path) -> None:
    read(tmp_path, HOUSE + rect(20, 80, 15, 10, 'id="mat" fill="#a00"'))
    files = [str(tmp_path / name) for name in ("a.svg", "p.svg", "o.fold")]
    arguments = ["--effort", "fast", "--exact", "--width", "60mm", "--min-crease", "0mm", "--quiet"]
    assert main(["make", files[0], "--preview", files[1], "-o", files[2], *arguments]) == 0
    shown = (tmp_path / "p.svg").read_text()
    (line,) = [line for line in shown.splitlines() if "#06f" in line]
    # the mat is as wide as a quarter of the house, at its lower left corner; around all there are 5 mm
    assert 'd="M5.0000,' in line or "5.0000," in line
    assert "20.0000," in line
    assert "#06f" not in preview([], [read_shape(tmp_path / "a.svg").loops[0]]).decode()


def test_places_in_errors_are_those_of_the_file(tmp_path: Path) -> None:
    drawing = read(tmp_path, rect(10, 20, 30, 30) + '<path d="M60 60L90 60L90 90L75 60.00000001L60 90Z"/>')
    with pytest.raises(ShapeError, match=r"at \(75, 60\)"):
        make_shape(drawing.loops, y_down=drawing.y_down)
    with pytest.raises(ShapeError, match=r"at \(75, -60\)"):
        make_shape(drawing.loops)
    assert main(["make", str(tmp_path / "a.svg"), "-o", str(tmp_path / "o.fold"), "--strict"]) != 0


def test_many_outlines_in_one_place_do_not_take_long(tmp_path: Path) -> None:
    body = "".join(
        rect(x, y, 1.5, 1.5, f'fill="{"white" if (x + y) % 3 == 0 else "black"}"') for x in range(28) for y in range(28)
    )
    drawing = read(tmp_path, body)
    assert 0 < area(drawing) < 30**2
