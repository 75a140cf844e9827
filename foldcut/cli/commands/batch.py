"""``foldcut batch``: fold many drawings, or the letters of a text, into one folder, on all cores or on a cluster."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from foldcut.cli import options
from foldcut.cli.commands import Command
from foldcut.cli.console import DONE, FAILED
from foldcut.cli.options import Machine
from foldcut.cli.outputs import Outputs
from foldcut.cli.parser import output_name
from foldcut.cli.signals import Terminated
from foldcut.core.errors import BadInputError

if TYPE_CHECKING:
    from foldcut.batch.nest import NestedBed, Nesting
    from foldcut.batch.run import Batch
    from foldcut.profiles import Profile

MOST_FAILURES = 10
"""How many failures are listed; results.csv has all."""
MOST_LETTERS = 120
"""How much of an error is printed in the list of failures."""

EXAMPLES = """\
examples:
  foldcut batch icons -o out --profile laser-dxf --effort fast
  foldcut batch 'icons/*-fill.svg' -o out --format svg,fold --sheet a5 --tolerance 1mm
  foldcut batch icons -o out --dask tcp://scheduler:8786 --parquet
  foldcut batch --text HELLO --font foldcut -o out --profile printer-a4
  foldcut batch icons -o out --sheet a6 --profile grbl-laser --nest --tabs 4x0.5mm

With --text each letter gets a sheet of its own, named after it: H, E, L and O; the report says to print L twice.
OUT gets the files of each drawing under its name, results.csv with a row for each, contact-sheet.svg, and
foldcut-batch.jsonl, a journal of what is done: after an interruption, the same command goes on from there.
"""


def add_options(command: ArgumentParser) -> None:
    """Add the drawings, the folder to write into, how to share the work, the search and the machine."""
    command.add_argument(
        "drawings",
        metavar="FOLDER|GLOB",
        nargs="*",
        help="a folder, with all its subfolders, a pattern of names, or a drawing",
    )
    add_letters(command)
    command.add_argument(
        "-o", "--output", type=output_name, metavar="OUT", required=True, help="the folder to write into"
    )
    command.add_argument(
        "--format",
        dest="formats",
        metavar="NAME,...",
        help="the formats to write (default: the profile's, or svg,fold)",
    )
    command.add_argument(
        "--nest",
        action="store_true",
        help="lay the sheets of all drawings, each as often as --copies says, on as few beds of the machine as they "
        "take: bed-1, bed-2, ... in the --format; beds.txt says what lies where, and each drawing gets a .fold",
    )
    command.add_argument("--jobs", metavar="N", type=int, help="how many processes (default: one for each core)")
    command.add_argument("--dask", metavar="ADDRESS", help="use the workers of this dask scheduler (extra: batch)")
    command.add_argument(
        "--timeout",
        dest="drawing_timeout",
        metavar="S",
        type=float,
        default=300.0,
        help="give up on a drawing after this many seconds (default: 300)",
    )
    command.add_argument("--retry", action="store_true", help="try the drawings again that failed before")
    command.add_argument("--force", action="store_true", help="start over, and replace files that exist already")
    command.add_argument("--parquet", action="store_true", help="also write results.parquet (extra: batch)")
    command.add_argument(
        "--contact-sheet", choices=("svg", "png"), default="svg", help="the page with all patterns (default: svg)"
    )
    options.add_folding(command)
    options.add_machine(command)
    options.add_console(command)


def add_letters(command: ArgumentParser) -> None:
    """Add the text and its font."""
    options.add_text(command, "fold the letters of this text instead, each once and on a sheet of its own")


def batch(args: Namespace) -> int:
    """Fold many drawings."""
    from foldcut.batch.drawings import letters_of
    from foldcut.batch.run import run_batch
    from foldcut.batch.worker import Recipe
    from foldcut.cli.progress import progress_for
    from foldcut.jobs.arrange import IN_THE_CORNER
    from foldcut.output.recipe import Recipe as FileRecipe
    from foldcut.readers.typed_text import letter_names
    from foldcut.redraw.compiling import get_ready

    if (args.text is None) == (not args.drawings):
        raise BadInputError(f"give FOLDER|GLOB or a --text{'' if args.text is None else ', not both'}")
    names = [] if args.text is None else letter_names(args.text)
    letters = [] if args.text is None else letters_of(args.text, args.font)
    console, machine, folding = options.console(args), asked_machine(args), options.folding(args)
    formats = endings(args.formats, machine.profile)
    nesting = None if not args.nest else asked_nesting(formats, machine, names)
    # with --nest copies may lie on several beds
    checked = machine if nesting is None else replace(machine, job=replace(machine.job, layout=IN_THE_CORNER))
    Outputs(tuple(Path(f"drawing{ending}") for ending in formats), "drawing", checked).check_formats(folding.paper)
    if nesting is not None:
        formats = tuple(dict.fromkeys((".fold", *(ending for ending in formats if ending not in nesting.endings))))
    out = Path(args.output)
    fold = {**vars(folding), "next_level": False}  # nobody reads what it would cost
    made = FileRecipe("make").also(*options.words(args, add_letters, text=None))
    made = made.also(*options.folding_words(args)).also(*machine.words)
    recipe = Recipe(fold, options.reading(args), formats, machine.profile, machine.job, made)
    done = ""
    with progress_for(console) as bar:

        def progress(text: str, part: float) -> None:
            nonlocal done
            done = f"{text}; "
            bar(text, part)

        try:
            if not folding.exact:
                get_ready(lambda text: progress(text, 0.0))  # once, and not in each process
            outcome = run_batch(
                args.drawings,
                out,
                recipe,
                letters=letters,
                inputs_beside=read_beside(args, machine),
                jobs=args.jobs,
                timeout=args.drawing_timeout,
                cluster=args.dask,
                replace=args.force,
                retry=args.retry,
                parquet=args.parquet,
                sheet=f".{args.contact_sheet}",
                nesting=nesting,
                progress=progress,
            )
        except (KeyboardInterrupt, Terminated) as error:
            error.add_note(f"{done}the same command again goes on from there")
            raise
    failed = failures(outcome)
    report = {
        "ok": not failed,
        "counts": outcome.counts,
        "resumed": outcome.resumed,
        "files": list(map(str, outcome.written)),
        "rows": outcome.rows,
    }
    if names:
        report["letters"] = names
    if nesting is not None:
        report["beds"] = [bed_report(bed) for bed in outcome.beds]
    console.report(report, [*lines(outcome, out), *([] if nesting else repeated(names)), *bed_lines(outcome, out)])
    return FAILED if failed else DONE


def read_beside(args: Namespace, machine: Machine) -> list[Path]:
    """Return the files that are read beside the drawings: the font, and the user's own profile."""
    from foldcut.profiles import profile_file
    from foldcut.readers.typed_text import font_file

    font = None if args.text is None else font_file(args.font)
    profile = None if machine.name is None else profile_file(machine.name)
    return [path for path in (font, profile) if path is not None]


