"""Writes what docs/machines.md says of each machine, and the pictures of its layers: ``make pictures`` runs it.

Everything comes from the profiles: layers, colours, what the operator does, and the source of every number. What stands
in the page above the line ``MARK`` is written by hand and stays as it is.
"""

from __future__ import annotations

from pathlib import Path
from typing import get_args

from foldcut import fold
from foldcut.exporters.text import number
from foldcut.jobs.job import Job, make_jobs
from foldcut.profiles import Profile, Role, load_profile, profile_names
from foldcut.samples import sample_path

DOCS = Path(__file__).resolve().parent.parent
PAGE = DOCS / "machines.md"
MARK = "<!-- docs/drawings/machines.py writes what follows, from profiles/ -->"

PICTURED = {"laser": "laser-dxf", "cutter": "silhouette-cameo", "plotter": "axidraw-a4", "printer": "printer-a4"}
"""Whose layers are drawn for each kind of machine."""

KINDS = {"laser": "Lasers", "cutter": "Cutters", "plotter": "Pen plotters", "printer": "Printers"}
"""The headings of the page."""

SCALE = 0.35
"""How much smaller than the sheet a picture shows it."""


def sections() -> str:
    """Return what the page says of every machine: by kind, with the sources first that all of a kind share."""
    parts = []
    for kind, heading in KINDS.items():
        some = {name: profile for name, profile in machines().items() if profile.kind == kind}
        first, *rest = (set(profile.sources.items()) for profile in some.values())
        shared = dict(sorted(first.intersection(*rest)))
        parts += [f"## {heading}", "", *_sources(shared), *(_section(*one, shared) for one in some.items())]
    return "\n".join(parts)


def machines() -> dict[str, Profile]:
    """Return the profiles that jobs are made for, by name."""
    known = {name: load_profile(name) for name in profile_names()}
    return {name: profile for name, profile in known.items() if profile.operations}


def _sources(sources: dict[str, str]) -> list[str]:
    return [*(f"- `{key}`: {source}" for key, source in sorted(sources.items())), ""]


def _section(name: str, profile: Profile, shared: dict[str, str]) -> str:
    size = ", ".join(paper.upper() if len(paper) < 3 else paper.capitalize() for paper in profile.papers)
    if profile.bed is not None:
        size = f"{number(profile.bed.width_mm)} x {number(profile.bed.height_mm)} mm"
    first, *rest = profile.instructions
    lines = [
        f"### {profile.title}",
        "",
        f"`--profile {name}` writes {profile.format.upper()}; {'papers' if profile.papers else 'bed'}: {size}; "
        f"lines are {number(profile.line_mm)} mm wide.",
        "",
        f"1. {first}",
        "",
        "   | layer | colour | what the operator does with it |",
        "   | --- | --- | --- |",
        *(f"   | {' | '.join(row)} |" for row in _rows(profile)),
        "",
        *(f"{place}. {line}" for place, line in enumerate(rest, 2)),
        "",
        f"![layers](layers-{profile.kind}.svg)",
        "",
        *_sources({key: source for key, source in profile.sources.items() if key not in shared}),
    ]
    return "\n".join(lines)


def _rows(profile: Profile) -> list[tuple[str, str, str]]:
    crease, perforated = (profile.does[action] for action in (profile.treatment, "perforate"))
    rows = []
    for role in get_args(Role):
        operation = profile.operations[role]
        does = {"mark": profile.does["mark"], "cut": profile.does["cut"]}.get(
            role, f"{crease}; with `--treatment perforate`: {perforated}"
        )
        pen = f", pen {operation.pen}" if operation.pen is not None and profile.format in ("hpgl", "gcode") else ""
        rows.append((operation.layer, f"`{operation.colour}`{pen}", does))
    return rows


def picture(job: Job, profile: Profile) -> str:
    """Return an SVG of a job's layers, side by side."""
    width, height = (SCALE * side for side in job.size)
    step_width = width + 12
    parts = []
    for place, step in enumerate(job.steps):
        x = 6 + place * step_width
        data = " ".join(
            "M"
            + "L".join(f"{number(x + SCALE * a, 1)},{number(8 + height - SCALE * b, 1)}" for a, b in stroke.tolist())
            for stroke in step.strokes
        )
        colour = step.operation.colour
        parts += [
            f' <rect x="{number(x, 1)}" y="8" width="{number(width, 1)}" height="{number(height, 1)}" fill="#fff" '
            'stroke="#ddd" stroke-width="0.3" />',
            f' <path d="{data}" fill="none" stroke="{colour}" stroke-width="0.6" />',
            f' <text x="{number(x, 1)}" y="5" font-family="sans-serif" font-size="4" fill="#666">'
            f"{step.operation.layer}</text>",
        ]
    wide, high = len(job.steps) * step_width, height + 14
    head = (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {number(wide)} {number(high)}" '
        f'width="{3 * wide:.0f}" height="{3 * high:.0f}">'
    )
    return "\n".join([head, *parts, "</svg>", ""])


def main() -> None:
    """Write the page and the pictures."""
    pattern = fold(sample_path("star"), "148x105mm", effort="fast").require_verified()
    for kind, name in PICTURED.items():
        profile = load_profile(name)
        (job,) = make_jobs(pattern, profile, marks=("outline",))
        (DOCS / f"layers-{kind}.svg").write_text(picture(job, profile), "utf-8")
    by_hand = PAGE.read_text("utf-8").partition(MARK)[0]
    PAGE.write_text(f"{by_hand}{MARK}\n\n{sections()}", "utf-8")


if __name__ == "__main__":
    main()
