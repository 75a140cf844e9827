"""Pictures of a pattern: the creases, the sheet folded flat, its layers drawn apart, and what the cut leaves.

Input: a ``FoldedPattern`` and the names of panels; output: SVG 1.1, one user unit is 1 mm, panels of ``PANEL_MM`` side
by side in rows of two. Strokes are thin enough for 100 mm and scale with the picture. Mountains are dash-dotted and
red, valleys dashed and blue, what is inside the shape is yellow.
"""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import svgwrite

from foldcut.errors import BadInputError
from foldcut.job import mountain_pieces, valley_pieces
from foldcut.model import Floats, FoldedPattern
from foldcut.molecules import Kind
from foldcut.plane import signed_area
from foldcut.profiles import Drawing, Profile

from .svg import path_data
from .text import number, printable

if TYPE_CHECKING:
    from foldcut.pipeline import PaperStages

PANEL_MM, GAP_MM, CAPTION_MM = 100.0, 8.0, 3.2
INSIDE, INSIDE_BACK, OUTSIDE, OUTSIDE_BACK = "#ffe08a", "#e6b93f", "#ffffff", "#cfd8e3"
SIDEWAYS, UPWARD = 0.45, 0.2
"""Layers apart are seen from the side: how much of the way along the cut line is left, and how far it climbs."""

Outline = tuple[Floats, str]
Stroke = tuple[Floats, str]


def check(show: Sequence[str], *, construction: bool = False) -> None:
    """Raise BadInputError unless all these are names of panels, of ``CONSTRUCTION`` only if there is one."""
    for name in show:
        if name not in {**PANELS, **CONSTRUCTION}:
            raise BadInputError(f"there is no picture {name!r}; choose of {', '.join([*PANELS, *CONSTRUCTION])}")
        if name in CONSTRUCTION and not construction:
            raise BadInputError(f"the picture {name} is of the paper's construction: it goes with --method paper")


