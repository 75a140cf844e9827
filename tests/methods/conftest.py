"""Methods are tested on drawings as they are: no test of a method has its outline drawn anew."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from foldcut.redraw.bounds import Bounds


@pytest.fixture(autouse=True, scope="module")
def _as_it_is() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Bounds, "tolerances", lambda *_: (0.0,))
        yield
