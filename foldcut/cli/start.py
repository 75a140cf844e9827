"""Where the process of the command line starts and ends, so that Ctrl-C is answered in one line then, too.

Nothing that takes time is imported at the top, so that as little as possible happens before this file can answer.
"""

from __future__ import annotations

import sys

INTERRUPTED = "interrupted; no file is half-written"


def main() -> int:
    """Run the command that ``sys.argv`` asks for, in a process of its own, and return the exit status."""
    try:
        import signal

        from foldcut.cli.main import main as run

        if not sys.warnoptions:
            import warnings

            warnings.simplefilter("ignore")  # libraries warn about what foldcut checks itself
        status = run()
        signal.signal(signal.SIGINT, signal.SIG_IGN)  # all is done and told
    except KeyboardInterrupt:
        status = _interrupted()
    return status


def _interrupted() -> int:
    """Say that Ctrl-C came before the command began, or when it was all but done."""
    if "--json" in sys.argv:
        print(f'{{"ok": false, "error": {{"type": "KeyboardInterrupt", "message": "{INTERRUPTED}"}}, "findings": []}}')
    print(f"foldcut: error: {INTERRUPTED}", file=sys.stderr)
    return 130
