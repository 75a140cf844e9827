"""A folding guide: what to fold, press and collapse, in which order, and where to cut, with a picture of each step.

Input: a ``FoldedPattern``; output: one HTML file that loads nothing, or a PDF on A4. The order is that of
``foldcut.folding_steps``. Straight folds are given one by one. Creases that have to close together, in a *collapse*,
are first pressed in numbered groups, both ways so that they fold easily either way; then the result is shown.
"""

from __future__ import annotations

import html
import io
import math
from dataclasses import dataclass

import numpy as np
from reportlab.lib.pagesizes import A4
from reportlab.lib.styles import getSampleStyleSheet
from reportlab.lib.units import mm
from reportlab.platypus import Flowable, KeepTogether, Paragraph, SimpleDocTemplate, Spacer

from foldcut.core.arrays import Bools, Floats, Ints, index_array
from foldcut.core.model import FoldedPattern, FoldedState
from foldcut.folding_steps import FoldingStep, folding_steps, in_words, lines_of, phases
from foldcut.geometry.planar_graph import edge_faces
from foldcut.geometry.vectors import left_normal, signed_area
from foldcut.methods import fewer_creases
from foldcut.pattern.cut_line import pieces_of
from foldcut.pattern.foldability import foldability, most_layers
from foldcut.profiles import LineStyle, Profile, load_profile

from ..text import printable
from . import panels, pictures
from .panels import BOLD, EDGE, EDGE_COLOUR, PANEL_MM, Item, Key, Label, Panel

NOW = "#d35400"
"""The colour of what to fold or press in this step."""

DONE = "#888888"
"""The colour of lines pressed in earlier steps."""

LATER = "#dddddd"
"""The colour of lines to press in later steps."""

FRONT = "#ffffff"
"""The colour of the sheet's printed side."""

BACK = "#cfd8e3"
"""The colour of the sheet's back."""

MOVED = "#fde0c8"
"""The colour of the printed side of the part that moves."""

MOVED_BACK = "#eeb58a"
"""The colour of the back of the part that moves."""

LABELLED_MM = 7.0
"""Lines at least this long on the picture have the number of their group beside them."""

PICTURE_MM = 90
"""The longer side of a picture on the PDF's page."""


@dataclass(frozen=True)
class Instruction:
    """What to do next, in words and as a picture."""

    title: str
    text: str
    panel: Panel

    @property
    def picture(self) -> bytes:
        """The picture as SVG."""
        return panels.laid_out([("", self.panel)], "")[0]


def instructions(pattern: FoldedPattern, look: LineStyle) -> list[Instruction]:
    """Return all instructions, from the flat sheet to the shape cut out."""
    numbers = foldability(pattern, method=fewer_creases())
    steps = folding_steps(pattern)
    advice = [f"{numbers.layers_at_cut} layers will lie on the cut, {numbers.layers} at the thickest place"]
    told = any(warning.startswith("the shortest crease") for warning in numbers.warnings)
    if numbers.shortest_crease_mm and not told:
        advice.append(f"the shortest crease is {numbers.shortest_crease_mm:.1f} mm long")
    text = (
        f"Print or score the pattern in true size, on a sheet of {pattern.sheet}. "
        f"It takes {in_words(phases(pattern, steps))}. For office paper: "
    )
    made = [
        Instruction("The sheet", text + "; ".join([*advice, *numbers.warnings]) + ".", pictures.creases(pattern, look))
    ]
    sheet = _Sheet(pattern)
    for step in steps:
        made += [sheet.fold(step, look)] if step.line is not None else sheet.collapse(step)
        sheet.advance(step)
    outline = pattern.creases.faces_vertices[0]
    over = np.prod([signed_area(state.vertices_coords[outline]) for state in (sheet.state, pattern.folded)]) < 0
    heights = pattern.folded.vertices_coords[:, 1]
    what = "lines to cut" if pattern.shape.is_graph else "outline of the shape"
    made += [
        Instruction(
            "Check the layers",
            "Turned so that the spine is on the left, and drawn apart, from the lowest on the left to the highest on "
            "the right, the layers follow each other so. The red line is where the shape begins.",
            pictures.apart(pattern, look),
        ),
        Instruction(
            "Cut",
            f"Turn the folded sheet {'over, and round' if over else 'round'} until it lies as in the picture. Cut "
            f"once, straight, along the {what}: level, {heights.max():.1f} mm under the highest point "
            f"and {-heights.min():.1f} mm over the lowest.",
            pictures.front(pattern, look),
        ),
        Instruction("Unfold", _what_is_left(pattern), pictures.after(pattern, look)),
    ]
    return made


