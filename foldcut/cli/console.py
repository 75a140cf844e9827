"""What the command line prints, and with which status it exits. Reports go to stdout, errors to stderr.

Names of files and titles are shown as they may be printed: their control characters and escape sequences do nothing.
"""

from __future__ import annotations

import io
import os
import signal
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any, NamedTuple, TextIO

from foldcut.core.errors import FoldcutError
from foldcut.core.text import shown

if TYPE_CHECKING:
    from foldcut.core.model import Finding

DONE = 0
"""The work is done, and the pattern is verified."""
FAILED = 1
"""There is no pattern, or it is not verified."""
BAD_INPUT = 2
"""The input is at fault."""
UNDECIDED = 3
"""Whether the pattern folds is not decided."""
INTERRUPTED = 128 + signal.SIGINT
"""Ctrl-C was pressed."""
TERMINATED = 128 + signal.SIGTERM
"""SIGTERM arrived."""


LONGEST = 1200
"""An error with more letters is cut in its middle: what is wrong and the remedy stay."""


class PrintError(FoldcutError, OSError):
    """What was to be printed cannot be."""


class Console(NamedTuple):
    """How a command reports: as JSON on stdout for programs, as text for people, or not at all."""

    as_json: bool
    quiet: bool = False

    @property
    def tells_progress(self) -> bool:
        """Whether people are told on stderr how far the work is."""
        return not (self.quiet or self.as_json)

    def report(self, report: dict[str, Any], lines: Sequence[str]) -> None:
        """Print a report: the dictionary for programs, or the lines for people."""
        if self.as_json:
            print_json(report)
        elif not self.quiet:
            _print("\n".join(map(shown, lines)), sys.stdout)

    def verdict(self, report: dict[str, Any], lines: Sequence[str], findings: Sequence[Finding], remedy: str) -> int:
        """Print a report and, if verification found something, an error that sums it up; return the exit status."""
        if not findings:
            self.report(report, lines)
            return DONE
        more = f" (and {len(findings) - 1} more)" if len(findings) > 1 else ""
        message = f"the pattern is not verified: {findings[0]}{more}; {remedy}"
        self.report(report | {"error": {"type": "VerificationError", "message": message}}, lines)
        print_error(message)
        return FAILED


def print_json(report: dict[str, Any]) -> None:
    """Print a report for programs."""
    import json

    _print(json.dumps(report, indent=2), sys.stdout)


def print_error(message: str) -> str:
    """Print an error as one line on stderr, and return the message as it stands in that line."""
    line = shown(" ".join(message.split()))
    if len(line) > LONGEST:
        line = f"{line[: 2 * LONGEST // 3]} ... {line[-LONGEST // 3 :]}"
    try:
        _print(f"foldcut: error: {line}", sys.stderr)
    except OSError:  # nobody is told
        _to_nowhere(sys.stderr)
    return line


def _print(text: str, out: TextIO) -> None:
    """Print a text at once; raises what ``flush`` raises."""
    with _checked(out):
        print(text, file=out, flush=True)


def flush() -> None:
    """Print what waits to be printed; raises BrokenPipeError where nobody reads on, and PrintError where that fails."""
    with _checked(sys.stdout):
        sys.stdout.flush()


@contextmanager
def _checked(out: TextIO) -> Iterator[None]:
    try:
        yield
    except BrokenPipeError:
        raise
    except OSError as error:
        _to_nowhere(out)
        why = error.strerror or str(error)
        raise PrintError(
            f"the report cannot be printed: {why}; files that were asked for may be there already"
        ) from None


def open_streams() -> None:
    """Open standard streams that are closed, to and from nowhere: a file must not get their number.

    Letters that the terminal lacks are printed as their escapes.
    """
    for number, name in enumerate(("stdin", "stdout", "stderr")):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # the lowest number that is free: this one
        if getattr(sys, name) is None:
            setattr(sys, name, open(number, "w" if number else "r", encoding="utf-8", closefd=False))  # noqa: SIM115
    for out in (sys.stdout, sys.stderr):
        if isinstance(out, io.TextIOWrapper):
            out.reconfigure(errors="backslashreplace")


def nobody_listens() -> None:
    """Give up on standard output, which nobody reads: what waits to be printed must not fail again at exit."""
    _to_nowhere(sys.stdout)


def _to_nowhere(out: TextIO) -> None:
    with suppress(OSError, ValueError, AttributeError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), out.fileno())
