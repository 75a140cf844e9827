"""The files that a command is asked for: are they possible, where do they go, and what is in them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from foldcut.cli.options import Machine
from foldcut.core.errors import BadInputError

if TYPE_CHECKING:
    from foldcut.core.model import FoldedPattern, Sheet
    from foldcut.jobs.job import Job

PATTERN_FORMATS = ("svg", "fold", "png")
"""What goes into a folder or an archive that is for no machine."""


@dataclass(frozen=True)
class Outputs:
    """Files for a ``machine``, by their endings; a folder that exists, or a zip archive, is a *bundle* of several.

    ``stem``: what the files in a folder are called.
    """

    paths: tuple[Path, ...]
    stem: str
    machine: Machine

    def check_formats(self, sheet: Sheet) -> None:
        """Raise what is wrong with the formats for this machine and sheet, before any long work."""
        from foldcut.exporters import JOB_EXPORTERS, check_job_export, check_suffix

        machine, job = self.machine.with_jobs, self.machine.job
        in_bundles = [member for path in self.paths if is_bundle(path) for member in self._members(path)]
        for path in [*in_bundles, *(path for path in self.paths if not is_bundle(path))]:
            check_suffix(path.suffix, machine, self.machine.profile)
            if machine is not None and path.suffix.lower() in JOB_EXPORTERS:
                check_job_export(path.suffix, machine, sheet, material=job.material, tile=job.tile)

    def targets(self) -> list[Path]:
        """Return every file that will be written."""
        return [target for path in self.paths for target in self._targets(path)]

    def contents(self, pattern: FoldedPattern) -> tuple[dict[Path, bytes], list[Job]]:
        """Return the bytes of every file, and the jobs among them."""
        from foldcut.exporters.bundle import README, readme, zipped
        from foldcut.output.render import Maker

        maker = Maker(pattern, self.machine.profile, self.machine.job)
        contents: dict[Path, bytes] = {}
        for path in self.paths:
            if not is_bundle(path):
                contents |= maker.files(path)
                continue
            members: dict[str, bytes] = {}
            sides: dict[str, Job | None] = {}
            for member in self._members(path):
                members |= {str(name): data for name, data in maker.files(member).items()}
                of_member = self.machine.job.sides(member)
                sides |= {str(name): maker.jobs.get(side) for side, name in of_member.items()}
            every = {README: readme(pattern, sides, self.machine.profile)} | members
            contents |= {path / name: data for name, data in every.items()} if path.is_dir() else {path: zipped(every)}
        return contents, list(maker.jobs.values())

    def _members(self, path: Path) -> list[Path]:
        """Return the names of what goes into a bundle, without its README; a job may have two files for one name."""
        stem = self.stem if path.is_dir() else path.stem
        profile = self.machine.profile
        return [Path(f"{stem}.{ending}") for ending in (PATTERN_FORMATS if profile is None else (profile.format,))]

    def _targets(self, path: Path) -> list[Path]:
        """Return the files that will be written for one output."""
        sides = self.machine.job.sides
        if not path.is_dir():
            return [path] if is_bundle(path) else list(sides(path).values())
        from foldcut.exporters.bundle import OURS, README

        about = path / README
        if about.is_file() and not about.read_bytes().startswith(OURS.encode()):
            raise BadInputError(f"{about} exists and was not written by foldcut; choose an empty folder, or a .zip")
        return [about, *(path / name for member in self._members(path) for name in sides(member).values())]


def is_bundle(path: Path) -> bool:
    """Whether several files go into this: a folder that exists, or a zip archive."""
    return path.is_dir() or path.suffix.lower() == ".zip"
