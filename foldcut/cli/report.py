"""Reports about patterns: a plain dictionary, which ``--json`` prints, and the same as lines of text.

A finished pattern, how it was made and what verification found -> a ``Report`` -> lines. Nothing is printed or verified
here.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from textwrap import shorten
from typing import TYPE_CHECKING, Any

import numpy as np

from foldcut.core.arrays import Floats
from foldcut.core.model import CreasePattern, Finding, Sheet
from foldcut.core.units import rounded_up
from foldcut.folding_steps.phases import Phase, in_words
from foldcut.geometry.vectors import cross
from foldcut.methods import METHODS, fewer_creases
from foldcut.pattern.cut_line import pieces_of
from foldcut.pattern.first_folds import first_fold_count, is_wedge, layers_after, sectors_left
from foldcut.pattern.foldability import PAPER_MM, crease_numbers, foldability, thickness
from foldcut.proof.verify import CHECKS

if TYPE_CHECKING:
    from foldcut.cli.outputs import MadeFor
    from foldcut.foldfile.decide import Decision
    from foldcut.foldfile.reopen import Reopened
    from foldcut.jobs.job import Job
    from foldcut.layer_orders.count import States
    from foldcut.pipeline import Result
    from foldcut.profiles import Profile
    from foldcut.readers import Drawing
    from foldcut.redraw.ladder import Ladder, Level

MOST_LETTERS = 60
"""How much of the reason why an outline has no pattern is in the table; the report for programs has all."""

MOST_FOLDS_UNASKED = 300
"""Methods that are tried only where they are asked for get a warning with a pattern of more folds than this."""

Report = dict[str, Any]
"""What JSON can hold: the names and numbers that programs read."""

MOST_FINDINGS = 10
"""How many findings the text shows; the report for programs has all."""


def make_report(
    result: Result,
    files: Sequence[Report],
    made: Sequence[MadeFor] = (),
) -> Report:
    """Return the report of ``foldcut make``.

    ``files``: a dictionary with path, bytes and replaced for each file that was written; ``made``: the machines that
    they are for, and their jobs. The thickness is that of the first machine's material, by default the first one of its
    profile, or of office paper where the profile names no materials.
    """
    pattern = result.folded_pattern
    sheet = pattern.sheet
    first = made[0].machine if made else None
    paper, paper_mm = _paper(first.profile, first.job.material) if first is not None else ("office paper", PAPER_MM)
    numbers = foldability(pattern, paper_mm, fewer_creases())
    return {
        "ok": result.verified,
        "title": pattern.title,
        "sheet": {"name": sheet.name, "width_mm": sheet.width, "height_mm": sheet.height},
        "drawing": _drawing_report(result.drawing),
        **({"pieces": len(pieces_of(pattern.shape, sheet))} if pattern.shape.is_graph else {}),
        "scale_mm_per_unit": pattern.placement.scale,
        "corners": pattern.shape.corner_count,
        "ladder": _ladder_report(result.ladder),
        "method": result.method,
        **result.numbers,
        "told": list(result.told),
        "attempts": list(map(asdict, result.attempts)),
        "actions": result.folds,
        "phases": [asdict(phase) for phase in result.phases],
        "difficulty": {**asdict(result.difficulty), "level": result.difficulty.level, "text": str(result.difficulty)},
        "first_folds": [line.tolist() for line in pattern.first_folds],
        "first_fold_count": first_fold_count(pattern.first_folds),
        "ribbon_mm": result.ribbon,
        "paper": paper,
        **asdict(numbers),
        "warnings": [*numbers.warnings, *_too_many_folds(result)],
        "faces": len(pattern.creases.faces_vertices),
        "seconds": dict(result.seconds),
        "verified": list(CHECKS) if result.verified else [],
        "findings": list(map(asdict, result.findings)),
        "notes": list(result.notes),
        **_machine_report(files, made),
        "files": list(files),
    }


def _too_many_folds(result: Result) -> list[str]:
    """Return a warning of a pattern that was made only because its method was asked for, and what to do instead."""
    if result.actions <= MOST_FOLDS_UNASKED or not METHODS[result.method].needs_ribbon:
        return []
    return [
        f"nobody folds {result.actions:,} folds by hand; they come of --method {result.method}: without it "
        "the drawing is folded with few folds, or drawn anew with fewer corners until that can be done"
    ]


def _drawing_report(drawing: Drawing | None) -> Report | None:
    """Return the numbers of the drawing that was read."""
    if drawing is None:
        return None
    return {
        "loops": len(drawing.loops),
        "points": sum(map(len, (*drawing.loops, *drawing.lines))),
        "unit_mm": drawing.unit_mm,
        "size": list(drawing.size),
        "size_mm": None if drawing.size_mm is None else list(drawing.size_mm),
        "ignored": list(drawing.ignored),
    }


def _drawing_rows(report: Report) -> list[tuple[str, str]]:
    """Return the lines about the drawing that was read."""
    drawing = report["drawing"]
    if drawing is None:
        return []
    unit = drawing["unit_mm"]
    width, height = drawing["size"] if unit is None else drawing["size_mm"]
    size = f"{width:.4g} x {height:.4g}"
    said = "in a unit that the file does not say" if unit is None else f"mm; the file's unit is {unit:.4g} mm"
    loops = _count(drawing["loops"], "loop") if drawing["loops"] else "lines"
    loops = f"{loops}, {drawing['points']} points"
    rows = [("drawing", f"{loops}, {size} {said}")]
    return [*rows, ("ignored", ", ".join(drawing["ignored"]))] if drawing["ignored"] else rows


def _ladder_report(ladder: Ladder | None) -> Report | None:
    """Return what each tolerance costs, and which was taken."""
    if ladder is None:
        return None
    return {
        "taken": ladder.taken,
        "folds_allowed": ladder.folds,
        "interrupted": ladder.interrupted,
        "levels": [level_report(level, alone=len(ladder.levels) == 1) for level in ladder.levels],
    }


def level_report(level: Level, *, quick: bool = False, alone: bool = False) -> Report:
    """Return the numbers of one tolerance; ``quick``: without what takes time; ``alone``: it is the only one."""
    numbers = ("tolerance_mm", "off_by_mm", "corners", "folds", "shortest_mm", "layers", "for_hands", "failure")
    report = {name: getattr(level, name) for name in numbers} | {"seconds": round(level.seconds, 3)}
    if level.folds is None:
        report["off_by_mm"] = None  # there is no outline to measure
        report["corners"] = level.corners or None
    if quick:
        return report | {"simple_folds": None}
    return report | {"folds": level.counted_folds, "simple_folds": None if alone else level.simple_folds}


MOVED_MM = 0.05
"""A drawing whose corners moved by less than this, in mm on the sheet, is called as drawn and nothing more."""

LADDER_HEAD = ("tolerance", "off by", "corners", "folds", "simple", "shortest", "layers")
"""The columns of the ladder."""


def _ladder_rows(report: Report) -> list[tuple[str, str]]:
    """Return the lines about the tolerances that were tried: a table, what was taken, and what the next would cost."""
    ladder = report["ladder"]
    if ladder is None:
        return []
    taken, levels = ladder["taken"], ladder["levels"]
    if len(levels) == 1 and not levels[0]["tolerance_mm"]:
        hands = "for two hands" if levels[0]["for_hands"] else f"not for two hands ({_why_not(levels[0], ladder)})"
        off = levels[0]["off_by_mm"]
        moved = "" if off < MOVED_MM else f", but for corners moved by up to {rounded_up(off)} mm"
        return [("outline", f"as drawn{moved}; {hands}")]
    cells = [LADDER_HEAD, *map(_ladder_cells, levels)]
    widths = [max(map(len, column)) for column in zip(*(row for row in cells if len(row) > 1), strict=True)]
    marks = ["  ", *("> " if number == taken else "  " for number in range(len(levels)))]
    texts = [mark + "  ".join(map(str.rjust, row, widths)) for mark, row in zip(marks, cells, strict=True)]
    reasons = ["", *(shorten(level["failure"], MOST_LETTERS, placeholder=" ...") for level in levels)]
    texts = [f"{text}  {reason}".rstrip() for text, reason in zip(texts, reasons, strict=True)]
    rows = [("outline" if number == 0 else "", text) for number, text in enumerate(texts)]
    return [*rows, ("taken", _taken_text(ladder)), *[("next", text) for text in _next_text(ladder)]]


def _ladder_cells(level: Report) -> tuple[str, ...]:
    """Return a row of the ladder."""
    tolerance = f"{level['tolerance_mm']:.3g} mm" if level["tolerance_mm"] else "as drawn"
    if level["folds"] is None:
        return (tolerance, "", str(level["corners"] or ""), "-", "-", "-", "-")
    simple = "?" if level["simple_folds"] is None else str(level["simple_folds"])
    return (
        tolerance,
        f"{level['off_by_mm']:.2f} mm",
        str(level["corners"]),
        str(level["folds"]),
        simple,
        f"{level['shortest_mm']:.3g} mm",
        str(level["layers"]),
    )


def _taken_text(ladder: Report) -> str:
    """Say which outline was taken, and why."""
    level = ladder["levels"][ladder["taken"]]
    what = _outline_text(level)
    if level["for_hands"]:
        return f"{what}: it is for two hands, with at most {ladder['folds_allowed']} folds and no crease too short"
    return f"{what}: the easiest to fold of these, but it is not for two hands ({_why_not(level, ladder)})"


def _outline_text(level: Report) -> str:
    """Name the outline of a level."""
    if not level["tolerance_mm"]:
        return "the drawing as it is"
    return f"the outline {rounded_up(level['off_by_mm'])} mm off the drawing"


def _why_not(level: Report, ladder: Report) -> str:
    """Say why a pattern is not for two hands."""
    many = level["folds"] is not None and level["folds"] > ladder["folds_allowed"]
    return f"more than {ladder['folds_allowed']} folds" if many else "its shortest crease is too short"


def _folds_text(level: Report, taken: Report) -> str:
    """Say how many folds one outline takes, beside those of the one that was taken."""
    if level["folds"] == taken["folds"]:
        return "as many folds"
    return f"{level['folds']} fold{'s' * (level['folds'] != 1)} instead of {taken['folds']}"


def _next_text(ladder: Report) -> list[str]:
    """Say what the tolerance after the one that was taken would cost."""
    taken = ladder["levels"][ladder["taken"]]
    for level in ladder["levels"][ladder["taken"] + 1 :][:1]:
        if level["folds"] is None:
            return [f"{level['tolerance_mm']:.3g} mm has no pattern"]
        return [
            f"{_outline_text(level)} would take {_folds_text(level, taken)}, "
            f"the shortest crease {level['shortest_mm']:.3g} mm long (--tolerance, --level easy)"
        ]
    return []


def _paper(profile: Profile | None, material: str | None) -> tuple[str, float]:
    """Return what the sheet is made of, and its thickness in mm."""
    if profile is None or not profile.materials:
        return "office paper", PAPER_MM
    name = material or next(iter(profile.materials))
    return name, profile.materials[name].thickness_mm


def _machine_report(files: Sequence[Report], made: Sequence[MadeFor]) -> Report:
    """Return what a report says of machines: their jobs, their titles, and what their operators do."""
    profiles = [one.machine.profile for one in made if one.machine.profile is not None]
    return {
        "jobs": [_job_report(job, one.machine.profile) for one in made for job in one.jobs],
        "machine": ", ".join(profile.title for profile in profiles) or None,
        "next": [line for one in made for line in _next(files, one, len(made) > 1)],
    }


def _next(files: Sequence[Report], made: MadeFor, several: bool) -> list[str]:
    """Return what the operator does: in the machine's software only if a file is in the format that it reads."""
    from foldcut.exporters import JOB_EXPORTERS
    from foldcut.jobs.instructions import instructions

    profile, jobs = made.machine.profile, made.jobs
    if profile is None:
        return []
    endings = {str(file["path"]).rpartition(".")[2].lower() for file in files}
    fits = bool(endings & {profile.format, "zip"})
    if not fits and not jobs:
        return []
    # a .zip has files in the machine's own format
    formats = {ending for ending in endings if f".{ending}" in JOB_EXPORTERS} | ({profile.format} if fits else set())
    lines = instructions(profile, jobs, formats)
    return [f"{profile.title}: {line}" for line in lines] if several else lines