def _what_is_left(pattern: FoldedPattern) -> str:
    """Say what there is after the cut."""
    if not pattern.shape.is_graph:
        return "One part is the shape, the other the sheet around it."
    count = len(pieces_of(pattern.shape, pattern.sheet))
    return f"The sheet is in {count} pieces." if count > 1 else "The sheet is in one piece, with slits."


class _Sheet:
    """The sheet as it lies before a step, and the pictures of it."""

    def __init__(self, pattern: FoldedPattern) -> None:
        self.pattern, creases = pattern, pattern.creases
        self.faces = creases.faces_vertices
        self.ends = creases.edges_vertices
        self.beside = edge_faces(creases)
        self.state = FoldedState(creases.vertices_coords, index_array(np.arange(len(self.faces))))
        self.folded = np.zeros(len(self.ends), dtype=np.bool_)
        self.count = 0

    def advance(self, step: FoldingStep) -> None:
        """Go on to the state after a step."""
        self.folded[step.edges] = True
        self.state = step.state

    def drawn(self, state: FoldedState, folded: Bools, moved: Ints | None = None) -> list[Item]:
        """Return the sheet from the lowest layer to the highest; its border and folded creases are drawn as edges."""
        if not folded.any() and moved is None:
            return [panels.faces([self.pattern.sheet.corners], FRONT)]
        seen: Bools = folded | (self.beside < 0).any(axis=1)
        edges: list[list[int]] = [[] for _ in range(len(self.faces))]
        for edge in np.flatnonzero(seen).tolist():
            for face in self.beside[edge].tolist():
                if face >= 0:
                    edges[face].append(edge)
        moving = set([] if moved is None else moved.tolist())
        items = []
        for face in state.layers.tolist():
            outline = state.vertices_coords[self.faces[face]]
            front = signed_area(outline) > 0
            fill = (MOVED if front else MOVED_BACK) if face in moving else FRONT if front else BACK
            items.append(Item([outline], fill=fill, stroke=fill, width=EDGE / 2, closed=True))
            lines = [state.vertices_coords[self.ends[edge]] for edge in edges[face]]
            items += [Item(lines, stroke=EDGE_COLOUR, width=EDGE)] if lines else []
        return items

    def back(self, state: FoldedState) -> list[Key]:
        """Return a key for the sheet's back, if it can be seen."""
        turned = [signed_area(state.vertices_coords[outline]) < 0 for outline in self.faces]
        return [Key("the back", fill=BACK)] if any(turned) else []

    def fold(self, step: FoldingStep, look: LineStyle) -> Instruction:
        """Return the instruction to fold a part of the sheet over a line."""
        assert step.line is not None
        assert step.moved is not None
        self.count += 1
        at = self.state.vertices_coords
        along = (step.line[1] - step.line[0]) / math.dist(*step.line)
        off = (at - step.line[0]) @ left_normal(along)
        tie = 1e-6 * self.pattern.sheet.diagonal
        straddled = any(off[outline].min() < -tie and off[outline].max() > tie for outline in self.faces)
        layers = _most_on(at[self.ends[step.edges]], along, tie)
        which = "the layer" if layers == 1 else f"the {layers} layers"
        if straddled:
            which = f"only {which} {'on top' if step.over else 'at the back'}"
        elif layers == 1:
            which = "the sheet"
        else:
            which = "both layers together" if layers == 2 else f"all {layers} layers together"
        valley = panels.valley(look) if step.over else panels.mountain(look)
        arrow = _arrow(at[np.unique(np.concatenate([self.faces[face] for face in step.moved]))], step.line)
        panel = Panel(
            [
                *self.drawn(self.state, self.folded, step.moved),
                Item([step.line], stroke=NOW, width=BOLD, dash=valley),
                Item(arrow, stroke=NOW, width=BOLD / 2),
            ],
            [
                Key("fold here", stroke=NOW, width=BOLD, dash=valley),
                Key("moves", fill=MOVED),
                *self.back(self.state),
            ],
        )
        way = "toward you, over the line" if step.over else "away from you, behind the rest"
        return Instruction(
            f"Fold {self.count}",
            f"Fold {which} along the marked line: the coloured part goes {way}. Leave it folded.",
            panel,
        )

    def collapse(self, step: FoldingStep) -> list[Instruction]:
        """Return the instructions to press creases in groups and to close them all."""
        groups = [lines_of(self.pattern, self.state.vertices_coords, group) for group in step.groups]
        layers = most_layers(self.faces, self.state) if self.folded.any() else 1
        through = "" if layers == 1 else " through both layers" if layers == 2 else f" through all {layers} layers"
        single = sum(map(len, groups)) == 1
        if single:  # elsewhere there may be more layers than on this line
            line = groups[0][0]
            on_line = self.state.vertices_coords[self.ends[step.edges]]
            layers = _most_on(on_line, (line[1] - line[0]) / math.dist(*line), 1e-6 * self.pattern.sheet.diagonal)
            through = "" if layers == 1 else f" through {layers} layers"
        sheet = self.drawn(self.state, self.folded)
        overview = [self._overview(groups, sheet)] if len(groups) > 1 else []
        return [*overview, *self._press(groups, sheet, through), self._close(step, through, single)]

    def _overview(self, groups: list[list[Floats]], sheet: list[Item]) -> Instruction:
        """Return the instruction that shows which creases are in which group."""
        extent = float(np.ptp(self.state.vertices_coords, axis=0).max())
        labels = [
            Label(str(number), line.mean(axis=0), colour="#a03000")
            for number, lines in enumerate(groups, start=1)
            for line in lines
            if math.dist(*line) * PANEL_MM / extent > LABELLED_MM
        ]
        lines = [line for lines in groups for line in lines]
        order = "what is inside other parts of the pattern comes first" if self.pattern.regions else "long lines first"
        return Instruction(
            "The groups",
            f"The creases that come next are pressed in {len(groups)} groups: {order}. "
            "The picture has the numbers of the groups on the longer lines.",
            Panel([*sheet, Item(lines, stroke=DONE, width=EDGE)], labels=labels),
        )

    def _press(self, groups: list[list[Floats]], sheet: list[Item], through: str) -> list[Instruction]:
        """Return an instruction to press the creases of each group."""
        every = np.array([line for lines in groups for line in lines])
        thin = panels.fine(every, float(np.ptp(self.state.vertices_coords, axis=0).max()), EDGE * 1.5)
        bold = BOLD / 1.5 * max(0.5, thin / (EDGE * 1.5))
        made = []
        for number, lines in enumerate(groups):
            done = [line for some in groups[:number] for line in some]
            later = [line for some in groups[number + 1 :] for line in some]
            strokes = ((later, LATER, thin), (done, DONE, thin), (lines, NOW, bold))
            items = [Item(some, stroke=colour, width=width) for some, colour, width in strokes if some]
            keys = [Key("now", stroke=NOW, width=BOLD / 1.5)]
            keys += [Key("done", stroke=DONE)] if done else []
            keys += [Key("later", stroke=LATER)] if later else []
            shortest = min(math.dist(*line) for line in lines)
            title = f"Press group {number + 1} of {len(groups)}" if len(groups) > 1 else "Press creases"
            what, them = ("marked line", "it") if len(lines) == 1 else (f"{len(lines)} marked lines", "them")
            text = (
                f"Crease the {what}{through}, sharply and both ways, and open {them} again. "
                f"The shortest is {shortest:.1f} mm long."
            )
            made.append(Instruction(title, text, Panel([*sheet, *items], keys)))
        return made

    def _close(self, step: FoldingStep, through: str, single: bool) -> Instruction:
        """Return the instruction to close all creases of a step at once, or a single one that is no simple fold."""
        folded = self.folded.copy()
        folded[step.edges] = True
        ends = "lies flat like this" if not self.folded.any() else "lies flat again, like this"
        what = f"these creases{through} close together: this is one movement and not a row of straight folds"
        if single:
            what = f"this crease{through} closes, though not as a simple fold"
        text = (
            f"Now {what}. Bend every mountain (dash-dotted on the pattern) away from you and every valley (dashed) "
            f"toward you, a little everywhere, then more, until the sheet {ends}."
        )
        if len(step.groups) > 1 and self.pattern.regions:
            text += (
                " Shape group 1 first, then 2, and so on; the flaps come to lie on each other like the pages of a book."
            )
        keys = [Key("the printed side", fill=FRONT), *self.back(step.state)]
        return Instruction("Collapse", text, Panel(self.drawn(step.state, folded), keys))


