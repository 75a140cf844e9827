"""SVG of a job, for lasers, cutters and plotters: one layer and one colour for each step, at true size.

Input: a ``Job`` and a ``Profile``; output: SVG 1.1. One user unit is 1 mm, y points down, nothing is transformed; the
drawing is as large as the sheet. Layers are Inkscape's, in the order of the job; AxiDraw reads the order and pauses
from their names, and LightBurn, Glowforge, xTool and Cricut tell steps by their colours. A step is one compound path,
and so one object to them.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import svgwrite
from svgwrite.extensions import Inkscape

from foldcut.jobs.job import Job, JobStep
from foldcut.profiles import Profile

from ..pattern.svg import path_data, with_paths
from ..text import number, printable


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
    paths_of: dict[str, Iterable[str]] = {}
    for count, step in enumerate(job.steps, 1):
        operation = step.operation
        name = f"step-{count}-{step.role}"
        group = inkscape.layer(
            label=operation.layer,
            id=name,
            fill="none",
            stroke=operation.colour,
            stroke_width=number(profile.line_mm),
        )
        drawing.add(group)
        paths_of[name] = [" ".join(_paths(step, height))]
    return with_paths(drawing, paths_of)


def _paths(step: JobStep, height: float) -> Iterator[str]:
    """Yield the path data of each stroke of a step."""
    for stroke in step.strokes:
        closed = len(stroke) > 2 and bool((stroke[0] == stroke[-1]).all())
        points = [(x, height - y) for x, y in (stroke[:-1] if closed else stroke).tolist()]
        yield path_data(points, closed=closed)
