"""Only the first step of the ladder: the drawing as it is, whose corners methods may move by hairs."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from unittest import mock

from foldcut.redraw.bounds import Bounds


@contextmanager
def as_it_is() -> Iterator[None]:
    """Fold drawings as they are in this block; no outline is drawn anew.

    ``exact=True`` is not the same: it forbids the methods to move corners by hairs, too.
    """
    with mock.patch.object(Bounds, "tolerances", return_value=(0.0,)):
        yield
