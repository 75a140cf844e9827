"""Where the process of the command line starts and ends, so that Ctrl-C is answered in one line then, too.

Nothing that takes time is imported at the top, so that as little as possible happens before this file can answer.
"""

from __future__ import annotations

import sys


def main() -> int:
    """Run the command that ``sys.argv`` asks for, in a process of its own, and return the exit status."""
    try:
        from foldcut.cli.signals import Terminated, signals_raise
    except KeyboardInterrupt:
        return _ended("KeyboardInterrupt", "interrupted", 130)
    try:
        with signals_raise():  # so early that none is lost in what the import of modules calls back
            import logging
            import signal

            from foldcut.cli.main import main as run

            logging.lastResort = None  # libraries warn about what foldcut checks itself
            if not sys.warnoptions:
                import warnings

                warnings.simplefilter("ignore")
            status = run()
        signal.signal(signal.SIGINT, signal.SIG_IGN)  # all is done and told
    except KeyboardInterrupt:
        status = _ended("KeyboardInterrupt", "interrupted", 130)
    except Terminated:
        status = _ended("Terminated", "terminated", 143)
    return status


def _ended(kind: str, how: str, status: int) -> int:
    """Say that a signal came before the command began, or when it was all but done."""
    message = f"{how}; no file is half-written"
    if "--json" in sys.argv:
        print(f'{{"ok": false, "error": {{"type": "{kind}", "message": "{message}"}}, "findings": []}}')
    print(f"foldcut: error: {message}", file=sys.stderr)
    return status
