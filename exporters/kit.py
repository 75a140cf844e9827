"""A kit: all that a person needs to make one figure, in one PDF: the printed sheet, and the guide with the result.

The PDF of a job and a ``FoldedPattern`` -> PDF. The pages of the sheet come first and stay as they are, in true size
and with their layers; the guide's pages follow.
"""

from __future__ import annotations

import io

import pikepdf

from foldcut.core.model import FoldedPattern
from foldcut.profiles import Profile

from .pictures.guide import export_pdf

__all__ = ["is_kit", "kit"]

ENDING = "-kit.pdf"
"""How the name of a kit ends."""


def is_kit(name: str) -> bool:
    """Whether a file of this name is a kit."""
    return name.lower().endswith(ENDING)


def kit(sheet: bytes, pattern: FoldedPattern, profile: Profile) -> bytes:
    """Return the PDF of a printed sheet with the guide behind it; the same pattern gives the same bytes."""
    with pikepdf.open(io.BytesIO(sheet)) as pdf, pikepdf.open(io.BytesIO(export_pdf(pattern, profile))) as guide:
        pdf.pages.extend(guide.pages)
        out = io.BytesIO()
        pdf.save(out, deterministic_id=True, compress_streams=True)
    return out.getvalue()
