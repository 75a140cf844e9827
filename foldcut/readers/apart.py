"""Read a file in a process of its own, which may take so much processor time and memory and no more.

A function without arguments -> what it returns, or the error that it raises. Libraries that read files can be made to
take hours and all memory by a small file, and no exception gets into compiled code. So the command line has files read
in a copy of its process (``fork``, which takes a few ms), with limits that the system keeps. This process only waits:
Ctrl-C and a time limit get through at once, and then the other process is killed. Where there is no ``fork``, the
function is called here.
"""

from __future__ import annotations

import contextlib
import faulthandler
import os
import pickle
import signal
import struct
import traceback
import warnings
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any, NoReturn, TypeVar

from foldcut.core.errors import FileFormatError
from foldcut.core.processes import die_with_parent
from foldcut.core.signals import HELD
from foldcut.drawing.limits import Limits
from foldcut.readers import READERS, Drawing, ReadOptions, read_shape

__all__ = ["apart", "read_shape_apart"]

Result = TypeVar("Result")

LARGEST = 2**62
"""The largest limit that the system takes, beside none at all."""


def read_shape_apart(path: str | Path, options: ReadOptions, data: bytes | None = None) -> Drawing:
    """Do as ``read_shape``, in a process of its own that takes no more than ``options.limits`` allow."""
    suffix = f".{options.suffix.removeprefix('.')}" if options.suffix else Path(path).suffix
    if reader := READERS.get(suffix.lower()):
        import_module(f"foldcut.readers.{reader.module}")  # here: what comes later may need the same libraries
    return apart(lambda: read_shape(path, options, data), options.limits, str(path))


def apart(work: Callable[[], Result], limits: Limits, name: str, *, option: bool = True) -> Result:
    """Return what ``work`` returns, or raise what it raises; ``name``: of the file that it reads, for errors.

    ``option``: the limits can be changed by ``--limit``, so errors say so. Raises ``FileFormatError`` if it takes more
    time or memory than ``limits`` allow, or crashes. Arrays in the result are read-only.
    """
    if not hasattr(os, "fork"):
        return work()
    reading, writing = os.pipe()
    child = 0
    try:
        held = signal.pthread_sigmask(signal.SIG_BLOCK, HELD)  # Ctrl-C must not unwind both processes
        try:
            with warnings.catch_warnings(action="ignore"):  # of other threads, which hold nothing that a reader needs
                child = os.fork()
            if not child:
                _answer(work, limits, writing)
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, held)
        os.close(writing)
        with os.fdopen(reading, "rb") as answers:
            answer = answers.read()
        _, status = os.waitpid(child, 0)
        child = 0
    finally:
        if child:
            with contextlib.suppress(ProcessLookupError, ChildProcessError):
                os.kill(child, signal.SIGKILL)
                os.waitpid(child, 0)
    if os.waitstatus_to_exitcode(status) != 0:
        raise FileFormatError(f"{name}: {_reason(os.waitstatus_to_exitcode(status), limits, option=option)}")
    value, error = _unpacked(answer)
    if error is not None:
        raise error
    result: Result = value
    return result


def _reason(status: int, limits: Limits, *, option: bool) -> str:
    """Return why a process ended that was killed."""
    if status == -signal.SIGXCPU:
        what, name = f"reading it takes more than {limits.seconds:,} s of the processor", "seconds"
    else:
        what = f"reading it takes more than {limits.megabytes:,} MB of memory, or the library that reads it crashed"
        name = "megabytes"
    return f"{what}; give a simpler one{f', or allow more with --limit {name}=NUMBER' if option else ''}"


def _answer(work: Callable[[], object], limits: Limits, to: int) -> NoReturn:
    """Do the work in this process, a copy of the other one, write what comes of it, and end."""
    status = 1
    try:
        for number in HELD:
            signal.signal(number, signal.SIG_DFL)
        signal.pthread_sigmask(signal.SIG_UNBLOCK, HELD)
        faulthandler.disable()  # the other process says that this one crashed
        die_with_parent()
        _bound(limits)
        try:
            packed = _packed((work(), None))
        except MemoryError:
            os._exit(status)
        except Exception as error:  # raised again in the other process
            told = traceback.format_exc()
            try:
                packed = _packed((None, error))
                _unpacked(packed)
            except Exception:  # an error that cannot be copied
                packed = _packed((None, RuntimeError(told)))
        with os.fdopen(to, "wb") as answers:
            answers.write(packed)
        status = 0
    finally:
        os._exit(status)


def _packed(value: object) -> bytes:
    """Return a value as bytes; arrays apart from the rest, so that they come back read-only."""
    arrays: list[pickle.PickleBuffer] = []
    rest = pickle.dumps(value, protocol=5, buffer_callback=arrays.append)
    parts = [rest, *(array.raw().tobytes() for array in arrays)]
    return struct.pack(f"<Q{len(parts)}Q", len(parts), *map(len, parts)) + b"".join(parts)


def _unpacked(data: bytes) -> tuple[Any, Exception | None]:
    (count,) = struct.unpack_from("<Q", data)
    sizes = struct.unpack_from(f"<{count}Q", data, 8)
    parts, at = [], 8 * (count + 1)
    for size in sizes:
        parts.append(data[at : at + size])
        at += size
    result: tuple[Any, Exception | None] = pickle.loads(parts[0], buffers=parts[1:])
    return result


def _bound(limits: Limits) -> None:
    """Let this process take no more processor time and memory than ``limits`` allow, where the system can do that."""
    with contextlib.suppress(ImportError, AttributeError, OSError, ValueError):
        import resource

        _lower(resource.RLIMIT_CPU, limits.seconds)
        _lower(resource.RLIMIT_CORE, 0)
        size, resident = (
            int(pages) * resource.getpagesize() for pages in Path("/proc/self/statm").read_text().split()[:2]
        )
        _lower(resource.RLIMIT_AS, size - resident + limits.megabytes * 2**20)


def _lower(kind: int, most: int) -> None:
    import resource

    _, highest = resource.getrlimit(kind)
    most = min(most, LARGEST if highest == resource.RLIM_INFINITY else highest)
    resource.setrlimit(kind, (most, highest))
