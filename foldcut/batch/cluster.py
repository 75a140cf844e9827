"""The work of a batch on a dask cluster, whose workers need foldcut with the extra ``batch``."""

from __future__ import annotations

from collections.abc import Sequence
from types import ModuleType
from typing import Any

from foldcut.batch.cores import Outcomes
from foldcut.batch.drawings import Item
from foldcut.batch.worker import BAD_INPUT, CRASHED, Outcome, Recipe, work_apart
from foldcut.core.errors import FoldcutError

AHEAD = 500
"""The cluster is given this many drawings ahead, so that its workers never wait and it never holds them all."""


class ClusterError(FoldcutError, RuntimeError):
    """The cluster is out of reach."""


def work_on_cluster(dask: ModuleType, address: str, items: Sequence[Item], recipe: Recipe, timeout: float) -> Outcomes:
    """Yield the outcome of each drawing from the workers of a cluster; a lost worker's drawings go to another.

    ``dask``: the module ``distributed``; ``address``: the scheduler's. Raises ClusterError: it does not answer.
    """
    try:
        client = dask.Client(address, timeout="20s", set_as_default=False)
    except (OSError, ValueError) as error:  # dask raises ValueError for an address it cannot parse
        raise ClusterError(
            f"the scheduler {address} does not answer ({error}); start one with `dask scheduler`"
        ) from None
    with client:
        waiting = iter(items)
        known: dict[Any, tuple[Item, str]] = {}
        futures = dask.as_completed(loop=client.loop)

        def submit() -> Outcomes:
            """Give the cluster the next drawing; yield those that cannot even be read."""
            for item in waiting:
                task, digest, error = item.read(recipe.reading.limits.bytes)
                if task is None:
                    yield item, digest, Outcome(BAD_INPUT, error)
                    continue
                future = client.submit(work_apart, recipe, task, timeout, pure=False)
                known[future.key] = (item, digest)
                futures.add(future)
                return

        for _ in range(AHEAD):
            yield from submit()
        for future in futures:
            item, digest = known.pop(future.key)
            yield item, digest, _outcome_of(future)
            yield from submit()


def _outcome_of(future: Any) -> Outcome:
    """Return the outcome that a cluster has for a drawing; raise an error that ends the batch."""
    error = future.exception()
    if error is None:
        outcome: Outcome = future.result()
        return outcome
    if type(error).__name__ == "KilledWorker":
        return Outcome(CRASHED, "every worker that had this drawing was lost")
    raise error
