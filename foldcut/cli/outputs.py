"""The files that a command is asked for: are they possible, where do they go, and what is in them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from foldcut.cli.options import Machine
from foldcut.core.errors import BadInputError
from foldcut.core.files import read_bytes

if TYPE_CHECKING:
    from foldcut.core.model import FoldedPattern, Sheet
    from foldcut.jobs.job import Job
    from foldcut.output.recipe import Recipe
    from foldcut.output.render import Maker

PATTERN_FORMATS = ("svg", "fold", "png")
"""What goes into a folder or an archive that is for no machine."""


@dataclass(frozen=True)
class MadeFor:
    """A machine and the jobs that were made for it."""

    machine: Machine
    jobs: list[Job]


@dataclass(frozen=True)
class Outputs:
    """Files for a ``machine``, by their endings; a folder that exists, or a zip archive, is a *bundle* of several.

    ``stem``: what the files in a folder are called. ``usual``: machines for files with some endings, if the user names
    none; all other files are of the pattern alone.
    """

    paths: tuple[Path, ...]
    stem: str
    machine: Machine
    usual: Mapping[str, Machine] = field(default_factory=dict)

    def machine_for(self, path: Path) -> Machine:
        """Return the machine that a file is for."""
        return self.usual.get(path.suffix.lower(), self.machine)

    def machines(self) -> list[MadeFor]:
        """Return the machines that there may be files for, without jobs."""
        return [MadeFor(machine, []) for machine in (*self.usual.values(), self.machine) if machine.profile is not None]

    def profile_files(self) -> list[Path]:
        """Return the user's own profiles of these machines; there need be no such files."""
        from foldcut.profiles import profile_file

        return [profile_file(made.machine.name) for made in self.machines() if made.machine.name is not None]

    def check_formats(self, sheet: Sheet) -> None:
        """Raise what is wrong with the formats for this machine and sheet, before any long work."""
        from foldcut.exporters import JOB_EXPORTERS, check_job_export, check_suffix

        in_bundles = [member for path in self.paths if is_bundle(path) for member in self._members(path)]
        files = [*in_bundles, *(path for path in self.paths if not is_bundle(path))]
        for path in files:
            machine = self.machine_for(path)
            check_suffix(path.suffix, machine.with_jobs, machine.profile, sheet)
            if machine.with_jobs is not None and path.suffix.lower() in JOB_EXPORTERS:
                job = machine.job
                registration = (job.registration or machine.with_jobs.registration) if job.two_sided else None
                check_job_export(
                    path.suffix,
                    machine.with_jobs,
                    sheet,
                    material=job.material,
                    tile=job.tile,
                    registration=registration,
                    layout=job.layout,
                    tabs=job.tabs,
                    framed=job.framed,
                )

        self._check_job_options(files)

    def _check_job_options(self, files: Iterable[Path]) -> None:
        """Raise BadInputError if options for the machine's job are given and none of the ``files`` is a job."""
        from foldcut.exporters import JOB_EXPORTERS
        from foldcut.output.render import JOB_WORDS

        given = dict.fromkeys(word.partition("=")[0] for word in self.machine.words.options)
        wrong = [name for name in given if name in JOB_WORDS]
        if self.machine.with_jobs is None or not wrong or any(path.suffix.lower() in JOB_EXPORTERS for path in files):
            return
        verb, them = ("is", "it") if len(wrong) == 1 else ("are", "them")
        raise BadInputError(
            f"{' and '.join(wrong)} {verb} for a job, and no file for the machine is asked for; leave {them} out, or "
            f"add -o NAME.{self.machine.with_jobs.format}"
        )

    def targets(self) -> list[Path]:
        """Return every file that may be written."""
        return [target for path in self.paths for target in self._targets(path)]

    def contents(self, pattern: FoldedPattern, recipe: Recipe) -> tuple[dict[Path, bytes], list[MadeFor]]:
        """Return the bytes of every file, with its recipe, and the machines that they are for with their jobs."""
        from foldcut.exporters.bundle import README, readme, zipped
        from foldcut.output.render import Maker

        makers: dict[tuple[object, ...], tuple[Machine, Maker]] = {}
        contents: dict[Path, bytes] = {}
        for path in self.paths:
            machine = self.machine_for(path)
            of_it = recipe.also(*machine.words)
            made = Maker(pattern, machine.profile, machine.job, of_it)
            _, maker = makers.setdefault((machine.name, machine.words.options), (machine, made))
            if not is_bundle(path):
                contents |= maker.named_files(path)
                continue
            members: dict[str, bytes] = {}
            for member in self._members(path):
                members |= {str(name): data for name, data in maker.files(member).items()}
            jobs = {name: maker.jobs_of.get(Path(name)) for name in members}
            text = readme(pattern, jobs, machine.profile, list(maker.jobs.values()), of_it.lines())
            every = {README: text} | members
            if path.is_dir():
                contents |= {path / name: data for name, data in every.items()}
            else:
                contents[path] = of_it.put_into(zipped(every), path.name, path.name)
        machines = [MadeFor(machine, list(maker.jobs.values())) for machine, maker in makers.values()]
        return contents, [made for made in machines if made.machine.profile is not None]

    def _members(self, path: Path) -> list[Path]:
        """Return the names of what goes into a bundle, without its README; a job may have several files for one."""
        stem = self.stem if path.is_dir() else path.stem
        profile = self.machine.profile
        return [Path(f"{stem}.{ending}") for ending in (PATTERN_FORMATS if profile is None else (profile.format,))]

    def _targets(self, path: Path) -> list[Path]:
        """Return the files that may be written for one output."""
        machine = self.machine_for(path)
        if not path.is_dir():
            return [path] if is_bundle(path) else machine.job.targets(path, machine.profile)
        from foldcut.exporters.bundle import OURS, README

        about = path / README
        if about.is_file() and not read_bytes(about, len(OURS)).startswith(OURS.encode()):
            raise BadInputError(f"{about} exists and was not written by foldcut; choose an empty folder, or a .zip")
        members = (name for member in self._members(path) for name in machine.job.targets(member, machine.profile))
        return [about, *(path / name for name in members)]


def is_bundle(path: Path) -> bool:
    """Whether several files go into this: a folder that exists, or a zip archive."""
    return path.is_dir() or path.suffix.lower() == ".zip"
