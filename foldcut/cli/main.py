"""The command ``foldcut``: run one command, and turn whatever goes wrong into one line and an exit status.

The status is 0 when the work is done and verified, 1 when there is no pattern or it is not verified, 2 when the input
is at fault, 130 after Ctrl-C and 143 after SIGTERM. Everything slow to import is imported inside the commands.
"""

from __future__ import annotations

import atexit
import errno
import gc
import os
import sys
from argparse import Namespace
from collections.abc import Sequence
from contextlib import suppress

from foldcut.cli.console import (
    BAD_INPUT,
    FAILED,
    INTERRUPTED,
    TERMINATED,
    flush,
    nobody_listens,
    open_streams,
    print_error,
    print_json,
)
from foldcut.cli.parser import parse
from foldcut.cli.signals import Terminated, TimedOut, deaf, last_raised, signals_raise, time_limit
from foldcut.core.errors import FoldcutError, UnfoldableError

TRACEBACK = "FOLDCUT_TRACEBACK"
"""Where this is set in the environment, errors end with a traceback: for those who look for a mistake in foldcut."""

NO_MEMORY = "failed to map segment from shared object"
"""What the system says where there is not enough memory to load a library."""

LONGEST_CHAIN = 100
"""How many errors are looked at, each of which was raised while the next was handled."""

GARBAGE = 50_000
"""The collector looks for garbage after this many new objects; Python's own setting is 700."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command and return its exit status; ``argv`` is ``sys.argv[1:]`` unless given."""
    argv = list(sys.argv[1:] if argv is None else argv)
    as_json = "--json" in argv
    args = Namespace()
    try:
        with signals_raise():
            _start_fast()
            open_streams()
            command, args = parse(argv)
            with time_limit(getattr(args, "timeout", None)):
                status = command.run(args)
            flush()
            return status
    except SystemExit:  # --help and --version have printed something
        flush()
        raise
    except BrokenPipeError:
        nobody_listens()
        return FAILED
    except (Exception, KeyboardInterrupt, Terminated, TimedOut) as error:
        if os.environ.get(TRACEBACK):
            raise
        message, status = told(error, args)
        return _fail(error, message, status, as_json)


def told(error: BaseException, args: Namespace | None = None) -> tuple[str, int]:
    """Return what is said about an error of a command, whose options ``args`` are, and the exit status."""
    ended = ended_by(error)
    if isinstance(ended, KeyboardInterrupt):
        return f"interrupted; {_notes(ended)}no file is half-written", INTERRUPTED
    if isinstance(ended, Terminated):
        return f"terminated; {_notes(ended)}no file is half-written", TERMINATED
    if isinstance(ended, TimedOut):
        remedy = "allow more with --timeout"
        searches = args is not None and "effort" in args and getattr(args, "again", None) is None
        remedy += ", or search less with --effort fast or --seconds" if searches else ""
        return f"timed out after {ended.seconds:g} s, no file is half-written; {remedy}", FAILED
    if isinstance(error, FoldcutError):
        return str(error), FAILED if isinstance(error, UnfoldableError) else BAD_INPUT
    if isinstance(error, OSError):
        where = f"{error.filename}: " if error.filename else ""
        remedy = "; give a shorter name" if error.errno == errno.ENAMETOOLONG else ""
        return f"{where}{error.strerror or error}{remedy}", BAD_INPUT
    if isinstance(error, MemoryError) or NO_MEMORY in str(error):
        return "there is not enough memory, and no file is half-written; simplify the drawing", FAILED
    what = " ".join(f"{type(error).__name__}: {error}".split())
    return (
        f"this is a mistake in foldcut, and no file is half-written: {what}; please report it with what is printed "
        f"if {TRACEBACK}=1 is set",
        FAILED,
    )


def ended_by(error: BaseException) -> BaseException | None:
    """Return the Ctrl-C, signal or time limit that an error is or came from, if any: libraries turn it into others."""
    seen = 0
    found: BaseException | None = error
    while found is not None and seen < LONGEST_CHAIN and not isinstance(error, FoldcutError):
        if isinstance(found, KeyboardInterrupt | Terminated | TimedOut):
            return found
        found, seen = found.__cause__ or found.__context__, seen + 1
    return None if isinstance(error, FoldcutError | OSError) else last_raised()


def _start_fast() -> None:
    """Set up the process before anything large is imported."""
    # Matrices are small: threads for them cost more than they save.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    # What is imported stays: the collector need not search it again and again, nor at the end.
    gc.set_threshold(GARBAGE)
    atexit.register(gc.freeze)


def _notes(error: BaseException) -> str:
    """Return the notes that commands have added to an interruption."""
    return "".join(f"{note}; " for note in getattr(error, "__notes__", ()))


def _fail(error: BaseException, message: str, status: int, as_json: bool) -> int:
    """Print an error for people and, with ``--json``, for programs; return the exit status."""
    with deaf():  # a second Ctrl-C does not break that off
        line = print_error(message)
        if as_json:
            from dataclasses import asdict

            findings = [asdict(finding) for finding in getattr(error, "findings", ())]
            about = {"type": type(error).__name__, "message": line}
            with suppress(OSError):  # it may be that which went wrong
                print_json({"ok": False, "error": about, "findings": findings})
    return status
