"""Show a page that was written in the user's browser, where there is somebody to see it."""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from pathlib import Path

__all__ = ["has_screen", "open_page"]

SCREENS = ("DISPLAY", "WAYLAND_DISPLAY")
"""What names the screen where windows need one: any of these."""


def has_screen() -> bool:
    """Return whether somebody looks at a terminal on a machine that has windows."""
    windows = sys.platform in ("darwin", "win32") or any(os.environ.get(name) for name in SCREENS)
    return windows and sys.stdout.isatty()


def open_page(path: Path) -> None:
    """Open a page in the user's browser; without one, nothing happens: the report has named the file."""
    import webbrowser

    with suppress(webbrowser.Error, OSError):
        webbrowser.open(path.resolve().as_uri())