def draw(
    pattern: FoldedPattern, show: Sequence[str], profile: Profile, stages: PaperStages | None = None
) -> tuple[bytes, tuple[float, float]]:
    """Return an SVG with a panel for each name in ``show``, and its width and height in mm.

    Raises BadInputError for a name that is not in ``PANELS``, nor, where the paper's ``stages`` are given, in
    ``CONSTRUCTION``.
    """
    check(show, construction=stages is not None)
    columns = min(2, len(show))
    rows = -(-len(show) // columns)
    height = PANEL_MM + CAPTION_MM * 2
    size = (columns * (PANEL_MM + GAP_MM) + GAP_MM, rows * (height + GAP_MM) + GAP_MM)
    drawing = svgwrite.Drawing(
        size=tuple(f"{number(side)}mm" for side in size),
        viewBox=f"0 0 {number(size[0])} {number(size[1])}",
        debug=False,
    )
    drawing.set_desc(title=printable(pattern.title) or "foldcut")
    for place, name in enumerate(show):
        if name in PANELS:
            caption, panel = PANELS[name]
            outlines, strokes = panel(pattern, profile.drawing)
        else:
            assert stages is not None
            caption, built = CONSTRUCTION[name]
            outlines, strokes = built(stages)
        corner = np.array([GAP_MM, GAP_MM]) + np.array([PANEL_MM + GAP_MM, height + GAP_MM]) * (
            place % columns,
            place // columns,
        )
        group = drawing.add(drawing.g(id=name))
        _fit(drawing, group, outlines, strokes, corner)
        below = (number(corner[0]), number(corner[1] + PANEL_MM + 1.5 * CAPTION_MM))
        group.add(
            drawing.text(caption, insert=below, font_size=number(CAPTION_MM), font_family="sans-serif", fill="#222")
        )
    text = ET.tostring(drawing.get_xml(), encoding="unicode")
    return f'<?xml version="1.0" encoding="utf-8"?>\n{text}\n'.encode(), size


def one_panel(outlines: list[Outline], strokes: list[Stroke]) -> bytes:
    """Return a picture of ``PANEL_MM`` square as SVG."""
    size = (f"{number(PANEL_MM)}mm",) * 2
    drawing = svgwrite.Drawing(size=size, viewBox=f"0 0 {number(PANEL_MM)} {number(PANEL_MM)}", debug=False)
    _fit(drawing, drawing, outlines, strokes, np.zeros(2))
    return ET.tostring(drawing.get_xml(), encoding="unicode").encode()


def _fit(drawing: svgwrite.Drawing, group: Any, outlines: list[Outline], strokes: list[Stroke], corner: Floats) -> None:
    """Draw filled outlines and then strokes, y up, as large as the panel at ``corner`` allows."""
    every = np.concatenate([points.reshape(-1, 2) for points, _ in [*outlines, *strokes]])
    low, extent = every.min(axis=0), np.ptp(every, axis=0)
    scale = PANEL_MM / float(extent.max())
    margin = (PANEL_MM - scale * extent) / 2

    def place(points: Floats) -> list[list[float]]:
        moved = (points - low) * scale + margin
        placed: list[list[float]] = (moved * (1, -1) + (0, PANEL_MM) + corner).tolist()
        return placed

    for points, colour in outlines:
        data = path_data(place(points), closed=True)
        group.add(drawing.path(d=data, fill=colour, stroke="#444", stroke_width="0.1", stroke_linejoin="round"))
    for points, colour in strokes:
        data = "".join(path_data(place(piece), closed=False) for piece in points)
        group.add(drawing.path(d=data, fill="none", stroke=colour, stroke_width="0.3"))


def _pieces(pattern: FoldedPattern) -> Iterable[tuple[int, bool, Floats, Floats]]:
    """Yield the faces' parts on either side of the cut line: face, whether inside, its corners flat and folded."""
    flat, folded = pattern.creases.vertices_coords, pattern.folded.vertices_coords
    for face, ring in enumerate(pattern.creases.faces_vertices.to_lists()):
        both = np.hstack([flat[ring], folded[ring]])
        for side in (1.0, -1.0):
            heights = side * both[:, 3]
            if heights.max() < 1e-9:
                continue
            corners = []
            for one, other, here, there in zip(
                both, np.roll(both, -1, axis=0), heights, np.roll(heights, -1), strict=True
            ):
                if here >= 0:
                    corners.append(one)
                if here * there < 0:
                    corners.append(one + (other - one) * (here / (here - there)))
            part = np.array(corners)
            yield face, side > 0, part[:, :2], part[:, 2:]


def _colour(inside: bool, folded: Floats) -> str:
    front = signed_area(folded) > 0
    return (INSIDE if front else INSIDE_BACK) if inside else (OUTSIDE if front else OUTSIDE_BACK)


def _creases(pattern: FoldedPattern, look: Drawing) -> tuple[list[Outline], list[Stroke]]:
    creases = pattern.creases
    lines = creases.vertices_coords[creases.edges_vertices]
    styles = (("M", mountain_pieces, look.mountain_colour), ("V", valley_pieces, look.valley_colour))
    drawn = [
        (pieces(line, look), colour)
        for letter, pieces, colour in styles
        for line in lines[creases.edges_assignment == letter]
    ]
    shape = [(loop, INSIDE if pattern.shape.depth(n) % 2 == 0 else OUTSIDE) for n, loop in _outer_first(pattern)]
    return [(pattern.sheet.corners, OUTSIDE), *shape], drawn


def _outer_first(pattern: FoldedPattern) -> list[tuple[int, Floats]]:
    return sorted(enumerate(pattern.shape.loops), key=lambda row: pattern.shape.depth(row[0]))


def _front(pattern: FoldedPattern, look: Drawing) -> tuple[list[Outline], list[Stroke]]:
    rank = np.argsort(pattern.folded.layers)
    parts = sorted(_pieces(pattern), key=lambda part: rank[part[0]])
    return [(folded, _colour(inside, folded)) for _, inside, _, folded in parts], [_cut_line(pattern)]


def _cut_line(pattern: FoldedPattern) -> Stroke:
    x = pattern.folded.vertices_coords[:, 0]
    over = 0.08 * np.ptp(x)
    return np.array([[[x.min() - over, 0.0], [x.max() + over, 0.0]]]), "#c00000"


def _apart(pattern: FoldedPattern, look: Drawing) -> tuple[list[Outline], list[Stroke]]:
    rank = np.argsort(pattern.folded.layers)
    size = float(np.ptp(pattern.folded.vertices_coords, axis=0).max())
    step = 1.6 * size / len(rank)
    side = np.array([[SIDEWAYS, UPWARD], [0.0, 1.0]])
    parts = sorted(_pieces(pattern), key=lambda part: rank[part[0]])
    outlines = [
        (folded @ side + (rank[face] * step, 0.0), _colour(inside, folded)) for face, inside, _, folded in parts
    ]
    first = float(pattern.folded.vertices_coords[:, 0].min())
    spine = np.array([[first * SIDEWAYS - step, first * UPWARD], [first * SIDEWAYS + len(rank) * step, first * UPWARD]])
    return outlines, [(spine[None], "#c00000")]


def _after(pattern: FoldedPattern, look: Drawing) -> tuple[list[Outline], list[Stroke]]:
    aside = np.array([1.06 * pattern.sheet.width, 0.0])
    return [(flat + aside * inside, INSIDE if inside else OUTSIDE) for _, inside, flat, _ in _pieces(pattern)], []


PANELS: dict[str, tuple[str, Callable[[FoldedPattern, Drawing], tuple[list[Outline], list[Stroke]]]]] = {
    "pattern": ("Dash-dotted, red: mountain. Dashed, blue: valley.", _creases),
    "folded": ("Folded flat; the red line is the cut.", _front),
    "layers": ("The layers drawn apart, seen from the side.", _apart),
    "pieces": ("After the cut, unfolded: the rest and the shape.", _after),
}


CIRCLE = np.array([[math.cos(a), math.sin(a)] for a in np.linspace(0, 2 * math.pi, 49)])
THREE, FOUR = "#dcebdc", "#f6d9c9"


def _packing(stages: PaperStages) -> tuple[list[Outline], list[Stroke]]:
    """The disks, and the gaps between them: paper section 2, Figure 1."""
    packing = stages.packing
    circles = packing.centres[:, None] + packing.radii[:, None, None] * CIRCLE
    gaps = [(packing.centres[gap], THREE if len(gap) == 3 else FOUR) for gap in packing.gaps]
    count = packing.boundary_count
    drawn = [(circles[:count], "#1b5e9e"), (circles[count:], "#888888"), *_loops(stages)]
    return gaps, [(pieces, colour) for pieces, colour in drawn if len(pieces)]


def _loops(stages: PaperStages) -> list[Stroke]:
    """The boundary of the shape, of which each node's first disk is taken."""
    centre = dict(zip(stages.packing.node.tolist()[::-1], stages.packing.centres.tolist()[::-1], strict=True))
    loops = [[centre[node] for node in loop.tolist()] for loop in stages.packing.loop_nodes]
    return [(np.array([[*loop, loop[0]]]), "#c00000") for loop in loops[1:]]


def _molecules(stages: PaperStages) -> tuple[list[Outline], list[Stroke]]:
    """Each molecule with its bisectors, tangency edges and gussets: paper section 3, Figures 2 to 4."""
    molecules = stages.molecules
    gaps = [(molecules.vertices[row], THREE if len(row) == 3 else FOUR) for row in molecules.corners]
    lines = molecules.vertices[molecules.creases]
    colours = {Kind.BISECTOR: "#b3001b", Kind.TANGENCY: "#0b4f9e", Kind.DIAGONAL: "#117733", Kind.SIDE: "#666666"}
    kinds = [(lines[molecules.crease_kind == kind], colour) for kind, colour in colours.items()]
    return gaps, [(some, colour) for some, colour in kinds if len(some)]


def _trees(stages: PaperStages) -> tuple[list[Outline], list[Stroke]]:
    """T_C over the corners and T_M over the molecules: paper section 4, Figure 5."""
    molecules, assignment = stages.molecules, stages.assignment
    gaps = [(molecules.vertices[row], "#ffffff") for row in molecules.corners]
    middles = np.array([molecules.vertices[row].mean(axis=0) for row in molecules.corners])
    children = np.flatnonzero(assignment.parent >= 0)
    of_molecules = np.stack([middles[children], middles[assignment.parent[children]]], axis=1)
    feet = set(assignment.corner_tree[:, 1].tolist())
    sides = molecules.creases[molecules.crease_kind == Kind.SIDE]
    halves = np.array([side for side in sides.tolist() if feet & set(side)], dtype=int).reshape(-1, 2)
    drawn = [(molecules.vertices[halves], "#c00000"), (of_molecules, "#0b4f9e")]
    return gaps, [(some, colour) for some, colour in drawn if len(some)]


def _ribbon(stages: PaperStages) -> tuple[list[Outline], list[Stroke]]:
    """The strip along the boundary that stays unfolded: paper section 5, Figure 7."""
    molecules = stages.molecules
    strip = [
        (molecules.vertices[row], "#ffe08a")
        for row, owner in zip(molecules.facets, molecules.facet_molecule.tolist(), strict=True)
        if owner < 0
    ]
    gaps = [(molecules.vertices[row], "#ffffff") for row in molecules.corners]
    across = molecules.vertices[molecules.creases[molecules.crease_kind == Kind.RIBBON]]
    return [*gaps, *strip], [(across, "#b3001b")] if len(across) else []


CONSTRUCTION: dict[str, tuple[str, Callable[[PaperStages], tuple[list[Outline], list[Stroke]]]]] = {
    "packing": ("Disks and gaps: three-sided green, four-sided orange.", _packing),
    "molecules": ("Molecules: bisectors red, tangency edges blue, gussets green.", _molecules),
    "trees": ("The tree of corners, red, and of molecules, blue.", _trees),
    "ribbon": ("The ribbon along the cut, and the creases across it.", _ribbon),
}
