"""The command line: ``foldcut make`` and the other commands of ``foldcut --help``.

Only this module prints: reports on stdout, progress and one-line errors on stderr. It exits with 0 when the
pattern was made and verified, 1 when there is none or it is not verified, 2 when the input is at fault, 130
and 143 when it was interrupted or terminated. Everything slow to import is imported inside the commands.
"""

from __future__ import annotations

import argparse
import atexit
import gc
import io
import json
import os
import signal
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING, Any, NoReturn

from foldcut.core.errors import BadInputError, FileFormatError, FoldcutError, ShapeError, UnfoldableError
from foldcut.methods import ADJUST_MM, CHOICES, DEFAULT_METHOD, EFFORTS, METHODS

if TYPE_CHECKING:
    from foldcut.core.model import Finding, FoldedPattern
    from foldcut.foldfile.reopen import Reopened
    from foldcut.jobs.bed import Side
    from foldcut.jobs.job import Job
    from foldcut.output.render import JobOptions
    from foldcut.pipeline import Result
    from foldcut.profiles import Profile
    from foldcut.readers import Drawing, ReadOptions

DONE, FAILED, BAD_INPUT = 0, 1, 2
FOLD, CREASES = ".fold", "-creases"  # the ending of patterns, and what stands before it in names made here
ANY_LASER = "laser-dxf"  # whom a DXF is for when nobody is named
MOST_FAILURES, MOST_LETTERS = 10, 120  # of a batch: how many are listed, and how much of each error
GARBAGE = 50_000  # so many new objects before garbage is looked for; Python does so after 700
INTERRUPTED, TERMINATED = 128 + signal.SIGINT, 128 + signal.SIGTERM

EPILOG = """\
examples:
  foldcut make fish                        the sample "fish" on A4, as fish-creases.svg and fish-creases.fold
  foldcut make logo.svg -o logo.fold       your own drawing
  foldcut make fish --profile glowforge    the job for a machine, in its format
  foldcut view fish                        a page to fold and cut it on the screen
  foldcut batch icons -o out               every drawing in a folder, on all cores
  foldcut profiles                         the machines that foldcut knows
  foldcut check logo.fold                  does this pattern fold flat?
  foldcut COMMAND --help                   all options of a command, with examples

exit status: 0 done and verified, 1 not foldable or not verified, 2 bad input
"""

MAKE_EPILOG = """\
examples:
  foldcut make fish -o fish.svg -o fish.fold
  foldcut make logo.svg --sheet letter --margin 15mm
  foldcut make logo.svg --layer Cut --flatten 0.2mm
  foldcut make part.dxf --layer OUTLINE --join 0.2mm
  cat fish.svg | foldcut make - --from svg -o fish.fold
  foldcut make --text A --font MyFont.ttf
  foldcut make photo.png --threshold 0.4 --simplify 1mm
  foldcut make star.json --sheet 200x200mm --scale 1:2 --offset 30,40 --rotate 45
  foldcut make logo.svg --width 80mm --sheet 100x150mm
  foldcut make fish -o fish.fold --json > report.json
  foldcut make swan --effort best --seconds 60
  foldcut make map.svg --sheet a3 --simplify 0.5mm --min-crease 2mm
  foldcut make fish --method paper --ribbon 0.4mm
  foldcut make fish --profile laser-dxf --material card-160g --treatment perforate
  foldcut make swan --sheet a2 --profile printer-a4 --tile
  foldcut make fish --profile laser-dxf --two-sided --registration pins -o fish.zip
  foldcut make fish --profile axidraw-a4 --marks outline,numbers,title
  foldcut make fish --profile grbl-laser --two-sided --set bed.width_mm=300

Without -o it writes NAME-creases.svg and, unless SHAPE is a .fold, NAME-creases.fold into the current folder, or with
--profile NAME-PROFILE with the ending of the machine's format.
Existing files are replaced only with --force. Ctrl-C during the search goes on with the best pattern found so far.
"""

VIEW_EPILOG = """\
examples:
  foldcut view fish                        fish.html; open it in a browser
  foldcut view logo.svg --sheet a5 -o out/logo.html
  foldcut view logo.fold                   a pattern that foldcut made before
"""

DRAW_EPILOG = """\
examples:
  foldcut draw fish                        fish-pictures.svg
  foldcut draw triangle --method paper --show packing,molecules,trees,ribbon --ribbon 1mm
  foldcut draw logo.svg --show folded,layers -o folded.png
"""

GUIDE_EPILOG = """\
examples:
  foldcut guide letter-a                   letter-a-guide.pdf
  foldcut guide logo.svg -o logo.html
"""

BATCH_EPILOG = """\
examples:
  foldcut batch icons -o out --profile laser-dxf --effort fast
  foldcut batch 'icons/*-fill.svg' -o out --format svg,fold --sheet a5 --simplify 0.3mm
  foldcut batch icons -o out --dask tcp://scheduler:8786 --parquet

OUT gets the files of each drawing under its name, results.csv with a row for each, contact-sheet.svg, and
foldcut-batch.jsonl, where what is done is written down: the same command again goes on after an interruption.
"""

SERVE_EPILOG = """\
examples:
  foldcut serve                            then open the address that it prints
  foldcut serve --port 9000
"""

CHECK_EPILOG = """\
examples:
  foldcut check fish.fold
  foldcut check fish.fold --shape fish     also check that the cut gives this shape
  foldcut check fish.fold --json
"""

COUPON_EPILOG = """\
examples:
  foldcut coupon --profile grbl-laser
  foldcut coupon --profile laser-dxf --material card-300g -o card.dxf
"""

PROFILES_EPILOG = """\
examples:
  foldcut profiles
  foldcut profiles show glowforge
  foldcut profiles validate my-laser.toml
"""

SAMPLES_EPILOG = """\
examples:
  foldcut samples
  foldcut make "$(foldcut samples | head -n 1)"
"""


class _Terminated(BaseException):
    """SIGTERM came: unwind, so that temporary files are removed."""


class _TimedOut(BaseException):
    """--timeout has passed: unwind, past all that would go on with the best found so far."""


