"""What the command line says about a pattern: numbers as a plain dictionary, and the same as lines of text.

Input: a finished pattern and what is known of its making; output: what ``--json`` prints, or text. Nothing
is printed here, and nothing is checked: findings come from verification.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import numpy as np

from foldcut.model import CreasePattern, Finding, FoldedState, Ragged, Sheet

if TYPE_CHECKING:
    from foldcut.pipeline import Result

Report = dict[str, Any]

MOST_FINDINGS = 10
"""How many findings the text shows; the report for programs has all."""
CHECKS = ("planar", "isometry", "Kawasaki", "Maekawa", "assignment", "layers", "cut")
"""What verification looks at, in its order; the cut only where the shape is known."""


def make_report(result: Result, files: Sequence[Report]) -> Report:
    """Return the report of ``foldcut make``; ``files`` are the written ones: path, bytes, replaced."""
    pattern = result.folded_pattern
    sheet = pattern.sheet
    return {
        "ok": result.verified,
        "title": pattern.title,
        "sheet": {"name": sheet.name, "width_mm": sheet.width, "height_mm": sheet.height},
        "scale_mm_per_unit": pattern.placement.scale,
        "corners": pattern.shape.corner_count,
        "disks": len(result.packing.radii),
        "molecules": len(result.molecules.corners),
        **pattern_numbers(pattern.creases),
        "layers_at_cut": layers_at_cut(pattern.creases.faces_vertices, pattern.folded),
        "seconds": dict(result.seconds),
        "verified": list(CHECKS) if result.verified else [],
        "findings": list(map(asdict, result.findings)),
        "notes": list(result.drawing_notes),
        "files": list(files),
    }


def make_lines(report: Report) -> list[str]:
    """Return the report of ``foldcut make`` as text."""
    sheet = Sheet(report["sheet"]["width_mm"], report["sheet"]["height_mm"], report["sheet"]["name"])
    seconds = report["seconds"]
    rows = [
        ("sheet", f"{sheet}; 1 unit of the drawing is {report['scale_mm_per_unit']:.4g} mm"),
        ("packing", f"{report['disks']} disks, {report['molecules']} molecules"),
        *_pattern_rows(report),
        ("layers", f"{report['layers_at_cut']} to cut through at the thickest place"),
        ("time", f"{seconds.get('build', 0):.2f} s to build, {seconds.get('verify', 0):.2f} s to verify"),
        *[("note", note) for note in report["notes"]],
        *_verdict_rows(report),
        *[("written", _file_text(file)) for file in report["files"]],
    ]
    return [report["title"] or "untitled", *_aligned(rows)]


def check_report(creases: CreasePattern, findings: Sequence[Finding], with_shape: bool, notes: Sequence[str]) -> Report:
    """Return the report of ``foldcut check``; without a shape there is no cut to check."""
    return {
        "ok": not findings,
        **pattern_numbers(creases),
        "verified": [check for check in CHECKS if not findings and (with_shape or check != "cut")],
        "findings": list(map(asdict, findings)),
        "notes": list(notes),
    }


def check_lines(report: Report) -> list[str]:
    """Return the report of ``foldcut check`` as text."""
    notes = [("note", note) for note in report["notes"]]
    return _aligned([*_pattern_rows(report), *notes, *_verdict_rows(report)])


def pattern_numbers(creases: CreasePattern) -> Report:
    """Return the numbers of creases and faces, and the shortest crease in mm (None without creases)."""
    mountain, valley = creases.edges_assignment == "M", creases.edges_assignment == "V"
    ends = creases.vertices_coords[creases.edges_vertices[mountain | valley]]
    lengths = np.hypot(*(ends[:, 1] - ends[:, 0]).T)
    return {
        "creases": len(lengths),
        "mountains": int(mountain.sum()),
        "valleys": int(valley.sum()),
        "shortest_crease_mm": float(lengths.min()) if len(lengths) else None,
        "faces": len(creases.faces_vertices),
    }


def layers_at_cut(faces: Ragged, folded: FoldedState) -> int:
    """Return how many layers of paper the cut goes through where the folded sheet is thickest along it.

    The cut runs along y = 0; faces that only touch this line from above or below do not count.
    """
    tolerance = 1e-9 * float(np.ptp(folded.vertices_coords, axis=0).max())
    x, y = folded.vertices_coords[faces.values].T
    y = np.where(np.abs(y) < tolerance, 0.0, y)
    following = np.arange(1, len(x) + 1)
    following[faces.offsets[1:] - 1] = faces.offsets[:-1]
    above = y > 0
    reaches_below = np.minimum.reduceat(y, faces.offsets[:-1])[faces.rows] < 0
    start = np.flatnonzero((above != above[following]) & reaches_below)
    end = following[start]
    crossings = x[start] + (x[end] - x[start]) * y[start] / (y[start] - y[end])
    # Rounded, so that one face ends exactly where the next begins.
    place = np.round(crossings / tolerance)
    # A face is entered and left in turn along the cut, and at one place faces end before others begin.
    place = place[np.lexsort((place, faces.rows[start]))]
    step = np.tile([1, -1], len(place) // 2)
    return int(np.cumsum(step[np.lexsort((step, place))]).max(initial=0))


def _pattern_rows(report: Report) -> list[tuple[str, str]]:
    """Return the lines that every pattern has."""
    shortest = report["shortest_crease_mm"]
    length = "" if shortest is None else f", the shortest {shortest:.3g} mm long"
    return [
        (
            "creases",
            f"{report['creases']}: {report['mountains']} mountains, {report['valleys']} valleys{length}",
        ),
        ("faces", f"{report['faces']}"),
    ]


def _verdict_rows(report: Report) -> list[tuple[str, str]]:
    """Return the line that says what was verified, or a line for each finding."""
    findings = [Finding(**finding) for finding in report["findings"]]
    if not findings:
        return [("verified", ", ".join(report["verified"]))]
    more = [("", f"and {len(findings) - MOST_FINDINGS} more")] if len(findings) > MOST_FINDINGS else []
    return [("NOT VALID", str(finding)) for finding in findings[:MOST_FINDINGS]] + more


def _file_text(file: Report) -> str:
    """Return a file's line: its path, its size, and whether there was one before."""
    return f"{file['path']} ({file['bytes']:,} bytes{', replaced' if file['replaced'] else ''})"


def _aligned(rows: Sequence[tuple[str, str]]) -> list[str]:
    """Return the rows with their texts below each other."""
    return [f"  {name:<9} {text}" for name, text in rows]
