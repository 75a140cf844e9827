"""A folding guide: what to press first, what to collapse, where to cut, with a picture of each step; HTML or PDF.

Input: a ``FoldedPattern``; output: one HTML file that loads nothing, or a PDF on A4. Lines are pressed in groups, the
longest first, and both ways, so that they go either way in the collapse. The collapse itself is one movement of all
creases: the guide says so, and shows what must come out.
"""

from __future__ import annotations

import html
import io
import math
from collections.abc import Sequence
from dataclasses import dataclass

from foldcut.foldability import foldability
from foldcut.marks import pressing_order
from foldcut.model import Floats, FoldedPattern
from foldcut.profiles import Drawing, Profile, load_profile

from . import pictures
from .text import printable

LINES_A_STEP, MOST_GROUPS = 12, 8
NOW, DONE, LATER = "#d35400", "#888888", "#dddddd"
PICTURE_MM = 90


@dataclass(frozen=True)
class Step:
    """What to do, in words, with a square picture as SVG."""

    title: str
    text: str
    picture: bytes


def steps(pattern: FoldedPattern, look: Drawing) -> list[Step]:
    """Return the steps from the flat sheet to the shape cut out."""
    firsts, rest = pressing_order(pattern)
    numbers = foldability(pattern)
    size = max(LINES_A_STEP, math.ceil(len(rest) / MOST_GROUPS))
    groups = [rest[at : at + size] for at in range(0, len(rest), size)]
    advice = [f"{numbers.layers_at_cut} layers will lie on the cut, {numbers.layers} at the thickest place"]
    advice += [f"the shortest crease is {numbers.shortest_crease_mm:.1f} mm long"] if numbers.shortest_crease_mm else []
    text = f"Print or score the pattern in true size, on a sheet of {pattern.sheet}. For office paper: "
    made = [
        Step("The sheet", text + "; ".join([*advice, *numbers.warnings]) + ".", _panel(pattern, look, "pattern")),
    ]
    for number, line in enumerate(firsts):
        through = "the sheet" if number == 0 else "all layers"
        made.append(
            Step(
                "Fold in half",
                f"Fold {through} along the marked line, away from you, and leave it folded.",
                _lines(pattern, firsts[:number], [line], rest),
            )
        )
    layers = 2 ** len(firsts)
    through = f" through all {layers} layers" if layers > 1 else ""
    for number, group in enumerate(groups):
        before = [line for earlier in groups[:number] for line in earlier]
        shortest = min(math.dist(*line) for line in group)
        made.append(
            Step(
                f"Press creases, {number + 1} of {len(groups)}",
                f"Crease the {len(group)} marked lines{through}, sharply and both ways, and open them again. "
                f"The shortest is {shortest:.1f} mm long.",
                _lines(pattern, [*firsts, *before], group, [line for later in groups[number + 1 :] for line in later]),
            )
        )
    heights = pattern.folded.vertices_coords[:, 1]
    made += [
        Step(
            "Collapse",
            "Now all creases close together: this is one movement and not a row of simple folds. Bend every mountain "
            "(dash-dotted) away from you and every valley (dashed) toward you, a little everywhere, then more, until "
            "the sheet lies flat like this. The outline of the shape comes to lie on one straight line.",
            _panel(pattern, look, "folded"),
        ),
        Step(
            "Check the layers",
            "Drawn apart, from the lowest on the left to the highest on the right, the layers follow each other so. "
            "The red line is where the shape begins.",
            _panel(pattern, look, "layers"),
        ),
        Step(
            "Cut",
            f"Cut once, straight, along the outline of the shape: level, {heights.max():.1f} mm under the highest "
            f"point of the folded sheet and {-heights.min():.1f} mm over its lowest, as in the picture.",
            _panel(pattern, look, "folded"),
        ),
        Step(
            "Unfold",
            "The upper part is the shape, the lower part the sheet around it.",
            _panel(pattern, look, "pieces"),
        ),
    ]
    return made


def _panel(pattern: FoldedPattern, look: Drawing, name: str) -> bytes:
    return pictures.one_panel(*pictures.PANELS[name][1](pattern, look))


def _lines(pattern: FoldedPattern, done: Sequence[Floats], now: Sequence[Floats], later: Sequence[Floats]) -> bytes:
    strokes = [(line[None], colour) for some, colour in ((later, LATER), (done, DONE), (now, NOW)) for line in some]
    return pictures.one_panel([(pattern.sheet.corners, "#ffffff")], strokes)


def export_html(pattern: FoldedPattern, profile: Profile | None = None) -> bytes:
    """Return the guide as one HTML file."""
    title = html.escape(printable(pattern.title) or "foldcut")
    parts = [
        f"<section><h2>{number}. {html.escape(step.title)}</h2><p>{html.escape(step.text)}</p>"
        f'<div role="img" aria-label="{html.escape(step.title)}">{step.picture.decode()}</div></section>'
        for number, step in enumerate(steps(pattern, (profile or load_profile()).drawing), start=1)
    ]
    style = (
        "body{font:16px/1.4 system-ui,sans-serif;max-width:46rem;margin:0 auto;padding:1rem;color:#1a1a1a}"
        "section{break-inside:avoid;border-top:1px solid #bbb}svg{width:100%;height:auto;max-width:110mm}"
    )
    head = (
        '<meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>{title}: how to fold it</title><style>{style}</style>"
    )
    body = f"<main><h1>{title}: how to fold it</h1>{''.join(parts)}</main>"
    return f'<!DOCTYPE html>\n<html lang="en"><head>{head}</head><body>{body}</body></html>\n'.encode()


def export_pdf(pattern: FoldedPattern, profile: Profile | None = None) -> bytes:
    """Return the guide as a PDF on A4; the same pattern gives the same bytes."""
    from reportlab.lib.pagesizes import A4
    from reportlab.lib.styles import getSampleStyleSheet
    from reportlab.lib.units import mm
    from reportlab.platypus import Image, KeepTogether, Paragraph, SimpleDocTemplate, Spacer

    from .png import rendered

    title = printable(pattern.title) or "foldcut"
    look, flow = getSampleStyleSheet(), []
    flow.append(Paragraph(f"{html.escape(title)}: how to fold it", look["Title"]))
    for number, step in enumerate(steps(pattern, (profile or load_profile()).drawing), start=1):
        picture = io.BytesIO(rendered(step.picture, (pictures.PANEL_MM, pictures.PANEL_MM)))
        block = [
            Paragraph(f"{number}. {html.escape(step.title)}", look["Heading2"]),
            Paragraph(html.escape(step.text), look["BodyText"]),
            Spacer(1, 3 * mm),
            Image(picture, PICTURE_MM * mm, PICTURE_MM * mm),
        ]
        flow.append(KeepTogether(block))
    out = io.BytesIO()
    SimpleDocTemplate(out, pagesize=A4, title=f"{title}: how to fold it", creator="foldcut", invariant=1).build(flow)
    return out.getvalue()


GUIDES = {".html": export_html, ".pdf": export_pdf}
