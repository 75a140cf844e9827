"""Renders the files of a finished pattern: those of the pattern itself, and those of jobs for machines.

A ``FoldedPattern``, a profile and ``JobOptions`` -> the names and bytes of files. Nothing is written here.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from foldcut.core.model import FoldedPattern
from foldcut.exporters import DUPLEX, JOB_EXPORTERS, export, export_duplex, export_frame, export_job
from foldcut.jobs.arrange import IN_THE_CORNER, BedLayout
from foldcut.jobs.bed import Side
from foldcut.jobs.instructions import COLOURS
from foldcut.jobs.job import Job, JobStep, Registration, make_jobs
from foldcut.jobs.tabs import Tabs
from foldcut.output.recipe import Recipe
from foldcut.profiles import Action, Profile, Treatment

__all__ = ["JobOptions", "Maker"]


JOB_WORDS = (
    "--material",
    "--treatment",
    "--two-sided",
    "--registration",
    "--marks",
    "--tile",
    "--at",
    "--copies",
    "--tabs",
    "--frame",
)
"""The options of the command line that only a job can follow."""


@dataclass(frozen=True)
class JobOptions:
    """The options of ``make_jobs`` beside the pattern and the profile; None: as the profile says."""

    material: str | None = None
    treatment: Treatment | None = None
    two_sided: bool = False
    registration: Registration | None = None
    marks: tuple[str, ...] | None = None
    tile: bool = False
    layout: BedLayout = IN_THE_CORNER
    tabs: Tabs | None = None
    framed: bool = False

    def jobs(self, pattern: FoldedPattern, profile: Profile) -> tuple[Job, ...]:
        """Return the jobs of a pattern for a machine, for a printer with hints; errors as of ``make_jobs``."""
        made = make_jobs(
            pattern,
            profile,
            material=self.material,
            treatment=self.treatment,
            two_sided=self.two_sided,
            registration=self.registration,
            marks=self.marks,
            tile=self.tile,
            layout=self.layout,
            tabs=self.tabs,
            framed=self.framed,
        )
        if profile.kind != "printer":
            return made
        from foldcut.folding_steps.hints import hints

        subtitle, lines = hints(pattern, COLOURS.get(profile.operations["mark"].colour, "outline's"))
        return (replace(made[0], subtitle=subtitle, hints=lines), *made[1:])

    def words(self) -> tuple[str, ...]:
        """Return the options as they are typed on the command line, those that are not as the profile says."""
        at = self.layout.at
        values = {
            "--material": self.material,
            "--treatment": self.treatment,
            "--two-sided": self.two_sided,
            "--registration": self.registration,
            "--marks": None if self.marks is None else ",".join(self.marks) or "none",
            "--tile": self.tile,
            "--at": None if at is None else f"{at[0]:g}mm,{at[1]:g}mm",
            "--copies": None if self.layout.copies == 1 else self.layout.copies,
            "--tabs": self.tabs,
            "--frame": self.framed,
        }
        return tuple(
            name if value is True else f"{name}={value}"
            for name, value in values.items()
            if value is not None and value is not False
        )

    def sides(self, path: Path) -> dict[Side, Path]:
        """Return the files that ``path`` stands for: one, or one for the front and one for the back; a PDF has both."""
        if not self.two_sided or path.suffix.lower() not in JOB_EXPORTERS or path.suffix.lower() == DUPLEX:
            return {"both": path}
        return {"front": path.with_stem(f"{path.stem}-front"), "back": path.with_stem(f"{path.stem}-back")}

    def targets(self, path: Path, profile: Profile | None) -> list[Path]:
        """Return the files that may be written for ``path``: for each side, and each tool if these have files apart."""
        sides = list(self.sides(path).values())
        frames = [frame_path(side) for side in sides] if self.framed and path.suffix.lower() in JOB_EXPORTERS else []
        if not tools_apart(path, profile):
            return [*frames, *sides]
        return [*frames, *(tool_path(side, tool) for side in sides for tool in dict.fromkeys(TOOLS.values()))]


TOOLS: dict[Action, str] = {"mark": "mark", "score": "score", "draw": "score", "perforate": "cut", "cut": "cut"}
"""What the file of a tool is called, by what is done with it, where every tool has a file of its own."""


def tools_apart(path: Path, profile: Profile | None) -> bool:
    """Whether a job needs a file for each tool: the machine has one holder, and would cut where it should score."""
    hpgl = None if profile is None else profile.hpgl
    return path.suffix.lower() == ".hpgl" and hpgl is not None and hpgl.tools == "separate"


def tool_path(path: Path, tool: str) -> Path:
    """Return the file of a tool."""
    return path.with_stem(f"{path.stem}-{tool}")


def frame_path(path: Path) -> Path:
    """Return the file that goes round the job of another file, with the tool off."""
    return path.with_stem(f"{path.stem}-frame")


def job_files(job: Job, path: Path, profile: Profile) -> dict[Path, Job]:
    """Return what of a job is in which file: all of it in one, or the steps of each tool in a file of its own."""
    if not tools_apart(path, profile):
        return {path: job}
    steps: dict[str, list[JobStep]] = {}
    for step in job.steps:
        steps.setdefault(TOOLS[step.action], []).append(step)
    return {tool_path(path, tool): replace(job, steps=tuple(some)) for tool, some in steps.items()}


class Maker:
    """Makes the files of a pattern.

    ``recipe``: how they are made, if that is to stand in them. ``jobs``: the pattern's jobs for the machine, by side,
    once a file has needed them; ``jobs_of``: what of them is in each file.
    """

    def __init__(
        self, pattern: FoldedPattern, profile: Profile | None, options: JobOptions, recipe: Recipe | None = None
    ) -> None:
        self.pattern, self.profile, self.options, self.recipe = pattern, profile, options, recipe
        self.jobs: dict[Side, Job] = {}
        self.jobs_of: dict[Path, Job] = {}

    def files(self, path: Path) -> dict[Path, bytes]:
        """Return the bytes of each file that ``path`` stands for, with their recipe; its ending says the format.

        Raises FileFormatError and JobError, as exporters do.
        """
        return self._with_recipe(path, self._without_recipe(path))

    def named_files(self, path: Path) -> dict[Path, bytes]:
        """Return what ``files`` returns for a name that the user chose: for a printer, that of a kit asks for one."""
        if self.profile is None or self.profile.kind != "printer":
            return self.files(path)
        from foldcut.exporters.kit import is_kit

        return self.kit(path) if is_kit(path.name) else self.files(path)

    def kit(self, path: Path) -> dict[Path, bytes]:
        """Return the bytes of a PDF for a printer with the folding guide behind it, with its recipe."""
        from foldcut.exporters.kit import kit

        assert self.profile is not None
        sheets = self._without_recipe(path)
        return self._with_recipe(path, {p: kit(data, self.pattern, self.profile) for p, data in sheets.items()})

    def _with_recipe(self, path: Path, made: dict[Path, bytes]) -> dict[Path, bytes]:
        recipe = self.recipe
        if recipe is not None and path.suffix.lower() not in JOB_EXPORTERS:
            recipe = recipe.without(JOB_WORDS)  # they are refused where there is no job
        return made if recipe is None else {p: recipe.put_into(data, path.name, p.name) for p, data in made.items()}

    def _without_recipe(self, path: Path) -> dict[Path, bytes]:
        profile, options = self.profile, self.options
        if profile is None or not profile.operations or path.suffix.lower() not in JOB_EXPORTERS:
            return {path: export(self.pattern, path.suffix, profile)}
        if not self.jobs:
            self.jobs = {job.side: job for job in options.jobs(self.pattern, profile)}
        if options.two_sided and path.suffix.lower() == DUPLEX:
            front, back = self.jobs["front"], self.jobs["back"]
            self.jobs_of[path] = replace(front, side="both")
            return {path: export_duplex(front, back, profile)}
        files: dict[Path, bytes] = {}
        for side, name in options.sides(path).items():
            if options.framed:
                files[frame_path(name)] = export_frame(self.jobs[side], path.suffix, profile)
            parts = job_files(self.jobs[side], name, profile)
            files |= {part: export_job(job, path.suffix, profile) for part, job in parts.items()}
            self.jobs_of |= parts
        return files