class _Parser(argparse.ArgumentParser):
    """A parser that raises where argparse would print its usage and exit; ``commands`` are the names it has."""

    commands: tuple[str, ...] = ()

    def error(self, message: str) -> NoReturn:
        raise BadInputError(f"{message}; see {self.prog} --help")


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command and return its exit status; ``argv`` is ``sys.argv[1:]`` unless given."""
    argv = list(sys.argv[1:] if argv is None else argv)
    as_json = "--json" in argv
    _start_fast()
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")  # a title that the terminal has no letters for
    try:
        with _signals_raise():
            args = _parsed(argv)
            with _time_limit(getattr(args, "timeout", None)):
                status: int = args.run(args)
            sys.stdout.flush()
            return status
    except FoldcutError as error:
        return _fail(error, str(error), FAILED if isinstance(error, UnfoldableError) else BAD_INPUT, as_json)
    except BrokenPipeError:
        # Nobody reads on; what is still buffered must not fail again at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return FAILED
    except OSError as error:
        where = f"{error.filename}: " if error.filename else ""
        return _fail(error, f"{where}{error.strerror or error}", BAD_INPUT, as_json)
    except KeyboardInterrupt as error:
        return _fail(error, f"interrupted; {_notes(error)}no file is half-written", INTERRUPTED, as_json)
    except _TimedOut as error:
        remedy = "allow more with --timeout, or search less with --effort fast or --seconds"
        return _fail(error, f"timed out after {args.timeout:g} s, no file is half-written; {remedy}", FAILED, as_json)
    except _Terminated as error:
        return _fail(error, f"terminated; {_notes(error)}no file is half-written", TERMINATED, as_json)


def _parsed(argv: Sequence[str]) -> argparse.Namespace:
    """Return what the arguments say; raises BadInputError for what no option is, with the nearest that is."""
    parser = _parser()
    if argv and argv[0][:1] != "-" and argv[0] not in parser.commands:
        of_all = f"choose one of {', '.join(parser.commands)}, such as foldcut make {argv[0]}"
        raise BadInputError(f"there is no command {argv[0]!r}; {_nearest(argv[0], parser.commands) or of_all}")
    args, unknown = parser.parse_known_args(_with_joined_values(argv))
    if unknown:
        command: argparse.ArgumentParser = args.parser
        known = [option for action in command._actions for option in action.option_strings]
        nearest = _nearest(unknown[0].partition("=")[0], known) if unknown[0].startswith("--") else ""
        remedy = nearest or f"see {command.prog} --help"
        if args.command == "make" and unknown[0][:1] != "-":
            remedy = "give one drawing, or all to foldcut batch"
        raise BadInputError(f"unrecognized arguments: {' '.join(unknown)}; {remedy}")
    return args


def _nearest(name: str, known: Sequence[str], what: str = "") -> str:
    """Return a question after the known name that is most like this one; an empty text if none is."""
    from difflib import get_close_matches

    return "".join(f"did you mean {what}{match}?" for match in get_close_matches(name, known, n=1))


def _start_fast() -> None:
    """Leave out what takes long and is not needed; nothing is imported yet that asks."""
    # matrices are small: threads for them cost more than they save
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    # what is imported stays: no looking for garbage in it again and again, nor at the end
    gc.set_threshold(GARBAGE)
    atexit.register(gc.freeze)


def _notes(error: BaseException) -> str:
    """Return what was noted about an interruption on its way."""
    return "".join(f"{note}; " for note in getattr(error, "__notes__", ()))


def _make(args: argparse.Namespace) -> int:
    """Fold a shape and write the files."""
    from foldcut.drawing.mend import preview
    from foldcut.foldfile.reopen import Reopened
    from foldcut.output.atomic import check_targets
    from foldcut.profiles import load_profile

    source = _source(args)
    if args.profile is None and args.output and all(Path(out).suffix.lower() == ".dxf" for out in args.output):
        args.profile = ANY_LASER
    profile = None if args.profile is None else load_profile(args.profile, args.set)
    names = [f"{_stem(source)}.html"] if args.command == "view" else _default_outputs(source, args.profile, profile)
    for out in args.output or ():
        if out.endswith(("/", os.sep)) and not Path(out).is_dir():
            raise BadInputError(f"cannot write into {out}: there is no such folder; create it first")
    outputs = [Path(out) for out in args.output or names]
    _check_machine(args, profile, outputs)
    for path in outputs:
        if path.is_file() and source.is_file() and path.samefile(source):
            raise BadInputError(f"{path} is the drawing itself; give the output another name")
    stem = _stem(source)
    targets = [target for path in outputs for target in _targets(path, stem, profile, args)]
    if args.preview:
        if Path(args.preview).suffix.lower() != ".svg":
            raise BadInputError(f"{args.preview}: a preview is SVG; give a name that ends in .svg")
        targets.append(Path(args.preview))
    check_targets(targets, replace=args.force)

    result = _folded(source, args)
    contents: dict[Path, bytes] = {}
    jobs: list[Job] = []
    if result.verified:
        contents, jobs = _contents(result.folded_pattern, outputs, stem, profile, args)
        if args.preview and not isinstance(result, Reopened) and result.prepared is not None:
            contents[Path(args.preview)] = preview(result.prepared.drawn, result.prepared.loops)
    return _write_and_report(result, contents, args, jobs, profile)


def _folded(source: Path, args: argparse.Namespace) -> Result | Reopened:
    """Fold the drawing as the options say, or open a pattern that is folded already."""
    if source.suffix.lower() == FOLD and args.text is None:
        return _reopened(source, args)
    from foldcut import pipeline
    from foldcut.cli.progress import ProgressBar, progress_lines

    with ProgressBar(sys.stderr.isatty() and not (args.quiet or args.json)) as bar:
        progress = progress_lines(sys.stderr) if args.progress else bar
        drawing = _drawing(args, source)
        try:
            return pipeline.fold(drawing, **_fold_options(args), progress=progress)
        except ShapeError as error:
            if args.text is not None:
                raise
            raise ShapeError(f"{source}: {error}") from error


def _fold_options(args: argparse.Namespace) -> dict[str, Any]:
    """Return what the options say of laying and folding a drawing: keyword arguments of ``pipeline.fold``."""
    from foldcut.drawing.mend import Preparation
    from foldcut.drawing.placement import parse_length, parse_sheet

    return {
        "sheet": parse_sheet(args.sheet),
        "margin": parse_length(args.margin),
        "scale": _scale(args),
        "offset": _parse_offset(args.offset),
        "rotation": _parse_rotation(args.rotate),
        "width": None if args.width is None else parse_length(args.width),
        "height": None if args.height is None else parse_length(args.height),
        "method": args.method,
        "ribbon": None if args.ribbon is None else parse_length(args.ribbon),
        "min_crease": None if args.min_crease is None else parse_length(args.min_crease),
        "simplify": parse_length(args.simplify),
        "symmetry": parse_length(args.symmetry),
        "adjust": parse_length(args.adjust),
        "effort": args.effort,
        "seconds": args.seconds,
        "preparation": Preparation(
            corners=args.corners,
            min_feature=parse_length(args.min_feature),
            separate=parse_length(args.separate),
            mirror=args.mirror,
            strict=args.strict,
        ),
    }


def _reopened(source: Path, args: argparse.Namespace) -> Reopened:
    """Open a FOLD file of foldcut's; options that say how to read, lay and fold a drawing are errors."""
    from foldcut.foldfile.read import read_fold
    from foldcut.foldfile.reopen import reopen

    of_drawings = _Parser(add_help=False)
    _add_options_of_fold(of_drawings)
    of_drawings.add_argument("--preview")
    options = [
        action for action in of_drawings._actions if action.dest not in ("shape", "force", "timeout", "progress")
    ]
    given = [option.option_strings[-1] for option in options if getattr(args, option.dest, None) != option.default]
    if given:
        raise BadInputError(f"{', '.join(given)}: for drawings; {source} has its sheet and creases already")
    try:
        return reopen(read_fold(source))
    except FileFormatError:
        raise
    except BadInputError as error:
        raise BadInputError(f"{source}: {error}") from None


