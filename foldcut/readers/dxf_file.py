"""From the bytes of a DXF file to a document of ezdxf, without those entities that cannot be read.

ezdxf gives up on a whole file for one entity that it cannot read. Here every entity is tried alone first; what fails is
left out and counted. Two kinds are mended instead: entities of later versions in a file that calls itself R12, and
entities without the markers between their parts. Splines are trimmed to where they are defined (docs/ezdxf-splines.md).
"""

from __future__ import annotations

import io
from collections import Counter
from collections.abc import Iterator
from typing import Any

import numpy as np
from ezdxf.audit import Auditor
from ezdxf.document import Drawing
from ezdxf.entities import factory
from ezdxf.lldxf.const import DXFStructureError
from ezdxf.lldxf.extendedtags import ExtendedTags
from ezdxf.lldxf.tags import Tags
from ezdxf.lldxf.types import DXFTag
from ezdxf.recover import Recover, bytes_loader

from foldcut.core.arrays import Floats

UNREADABLE = "unreadable {}"
"""What is counted for an entity that is left out, by its kind."""

R12, R2000 = "AC1009", "AC1015"

_MARKERS = {
    "LWPOLYLINE": ("AcDbPolyline", {90, 70, 43, 38, 39, 10}),
    "SPLINE": ("AcDbSpline", {210, 70, 71, 72, 73, 74, 42, 43, 44, 40, 10, 11, 12, 13}),
    "ELLIPSE": ("AcDbEllipse", {10, 11, 210, 40, 41, 42}),
    "HATCH": ("AcDbHatch", {10, 210, 2, 70, 71, 91}),
}
"""Kinds that R12 does not have: the marker of their own part, and the codes that it can begin with."""

_FLOATS = (range(10, 60), range(110, 150), range(210, 240), range(460, 470), range(1010, 1060))
"""The codes of floating point numbers."""

MOST_DEGREES = 25
"""A spline of a higher degree is not read."""

_STRUCTURE = {"SECTION", "BLOCK", "ENDBLK", "SEQEND"}
"""What is not an entity, and cannot be left out."""


def document_of(data: bytes, ignored: Counter[str]) -> Drawing:
    """Return the document in a DXF file; what is left out is counted in ``ignored``.

    Raises ``DXFError``, or another error of ezdxf, if the file as a whole cannot be read.
    """
    try:
        tool = _Recover.run(io.BytesIO(data))
        document = _loaded(tool.section_dict, tool.broken)
    except RecursionError:
        raise
    except Exception:  # whatever an entity raises
        tool = _Recover.run(io.BytesIO(data), _with_numbers)
        sections: Any = tool.section_dict
        for name in ("ENTITIES", "BLOCKS"):
            if name in sections:
                sections[name] = list(_readable(sections[name], tool.dxfversion, tool.broken))
        document = _loaded(sections, tool.broken)
    ignored.update(tool.broken)
    return document


def _with_numbers(stream: Any) -> Iterator[DXFTag]:
    """Yield the tags of a file with nan for what should be a number and is none, so that its entity is left out."""
    for tag in bytes_loader(stream):
        if any(tag.code in codes for codes in _FLOATS):
            try:
                float(tag.value)
            except ValueError:
                yield DXFTag(tag.code, b"nan")
                continue
        yield tag


def _loaded(sections: Any, broken: Counter[str]) -> Drawing:
    """Return the document after ezdxf's audit, which takes entities away; these are counted."""
    document = Drawing()
    document._load_section_dict(sections)
    before = _kinds(document)
    Auditor(document).run()
    broken.update({UNREADABLE.format(kind): count for kind, count in (before - _kinds(document)).items()})
    return document


def _kinds(document: Drawing) -> Counter[str]:
    """Return how many entities of each kind the model space and the blocks have."""
    layouts = (block for block in document.blocks if not block.name.lower().startswith("*paper"))
    return Counter(entity.dxftype() for block in layouts for entity in block if entity.is_alive)


