"""What the bench does with a finished pattern: verify it and write it in every format.

``prepare`` of an item sets up, untimed, and returns what is timed; ``numbers`` says, untimed, what came of it. Files of
jobs are made of the creases as they are, one stroke each in the pattern's order: what ordering them takes is an item of
its own, "job".
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from foldcut.core.errors import UnfoldableError
from foldcut.core.model import FoldedPattern
from foldcut.exporters import JOB_EXPORTERS, PATTERN_EXPORTERS, export, export_job
from foldcut.jobs.bed import Lay
from foldcut.jobs.job import Job, make_jobs, steps_of
from foldcut.profiles import load_profile
from foldcut.proof.verify import verify

MACHINES = {
    ".svg": "glowforge",
    ".dxf": "laser-dxf",
    ".hpgl": "roland-dxy",
    ".gcode": "grbl-laser",
    ".pdf": "printer-a4",
    ".lbrn2": "lightburn-co2",
}


@dataclass(frozen=True)
class Subject:
    """A pattern and the centres of its disks, ``(n, 2)`` mm."""

    pattern: FoldedPattern
    centres: np.ndarray

    @property
    def faces(self) -> int:
        """The number of faces of the pattern."""
        return len(self.pattern.creases.faces_vertices.offsets) - 1


def _nothing(result: Any) -> dict[str, Any]:
    return {}


@dataclass(frozen=True)
class Item:
    """One thing that is timed; ``limit`` is in units of the bench's own, inf for always."""

    name: str
    prepare: Callable[[Subject], Callable[[], Any]]
    numbers: Callable[[Any], dict[str, Any]] = field(default=_nothing)
    limit: float = 1.0
    needs: str | None = None


def _size(data: bytes) -> dict[str, Any]:
    return {"bytes": len(data)}


def _pattern_exporter(suffix: str, profile_name: str | None = None) -> Item:
    def prepare(subject: Subject) -> Callable[[], bytes]:
        profile = load_profile(profile_name) if profile_name else None
        return lambda: export(subject.pattern, suffix, profile)

    return Item(f"{suffix} {profile_name}" if profile_name else suffix, prepare, _size)


def _job_exporter(suffix: str) -> Item:
    name = MACHINES[suffix]

    def prepare(subject: Subject) -> Callable[[], bytes]:
        profile = load_profile(name)
        job = plain_job(subject.pattern, name)
        return lambda: export_job(job, suffix, profile)

    return Item(f"{suffix} {name}", prepare, _size)


def plain_job(pattern: FoldedPattern, profile_name: str) -> Job:
    """Return a job of every crease as one stroke, in the pattern's order."""
    profile = load_profile(profile_name)
    creases, lay = pattern.creases, Lay.for_machine(pattern.sheet, profile)
    ends = lay.place(creases.vertices_coords)[creases.edges_vertices]
    strokes = {
        "mountain": tuple(ends[creases.edges_assignment == "M"]),
        "valley": tuple(ends[creases.edges_assignment == "V"]),
    }
    steps = tuple(replace(step, strokes=strokes[step.role]) for step in steps_of(profile) if step.role in strokes)
    return Job(pattern.title, lay.size, lay.at, lay.turned, "both", steps, 0.0, 0.0, lay.paper)


def _job(subject: Subject) -> Callable[[], Job]:
    profile = load_profile("laser-dxf")
    return lambda: make_jobs(subject.pattern, profile)[0]


def _verify(subject: Subject) -> Callable[[], list[Any]]:
    pattern = subject.pattern
    return lambda: list(verify(pattern.creases, pattern.folded.layers, pattern.shape))


def _require_none(findings: list[Any]) -> dict[str, Any]:
    """What ends at a finding has not been verified, and its seconds say nothing."""
    if findings:
        raise UnfoldableError(f"{len(findings):,} findings, such as: {findings[0]}")
    return {}


VERIFY = Item("verify", _verify, _require_none, limit=6.0)
EXPORTERS = (
    *(_pattern_exporter(suffix) for suffix in PATTERN_EXPORTERS),
    _pattern_exporter(".svg", "origami-software"),
    Item("job laser-dxf", _job, lambda job: {"travel_mm": job.travel, "travel_before_mm": job.travel_before}),
    *(_job_exporter(suffix) for suffix in JOB_EXPORTERS),
)
