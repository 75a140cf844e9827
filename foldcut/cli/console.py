"""What the command line prints, and with which status it exits. Reports go to stdout, errors to stderr."""

from __future__ import annotations

import signal
import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

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


class Console(NamedTuple):
    """How a command reports: as JSON on stdout for programs, as text for people, or not at all."""

    as_json: bool
    quiet: bool = False

    @property
    def draws_progress(self) -> bool:
        """Whether a progress bar is wanted and stderr can show it."""
        return sys.stderr.isatty() and not (self.quiet or self.as_json)

    def report(self, report: dict[str, Any], lines: Sequence[str]) -> None:
        """Print a report: the dictionary for programs, or the lines for people."""
        if self.as_json:
            print_json(report)
        elif not self.quiet:
            print("\n".join(lines))

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

    print(json.dumps(report, indent=2))


def print_error(message: str) -> str:
    """Print an error as one line on stderr, and return the message as it stands in that line."""
    line = " ".join(message.split())
    print(f"foldcut: error: {line}", file=sys.stderr)
    return line
