"""One drawing of a batch, folded in a process of its own.

A ``Task``, the bytes of a drawing, and a ``Recipe`` -> an ``Outcome``: the bytes of files and numbers about the
pattern, or the reason why there is none. ``work`` does it in this process; a ``Process`` has another interpreter do it,
so that a drawing that takes too long or crashes the interpreter spoils nothing else. No file is written here.
"""

from __future__ import annotations

import hashlib
import os
import pickle
import queue
import subprocess
import sys
import threading
import time
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, BinaryIO

from foldcut.core.errors import BadInputError, FoldcutError, UnfoldableError
from foldcut.exporters.pictures.contact_sheet import Thumbnail, thumbnail
from foldcut.output.recipe import Recipe as FileRecipe
from foldcut.output.render import JobOptions, Maker
from foldcut.profiles import Profile
from foldcut.readers import ReadOptions
from foldcut.readers.apart import read_shape_apart

MADE = "made"
"""The pattern is verified, and its files are there."""

UNFOLDABLE = "unfoldable"
"""No method has a pattern for the drawing, or its creases are too short."""

BAD_INPUT = "bad-input"
"""The drawing cannot be read, or its name is too long for its files."""

TIMED_OUT = "timed-out"
"""The drawing took longer than the timeout, and its process was killed."""

CRASHED = "crashed"
"""The drawing's process died each time it was tried."""

ERROR = "error"
"""A mistake in foldcut: an exception that no stage raises on purpose."""

ATTEMPTS = 2
"""A drawing whose process dies is tried this often: the first time, something else may have been the reason."""

START = "from foldcut.batch.worker import main; main()"
"""What a process runs. Not ``-m``: classes of a module that runs as ``__main__`` cannot be unpickled elsewhere."""

ONE_THREAD = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
"""Each process uses one thread for linear algebra: the cores are busy already, and sums keep their order."""


class WorkerError(FoldcutError, RuntimeError):
    """Worker processes do not start, so no drawing can be folded."""


@dataclass(frozen=True)
class Recipe:
    """What is done to every drawing of a batch.

    ``fold``: keyword arguments of ``pipeline.fold``; ``endings``: those of the files to make, such as ``(".dxf",)``;
    ``profile`` and ``job``: the machine they are for, if any, and the options of its job; ``made``: how the files are
    made in words, which is put into them, but for the drawing.
    """

    fold: Mapping[str, Any] = field(default_factory=dict)
    reading: ReadOptions = field(default_factory=ReadOptions)
    endings: tuple[str, ...] = (".svg", ".fold")
    profile: Profile | None = None
    job: JobOptions = field(default_factory=JobOptions)
    made: FileRecipe | None = None

    @property
    def fingerprint(self) -> str:
        """A hash that is the same for equal recipes, in every process."""
        parts = (sorted(self.fold.items()), self.reading, self.endings, self.profile, self.job)
        return hashlib.sha256(repr(parts).encode()).hexdigest()


@dataclass(frozen=True)
class Task:
    """A drawing: the path of its file, its bytes, and the ``stem`` of the files made of it.

    ``letter``: the letter of a text that it is, and then it is in no file.
    """

    name: str
    stem: str
    data: bytes
    letter: str = ""


@dataclass(frozen=True)
class Outcome:
    """What came of a drawing: the ``files`` by name, or a ``status`` and an ``error`` that say why there are none.

    ``off_by_mm``: how far the outline is from the drawing; ``for_hands``: whether the pattern is for two hands;
    ``difficulty``: how difficult it is, in a few words.
    """

    status: str
    error: str = ""
    method: str = ""
    creases: int | None = None
    folds: int | None = None
    shortest_crease_mm: float | None = None
    off_by_mm: float | None = None
    for_hands: bool | None = None
    difficulty: str = ""
    seconds: float = 0.0
    files: Mapping[str, bytes] = field(default_factory=dict)
    thumbnail: Thumbnail | None = None


def work(recipe: Recipe, task: Task) -> Outcome:
    """Fold a drawing and make its files; whatever goes wrong becomes the outcome's error."""
    from foldcut import pipeline

    started = time.perf_counter()
    try:
        drawing = read_shape_apart(task.name, recipe.reading, task.data)
        result = pipeline.fold(drawing, **recipe.fold)
        pattern = result.require_verified()
        level = None if result.ladder is None else result.ladder.level
        made = recipe.made and (
            replace(recipe.made, options=(f"--text={task.letter}", *recipe.made.options))
            if task.letter
            else replace(recipe.made, drawing=Path(task.name).name, sha256=drawing.sha256)
        )
        maker = Maker(pattern, recipe.profile, recipe.job, made)
        files: dict[str, bytes] = {}
        for ending in recipe.endings:
            files |= {path.as_posix(): data for path, data in maker.files(Path(task.stem + ending)).items()}
    except UnfoldableError as error:
        return _failed(UNFOLDABLE, error, started)
    except BadInputError as error:
        return _failed(BAD_INPUT, error, started)
    except Exception as error:  # a mistake in a stage must not end the batch
        return _failed(ERROR, f"{type(error).__name__}: {error}", started)
    return Outcome(
        MADE,
        method=result.method,
        creases=result.foldability.creases,
        folds=result.folds,
        shortest_crease_mm=result.foldability.shortest_crease_mm,
        off_by_mm=None if level is None else round(level.off_by_mm, 4),
        for_hands=None if level is None else level.for_hands,
        difficulty=result.difficulty.short,
        seconds=time.perf_counter() - started,
        files=files,
        thumbnail=thumbnail(pattern),
    )


