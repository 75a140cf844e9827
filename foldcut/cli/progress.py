"""Progress on stderr: a bar or lines for people, or lines of JSON for programs that ask for them with ``--progress``.

The bar appears when stderr is a terminal and the work takes longer than a second, or something has to be compiled; it
disappears when the work is done. Where stderr is no terminal, as in the log of a build, a line is written every few
seconds instead.
"""

from __future__ import annotations

import json
import os
import sys
import threading
import time
from contextlib import ExitStack, suppress
from types import TracebackType
from typing import TYPE_CHECKING, TextIO

if TYPE_CHECKING:
    from rich.progress import Progress

    from foldcut.cli.console import Console
    from foldcut.redraw.ladder import Level

PATIENCE_S = 1.0
"""Work that is done sooner shows no bar."""
AT_ONCE = "compiling"
"""A stage whose name begins with this shows it at once: it takes long, and tells nothing until it is over."""
BETWEEN_LINES_S = 0.1
"""A stage writes no more than one line in this time."""
EVERY_S = 5.0
"""Where there is no terminal, a line says this often how far the work is."""
NO_PROGRESS = "FOLDCUT_NO_PROGRESS"
"""The environment variable that turns these lines off: for programs that take any line on stderr for an error."""


class ProgressLines:
    """A callback ``lines(stage, fraction)`` that writes ``{"stage": "searching: 8 creases", "fraction": 0.5}``.

    A stage, which is named by the text before the colon, writes no more than one line every ``BETWEEN_LINES_S``.
    """

    def __init__(self, out: TextIO) -> None:
        self._out = out
        self._last, self._told, self._fraction = "", 0.0, 0.0

    def __call__(self, stage: str, fraction: float) -> None:
        """Write that ``stage`` is at work and that this ``fraction`` of the whole is done, from 0 to 1."""
        name, now = stage.partition(":")[0], time.monotonic()
        self._fraction = round(fraction, 4)
        if name != self._last or now - self._told >= BETWEEN_LINES_S:
            self._last, self._told = name, now
            self._write({"stage": stage, "fraction": self._fraction})

    def found(self, level: Level) -> None:
        """Write that there is a verified pattern, at once, with its numbers as in the report: the best so far."""
        from foldcut.cli.report import level_report

        self._last = "found"
        self._write({"stage": "found", "fraction": self._fraction, "pattern": level_report(level, quick=True)})

    def _write(self, line: dict[str, object]) -> None:
        with suppress(OSError):  # nobody listens, and the pattern is wanted all the same
            print(json.dumps(line), file=self._out, flush=True)


class ProgressBar:
    """A callback ``bar(stage, fraction)`` that draws a bar; use it in a ``with`` statement."""

    def __init__(self, enabled: bool) -> None:
        self._enabled = enabled
        self._started = time.monotonic()
        self._open = ExitStack()
        self._progress: Progress | None = None
        self._found = ""

    def __enter__(self) -> ProgressBar:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._open.close()

    def found(self, level: Level) -> None:
        """Keep showing which pattern there is already: Ctrl-C would take it."""
        self._found = _so_far(level)

    def __call__(self, stage: str, fraction: float) -> None:
        """Show that ``stage`` is at work and that this ``fraction`` of the whole is done, from 0 to 1."""
        is_early = time.monotonic() - self._started < PATIENCE_S and not stage.startswith(AT_ONCE)
        if not self._enabled or is_early:
            return
        if self._progress is None:
            from rich.console import Console
            from rich.progress import Progress

            self._progress = self._open.enter_context(Progress(console=Console(stderr=True), transient=True))
            self._progress.add_task(stage, total=1.0)
        self._progress.update(self._progress.task_ids[0], description=stage + self._found, completed=fraction)


class ProgressText:
    """A callback ``text(stage, fraction)`` that writes a line every ``EVERY_S``; use it in a ``with`` statement.

    A thread writes the lines, so that there are some even while nothing new is told. It begins with the first stage:
    before that, while files are read, processes are forked, which threads do not survive.
    """

    def __init__(self, out: TextIO) -> None:
        self._out = out
        self._started = time.monotonic()
        self._stage, self._fraction, self._found = "", 0.0, ""
        self._done = threading.Event()
        self._thread: threading.Thread | None = None

    def __enter__(self) -> ProgressText:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._done.set()
        if self._thread is not None:
            self._thread.join()

    def found(self, level: Level) -> None:
        """Keep telling which pattern there is already."""
        self._found = _so_far(level)

    def __call__(self, stage: str, fraction: float) -> None:
        """Remember that ``stage`` is at work and that this ``fraction`` of the whole is done, from 0 to 1."""
        is_new = stage != self._stage
        self._stage, self._fraction = stage, fraction
        if is_new and stage.startswith(AT_ONCE):
            self._tell()
        if self._thread is None:
            self._thread = threading.Thread(target=self._tell_often, daemon=True)
            self._thread.start()

    def _tell_often(self) -> None:
        while not self._done.wait(EVERY_S):
            self._tell()

    def _tell(self) -> None:
        seconds = time.monotonic() - self._started
        line = f"foldcut: {seconds:3.0f} s, {self._fraction:3.0%}: {self._stage}{self._found}\n"
        with suppress(OSError, ValueError):  # nobody listens, and the pattern is wanted all the same
            self._out.write(line)  # all at once: two threads print
            self._out.flush()


def progress_for(console: Console) -> ProgressBar | ProgressText:
    """Return how people are told of the progress of a command: as a bar, in lines, or not at all."""
    is_terminal = sys.stderr.isatty()
    if console.tells_progress and not is_terminal and not os.environ.get(NO_PROGRESS):
        return ProgressText(sys.stderr)
    return ProgressBar(console.tells_progress and is_terminal)


def _so_far(level: Level) -> str:
    """Return which pattern there is already, in brackets."""
    off = f"{level.off_by_mm:.2g} mm off" if level.tolerance_mm else "as drawn"
    return f" ({level.folds} folds so far, {off})"
