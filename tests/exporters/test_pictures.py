"""The pictures: every face is there, in its colour, in the order of the layers, as svgelements reads them."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import pytest
import shapely
import svgelements
from numpy.testing import assert_allclose
from PIL import Image
from support.folded import folded_sample

from foldcut.cli.main import main
from foldcut.core.arrays import Floats
from foldcut.core.errors import BadInputError
from foldcut.core.model import FoldedPattern
from foldcut.exporters.pictures.pictures import CONSTRUCTION, INSIDE, INSIDE_BACK, OUTSIDE, OUTSIDE_BACK, draw
from foldcut.methods.disks.method import DiskStages
from foldcut.methods.disks.molecules import Kind
from foldcut.pipeline import fold
from foldcut.profiles import load_profile
from foldcut.samples import sample_path

YELLOW, WHITE = {INSIDE, INSIDE_BACK}, {OUTSIDE, OUTSIDE_BACK}


def folded(sample: str) -> FoldedPattern:
    """Fold a sample on A4."""
    return folded_sample(sample)


def outlines(pattern: FoldedPattern, panel: str) -> list[tuple[shapely.Polygon, str]]:
    """Return the filled polygons of a panel with their colours, in drawing order, as svgelements reads them."""
    data, _ = draw(pattern, [panel], load_profile())
    drawing = svgelements.SVG.parse(io.BytesIO(data), ppi=25.4)
    (group,) = drawing.elements(lambda e: isinstance(e, svgelements.Group) and e.id == panel)
    paths = [p for p in group.select() if isinstance(p, svgelements.Path) and p.fill.value is not None]
    return [(shapely.Polygon([(q.x, q.y) for q in path.as_points()]), path.fill.hex) for path in paths]


def part_count(heights: Floats) -> int:
    """In how many parts the cut line divides a face with corners of these heights over it."""
    return int(heights.max() > 1e-9) + int(heights.min() < -1e-9)


@pytest.mark.parametrize("sample", ["fish", "ring", "letter-a", "two-triangles"])
def test_the_pieces_after_the_cut_are_the_shape_and_the_rest(sample: str) -> None:
    pattern = folded(sample)
    drawn = outlines(pattern, "pieces")
    areas = np.array([sum(polygon.area for polygon, fill in drawn if fill in some) for some in (YELLOW, WHITE)])
    shape = sum(
        shapely.Polygon(loop).area * (-1) ** pattern.shape.depth(n) for n, loop in enumerate(pattern.shape.loops)
    )
    ratio = shape / (pattern.sheet.width * pattern.sheet.height)
    assert areas[0] / areas.sum() == pytest.approx(ratio, rel=1e-4)


@pytest.mark.parametrize("panel", ["folded", "layers"])
def test_every_face_is_drawn_and_each_half_of_it_is_on_its_side_of_the_cut(panel: str) -> None:
    pattern = folded("fish")
    drawn = outlines(pattern, panel)
    heights = pattern.folded.vertices_coords[:, 1]
    rings = pattern.creases.faces_vertices.to_lists()
    assert len(drawn) == sum(part_count(heights[ring]) for ring in rings)
    assert {fill for _, fill in drawn} == YELLOW | WHITE
    if panel == "folded":  # y points down: the shape is above the cut
        assert max(p.bounds[3] for p, fill in drawn if fill in YELLOW) == pytest.approx(
            min(p.bounds[1] for p, fill in drawn if fill in WHITE), abs=1e-3
        )


@pytest.mark.parametrize("end", [0, -1])
def test_the_lowest_face_is_drawn_first_and_the_highest_last(end: int) -> None:
    pattern = folded("fish")
    drawn = [polygon.area for polygon, _ in outlines(pattern, "folded")]
    points, faces = pattern.folded.vertices_coords, pattern.creases.faces_vertices.to_lists()
    areas = [shapely.Polygon(points[ring]).area for ring in faces]
    face = pattern.folded.layers[end]
    parts = part_count(points[faces[face], 1])
    its = sum(drawn[:parts] if end == 0 else drawn[-parts:])
    assert its / sum(drawn) == pytest.approx(areas[face] / sum(areas), rel=1e-3)
    assert sum(area == pytest.approx(areas[face], rel=1e-3) for area in areas) == 1


def test_all_panels_are_on_one_picture_and_png_has_its_size(tmp_path: Path) -> None:
    out = tmp_path / "ring.png"
    assert main(["draw", "ring", "--effort", "fast", "-o", str(out), "--quiet"]) == 0
    _, size = draw(folded("ring"), ["pattern", "folded", "layers", "pieces"], load_profile())
    with Image.open(out) as image:
        assert_allclose(np.array(image.size) / 200 * 25.4, size, atol=0.2)
        assert len(image.getcolors(maxcolors=2**24) or []) > 50


def test_unknown_pictures_and_formats_are_errors(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(BadInputError, match=r"no picture 'x'; choose from pattern, folded, layers, pieces, "):
        draw(folded("ring"), ["x"], load_profile())
    assert main(["draw", "ring", "--show", "x"]) == 2
    assert main(["draw", "ring", "-o", str(tmp_path / "a.dxf")]) == 2
    assert "pictures are SVG or PNG" in capsys.readouterr().err


def test_the_construction_is_drawn_with_every_disk_molecule_and_tree() -> None:
    result = fold(sample_path("triangle"), method="paper", ribbon=1.0)
    stages = result.stages
    assert isinstance(stages, DiskStages)
    data, _ = draw(result.folded_pattern, list(CONSTRUCTION), load_profile(), stages)
    drawing = svgelements.SVG.parse(io.BytesIO(data), ppi=25.4)
    groups = {
        g.id: list(g.select())
        for g in drawing.elements(lambda e: isinstance(e, svgelements.Group))
        if g.id in CONSTRUCTION
    }
    count = len(stages.packing.gaps)

    def pieces(panel: str, colour: str) -> int:
        """Count the polylines of one colour."""
        paths = [p for p in groups[panel] if isinstance(p, svgelements.Path) and p.stroke.hex == colour]
        return sum(len(list(path.as_subpaths())) for path in paths)

    filled = {
        panel: sum(isinstance(p, svgelements.Path) and p.fill.value is not None for p in paths)
        for panel, paths in groups.items()
    }
    strip = int((stages.molecules.facet_molecule < 0).sum())
    dots = len(stages.assignment.roots)
    assert filled == {
        "packing": count,
        "molecules": count,
        "rabbit-ear": 1 + 1 + 6,  # the triangle, the plane, the facets
        "gusset": 2 + 2 + 1 + 12,  # and the gusset and its two perpendicular points
        "inset": 2 + 1 + 4,
        "trees": count + dots,
        "matching": count,
        "ribbon": count + strip,
    }
    assert pieces("packing", "#1b5e9e") + pieces("packing", "#888888") == len(stages.packing.radii)
    four = sum(len(gap) == 4 for gap in stages.packing.gaps)
    assert pieces("packing", "#e08a4a") >= four > 0  # those that reach over the edge are cut off there
    reversed_sides = (stages.molecules.crease_kind == Kind.SIDE) & (stages.assignment.crease_assignment == "M")
    assert pieces("matching", "#c00000") == reversed_sides.sum() == len(stages.assignment.corner_tree)
    assert pieces("trees", "#0b4f9e") == count - dots  # two roots
    assert pieces("trees", "#c00000") == 2 * len(stages.assignment.corner_tree)


def test_the_construction_goes_with_the_papers_method(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["draw", "triangle", "--show", "packing"]) == 2
    assert "goes with --method paper" in capsys.readouterr().err