def make_lines(report: Report) -> list[str]:
    """Return the report of ``foldcut make`` as text."""
    sheet = Sheet(report["sheet"]["width_mm"], report["sheet"]["height_mm"], report["sheet"]["name"])
    seconds = report["seconds"]
    used = f"{report['sheet_used']:.0%} of it is the shape"
    rows = [
        *_drawing_rows(report),
        ("sheet", f"{sheet}; 1 unit of the drawing is {report['scale_mm_per_unit']:.4g} mm"),
        ("", f"cut into {_count(report['pieces'], 'piece')}" if "pieces" in report else used),
        *_ladder_rows(report),
        *_method_rows(report),
        *_fold_rows(report),
        ("skill", report["difficulty"]["text"]),
        *_pattern_rows(report),
        (
            "layers",
            f"{report['layers']} at the thickest place, about {thickness(report['thickness_mm'])} of "
            f"{report['paper']}; {report['layers_at_cut']} to cut through",
        ),
        ("time", f"{seconds.get('build', 0):.2f} s to build, {seconds.get('verify', 0):.2f} s to verify"),
        *[("note", note) for note in report["notes"]],
        *[("warning", warning) for warning in report["warnings"]],
        *_verdict_rows(report),
        *_job_rows(report),
        *_file_rows(report),
    ]
    return [report["title"] or "untitled", *_aligned(rows)]


