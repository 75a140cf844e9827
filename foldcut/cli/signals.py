"""Signals and the time limit, as exceptions that unwind the stack so that temporary files are removed.

While a module is imported they wait: one that is broken off stays half there, and what needs it then fails in odd ways.
An exception that is lost since it came in a finaliser or in a callback is raised once more.
"""

from __future__ import annotations

import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any, NoReturn

from foldcut.core.errors import BadInputError

REPEAT_S = 1.0
"""The alarm of the time limit rings again after so long: an exception that is raised in a finaliser is lost."""


AGAIN_S = 0.01
"""A signal that could not be followed comes again after this much time of the processor."""

Handler = Callable[[int, FrameType | None], Any]


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
        raise BadInputError(f"--timeout is {seconds:g} s; give a positive number below 1e8")
    if not hasattr(signal, "setitimer"):
        raise BadInputError("--timeout does not work on this system; leave it out")

    def raise_timed_out(number: int, frame: FrameType | None) -> NoReturn:
        raise TimedOut(seconds)

    before = signal.signal(signal.SIGALRM, after_imports(raise_timed_out))
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

    lost = {KeyboardInterrupt: signal.SIGINT, Terminated: signal.SIGTERM}
    tell = sys.unraisablehook

    def raise_again(ignored: Any) -> None:
        if issubclass(ignored.exc_type, tuple(lost)):
            _come_again(lost[ignored.exc_type])
        elif not issubclass(ignored.exc_type, TimedOut):  # which comes again by itself
            tell(ignored)

    handlers: dict[signal.Signals, Any] = {signal.SIGTERM: after_imports(raise_terminated)}
    if signal.getsignal(signal.SIGINT) in (signal.SIG_IGN, signal.default_int_handler):
        handlers[signal.SIGINT] = after_imports(signal.default_int_handler)
    if hasattr(signal, "setitimer"):
        handlers[signal.SIGVTALRM] = _follow_waiting
    before: dict[signal.Signals, Any] = {}
    _raised.clear()
    try:
        for number, handler in handlers.items():
            before[number] = signal.signal(number, handler)
    except ValueError:  # not the main thread
        yield
        return
    try:
        sys.unraisablehook = raise_again
        yield
    finally:
        sys.unraisablehook = tell
        if hasattr(signal, "setitimer"):
            signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)  # before its handler goes: by itself it ends the process
        _waiting.clear()
        for number, handler in before.items():
            signal.signal(number, signal.SIG_DFL if handler is None else handler)


def after_imports(handler: Handler) -> Handler:
    """Return a handler that waits until no module is being imported."""

    def handle(number: int, frame: FrameType | None) -> None:
        if hasattr(signal, "setitimer") and _is_importing(frame):
            _come_again(number)
            return
        try:
            handler(number, frame)
        except BaseException as error:
            _raised[:] = [error]
            raise

    return handle


@contextmanager
def deaf() -> Iterator[None]:
    """Ignore Ctrl-C in the block."""
    try:
        before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    except ValueError:  # not the main thread
        yield
        return
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def last_raised() -> BaseException | None:
    """Return what a signal last raised, if anything: compiled libraries make other errors of it, without its cause."""
    return _raised[0] if _raised else None


_raised: list[BaseException] = []
"""What a signal last raised."""
_waiting: set[int] = set()
"""The signals that came at a bad moment. Handlers have no other place to keep them."""


def _come_again(number: int) -> None:
    """Have a signal come again. The timer is one that nothing else uses, and needs no thread."""
    _waiting.add(number)
    signal.setitimer(signal.ITIMER_VIRTUAL, AGAIN_S)


def _follow_waiting(number: int, frame: FrameType | None) -> None:
    """Follow a signal that came at a bad moment."""
    if _waiting:
        signal.raise_signal(_waiting.pop())
    if _waiting:
        signal.setitimer(signal.ITIMER_VIRTUAL, AGAIN_S)


def _is_importing(frame: FrameType | None) -> bool:
    """Whether a module is being imported where a signal came."""
    while frame is not None:
        if frame.f_code.co_filename.startswith("<frozen importlib"):
            return True
        frame = frame.f_back
    return False
