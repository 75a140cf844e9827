"""Pictures of a pattern: the creases, the sheet folded flat, its layers drawn apart, and what the cut leaves.

Input: a ``FoldedPattern`` and the names of panels; output: SVG (see ``panels``). Mountains are dash-dotted and red,
valleys dashed and blue; the inside of the shape is yellow.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from foldcut.core.arrays import Floats
from foldcut.core.errors import BadInputError
from foldcut.core.model import FoldedPattern
from foldcut.geometry.vectors import signed_area
from foldcut.profiles import LineStyle, Profile

from .construction import CONSTRUCTION
from .panels import BOLD, EDGE, EDGE_COLOUR, Item, Key, Panel, faces, fine, laid_out, mountain, valley

if TYPE_CHECKING:
    from foldcut.methods.disks.method import DiskStages

INSIDE = "#ffe08a"
"""The colour of the shape's front."""

INSIDE_BACK = "#e6b93f"
"""The colour of the shape's back."""

OUTSIDE = "#ffffff"
"""The colour of the front of the sheet around the shape."""

OUTSIDE_BACK = "#cfd8e3"
"""The colour of the back of the sheet around the shape."""

CUT = "#c00000"
"""The colour of the cut."""

SIDEWAYS = 0.45
"""How much layers drawn apart are foreshortened along the cut line, since they are seen from the side."""

UPWARD = 0.2
"""How far the cut line of layers drawn apart climbs, as a fraction of its length."""


def check(show: Sequence[str], *, construction: bool = False) -> None:
    """Raise BadInputError unless these are names of panels; those of ``CONSTRUCTION`` need a construction."""
    for name in show:
        if name not in {**PANELS, **CONSTRUCTION}:
            raise BadInputError(f"there is no picture {name!r}; choose from {', '.join([*PANELS, *CONSTRUCTION])}")
        if name in CONSTRUCTION and not construction:
            raise BadInputError(f"the picture {name} is of the paper's construction: it goes with --method paper")


def draw(
    pattern: FoldedPattern, show: Sequence[str], profile: Profile, stages: DiskStages | None = None
) -> tuple[bytes, tuple[float, float]]:
    """Return an SVG with a panel for each name in ``show``, and its width and height in mm.

    ``stages``: those of the disk method, if it made the pattern. Raises BadInputError for a name that is neither in
    ``PANELS`` nor, given ``stages``, in ``CONSTRUCTION``.
    """
    check(show, construction=stages is not None)
    panels = []
    for name in show:
        if name in PANELS:
            panels.append((name, PANELS[name](pattern, profile.drawing)))
        else:
            assert stages is not None
            panels.append((name, CONSTRUCTION[name](stages, profile.drawing)))
    return laid_out(panels, pattern.title)


def _pieces(pattern: FoldedPattern) -> Iterable[tuple[int, bool, Floats, Floats]]:
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


def _colour(inside: bool, folded: Floats) -> str:
    front = signed_area(folded) > 0
    return (INSIDE if front else INSIDE_BACK) if inside else (OUTSIDE if front else OUTSIDE_BACK)


def creases(pattern: FoldedPattern, look: LineStyle) -> Panel:
    """Draw the crease pattern."""
    kinds = pattern.creases.edges_assignment
    lines = pattern.creases.vertices_coords[pattern.creases.edges_vertices]
    folded = np.isin(kinds, ("M", "V"))
    width = fine(lines[folded], max(pattern.sheet.width, pattern.sheet.height))
    sheet = faces([pattern.sheet.corners], OUTSIDE)
    loops = sorted(enumerate(pattern.shape.loops), key=lambda row: pattern.shape.depth(row[0]))
    shape = [faces([loop], INSIDE if pattern.shape.depth(n) % 2 == 0 else OUTSIDE) for n, loop in loops]
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
    return Panel([sheet, *shape, *drawn], [*keys, Key("the shape", fill=INSIDE)])


SIDES = [
    Key("the shape, front", fill=INSIDE),
    Key("back", fill=INSIDE_BACK),
    Key("around it, front", fill=OUTSIDE),
    Key("back", fill=OUTSIDE_BACK),
]


def front(pattern: FoldedPattern, look: LineStyle) -> Panel:
    """Draw the folded sheet from the front, and where to cut."""
    rank = np.argsort(pattern.folded.layers)
    parts = sorted(_pieces(pattern), key=lambda part: rank[part[0]])
    x = pattern.folded.vertices_coords[:, 0]
    over = 0.08 * np.ptp(x)
    line = np.array([[x.min() - over, 0.0], [x.max() + over, 0.0]])
    cut = Item([line], stroke=CUT, width=BOLD)
    drawn = [faces([folded], _colour(inside, folded)) for _, inside, _, folded in parts]
    return Panel([*drawn, cut], [Key("folded flat: the cut", stroke=CUT, width=BOLD), *SIDES])


def apart(pattern: FoldedPattern, look: LineStyle) -> Panel:
    """Draw the layers apart, along the cut line, seen from the side."""
    rank = np.argsort(pattern.folded.layers)
    size = float(np.ptp(pattern.folded.vertices_coords, axis=0).max())
    step = 1.6 * size / len(rank)
    side = np.array([[SIDEWAYS, UPWARD], [0.0, 1.0]])
    parts = sorted(_pieces(pattern), key=lambda part: rank[part[0]])
    width = min(EDGE, 0.25 * EDGE + 4.0 * EDGE / len(rank) ** 0.5)
    drawn = [
        Item([folded @ side + (rank[face] * step, 0.0)], _colour(inside, folded), EDGE_COLOUR, width, closed=True)
        for face, inside, _, folded in parts
    ]
    first = float(pattern.folded.vertices_coords[:, 0].min())
    right = max(float(item.lines[0][:, 0].max()) for item in drawn)
    foot = np.array([first * SIDEWAYS, first * UPWARD])
    spine = np.array([foot - (0.02 * right, 0.0), [1.02 * right, foot[1]]])
    return Panel(
        [*drawn, Item([spine], stroke=CUT)],
        [Key("the layers apart, the lowest left: the cut", stroke=CUT), *SIDES],
    )


def after(pattern: FoldedPattern, look: LineStyle) -> Panel:
    """Draw what unfolds after the cut."""
    aside = np.array([1.06 * pattern.sheet.width, 0.0])
    if pattern.sheet.width > pattern.sheet.height:
        aside = np.array([0.0, -1.06 * pattern.sheet.height])
    lines = pattern.creases.vertices_coords[pattern.creases.edges_vertices]
    width = fine(lines, 2 * max(pattern.sheet.width, pattern.sheet.height), EDGE)
    drawn = [
        Item([flat + aside * inside], INSIDE if inside else OUTSIDE, EDGE_COLOUR, width, closed=True)
        for _, inside, flat, _ in _pieces(pattern)
    ]
    keys = [Key("after the cut, unfolded: the shape", fill=INSIDE), Key("the rest", fill=OUTSIDE)]
    return Panel(drawn, keys)


PANELS: dict[str, Callable[[FoldedPattern, LineStyle], Panel]] = {
    "pattern": creases,
    "folded": front,
    "layers": apart,
    "pieces": after,
}
"""The pictures of a pattern, by name."""