def _job_report(job: Job, profile: Profile | None) -> Report:
    """Return the numbers of a job."""
    from foldcut.jobs.duration import seconds_of_steps

    seconds = None if profile is None else seconds_of_steps(job, profile)
    return {
        "side": job.side,
        "turned": job.turned,
        "turned_over": job.turned_over,
        "registration": job.registration,
        "holes_mm": None if job.holes is None else (job.holes + job.at).tolist(),
        "corners_mm": [list(corner) for corner in job.corners],
        "tabs": None if job.tabs is None else asdict(job.tabs),
        "missed_mm": list(job.missed),
        "uncut": job.uncut,
        "travel_before_mm": job.travel_before,
        "travel_mm": job.travel,
        "seconds": None if seconds is None else round(sum(seconds), 1),
        "seconds_unverified": profile is not None and "motion" in profile.unverified,
        "steps": [
            {
                "role": step.role,
                "layer": step.operation.layer,
                "colour": step.operation.colour,
                "action": step.action,
                "strokes": len(step.strokes),
                "length_mm": step.length,
                "seconds": None if seconds is None else round(seconds[place], 1),
                **({"setting": step.setting.model_dump()} if step.setting else {}),
            }
            for place, step in enumerate(job.steps)
        ],
    }


def _job_rows(report: Report) -> list[tuple[str, str]]:
    """Return the lines about the machine and its jobs."""
    rows = [("machine", report["machine"])] if report["machine"] else []
    for job in report["jobs"]:
        steps = "; ".join(f"{step['layer']} {step['length_mm'] / 1000:.2f} m" for step in job["steps"])
        turned = ", the sheet lies a quarter turn to the left" if job["turned"] else ""
        rows.append(("job" if job["side"] == "both" else job["side"], steps + turned))
        before, after = job["travel_before_mm"] / 1000, job["travel_mm"] / 1000
        rows.append(("", f"{after:.2f} m between strokes ({before:.2f} m in the pattern's order)"))
        if job["seconds"] is not None:
            rows.append(("", _duration_text(job)))
    return rows


