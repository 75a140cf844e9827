"""Pictures of a pattern: the creases, the sheet folded flat, its layers drawn apart, and what the cut leaves.

Input: a ``FoldedPattern`` and the names of panels; output: SVG (see ``panels``). Mountains are dash-dotted and red,
valleys dashed and blue; the inside of the shape is yellow. Where the outline is not the drawing, the latter is grey.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from textwrap import wrap
from typing import TYPE_CHECKING

import numpy as np
import shapely

from foldcut.core.arrays import Floats
from foldcut.core.errors import BadInputError
from foldcut.core.model import FoldedPattern, Shape, Sheet
from foldcut.geometry.vectors import signed_area
from foldcut.pattern.cut_line import pieces_of
from foldcut.profiles import LineStyle, Profile

from .construction import CONSTRUCTION
from .panels import BOLD, EDGE, EDGE_COLOUR, Item, Key, Panel, faces, fine, laid_out, mountain, valley

if TYPE_CHECKING:
    from foldcut.methods.disks.method import DiskStages
    from foldcut.redraw.ladder import Ladder, Level

INSIDE = "#ffe08a"
"""The colour of the shape's front."""

INSIDE_BACK = "#e6b93f"
"""The colour of the shape's back."""

PIECES = (INSIDE, "#bfe3c0", "#f6c6b8", "#c9d6f2", "#e5cdea", "#d9d3b8")
"""The colours of the pieces of a graph, in turns."""

EMPTY = "#8a8a8a"
"""The colour of what is cut out of a piece."""

APART = 0.15
"""How much farther from each other pieces of a graph are drawn than they are."""

TOUCHING = 1e-6
"""Lines that are this near to the boundary of a piece, in mm, lie along it."""

OUTSIDE = "#ffffff"
"""The colour of the front of the sheet around the shape."""

OUTSIDE_BACK = "#cfd8e3"
"""The colour of the back of the sheet around the shape."""

CUT = "#c00000"
"""The colour of the cut."""

DRAWN = "#8a8a8a"
"""The colour of the drawing where the outline is another."""

CUT_OUT = "#000000"
"""The colour of the outline that the cut cuts out, beside the drawing's."""

LADDER = "ladder"
"""The name of the pictures of all tolerances that were tried, side by side."""

LADDER_COLUMNS = 3
"""How many of these are in a row."""

THIN = 0.2
"""The width of the drawing's line, in mm."""

UNDER, BROAD = "#d4d4d4", 1.2
"""The colour and the width, in mm, of the lines of a graph under the creases that lie on them."""

FIRM = 0.45
"""The width of the line of the outline that is cut out, in mm."""

WORDS = 60
"""The letters in a line of words under a picture."""

LINES = 3
"""The lines of words under a picture of an outline that has no pattern."""

SIDEWAYS = 0.45
"""How much layers drawn apart are foreshortened along the cut line, since they are seen from the side."""

UPWARD = 0.2
"""How far the cut line of layers drawn apart climbs, as a fraction of its length."""


def check(show: Sequence[str], *, construction: bool = False) -> None:
    """Raise BadInputError unless these are names of panels; those of ``CONSTRUCTION`` need a construction."""
    known = [*PANELS, LADDER, *CONSTRUCTION]
    for name in show:
        if name not in known:
            raise BadInputError(f"there is no picture {name!r}; choose from {', '.join(known)}")
        if name in CONSTRUCTION and not construction:
            raise BadInputError(f"the picture {name} is of the paper's construction: it goes with --method paper")


