"""Many drawings, each folded in a process of its own: ``run_batch``, and the ``Recipe`` that says what to make."""

from foldcut.batch.run import Batch, run_batch
from foldcut.batch.worker import Recipe

__all__ = ["Batch", "Recipe", "run_batch"]
