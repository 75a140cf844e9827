"""What holds for every test."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator

import pytest

# As the command does: more threads than one only get into each other's way, and into the other worker's.
# It has to be said before numpy is imported.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# Tests expect nothing on stderr but errors, however slow the machine is.
os.environ["FOLDCUT_NO_PROGRESS"] = "1"

LONGEST = ("test_icons.py", "test_web.py", "test_page.py", "test_folding_steps.py", "test_batch.py")
"""Files whose tests take longest. They are begun first: no worker has a long one left when the other is done."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Put the tests that take longest first, and leave the order as it is otherwise."""
    items.sort(key=lambda item: LONGEST.index(item.path.name) if item.path.name in LONGEST else len(LONGEST))


@pytest.fixture(autouse=True)
def ctrl_c_interrupts() -> Iterator[None]:
    """Let SIGINT interrupt, here and in the processes that a test starts, where the parent of the tests ignores it."""
    before = signal.getsignal(signal.SIGINT)
    if before is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


WITH_THE_LADDER = ("batch", "cli", "redraw", "web")
"""The folders of tests in which outlines are drawn anew, as users have it."""


@pytest.fixture(autouse=True, scope="module")
def drawings_are_folded_as_they_are(request: pytest.FixtureRequest) -> Iterator[None]:
    """Draw no outline anew where tests are about something else and only need a pattern: that is faster."""
    from support.as_it_is import as_it_is

    if set(request.path.parts) & set(WITH_THE_LADDER):
        yield
        return
    with as_it_is():
        yield


@pytest.fixture(autouse=True, scope="session")
def samples_are_folded_once(tmp_path_factory: pytest.TempPathFactory) -> None:
    """Name a folder for the folded samples that all workers of this run share."""
    from support import folded

    base = tmp_path_factory.getbasetemp()
    folder = (base.parent if "PYTEST_XDIST_WORKER" in os.environ else base) / "folded"
    folder.mkdir(exist_ok=True)
    folded.SHARED[:] = [folder]
