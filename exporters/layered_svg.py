"""SVG of a job, for lasers, cutters and plotters: one layer and one colour for each operation, in true size.

Input: a ``Job`` and a ``Profile``; output: SVG 1.1. One user unit is 1 mm, y points down, nothing is transformed; the
drawing is as large as the sheet. Layers are Inkscape's, in the order of the job; AxiDraw reads order and pauses off
their names, LightBurn, Glowforge, xTool and Cricut go by the colours.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET

import svgwrite
from svgwrite.extensions import Inkscape

from foldcut.job import Job
from foldcut.profiles import Profile

from .svg import path_data
from .text import number, printable


def export(job: Job, profile: Profile) -> bytes:
    """Return a job as an SVG file."""
    width, height = job.size
    drawing = svgwrite.Drawing(
        size=(f"{number(width)}mm", f"{number(height)}mm"),
        viewBox=f"0 0 {number(width)} {number(height)}",
        debug=False,
    )
    drawing.set_desc(title=printable(job.title) or "foldcut")
    inkscape = Inkscape(drawing)
    for count, step in enumerate(job.steps, 1):
        operation = step.operation
        group = inkscape.layer(
            label=operation.layer,
            id=f"step-{count}-{step.role}",
            fill="none",
            stroke=operation.colour,
            stroke_width=number(profile.drawing.crease_stroke_mm),
        )
        for stroke in step.strokes:
            closed = len(stroke) > 2 and bool((stroke[0] == stroke[-1]).all())
            points = [(x, height - y) for x, y in (stroke[:-1] if closed else stroke).tolist()]
            group.add(drawing.path(d=path_data(points, closed=closed)))
        drawing.add(group)
    root = drawing.get_xml()
    ET.indent(root, " ")
    text = ET.tostring(root, encoding="unicode")
    return f'<?xml version="1.0" encoding="utf-8"?>\n{text}\n'.encode()
