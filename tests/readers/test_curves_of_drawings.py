"""Readers hand on the curves that loops were flattened from, in the order of the loops."""

from __future__ import annotations

import io
import math
from collections.abc import Callable
from typing import Any

import ezdxf
import numpy as np
import pytest
from reportlab.pdfgen.canvas import Canvas
from support.places import SAMPLES

from foldcut.drawing.curved import curves_of
from foldcut.drawing.mend import Preparation, prepare
from foldcut.drawing.shape import make_shape
from foldcut.geometry.curves import Arc, Bezier, CurvedLoop, Line, farthest_apart
from foldcut.geometry.vectors import signed_area
from foldcut.readers import Drawing, ReadOptions, read_shape
from foldcut.readers.typed_text import draw_text


def svg(body: str, box: str = "0 0 100 100") -> Drawing:
    return read_shape("a.svg", data=f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{box}">{body}</svg>'.encode())


def dxf(draw: Callable[[Any], object]) -> Drawing:
    document = ezdxf.new("R2010", units=4)
    draw(document.modelspace())
    text = io.StringIO()
    document.write(text)
    return read_shape("a.dxf", data=text.getvalue().encode())


def pdf(draw: Callable[[Any], object]) -> Drawing:
    pytest.importorskip("pypdfium2")
    data = io.BytesIO()
    canvas = Canvas(data, pagesize=(200, 200))
    draw(canvas)
    canvas.showPage()
    canvas.save()
    return read_shape("a.pdf", data=data.getvalue())


def kinds(curve: CurvedLoop) -> set[str]:
    return {type(segment).__name__ for segment in curve.segments}


def faults(drawing: Drawing) -> list[str]:
    """Where curves are not what the loops were flattened from."""
    if len(drawing.curves) != len(drawing.loops):
        return [f"{len(drawing.curves)} curves of {len(drawing.loops)} loops"]
    most = 1.1 * 0.05 * max(drawing.size) / 200  # ezdxf looks at the middle of each chord only
    wrong = []
    for number, (curve, loop) in enumerate(zip(drawing.curves, drawing.loops, strict=True)):
        ends = np.array([one.end for one in curve.segments])
        starts = np.array([one.start for one in curve.segments])
        if np.abs(ends - np.roll(starts, -1, axis=0)).max() > 1e-9 * max(drawing.size):
            wrong.append(f"curve {number} is not closed")
        if farthest_apart([curve], [loop], 1e-6 * max(drawing.size))[0] > most:
            wrong.append(f"curve {number} is not at its loop")
        if signed_area(curve.flattened(most)) * signed_area(loop) <= 0:
            wrong.append(f"curve {number} runs the other way around")
    return wrong


SVGS = {
    "circle": ('<circle cx="50" cy="40" r="30"/>', {"Arc"}),
    "ellipse, turned": ('<ellipse cx="5" cy="4" rx="30" ry="10" transform="translate(40 40) rotate(30)"/>', {"Arc"}),
    "sheared circle": ('<circle r="20" transform="matrix(1 .5 .3 1 40 40)"/>', {"Arc"}),
    "rounded": ('<rect x="10" y="10" width="60" height="40" rx="12" ry="7"/>', {"Arc", "Line"}),
    "cubics": ('<path d="M50 10C90 20 70 60 50 90S20 20 50 10Z"/>', {"Bezier"}),
    "quadratics": ('<path d="M50 10Q90 20 70 60T20 20"/>', {"Bezier", "Line"}),
    "arcs": ('<path d="M20 50A30 20 20 1 1 70 60A40 30 10 0 1 20 50Z"/>', {"Arc"}),
    "clone in a group": (
        '<defs><path id="a" d="M0 0C9 1 9 9 0 9Z"/></defs><g transform="scale(-3 4)"><use href="#a" x="-20"/></g>',
        {"Bezier", "Line"},
    ),
    "stroked arcs, end to end": (
        '<g fill="none" stroke="black"><path d="M20 50A30 30 0 0 1 80 50"/><path d="M20 50A30 15 0 0 0 80 50"/></g>',
        {"Arc"},
    ),
    "a curve and lines, end to end": (
        '<g fill="none" stroke="black"><path d="M80 50L50 90L20 50"/><path d="M20 50C20 0 80 0 80 50"/></g>',
        {"Bezier", "Line"},
    ),
}


@pytest.mark.parametrize("name", sorted(SVGS))
def test_curves_of_svg(name: str) -> None:
    body, expected = SVGS[name]
    drawing = svg(body)
    assert faults(drawing) == []
    assert kinds(drawing.curves[0]) == expected


def test_a_circle_of_an_svg_is_one_exactly() -> None:
    drawing = svg('<circle cx="50" cy="40" r="30"/><circle cx="50" cy="40" r="10"/>')
    for curve, radius in zip(drawing.curves, (30, 10), strict=True):
        arcs = [one for one in curve.segments if isinstance(one, Arc)]
        assert [one.radius for one in arcs] == pytest.approx([radius] * len(arcs))
        assert np.array([one.centre for one in arcs]) == pytest.approx(np.array([(50.0, -40.0)] * len(arcs)))
        assert sum(one.sweep for one in arcs) == pytest.approx(math.copysign(math.tau, arcs[0].sweep))


CUT = {
    "two circles": ('<circle cx="20" cy="20" r="10"/><circle cx="30" cy="20" r="10"/>', [("Arc", 0.9)]),
    "disc and rounded box": (
        '<circle cx="50" cy="40" r="30"/><rect x="20" y="40" width="60" height="40" rx="5"/>',
        [("Arc", 0.5)],
    ),
    "one outline that crosses itself": (
        '<path d="M20 50A30 20 20 1 1 70 60A10 30 0 0 0 20 50Z"/>',
        [("Arc", 0.8), ("Arc", 0.8), ("Arc", 0.6)],
    ),
    "four petals": (
        '<path d="M10 50C10 10 90 10 90 50S10 90 10 50Z"/><path d="M50 0C60 20 60 60 50 100S40 20 50 0Z"/>',
        [("Bezier", 0.9)],
    ),
    "the same twice": ('<circle cx="20" cy="20" r="10"/><circle cx="20" cy="20" r="10"/>', [("Arc", 1.0)]),
    "boxes beside a disc": (
        '<rect width="20" height="10"/><rect x="10" y="5" width="20" height="10"/><circle cx="70" cy="70" r="9"/>',
        [("Line", 1.0), ("Arc", 1.0)],
    ),
}


@pytest.mark.parametrize("name", sorted(CUT))
def test_loops_that_were_cut_out_of_others_keep_what_is_left_of_their_curves(name: str) -> None:
    body, expected = CUT[name]
    drawing = svg(body)
    assert faults(drawing) == []
    assert len(drawing.curves) == len(expected)
    for curve, (kind, share) in zip(drawing.curves, expected, strict=True):
        lengths = {"Arc": 0.0, "Bezier": 0.0, "Line": 0.0}
        for segment in curve.segments:
            points = segment.points(np.linspace(0, 1, 50))
            lengths[type(segment).__name__] += float(np.hypot(*np.diff(points, axis=0).T).sum())
        assert lengths[kind] >= 0.999 * share * sum(lengths.values())


def test_curves_of_dxf_are_found_again_in_what_was_cut() -> None:
    def draw(space: Any) -> None:
        space.add_circle((5, 7), 3)
        space.add_ellipse((9, 8), (5, 1), 0.5)

    drawing = dxf(draw)
    assert faults(drawing) == []
    assert len(drawing.curves) == 1
    assert {type(one) for one in drawing.curves[0].segments} == {Arc, Bezier, Line}


@pytest.mark.parametrize(("start", "sweep"), [(0, 360), (30, 80), (200, 300)])
def test_arcs_of_a_dxf_are_arcs_of_circles(start: float, sweep: float) -> None:
    def draw(space: Any) -> None:
        if sweep == 360:
            space.add_circle((5, 7), 30)
        else:
            arc = space.add_arc((5, 7), 30, start, start + sweep)
            space.add_line(arc.start_point, arc.end_point)

    drawing = dxf(draw)
    arcs = [one for one in drawing.curves[0].segments if isinstance(one, Arc)]
    assert [one.radius for one in arcs] == pytest.approx([30.0] * len(arcs))
    assert np.array([one.centre for one in arcs]) == pytest.approx(np.array([(5.0, 7.0)] * len(arcs)))
    assert abs(sum(one.sweep for one in arcs)) == pytest.approx(math.radians(sweep))


def test_a_drawing_of_lines_has_no_curves() -> None:
    assert svg('<path d="M0 0L9 0L5 7Z"/><rect x="30" y="30" width="5" height="9"/>').curves == ()
    assert read_shape(SAMPLES / "star.svg").curves == ()


@pytest.mark.parametrize("text", ["S", "B", "8g"])
def test_curves_of_letters(text: str) -> None:
    drawing = draw_text(text)
    assert faults(drawing) == []
    assert any("Bezier" in kinds(curve) for curve in drawing.curves)


def arcs_and_lines(space: Any) -> None:
    space.add_arc((50, 50), 20, 0, 180)
    space.add_line((30, 50), (30, 10))
    space.add_line((70, 10), (30, 10))
    space.add_line((70, 10), (70, 50))


@pytest.mark.parametrize(
    "draw",
    [
        lambda space: space.add_circle((5, 7), 3),
        lambda space: space.add_ellipse((5, 7), (9, 3), 0.4),
        lambda space: space.add_lwpolyline([(0, 0, 0.5), (10, 0, 0), (10, 10, -0.3), (0, 10, 0)], "xyb", close=True),
        lambda space: space.add_spline([(0, 0), (10, 0), (10, 10), (0, 8), (0, 0)]),
        arcs_and_lines,
    ],
    ids=["circle", "ellipse", "bulges", "spline", "arcs and lines"],
)
def test_curves_of_dxf(draw: Callable[[Any], object]) -> None:
    drawing = dxf(draw)
    assert faults(drawing) == []
    assert kinds(drawing.curves[0]) & {"Arc", "Bezier"}


def test_curves_of_pdf() -> None:
    def draw(canvas: Any) -> None:
        canvas.circle(100, 100, 50, fill=1)
        canvas.translate(20, 10)
        canvas.rect(0, 0, 20, 20, fill=1)

    drawing = pdf(draw)
    assert faults(drawing) == []
    assert [kinds(curve) for curve in drawing.curves] == [{"Bezier"}, {"Line"}]


def test_the_comparison_can_fail() -> None:
    drawing = svg('<circle cx="50" cy="40" r="30"/>')
    moved = CurvedLoop(tuple(s.transformed(np.array([(1, 0, 0.1), (0, 1, 0)])) for s in drawing.curves[0].segments))
    for wrong in (moved, drawing.curves[0].reversed(), CurvedLoop(drawing.curves[0].segments[:1])):
        assert faults(Drawing(drawing.loops, None, "", curves=(wrong,))) != []


MANY = '<path d="M5 5C5 60 60 60 60 5Z"/><circle cx="30" cy="20" r="8"/><path d="M70 70L90 70L90 95L80 95L70 95Z"/>'


@pytest.mark.parametrize("mirrored", [False, True])
def test_the_loops_of_a_shape_get_their_curves(mirrored: bool) -> None:
    drawing = svg(MANY)
    loops = prepare(drawing.loops, Preparation(mirror=mirrored)).loops
    shape = make_shape(loops)
    curves = curves_of(shape, drawing.loops, drawing.curves, mirrored=mirrored)
    for curve, loop, expected in zip(curves, shape.loops, [Bezier, Arc, Line], strict=True):
        assert any(isinstance(segment, expected) for segment in curve.segments)
        assert farthest_apart([curve], [loop])[0] < 0.03
        assert signed_area(curve.flattened(0.1)) > 0


def test_a_loop_that_mending_changed_loses_its_curves() -> None:
    drawing = svg(MANY + '<path d="M10 80C10 60 40 60 40 80L25 95Z"/>')
    cut = [loop + np.array((0.0, 12.0 * (number == 2))) for number, loop in enumerate(drawing.loops)]
    cut[3] = cut[3][: len(cut[3]) // 2]
    curves = curves_of(make_shape(cut), drawing.loops, drawing.curves)
    assert [curve.is_straight for curve in curves] == [False, False, True, True]
    assert farthest_apart([curves[3]], [cut[3]])[0] < 1e-9


def test_shapes_without_curves_are_polygons() -> None:
    drawing = read_shape(SAMPLES / "star.svg", ReadOptions())
    shape = make_shape(drawing.loops)
    curves = curves_of(shape, drawing.loops, drawing.curves)
    assert [np.array_equal(one.flattened(1.0), loop) for one, loop in zip(curves, shape.loops, strict=True)] == [True]
