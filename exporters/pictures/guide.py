"""A folding guide: what to fold, press and collapse, in which order, and where to cut, with a picture of each step.

Input: a ``FoldedPattern``; output: one HTML file that loads nothing, or a PDF on A4. The order is that of
``foldcut.folding_steps``; the pictures have the symbols of origami diagrams (``symbols``) and show the paper as it lies
before each step (``folded_paper``). Straight folds are given one by one. Creases that have to close together, in a
*collapse*, are first pressed in numbered groups, both ways so that they fold easily either way; then they are shown as
mountains and valleys, and then the result.
"""

from __future__ import annotations

import html
import io
import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import shapely
from reportlab.lib.pagesizes import A4
from reportlab.lib.styles import ParagraphStyle
from reportlab.lib.units import mm
from reportlab.pdfgen.canvas import Canvas
from reportlab.platypus import Paragraph

from foldcut.core.arrays import Floats, Ints
from foldcut.core.model import FoldedPattern
from foldcut.core.units import rounded_up
from foldcut.folding_steps import FoldingStep, difficulty_of, folding_steps, in_words, lines_of, phases
from foldcut.folding_steps.half_closed import half_closed
from foldcut.folding_steps.references import reference
from foldcut.folding_steps.steps import goes_through_all
from foldcut.geometry.vectors import left_normal, signed_area
from foldcut.methods import fewer_creases
from foldcut.pattern.cut_line import pieces_of
from foldcut.pattern.foldability import foldability
from foldcut.profiles import LineStyle, Profile, load_profile

from ..text import printable
from . import panels, pictures, symbols
from .animation import export_animation
from .folded_paper import BACK, FRONT, MOVED, MOVED_BACK, FoldedPaper
from .in_space import in_space
from .panels import BOLD, EDGE, PANEL_MM, Item, Key, Label, Panel

__all__ = ["BACK", "FRONT", "GUIDES", "MOVED", "MOVED_BACK", "NOW", "Instruction", "instructions"]

NOW = "#d35400"
"""The colour of what to fold or press in this step."""

DONE = "#888888"
"""The colour of lines pressed in earlier steps."""

LATER = "#dddddd"
"""The colour of lines to press in later steps."""

MOST_ARROWS = 2
"""How many of the lines to press have an arrow: the longest."""

COLLAPSED = "Collapsed"
"""The title of the picture after a collapse."""

BESIDE = 1e-5
"""How near to the line of a fold its layers are counted, relative to the sheet's diagonal."""

LEAST_CREASES = 2
"""A step with fewer creases has no picture on the way."""

LEAST_TURN = 3.0
"""The paper is turned round before the cut if it lies askew by more than this, in degrees."""

LABELLED_MM = 7.0
"""Lines at least this long on the picture have the number of their group beside them."""

PAGE_MM = (210.0, 297.0)
"""The size of the PDF's page."""

MARGIN_MM = 15.0
"""How far everything stays from its edges."""

COLUMNS = 2
"""How many steps are beside each other."""

GUTTER_MM = 10.0
"""The distance between columns, and between rows."""

LABEL_MM = 3.0
"""The room for labels above a picture."""