def _draw(args: argparse.Namespace) -> int:
    """Fold a shape and draw pictures of it."""
    from foldcut.exporters.pattern.png import rendered
    from foldcut.exporters.pictures import pictures
    from foldcut.methods.disks.method import DiskStages
    from foldcut.pipeline import Result
    from foldcut.profiles import load_profile

    source = _source(args)
    output = Path(args.output or f"{_stem(source)}-pictures.svg")
    if output.suffix.lower() not in (".svg", ".png"):
        raise BadInputError(f"{output}: pictures are SVG or PNG; give a name that ends in .svg or .png")
    show = tuple(name.strip() for name in args.show.split(","))
    pictures.check(show, construction=args.method in METHODS and METHODS[args.method].construction)

    def drawn(result: Result | Reopened) -> bytes:
        stages = result.stages if isinstance(result, Result) and isinstance(result.stages, DiskStages) else None
        svg, size = pictures.draw(result.folded_pattern, show, load_profile(), stages)
        return svg if output.suffix.lower() == ".svg" else rendered(svg, size)

    return _fold_and_write(source, output, drawn, args)


def _guide(args: argparse.Namespace) -> int:
    """Fold a shape and write how a person folds it."""
    from foldcut.exporters.pictures.guide import GUIDES

    source = _source(args)
    output = Path(args.output or f"{_stem(source)}-guide.pdf")
    if output.suffix.lower() not in GUIDES:
        raise BadInputError(f"{output}: guides are PDF or HTML; give a name that ends in {' or '.join(GUIDES)}")
    guide = GUIDES[output.suffix.lower()]
    return _fold_and_write(source, output, lambda result: guide(result.folded_pattern), args)


def _fold_and_write(
    source: Path, output: Path, content: Callable[[Result | Reopened], bytes], args: argparse.Namespace
) -> int:
    """Fold a shape and write one file about it."""
    from foldcut.output.atomic import check_targets

    check_targets([output], replace=args.force)
    result = _folded(source, args)
    return _write_and_report(result, {output: content(result)} if result.verified else {}, args)


def _write_and_report(
    result: Result | Reopened,
    contents: dict[Path, bytes],
    args: argparse.Namespace,
    jobs: Sequence[Job] = (),
    profile: Profile | None = None,
) -> int:
    """Write the files of a verified result and print its report."""
    from foldcut.cli import report
    from foldcut.foldfile.reopen import Reopened
    from foldcut.output.atomic import write_files

    files = [{"path": str(p), "bytes": len(data), "replaced": p.exists()} for p, data in contents.items()]
    write_files(contents, replace=args.force)
    if isinstance(result, Reopened):
        made = report.reopened_report(result, files, jobs, profile)
        return _finish(made, report.reopened_lines(made), result.findings, "nothing is written", args)
    made = report.make_report(result, files, jobs, profile, getattr(args, "material", None))
    return _finish(made, report.make_lines(made), result.findings, "nothing is written", args)


def _batch(args: argparse.Namespace) -> int:
    """Fold many drawings."""
    from foldcut.batch.results import RESULTS
    from foldcut.batch.run import run_batch
    from foldcut.batch.worker import MADE, Recipe
    from foldcut.cli.progress import ProgressBar
    from foldcut.profiles import load_profile

    profile = None if args.profile is None else load_profile(args.profile, args.set)
    names = args.formats.split(",") if args.formats else [profile.format] if profile else ["svg", "fold"]
    endings = tuple(dict.fromkeys("." + name.strip().lower().removeprefix(".") for name in names))
    _check_machine(args, profile, [Path(f"drawing{ending}") for ending in endings])
    out = Path(args.output)
    recipe = Recipe(_fold_options(args), _read_options(args), endings, profile, _job_options(args))
    done = ""
    with ProgressBar(sys.stderr.isatty() and not (args.quiet or args.json)) as bar:

        def progress(text: str, part: float) -> None:
            nonlocal done
            done = f"{text}; "
            bar(text, part)

        try:
            batch = run_batch(
                args.drawings,
                out,
                recipe,
                jobs=args.jobs,
                timeout=args.file_timeout,
                cluster=args.dask,
                replace=args.force,
                retry=args.retry,
                parquet=args.parquet,
                sheet=f".{args.contact_sheet}",
                progress=progress,
            )
        except (KeyboardInterrupt, _Terminated) as error:
            error.add_note(f"{done}the same command again goes on from there")
            raise
    failed = [row for row in batch.rows if row["status"] != MADE]
    counts = ", ".join(f"{count} {status}" for status, count in batch.counts.items())
    before = f"; {batch.resumed} were done before" if batch.resumed else ""
    lines = [f"{len(batch.rows)} drawing{'s' * (len(batch.rows) != 1)}: {counts}{before}"]
    lines += [
        f"  {row['status']:<10} {row['file']}: {_cut_short(row['error'].removeprefix(row['file'] + ': '))}"
        for row in failed[:MOST_FAILURES]
    ]
    lines += [f"  and {len(failed) - MOST_FAILURES} more, see {out / RESULTS}"] if len(failed) > MOST_FAILURES else []
    lines += [f"  written    {path}" for path in batch.written]
    if args.json or not args.quiet:
        files = list(map(str, batch.written))
        report = {"ok": not failed, "counts": batch.counts, "resumed": batch.resumed, "files": files}
        _print_report(report | {"rows": batch.rows}, lines, args.json)
    return FAILED if failed else DONE


def _cut_short(text: str) -> str:
    """Return as much of a text as fits on a line."""
    return text if len(text) <= MOST_LETTERS else f"{text[:MOST_LETTERS]}..."