def draw(
    pattern: FoldedPattern,
    show: Sequence[str],
    profile: Profile,
    stages: DiskStages | None = None,
    ladder: Ladder | None = None,
) -> tuple[bytes, tuple[float, float]]:
    """Return an SVG with a panel for each name in ``show``, and its width and height in mm.

    ``stages``: those of the disk method, if it made the pattern; ``ladder``: all tolerances that were tried, of which
    each gets a panel. Raises BadInputError for a name that is neither in ``PANELS`` nor, given ``stages``, in
    ``CONSTRUCTION``, nor, given ``ladder``, is ``LADDER``.
    """
    check(show, construction=stages is not None)
    panels = []
    for name in show:
        if name == LADDER:
            if ladder is None:
                raise BadInputError("a pattern that was folded before has no ladder; give the drawing")
            panels += [(f"{LADDER}-{n}", panel) for n, panel in enumerate(_levels(ladder, profile.drawing), start=1)]
        elif name in PANELS:
            panels.append((name, PANELS[name](pattern, profile.drawing)))
        else:
            assert stages is not None
            panels.append((name, CONSTRUCTION[name](stages, profile.drawing)))
    return laid_out(panels, pattern.title, LADDER_COLUMNS if LADDER in show else 2)


def pieces(pattern: FoldedPattern) -> Iterable[tuple[int, bool, Floats, Floats]]:
    """Yield the parts of faces on either side of the cut: face, whether inside the shape, corners flat and folded."""
    flat, folded = pattern.creases.vertices_coords, pattern.folded.vertices_coords
    for face, outline in enumerate(pattern.creases.faces_vertices.to_lists()):
        both = np.hstack([flat[outline], folded[outline]])
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


def coloured(inside: bool, folded: Floats) -> str:
    """Return the colour of a part of a face as it lies: of its front, or of its back."""
    front = signed_area(folded) > 0
    return (INSIDE if front else INSIDE_BACK) if inside else (OUTSIDE if front else OUTSIDE_BACK)


def outlines(pattern: FoldedPattern, look: LineStyle) -> Panel:
    """Draw the outline that is cut out, and over it the drawing, if that is another."""
    what = "the lines that are cut" if pattern.shape.is_graph else "the outline that is cut out"
    keys = [Key(what, stroke=CUT_OUT, width=FIRM)]
    keys += [Key("the drawing", stroke=DRAWN)] if pattern.drawn else []
    lines = _outlines(pattern.shape, pattern.drawn)
    return Panel([faces([pattern.sheet.corners], OUTSIDE), *_filled(pattern.shape), *lines], keys)


def _filled(shape: Shape) -> list[Item]:
    """Return the shape, yellow, with its holes."""
    loops = sorted(enumerate(shape.loops), key=lambda row: shape.depth(row[0]))
    return [faces([loop], INSIDE if shape.depth(n) % 2 == 0 else OUTSIDE) for n, loop in loops]


def _outlines(shape: Shape, drawn: Sequence[Floats]) -> list[Item]:
    """Return the lines of the outline, and over them those of the drawing, if that is another."""
    before = [Item(drawn, stroke=DRAWN, width=THIN, closed=True)] if drawn else []
    cut = [Item(list(shape.loops), stroke=CUT_OUT, width=FIRM, closed=True)] if shape.loops else []
    cut += [Item(list(shape.lines), stroke=CUT_OUT, width=FIRM)] if shape.lines else []
    return [*cut, *before]


def _levels(ladder: Ladder, look: LineStyle) -> list[Panel]:
    """Draw each tolerance that was tried: outlines, creases, and below what it costs."""
    return [_level(level, look, taken=number == ladder.taken) for number, level in enumerate(ladder.levels)]


