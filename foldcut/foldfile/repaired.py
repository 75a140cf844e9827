"""A FOLD file of the pattern that was judged: with its vertices where they fold flat exactly, and no more changed.

``FoldFile`` and ``Decision`` -> bytes. Creases, faces, letters and lines that stay flat are those of the file, lengths
in mm. The layer order is the file's, or the one that was found; it is left out where edges are unassigned, since it
holds for one choice of mountains and valleys only. ``foldcut:repairedBy`` says by how many mm vertices were moved:
angles are exact then, and what coincides when the sheet is folded does so within some hundred times that.
"""

from __future__ import annotations

from importlib.metadata import version
from typing import Any

from foldcut.foldfile.decide import Decision
from foldcut.foldfile.read import FoldFile
from foldcut.foldfile.solved import as_json, face_orders_of

__all__ = ["repaired_file"]


def repaired_file(file: FoldFile, decision: Decision) -> bytes:
    """Return a FOLD file of a pattern that folds flat, as ``decision`` says of the ``file``."""
    pattern, letters = decision.pattern, file.pattern.edges_assignment
    document: dict[str, Any] = {
        "file_spec": 1.2,
        "file_creator": f"foldcut {version('foldcut')}",
        "file_title": file.title,
        "file_classes": ["singleModel"],
        "frame_classes": ["creasePattern"],
        "frame_unit": "mm",
        "vertices_coords": pattern.vertices_coords.tolist(),
        "edges_vertices": pattern.edges_vertices.tolist(),
        "edges_assignment": letters.tolist(),
        "faces_vertices": pattern.faces_vertices.to_lists(),
    }
    if not (letters == "U").any():
        if decision.pairs is not None:
            document["faceOrders"] = face_orders_of(pattern, decision.pairs)
        elif file.layers is not None:
            document["foldcut:layers"] = file.layers.tolist()
    if file.placement is not None:
        document["foldcut:placement"] = file.placement.matrix.tolist()
    for name, loops in (
        ("shape", file.loops),
        ("firstFolds", file.first_folds),
        ("drawn", file.drawn),
        ("lines", file.lines or None),
    ):
        if loops is not None:
            document[f"foldcut:{name}"] = [points.tolist() for points in loops]
    if decision.moved is not None or file.repaired_by:
        most = 0.0 if decision.moved is None else decision.moved.most
        document["foldcut:repairedBy"] = max(most, file.repaired_by)
    if file.moved_by is not None:
        document["foldcut:movedBy"] = file.moved_by
    return as_json(document)