def _serve(args: argparse.Namespace) -> int:
    """Serve the web page until Ctrl-C."""
    import socket

    try:
        import uvicorn

        from foldcut.web.app import Settings, make_app
    except ModuleNotFoundError as error:
        raise BadInputError(f"serve needs the extra 'serve' ({error.name}): pip install 'foldcut[serve]'") from None
    if not 0 < args.port < 65536:
        raise BadInputError(f"--port {args.port} is none; give one from 1 to 65535")
    if not 0 < args.job_seconds < 1e8:
        raise BadInputError(f"--job-seconds is {args.job_seconds:g}; give a positive number below 1e8")
    name = f"[{args.host}]" if ":" in args.host else args.host
    own = Settings().hosts
    everywhere = args.host in ("0.0.0.0", "::")
    settings = Settings(job_seconds=args.job_seconds, hosts=("*",) if everywhere else (*own, name))
    config = uvicorn.Config(make_app(settings), log_level="warning", server_header=False, limit_concurrency=200)
    family = socket.AF_INET6 if ":" in args.host else socket.AF_INET
    try:
        listening = socket.create_server((args.host, args.port), family=family)
    except OSError as error:
        what = (error.strerror or str(error)).partition(" (while")[0]
        raise BadInputError(f"cannot listen at {name}:{args.port}: {what}; give another --port or --host") from None
    with listening:
        print(f"http://{name}:{args.port}/ until Ctrl-C; nothing is kept afterwards", flush=True)
        if name not in own:
            print("everyone who reaches this address can use it, and there is no password", file=sys.stderr)
        with suppress(KeyboardInterrupt):
            uvicorn.Server(config).run(sockets=[listening])
    return DONE


def _check(args: argparse.Namespace) -> int:
    """Verify a FOLD file."""
    from foldcut.cli import report
    from foldcut.drawing.shape import make_shape
    from foldcut.foldfile.read import read_fold
    from foldcut.proof.verify import verify

    read = read_fold(Path(args.file))
    shape, notes = None, read.notes
    if args.shape:
        drawing = _drawing(args, _source(args))
        notes += drawing.repairs
        if read.placement is not None:
            loops = [read.placement.apply(loop) for loop in drawing.own_coordinates()]
        else:
            loops = [loop * (drawing.unit_mm or 1.0) for loop in drawing.loops]
            notes += ("foldcut:placement is missing: the drawing is taken to lie on the sheet as drawn, in mm, y up",)
        shape = make_shape(loops)
    findings = verify(read.pattern, read.layers, shape)
    checked = report.check_report(read.pattern, findings, shape is not None, notes)
    remedy = "mend the pattern" + (", or give the drawing it was made from" if args.shape else "")
    return _finish(checked, report.check_lines(checked), findings, remedy, args)


def _samples(args: argparse.Namespace) -> int:
    """List the samples."""
    from foldcut.samples import sample_names

    names = sample_names()
    _print_report({"ok": True, "samples": list(names)}, names, args.json)
    return DONE


def _source(args: argparse.Namespace) -> Path:
    """Return the path of the drawing, that of standard input, or for a text a name that no file has to have."""
    text = getattr(args, "text", None)
    if (text is None) == (not args.shape):
        raise BadInputError(f"give a SHAPE or a --text, {'one of them' if text is None else 'not both'}")
    if text is not None:
        return Path("".join(letter for letter in text if letter.isalnum())[:40] or "text")
    return Path(args.shape) if args.shape == "-" else _shape_path(args.shape)


def _drawing(args: argparse.Namespace, source: Path) -> Drawing:
    """Return what the drawing's file, or the text, shows."""
    if getattr(args, "text", None) is None:
        from foldcut.readers import read_shape

        return read_shape(source, _read_options(args))
    from foldcut.readers.typed_text import draw_text

    return draw_text(args.text, args.font, _read_options(args))


def _stem(source: Path) -> str:
    """Return what files are called after a drawing, or after a pattern that ``foldcut make`` named after one."""
    stem = source.stem.removesuffix(CREASES) if source.suffix.lower() == FOLD else source.stem
    return "drawing" if str(source) == "-" else stem or source.stem


def _read_options(args: argparse.Namespace) -> ReadOptions:
    """Return what the reader is told."""
    from foldcut.drawing.limits import parse_limits
    from foldcut.drawing.placement import parse_length
    from foldcut.readers import ReadOptions

    return ReadOptions(
        flatten_mm=parse_length(args.flatten),
        join_mm=parse_length(args.join),
        layers=tuple(args.layer),
        ids=tuple(args.id),
        suffix=args.format or "",
        threshold=args.threshold,
        limits=parse_limits(args.limit),
    )


def _shape_path(name: str) -> Path:
    """Return the path of a drawing, given as a path or as the name of a sample."""
    from foldcut.samples import sample_names, sample_path

    path = Path(name)
    if path.is_file():
        return path
    if name in sample_names():
        return sample_path(name)
    if path.is_dir():
        raise BadInputError(f"{name}: is a folder; give a drawing, or all in it to foldcut batch")
    remedy = "give a drawing or one of the samples, which foldcut samples lists"
    raise BadInputError(f"{name}: there is no such file; {_nearest(name, sample_names(), 'the sample ') or remedy}")


def _contents(
    pattern: FoldedPattern, outputs: Sequence[Path], stem: str, profile: Profile | None, args: argparse.Namespace
) -> tuple[dict[Path, bytes], list[Job]]:
    """Return what goes into the files, and the jobs among it; ``stem``: what files in a folder are called."""
    from foldcut.exporters.bundle import README, readme, zipped
    from foldcut.output.render import Maker

    maker = Maker(pattern, profile, _job_options(args))
    contents: dict[Path, bytes] = {}
    for path in outputs:
        if not _is_bundle(path):
            contents |= maker.files(path)
            continue
        members: dict[str, bytes] = {}
        sides: dict[str, Job | None] = {}
        for member in map(Path, _members(path, stem, profile)):
            members |= {str(name): data for name, data in maker.files(member).items()}
            sides |= {str(name): maker.jobs.get(side) for side, name in _sides(member, args).items()}
        every = {README: readme(pattern, sides, profile)} | members
        contents |= {path / name: data for name, data in every.items()} if path.is_dir() else {path: zipped(every)}
    return contents, list(maker.jobs.values())


def _job_options(args: argparse.Namespace) -> JobOptions:
    """Return how jobs are made."""
    from foldcut.output.render import JobOptions

    return JobOptions(
        material=args.material,
        treatment=args.treatment,
        two_sided=args.two_sided,
        registration=args.registration or "corners",
        marks=_marks(args.marks),
        tile=args.tile,
    )


def _is_bundle(path: Path) -> bool:
    """Whether several files go into this: a folder that is there, or a zip archive."""
    return path.is_dir() or path.suffix.lower() == ".zip"


def _members(path: Path, stem: str, profile: Profile | None) -> list[str]:
    """Return the names of what goes into a folder or an archive, but for sides and the README."""
    stem = stem if path.is_dir() else path.stem
    endings = ["svg", "fold", "png"] if profile is None else [profile.format]
    return [f"{stem}.{ending}" for ending in endings]


