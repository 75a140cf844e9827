"""PDF: a job to print at true size, on one page or on as many as the sheet needs, with a layer for each step.

Input: a ``Job`` and a ``Profile`` with the size of the printer's pages (``bed``) and their margins (``page``); output:
PDF. A sheet larger than a page is divided into tiles that overlap; crosses mark the same places on neighbouring pages.
Every page has a ruler and, in a layer of its own, a legend; one of several has a small picture of all pages. Layers are
optional content (ISO 32000-1, 8.11); viewers are asked not to scale (12.2, PrintScaling).
"""

from __future__ import annotations

import io
import math
from collections import Counter
from collections.abc import Sequence
from textwrap import wrap

import numpy as np
import pikepdf
from pikepdf import Array, Dictionary, Name, String
from reportlab.lib.units import mm
from reportlab.pdfbase.pdfmetrics import stringWidth
from reportlab.pdfgen.canvas import Canvas

from foldcut.core.arrays import Floats
from foldcut.jobs.dashes import mountain_pieces, valley_pieces
from foldcut.jobs.errors import LackingError
from foldcut.jobs.job import Job
from foldcut.jobs.model import Pictogram
from foldcut.jobs.pages import Edge, Tile, flip_edge, pages_behind, tiles
from foldcut.profiles import Profile, Role

from ..legend import BACKING, Ground
from ..pattern.svg import DESCENT, shortened
from ..text import printable
from .pictograms import PICTOGRAMS

A4_BED = ("bed.width_mm=210", "bed.height_mm=297")
A_PAGE = ("page.margin_mm=5", "page.overlap_mm=10")
"""Examples of what a profile may lack."""

MEANING: dict[Role, str] = {
    "mark": "the shape: the one cut goes along it",
    "mountain": "mountain: fold away from you",
    "valley": "valley: fold toward you",
    "cut": "the sheet's edge",
}
"""What the legend says about a role."""

BEHIND: dict[Role, str] = MEANING | {
    "mountain": "mountain, seen from behind: fold toward you",
    "valley": "valley, seen from behind: fold away from you",
}
"""What the legend says on the page of the back."""

PICTOGRAM_MM = 7.0
"""The size of the pictures beside the hints."""

WRAPPED = 44
"""The most letters in a line of a hint where these are broken in two."""

BLACK = "#000000"
"""The colour of these pictures."""

LEGEND = "Legend"
"""The name of the legend's layer."""

FONT = "Helvetica"
"""The font of all words: one that every PDF viewer has."""

RULER_MM = 100.0
"""The length of the ruler on a page that is wide enough."""

MAP_MM = 18.0
"""The longer side of the small picture that shows which of several pages one is."""

MAP_FILL = 0.35
"""The opacity of the page in that picture."""

CROSS_MM = 4.0
"""The size of the crosses where pages overlap."""


def export(job: Job, profile: Profile) -> bytes:
    """Return a job as a PDF file; the same job gives the same bytes.

    Raises JobError: the profile does not say how large a page is, or what margins its printer leaves.
    """
    return _document([job], profile)


def export_duplex(front: Job, back: Job, profile: Profile) -> bytes:
    """Return the jobs of both sides as one PDF, behind each page of the front its back, to print on both sides.

    The file asks viewers for the edge on which to turn the paper over (ISO 32000-1, 12.2, Duplex). Errors as for
    ``export``.
    """
    return _document([front, back], profile)


