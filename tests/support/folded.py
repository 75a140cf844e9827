"""Samples that are folded once in a run of the tests, for all tests and all worker processes."""

from __future__ import annotations

import fcntl
import io
import pickle
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from foldcut.core.arrays import sealed
from foldcut.core.model import FoldedPattern
from foldcut.pipeline import Result, fold
from foldcut.samples import sample_path
from support.as_it_is import as_it_is

SHARED: list[Path] = []
"""The folder of this run in which the workers keep what they folded; ``conftest.py`` puts it here."""


def folded_sample(name: str, sheet: str = "a4", method: str = "auto") -> FoldedPattern:
    """Return the verified pattern of a sample; raises ``VerificationError`` where verification found something."""
    return fold_sample(name, sheet, method).require_verified()


def fold_sample(name: str, sheet: str = "a4", method: str = "auto") -> Result:
    """Fold a sample as it is, with little effort and creases of any length, or return what was folded before."""
    return _fold_once(name, sheet, method)


@cache
def _fold_once(name: str, sheet: str, method: str) -> Result:
    kept = SHARED[0] / f"{name}-{sheet}-{method}.pickle"
    with kept.with_suffix(".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)  # another worker may be folding it
        if kept.exists():
            found: Result = pickle.loads(kept.read_bytes())
            return found
        with as_it_is():
            result = fold(sample_path(name), sheet, method=method, effort="fast", min_crease=0)
        kept.write_bytes(_pickled(result))
    return result


def _pickled(result: Result) -> bytes:
    data = io.BytesIO()
    _Pickler(data, pickle.HIGHEST_PROTOCOL).dump(result)
    return data.getvalue()


class _Pickler(pickle.Pickler):
    """Pickles that keep arrays read-only which are so."""

    def reducer_override(self, obj: object) -> Any:
        """Pickle a read-only array as a copy that is sealed when it is loaded."""
        if isinstance(obj, np.ndarray) and not obj.flags.writeable:
            return sealed, (obj.copy(),)
        return NotImplemented