def _targets(path: Path, stem: str, profile: Profile | None, args: argparse.Namespace) -> list[Path]:
    """Return the files that an output is written to."""
    if not path.is_dir():
        return [path] if _is_bundle(path) else list(_sides(path, args).values())
    from foldcut.exporters.bundle import OURS, README

    about = path / README
    if about.is_file() and not about.read_bytes().startswith(OURS.encode()):
        raise BadInputError(f"{about} is there and not foldcut's; choose an empty folder, or a .zip")
    members = (Path(name) for name in _members(path, stem, profile))
    return [about, *(path / name for member in members for name in _sides(member, args).values())]


def _marks(text: str | None) -> tuple[str, ...]:
    """Return the names of marks; raises JobError for one that is not known."""
    from foldcut.jobs.errors import JobError
    from foldcut.jobs.marks import DEFAULT_MARKS, MARKS

    if text is None:
        return DEFAULT_MARKS
    names = () if text == "none" else tuple(name.strip() for name in text.split(","))
    for name in names:
        if name not in MARKS:
            raise JobError(f"there is no mark {name!r}; choose of {', '.join(MARKS)}, or none")
    return names


def _check_machine(args: argparse.Namespace, profile: Profile | None, outputs: Sequence[Path]) -> None:
    """Raise what is wrong with formats and jobs before any long work."""
    from foldcut.drawing.placement import parse_sheet
    from foldcut.exporters import JOB_EXPORTERS, check_job_export, check_suffix

    machine = profile if profile is not None and profile.operations else None
    of_jobs = ("material", "treatment", "two_sided", "registration", "marks", "tile")
    of_machines = (*(() if profile else ("set",)), *(() if machine else of_jobs))
    given = [f"--{name.replace('_', '-')}" for name in of_machines if getattr(args, name)]
    if given:
        one = len(given) == 1
        if profile is None:
            what = f"{'goes' if one else 'go'} with a machine: name it with --profile"
        else:
            what = f"{'is' if one else 'are'} for a machine, and {args.profile} is none"
        raise BadInputError(f"{' and '.join(given)} {what}; see foldcut profiles")
    if args.registration and not args.two_sided:
        raise BadInputError("--registration lines the back up with the front: it goes with --two-sided")
    _marks(args.marks)
    names = [Path(name) for path in outputs if _is_bundle(path) for name in _members(path, "drawing", profile)]
    for path in [*names, *(path for path in outputs if not _is_bundle(path))]:
        check_suffix(path.suffix, machine, profile)
        if machine is not None and path.suffix.lower() in JOB_EXPORTERS:
            sheet = parse_sheet(args.sheet)
            check_job_export(path.suffix, machine, sheet, material=args.material, tile=args.tile)


def _sides(path: Path, args: argparse.Namespace) -> dict[Side, Path]:
    """Return the files of a job: one, or one for the front and one for the back."""
    return _job_options(args).sides(path)


def _default_outputs(source: Path, name: str | None, profile: Profile | None) -> list[str]:
    """Return the outputs when none are asked for; never the drawing's own name."""
    stem = _stem(source)
    if name is None or profile is None:
        return [f"{stem}{CREASES}.svg"] + ([] if source.suffix.lower() == FOLD else [f"{stem}{CREASES}.fold"])
    return [f"{stem}-{Path(name).stem}.{profile.format}"]


def _coupon(args: argparse.Namespace) -> int:
    """Write a machine's test card."""
    from foldcut.exporters import export_job
    from foldcut.jobs.coupon import make_coupon
    from foldcut.output.atomic import check_targets, write_files
    from foldcut.profiles import load_profile

    profile = load_profile(args.profile, args.set)
    path = Path(args.output or f"coupon-{Path(args.profile).stem}.{profile.format}")
    check_targets([path], replace=args.force)
    job, rows = make_coupon(profile, args.material)
    data = export_job(job, path.suffix, profile)
    replaced = path.exists()
    write_files({path: data}, replace=args.force)
    lines = [job.title, *(f"  {row}" for row in rows), f"  written   {path} ({len(data):,} bytes)"]
    files = [{"path": str(path), "bytes": len(data), "replaced": replaced}]
    if args.json or not args.quiet:
        _print_report({"ok": True, "title": job.title, "rows": rows, "files": files}, lines, args.json)
    return DONE


def _profiles(args: argparse.Namespace) -> int:
    """List, show or validate profiles."""
    from foldcut.profiles import load_profile, profile_names

    if args.action == "list":
        profiles = {name: load_profile(name) for name in profile_names()}
        width = max(map(len, profiles))
        lines = [f"{name:<{width}}  {p.format:<5}  {p.title}" for name, p in profiles.items()]
        listed = [{"name": name, "title": p.title, "format": p.format, "kind": p.kind} for name, p in profiles.items()]
        _print_report({"ok": True, "profiles": listed}, lines, args.json)
        return DONE
    if not args.name:
        raise BadInputError(f"foldcut profiles {args.action} needs the name of a profile or the path of a TOML file")
    profile = load_profile(args.name, args.set)
    if args.action == "show":
        shown = json.dumps(profile.model_dump(exclude_none=True), indent=2, ensure_ascii=False)
        _print_report({"ok": True, "profile": profile.model_dump(exclude_none=True)}, [shown], args.json)
    else:
        _print_report({"ok": True, "profile": args.name}, [f"{args.name}: valid"], args.json)
    return DONE


def _scale(args: argparse.Namespace) -> str | float:
    """Return the scale; raises BadInputError where the drawing's size is asked for twice."""
    if args.scale is not None and (args.width is not None or args.height is not None):
        other = "--width" if args.width is not None else "--height"
        raise BadInputError(f"--scale and {other} both say how large the drawing is; give one of them")
    return _parse_scale(args.scale or "fit")


def _parse_rotation(text: str | None) -> str | float | None:
    """Return degrees or "best"; None if nothing is asked for."""
    if text in (None, "best"):
        return text
    try:
        return float(text)
    except ValueError:
        raise BadInputError(f"--rotate {text} is no angle; give degrees such as 45, or best") from None


def _parse_scale(text: str) -> str | float:
    """Return "fit" or the factor that "1.5" or "1:2" (half size) means."""
    if text == "fit":
        return text
    numerator, colon, denominator = text.partition(":")
    try:
        scale = float(numerator) / (float(denominator) if colon else 1.0)
    except (ValueError, ZeroDivisionError):
        scale = 0.0
    if not 0 < scale < float("inf"):
        raise BadInputError(
            f"--scale {text} is no scale; give fit, a number above 0 such as 1.5, or a ratio such as 1:2"
        )
    return scale


def _parse_offset(text: str | None) -> tuple[float, float] | None:
    """Return (x, y) in mm from "X,Y", each a length that may be negative."""
    from foldcut.drawing.placement import parse_length

    if text is None:
        return None
    parts = [part.strip() for part in text.split(",")]
    if len(parts) != 2:
        raise BadInputError(f"--offset {text} is no pair; give X,Y such as 30,40 or 3cm,-5mm")
    x, y = (-parse_length(part[1:]) if part.startswith("-") else parse_length(part) for part in parts)
    return x, y


