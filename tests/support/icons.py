"""Silhouettes out of icon sets of npm, which tests/tools.sh installs: which there are, and folding one."""

from __future__ import annotations

import random
import re
import time
from pathlib import Path
from typing import Any

import numpy as np
import shapely

import foldcut
from foldcut.drawing.mend import Preparation
from foldcut.readers import read_shape
from support.as_it_is import as_it_is
from support.places import TESTS

NODE_MODULES = TESTS / "node" / "node_modules"

SETS = {"@mapbox/maki": "icons", "@primer/octicons": "build/svg", "bootstrap-icons": "icons"}
"""The folder of the icons in each package."""

_SHAPES = re.compile(r"<(?:path|polygon|rect|circle|ellipse|line|polyline|use)\b[^>]*>")
_DATA = re.compile(r"""\bd=["']([^"']*)""")


def icon_folders() -> list[Path]:
    """Return the folders of the sets that are installed."""
    folders = [NODE_MODULES / package / folder for package, folder in SETS.items()]
    return [folder for folder in folders if folder.is_dir()]


def silhouettes(folders: list[Path], seed: int = 1) -> list[Path]:
    """Return the icons whose text has one path with one subpath, shuffled."""
    found = [file for folder in folders for file in sorted(folder.glob("*.svg")) if _is_one(file.read_text("utf-8"))]
    random.Random(seed).shuffle(found)
    return found


def _is_one(text: str) -> bool:
    shapes = _SHAPES.findall(text)
    data = _DATA.search(shapes[0]) if len(shapes) == 1 else None
    return data is not None and len(re.findall("[Mm]", data[1])) == 1


def fold_icon(path: Path, corners: int, effort: str = "fast") -> dict[str, Any]:
    """Fold an icon on A4 with at most so many corners, and return what came of it; ``failure`` is empty if all is well.

    ``off_mm`` is how far the simplified outline is from the drawn one, ``seconds`` are of the processor.
    """
    started = time.process_time()
    row: dict[str, Any] = {"icon": path.stem, "failure": ""}
    try:
        drawing = read_shape(path)
        row |= {"loops": len(drawing.loops), "points": sum(map(len, drawing.loops))}
        if len(drawing.loops) == 1:
            with as_it_is():
                result = foldcut.fold(drawing, min_crease=0, effort=effort, preparation=Preparation(corners=corners))
            row |= _folded(result)
    except foldcut.FoldcutError as error:
        row["failure"] = f"{type(error).__name__}: {error}"
    return row | {"seconds": time.process_time() - started}


def _folded(result: foldcut.Result) -> dict[str, Any]:
    assert result.prepared is not None
    before, after = (
        shapely.MultiLineString([np.concatenate([loop, loop[:1]]) for loop in loops])
        for loops in (result.prepared.drawn, result.prepared.loops)
    )
    return {
        "corners": sum(map(len, result.prepared.loops)),
        "off_mm": float(shapely.hausdorff_distance(before, after)),
        "method": result.method,
        "creases": result.folded_pattern.creases.crease_count,
        "shortest_mm": result.foldability.shortest_crease_mm,
        "failure": "; ".join(map(str, result.findings)),
    }
