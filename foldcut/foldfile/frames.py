"""Which frame of a FOLD file is the crease pattern: the key frame, or the first of ``file_frames`` that is one.

JSON object -> the same with that frame as the key frame, and notes. (FOLD specification 1.2, "Frames".)
"""

from __future__ import annotations

from typing import Any

from foldcut.foldfile.parts import fail

__all__ = ["is_folded_form", "with_pattern_first"]

MOST_PARENTS = 50
"""Frames that inherit from more frames than this inherit from each other in a circle."""


def is_folded_form(frame: dict[str, Any]) -> bool:
    """Whether a frame says that it is a folded form, and no crease pattern."""
    classes = frame.get("frame_classes", [])
    return isinstance(classes, list) and "foldedForm" in classes and "creasePattern" not in classes


def with_pattern_first(data: dict[str, Any]) -> tuple[dict[str, Any], list[str]]:
    """Return a file whose key frame is the crease pattern, if any of its frames is one, and notes on what was done."""
    frames = data.get("file_frames", [])
    if _is_pattern(data) or not isinstance(frames, list):
        return data, []
    for at, frame in enumerate(frames):
        if not isinstance(frame, dict):
            fail(f"file_frames[{at}]", "must be an object")
        whole = _inherited(data, frames, at)
        if _is_pattern(whole):
            first = {key: value for key, value in data.items() if key.startswith("file_")} | whole
            key_frame = {key: value for key, value in data.items() if not key.startswith("file_")}
            rest = [other for number, other in enumerate(frames) if number != at]
            first["file_frames"] = [*rest, key_frame]
            notes = [f"the crease pattern is in file_frames[{at}]"]
            return first, notes
    return data, []


def _is_pattern(frame: dict[str, Any]) -> bool:
    return "vertices_coords" in frame and "edges_vertices" in frame and not is_folded_form(frame)


def _inherited(data: dict[str, Any], frames: list[Any], at: int) -> dict[str, Any]:
    """Return a frame together with what it inherits; frame 0 is the key frame, so ``frames[0]`` is frame 1."""
    whole: dict[str, Any] = {}
    for steps in range(MOST_PARENTS + 1):
        if steps == MOST_PARENTS:
            fail(f"file_frames[{at}].frame_parent", "frames inherit from each other in a circle")
        frame = frames[at]
        if not isinstance(frame, dict):
            return whole
        whole = frame | whole
        parent = frame.get("frame_parent", 0)
        if frame.get("frame_inherit") is not True or type(parent) is not int or not 0 <= parent <= len(frames):
            return whole
        if parent == 0:
            return {key: value for key, value in data.items() if not key.startswith("file_")} | whole
        at = parent - 1
    return whole
