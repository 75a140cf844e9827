"""Many drawings, each in a process of its own: ``run_batch``, and the ``Recipe`` of what is done to each."""

from foldcut.batch.run import Batch, run_batch
from foldcut.batch.worker import Recipe

__all__ = ["Batch", "Recipe", "run_batch"]