def _duration_text(job: Report) -> str:
    """Say how long a job takes, and what of that each of its steps."""
    from foldcut.jobs.duration import about

    steps = "; ".join(f"{step['layer']} {about(step['seconds']).removeprefix('about ')}" for step in job["steps"])
    doubt = ", by speeds that are unverified" if job["seconds_unverified"] else ""
    return f"{about(job['seconds'])} on the machine{doubt}" + (f": {steps}" if len(job["steps"]) > 1 else "")


def _method_rows(report: Report) -> list[tuple[str, str]]:
    """Return the lines about how the pattern was made, and what came of the other methods that were tried."""
    rows = [("method" if number == 0 else "", text) for number, text in enumerate(report["told"])]
    others = (attempt for attempt in report["attempts"] if attempt["method"] != report["method"])
    rows += [("", f"{attempt['method']}: {_attempt_text(attempt)}") for attempt in others]
    needed = " (this method needs one)" if METHODS[report["method"]].needs_ribbon else ""
    return [*rows, ("", f"ribbon {report['ribbon_mm']:.3g} mm{needed}")] if report["ribbon_mm"] else rows


def _attempt_text(attempt: Report) -> str:
    """Return what came of a method whose pattern was not taken."""
    if attempt["failure"]:
        return str(attempt["failure"]).partition(": loop")[0]
    return (
        f"{attempt['creases']} creases, {attempt['actions']} folds, the shortest {attempt['shortest_mm']:.3g} mm long"
    )


