"""The command ``foldcut``: run one command, and turn whatever goes wrong into one line and an exit status.

The status is 0 when the work is done and verified, 1 when there is no pattern or it is not verified, 2 when the input
is at fault, 130 after Ctrl-C and 143 after SIGTERM. Everything slow to import is imported inside the commands.
"""

from __future__ import annotations

import atexit
import gc
import io
import os
import sys
from collections.abc import Sequence

from foldcut.cli.console import BAD_INPUT, FAILED, INTERRUPTED, TERMINATED, print_error, print_json
from foldcut.cli.parser import parse
from foldcut.cli.signals import Terminated, TimedOut, signals_raise, time_limit
from foldcut.core.errors import FoldcutError, UnfoldableError

GARBAGE = 50_000
"""The collector looks for garbage after this many new objects; Python's own setting is 700."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command and return its exit status; ``argv`` is ``sys.argv[1:]`` unless given."""
    argv = list(sys.argv[1:] if argv is None else argv)
    as_json = "--json" in argv
    _start_fast()
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")  # a title may have letters that the terminal lacks
    try:
        with signals_raise():
            command, args = parse(argv)
            with time_limit(getattr(args, "timeout", None)):
                status = command.run(args)
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
    except TimedOut as error:
        remedy = "allow more with --timeout, or search less with --effort fast or --seconds"
        return _fail(error, f"timed out after {error.seconds:g} s, no file is half-written; {remedy}", FAILED, as_json)
    except Terminated as error:
        return _fail(error, f"terminated; {_notes(error)}no file is half-written", TERMINATED, as_json)


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
    line = print_error(message)
    if as_json:
        from dataclasses import asdict

        findings = [asdict(finding) for finding in getattr(error, "findings", ())]
        print_json({"ok": False, "error": {"type": type(error).__name__, "message": line}, "findings": findings})
    return status


if __name__ == "__main__":
    sys.exit(main())
