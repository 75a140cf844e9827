"""DXF: a job for lasers and cutters, one layer for each operation, in mm.

Input: a ``Job`` and a ``Profile``; output: DXF R2000 that states its unit, or R12, which cannot, for programs that read
nothing newer. There are only lines and polylines; programs drop line types on import, so each dash is a line. The
sheet's lower left corner is at (0, 0).
"""

from __future__ import annotations

import io
import logging
from collections.abc import Container

import ezdxf
from ezdxf import colors, units
from ezdxf.document import Drawing
from ezdxf.filemanagement import new

from foldcut.jobs.job import Job
from foldcut.profiles import Profile

# ezdxf warns that R12 has no units, on standard error unless there is a handler
logging.getLogger("ezdxf").addHandler(logging.NullHandler())


def export(job: Job, profile: Profile) -> bytes:
    """Return a job as a DXF file; the same job gives the same bytes."""
    # no dates, no random identifiers
    ezdxf.options.write_fixed_meta_data_for_testing = True  # type: ignore[attr-defined]
    document = new(profile.dxf_version)
    width, height = job.size
    old = profile.dxf_version == "R12"
    if not old:
        document.units = units.MM
        document.header["$MEASUREMENT"] = 1
        document.header["$PSVPSCALE"] = 1.0
    space = document.modelspace()
    taken: set[int] = set()
    for step in job.steps:
        name = step.operation.layer
        red, green, blue = (int(step.operation.colour[n : n + 2], 16) for n in (1, 3, 5))
        index = _index((red, green, blue), taken)
        taken.add(index)
        layer = document.layers.add(name, color=index)
        if not old:
            layer.rgb = (red, green, blue)
        attributes = {"layer": name}
        for stroke in step.strokes:
            points = [(x, y) for x, y in stroke.tolist()]
            if len(points) == 2:
                space.add_line(points[0], points[1], dxfattribs=attributes)
                continue
            closed = points[0] == points[-1]
            add = space.add_polyline2d if old else space.add_lwpolyline
            add(points[:-1] if closed else points, close=closed, dxfattribs=attributes)
    document.header["$EXTMIN"] = (0.0, 0.0, 0.0)
    document.header["$EXTMAX"] = (width, height, 0.0)
    space.dxf.extmin, space.dxf.extmax = (0.0, 0.0, 0.0), (width, height, 0.0)
    return _bytes(document)


def _index(rgb: tuple[int, int, int], taken: Container[int]) -> int:
    """Return the nearest of the standard colours that no other layer has, for programs that know no others.

    The first nine have names, and come first if they are the colour itself.
    """
    free = (number for number in range(1, 256) if number not in taken)
    return min(free, key=lambda n: sum((a - b) ** 2 for a, b in zip(_standard(n), rgb, strict=True)))


def _standard(number: int) -> tuple[int, int, int]:
    if number == 7:  # drawn black on a white background
        return 0, 0, 0
    red, green, blue = colors.aci2rgb(number)
    return red, green, blue


def _bytes(document: Drawing) -> bytes:
    text = io.StringIO()
    document.write(text)
    return document.encode(text.getvalue())