def _most_on(lines: Floats, along: Floats, tie: float) -> int:
    """Return the largest number of segments, all on one line, ``(n, 2, 2)``, that lie on each other."""
    x = np.sort(lines @ along, axis=1)
    starts, ends = np.sort(x[:, 0]), np.sort(x[:, 1])
    return max(
        int(np.searchsorted(starts, place + tie, side="right") - np.searchsorted(ends, place + tie)) for place in starts
    )


def _arrow(points: Floats, line: Floats) -> list[Floats]:
    """Return an arrow: an arc from the middle of the part that moves to its new place, and the arrow's head."""
    along = (line[1] - line[0]) / math.dist(*line)
    middle = points.mean(axis=0)
    foot = line[0] + along * float((middle - line[0]) @ along)
    away = middle - foot
    reach = math.hypot(*away)
    angle = np.radians(np.linspace(25, 150, 30))[:, None]
    arc = foot + away * np.cos(angle) + 0.45 * reach * along * np.sin(angle)
    tip, back = arc[-1], arc[-1] - arc[-4]
    back = back / math.hypot(*back) * 0.18 * reach
    aside = left_normal(back) * 0.45
    return [arc, np.array([tip - back + aside, tip, tip - back - aside])]


def export_html(pattern: FoldedPattern, profile: Profile | None = None) -> bytes:
    """Return the guide as one HTML file."""
    title = html.escape(printable(pattern.title) or "foldcut")
    parts = [
        f"<section><h2>{number}. {html.escape(step.title)}</h2><p>{html.escape(step.text)}</p>"
        f'<div role="img" aria-label="{html.escape(step.title)}">{_bare(step.picture)}</div></section>'
        for number, step in enumerate(instructions(pattern, (profile or load_profile()).drawing), start=1)
    ]
    style = (
        "body{font:16px/1.4 system-ui,sans-serif;max-width:46rem;margin:0 auto;padding:1rem;color:#1a1a1a}"
        "section{break-inside:avoid;border-top:1px solid #bbb}svg{width:100%;height:auto;max-width:120mm}"
    )
    head = (
        '<meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>{title}: how to fold it</title><style>{style}</style>"
    )
    body = f"<main><h1>{title}: how to fold it</h1>{''.join(parts)}</main>"
    return f'<!DOCTYPE html>\n<html lang="en"><head>{head}</head><body>{body}</body></html>\n'.encode()


