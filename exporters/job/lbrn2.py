"""lbrn2: a job as a LightBurn project with a cut setting for each step, so that nothing is left to assign there.

Input: a ``Job`` and a ``Profile``; output: XML, lengths in mm on the bed, y up, speeds in mm/s, power in percent.
Sources: projects written by LightBurn, and meerk40t's reader of them (meerk40t/extra/lbrn.py).
"""

from __future__ import annotations

import xml.etree.ElementTree as ET

from foldcut.jobs.job import Job, JobStep
from foldcut.profiles import Profile

from .no_power import no_power

COLOURS = (
    "000000 0000ff ff0000 00e000 d0d000 ff8000 00e0e0 ff00ff b4b4b4 0000a0 a00000 00a000 a0a000 c08000 00a0ff "
    "a000a0 808080 7d87b9 bb7784 4a6fe3 d33f6a 8cd78c f0b98d f6c4e1 fa9ed4 500a78 b45a00 004754 86fa88 ffdb66"
)
PALETTE = {f"#{colour}": index for index, colour in enumerate(COLOURS.split())} | {"#00ff00": 3}
"""The indices of LightBurn's layers by their colours, which are fixed; plain green stands for its green."""


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
    # an XML element for each stroke would take most of the time and memory
    shapes = [
        _shape(stroke.tolist(), index, job.at)
        for step, index in zip(job.steps, indices, strict=True)
        for stroke in step.strokes
    ]
    if shapes:
        root.append(ET.Element("SHAPES"))
    ET.indent(root, " ")
    head, *end = ET.tostring(root).split(b" <SHAPES />\n")
    text = "".join(shapes).encode()
    return b"".join([b'<?xml version="1.0" encoding="UTF-8"?>\n', head, *(text + rest for rest in end), b"\n"])


def _shape(points: list[list[float]], index: int, at: tuple[float, float]) -> str:
    """Return the text of a stroke as a path."""
    closed = len(points) > 2 and points[0] == points[-1]
    points = points[:-1] if closed else points
    right, up = at
    corners = "".join([f"V{x + right:.6f} {y + up:.6f}c0x1c1x1" for x, y in points])
    lines = [f"L{k} {k + 1}" for k in range(len(points) - 1)] + [f"L{len(points) - 1} 0"] * closed
    return (
        f' <Shape Type="Path" CutIndex="{index}">\n  <XForm>1 0 0 1 0 0</XForm>\n  <VertList>{corners}</VertList>\n'
        f"  <PrimList>{''.join(lines)}</PrimList>\n </Shape>\n"
    )


def _indices(job: Job) -> list[int]:
    """Return the index of a layer for each step: LightBurn's own of the same colour where there is one."""
    indices: list[int] = []
    wanted = {PALETTE.get(step.operation.colour) for step in job.steps}
    others = (index for index in range(len(PALETTE)) if index not in wanted)
    for step in job.steps:
        index = PALETTE.get(step.operation.colour)
        indices.append(next(others) if index is None or index in indices else index)
    return indices


def _cut_setting(root: ET.Element, step: JobStep, index: int, priority: int, profile: Profile) -> None:
    setting = step.setting
    if setting is None or setting.power_percent is None:
        raise no_power(step, profile)
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