def _failed(status: str, error: object, started: float) -> Outcome:
    return Outcome(status, " ".join(str(error).split()), seconds=time.perf_counter() - started)


class Process:
    """A process that folds one drawing after another; it starts when it is needed and ends with this one."""

    def __init__(self) -> None:
        self._process: subprocess.Popen[bytes] | None = None
        self._cancelled = False

    def run(self, recipe: Recipe, task: Task, timeout: float) -> Outcome:
        """Return the outcome of a drawing; after ``timeout`` seconds its process is killed.

        Raises WorkerError: no process starts.
        """
        died = ""
        for _ in range(ATTEMPTS):
            process = self._started()
            started = time.perf_counter()
            late = threading.Event()
            timer = threading.Timer(timeout, _give_up, (process, late))
            timer.start()
            try:
                assert process.stdin is not None
                assert process.stdout is not None
                pickle.dump((recipe, task), process.stdin)
                process.stdin.flush()
                outcome: Outcome = pickle.load(process.stdout)
            except (EOFError, OSError, pickle.UnpicklingError):
                self.stop()
                died = f"its process ended with status {process.returncode}"
                if late.is_set():
                    remedy = "allow more with --timeout, or search less with --effort fast or --seconds"
                    return _failed(TIMED_OUT, f"timed out after {timeout:g} s; {remedy}", started)
                if self._cancelled:
                    break
            else:
                return outcome
            finally:
                timer.cancel()
        return _failed(CRASHED, f"{died}, {ATTEMPTS} times: a lack of memory, or a mistake in a library", started)

    def _started(self) -> subprocess.Popen[bytes]:
        """Return the process, started and ready."""
        if self._process is None or self._process.poll() is not None:
            self.stop()
            places = [place or os.getcwd() for place in sys.path]
            one = dict.fromkeys(ONE_THREAD, "1")
            self._process = subprocess.Popen(
                [sys.executable, "-P", "-c", START],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                env={**one, **os.environ, "PYTHONPATH": os.pathsep.join(places)},
                start_new_session=True,  # Ctrl-C is for this process, which then ends that one
            )
            assert self._process.stdout is not None
            try:
                pickle.load(self._process.stdout)
            except (EOFError, pickle.UnpicklingError):
                status = self._process.wait()
                if not self._cancelled:
                    raise WorkerError(
                        f"a worker process does not start (status {status}); `python -c '{START}'` shows why"
                    ) from None
        return self._process

    def cancel(self) -> None:
        """End the process at once; called by another thread than the one that is in ``run``."""
        self._cancelled = True
        if self._process is not None:
            self._process.kill()

    def stop(self) -> None:
        """End the process, wait for its end, and close its pipes."""
        if self._process is not None:
            self._process.kill()
            with self._process, suppress(OSError):
                pass


def _give_up(process: subprocess.Popen[bytes], late: threading.Event) -> None:
    late.set()
    process.kill()


_here = threading.local()


def work_apart(recipe: Recipe, task: Task, timeout: float) -> Outcome:
    """Do ``work`` in a process that this thread keeps; a cluster's workers run this."""
    if not hasattr(_here, "process"):
        _here.process = Process()
    process: Process = _here.process
    return process.run(recipe, task, timeout)


def main() -> None:
    """Answer tasks from standard input with outcomes on standard output, until there are no more.

    A thread reads standard input and ends this process as soon as the other end is gone.
    """
    answers = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())  # what a library prints must not mix with answers
    tasks: queue.SimpleQueue[tuple[Recipe, Task]] = queue.SimpleQueue()
    from foldcut import pipeline  # noqa: F401  # so that its second of imports does not count for the first drawing

    threading.Thread(target=_read_tasks, args=(sys.stdin.buffer, tasks), daemon=True).start()
    _answer(answers, None)
    while True:
        _answer(answers, work(*tasks.get()))


def _read_tasks(source: BinaryIO, tasks: queue.SimpleQueue[tuple[Recipe, Task]]) -> None:
    with suppress(EOFError, OSError, pickle.UnpicklingError):
        while True:
            tasks.put(pickle.load(source))
    os._exit(0)


def _answer(answers: BinaryIO, answer: Outcome | None) -> None:
    pickle.dump(answer, answers)
    answers.flush()
