"""Renders the files of a finished pattern: those of the pattern itself, and those of jobs for machines.

A ``FoldedPattern``, a profile and ``JobOptions`` -> the names and bytes of files. Nothing is written here.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from foldcut.core.model import FoldedPattern
from foldcut.exporters import JOB_EXPORTERS, export, export_job
from foldcut.jobs.bed import Side
from foldcut.jobs.job import Job, Registration, make_jobs
from foldcut.jobs.marks import DEFAULT_MARKS
from foldcut.profiles import Profile, Treatment

__all__ = ["JobOptions", "Maker"]


@dataclass(frozen=True)
class JobOptions:
    """The options of ``make_jobs`` beside the pattern and the profile."""

    material: str | None = None
    treatment: Treatment | None = None
    two_sided: bool = False
    registration: Registration = "corners"
    marks: tuple[str, ...] = DEFAULT_MARKS
    tile: bool = False

    def sides(self, path: Path) -> dict[Side, Path]:
        """Return the files that ``path`` stands for: one, or one for the front and one for the back."""
        if not self.two_sided or path.suffix.lower() not in JOB_EXPORTERS:
            return {"both": path}
        return {"front": path.with_stem(f"{path.stem}-front"), "back": path.with_stem(f"{path.stem}-back")}


class Maker:
    """Makes the files of a pattern; ``jobs``: its jobs for the machine, by side, once a file has needed them."""

    def __init__(self, pattern: FoldedPattern, profile: Profile | None, options: JobOptions) -> None:
        self.pattern, self.profile, self.options = pattern, profile, options
        self.jobs: dict[Side, Job] = {}

    def files(self, path: Path) -> dict[Path, bytes]:
        """Return the bytes of each file that ``path`` stands for; its ending says the format.

        Raises FileFormatError and JobError, as exporters do.
        """
        profile, options = self.profile, self.options
        if profile is None or not profile.operations or path.suffix.lower() not in JOB_EXPORTERS:
            return {path: export(self.pattern, path.suffix, profile)}
        if not self.jobs:
            made = make_jobs(
                self.pattern,
                profile,
                material=options.material,
                treatment=options.treatment,
                two_sided=options.two_sided,
                registration=options.registration,
                marks=options.marks,
                tile=options.tile,
            )
            self.jobs = {job.side: job for job in made}
        return {name: export_job(self.jobs[side], path.suffix, profile) for side, name in options.sides(path).items()}