def _with_joined_values(argv: Sequence[str]) -> list[str]:
    """Return the arguments with ``--offset -5,3`` or ``--text -A`` as one: argparse takes such values for options."""
    joined: list[str] = []
    for argument in argv:
        before = joined[-1] if joined and "--" not in joined else ""  # after -- there are no options
        negative = argument[:1] == "-" and argument[1:2].isdigit() and before[:2] == "--" and "=" not in before
        if negative or (before in ("--offset", "--text") and argument[:2] != "--"):
            joined[-1] = f"{before}={argument}"
        else:
            joined.append(argument)
    return joined


def _finish(
    report: dict[str, Any],
    lines: Sequence[str],
    findings: Sequence[Finding],
    what: str,
    args: argparse.Namespace,
) -> int:
    """Print a report and, where there are findings, an error that sums them up; return the exit status."""
    message = ""
    if findings:
        more = f" (and {len(findings) - 1} more)" if len(findings) > 1 else ""
        message = f"the pattern is not verified: {findings[0]}{more}; {what}"
        report["error"] = {"type": "VerificationError", "message": message}
    if args.json or not args.quiet:
        _print_report(report, lines, args.json)
    return _fail(None, message, FAILED, as_json=False) if findings else DONE


def _print_report(report: dict[str, Any], lines: Sequence[str], as_json: bool) -> None:
    """Print a report on stdout, for programs or for people."""
    print(json.dumps(report, indent=2) if as_json else "\n".join(lines))


def _fail(error: BaseException | None, message: str, status: int, as_json: bool) -> int:
    """Print an error as one line on stderr, and for programs on stdout; return the exit status."""
    line = " ".join(message.split())
    print(f"foldcut: error: {line}", file=sys.stderr)
    if as_json:
        from dataclasses import asdict

        findings = [asdict(finding) for finding in getattr(error, "findings", ())]
        about = {"type": type(error).__name__.lstrip("_"), "message": line}
        print(json.dumps({"ok": False, "error": about, "findings": findings}, indent=2))
    return status


@contextmanager
def _time_limit(seconds: float | None) -> Iterator[None]:
    """Raise ``_TimedOut`` in the block once so many seconds have passed."""
    if seconds is None:
        yield
        return
    if not 0 < seconds < 1e8:
        raise BadInputError(f"--timeout is {seconds} s; give a positive number")
    if not hasattr(signal, "setitimer"):
        raise BadInputError("--timeout does not work on this system; leave it out")

    def raise_timed_out(number: int, frame: FrameType | None) -> NoReturn:
        raise _TimedOut

    before = signal.signal(signal.SIGALRM, raise_timed_out)
    try:
        signal.setitimer(signal.ITIMER_REAL, seconds, 1.0)  # again and again: an exception in a finaliser is lost
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


@contextmanager
def _signals_raise() -> Iterator[None]:
    """Let SIGTERM unwind the stack as Ctrl-C does, and Ctrl-C too where the parent has it ignored.

    A shell without job control starts what it runs in the background with SIGINT ignored.
    """

    def raise_terminated(number: int, frame: FrameType | None) -> NoReturn:
        raise _Terminated

    handlers: dict[signal.Signals, Any] = {signal.SIGTERM: raise_terminated}
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        handlers[signal.SIGINT] = signal.default_int_handler
    try:
        before = {number: signal.signal(number, handler) for number, handler in handlers.items()}
    except ValueError:  # not the main thread
        yield
        return
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _parser() -> _Parser:
    """Build the parser of all commands."""
    parser = _Parser(
        prog="foldcut",
        description="Fold a sheet flat so that one straight cut cuts out any drawing with straight edges.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action=_Version, help="show the version and exit")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND", title="commands")
    _add_make(commands)
    _add_view(commands)
    _add_draw(commands)
    _add_guide(commands)
    _add_batch(commands)
    _add_serve(commands)
    _add_check(commands)
    _add_coupon(commands)
    _add_profiles(commands)
    _add_samples(commands)
    parser.commands = tuple(commands.choices)
    return parser


class _Version(argparse.Action):
    """Print the installed version; looked up only when asked for."""

    def __init__(self, option_strings: Sequence[str], dest: str, help: str) -> None:
        super().__init__(option_strings, dest, nargs=0, help=help)

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> NoReturn:
        from importlib.metadata import version

        print(f"foldcut {version('foldcut')}")
        parser.exit()


def _command(
    commands: Any,
    name: str,
    run: Callable[[argparse.Namespace], int],
    summary: str,
    description: str,
    epilog: str,
) -> argparse.ArgumentParser:
    """Add a command that does ``run``."""
    form = argparse.RawDescriptionHelpFormatter
    command: argparse.ArgumentParser = commands.add_parser(
        name, help=summary, description=description, epilog=epilog, formatter_class=form
    )
    command.set_defaults(run=run, parser=command)
    return command


def _add_make(commands: Any) -> None:
    _add_options_of_make(
        _command(
            commands,
            "make",
            _make,
            "compute the crease pattern of a drawing and write it",
            "Compute how to fold a sheet so that one straight cut gives the drawing.",
            MAKE_EPILOG,
        )
    )


def _add_view(commands: Any) -> None:
    _add_options_of_make(
        _command(
            commands,
            "view",
            _make,
            "compute the crease pattern and write a page to look at, to fold and to cut on the screen",
            "Compute as `foldcut make` does and write NAME.html: the pattern, and the sheet in 3D with sliders that "
            "fold it and take its layers off. The page is one file, needs no network, and works in any browser.",
            VIEW_EPILOG,
        )
    )


def _add_options_of_make(make: argparse.ArgumentParser) -> None:
    make.add_argument(
        "-o",
        "--output",
        metavar="OUT",
        action="append",
        help="a file to write; its ending is the format; or a folder or a .zip for all files of a job and a "
        "README.txt; repeatable",
    )
    make.add_argument(
        "--preview", metavar="FILE.svg", help="also draw the drawing before (red) and after (black) mending"
    )
    _add_options_of_fold(make)
    _add_machine(make)
    _add_common(make)


