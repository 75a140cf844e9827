"""Crease patterns as bare lines, for programs that fold them: SVG, .cp and .opx.

Input: a ``FoldedPattern``; output: one line for each edge, in mm, y pointing down, unmerged and unbroken.

- SVG: ``<line style="stroke:...">`` and nothing else, red mountains, blue valleys, black border: what Flat-Folder
  (io.js, SVG_2_L) and Origami Simulator (pattern.js, typeForStroke) read.
- .cp: ``type x1 y1 x2 y2``, 1 border, 2 mountain, 3 valley: ORIPA, Orihime, Flat-Folder (io.js, CP_2_L).
- .opx: ORIPA's own XML of Java beans, the same types (Flat-Folder's io.js, OPX_2_L).
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterator

from foldcut.core.model import FoldedPattern
from foldcut.profiles import Profile

from ..text import printable

STROKES = {"B": "#000000", "M": "#ff0000", "V": "#0000ff"}
TYPES = {"B": 1, "M": 2, "V": 3}
BLOCK = 8192
"""Edges that are turned into Python's numbers at once."""


def _property(name: str, kind: str, form: str) -> str:
    """Return one property of an edge as an .opx file has it."""
    return f'      <void property="{name}">\n       <{kind}>{form}</{kind}>\n      </void>\n'


OPX_EDGE = (
    '    <void index="%d">\n     <object class="oripa.OriLineProxy">\n'
    + _property("type", "int", "%d")
    + "".join(_property(name, "double", "%r") for name in ("x0", "y0", "x1", "y1"))
    + "     </object>\n    </void>\n"
)


def export_svg(pattern: FoldedPattern, profile: Profile) -> bytes:
    """Return the edges as SVG lines; nothing in it depends on the profile."""
    width, height = (f"{size:g}" for size in (pattern.sheet.width, pattern.sheet.height))
    head = (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}mm" height="{height}mm" viewBox="0 0 {width} {height}">'
    )
    lines = (
        f'<line x1="{a!r}" y1="{b!r}" x2="{c!r}" y2="{d!r}" style="stroke:{STROKES[letter]};stroke-width:0.25"/>'
        for letter, a, b, c, d in _edges(pattern)
    )
    return "\n".join(['<?xml version="1.0" encoding="utf-8"?>', head, *lines, "</svg>\n"]).encode()


def export_cp(pattern: FoldedPattern, profile: Profile) -> bytes:
    """Return the edges as a .cp file; nothing in it depends on the profile."""
    lines = (f"{TYPES[letter]} {a!r} {b!r} {c!r} {d!r}\n" for letter, a, b, c, d in _edges(pattern))
    return "".join(lines).encode("ascii")


def export_opx(pattern: FoldedPattern, profile: Profile) -> bytes:
    """Return the edges as an .opx file; nothing in it depends on the profile."""
    root = ET.Element("java", version="1.8.0", attrib={"class": "java.beans.XMLDecoder"})
    data = ET.SubElement(root, "object", attrib={"class": "oripa.DataSet"})
    lines = ET.SubElement(data, "void", property="lines")
    count = len(pattern.creases.edges_vertices)
    array = ET.SubElement(lines, "array", attrib={"class": "oripa.OriLineProxy"}, length=str(count))
    array.text = "EDGES"
    for name, kind, text in (
        ("mainVersion", "int", "1"),
        ("paperSize", "double", repr(max(pattern.sheet.width, pattern.sheet.height))),
        ("title", "string", printable(pattern.title)),
    ):
        ET.SubElement(ET.SubElement(data, "void", property=name), kind).text = text
    ET.indent(root, " ")
    # an element for each of a million numbers would take a gigabyte
    edges = "".join(OPX_EDGE % (number, TYPES[letter], *ends) for number, (letter, *ends) in enumerate(_edges(pattern)))
    head, end = ET.tostring(root).split(b"EDGES", 1)
    return b'<?xml version="1.0" encoding="UTF-8"?>\n' + head + f"\n{edges}   ".encode() + end + b"\n"


def _edges(pattern: FoldedPattern) -> Iterator[tuple[str, float, float, float, float]]:
    """Yield assignment and ends of all edges, y down."""
    creases = pattern.creases
    points = creases.vertices_coords * (1, -1) + (0, pattern.sheet.height)
    for low in range(0, len(creases.edges_vertices), BLOCK):
        some = slice(low, low + BLOCK)
        ends = points[creases.edges_vertices[some]].reshape(-1, 4).tolist()
        for letter, (a, b, c, d) in zip(creases.edges_assignment[some].tolist(), ends, strict=True):
            yield letter, a, b, c, d