def asked_machine(args: Namespace) -> Machine:
    """Return the machine that is named, or the obvious one for the one format of a machine among those asked for."""
    wanted = endings(args.formats, None)
    usual = options.usual_machines(args, wanted)
    return next(iter(usual.values())) if len(usual) == 1 and ".svg" not in wanted else options.machine(args)


def asked_nesting(formats: Sequence[str], machine: Machine, letters: Sequence[str]) -> Nesting:
    """Return how sheets are laid on beds together; raises what is wrong with that."""
    from foldcut.batch.nest import Nesting, check_nesting
    from foldcut.exporters import JOB_EXPORTERS

    check_nesting(machine.profile, machine.job)
    endings = tuple(ending for ending in formats if ending in JOB_EXPORTERS)
    if not endings:
        raise BadInputError(
            f"--nest writes jobs; give one of {', '.join(JOB_EXPORTERS)} with --format, or leave it out"
        )
    return Nesting(endings, Counter(letters))


def bed_report(bed: NestedBed) -> dict[str, Any]:
    """Return what a program wants to know of a bed."""
    return {
        "files": list(bed.files),
        "sheets": [asdict(sheet) for sheet in bed.sheets],
        "seconds": None if bed.seconds is None else round(bed.seconds, 1),
    }


def bed_lines(made: Batch, out: Path) -> list[str]:
    """Return a line for every bed, and where to read what to do with them."""
    from foldcut.batch.nest import BEDS
    from foldcut.jobs.duration import about

    lines = []
    for number, bed in enumerate(made.beds, 1):
        lasts = "" if bed.seconds is None else f", {about(bed.seconds)} on the machine"
        lines.append(f"  bed {number:<6} {len(bed.sheets)} sheet{'s' * (len(bed.sheets) != 1)}{lasts}")
    return [*lines, f"  next       {out / BEDS} says which sheet lies where, and what to do"] if lines else []


def repeated(letters: Sequence[str]) -> list[str]:
    """Return a line that says how often to print the letters that a text has more than once, if there are any."""
    counts = {name: count for name, count in Counter(letters).items() if count > 1}
    often = ", ".join(f"{name} {count} times" for name, count in counts.items())
    return [f"  print      {often}"] if counts else []


def endings(names: str | None, profile: Profile | None) -> tuple[str, ...]:
    """Return the endings of the formats that are asked for, each once, such as ``(".svg", ".fold")``."""
    asked = names.split(",") if names else [profile.format] if profile else ["svg", "fold"]
    return tuple(dict.fromkeys("." + name.strip().lower().removeprefix(".") for name in asked))


def failures(made: Batch) -> Sequence[dict[str, str]]:
    """Return the rows of the drawings that have no pattern."""
    from foldcut.batch.worker import MADE

    return [row for row in made.rows if row["status"] != MADE]


def lines(made: Batch, out: Path) -> list[str]:
    """Return the report as text: counts, the first failures, and what was written."""
    from foldcut.batch.results import RESULTS

    failed = failures(made)
    counts = ", ".join(f"{count} {status}" for status, count in made.counts.items())
    before = f"; {made.resumed} were done before" if made.resumed else ""
    drawings = f"{len(made.rows)} drawing{'s' * (len(made.rows) != 1)}"
    first = [
        f"  {row['status']:<10} {row['file']}: {cut_short(row['error'].removeprefix(row['file'] + ': '))}"
        for row in failed[:MOST_FAILURES]
    ]
    more = [f"  and {len(failed) - MOST_FAILURES} more, see {out / RESULTS}"] if len(failed) > MOST_FAILURES else []
    written = [f"  written    {path}" for path in made.written]
    return [f"{drawings}: {counts}{before}", *first, *more, *written]


def cut_short(text: str) -> str:
    """Return as much of a text as fits on a line."""
    return text if len(text) <= MOST_LETTERS else f"{text[:MOST_LETTERS]}..."


BATCH = Command(
    "Do what `foldcut make` does for every drawing in folders, and write everything into one folder. A drawing that "
    "fails does not end the batch, and an interrupted batch goes on where it was.",
    EXAMPLES,
    add_options,
    batch,
)