def _fold_rows(report: Report) -> list[tuple[str, str]]:
    """Return the lines about the first folds and the number of folds."""
    lines = [np.array(line) for line in report["first_folds"]]
    rows = [
        ("then" if number else "first", f"fold the sheet in half along {_line_text(line)}, away from you")
        for number, line in enumerate(lines[:1] if is_wedge(lines) else lines)
    ]
    if is_wedge(lines):
        count = len(lines)
        left = ", then ".join(map(str, sectors_left(count)))
        x, y = _crossing(*lines[:2]).tolist()
        way = (
            f"through ({x:.4g}, {y:.4g}) mm, always away from you: of its {count} sectors {left} stay beside each other"
        )
        rows.append(("then", f"fold the half into a wedge of {180 / count:.4g} degrees, along the other lines {way}"))
    counted = [Phase(**phase) for phase in report["phases"]]
    total = "" if len(counted) == 1 else f"{report['actions']}: " if counted else str(report["actions"])
    folds = [("folds", total + in_words(counted))]
    first = first_fold_count(lines)
    if rows and report["actions"] > first:
        number = {1: "", 2: " two", 3: " three", 4: " four"}.get(first, f" {first}")
        folds.append(("", f"all but the first{number} through {layers_after(lines)} layers"))
    return [*rows, *folds]


def _line_text(line: Floats) -> str:
    """Return in words where a line across the sheet is, ``(2, 2)`` mm."""
    (x, y), (to_x, to_y) = line.tolist()
    if x == to_x:
        return f"the upright line at x = {x:.4g} mm"
    return (
        f"the level line at y = {y:.4g} mm"
        if y == to_y
        else (f"the line from ({x:.4g}, {y:.4g}) to ({to_x:.4g}, {to_y:.4g}) mm")
    )


def _crossing(one: Floats, other: Floats) -> Floats:
    """Return where two lines, ``(2, 2)`` mm each, cross."""
    along, across = one[1] - one[0], other[1] - other[0]
    part = cross(other[0] - one[0], across) / cross(along, across)
    place: Floats = one[0] + part * along
    return place


def check_report(creases: CreasePattern, findings: Sequence[Finding], with_shape: bool, notes: Sequence[str]) -> Report:
    """Return the report of ``foldcut check``; without a shape there is no cut to check."""
    return {
        "ok": not findings,
        **asdict(crease_numbers(creases)),
        "faces": len(creases.faces_vertices),
        "verified": [check for check in CHECKS if not findings and (with_shape or check != "cut")],
        "findings": list(map(asdict, findings)),
        "notes": list(notes),
    }


def check_lines(report: Report) -> list[str]:
    """Return the report of ``foldcut check`` as text."""
    notes = [("note", note) for note in report["notes"]]
    return _aligned([*_pattern_rows(report), *notes, *_verdict_rows(report)])


def decision_report(decision: Decision, with_shape: bool, notes: Sequence[str]) -> Report:
    """Return the report of ``foldcut check``: that of the checks, and what was decided."""
    moved = decision.moved
    return {
        **check_report(decision.pattern, decision.findings, with_shape, notes),
        "ok": decision.folds is True,
        "folds": decision.folds,
        "verdict": decision.sentence,
        "verified": [check for check in CHECKS if decision.folds and (with_shape or check != "cut")],
        "moved_mm": None if moved is None else moved.most,
        "moved_at": None if moved is None else list(moved.where),
    }