def _level(level: Level, look: LineStyle, *, taken: bool) -> Panel:
    """Draw one tolerance; without a pattern, only say why there is none."""
    name = f"within {level.tolerance_mm:.3g} mm" if level.tolerance_mm else "as drawn"
    pattern = level.pattern
    if pattern is None or level.folds is None or level.shortest_mm is None:
        words = wrap(level.failure, WORDS, max_lines=LINES, placeholder=" ...")
        keys = [Key(f"{name}: no pattern"), *map(Key, words)]
        if level.laid is None:
            return Panel([faces([Sheet(1.0, 1.0).corners], OUTSIDE)], keys)
        shape = level.laid.shape
        sheet = faces([level.laid.sheet.corners], OUTSIDE)
        return Panel([sheet, *_filled(shape), *_outlines(shape, level.drawn)], keys)
    lines = pattern.creases.vertices_coords[pattern.creases.edges_vertices]
    kinds = pattern.creases.edges_assignment
    drawn = [
        Item(list(lines[kinds == letter]), stroke=colour, width=EDGE)
        for letter, colour in (("M", look.mountain_colour), ("V", look.valley_colour))
        if (kinds == letter).any()
    ]
    hands = "for two hands" if level.for_hands else "not for two hands"
    cost = f"{level.off_by_mm:.2g} mm off, {level.folds} folds, shortest {level.shortest_mm:.3g} mm"
    keys = [Key(f"{name}{': taken' if taken else ''}"), Key(cost), Key(f"{level.layers} layers at the cut, {hands}")]
    outline = _outlines(pattern.shape, pattern.drawn)
    return Panel([faces([pattern.sheet.corners], OUTSIDE), *_filled(pattern.shape), *drawn, *outline], keys)


def creases(pattern: FoldedPattern, look: LineStyle) -> Panel:
    """Draw the crease pattern."""
    kinds = pattern.creases.edges_assignment
    lines = pattern.creases.vertices_coords[pattern.creases.edges_vertices]
    folded = np.isin(kinds, ("M", "V"))
    width = fine(lines[folded], max(pattern.sheet.width, pattern.sheet.height))
    sheet = faces([pattern.sheet.corners], OUTSIDE)
    shape = _filled(pattern.shape)
    before = [Item(pattern.drawn, stroke=DRAWN, width=THIN, closed=True)] if pattern.drawn else []
    styles = (
        ("M", look.mountain_colour, mountain(look), "mountain: fold away from you"),
        ("V", look.valley_colour, valley(look), "valley: fold toward you"),
    )
    drawn = [
        Item(list(lines[kinds == letter]), stroke=colour, width=width, dash=dash)
        for letter, colour, dash, _ in styles
        if (kinds == letter).any()
    ]
    keys = [Key(text, stroke=colour, dash=dash) for _, colour, dash, text in styles]
    drawing = [Key("the drawing", stroke=DRAWN)] if pattern.drawn else []
    filled = [Key("over the cut" if pattern.shape.is_graph else "the shape", fill=INSIDE)] if shape else []
    graph = pattern.shape.is_graph
    cut = [Item(list(pattern.shape.strokes), stroke=UNDER, width=BROAD)] if graph else []
    return Panel([sheet, *shape, *before, *cut, *drawn], [*keys, *filled, *drawing])


def _sides(shape: Shape) -> list[Key]:
    """Say what the colours of both sides of the sheet mean."""
    inside, outside = ("over the cut", "under it") if shape.is_graph else ("the shape", "around it")
    return [
        Key(f"{inside}, front", fill=INSIDE),
        Key("back", fill=INSIDE_BACK),
        Key(f"{outside}, front", fill=OUTSIDE),
        Key("back", fill=OUTSIDE_BACK),
    ]


def front(pattern: FoldedPattern, look: LineStyle) -> Panel:
    """Draw the folded sheet from the front, and where to cut."""
    rank = np.argsort(pattern.folded.layers)
    parts = sorted(pieces(pattern), key=lambda part: rank[part[0]])
    x = pattern.folded.vertices_coords[:, 0]
    over = 0.08 * np.ptp(x)
    line = np.array([[x.min() - over, 0.0], [x.max() + over, 0.0]])
    cut = Item([line], stroke=CUT, width=BOLD)
    drawn = [faces([folded], coloured(inside, folded)) for _, inside, _, folded in parts]
    return Panel([*drawn, cut], [Key("folded flat: the cut", stroke=CUT, width=BOLD), *_sides(pattern.shape)])