def _document(jobs: Sequence[Job], profile: Profile) -> bytes:
    if profile.bed is None or profile.page is None:
        lacking = [*(() if profile.bed else A4_BED), *(() if profile.page else A_PAGE)]
        raise LackingError(f"the profile {profile.title!r} lacks what PDF needs", lacking)
    raw = io.BytesIO()
    canvas = Canvas(raw, invariant=True, pageCompression=0)
    canvas.setTitle(printable(jobs[0].title) or "foldcut")
    canvas.setCreator("foldcut")
    layers = [*dict.fromkeys(step.operation.layer for job in jobs for step in job.steps), LEGEND]
    duplex: Edge | None = None
    if len(jobs) == 1:
        pages = [(jobs[0], tile, "") for tile in tiles(jobs[0], profile)]
    else:
        front, back = jobs
        assert back.turned_over is not None
        behind = pages_behind(front, back, profile)
        pages = [page for one, other in behind for page in ((front, one, ""), (back, other, f"back of {_name(one)}"))]
        duplex = flip_edge(back.turned_over, behind[0][0])
    corners_of = {id(job): _corners(job) for job in jobs}
    for job, tile, name in pages:
        corners, lines = corners_of[id(job)]
        canvas.setPageSize((tile.width * mm, tile.height * mm))
        canvas.saveState()
        if tile.tiled:
            clip = canvas.beginPath()
            clip.rect(tile.inset * mm, tile.inset * mm, tile.clear_width * mm, tile.clear_height * mm)
            canvas.clipPath(clip, stroke=0)
        points, end = ((corners - (tile.x, tile.y)) * mm).tolist(), 0
        for step in job.steps:
            canvas._code.append(f"/OC /L{layers.index(step.operation.layer)} BDC")
            canvas.setStrokeColor(step.operation.colour)
            canvas.setLineWidth(profile.line_mm * mm)
            for stroke in step.strokes:
                path = canvas.beginPath()
                start, end = end, end + len(stroke)
                path.moveTo(*points[start])
                for point in points[start + 1 : end]:
                    path.lineTo(*point)
                canvas.drawPath(path)
            canvas._code.append("EMC")
        canvas.restoreState()
        ground = Ground(tile.width, tile.height, profile.page.margin_mm + 2)
        ground.add_lines(lines - (tile.x, tile.y))
        crosses = _crosses(tile, profile.page.overlap_mm) if tile.tiled else np.zeros((0, 2, 2))
        for cross in crosses:
            x, y = (cross.mean(axis=0) - CROSS_MM / 2).tolist()
            ground.fill(x, y, CROSS_MM, CROSS_MM)
        _furniture(canvas, tile, name, profile, ground, crosses)
        if tile.tiled:
            _map(canvas, job, tile, profile, ground)
        canvas._code.append(f"/OC /L{len(layers) - 1} BDC")
        _legend(canvas, job, profile, ground)
        if job.hints and (tile.row, tile.column) == (0, 0):
            _hints(canvas, job, profile, ground)
        canvas._code.append("EMC")
        canvas.showPage()
    canvas.save()
    return _with_layers(raw.getvalue(), layers, duplex)


def _corners(job: Job) -> tuple[Floats, Floats]:
    """Return the corners of a job's strokes one after another, ``(n, 2)``, and its lines, ``(m, 2, 2)``."""
    strokes = [stroke for step in job.steps for stroke in step.strokes]
    corners = np.concatenate([np.zeros((0, 2)), *strokes])
    ends = np.cumsum([len(stroke) for stroke in strokes], dtype=np.int64)
    return corners, np.delete(np.stack([corners[:-1], corners[1:]], axis=1), ends[:-1] - 1, axis=0)


def _name(tile: Tile) -> str:
    """Return what a page is called among several."""
    return f"row {tile.row + 1}, column {tile.column + 1} of {tile.count} pages" if tile.tiled else "the page before"


def _legend(canvas: Canvas, job: Job, profile: Profile, ground: Ground) -> None:
    """Draw the title and a row for each step, in its dashes and colour, where they cover the fewest lines."""
    look = profile.drawing
    size, indent, row = look.text_mm, look.sample_mm + 2, 1.6 * look.text_mm
    sample = np.array([[0.0, 0.0], [look.sample_mm, 0.0]])
    pieces = {"mountain": mountain_pieces(sample, look), "valley": valley_pieces(sample, look)}
    roles = Counter(step.role for step in job.steps)
    # on a test card the rows are steps of the same role
    meaning = BEHIND if job.side == "back" else MEANING
    words = [printable(step.words) or meaning[step.role] for step in job.steps]
    title = shortened(printable(job.title), float(ground.room[0]) / size)
    widths = [*(indent + _width(text, size) for text in words), _width(title, size)]
    place = ground.place([(max(widths), row * len(widths))], size / 2)
    canvas.setFont(FONT, size * mm)
    rows = [*zip(job.steps, words, strict=True)][::-1]
    x, y = place.x, place.y
    for (step, text), width in zip([*rows, (None, title)], [*widths[-2::-1], widths[-1]], strict=True):
        if ground.lines_under(x, y, width, row):
            _backing(canvas, x, y, width, row)
        canvas.setFillColor(look.legend_colour)
        base = y + DESCENT * size
        if step is None:
            canvas.drawString(x * mm, base * mm, text)
            continue
        canvas.setStrokeColor(step.operation.colour)
        canvas.setLineWidth(profile.line_mm * mm)
        dashes = pieces.get(step.role, sample[None]) if roles[step.role] == 1 else sample[None]
        for start, end in dashes.tolist():
            height = base + 0.35 * size
            canvas.line((x + start[0]) * mm, height * mm, (x + end[0]) * mm, height * mm)
        canvas.drawString((x + indent) * mm, base * mm, text)
        y += row
    ground.fill(place.x, place.y, place.width, place.height)