def states_report(states: States | None) -> Report:
    """Return what is reported of the layer orders that were counted; None: they were too many."""
    if states is None:
        return {"states": None, "states_of_parts": []}
    return {"states": states.number, "states_of_parts": list(states.parts)}


def solved_report(decided: Report, files: Sequence[Report], made: Sequence[MadeFor]) -> tuple[Report, list[str]]:
    """Return the report of ``foldcut solve``, and the same as text; ``decided`` is that of the decision."""
    report = {**decided, **_machine_report(files, made), "files": list(files)}
    return report, [*decision_lines(decided), *_aligned([*_job_rows(report), *_file_rows(report)])]


def decision_lines(report: Report) -> list[str]:
    """Return the report of ``foldcut check`` as text."""
    notes = [("note", note) for note in report["notes"]]
    rows = [*_pattern_rows(report), *notes, ("verdict", report["verdict"])]
    if "states" in report:
        number, parts = report["states"], report["states_of_parts"]
        product = f", {' x '.join(map(str, parts))} of parts that do not depend on each other" if len(parts) > 1 else ""
        rows.append(("states", "too many to be counted" if number is None else f"{number:,}{product}"))
    rows += [] if report["folds"] is None else _verdict_rows(report)
    return _aligned([*rows, *(_file_rows(report) if "files" in report else [])])


def reopened_report(result: Reopened, files: Sequence[Report], made: Sequence[MadeFor] = ()) -> Report:
    """Return the report of a pattern that was read from a FOLD file; ``files`` as in ``make_report``."""
    pattern = result.folded_pattern
    return {
        **check_report(pattern.creases, result.findings, True, result.notes),
        "title": pattern.title,
        **_machine_report(files, made),
        "files": list(files),
    }


def reopened_lines(report: Report) -> list[str]:
    """Return the report of a pattern that was read from a FOLD file as text."""
    rows = [*_job_rows(report), *_file_rows(report)]
    return [report["title"] or "untitled", *check_lines(report), *_aligned(rows)]


def _file_rows(report: Report) -> list[tuple[str, str]]:
    """Return the lines about the files that were written, and what to do with them."""
    written = [("written", _file_text(file)) for file in report["files"]]
    return [*written, *[("next", line) for line in report["next"] if written]]


def _pattern_rows(report: Report) -> list[tuple[str, str]]:
    """Return the lines that every pattern has."""
    counts = f"{_count(report['mountains'], 'mountain')}, {_count(report['valleys'], 'valley')}"
    rows = [("creases", f"{report['creases']}: {counts}; on {_count(report['lines'], 'line')}")]
    if report["shortest_crease_mm"] is not None:
        x, y = report["shortest_crease_at"]
        rows.append(("", f"the shortest {report['shortest_crease_mm']:.3g} mm long, at ({x:.4g}, {y:.4g})"))
    if report["smallest_angle_deg"] is not None:
        rows.append(("", f"the smallest angle between two {report['smallest_angle_deg']:.3g} degrees"))
    return [*rows, ("faces", f"{report['faces']}")]


def _count(number: int, thing: str) -> str:
    """Return "1 loop", "2 loops"."""
    return f"{number} {thing}{'s' * (number != 1)}"


def _verdict_rows(report: Report) -> list[tuple[str, str]]:
    """Return the line that names the checks that passed, or a line for each finding."""
    findings = [Finding(**finding) for finding in report["findings"]]
    if not findings:
        return [("verified", ", ".join(report["verified"]))]
    more = [("", f"and {len(findings) - MOST_FINDINGS} more")] if len(findings) > MOST_FINDINGS else []
    return [("NOT VALID", str(finding)) for finding in findings[:MOST_FINDINGS]] + more


def _file_text(file: Report) -> str:
    """Return a file's path, its size, whether it replaced another, and why its recipe is not in it."""
    without = f"; without a recipe: {file['no_recipe']}" if file.get("no_recipe") else ""
    return f"{file['path']} ({file['bytes']:,} bytes{', replaced' if file['replaced'] else ''}{without})"


def _aligned(rows: Sequence[tuple[str, str]]) -> list[str]:
    """Return the rows with their texts aligned."""
    return [f"  {name:<9} {text}" for name, text in rows]