def apart(pattern: FoldedPattern, look: LineStyle) -> Panel:
    """Draw the layers apart, along the cut line, seen from the side."""
    rank = np.argsort(pattern.folded.layers)
    size = float(np.ptp(pattern.folded.vertices_coords, axis=0).max())
    step = 1.6 * size / len(rank)
    side = np.array([[SIDEWAYS, UPWARD], [0.0, 1.0]])
    parts = sorted(pieces(pattern), key=lambda part: rank[part[0]])
    width = min(EDGE, 0.25 * EDGE + 4.0 * EDGE / len(rank) ** 0.5)
    drawn = [
        Item([folded @ side + (rank[face] * step, 0.0)], coloured(inside, folded), EDGE_COLOUR, width, closed=True)
        for face, inside, _, folded in parts
    ]
    first = float(pattern.folded.vertices_coords[:, 0].min())
    right = max(float(item.lines[0][:, 0].max()) for item in drawn)
    foot = np.array([first * SIDEWAYS, first * UPWARD])
    spine = np.array([foot - (0.02 * right, 0.0), [1.02 * right, foot[1]]])
    return Panel(
        [*drawn, Item([spine], stroke=CUT)],
        [Key("the layers apart, the lowest left: the cut", stroke=CUT), *_sides(pattern.shape)],
    )


def after(pattern: FoldedPattern, look: LineStyle) -> Panel:
    """Draw what unfolds after the cut."""
    aside = np.array([1.06 * pattern.sheet.width, 0.0])
    if pattern.sheet.width > pattern.sheet.height:
        aside = np.array([0.0, -1.06 * pattern.sheet.height])
    if pattern.shape.is_graph:
        return _pieces_apart(pattern, aside)
    lines = pattern.creases.vertices_coords[pattern.creases.edges_vertices]
    width = fine(lines, 2 * max(pattern.sheet.width, pattern.sheet.height), EDGE)
    drawn = [
        Item([flat + aside * inside], INSIDE if inside else OUTSIDE, EDGE_COLOUR, width, closed=True)
        for _, inside, flat, _ in pieces(pattern)
    ]
    keys = [Key("after the cut, unfolded: the shape", fill=INSIDE), Key("the rest", fill=OUTSIDE)]
    return Panel(drawn, keys)


def _pieces_apart(pattern: FoldedPattern, aside: Floats) -> Panel:
    """Draw the pieces that a cut along a graph leaves: those at the sheet's border, and ``aside`` the others, apart."""
    border = shapely.box(0, 0, pattern.sheet.width, pattern.sheet.height).exterior
    cut = shapely.union_all([shapely.linestrings(stroke) for stroke in pattern.shape.strokes])
    middle = pattern.shape.points.mean(axis=0)
    drawn, inner, holes = [], 0, 0
    for piece in pieces_of(pattern.shape, pattern.sheet):
        step, colour = np.zeros(2), OUTSIDE
        if not piece.exterior.intersects(border):
            step = aside + APART * (shapely.get_coordinates(piece.centroid)[0] - middle)
            colour = PIECES[inner % len(PIECES)]
            inner += 1
        rings = [shapely.get_coordinates(ring)[:-1] + step for ring in (piece.exterior, *piece.interiors)]
        drawn += [faces(rings[:1], colour), faces(rings[1:], EMPTY)]
        holes += len(rings) - 1
        slits = shapely.difference(shapely.intersection(cut, piece), shapely.buffer(piece.boundary, TOUCHING))
        ends = [shapely.get_coordinates(part) + step for part in shapely.get_parts(slits)]
        drawn.append(Item([line for line in ends if len(line) > 1], stroke=CUT, width=FIRM))
    keys = [Key("after the cut, unfolded: what is left of the sheet", fill=OUTSIDE)]
    keys += [Key("pieces", fill=PIECES[0])] if inner else []
    keys += [Key("cut out", fill=EMPTY)] if holes else []
    return Panel([item for item in drawn if item.lines], keys)


PANELS: dict[str, Callable[[FoldedPattern, LineStyle], Panel]] = {
    "pattern": creases,
    "folded": front,
    "layers": apart,
    "pieces": after,
    "outline": outlines,
}
"""The pictures of a pattern, by name."""
