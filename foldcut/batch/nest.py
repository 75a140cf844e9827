"""The sheets of a batch laid together on as few beds as they take, one job for each bed.

FOLD files that the batch wrote, a ``Profile`` and ``JobOptions`` -> the files of every bed, and which sheet lies where.
What a machine cuts out are the sheets, which are rectangles: they are packed by ``rectpack``, upright or turned by a
quarter, ``APART_MM`` apart. Only their sizes and names matter for that, not in which order they were folded.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import product
from pathlib import Path
from typing import Any

from foldcut.batch.worker import MADE
from foldcut.core.errors import BadInputError
from foldcut.core.model import FoldedPattern
from foldcut.exporters import JOB_EXPORTERS, export_frame, export_job
from foldcut.exporters.bundle import OURS
from foldcut.exporters.text import printable
from foldcut.foldfile.read import read_fold_apart
from foldcut.foldfile.reopen import reopen
from foldcut.jobs.arrange import APART_MM, IN_THE_CORNER, arranged, check_bed, check_copies, from_zero, quarter_turned
from foldcut.jobs.duration import about, seconds_of_steps
from foldcut.jobs.errors import JobError
from foldcut.jobs.instructions import instructions
from foldcut.jobs.model import Job
from foldcut.output.render import JobOptions, frame_path, job_files
from foldcut.profiles import Bed, Profile

BEDS = "beds.txt"
"""The name of the file that says which sheet lies where, and what the operator does."""

BED_FILE = re.compile(rf"bed-[1-9][0-9]*(-[a-z]+)?({'|'.join(map(re.escape, JOB_EXPORTERS))})")
"""What the files of beds are called."""

MICRONS = 1000
"""The packer counts in whole numbers: thousandths of a mm."""

MANY = 1000
"""For more sheets than this only one way of packing is tried: others take too long."""

WAYS = tuple(product(("MaxRectsBssf", "MaxRectsBl", "GuillotineBssfSas"), ("SORT_AREA", "SORT_LSIDE", "SORT_SSIDE")))
"""How sheets are packed, as the packer calls it.

The way that takes the fewest beds is taken, of several the one that leaves most of the last.
"""


@dataclass(frozen=True)
class Sheet:
    """A sheet on a bed: its drawing, its corner next to the bed's zero, in mm from there, and whether it is turned."""

    drawing: str
    at: tuple[float, float]
    turned: bool


@dataclass(frozen=True)
class NestedBed:
    """What is done on one bed at once: the ``files`` by name, the sheets, and how many seconds it takes, if known."""

    files: Mapping[str, bytes]
    sheets: tuple[Sheet, ...]
    job: Job
    seconds: float | None


Packed = list[tuple[int, float, float, bool]]
"""The sheets on a bed: the number of each, its corner in mm from the bed's zero, and whether it is turned."""


def check_nesting(profile: Profile | None, options: JobOptions) -> None:
    """Raise what is wrong with laying the sheets of a batch on beds together, before any of them is folded."""
    if profile is None or not profile.operations:
        raise BadInputError("--nest lays sheets on the bed of a machine: name it with --profile; see foldcut profiles")
    check_bed(profile)
    check_copies(options.layout)
    if options.two_sided:
        raise JobError(
            "--nest is for one side, since sheets that lie both ways are turned over in two ways; leave --two-sided out"
        )
    if options.layout.at is not None:
        raise JobError("--at is for one sheet, and --nest chooses where each lies; leave one of them out")


@dataclass(frozen=True)
class Nesting:
    """That sheets are laid on beds together: the ``endings`` of their files, and how often each drawing is wanted.

    ``counts``: by stem, where it is not once.
    """

    endings: tuple[str, ...]
    counts: Mapping[str, int] = field(default_factory=dict)


def nested_files(
    folder: Path, records: Sequence[Mapping[str, Any]], nesting: Nesting, profile: Profile, options: JobOptions
) -> tuple[list[NestedBed], dict[Path, bytes], list[Path]]:
    """Return the beds for the drawings of a batch that were made, their files, and those of an earlier run to remove.

    ``records``: those of the journal. Raises JobError: a sheet does not fit the bed. Raises BadInputError: a drawing's
    file has the name of a bed's.
    """
    stems = [
        record["stem"]
        for record in records
        if record["status"] == MADE
        for _ in range(nesting.counts.get(record["stem"], 1))
    ]
    if not stems:
        return [], {}, []
    beds = nest(folder, stems, nesting.endings, profile, options)
    files = {name: data for bed in beds for name, data in bed.files.items()}
    files[BEDS] = beds_text(beds, nesting.endings, profile)
    others = {name for record in records for name in record["outputs"]}
    for name in others & {*files}:
        raise BadInputError(
            f"{folder / name} is of a drawing, and --nest gives a bed that name; call the drawing otherwise"
        )
    stale = [path for path in beds_of_before(folder) if path.name not in files and path.name not in others]
    return beds, {folder / name: data for name, data in files.items()}, stale


def beds_of_before(folder: Path) -> list[Path]:
    """Return the files of beds that an earlier run wrote; none unless its list of them is there."""
    about = folder / BEDS
    if not about.is_file() or not about.read_bytes().startswith(OURS.encode()):
        return []
    return [path for path in sorted(folder.glob("bed-*")) if BED_FILE.fullmatch(path.name)]


