"""A progress bar on stderr for work that takes longer than a second.

Only for people: the command line shows it when stderr is a terminal, and clears it when the work is done.
"""

from __future__ import annotations

import time
from contextlib import ExitStack
from types import TracebackType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.progress import Progress

PATIENCE_S = 1.0
"""Work that is done sooner shows no bar."""


class ProgressBar:
    """A callback ``bar(stage, fraction)`` that draws; use it in a ``with`` statement."""

    def __init__(self, enabled: bool) -> None:
        self._enabled = enabled
        self._started = time.monotonic()
        self._open = ExitStack()
        self._progress: Progress | None = None

    def __enter__(self) -> ProgressBar:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._open.close()

    def __call__(self, stage: str, fraction: float) -> None:
        """Show that ``stage`` is done to ``fraction``, 0 to 1."""
        if not self._enabled or time.monotonic() - self._started < PATIENCE_S:
            return
        if self._progress is None:
            from rich.console import Console
            from rich.progress import Progress

            self._progress = self._open.enter_context(Progress(console=Console(stderr=True), transient=True))
            self._progress.add_task(stage, total=1.0)
        self._progress.update(self._progress.task_ids[0], description=stage, completed=fraction)
