"""DXF files with something odd in them: it is left out and named, or mended, and the rest is read."""

from __future__ import annotations

import io
import re
from collections.abc import Callable
from functools import reduce
from itertools import pairwise
from pathlib import Path

import ezdxf
import numpy as np
import pytest
import shapely
from ezdxf.document import Drawing as Document
from scipy.interpolate import BSpline

from foldcut.core.errors import FileFormatError
from foldcut.readers import Drawing, ReadOptions, read_shape
from foldcut.readers.dxf_file import trim_spline

PLATE = ((0, 0), (100, 0), (100, 70), (0, 70))
PLATE_AREA = 7000.0


def document(version: str = "R2010") -> Document:
    """Return a document in mm with a plate."""
    made = ezdxf.new(version, units=4)
    if version == "R12":
        made.modelspace().add_polyline2d(PLATE, close=True)
    else:
        made.modelspace().add_lwpolyline(PLATE, close=True)
    return made


def text_of(made: Document) -> str:
    stream = io.StringIO()
    made.write(stream)
    return stream.getvalue()


def area(drawing: Drawing) -> float:
    return float(reduce(shapely.symmetric_difference, map(shapely.Polygon, drawing.loops)).area)


def with_mesh() -> str:
    made = document()
    with made.modelspace().add_mesh().edit_data() as data:
        data.vertices, data.faces = [(0, 0, 0), (1, 0, 0), (1, 1, 0)], [(0, 1, 2)]
    return re.sub(r" 94\n.*?(?=  0\n)", "", text_of(made), count=1, flags=re.DOTALL)


def with_dimension() -> str:
    made = document()
    made.modelspace().add_linear_dim(base=(0, 80), p1=(0, 70), p2=(100, 70)).render()
    return text_of(made).replace("*D1", "*D9", 1)


def with_dimension_without_block() -> str:
    made = document()
    made.modelspace().add_linear_dim(base=(0, 80), p1=(0, 70), p2=(100, 70))
    return text_of(made)


def with_circle(change: Callable[[str], str]) -> str:
    made = document()
    made.modelspace().add_circle((20, 20), 5)
    return change(text_of(made))


def with_spline_without_knots() -> str:
    made = document()
    spline = made.modelspace().add_spline()
    spline.control_points, spline.knots = [(10, 10), (20, 10), (20, 20), (10, 20)], [0, 0, 0, 1]
    return text_of(made)


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        (with_mesh(), "MESH"),
        (with_dimension_without_block(), "DIMENSION"),
        (with_circle(lambda text: text.replace(" 40\n5.0\n", " 40\nnan\n")), "CIRCLE"),
        (with_circle(lambda text: text.replace(" 40\n5.0\n", " 40\nfive\n")), "CIRCLE"),
        (with_circle(lambda text: text.replace(" 10\n20.0\n", " 10\n1e999\n")), "CIRCLE"),
        (with_spline_without_knots(), "SPLINE"),
    ],
)
def test_what_cannot_be_read_is_left_out_and_told(tmp_path: Path, text: str, kind: str) -> None:
    (tmp_path / "a.dxf").write_text(text)
    drawing = read_shape(tmp_path / "a.dxf")
    assert area(drawing) == pytest.approx(PLATE_AREA)
    assert drawing.ignored == (f"1 unreadable {kind}",)


def test_a_dimension_with_its_block_is_only_passed_over(tmp_path: Path) -> None:
    (tmp_path / "a.dxf").write_text(with_dimension())
    drawing = read_shape(tmp_path / "a.dxf")
    assert (area(drawing), drawing.ignored) == (pytest.approx(PLATE_AREA), ("1 DIMENSION",))


def test_a_circle_of_any_size_is_flattened_in_time(tmp_path: Path) -> None:
    for radius in ("1e12", "1e30", "1e60"):
        (tmp_path / "a.dxf").write_text(with_circle(lambda text, to=radius: text.replace(" 40\n5.0\n", f" 40\n{to}\n")))  # type: ignore[misc]
        assert sum(map(len, read_shape(tmp_path / "a.dxf").loops)) < 200_000


def test_a_file_with_nothing_that_can_be_read_says_so(tmp_path: Path) -> None:
    made = ezdxf.new()
    made.modelspace().add_circle((0, 0), 5)
    (tmp_path / "a.dxf").write_text(text_of(made).replace(" 40\n5.0\n", " 40\nnan\n"))
    with pytest.raises(FileFormatError, match=r"there is no outline.* and 1 unreadable CIRCLE"):
        read_shape(tmp_path / "a.dxf")


LWPOLYLINE = "  0\nLWPOLYLINE\n  8\n0\n{}{} 90\n4\n 70\n1\n" + "".join(
    f" 10\n{x}\n 20\n{y}\n" for x, y in ((10, 10), (30, 10), (30, 30), (10, 30))
)


