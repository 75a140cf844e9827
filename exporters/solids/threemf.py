"""3MF: the scored sheet, or the folded one, as triangles that share their corners, for 3D printers.

Input: a ``FoldedPattern`` and a ``Profile`` with ``solid``; output: a 3MF package, mm. Source: 3MF core specification
1.3, chapters 2 (package) and 4 (mesh). Needs the extra ``solids``.
"""

from __future__ import annotations

from xml.sax.saxutils import escape

from foldcut.core.model import FoldedPattern
from foldcut.profiles import Profile

from ..bundle import zipped
from ..text import number, printable
from .folded_stack import solid_of
from .scored_sheet import corners_and_triangles

CONTENT_TYPES = (
    '<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">'
    '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
    '<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>'
    "</Types>"
)
RELATIONSHIPS = (
    '<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">'
    '<Relationship Target="/3D/3dmodel.model" Id="rel0" '
    'Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>'
    "</Relationships>"
)
CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
DECIMALS = 6
"""Digits of a length in mm after the point."""


def export(pattern: FoldedPattern, profile: Profile) -> bytes:
    """Return the sheet as a 3MF file; errors as for ``solid_of``."""
    points, triangles = corners_and_triangles(solid_of(pattern, profile).to_mesh64())
    corners = "".join(
        f'<vertex x="{number(x, DECIMALS)}" y="{number(y, DECIMALS)}" z="{number(z, DECIMALS)}"/>'
        for x, y, z in points.tolist()
    )
    faces = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in triangles.tolist())
    title = escape(printable(pattern.title) or "foldcut")
    model = (
        f'<model unit="millimeter" xml:lang="en" xmlns="{CORE}"><metadata name="Title">{title}</metadata>'
        f'<resources><object id="1" type="model"><mesh><vertices>{corners}</vertices>'
        f'<triangles>{faces}</triangles></mesh></object></resources><build><item objectid="1"/></build></model>'
    )
    parts = {"[Content_Types].xml": CONTENT_TYPES, "_rels/.rels": RELATIONSHIPS, "3D/3dmodel.model": model}
    return zipped({name: f'<?xml version="1.0" encoding="UTF-8"?>\n{text}'.encode() for name, text in parts.items()})
