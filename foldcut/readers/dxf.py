"""Read DXF with ezdxf, which mends broken files: closed curves, chains of lines, hatches, blocks.

``readers.dxf_file`` leaves out entities that cannot be read; here those are left out that cannot be drawn. Curves
become segments within the tolerance; open lines are joined end to end. Hatches are read only if there are no outlines,
since they usually repeat them. ``unit_mm`` follows from $INSUNITS; 0 means that the file does not say. Layers
that are off or frozen are passed over, as are blocks from other files.
"""

from __future__ import annotations

import logging
import math
from collections import Counter
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from ezdxf import path as paths
from ezdxf.enums import InsertUnits
from ezdxf.units import conversion_factor

from foldcut.core.arrays import Floats, points_array
from foldcut.core.errors import FileFormatError
from foldcut.drawing.limits import Limits
from foldcut.geometry.curves import Arc, Bezier, Line, Segment
from foldcut.readers.base import Drawing, ReadOptions, Source, counted
from foldcut.readers.dxf_file import UNREADABLE, document_of, trim_spline
from foldcut.readers.join_outlines import Outline, loops_of

# ezdxf logs everything that it mends; what matters of that is in the error messages.
logging.getLogger("ezdxf").setLevel(logging.CRITICAL)

OUTLINES = {"LWPOLYLINE", "POLYLINE", "LINE", "ARC", "SPLINE", "CIRCLE", "ELLIPSE", "SOLID", "TRACE"}
"""Entities that draw outlines."""

FILLS = {"HATCH", "MPOLYGON"}
"""Entities that are read only if there are no outlines."""

FINEST = 2.5e-6
"""Curves are not flattened finer than this, relative to the size of the drawing: 0.05 mm in 20 m, 0.0005 mm on A4."""

MOST_ENTITIES = 100_000
"""A file that shows more entities is refused; those of blocks count as often as they are shown."""


def read(source: Source, options: ReadOptions) -> Drawing:
    """Return the drawing in a DXF file's model space; its title is the name of the file."""
    try:
        ignored: Counter[str] = Counter()
        return _read(document_of(source.data, ignored), source.name, options, ignored)
    except FileFormatError:
        raise
    except RecursionError:  # ezdxf reads blocks by recursion
        raise options.limits.too_deep() from None
    except Exception as error:  # ezdxf raises all kinds of errors where a file is broken
        about = " ".join(str(error).split())[:120] or type(error).__name__
        raise FileFormatError(f"not a DXF file that can be read: {about}; save the drawing again as DXF") from None


def _read(document: Any, title: str, options: ReadOptions, ignored: Counter[str]) -> Drawing:
    layers: set[str] = set()
    shown: list[_Drawn] = []
    wanted = {layer.casefold() for layer in options.layers}
    for entity in _entities(document, ignored, options.limits):
        layers.add(entity.dxf.layer)
        if wanted and entity.dxf.layer.casefold() not in wanted:
            continue
        kind = entity.dxftype()
        if kind not in FILLS | OUTLINES:
            ignored[kind] += 1
            continue
        try:
            shown.append(_drawn(entity))
        except Exception:  # whatever ezdxf raises for an entity that is broken
            ignored[UNREADABLE.format(kind)] += 1
    if any(one.kind in OUTLINES for one in shown):
        ignored.update(one.kind for one in shown if one.kind in FILLS)
        shown = [one for one in shown if one.kind in OUTLINES]
    if not any(one.paths for one in shown):
        where = f" in --layer {', '.join(options.layers)}" if wanted else ""
        there = ", ".join(counted(Counter({name: ignored[name] for name in ignored if name.startswith("unread")})))
        raise FileFormatError(
            f"there is no outline{where}; the file has the layers {', '.join(sorted(layers)[:20]) or 'none'}"
            f"{f' and {there}' if there else ''}: draw closed polylines, lines or arcs"
        )
    unit: Any = document.header.get("$INSUNITS", 0)
    unit_mm = float(conversion_factor(InsertUnits(unit), InsertUnits.Millimeters)) if 1 <= unit <= 20 else None
    corners = np.array([point for drawn in shown for one in drawn.paths for point in one.control_vertices()])
    extent = float(np.ptp(corners[:, :2], axis=0).max())
    if not extent > 0 or not math.isfinite(extent):
        raise FileFormatError("the drawing has no size; draw a closed outline with finite coordinates")
    tolerance = max(options.units(options.flatten_mm, unit_mm, extent), FINEST * extent)
    outlines = [
        Outline(
            list(_lines(one.paths, tolerance, closed=one.closed)), curves=list(map(_curve, one.paths)), name=one.name
        )
        for one in shown
    ]
    found = loops_of(outlines, options, unit_mm, extent)
    notes = found.notes
    if np.ptp(corners[:, 2]) > 0:
        notes += ("the z coordinates were ignored",)
    return found.drawing(unit_mm, title, notes, counted(ignored))


class _Drawn(NamedTuple):
    """What an entity draws: its kind, its name for reports, its paths, and whether these are closed in any case."""

    kind: str
    name: str
    paths: list[paths.Path]
    closed: bool


def _drawn(entity: Any) -> _Drawn:
    """Return what an entity draws; raises all kinds of errors where it is broken."""
    kind, handle = entity.dxftype(), entity.dxf.get("handle")
    closed = kind in FILLS
    if closed:
        drawn = list(paths.from_hatch(entity))
    else:
        if kind == "SPLINE":
            closed = bool(entity.closed)
            trim_spline(entity)
        drawn = [paths.make_path(entity)]
    drawn = [one for one in drawn if len(one)]
    if not drawn:
        raise ValueError("it draws nothing")
    for one in drawn:
        if not np.isfinite([(point.x, point.y) for point in one.control_vertices()]).all():
            raise ValueError("a number that is not finite")
    return _Drawn(kind, f"{kind} #{handle}" if handle else f"{kind} on layer {entity.dxf.layer}", drawn, closed)


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
    waiting = [(entity, 0) for entity in reversed(list(document.modelspace())) if entity.is_alive]
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
                for part in _parts(insert, ignored):
                    if part.dxf.layer == "0":
                        part.dxf.layer = entity.dxf.layer
                    waiting.append((part, depth + 1))


def _parts(insert: Any, ignored: Counter[str]) -> list[Any]:
    """Return the entities that an insert shows; of those that cannot be moved to its place, none."""
    try:
        return list(insert.virtual_entities())
    except RecursionError:
        raise
    except Exception:  # whatever ezdxf raises for an entity that is broken
        ignored[UNREADABLE.format("INSERT")] += 1
        return []
