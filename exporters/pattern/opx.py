"""OPX: the crease pattern as ORIPA's own XML of Java beans.

Input: a ``FoldedPattern``; output: XML with one ``OriLineProxy`` for each edge, in mm, y pointing down, with the types
of .cp. ORIPA and Flat-Folder (io.js, OPX_2_L) read it.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET

from foldcut.core.model import FoldedPattern
from foldcut.profiles import Profile

from ..text import printable
from .edges import TYPES, edge_lines


def _property(name: str, kind: str, form: str) -> str:
    """Return the text of one property of an edge."""
    return f'      <void property="{name}">\n       <{kind}>{form}</{kind}>\n      </void>\n'


EDGE = (
    '    <void index="%d">\n     <object class="oripa.OriLineProxy">\n'
    + _property("type", "int", "%d")
    + "".join(_property(name, "double", "%r") for name in ("x0", "y0", "x1", "y1"))
    + "     </object>\n    </void>\n"
)
"""The text of one edge, to be filled in with its index, its type and its ends."""


def export(pattern: FoldedPattern, profile: Profile) -> bytes:
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
    # an XML element for each of a million numbers would take a gigabyte
    edges = "".join(EDGE % (number, TYPES[letter], *ends) for number, (letter, *ends) in enumerate(edge_lines(pattern)))
    head, end = ET.tostring(root).split(b"EDGES", 1)
    return b'<?xml version="1.0" encoding="UTF-8"?>\n' + head + f"\n{edges}   ".encode() + end + b"\n"
