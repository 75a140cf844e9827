"""How far the folding of a shape has come: the stages, their times, and how much of the whole is done."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

__all__ = ["Progress", "Stages"]

Progress = Callable[[str, float], None]
"""Called with a stage's name and how much of the whole is done, from 0 to 1, which never gets smaller."""


class Stages:
    """Times stages and reports them; ``seconds`` has the time of each by its name."""

    def __init__(self, progress: Progress | None = None) -> None:
        self.progress = progress
        self.seconds: dict[str, float] = {}
        self.name = ""
        self.done = self.start = self.end = self.until = 0.0

    def up_to(self, done: float) -> None:
        """End what came before, and say how much of the whole will be done when the stages that follow are over."""
        self.done, self.end = max(self.done, self.end), done

    @contextmanager
    def __call__(self, name: str, part: float = 1.0) -> Iterator[None]:
        """Time a stage; ``part`` is its share of what is left up to the end that ``up_to`` has said."""
        self.name, self.start = name, self.done
        self.until = self.start + part * (self.end - self.start)
        self.report(0.0)
        start = time.perf_counter()
        yield
        self.seconds[name] = self.seconds.get(name, 0.0) + time.perf_counter() - start
        self.report(1.0)

    def report(self, fraction: float, doing: str = "") -> None:
        """Report how much of the present stage is done, and what it is doing."""
        self.tell(f"{self.name}: {doing}" if doing else self.name, fraction)

    def tell(self, text: str, fraction: float) -> None:
        """Report how much of the present stage is done, in words of its own."""
        self.done = max(self.done, self.start + fraction * (self.until - self.start))
        if self.progress is not None:
            self.progress(text, self.done)