def _add_machine(make: argparse.ArgumentParser) -> None:
    machine = make.add_argument_group("the machine")
    machine.add_argument(
        "--profile",
        metavar="NAME",
        help=f"write the job for this machine; see foldcut profiles (default: none, and {ANY_LASER} for DXF alone)",
    )
    machine.add_argument(
        "--set", metavar="KEY=VALUE", action="append", default=[], help="change a value of the profile (repeatable)"
    )
    machine.add_argument("--material", metavar="NAME", help="what the sheet is made of (default: the profile's first)")
    machine.add_argument(
        "--treatment",
        choices=("score", "perforate", "draw"),
        help="of the creases: unbroken lines, cuts with gaps, or dashed and dash-dotted lines (default: the profile's)",
    )
    machine.add_argument(
        "--two-sided", action="store_true", help="mountains on the front, valleys on the back, as two files"
    )
    machine.add_argument(
        "--registration",
        choices=("corners", "holes", "pins"),
        help="what lines the back up with the front: corner marks, 3 mm holes for pegs, or 1 mm holes for needles "
        "(default: corners)",
    )
    machine.add_argument(
        "--marks",
        metavar="NAME,...",
        help="what else is marked: outline (where the cut will be), first-folds, cut-line (only what is seen of the "
        "outline when folded), numbers (the order to press creases), title, ruler (PDF has both anyway); "
        "or none (default: outline,first-folds)",
    )
    machine.add_argument(
        "--tile", action="store_true", help="print a sheet that is larger than the paper on several pages"
    )


def _add_draw(commands: Any) -> None:
    draw = _command(
        commands,
        "draw",
        _draw,
        "draw the pattern, the folded sheet, its layers, and what the cut leaves",
        "Compute as `foldcut make` does and draw pictures to look at, side by side.",
        DRAW_EPILOG,
    )
    draw.add_argument("-o", "--output", metavar="OUT", help="a .svg or .png (default: NAME-pictures.svg)")
    draw.add_argument(
        "--show",
        metavar="NAME,...",
        default="pattern,folded,layers,pieces",
        help="pattern; folded: flat, from the front, with the cut; layers: drawn apart, from the side; pieces: "
        "unfolded after the cut (default: these); and of --method paper packing, molecules, rabbit-ear, gusset, inset, "
        "trees, matching, ribbon",
    )
    _add_options_of_fold(draw)
    _add_common(draw)


def _add_guide(commands: Any) -> None:
    guide = _command(
        commands,
        "guide",
        _guide,
        "write how a person folds it, step by step",
        "Compute as `foldcut make` does and write a folding guide with a picture of each step: straight folds, what to "
        "press and to collapse at once, the layers, where to cut.",
        GUIDE_EPILOG,
    )
    guide.add_argument("-o", "--output", metavar="OUT", help="a .pdf or .html (default: NAME-guide.pdf)")
    _add_options_of_fold(guide)
    _add_common(guide)


def _add_batch(commands: Any) -> None:
    batch = _command(
        commands,
        "batch",
        _batch,
        "compute the crease patterns of many drawings, on all cores or a cluster",
        "Do as `foldcut make` does for every drawing in folders, and write all into one folder. No drawing ends the "
        "batch, and an interrupted batch goes on where it was.",
        BATCH_EPILOG,
    )
    batch.add_argument(
        "drawings", metavar="FOLDER|GLOB", nargs="+", help="a folder with all below, a pattern of names, or a drawing"
    )
    batch.add_argument("-o", "--output", metavar="OUT", required=True, help="the folder to write into")
    batch.add_argument(
        "--format", dest="formats", metavar="NAME,...", help="what to write (default: the profile's, or svg,fold)"
    )
    batch.add_argument("--jobs", metavar="N", type=int, help="how many processes (default: one for each core)")
    batch.add_argument("--dask", metavar="ADDRESS", help="use the workers of this dask scheduler (extra: batch)")
    batch.add_argument(
        "--timeout",
        dest="file_timeout",
        metavar="S",
        type=float,
        default=300.0,
        help="give up a drawing after so many seconds (default: 300)",
    )
    batch.add_argument("--retry", action="store_true", help="do those again that failed before")
    batch.add_argument("--force", action="store_true", help="begin anew, and replace files that are there already")
    batch.add_argument("--parquet", action="store_true", help="also write results.parquet (extra: batch)")
    batch.add_argument(
        "--contact-sheet", choices=("svg", "png"), default="svg", help="the page with all patterns (default: svg)"
    )
    _add_folding(batch)
    _add_machine(batch)
    _add_common(batch)


def _add_serve(commands: Any) -> None:
    serve = _command(
        commands,
        "serve",
        _serve,
        "a page in the browser for all of this, on this machine",
        "Serve a page where drawings are dropped or drawn, folded, looked at and taken as files (extra: serve).",
        SERVE_EPILOG,
    )
    serve.add_argument("--port", type=int, default=8000, help="(default: %(default)s)")
    serve.add_argument("--host", default="127.0.0.1", help="the address to listen at (default: only this machine)")
    serve.add_argument(
        "--job-seconds", type=float, default=60.0, metavar="S", help="stop a drawing after so long (default: 60)"
    )


def _add_options_of_fold(make: argparse.ArgumentParser) -> None:
    """Add the drawing, where it lies on the sheet, and how to search."""
    _add_force(make)
    make.add_argument(
        "shape",
        metavar="SHAPE",
        nargs="?",
        help="a drawing (.svg, .dxf, .pdf, .png, .jpg, .json, .geojson, .wkt, .wkb, .csv), the name of a sample, a "
        "pattern that foldcut wrote (.fold), or - for standard input",
    )
    make.add_argument("--text", help="draw this text instead of a SHAPE")
    make.add_argument(
        "--font", default="sans", help="of --text: the path of a font file, or a family (default: %(default)s)"
    )
    _add_timeout(make)
    _add_folding(make)