def nest(
    folder: Path, stems: Sequence[str], endings: Sequence[str], profile: Profile, options: JobOptions
) -> list[NestedBed]:
    """Return the beds for the drawings whose patterns are ``STEM.fold`` in a folder, each as often as it is named.

    ``endings``: those of a bed's files. Raises JobError: a sheet does not fit the bed.
    """
    jobs = {stem: _job(opened(folder / f"{stem}.fold"), profile, options) for stem in sorted(set(stems))}
    names = sorted(stem for stem in stems for _ in range(options.layout.copies))
    packed = pack([jobs[name].size for name in names], check_bed(profile))
    return [_bed(number, sheets, names, jobs, endings, profile) for number, sheets in enumerate(packed, 1)]


def pack(sizes: Sequence[tuple[float, float]], bed: Bed) -> list[Packed]:
    """Return which sheets of these sizes, in mm, lie where on which bed, in the order of their numbers."""
    ways = WAYS if len(sizes) <= MANY else WAYS[:1]
    results = [_packed(sizes, bed, algorithm, order) for algorithm, order in ways]
    return min(results, key=lambda beds: (len(beds), sum(_area(sizes[number]) for number, *_ in beds[-1])))


def opened(path: Path) -> FoldedPattern:
    """Return the pattern in a FOLD file of the batch, verified anew."""
    made = reopen(read_fold_apart(path))
    if not made.verified:
        raise BadInputError(f"{path} is not as the batch wrote it ({made.findings[0]}); make it again with --force")
    return made.folded_pattern


def _area(size: tuple[float, float]) -> float:
    return size[0] * size[1]


def _packed(sizes: Sequence[tuple[float, float]], bed: Bed, algorithm: str, order: str) -> list[Packed]:
    import rectpack

    packer = rectpack.newPacker(
        pack_algo=getattr(rectpack, algorithm), sort_algo=getattr(rectpack, order), rotation=True
    )
    whole = [(round(MICRONS * (w + APART_MM)), round(MICRONS * (h + APART_MM))) for w, h in sizes]
    for number, (width, height) in enumerate(whole):
        packer.add_rect(width, height, rid=number)
    packer.add_bin(
        round(MICRONS * (bed.width_mm + APART_MM)), round(MICRONS * (bed.height_mm + APART_MM)), count=float("inf")
    )
    packer.pack()
    beds: dict[int, Packed] = {}
    for place, x, y, width, _, number in packer.rect_list():
        beds.setdefault(place, []).append((number, x / MICRONS, y / MICRONS, width != whole[number][0]))
    if sum(map(len, beds.values())) < len(sizes):
        raise JobError(
            f"a sheet does not fit the machine's {bed.width_mm:g} x {bed.height_mm:g} mm; use a smaller --sheet"
        )
    return [sorted(sheets) for _, sheets in sorted(beds.items())]


def _job(pattern: FoldedPattern, profile: Profile, options: JobOptions) -> Job:
    (job,) = replace(options, layout=IN_THE_CORNER).jobs(pattern, profile)
    return replace(job, at=(0.0, 0.0))


def _bed(
    number: int, packed: Packed, names: Sequence[str], jobs: Mapping[str, Job], endings: Sequence[str], profile: Profile
) -> NestedBed:
    """Return the files of one bed and what lies on it."""
    bed = check_bed(profile)
    parts = []
    for sheet, x, y, turned in packed:
        job = quarter_turned(jobs[names[sheet]]) if turned else jobs[names[sheet]]
        parts.append((job, from_zero((x, y), job.size, bed)))
    whole = replace(arranged(parts, profile), title=f"bed {number}", turned=False)
    files: dict[str, bytes] = {}
    for ending in endings:
        path = Path(f"bed-{number}{ending}")
        if whole.framed:
            files[str(frame_path(path))] = export_frame(whole, ending, profile)
        files |= {str(name): export_job(job, ending, profile) for name, job in job_files(whole, path, profile).items()}
    sheets = tuple(
        Sheet(names[sheet], corner, job.turned)
        for (sheet, *_), (job, _), corner in zip(packed, parts, whole.corners, strict=True)
    )
    seconds = seconds_of_steps(whole, profile)
    return NestedBed(files, sheets, whole, None if seconds is None else sum(seconds))


def beds_text(beds: Sequence[NestedBed], endings: Sequence[str], profile: Profile) -> bytes:
    """Return what is on every bed, and what the operator does with its files."""
    lines = [f"{OURS}: {sum(len(bed.sheets) for bed in beds)} sheets on {len(beds)} bed{'s' * (len(beds) > 1)}", ""]
    for number, bed in enumerate(beds, 1):
        lasts = "" if bed.seconds is None else f", {about(bed.seconds)} on the machine"
        lines.append(f"Bed {number}: {', '.join(bed.files)}{lasts}")
        for sheet in bed.sheets:
            turned = ", a quarter turn to the left" if sheet.turned else ""
            lines.append(f"  {printable(sheet.drawing)} at ({sheet.at[0]:g}, {sheet.at[1]:g}){turned}")
        lines += ["", *(f"  {line}" for line in instructions(profile, [bed.job], [end[1:] for end in endings])), ""]
    return ("\r\n".join(lines)).encode()