class _Recover(Recover):
    """ezdxf's tool for broken files; it leaves single entities out, and counts them."""

    def __init__(self, loader: Any = None) -> None:
        super().__init__(loader)
        self.broken: Counter[str] = Counter()

    def is_newer(self) -> bool:
        """Whether a file that calls itself R12 has entities of later versions; then it is called one of these."""
        sections: Any = self.section_dict
        every = (tags for name in ("ENTITIES", "BLOCKS") for tags in sections.get(name, []))
        if not any(str(tags[0].value) in _MARKERS for tags in every):
            return False
        self.dxfversion = R2000
        header = sections["HEADER"][0]
        at = next((at for at, tag in enumerate(header) if tag == (9, "$ACADVER")), None)
        if at is None:
            header[2:2] = [DXFTag(9, "$ACADVER"), DXFTag(1, R2000)]
        else:
            header[at + 1] = DXFTag(1, R2000)
        return True

    def check_entities(self, entities: list[Tags], is_r12: bool) -> Iterator[Tags]:
        """Yield the entities that are made as they should be, with markers where they need some."""
        for entity in entities:
            kind = str(entity[0].value)
            try:
                for tags in super().check_entities([entity], is_r12):
                    yield _marked(tags, kind)
            except DXFStructureError:
                if kind in _STRUCTURE:
                    raise
                self.broken[UNREADABLE.format(kind)] += 1

    @classmethod
    def run(cls, stream: Any, loader: Any = None, errors: str = "surrogateescape") -> _Recover:
        """Return the tool with the sections of a file; as in the base class, which makes one of its own kind."""
        tool: Any = cls(loader)
        tool.load_section_dict(tool.rebuild_sections(tool.load_tags(stream, errors)))
        sections = tool.section_dict
        if "TABLES" in sections:
            sections["TABLES"] = tool.rebuild_tables(sections["TABLES"])
        is_r12 = tool.dxfversion <= R12 and not tool.is_newer()
        if not is_r12:
            tool.recover_rootdict()
        for name in ("TABLES", "BLOCKS", "OBJECTS", "ENTITIES"):
            if name in sections:
                sections[name] = list(tool.check_entities(sections[name], is_r12))
        made: _Recover = tool
        return made


def _marked(tags: Tags, kind: str) -> Tags:
    """Return the tags of an entity with the markers of its parts."""
    marker, codes = _MARKERS.get(kind, ("", set()))
    if not marker or any(tag == (100, marker) for tag in tags):
        return tags
    kept = [tag for tag in tags if tag.code != 100]
    first = next((at for at, tag in enumerate(kept) if at and tag.code in codes), len(kept))
    start = 1 + sum(tag.code in (5, 330) for tag in kept[1:first])
    head = sorted(kept[1:first], key=lambda tag: tag.code not in (5, 330))
    whole = [kept[0], *head[: start - 1], DXFTag(100, "AcDbEntity"), *head[start - 1 :], DXFTag(100, marker)]
    return Tags([*whole, *kept[first:]])


def _readable(entities: list[Tags], version: str, broken: Counter[str]) -> Iterator[Tags]:
    """Yield the entities that ezdxf can load."""
    document = Drawing.new(max(version, R12))
    for tags in entities:
        kind = str(tags[0].value)
        try:
            if kind not in _STRUCTURE:
                factory.load(ExtendedTags(Tags(tags)), document)
        except RecursionError:
            raise
        except Exception:  # ezdxf raises all kinds of errors
            broken[UNREADABLE.format(kind)] += 1
            continue
        yield tags


def trim_spline(entity: Any) -> None:
    """Change a spline so that it begins and ends where it is defined, from knot p to knot n, on the same curve.

    p is the degree and n the number of control points. At both ends knots are inserted until there are p at one place
    (Boehm; The NURBS Book, section 5.2), and what lies outside is left out. ezdxf takes a spline from its first knot to
    its last one, which is the same only where p + 1 knots are equal at both ends. Raises ``ValueError`` for a degree
    that is too high.
    """
    degree = int(entity.dxf.degree)
    if degree > MOST_DEGREES:
        raise ValueError(f"a spline of degree {degree}")
    points = np.array([tuple(point) for point in entity.control_points], dtype=np.float64).reshape(-1, 3)
    knots = np.array(entity.knots, dtype=np.float64)
    count = len(points)
    if count <= degree or len(knots) != count + degree + 1 or not (np.diff(knots) >= 0).all():
        return
    first, last = knots[degree], knots[count]
    if (knots[0] == first and knots[-1] == last) or not first < last:
        return
    weights = np.array(entity.weights, dtype=np.float64) if len(entity.weights) == count else np.ones(count)
    nodes = np.column_stack([points * weights[:, None], weights])
    for knot in (first, last):
        while np.count_nonzero(knots == knot) < degree:
            knots, nodes = _with_knot(knots, nodes, degree, float(knot))
    start, end = int(np.argmax(knots == first)), int(np.argmax(knots == last))
    nodes = nodes[start - 1 : end]
    inner = knots[start : end + degree]
    entity.control_points = nodes[:, :3] / nodes[:, 3:]
    entity.knots = [first, *inner.tolist(), last]
    if len(entity.weights):
        entity.weights = nodes[:, 3].tolist()


def _with_knot(knots: Floats, nodes: Floats, degree: int, knot: float) -> tuple[Floats, Floats]:
    """Return the knots and the control points of the same spline with one knot more."""
    span = int(np.searchsorted(knots, knot, side="right")) - 1
    span = min(span, len(nodes) - 1)
    made = [*nodes[: span - degree + 1]]
    for at in range(span - degree + 1, span + 1):
        length = knots[at + degree] - knots[at]
        share = (knot - knots[at]) / length if length else 0.0
        made.append((1 - share) * nodes[at - 1] + share * nodes[at])
    made += [*nodes[span:]]
    return np.insert(knots, span + 1, knot), np.array(made)
