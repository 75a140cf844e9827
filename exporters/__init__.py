"""Exporters of finished patterns and of jobs: one module for each format, and a table for each of the two.

An exporter of ``pattern/`` or ``solids/`` takes a ``FoldedPattern``, one of ``job/`` the ``Job`` for a machine; both
take a ``Profile`` and return the bytes of a file. An exporter opens no file, prints nothing and changes no geometry;
the same input gives the same bytes.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import cast

from foldcut.core.errors import FileFormatError
from foldcut.core.model import FoldedPattern, Sheet
from foldcut.jobs.arrange import IN_THE_CORNER, BedLayout
from foldcut.jobs.bed import Lay
from foldcut.jobs.errors import JobError, LackingError
from foldcut.jobs.job import Job, check_job, steps_of
from foldcut.jobs.last_door import brought_on_bed, check_pattern
from foldcut.jobs.tabs import Tabs
from foldcut.profiles import Profile, Registration, load_profile, profile_names

PatternExporter = Callable[[FoldedPattern, Profile], bytes]
JobExporter = Callable[[Job, Profile], bytes]

# Modules are named and not imported here: ezdxf alone takes longer to import than all the rest.
PATTERN_EXPORTERS = {
    ".fold": "pattern.fold.export",
    ".svg": "pattern.svg.export",
    ".cp": "pattern.cp.export",
    ".opx": "pattern.opx.export",
    ".png": "pattern.png.export",
    ".html": "pattern.html_page.export",
    ".stl": "solids.stl.export",
    ".3mf": "solids.threemf.export",
    ".step": "solids.step.export",
}
"""The exporters of patterns, by the ending of their files."""

SOLIDS = (".stl", ".3mf", ".step")
"""The endings of solids, which need the extra ``solids`` and a profile with ``solid``."""

SOFTWARE_SVG = "pattern.bare_svg.export"
"""What writes SVG for profiles of kind "software"."""

JOB_EXPORTERS = {
    ".svg": "job.svg.export",
    ".dxf": "job.dxf.export",
    ".hpgl": "job.hpgl.export",
    ".gcode": "job.gcode.export",
    ".pdf": "job.pdf.export",
    ".lbrn2": "job.lbrn2.export",
}
"""The exporters of jobs, by the ending of their files."""

FRAME_EXPORTERS = {".gcode": "job.gcode.export_frame", ".hpgl": "job.hpgl.export_frame"}
"""What writes the way round a job with the tool off, in the formats that have such moves."""
DUPLEX = ".pdf"
"""The format that has both sides in one file."""


def check_suffix(
    suffix: str, machine: Profile | None = None, profile: Profile | None = None, sheet: Sheet | None = None
) -> None:
    """Raise FileFormatError unless a file with this ending, such as ``".svg"``, can be written.

    Without a ``machine``, only files of the pattern can be written. ``profile``: the one that they are made with, by
    default "plain"; ``sheet``: what is scored. Raises JobError: the profile makes no solid, or not of this sheet.
    """
    known = {**PATTERN_EXPORTERS, **(JOB_EXPORTERS if machine else {})}
    if suffix.lower() in known:
        if suffix.lower() in SOLIDS:
            from .solids.scored_sheet import check_bed, check_solid, needs

            profile = profile or load_profile()
            check_solid(profile)
            if sheet is not None and profile.solid is not None and not profile.solid.folded:
                check_bed(sheet.width, sheet.height, profile, "the sheet")
            if suffix.lower() == ".step":
                needs("build123d")
        return
    if suffix.lower() in JOB_EXPORTERS:
        for_it = machines_for(suffix)
        which = f" {' or '.join(for_it)}" if for_it else ""
        raise FileFormatError(f"{suffix} files are for a machine: name it with --profile{which}; see foldcut profiles")
    what = f"foldcut cannot write {suffix} files" if suffix else "an output file needs an ending that names its format"
    machines = "" if machine else f"; for a machine, with --profile, {', '.join(JOB_EXPORTERS)}"
    raise FileFormatError(f"{what}; use one of {', '.join(known)}{machines}")


def export(pattern: FoldedPattern, suffix: str, profile: Profile | None = None) -> bytes:
    """Return ``pattern`` as the bytes of a file with this ending; ``profile`` is "plain" by default.

    SVG is bare lines with a profile of kind "software", otherwise a drawing to look at and to print.

    Raises FileFormatError: no exporter writes a pattern to such a file. Raises BadInputError: it leaves its sheet.
    """
    profile = profile or load_profile()
    check_suffix(suffix, profile=profile)
    check_pattern(pattern)
    bare = suffix.lower() == ".svg" and profile.kind == "software"
    exporter = cast(PatternExporter, _imported(SOFTWARE_SVG if bare else PATTERN_EXPORTERS[suffix.lower()]))
    return exporter(pattern, profile)


def check_job_export(
    suffix: str,
    profile: Profile,
    sheet: Sheet,
    *,
    material: str | None = None,
    tile: bool = False,
    registration: Registration | None = None,
    layout: BedLayout = IN_THE_CORNER,
    tabs: Tabs | None = None,
    framed: bool = False,
) -> None:
    """Raise, before there is a pattern, what ``make_jobs`` and ``export_job`` would raise for any on this sheet."""
    if framed:
        _check_frame(suffix)
    check_job(sheet, profile, material=material, tile=tile, registration=registration, layout=layout, tabs=tabs)
    lay = Lay.for_machine(sheet, profile, tile=tile)
    steps = steps_of(profile, material)
    export_job(Job("", lay.size, lay.at, lay.turned, "both", steps, 0.0, 0.0, lay.paper), suffix, profile)


def machines_for(suffix: str) -> list[str]:
    """Return the profiles whose own format has this ending."""
    return [name for name in profile_names() if f".{load_profile(name).format}" == suffix.lower()]


def export_job(job: Job, suffix: str, profile: Profile) -> bytes:
    """Return a job as the bytes of a file with this ending.

    Raises FileFormatError: no exporter writes a job to such a file. Raises JobError: the profile lacks something that
    the format needs, or a stroke leaves the sheet or the bed.
    """
    if suffix.lower() not in JOB_EXPORTERS:
        what = f"{suffix} files hold no job" if suffix else "an output file needs an ending that names its format"
        raise FileFormatError(f"{what}; use one of {', '.join(JOB_EXPORTERS)}")
    exporter = cast(JobExporter, _imported(JOB_EXPORTERS[suffix.lower()]))
    try:
        return exporter(brought_on_bed(job, profile), profile)
    except LackingError as error:
        others = [] if suffix.lower() == f".{profile.format}" else machines_for(suffix)
        if not others:
            raise
        another = f"make {suffix} files by a command of their own, with --profile {' or '.join(others)}"
        raise JobError(f"{error.what}; {', or '.join([*error.remedies, another])}") from None


def export_frame(job: Job, suffix: str, profile: Profile) -> bytes:
    """Return the way round a job with the tool off, in the format of this ending.

    Raises FileFormatError: the format has no such moves. Raises JobError as ``export_job`` does.
    """
    _check_frame(suffix)
    exporter = cast(JobExporter, _imported(FRAME_EXPORTERS[suffix.lower()]))
    return exporter(brought_on_bed(job, profile), profile)


def _check_frame(suffix: str) -> None:
    """Raise FileFormatError unless files with this ending have moves with the tool off."""
    if suffix.lower() not in FRAME_EXPORTERS:
        raise FileFormatError(
            f"--frame needs moves with the tool off, and {suffix} files have none; use the framing of the machine's "
            f"own software, or write {' or '.join(FRAME_EXPORTERS)} for a machine that takes it"
        )


def export_duplex(front: Job, back: Job, profile: Profile) -> bytes:
    """Return the jobs of both sides as one PDF to print on both sides; errors as for ``export_job``."""
    from .job.pdf import export_duplex

    return export_duplex(brought_on_bed(front, profile), brought_on_bed(back, profile), profile)


def _imported(name: str) -> object:
    module, _, function = name.rpartition(".")
    return getattr(import_module(f"{__package__}.{module}"), function)