def _hints(canvas: Canvas, job: Job, profile: Profile, ground: Ground) -> None:
    """Draw how difficult it is and what to do, a line with a picture each, where that covers the fewest lines.

    Long lines are broken in two if that covers less. A page that is too small has none.
    """
    look = profile.drawing
    size, row, indent = look.text_mm, PICTOGRAM_MM + 1, PICTOGRAM_MM + 2
    words = [f"{number}. {printable(hint.words)}" for number, hint in enumerate(job.hints, start=1)]
    forms = [[[text] for text in words], [wrap(text, WRAPPED) for text in words]]
    height = row * len(words) + 1.6 * size
    boxes = [(indent + max(_width(text, size) for lines in form for text in lines), height) for form in forms]
    if (ground.room < boxes[-1]).any():
        return
    place = ground.place(boxes, size / 2)
    x, y = place.x, place.y + height - 1.6 * size
    canvas.setFont(FONT, size * mm)
    canvas.setFillColor(look.legend_colour)
    canvas.drawString(x * mm, (y + 0.6 * size) * mm, printable(job.subtitle))
    for hint, lines in zip(job.hints, forms[place.box], strict=True):
        y -= row
        width = indent + max(_width(text, size) for text in lines)
        if ground.lines_under(x, y, width, row):
            _backing(canvas, x, y, width, row)
        _pictogram(canvas, hint.picture, x, y, look.shape_colour)
        canvas.setFillColor(look.legend_colour)
        middle = y + PICTOGRAM_MM / 2 - 0.35 * size
        for number, text in enumerate(lines):
            base = middle + ((len(lines) - 1) / 2 - number) * 1.3 * size
            canvas.drawString((x + indent) * mm, base * mm, text)
    ground.fill(place.x, place.y, place.width, place.height)


def _pictogram(canvas: Canvas, name: Pictogram, x: float, y: float, grey: str) -> None:
    """Draw a small picture with its lower left corner at a place in mm."""
    canvas.saveState()
    canvas.setLineWidth(0.25 * mm)
    canvas.setFillColor(BLACK)
    canvas.setLineJoin(1)
    for stroke in PICTOGRAMS[name]:
        canvas.setStrokeColor(grey if stroke.grey else BLACK)
        canvas.setDash([0.9 * mm, 0.6 * mm] if stroke.dashed else [])
        points = ((stroke.points * PICTOGRAM_MM + (x, y)) * mm).tolist()
        path = canvas.beginPath()
        path.moveTo(*points[0])
        for point in points[1:]:
            path.lineTo(*point)
        canvas.drawPath(path, stroke=1, fill=int(stroke.filled))
    canvas.restoreState()


def _backing(canvas: Canvas, x: float, y: float, width: float, height: float) -> None:
    """Lay translucent white behind words, through which lines can still be seen."""
    canvas.saveState()
    canvas.setFillColor("#ffffff", alpha=BACKING)
    canvas.rect(x * mm, y * mm, width * mm, height * mm, stroke=0, fill=1)
    canvas.restoreState()


def _width(text: str, size: float) -> float:
    """Return the width of a text in mm."""
    return float(stringWidth(text, FONT, size))


