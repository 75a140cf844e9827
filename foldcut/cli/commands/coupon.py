"""``foldcut coupon``: a test card of scores and perforations for a machine."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from pathlib import Path

from foldcut.cli import options
from foldcut.cli.commands import Command
from foldcut.cli.console import DONE

EXAMPLES = """\
examples:
  foldcut coupon --profile grbl-laser
  foldcut coupon --profile laser-dxf --material card-300g -o card.dxf
"""


def add_options(command: ArgumentParser) -> None:
    """Add the machine, the material and the output."""
    command.add_argument("--profile", metavar="NAME", required=True, help="the machine; see foldcut profiles")
    command.add_argument("--material", metavar="NAME", help="what the card is made of (default: the profile's first)")
    command.add_argument("--set", metavar="KEY=VALUE", action="append", default=[], help="change a value (repeatable)")
    command.add_argument("-o", "--output", metavar="FILE", help="(default: coupon-PROFILE in the machine's format)")
    options.add_force(command)
    options.add_console(command)


def coupon(args: Namespace) -> int:
    """Write a machine's test card."""
    from foldcut.exporters import export_job
    from foldcut.jobs.coupon import make_coupon
    from foldcut.jobs.instructions import instructions
    from foldcut.output.atomic import Inputs, check_targets, write_files
    from foldcut.output.render import JobOptions, job_files
    from foldcut.profiles import load_profile, profile_file

    profile = load_profile(args.profile, args.set)
    path = Path(args.output or f"coupon-{Path(args.profile).stem}.{profile.format}")
    inputs = Inputs([profile_file(args.profile)])
    check_targets(JobOptions().targets(path, profile), replace=args.force, inputs=inputs)
    job, rows = make_coupon(profile, args.material)
    parts = job_files(job, path, profile)
    contents = {name: export_job(part, path.suffix, profile) for name, part in parts.items()}
    files = [{"path": str(name), "bytes": len(data), "replaced": name.exists()} for name, data in contents.items()]
    write_files(contents, replace=args.force, inputs=inputs)
    following = instructions(profile, [job])
    lines = [job.title, *(f"  {row}" for row in rows)]
    lines += [f"  written   {file['path']} ({file['bytes']:,} bytes)" for file in files]
    lines += [f"  next      {line}" for line in following]
    report = {"ok": True, "title": job.title, "rows": rows, "files": files, "next": following}
    options.console(args).report(report, lines)
    return DONE


COUPON = Command(
    "Write a test card: strips to fold, scored and perforated in many settings. The ticks beside a "
    "row tell its number.",
    EXAMPLES,
    add_options,
    coupon,
)
