"""Read DXF with ezdxf, which mends broken files: closed curves, chains of lines, hatches, blocks.

Curves become segments within the tolerance; open lines are joined end to end. Hatches are read only if there are no
outlines, since they usually repeat them. ``unit_mm`` follows from $INSUNITS; 0 means that the file does not say. Layers
that are off or frozen are passed over, as are blocks from other files.
"""

from __future__ import annotations

import io
import logging
import math
from collections import Counter
from collections.abc import Iterator
from typing import Any

import numpy as np
from ezdxf import path as paths
from ezdxf import recover
from ezdxf.enums import InsertUnits
from ezdxf.units import conversion_factor

from foldcut.core.arrays import Floats, points_array
from foldcut.core.errors import FileFormatError
from foldcut.drawing.limits import Limits
from foldcut.geometry.curves import Arc, Bezier, Line, Segment
from foldcut.readers.base import Drawing, ReadOptions, Source, counted
from foldcut.readers.join_outlines import Outline, loops_of

# ezdxf logs everything that it mends; what matters of that is in the error messages.
logging.getLogger("ezdxf").setLevel(logging.CRITICAL)

OUTLINES = {"LWPOLYLINE", "POLYLINE", "LINE", "ARC", "SPLINE", "CIRCLE", "ELLIPSE", "SOLID", "TRACE"}
"""Entities that draw outlines."""

FILLS = {"HATCH", "MPOLYGON"}
"""Entities that are read only if there are no outlines."""

MOST_ENTITIES = 200_000
"""A file that shows more entities is refused; those of blocks count as often as they are shown."""


def read(source: Source, options: ReadOptions) -> Drawing:
    """Return the drawing in a DXF file's model space; its title is the name of the file."""
    try:
        document, _ = recover.read(io.BytesIO(source.data))
        return _read(document, source.name, options)
    except FileFormatError:
        raise
    except RecursionError:  # ezdxf reads blocks by recursion
        raise options.limits.too_deep() from None
    except Exception as error:  # ezdxf raises all kinds of errors where a file is broken
        about = " ".join(str(error).split())[:120] or type(error).__name__
        raise FileFormatError(f"not a DXF file that can be read: {about}; save the drawing again as DXF") from None


def _read(document: Any, title: str, options: ReadOptions) -> Drawing:
    ignored: Counter[str] = Counter()
    layers: set[str] = set()
    shown: list[tuple[str, list[paths.Path]]] = []
    wanted = {layer.casefold() for layer in options.layers}
    for entity in _entities(document, ignored, options.limits):
        layers.add(entity.dxf.layer)
        if wanted and entity.dxf.layer.casefold() not in wanted:
            continue
        kind = entity.dxftype()
        if kind in FILLS:
            shown.append((kind, list(paths.from_hatch(entity))))
        elif kind in OUTLINES:
            shown.append((kind, [paths.make_path(entity)]))
        else:
            ignored[kind] += 1
    if any(kind in OUTLINES for kind, _ in shown):
        ignored.update(kind for kind, _ in shown if kind in FILLS)
        shown = [one for one in shown if one[0] in OUTLINES]
    shown = [(kind, [one for one in outlines if len(one)]) for kind, outlines in shown]
    if not any(outlines for _, outlines in shown):
        where = f" in --layer {', '.join(options.layers)}" if wanted else ""
        raise FileFormatError(
            f"there is no outline{where}; the file has the layers {', '.join(sorted(layers)[:20]) or 'none'}: "
            "draw closed polylines, lines or arcs"
        )
    unit: Any = document.header.get("$INSUNITS", 0)
    unit_mm = float(conversion_factor(InsertUnits(unit), InsertUnits.Millimeters)) if 1 <= unit <= 20 else None
    corners = np.array([point for _, outlines in shown for one in outlines for point in one.control_vertices()])
    extent = float(np.ptp(corners[:, :2], axis=0).max())
    if not extent > 0 or not math.isfinite(extent):
        raise FileFormatError("the drawing has no size; draw a closed outline with finite coordinates")
    tolerance = options.units(options.flatten_mm, unit_mm, extent)
    outlines = [
        Outline(list(_lines(drawn, tolerance, closed=kind in FILLS)), curves=[_curve(one) for one in drawn])
        for kind, drawn in shown
    ]
    found = loops_of(outlines, options, unit_mm, extent)
    notes = found.notes
    if np.ptp(corners[:, 2]) > 0:
        notes += ("the z coordinates were ignored",)
    return Drawing(found.loops, unit_mm, title, notes, False, counted(ignored), found.repairs, found.curves)


def _curve(outline: paths.Path) -> list[Segment]:
    """Return the segments of an outline; nothing if all are straight, or if it is drawn in several parts."""
    if not outline.has_curves or outline.has_sub_paths:
        return []
    segments: list[Segment] = []
    at = outline.start
    for command in outline.commands():
        if isinstance(command, paths.Curve3To):
            nodes = [at, command.ctrl, command.end]
        elif isinstance(command, paths.Curve4To):
            nodes = [at, command.ctrl1, command.ctrl2, command.end]
        else:
            nodes = [at, command.end]
        points = np.array([(node.x, node.y) for node in nodes], dtype=np.float64)
        arc = Arc.of_cubic(points) if len(points) == 4 else None  # ezdxf makes Béziers of arcs
        segments.append(arc or (Line(*points) if len(points) == 2 else Bezier(points)))
        at = command.end
    return segments


def _lines(outlines: list[paths.Path], tolerance: float, *, closed: bool) -> Iterator[tuple[Floats, bool]]:
    """Yield the points of flattened outlines, ``(n, 2)``, and whether each is closed."""
    for outline in outlines:
        points = points_array([(point.x, point.y) for point in outline.flattening(tolerance, 4)])
        yield points, closed or outline.is_closed


def _entities(document: Any, ignored: Counter[str], limits: Limits) -> Iterator[Any]:
    """Yield the visible entities of the model space, and of the blocks that it shows."""
    waiting = [(entity, 0) for entity in reversed(document.modelspace())]
    count = 0
    while waiting:
        entity, depth = waiting.pop()
        count += 1
        if count > MOST_ENTITIES:
            raise FileFormatError(f"more than {MOST_ENTITIES:,} entities are shown; give a simpler drawing")
        layer = document.layers.get(entity.dxf.layer) if entity.dxf.layer in document.layers else None
        if entity.dxf.get("invisible", 0) or (layer is not None and (layer.is_off() or layer.is_frozen())):
            ignored["hidden object"] += 1
        elif entity.dxftype() != "INSERT":
            yield entity
        elif entity.block() is None or entity.block().block.is_xref:
            ignored["external reference"] += 1
        else:
            limits.check_nesting(depth + 1)
            inserts = entity.multi_insert() if entity.mcount > 1 else [entity]
            for insert in inserts:
                count += 1
                if count > MOST_ENTITIES:
                    raise FileFormatError(f"more than {MOST_ENTITIES:,} entities are shown; give a simpler drawing")
                for part in insert.virtual_entities():
                    if part.dxf.layer == "0":
                        part.dxf.layer = entity.dxf.layer
                    waiting.append((part, depth + 1))