HIGHEST_MM = 58.0
"""The greatest height of a picture."""


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
    counted = phases(pattern, steps)
    told = difficulty_of(counted, numbers)
    advice = [f"{numbers.layers_at_cut} layers will lie on the cut, {numbers.layers} at the thickest place"]
    warned = any(warning.startswith("the shortest crease") for warning in numbers.warnings)
    if numbers.shortest_crease_mm and not warned:
        advice.append(f"the shortest crease is {numbers.shortest_crease_mm:.1f} mm long")
    text = (
        f"Print or score the pattern in true size, on a sheet of {pattern.sheet}. "
        f"It takes {in_words(counted)}: {told.short}. For office paper: "
    )
    made = [
        Instruction("The sheet", text + "; ".join([*advice, *numbers.warnings]) + ".", pictures.creases(pattern, look))
    ]
    sheet = _Sheet(pattern)
    for step in steps:
        made += [sheet.fold(step, look)] if step.line is not None else sheet.collapse(step, look)
        sheet.advance(step)
    if made[-1].title == COLLAPSED:
        made.pop()  # the next picture is the same
    heights = pattern.folded.vertices_coords[:, 1]
    what = "lines to cut" if pattern.shape.is_graph else "outline of the shape"
    made += [
        sheet.turned(),
        Instruction(
            "Check the layers",
            "Drawn apart, from the lowest on the left to the highest on the right, the layers follow each other so. "
            "The red line is where the shape begins.",
            pictures.apart(pattern, look),
        ),
        Instruction(
            "Cut",
            f"Cut once, straight, along the {what}: level, {heights.max():.1f} mm under the highest "
            f"point and {-heights.min():.1f} mm over the lowest.",
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
    """The sheet as it lies before a step, and the instructions for it."""

    def __init__(self, pattern: FoldedPattern) -> None:
        self.pattern, self.paper = pattern, FoldedPaper(pattern)
        self.faces, self.ends = self.paper.faces, self.paper.ends
        self.state = self.paper.unfolded
        self.folded = np.zeros(len(self.ends), dtype=np.bool_)
        self.count = 0

    @property
    def extent(self) -> float:
        """The size of the sheet as it lies."""
        return float(np.ptp(self.state.vertices_coords, axis=0).max())

    def advance(self, step: FoldingStep) -> None:
        """Go on to the state after a step."""
        self.folded[step.edges] = True
        self.state = step.state

    def fold(self, step: FoldingStep, look: LineStyle) -> Instruction:
        """Return the instruction to fold a part of the sheet over a line."""
        assert step.line is not None
        assert step.moved is not None
        self.count += 1
        at = self.state.vertices_coords
        layers = self._moving(step.line, step.moved)
        which = "the layer" if layers == 1 else f"the {layers} layers"
        if not goes_through_all(self.pattern, at, step.line):
            which = f"only {which} {'on top' if step.over else 'at the back'}"
        elif layers == 1:
            which = "the sheet"
        else:
            which = "both layers together" if layers == 2 else f"all {layers} layers together"
        dash = panels.valley(look) if step.over else panels.mountain(look)
        moves = at[np.unique(np.concatenate([self.faces[face] for face in step.moved]))]
        arrow = symbols.fold_arrow(moves, step.line, self.extent, valley=step.over)
        panel = Panel(
            [
                *self.paper.drawn(self.state, self.folded, step.moved),
                Item([step.line], stroke=NOW, width=BOLD, dash=dash),
                *arrow,
            ],
            [
                Key("valley fold" if step.over else "mountain fold", stroke=NOW, width=BOLD, dash=dash),
                Key("moves", fill=MOVED),
                *self.paper.back(self.state),
            ],
            self.paper.names(self.state, self.folded),
        )
        way = "toward you, over the line" if step.over else "away from you, behind the rest"
        where = reference(self.pattern, self.state, step)
        return Instruction(f"Fold {self.count}", f"Fold {which} {way}. {where}", panel)

    def _moving(self, line: Floats, moved: Ints) -> int:
        """Return how many layers a person holds at a fold: those that move just beside its line, ``(2, 2)``."""
        at = self.state.vertices_coords
        along = (line[1] - line[0]) / math.dist(*line)
        across = left_normal(along)
        polygons = [shapely.Polygon(at[self.faces[face]]) for face in moved.tolist()]
        side = np.sign(
            sum(
                polygon.area * float((at[self.faces[face]].mean(axis=0) - line[0]) @ across)
                for polygon, face in zip(polygons, moved.tolist(), strict=True)
            )
        )
        near = BESIDE * self.pattern.sheet.diagonal
        beside = shapely.LineString(line + side * near * across)
        parts = shapely.get_parts(shapely.intersection(np.array(polygons), beside))
        parts = parts[shapely.length(parts) > near]
        return _most_on(np.array([shapely.get_coordinates(part)[[0, -1]] for part in parts]), along, near)

    def collapse(self, step: FoldingStep, look: LineStyle) -> list[Instruction]:
        """Return the instructions to press creases in groups and to close them all."""
        groups = [lines_of(self.pattern, self.state.vertices_coords, group) for group in step.groups]
        single = sum(map(len, groups)) == 1
        through = self._through(groups, step)
        sheet = self.paper.drawn(self.state, self.folded)
        overview = [self._overview(groups, sheet)] if len(groups) > 1 else []
        return [*overview, *self._press(groups, sheet, step), *self._close(step, through, look, single=single)]

    def _through(self, groups: list[list[Floats]], step: FoldingStep) -> str:
        """Return through how many layers creases go: as many as lie on each other on any of their lines."""
        if not self.folded.any():
            return ""
        ends = self.state.vertices_coords[self.ends[step.edges]]
        counts = {self._layers_on(line, ends) for lines in groups for line in lines}
        most = max(counts)
        if len(counts) > 1:
            return f" through {min(counts)} to {most} layers"
        return "" if most == 1 else " through both layers" if most == 2 else f" through {most} layers"

    def _layers_on(self, line: Floats, ends: Floats) -> int:
        """Return how many of the creases, ``(n, 2, 2)``, lie on each other on a line at most."""
        tie = 1e-6 * self.pattern.sheet.diagonal
        along = (line[1] - line[0]) / math.dist(*line)
        off = np.abs((ends - line[0]) @ left_normal(along)).max(axis=1)
        places = (ends - line[0]) @ along
        on_it = (off < tie) & (places.max(axis=1) > tie) & (places.min(axis=1) < math.dist(*line) - tie)
        return _most_on(ends[on_it], along, tie)

    def _overview(self, groups: list[list[Floats]], sheet: list[Item]) -> Instruction:
        """Return the instruction that shows which creases are in which group."""
        labels = [
            Label(str(number), line.mean(axis=0), colour="#a03000")
            for number, lines in enumerate(groups, start=1)
            for line in lines
            if math.dist(*line) * PANEL_MM / self.extent > LABELLED_MM
        ]
        lines = [line for lines in groups for line in lines]
        order = "what is inside other parts of the pattern comes first" if self.pattern.regions else "long lines first"
        return Instruction(
            "The groups",
            f"The creases that come next are pressed in {len(groups)} groups: {order}. "
            "The picture has the numbers of the groups on the longer lines.",
            Panel([*sheet, Item(lines, stroke=DONE, width=EDGE)], labels=labels),
        )

    def _press(self, groups: list[list[Floats]], sheet: list[Item], step: FoldingStep) -> list[Instruction]:
        """Return an instruction to press the creases of each group."""
        every = np.array([line for lines in groups for line in lines])
        thin = panels.fine(every, self.extent, EDGE * 1.5)
        bold = BOLD / 1.5 * max(0.5, thin / (EDGE * 1.5))
        made = []
        for number, lines in enumerate(groups):
            done = [line for some in groups[:number] for line in some]
            later = [line for some in groups[number + 1 :] for line in some]
            strokes = ((later, LATER, thin), (done, DONE, thin), (lines, NOW, bold))
            items = [Item(some, stroke=colour, width=width) for some, colour, width in strokes if some]
            longest = sorted(lines, key=lambda line: -math.dist(*line))[:MOST_ARROWS]
            items += [
                one for line in longest for one in symbols.unfold_arrow(line.mean(axis=0), line, 0.7 * self.extent)
            ]
            keys = [Key("fold and unfold", stroke=NOW, width=BOLD / 1.5)]
            keys += [Key("done", stroke=DONE)] if done else []
            keys += [Key("later", stroke=LATER)] if later else []
            shortest = min(math.dist(*line) for line in lines)
            title = f"Press group {number + 1} of {len(groups)}" if len(groups) > 1 else "Press creases"
            what, them = ("marked line", "it") if len(lines) == 1 else (f"{len(lines)} marked lines", "them")
            through = self._through([lines], step)
            text = (
                f"Crease the {what}{through}, sharply and both ways, and open {them} again. "
                f"The shortest is {shortest:.1f} mm long."
            )
            made.append(Instruction(title, text, Panel([*sheet, *items], keys)))
        return made

    def _close(self, step: FoldingStep, through: str, look: LineStyle, *, single: bool) -> list[Instruction]:
        """Return the instructions to close all creases of a step at once, or a single one that is no simple fold."""
        folded = self.folded.copy()
        folded[step.edges] = True
        ends = "lies flat" if not self.folded.any() else "lies flat again"
        what = f"these creases{through} close together: this is one movement and not a row of straight folds"
        if single:
            what = f"this crease{through} closes, though not as a simple fold"
        text = (
            f"Now {what}. Bend every mountain (dash-dotted) away from you and every valley (dashed) toward you, a "
            f"little everywhere, then more, until the sheet {ends}."
        )
        if len(step.groups) > 1 and self.pattern.regions:
            text += (
                " Shape group 1 first, then 2, and so on; the flaps come to lie on each other like the pages of a book."
            )
        before = Panel([*self.paper.drawn(self.state, self.folded), *self._ways(step, look)], self._way_keys(look))
        keys = [Key("the printed side", fill=FRONT), *self.paper.back(step.state)]
        after = Panel(self.paper.drawn(step.state, folded), keys, self.paper.names(step.state, folded))
        return [
            Instruction("Collapse", text, before),
            *self._half_closed(step),
            Instruction(COLLAPSED, "It lies so now; layers are drawn a little apart.", after),
        ]

    def _half_closed(self, step: FoldingStep) -> list[Instruction]:
        """Return the picture of the sheet when the creases of a step have begun to close, where that is found."""
        top = None if step.edges.size < LEAST_CREASES else self.paper.top(self.state, self.folded, step.edges)
        if top is None:
            return []
        creases, up = top
        found = half_closed(creases)
        if found is None:
            return []
        drawn = {(min(ends), max(ends)) for ends in creases.edges_vertices[creases.edges_assignment != "F"].tolist()}
        together = ", all layers together" if self.folded.any() else ""
        text = (
            f"On the way, seen from the front and above{together}. (Computed: lengths are within "
            f"{rounded_up(max(0.001, found.strain_mm))} mm, nothing crosses, and faces bend a little.)"
        )
        return [Instruction("Closing", text, Panel(in_space(found, drawn, up=up), [Key("the back", fill=BACK)]))]

    def _ways(self, step: FoldingStep, look: LineStyle) -> list[Item]:
        """Return the creases of a step as they look from above: of those on each other, the highest."""
        at, rank = self.state.vertices_coords, np.argsort(self.state.layers)
        beside = self.paper.beside[step.edges]
        top = np.where(rank[beside[:, 0]] > rank[beside[:, 1]], beside[:, 0], beside[:, 1])
        up = self.paper.front_up(self.state)[beside[:, 0]]
        rising = (self.pattern.creases.edges_assignment[step.edges] == "V") == up
        shown: dict[tuple[float, ...], int] = {}
        grid = 1e-5 * self.pattern.sheet.diagonal
        for number in np.argsort(rank[top], kind="stable").tolist():
            one, other = sorted(map(tuple, np.round(at[self.ends[step.edges[number]]] / grid).tolist()))
            shown[one + other] = number
        seen = np.array(sorted(shown.values()))
        lines = at[self.ends[step.edges]]
        width = panels.fine(lines[seen], self.extent)
        styles = ((True, look.valley_colour, panels.valley(look)), (False, look.mountain_colour, panels.mountain(look)))
        return [
            Item(list(lines[seen[rising[seen] == way]]), stroke=colour, width=width, dash=dash)
            for way, colour, dash in styles
            if (rising[seen] == way).any()
        ]

    def _way_keys(self, look: LineStyle) -> list[Key]:
        return [
            Key("mountain", stroke=look.mountain_colour, dash=panels.mountain(look)),
            Key("valley", stroke=look.valley_colour, dash=panels.valley(look)),
        ]

    def turned(self) -> Instruction:
        """Return the instruction to turn the folded sheet as it lies in the pictures of the cut."""
        before, after = self.state.vertices_coords, self.pattern.folded.vertices_coords
        outline = self.faces[int(np.argmax([abs(signed_area(self.paper.flat[face])) for face in self.faces]))]
        over = signed_area(before[outline]) * signed_area(after[outline]) < 0
        far = outline[int(np.hypot(*(before[outline] - before[outline[0]]).T).argmax())]
        sides = [complex(*(at[far] - at[outline[0]])) for at in (before, after)]
        sides[0] = complex(-sides[0].real, sides[0].imag) if over else sides[0]
        angle = math.degrees(np.angle(sides[1] / sides[0]))
        around = abs(angle) > LEAST_TURN
        low, high = before.min(axis=0), before.max(axis=0)
        size = 0.22 * self.extent
        beside = np.array([high[0] + 0.8 * size, (low[1] + high[1]) / 2])
        up = np.array([0.0, size])
        marks = symbols.turn_over(beside + (0.7 if around else -0.1) * up, size) if over else []
        if around:
            marks += symbols.rotate(beside - (0.5 if over else 0.0) * up, 0.6 * size, left=angle > 0)
        round_it = f"turn it {abs(angle):.0f} degrees to the {'left' if angle > 0 else 'right'}"
        turns = ["turn it over, left to right" * over, round_it * around]
        words = ", and ".join(text for text in turns if text) or "leave it as it is"
        panel = Panel(
            [*self.paper.drawn(self.state, self.folded), *marks],
            self.paper.back(self.state),
            self.paper.names(self.state, self.folded),
        )
        text = f"It lies so now; layers are drawn a little apart. For the cut, {words}."
        return Instruction("Turn over" if over else "Turn" if around else "Folded", text, panel)


def _most_on(lines: Floats, along: Floats, tie: float) -> int:
    """Return the largest number of segments, all on one line, ``(n, 2, 2)``, that lie on each other."""
    x = np.sort(lines @ along, axis=1)
    starts, ends = np.sort(x[:, 0]), np.sort(x[:, 1])
    return max(
        int(np.searchsorted(starts, place + tie, side="right") - np.searchsorted(ends, place + tie)) for place in starts
    )


def export_html(pattern: FoldedPattern, profile: Profile | None = None) -> bytes:
    """Return the guide as one HTML file."""
    title = html.escape(printable(pattern.title) or "foldcut")
    parts = [
        f"<section><h2>{number}. {html.escape(step.title)}</h2>"
        f'<div role="img" aria-label="{html.escape(step.title)}">{_bare(step.picture)}</div>'
        f"<p>{html.escape(step.text)}</p></section>"
        for number, step in enumerate(instructions(pattern, (profile or load_profile()).drawing), start=1)
    ]
    style = (
        "body{font:16px/1.4 system-ui,sans-serif;max-width:60rem;margin:0 auto;padding:1rem;color:#1a1a1a}"
        "main{display:grid;grid-template-columns:repeat(auto-fill,minmax(min(100%,20rem),1fr));gap:0 2rem}"
        "h1{grid-column:1/-1}h2{font-size:1.1rem}section{break-inside:avoid;border-top:1px solid #bbb}"
        "svg{width:100%;height:auto;max-width:120mm}"
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
    heading = f"{title}: how to fold it"
    out = io.BytesIO()
    canvas = Canvas(out, pagesize=A4, invariant=True)
    canvas.setTitle(heading)
    canvas.setCreator("foldcut")
    width = (PAGE_MM[0] - 2 * MARGIN_MM - (COLUMNS - 1) * GUTTER_MM) / COLUMNS
    head = Paragraph(html.escape(heading), HEADING)
    _, high = head.wrap((PAGE_MM[0] - 2 * MARGIN_MM) * mm, PAGE_MM[1] * mm)
    y = PAGE_MM[1] - MARGIN_MM - high / mm
    head.drawOn(canvas, MARGIN_MM * mm, y * mm)
    y -= GUTTER_MM / 2
    cells = [
        _Cell(f"{number}. {step.title}", step, width)
        for number, step in enumerate(instructions(pattern, (profile or load_profile()).drawing), start=1)
    ]
    for first in range(0, len(cells), COLUMNS):
        row = cells[first : first + COLUMNS]
        height = max(cell.height for cell in row)
        if y - height < MARGIN_MM:
            canvas.showPage()
            y = PAGE_MM[1] - MARGIN_MM
        for column, cell in enumerate(row):
            cell.draw(canvas, MARGIN_MM + column * (width + GUTTER_MM), y)
        y -= height + GUTTER_MM
    canvas.save()
    return out.getvalue()


HEADING = ParagraphStyle("heading", fontName="Helvetica-Bold", fontSize=18, leading=22)
CAPTION = ParagraphStyle("caption", fontName="Helvetica-Bold", fontSize=11, leading=14)
WORDS = ParagraphStyle("words", fontName="Helvetica", fontSize=9, leading=11.5)


class _Cell:
    """A step on the page: its title, its picture, and its words; ``width`` and ``height`` in mm."""

    def __init__(self, title: str, step: Instruction, width: float) -> None:
        self.marks, size = panels.flat(step.panel)
        self.width = width
        self.title, self.words = Paragraph(html.escape(title), CAPTION), Paragraph(html.escape(step.text), WORDS)
        self.scale = min(width / size[0], HIGHEST_MM / size[1])
        self.picture = size[1] * self.scale
        self.above, self.below = (text.wrap(width * mm, PAGE_MM[1] * mm)[1] / mm for text in (self.title, self.words))
        self.above += LABEL_MM * bool(step.panel.labels)
        self.height = self.above + 1 + self.picture + 1 + self.below

    def draw(self, canvas: Canvas, x: float, top: float) -> None:
        """Draw the step with its upper left corner at a place in mm."""
        self.title.drawOn(canvas, x * mm, top * mm - self.title.height)
        canvas.saveState()
        canvas.translate(x * mm, (top - self.above - 1) * mm)
        canvas.scale(self.scale * mm, self.scale * mm)
        _draw_marks(canvas, self.marks)
        canvas.restoreState()
        self.words.drawOn(canvas, x * mm, (top - self.height) * mm)


def _draw_marks(canvas: Canvas, marks: list[panels.Outline | panels.Text]) -> None:
    """Draw the marks of a panel; a unit of the canvas is 1 mm, and its origin is the upper left corner."""
    canvas.setLineJoin(1)
    for mark in marks:
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


GUIDES: dict[str, Callable[[FoldedPattern], bytes]] = {
    ".html": export_html,
    ".pdf": export_pdf,
    ".svg": export_animation,
}
"""The exporters of guides, by the ending of their files."""
