"""``foldcut compile`` fills numba's cache; where it is not filled, or cannot be, what is needed is compiled."""

from __future__ import annotations

import os
import subprocess
import sys
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from typing import Any

import pytest
from numba.core import caching

from foldcut.cli.progress import ProgressBar
from foldcut.core import compiled
from foldcut.geometry.straight_skeleton import motion, skeleton, wavefront
from foldcut.redraw import compiling

COMMAND = [sys.executable, "-c", "import sys; from foldcut.cli.main import main; sys.exit(main(['compile']))"]


def test_what_is_compiled_is_kept_for_other_processes() -> None:
    done = subprocess.run(COMMAND, capture_output=True, text=True, check=True)
    assert done.stdout.startswith("compiled in ")
    copy = compiled.compiled_copy(wavefront)
    assert compiled.is_ready(copy.run)
    assert compiled.is_ready(copy.gather_faces)
    assert compiled.is_ready(compiled.compiled_copy(motion).move)
    assert compiling.is_compiled()


SMALL = """
from foldcut.core.compiled import compiled_in
__all__ = ["twice"]
compiled = compiled_in(__name__)
@compiled
def twice(x):
    return 2.0 * x
"""


def small(folder: Path, name: str) -> Any:
    """Return the compiled copy of a module with one function."""
    file = folder / f"{name}.py"
    file.write_text(SMALL)
    spec = spec_from_file_location(name, file)
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return compiled.copy_of(module, compiled.COPY)


def test_what_was_compiled_is_read_from_the_cache(tmp_path: Path) -> None:
    first = small(tmp_path, "first_of_two").twice
    assert not compiled.is_ready(first)
    assert first(1.0) == 2.0
    assert compiled.is_ready(first)
    again = compiled.copy_of(sys.modules["first_of_two_compiled"], "").twice
    assert again is not first
    assert compiled.is_ready(again)
    assert again(1.5) == 3.0
    assert (sum(first.stats.cache_hits.values()), sum(again.stats.cache_hits.values())) == (0, 1)
    assert again(2) == 4.0, "other types are compiled"


@pytest.mark.parametrize("fault", ["no folder", "full", "gone"])
def test_where_nothing_can_be_kept_everything_is_compiled_in_memory(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, fault: str
) -> None:
    def refuse(*_: object) -> None:
        raise OSError("no space left on device")

    if fault == "no folder":
        monkeypatch.setattr(caching.CacheImpl, "_locator_classes", [])
    if fault == "full":
        monkeypatch.setattr(caching.IndexDataCacheFile, "save", refuse)
    copy = small(tmp_path, f"nothing_kept_{fault.replace(' ', '_')}")
    if fault == "gone":
        monkeypatch.setattr(caching.IndexDataCacheFile, "load", refuse)
    assert not compiled.is_ready(copy.twice)
    compiled.forget_unreadable(copy)
    assert copy.twice(1.0) == 2.0
    assert compiled.is_ready(copy.twice), "in memory"


def test_outlines_are_searched_by_what_is_compiled_ahead() -> None:
    compiling.compile_ahead()
    told: list[str] = []
    assert compiling.get_ready(told.append) == 0.0
    assert told == []


def test_what_is_not_compiled_is_said_once(monkeypatch: pytest.MonkeyPatch) -> None:
    told: list[str] = []
    monkeypatch.setattr(compiling, "is_compiled", lambda: told.count("compiled") > 0)
    monkeypatch.setattr(compiling, "compile_ahead", lambda: told.append("compiled"))
    assert compiling.get_ready(told.append) > 0.0
    assert compiling.get_ready(told.append) == 0.0
    assert told == [compiling.COMPILING, "compiled"]


def test_a_bar_tells_of_compiling_at_once(capsys: pytest.CaptureFixture[str]) -> None:
    with ProgressBar(enabled=True) as bar:
        bar("reading", 0.0)
        assert bar._progress is None
        bar(compiling.COMPILING, 0.1)
        assert bar._progress is not None
    assert capsys.readouterr().out == ""


LEFT_BEHIND = """
from pathlib import Path
from foldcut.core import compiled
from foldcut.geometry.straight_skeleton import wavefront

copy = compiled.compiled_copy(wavefront)
index = Path(copy.run._cache._cache_file._index_path)
index.parent.mkdir(parents=True, exist_ok=True)
index.write_bytes(b"not a pickle")
print(compiled.is_ready(copy.run))
compiled.forget_unreadable(copy)
print(index.exists())
"""


def test_what_an_earlier_version_left_is_not_ready_and_is_forgotten(tmp_path: Path) -> None:
    environment = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path)}
    done = subprocess.run(
        [sys.executable, "-c", LEFT_BEHIND], capture_output=True, text=True, check=True, env=environment
    )
    assert done.stdout.split() == ["False", "False"]
    assert list(tmp_path.iterdir())


def test_compiled_code_is_used_only_once_it_has_been_worth_loading() -> None:
    choice = skeleton.Default()
    assert not choice.tables().compiled
    assert not choice.is_decided
    skeleton.compile_ahead()
    choice.spent = 2 * skeleton.PATIENCE
    assert choice.tables().compiled
