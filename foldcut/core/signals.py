"""Signals that wait while something is done that must not be broken off."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

__all__ = ["HELD", "signals_wait"]

HELD = [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGALRM") if hasattr(signal, name)]
"""The signals that wait: Ctrl-C, what ends a process, and the time limit."""


@contextmanager
def signals_wait() -> Iterator[None]:
    """Let signals wait until the block is done, and then run their handlers; does nothing outside the main thread."""
    came: list[int] = []

    def remember(number: int, frame: FrameType | None) -> None:
        came.append(number)

    before = {}
    try:
        if threading.current_thread() is threading.main_thread():  # no other is interrupted by signals
            for number in HELD:
                before[number] = signal.signal(number, remember)
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        for number in came[:1]:
            signal.raise_signal(number)
