"""``foldcut profiles``: list, show and validate what foldcut knows about machines."""

from __future__ import annotations

import json
from argparse import ArgumentParser, Namespace
from typing import TYPE_CHECKING

from foldcut.cli.commands import Command
from foldcut.cli.console import DONE, Console, print_error
from foldcut.core.errors import BadInputError

if TYPE_CHECKING:
    from foldcut.profiles import Profile

EXAMPLES = """\
examples:
  foldcut profiles
  foldcut profiles list grbl
  foldcut profiles show glowforge
  foldcut profiles validate my-laser.toml
"""


def add_options(command: ArgumentParser) -> None:
    """Add what to do, and with which profile."""
    command.add_argument("action", nargs="?", choices=("list", "show", "validate"), default="list")
    command.add_argument(
        "name",
        nargs="?",
        metavar="PROFILE",
        help="a name, or the path of a TOML file; for list: a part of names or titles",
    )
    command.add_argument("--set", metavar="KEY=VALUE", action="append", default=[], help="change a value (repeatable)")
    command.add_argument("--json", action="store_true", help="print JSON, for programs")


def profiles(args: Namespace) -> int:
    """List, show or validate profiles."""
    from foldcut.profiles import load_profile

    console = Console(args.json)
    if args.action == "list":
        return list_profiles(console, args.name or "")
    if not args.name:
        raise BadInputError(f"foldcut profiles {args.action} needs the name of a profile or the path of a TOML file")
    profile = load_profile(args.name, args.set)
    if args.action == "show":
        shown = profile.model_dump(exclude_none=True)
        console.report({"ok": True, "profile": shown}, json.dumps(shown, indent=2, ensure_ascii=False).split("\n"))
    else:
        console.report({"ok": True, "profile": args.name}, [f"{args.name}: valid"])
    return DONE


def list_profiles(console: Console, word: str) -> int:
    """Print profiles that have ``word`` in name or title: both, the format, the size of the bed or of the papers."""
    from foldcut.profiles import known_profiles

    known, broken = known_profiles()
    known = {name: p for name, p in known.items() if word.lower() in f"{name} {p.title}".lower()}
    if not known:
        raise BadInputError(f"no profile has {word!r} in its name or title; foldcut profiles lists all")
    rows = [(name, p.format, bed_size(p), p.title, unverified(p)) for name, p in known.items()]
    wide, bed = (max(len(row[column]) for row in rows) for column in (0, 2))
    lines = [f"{n:<{wide}}  {form:<5}  {size:<{bed}}  {title}{doubt}" for n, form, size, title, doubt in rows]
    listed = [
        {
            "name": name,
            "title": p.title,
            "format": p.format,
            "kind": p.kind,
            "bed_mm": None if p.bed is None else [p.bed.width_mm, p.bed.height_mm],
            "papers": list(p.papers),
            "unverified": list(p.unverified),
            "sources": p.sources,
        }
        for name, p in known.items()
    ]
    about = (
        "Unverified numbers were not compared with what the maker says; foldcut profiles show NAME has every source."
    )
    for message in broken.values():
        print_error(f"left out: {message}")
    console.report({"ok": True, "profiles": listed, "broken": broken}, [*lines, "", about])
    return DONE


def bed_size(profile: Profile) -> str:
    """Return the size of a machine's bed, or the papers that it takes."""
    if profile.bed is None:
        return ", ".join(profile.papers)
    return f"{profile.bed.width_mm:g} x {profile.bed.height_mm:g} mm"


def unverified(profile: Profile) -> str:
    """Return which numbers of a profile are unverified, in words."""
    return f" ({', '.join(profile.unverified)}: unverified)" if profile.unverified else ""


PROFILES = Command(
    "List, show and validate profiles: what foldcut knows about machines. Put your own into "
    "~/.config/foldcut/profiles, or anywhere else: --profile also takes a path that ends in .toml.",
    EXAMPLES,
    add_options,
    profiles,
)