def _furniture(canvas: Canvas, tile: Tile, name: str, profile: Profile, ground: Ground, crosses: Floats) -> None:
    """Draw the ruler, the page's ``name`` or its place among the pages, and the crosses."""
    look = profile.drawing
    canvas.setStrokeColor(look.legend_colour)
    canvas.setLineWidth(look.legend_stroke_mm * mm)
    size = look.text_mm
    length = min(RULER_MM, 10 * math.floor((tile.width - 2 * ground.inset) / 10))
    name = name or (_name(tile) if tile.tiled else "")
    words = f"{length:g} mm{'  ' if name else ''}{name}"
    place = ground.place([(length + 2 + _width(words, size), (1 + DESCENT) * size)], size / 2)
    if ground.lines_under(place.x + length, place.y, place.width - length, place.height):
        _backing(canvas, place.x + length + 1, place.y, place.width - length, place.height)
    ground.fill(place.x, place.y, place.width, place.height)
    x, y = place.x, place.y + DESCENT * size
    ruler = canvas.beginPath()
    ruler.moveTo(x * mm, y * mm)
    ruler.lineTo((x + length) * mm, y * mm)
    for n in range(round(length / 10) + 1):
        ruler.moveTo((x + 10 * n) * mm, y * mm)
        ruler.lineTo((x + 10 * n) * mm, (y + size) * mm)
    canvas.drawPath(ruler)
    canvas.setFillColor(look.legend_colour)
    canvas.setFont(FONT, size * mm)
    canvas.drawString((x + length + 2) * mm, y * mm, words)
    marks = canvas.beginPath()
    for start, end in (crosses * mm).tolist():
        marks.moveTo(*start)
        marks.lineTo(*end)
    canvas.drawPath(marks)


def _map(canvas: Canvas, job: Job, tile: Tile, profile: Profile, ground: Ground) -> None:
    """Draw a small picture of the sheet and of all pages, with this one filled, where it covers the fewest lines."""
    look = profile.drawing
    every = list(tiles(job, profile))
    places = np.array([(one.x + one.inset, one.y + one.inset) for one in every])
    low = np.minimum(places.min(axis=0), 0.0)
    high = np.maximum((places + np.array([tile.clear_width, tile.clear_height])).max(axis=0), job.size)
    scale = MAP_MM / float((high - low).max())
    width, height = ((high - low) * scale).tolist()
    place = ground.place([(width, height)], look.text_mm / 2)
    if ground.lines_under(place.x, place.y, width, height):
        _backing(canvas, place.x, place.y, width, height)
    ground.fill(place.x, place.y, width, height)
    corner = np.array([place.x, place.y])
    canvas.setStrokeColor(look.legend_colour)
    canvas.setLineWidth(look.legend_stroke_mm * mm)
    size = (tile.clear_width * scale * mm, tile.clear_height * scale * mm)
    for one, (x, y) in zip(every, ((places - low) * scale + corner).tolist(), strict=True):
        here = (one.row, one.column) == (tile.row, tile.column)
        if here:
            canvas.setFillColor(look.legend_colour, alpha=MAP_FILL)
        canvas.rect(x * mm, y * mm, *size, stroke=1, fill=int(here))
    canvas.setFillColor(look.legend_colour, alpha=1)
    x, y = (-low * scale + corner).tolist()
    canvas.setLineWidth(2 * look.legend_stroke_mm * mm)
    canvas.rect(x * mm, y * mm, job.size[0] * scale * mm, job.size[1] * scale * mm, stroke=1, fill=0)


def _crosses(tile: Tile, overlap: float) -> Floats:
    """Return the lines of the four crosses where pages overlap, ``(8, 2, 2)``."""
    lines = []
    for x in (tile.inset + overlap / 2, tile.width - tile.inset - overlap / 2):
        for y in (tile.inset + overlap / 2, tile.height - tile.inset - overlap / 2):
            for dx, dy in ((CROSS_MM / 2, 0.0), (0.0, CROSS_MM / 2)):
                lines.append([(x - dx, y - dy), (x + dx, y + dy)])
    return np.array(lines)


def _with_layers(data: bytes, names: list[str], duplex: Edge | None = None) -> bytes:
    """Return the file with its marked content made into layers, and the request not to scale it.

    ``duplex``: it asks to be printed on both sides, turned over on this edge.
    """
    with pikepdf.open(io.BytesIO(data)) as pdf:
        groups = [pdf.make_indirect(Dictionary(Type=Name.OCG, Name=String(name))) for name in names]
        order = Array(groups)
        pdf.Root.OCProperties = Dictionary(OCGs=Array(groups), D=Dictionary(Order=order, ON=Array(groups)))
        pdf.Root.ViewerPreferences = Dictionary(PrintScaling=Name("/None"))
        if duplex is not None:
            pdf.Root.ViewerPreferences.Duplex = Name(f"/DuplexFlip{duplex.capitalize()}Edge")
        for page in pdf.pages:
            page.Resources.Properties = Dictionary({f"/L{number}": group for number, group in enumerate(groups)})
        out = io.BytesIO()
        pdf.save(out, deterministic_id=True, compress_streams=True)
    return out.getvalue()