def _add_folding(make: argparse.ArgumentParser) -> None:
    """Add where a drawing lies on the sheet, how it is read, and how to search."""
    make.add_argument(
        "--sheet",
        default="a4",
        help="a paper size such as a4, which lies as the drawing does, or a4-landscape, or WIDTHxHEIGHT "
        "(default: %(default)s)",
    )
    make.add_argument("--margin", default="10mm", help="room kept free along the sheet's edges (default: %(default)s)")
    make.add_argument(
        "--scale",
        help="fit, or a factor on the size of the drawing such as 1.5 or 1:2 (default: fit, within the margin)",
    )
    make.add_argument("--width", metavar="LENGTH", help="scale the drawing to this width, turned as --rotate says")
    make.add_argument(
        "--height",
        metavar="LENGTH",
        help="scale it to this height; with --width, as large as neither is exceeded: it is never stretched",
    )
    make.add_argument(
        "--offset",
        metavar="X,Y",
        help="where the lower left corner of the drawing lies on the sheet (default: centred)",
    )
    make.add_argument(
        "--rotate",
        metavar="DEG",
        help="turn the drawing counter-clockwise; best: as it is largest on the sheet (default: a quarter if it has "
        "more room so, and as its mirror axes ask for; 0 forbids that)",
    )
    make.add_argument(
        "--method",
        choices=CHOICES,
        default=DEFAULT_METHOD,
        help="mirror: fold the drawing's mirror axes first, the rest through two or four layers; compact: one loop, "
        "few creases; skeleton: any loops, few creases, but not all drawings (extra: skeleton); auto: of these, what "
        "is easiest to fold, or else gate or paper; paper: the disk packing of Bern, Demaine, Eppstein and Hayes, "
        "thousands of creases; gate: the same for several loops (default: %(default)s)",
    )
    make.add_argument(
        "--effort",
        choices=EFFORTS,
        default="normal",
        help="how long to search for fewer and longer creases (default: %(default)s)",
    )
    make.add_argument(
        "--seconds", metavar="S", type=float, help="stop the search after so many seconds (default: as --effort says)"
    )
    make.add_argument(
        "--progress", action="store_true", help="print how far it is on stderr, as lines of JSON for programs"
    )
    make.add_argument(
        "--ribbon",
        metavar="WIDTH",
        help="half the width of an unfolded ribbon along the cut (default: none; with --method paper and gate, which "
        "need one, 0.25mm or what the drawing has room for)",
    )
    make.add_argument(
        "--min-crease",
        metavar="LENGTH",
        help="refuse patterns with a shorter crease (default: 0.5mm; of skeleton, gate and paper 0mm)",
    )
    make.add_argument(
        "--simplify",
        metavar="LENGTH",
        default="0mm",
        help="leave out corners that are no more than this off, on the sheet (default: none)",
    )
    make.add_argument(
        "--symmetry",
        metavar="LENGTH",
        default="0mm",
        help="take the drawing as mirror-symmetric when its corners are off by no more than this on the sheet, and "
        "make it so (default: only rounding)",
    )
    make.add_argument(
        "--adjust",
        metavar="LENGTH",
        default=f"{ADJUST_MM:g}mm",
        help="how far the method skeleton may move corners, so that creases meet (default: %(default)s)",
    )
    _add_reading(make)
    mend = make.add_argument_group("the drawing; every change is reported")
    mend.add_argument("--strict", action="store_true", help="refuse a drawing that has to be mended, and say why")
    mend.add_argument("--corners", metavar="N", type=int, help="leave out corners until at most N are left")
    mend.add_argument(
        "--min-feature",
        metavar="LENGTH",
        default="0mm",
        help="drop parts and close gaps that are narrower, on the sheet",
    )
    mend.add_argument(
        "--separate",
        metavar="LENGTH",
        default="0mm",
        help="if loops touch, move all edges inward until they are this far apart",
    )
    mend.add_argument("--mirror", action="store_true", help="turn the drawing over, left to right")


def _add_check(commands: Any) -> None:
    check = _command(
        commands,
        "check",
        _check,
        "verify that a FOLD file folds flat as it says",
        "Verify that a crease pattern folds flat as it says, and with --shape also its cut.",
        CHECK_EPILOG,
    )
    check.add_argument("file", metavar="FILE.fold", help="the crease pattern")
    check.add_argument("--shape", metavar="SHAPE", help="the drawing that the cut must give, or the name of a sample")
    _add_reading(check)
    _add_timeout(check)
    _add_common(check)


def _add_coupon(commands: Any) -> None:
    coupon = _command(
        commands,
        "coupon",
        _coupon,
        "write a test card of scores and perforations for a machine",
        "Write a test card: strips to fold, scored and perforated in many settings. A row's number is told "
        "by the ticks beside it.",
        COUPON_EPILOG,
    )
    coupon.add_argument("--profile", metavar="NAME", required=True, help="the machine; see foldcut profiles")
    coupon.add_argument("--material", metavar="NAME", help="what the card is made of (default: the profile's first)")
    coupon.add_argument("--set", metavar="KEY=VALUE", action="append", default=[], help="change a value (repeatable)")
    coupon.add_argument("-o", "--output", metavar="FILE", help="(default: coupon-PROFILE in the machine's format)")
    _add_force(coupon)
    _add_common(coupon)


def _add_profiles(commands: Any) -> None:
    profiles = _command(
        commands,
        "profiles",
        _profiles,
        "list, show and validate the machines' profiles",
        "List, show and validate profiles: what foldcut knows of machines. Your own go into "
        "~/.config/foldcut/profiles, or anywhere: --profile takes a path that ends in .toml.",
        PROFILES_EPILOG,
    )
    profiles.add_argument("action", nargs="?", choices=("list", "show", "validate"), default="list")
    profiles.add_argument("name", nargs="?", metavar="PROFILE", help="a name, or the path of a TOML file")
    profiles.add_argument("--set", metavar="KEY=VALUE", action="append", default=[], help="change a value (repeatable)")
    profiles.add_argument("--json", action="store_true", help="print for programs")


def _add_samples(commands: Any) -> None:
    samples = _command(
        commands,
        "samples",
        _samples,
        "list the drawings that come with foldcut",
        "List the drawings that come with foldcut; `foldcut make` takes their names as SHAPE.",
        SAMPLES_EPILOG,
    )
    samples.add_argument("--json", action="store_true", help="print the list for programs")


def _add_reading(command: argparse.ArgumentParser) -> None:
    reading = command.add_argument_group("the drawing")
    reading.add_argument(
        "--from", dest="format", metavar="SUFFIX", help="the drawing's format, such as svg (default: as its name ends)"
    )
    reading.add_argument("--layer", metavar="NAME", action="append", default=[], help="read only this (repeatable)")
    reading.add_argument("--id", metavar="ID", action="append", default=[], help="read only this element (repeatable)")
    reading.add_argument(
        "--flatten",
        metavar="LENGTH",
        default="0.05mm",
        help="how far a curve may be from its segments, in the drawing at its own size and at 200 mm "
        "(default: %(default)s)",
    )
    reading.add_argument(
        "--threshold",
        metavar="T",
        type=float,
        default=0.5,
        help="how light a picture's shape may be, from 0, black, to 1, white (default: %(default)s)",
    )
    reading.add_argument(
        "--join",
        metavar="LENGTH",
        default="0.05mm",
        help="join ends of lines that are no farther apart, at the same sizes (default: %(default)s)",
    )
    reading.add_argument(
        "--limit",
        metavar="NAME=NUMBER",
        action="append",
        default=[],
        help="read drawings that are larger: bytes (default: 20 MiB), points (100000), loops (1000), "
        "pixels (40 million), nesting (100); repeatable",
    )


def _add_force(command: argparse.ArgumentParser) -> None:
    command.add_argument("--force", action="store_true", help="replace files that are there already")


def _add_timeout(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "--timeout", metavar="S", type=float, help="give up after so many seconds, with an error (default: never)"
    )


def _add_common(command: argparse.ArgumentParser) -> None:
    command.add_argument("--json", action="store_true", help="print the report for programs, on stdout")
    command.add_argument("--quiet", action="store_true", help="print nothing but errors")


if __name__ == "__main__":
    sys.exit(main())
