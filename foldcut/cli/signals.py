"""Signals and the time limit, as exceptions that unwind the stack so that temporary files are removed."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any, NoReturn

from foldcut.core.errors import BadInputError

REPEAT_S = 1.0
"""The alarm of the time limit rings again after so long: an exception that is raised in a finaliser is lost."""


class Terminated(BaseException):
    """SIGTERM arrived."""


class TimedOut(BaseException):
    """The time limit has passed. Unlike Ctrl-C, it does not leave the search with the best pattern found so far."""

    def __init__(self, seconds: float) -> None:
        super().__init__(seconds)
        self.seconds = seconds


@contextmanager
def time_limit(seconds: float | None) -> Iterator[None]:
    """Raise ``TimedOut`` in the block after this many seconds; None is no limit."""
    if seconds is None:
        yield
        return
    if not 0 < seconds < 1e8:
        raise BadInputError(f"--timeout is {seconds} s; give a positive number")
    if not hasattr(signal, "setitimer"):
        raise BadInputError("--timeout does not work on this system; leave it out")

    def raise_timed_out(number: int, frame: FrameType | None) -> NoReturn:
        raise TimedOut(seconds)

    before = signal.signal(signal.SIGALRM, raise_timed_out)
    try:
        signal.setitimer(signal.ITIMER_REAL, seconds, REPEAT_S)
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


@contextmanager
def signals_raise() -> Iterator[None]:
    """Let SIGTERM unwind the stack as Ctrl-C does, and let Ctrl-C do so even where the parent ignores it.

    A shell without job control starts its background processes with SIGINT ignored.
    """

    def raise_terminated(number: int, frame: FrameType | None) -> NoReturn:
        raise Terminated

    handlers: dict[signal.Signals, Any] = {signal.SIGTERM: raise_terminated}
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        handlers[signal.SIGINT] = signal.default_int_handler
    try:
        before = {number: signal.signal(number, handler) for number, handler in handlers.items()}
    except ValueError:  # not the main thread
        yield
        return
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
