"""``foldcut coupon``: a test card of scores and perforations for a machine."""

from __future__ import annotations

import os
from argparse import ArgumentParser, Namespace
from pathlib import Path
from typing import TYPE_CHECKING

from foldcut.cli import options
from foldcut.cli.commands import Command
from foldcut.cli.console import DONE
from foldcut.cli.outputs import is_bundle
from foldcut.cli.parser import output_name
from foldcut.core.errors import BadInputError

if TYPE_CHECKING:
    from foldcut.profiles import Profile

EXAMPLES = """\
examples:
  foldcut coupon --profile grbl-laser
  foldcut coupon --profile laser-dxf --material card-300g -o card.dxf
  foldcut coupon --profile cricut-maker -o card.zip
"""


def add_options(command: ArgumentParser) -> None:
    """Add the machine, the material and the output."""
    add_card(command)
    command.add_argument(
        "-o",
        "--output",
        type=output_name,
        metavar="FILE",
        help="a file, or a .zip for it and a README.txt (default: coupon-PROFILE in the machine's format)",
    )
    options.add_force(command)
    options.add_console(command)


def add_card(command: ArgumentParser) -> None:
    """Add the machine and the material."""
    command.add_argument("--profile", metavar="NAME", required=True, help="the machine; see foldcut profiles")
    command.add_argument("--material", metavar="NAME", help="what the card is made of (default: the profile's first)")
    command.add_argument("--set", metavar="KEY=VALUE", action="append", default=[], help="change a value (repeatable)")


def coupon(args: Namespace) -> int:
    """Write a machine's test card."""
    from foldcut.exporters import export_job
    from foldcut.exporters.bundle import README, card_readme, zipped
    from foldcut.jobs.coupon import make_coupon
    from foldcut.jobs.duration import about, seconds_of_steps
    from foldcut.jobs.instructions import instructions
    from foldcut.output.atomic import Inputs, check_targets, write_files
    from foldcut.output.recipe import Recipe
    from foldcut.output.render import job_files
    from foldcut.profiles import load_profile, profile_file

    profile = load_profile(args.profile, args.set)
    path = Path(args.output or f"coupon-{Path(args.profile).stem}.{profile.format}")
    if path.is_dir() or (args.output or "").endswith(("/", os.sep)):
        raise BadInputError(f"{args.output} is a folder; give a file in it, or a .zip")
    inputs = Inputs([profile_file(args.profile)])
    check_targets(targets(path, profile), replace=args.force, inputs=inputs)
    job, rows = make_coupon(profile, args.material)
    recipe = Recipe(args.command).also(*options.words(args, add_card))
    card = path.with_suffix(f".{profile.format}") if is_bundle(path) else path
    following = instructions(profile, [job], [card.suffix.lower()[1:]])
    contents = {
        name: recipe.put_into(export_job(part, name.suffix, profile), card.name, name.name)
        for name, part in job_files(job, card, profile).items()
    }
    if is_bundle(path):
        parts = {name.name: data for name, data in contents.items()}
        text = card_readme(job.title, list(parts), rows, following, recipe.lines())
        contents = {path: recipe.put_into(zipped({README: text} | parts), path.name, path.name)}
    files = [{"path": str(name), "bytes": len(data), "replaced": name.exists()} for name, data in contents.items()]
    write_files(contents, replace=args.force, inputs=inputs)
    lines = [job.title, *(f"  {row}" for row in rows)]
    seconds = seconds_of_steps(job, profile)
    lines += [] if seconds is None else [f"  time      {about(sum(seconds))} on the machine"]
    lines += [f"  written   {file['path']} ({file['bytes']:,} bytes)" for file in files]
    lines += [f"  next      {line}" for line in following]
    lasts = None if seconds is None else round(sum(seconds), 1)
    report = {"ok": True, "title": job.title, "rows": rows, "seconds": lasts, "files": files, "next": following}
    options.console(args).report(report, lines)
    return DONE


def targets(path: Path, profile: Profile) -> list[Path]:
    """Return the files that are written for an output."""
    from foldcut.output.render import JobOptions

    return [path] if is_bundle(path) else JobOptions().targets(path, profile)


COUPON = Command(
    "Write a test card: strips to fold, scored and perforated in many settings. The ticks beside a "
    "row tell its number.",
    EXAMPLES,
    add_options,
    coupon,
)
