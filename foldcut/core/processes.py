"""What processes that this one starts have to do so that none of them outlives it."""

from __future__ import annotations

import contextlib
import signal
import sys

_DEATH_SIGNAL = 1
"""The option of Linux's ``prctl`` that says which signal a process gets when its parent ends."""


def die_with_parent() -> None:
    """Have this process killed when the one that started it ends, however that ends; does nothing but on Linux."""
    if sys.platform != "linux":
        return
    import ctypes

    with contextlib.suppress(OSError, AttributeError):
        ctypes.CDLL(None).prctl(_DEATH_SIGNAL, signal.SIGKILL, 0, 0, 0)