def _bare(picture: bytes) -> str:
    """Return a picture without the XML declaration, which belongs only at the start of a file."""
    return picture.decode().partition("?>\n")[2].strip()


def export_pdf(pattern: FoldedPattern, profile: Profile | None = None) -> bytes:
    """Return the guide as a PDF on A4; the same pattern gives the same bytes."""
    title = printable(pattern.title) or "foldcut"
    look, flow = getSampleStyleSheet(), []
    flow.append(Paragraph(f"{html.escape(title)}: how to fold it", look["Title"]))
    for number, step in enumerate(instructions(pattern, (profile or load_profile()).drawing), start=1):
        block = [
            Paragraph(f"{number}. {html.escape(step.title)}", look["Heading2"]),
            Paragraph(html.escape(step.text), look["BodyText"]),
            Spacer(1, 3 * mm),
            _Picture(step.panel),
        ]
        flow.append(KeepTogether(block))
    out = io.BytesIO()
    SimpleDocTemplate(out, pagesize=A4, title=f"{title}: how to fold it", creator="foldcut", invariant=1).build(flow)
    return out.getvalue()


class _Picture(Flowable):  # type: ignore[misc]
    """A panel that reportlab can put on a page."""

    def __init__(self, panel: Panel) -> None:
        super().__init__()
        self.marks, size = panels.flat(panel)
        self.scale = PICTURE_MM / max(size) * mm
        self.width, self.height = (side * self.scale for side in size)

    def draw(self) -> None:
        """Draw the panel; called by reportlab, with the origin in the lower left corner."""
        canvas = self.canv
        canvas.translate(0, self.height)
        canvas.scale(self.scale, self.scale)
        canvas.setLineJoin(1)
        for mark in self.marks:
            if isinstance(mark, panels.Text):
                canvas.setFillColor(mark.colour)
                canvas.setFont("Helvetica", panels.TEXT_MM)
                (canvas.drawCentredString if mark.centred else canvas.drawString)(mark.x, -mark.y, mark.words)
                continue
            path = canvas.beginPath()
            first, *rest = mark.points.tolist()
            path.moveTo(first[0], -first[1])
            for x, y in rest:
                path.lineTo(x, -y)
            if mark.closed:
                path.close()
            if mark.fill:
                canvas.setFillColor(mark.fill)
            if mark.stroke:
                canvas.setStrokeColor(mark.stroke)
                canvas.setLineWidth(mark.width)
            canvas.drawPath(path, fill=int(bool(mark.fill)), stroke=int(bool(mark.stroke)))


GUIDES = {".html": export_html, ".pdf": export_pdf}
"""The exporters of guides, by the ending of their files."""