@pytest.mark.parametrize("version", ["R12", "R2000", "R2013"])
@pytest.mark.parametrize("markers", [("", ""), ("100\nAcDbEntity\n", "100\nAcDbPolyline\n"), ("100\nAcDbEntity\n", "")])
def test_polylines_of_any_version_are_read_with_and_without_markers(
    tmp_path: Path, version: str, markers: tuple[str, str]
) -> None:
    plate = text_of(document(version))
    at = plate.index("ENTITIES\n") + len("ENTITIES\n")
    (tmp_path / "a.dxf").write_text(plate[:at] + LWPOLYLINE.format(*markers) + plate[at:])
    drawing = read_shape(tmp_path / "a.dxf")
    assert area(drawing) == pytest.approx(PLATE_AREA - 400)
    assert drawing.ignored == ()


def closed_spline(degree: int, weights: list[float] | None = None) -> str:
    """Return a plate with a hole that is a closed spline, as CAD programs write it: the first points come again."""
    made = document()
    spline = made.modelspace().add_spline()
    ring = [(50 + 20 * np.cos(turn), 35 + 20 * np.sin(turn)) for turn in np.arange(7) * 2 * np.pi / 7]
    points = [*ring, *ring[:degree]]
    spline.dxf.degree, spline.closed = degree, True
    spline.control_points, spline.knots = [(x, y, 0) for x, y in points], range(len(points) + degree + 1)
    if weights:
        spline.weights = [*weights, *weights[:degree]]
    return text_of(made)


@pytest.mark.parametrize("degree", [2, 3, 4])
@pytest.mark.parametrize("weights", [None, [1, 2, 1, 3, 1, 1, 0.5]])
def test_a_closed_spline_is_closed(tmp_path: Path, degree: int, weights: list[float] | None) -> None:
    (tmp_path / "a.dxf").write_text(closed_spline(degree, weights))
    drawing = read_shape(tmp_path / "a.dxf", ReadOptions(flatten_mm=0.001))
    assert len(drawing.loops) == 2
    ring = np.array([(50 + 20 * np.cos(turn), 35 + 20 * np.sin(turn)) for turn in np.arange(7) * 2 * np.pi / 7])
    share = np.array(weights or [1.0] * 7)
    nodes = np.column_stack([ring * share[:, None], share])
    curve = BSpline(np.arange(7 + 2 * degree + 1), np.concatenate([nodes, nodes[:degree]]), degree)
    points = curve(np.linspace(degree, 7 + degree, 2000))
    hole = shapely.Polygon(points[:, :2] / points[:, 2:])
    assert area(drawing) == pytest.approx(PLATE_AREA - hole.area, abs=0.05)
    assert (
        shapely.hausdorff_distance(shapely.LinearRing(drawing.loops[1]), hole.exterior) < 0.03
    )  # ezdxf fits cubic curves


def test_a_trimmed_spline_is_the_same_curve() -> None:
    rng = np.random.default_rng(5)
    for degree, count in ((1, 4), (2, 3), (3, 9), (5, 8)):
        spline = ezdxf.new().modelspace().add_spline()
        points, knots = rng.random((count, 3)), np.sort(rng.random(count + degree + 1))
        spline.dxf.degree, spline.control_points, spline.knots = degree, points, knots
        trim_spline(spline)
        at = np.linspace(knots[degree], knots[count], 20)[:-1]
        trimmed = BSpline(np.array(spline.knots), np.array(spline.control_points), degree)
        np.testing.assert_allclose(trimmed(at), BSpline(knots, points, degree)(at), atol=1e-12)
        assert spline.knots[0] == spline.knots[degree] == knots[degree]


@pytest.mark.parametrize(("units", "gap", "enough"), [(4, 0.1, "0.101mm"), (1, 0.1, "2.55mm"), (0, 2.5, "2.51mm")])
def test_the_error_says_how_far_to_join_and_that_does(tmp_path: Path, units: int, gap: float, enough: str) -> None:
    made = ezdxf.new(units=units)
    corners = [*PLATE, (0, gap)]
    for one, other in pairwise(corners):
        made.modelspace().add_line(one, other)
    path = tmp_path / "a.dxf"
    path.write_text(text_of(made))
    with pytest.raises(FileFormatError, match=rf"with --join {re.escape(enough)}") as caught:
        read_shape(path)
    mm = float(re.search(r"--join ([0-9.]+)mm", str(caught.value))[1])  # type: ignore[index]
    assert area(read_shape(path, ReadOptions(join_mm=mm))) == pytest.approx(PLATE_AREA, rel=0.02)
    with pytest.raises(FileFormatError, match="a line ends at"):
        read_shape(path, ReadOptions(join_mm=0.98 * mm))
