"""lbrn2: a job as a LightBurn project, with a cut setting for each operation: nothing to assign in LightBurn.

Input: a ``Job`` and a ``Profile``; output: XML, lengths in mm on the bed, y up, speeds in mm/s, power in percent.
Sources: projects written by LightBurn, and meerk40t's reader of them (meerk40t/extra/lbrn.py).
"""

from __future__ import annotations

import xml.etree.ElementTree as ET

import numpy as np

from foldcut.job import Job, JobError, Step
from foldcut.profiles import Profile

PALETTE = {"#000000": 0, "#0000ff": 1, "#ff0000": 2, "#00ff00": 3}
"""LightBurn's first layers; an index is a colour there."""


def export(job: Job, profile: Profile) -> bytes:
    """Return a job as an lbrn2 file.

    Raises JobError: the material has no power for an operation.
    """
    root = ET.Element(
        "LightBurnProject", AppVersion="1.4.00", FormatVersion="1", MaterialHeight="0", MirrorX="False", MirrorY="False"
    )
    indices = _indices(job)
    for priority, (step, index) in enumerate(zip(job.steps, indices, strict=True)):
        _cut_setting(root, step, index, priority, profile)
    for step, index in zip(job.steps, indices, strict=True):
        for stroke in step.strokes:
            points = (stroke + np.array(job.at)).tolist()
            closed = len(points) > 2 and points[0] == points[-1]
            points = points[:-1] if closed else points
            shape = ET.SubElement(root, "Shape", Type="Path", CutIndex=str(index))
            ET.SubElement(shape, "XForm").text = "1 0 0 1 0 0"
            ET.SubElement(shape, "VertList").text = "".join(f"V{x:.6f} {y:.6f}c0x1c1x1" for x, y in points)
            lines = [f"L{k} {k + 1}" for k in range(len(points) - 1)] + [f"L{len(points) - 1} 0"] * closed
            ET.SubElement(shape, "PrimList").text = "".join(lines)
    ET.indent(root, " ")
    return b'<?xml version="1.0" encoding="UTF-8"?>\n' + ET.tostring(root) + b"\n"


def _indices(job: Job) -> list[int]:
    """Return a layer for each step, LightBurn's own of the step's colour where it has one."""
    indices: list[int] = []
    others = iter(range(4, 4 + len(job.steps)))
    for step in job.steps:
        index = PALETTE.get(step.operation.colour)
        indices.append(next(others) if index is None or index in indices else index)
    return indices


def _cut_setting(root: ET.Element, step: Step, index: int, priority: int, profile: Profile) -> None:
    setting = step.setting
    if setting is None:
        raise JobError(f"the profile {profile.title!r} has no power for {step.role} on this material")
    cut = ET.SubElement(root, "CutSetting", type="Cut")
    for name, value in (
        ("index", index),
        ("name", step.operation.layer),
        ("minPower", f"{setting.power_percent:g}"),
        ("maxPower", f"{setting.power_percent:g}"),
        ("speed", f"{setting.speed_mm_s:g}"),
        ("numPasses", setting.passes),
        ("priority", priority),
    ):
        ET.SubElement(cut, name, Value=str(value))
