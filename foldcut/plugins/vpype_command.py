"""The command ``foldcut`` of vpype: the lines that were drawn -> layers with the crease pattern, for a plotter.

vpype hands its lines over as SVG, so they are read, joined and mended as a drawing is that comes from a file.
"""

from __future__ import annotations

import io

import click
import vpype as vp
import vpype_cli

from foldcut.core.errors import FoldcutError
from foldcut.core.model import FoldedPattern
from foldcut.core.units import MM_PER_UNIT, in_mm
from foldcut.options import Options
from foldcut.pipeline import fold
from foldcut.readers import ReadOptions, read_shape
from foldcut.redraw.bounds import LEVELS

LAYERS = {"M": ("Mountain", "red"), "V": ("Valley", "blue"), "C": ("Cut", "black")}
"""What the layers of a pattern are called, and their colours."""


@click.command()
@click.option("-s", "--sheet", default="a4", show_default=True, help="A paper size such as a4, or WIDTHxHEIGHT.")
@click.option("-m", "--margin", default="10mm", show_default=True, help="Room kept free along the sheet's edges.")
@click.option("-l", "--level", type=click.Choice([*LEVELS]), help="How near the outline stays to the drawing.")
@click.option("-e", "--effort", type=click.Choice(["fast", "normal", "best"]), default="normal", show_default=True)
@click.option("-j", "--join", help="Join ends of lines that are no farther apart than this, such as 1mm.")
@vpype_cli.global_processor  # type: ignore[untyped-decorator]
def foldcut(
    document: vp.Document, sheet: str, margin: str, level: str | None, effort: str, join: str | None
) -> vp.Document:
    """Fold a sheet so that one straight cut cuts the drawing out.

    The lines become three layers on the sheet: mountains (1), valleys (2) and what the cut cuts out (3). The pattern
    is proven first.

    Example: vpype read star.svg foldcut --sheet a5 write pattern.svg
    """
    text = io.StringIO()
    vp.write_svg(text, document, page_size=document.page_size or (1e3, 1e3), set_date=False)
    try:
        drawing = read_shape("drawing.svg", ReadOptions(join_mm=in_mm(join)), text.getvalue().encode())
        options = Options(sheet=sheet, margin=margin, level=level or "", effort=effort)
        return pattern_layers(fold(drawing, options).require_verified())
    except FoldcutError as error:
        raise click.ClickException(f"foldcut: {error}") from None


def pattern_layers(pattern: FoldedPattern) -> vp.Document:
    """Return a document of vpype, in its pixels, y down: a layer for each kind of line."""
    made = vp.Document(page_size=(_px(pattern.sheet.width), _px(pattern.sheet.height)))
    creases = pattern.creases
    for number, (kind, (name, colour)) in enumerate(LAYERS.items(), start=1):
        if kind == "C":
            lines = [[*loop, loop[0]] for loop in pattern.shape.loops]
        else:
            ends = creases.edges_vertices[creases.edges_assignment == kind]
            lines = [list(points) for points in creases.vertices_coords[ends]]
        height = pattern.sheet.height
        made.add([[complex(_px(x), _px(height - y)) for x, y in line] for line in lines], layer_id=number)
        made.layers[number].set_property(vp.METADATA_FIELD_NAME, name)
        made.layers[number].set_property(vp.METADATA_FIELD_COLOR, vp.Color(colour))
    return made


def _px(length_mm: float) -> float:
    return float(length_mm) / MM_PER_UNIT["px"]
