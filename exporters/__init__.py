"""Writers of finished patterns: one module per format, one table of them.

Stage: after verification. A pattern's exporter takes a ``FoldedPattern``, a job's exporter the ``Job`` that a machine
does, both a ``Profile``; the output is the bytes of a file. An exporter opens no file, prints nothing and changes no
geometry; the same input gives the same bytes.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import cast

from foldcut.core.errors import FileFormatError
from foldcut.core.model import FoldedPattern, Sheet
from foldcut.jobs.job import Job, check_job, steps_of
from foldcut.profiles import Profile, load_profile

PatternExporter = Callable[[FoldedPattern, Profile], bytes]
JobExporter = Callable[[Job, Profile], bytes]

# Imported when they are used: ezdxf alone takes longer to import than all the rest.
PATTERN_EXPORTERS = {
    ".fold": "pattern.fold.export",
    ".svg": "pattern.svg.export",
    ".cp": "pattern.lines.export_cp",
    ".opx": "pattern.lines.export_opx",
    ".png": "pattern.png.export",
    ".html": "pattern.page.export",
    ".stl": "solids.stl.export",
    ".3mf": "solids.threemf.export",
    ".step": "solids.step.export",
}
SOLIDS = (".stl", ".3mf", ".step")
SOFTWARE_SVG = "pattern.lines.export_svg"
JOB_EXPORTERS = {
    ".svg": "job.layered_svg.export",
    ".dxf": "job.dxf.export",
    ".hpgl": "job.hpgl.export",
    ".gcode": "job.gcode.export",
    ".pdf": "job.pdf.export",
    ".lbrn2": "job.lbrn2.export",
}


def check_suffix(suffix: str, machine: Profile | None = None, profile: Profile | None = None) -> None:
    """Raise FileFormatError unless a file with this ending, such as ``".svg"``, can be written.

    Without a ``machine`` there are files of the pattern only; ``profile``: what these are made by, "plain" unless
    given. Raises JobError: the profile makes no solid.
    """
    known = {**PATTERN_EXPORTERS, **(JOB_EXPORTERS if machine else {})}
    if suffix.lower() in known:
        if suffix.lower() in SOLIDS:
            from .solids.solid import check_solid, needs

            check_solid(profile or load_profile())
            if suffix.lower() == ".step":
                needs("build123d")
        return
    if suffix.lower() in JOB_EXPORTERS:
        raise FileFormatError(f"{suffix} files are for a machine: name it with --profile; see foldcut profiles")
    what = f"foldcut cannot write {suffix} files" if suffix else "an output file needs an ending that names its format"
    machines = "" if machine else f"; for a machine, with --profile, {', '.join(JOB_EXPORTERS)}"
    raise FileFormatError(f"{what}; use one of {', '.join(known)}{machines}")


def export(pattern: FoldedPattern, suffix: str, profile: Profile | None = None) -> bytes:
    """Return ``pattern`` as the bytes of a file with this ending; ``profile`` is "plain" unless given.

    With a profile of kind "software" SVG is bare lines, else a drawing to look at and to print.

    Raises FileFormatError: no exporter writes such files of a pattern.
    """
    profile = profile or load_profile()
    check_suffix(suffix, profile=profile)
    bare = suffix.lower() == ".svg" and profile.kind == "software"
    exporter = cast(PatternExporter, _imported(SOFTWARE_SVG if bare else PATTERN_EXPORTERS[suffix.lower()]))
    return exporter(pattern, profile)


def check_job_export(
    suffix: str, profile: Profile, sheet: Sheet, *, material: str | None = None, tile: bool = False
) -> None:
    """Raise what ``make_jobs`` and ``export_job`` would for any pattern on this sheet, before there is one."""
    check_job(sheet, profile, material=material, tile=tile)
    size = (sheet.width, sheet.height)
    export_job(Job("", size, (0.0, 0.0), False, "both", steps_of(profile, material), 0.0, 0.0), suffix, profile)


def export_job(job: Job, suffix: str, profile: Profile) -> bytes:
    """Return a job as the bytes of a file with this ending.

    Raises FileFormatError: no exporter writes jobs so. Raises JobError: the profile lacks what the format needs.
    """
    if suffix.lower() not in JOB_EXPORTERS:
        raise FileFormatError(
            f"{suffix or 'a name without an ending'} is no job; use one of {', '.join(JOB_EXPORTERS)}"
        )
    return cast(JobExporter, _imported(JOB_EXPORTERS[suffix.lower()]))(job, profile)


def _imported(name: str) -> object:
    module, _, function = name.rpartition(".")
    return getattr(import_module(f"{__package__}.{module}"), function)
