"""The work of a batch on the cores of this machine: a process for each, which folds one drawing after the other."""

from __future__ import annotations

import queue
import threading
from collections.abc import Generator, Sequence

from foldcut.batch.drawings import Item
from foldcut.batch.worker import BAD_INPUT, Outcome, Process, Recipe

Outcomes = Generator[tuple[Item, str, Outcome], None, None]
"""Drawings as they are done, each with the hash of its bytes and its outcome."""


def work_on_cores(items: Sequence[Item], recipe: Recipe, timeout: float, jobs: int) -> Outcomes:
    """Yield the outcome of each drawing, in the order they are done, from ``jobs`` processes.

    A thread waits for each process. Closing the generator ends them all. Raises WorkerError: no process starts.
    """
    waiting: queue.SimpleQueue[Item] = queue.SimpleQueue()
    for item in items:
        waiting.put(item)
    done: queue.SimpleQueue[tuple[Item, str, Outcome] | BaseException] = queue.SimpleQueue()
    processes = [Process() for _ in range(jobs)]
    stopped = threading.Event()

    def serve(process: Process) -> None:
        try:
            while not stopped.is_set():
                item = waiting.get_nowait()
                task, digest, error = item.read(recipe.reading.limits.bytes)
                outcome = Outcome(BAD_INPUT, error) if task is None else process.run(recipe, task, timeout)
                done.put((item, digest, outcome))
        except queue.Empty:
            pass
        except BaseException as error:  # the thread that waits for outcomes raises it
            done.put(error)
        finally:
            process.stop()

    threads = [threading.Thread(target=serve, args=(process,), daemon=True) for process in processes]
    for thread in threads:
        thread.start()
    try:
        for _ in items:
            came = done.get()
            if isinstance(came, BaseException):
                raise came
            yield came
    finally:
        stopped.set()
        for process in processes:
            process.cancel()
        for thread in threads:
            thread.join()
