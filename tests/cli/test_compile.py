"""``foldcut compile`` fills numba's cache, and says what is missing."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from foldcut.core import compiled
from foldcut.geometry.straight_skeleton import motion, skeleton, wavefront

COMMAND = [sys.executable, "-c", "import sys; from foldcut.cli.main import main; sys.exit(main(['compile']))"]


def test_what_is_compiled_is_kept_for_other_processes() -> None:
    done = subprocess.run(COMMAND, capture_output=True, text=True, check=True)
    assert done.stdout.startswith("compiled in ")
    copy = compiled.compiled_copy(wavefront)
    assert compiled.is_ready(copy.run)
    assert compiled.is_ready(copy.gather_faces)
    assert compiled.is_ready(compiled.compiled_copy(motion).move)


def test_without_numba_the_extra_is_named(tmp_path: Path) -> None:
    (tmp_path / "numba.py").write_text("raise ImportError('no numba')")
    code = f"import sys; sys.path.insert(0, {str(tmp_path)!r}); " + COMMAND[-1]
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 2
    assert "pip install 'foldcut[fast]'" in done.stderr
    assert "Traceback" not in done.stderr


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
