"""A DXF drawing as large as no sheet is has no more corners than its picture on a sheet needs."""

from __future__ import annotations

import io
from pathlib import Path

import ezdxf
import pytest

from foldcut.readers import read_shape


def drawn(tmp_path: Path, kind: str, size: float) -> Path:
    """Return a file with a circle, an ellipse, or a closed line of two arcs of a size in mm."""
    document = ezdxf.new(units=4)
    space = document.modelspace()
    if kind == "circle":
        space.add_circle((0, 0), size / 2)
    elif kind == "ellipse":
        space.add_ellipse((0, 0), (size / 2, 0), 0.5)
    else:
        space.add_lwpolyline([(0, 0, 0, 0, 1), (size, 0, 0, 0, 1)], close=True)
    text = io.StringIO()
    document.write(text)
    path = tmp_path / "a.dxf"
    path.write_text(text.getvalue())
    return path


@pytest.mark.parametrize("kind", ["circle", "ellipse", "arcs"])
def test_a_drawing_of_any_size_has_few_corners(kind: str, tmp_path: Path) -> None:
    small, large, huge = (len(read_shape(drawn(tmp_path, kind, size)).loops[0]) for size in (200.0, 1e5, 1e14))
    assert small < 300
    assert large == huge < 2000
