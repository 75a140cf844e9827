"""Files are read in a process of their own: what takes too long or too much is refused in one line."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from foldcut.cli.main import main
from foldcut.core.errors import BadInputError, FileFormatError
from foldcut.drawing.limits import Limits
from foldcut.foldfile.read import read_fold, read_fold_apart
from foldcut.readers import ReadOptions, read_shape
from foldcut.readers.apart import apart, read_shape_apart
from foldcut.samples import sample_path

SMALL = Limits(seconds=1, megabytes=200)
GOLDEN = Path(__file__).parent.parent / "golden"


def fail() -> None:
    raise BadInputError("it is bad")


def compiled_loop() -> int:
    return sum(range(10**12))  # in C: no exception gets into it


def test_the_result_is_the_same_and_its_arrays_are_read_only() -> None:
    path = sample_path("letter-a")
    one, other = read_shape(path), read_shape_apart(path, ReadOptions())
    assert all(np.array_equal(a, b) for a, b in zip(one.loops, other.loops, strict=True))
    assert (one.title, one.unit_mm, one.notes) == (other.title, other.unit_mm, other.notes)
    assert not any(loop.flags.writeable for loop in other.loops)
    pattern = read_fold_apart(GOLDEN / "book.fold").pattern
    assert np.array_equal(pattern.vertices_coords, read_fold(GOLDEN / "book.fold").pattern.vertices_coords)
    assert not pattern.vertices_coords.flags.writeable


@pytest.mark.parametrize(
    ("work", "message"),
    [
        (compiled_loop, "more than 1 s of the processor; give a simpler one, or allow more with --limit seconds="),
        (lambda: np.ones(10**8), "more than 200 MB of memory, or the library that reads it crashed"),
        (os.abort, "the library that reads it crashed; give a simpler one, or allow more with --limit megabytes="),
        (lambda: os.kill(os.getpid(), signal.SIGSEGV), "the library that reads it crashed"),
        (fail, "^it is bad$"),
    ],
)
def test_what_goes_wrong_is_an_error_of_one_line(work: Callable[[], object], message: str) -> None:
    with pytest.raises(BadInputError, match=message) as caught:
        apart(work, SMALL, "a.pdf")
    assert "\n" not in str(caught.value)


def test_a_mistake_keeps_its_kind() -> None:
    with pytest.raises(ZeroDivisionError):
        apart(lambda: 1 / 0, SMALL, "a.pdf")


def test_the_limits_are_options(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "a.json"
    path.write_text('{"loops": [' + ",".join(["[]"] * 3_000_000) + "]}")
    assert main(["make", str(path), "-o", str(tmp_path / "a.svg"), "--limit", "megabytes=100"]) == 2
    assert "takes more memory than there is" in (error := capsys.readouterr().err) or "100 MB of memory" in error
    assert main(["make", str(path), "-o", str(tmp_path / "a.svg"), "--limit", "megabytes=999999999999999"]) == 2
    assert "loops[0] is not a list of points" in capsys.readouterr().err


def test_a_fold_file_has_no_such_option_and_no_remedy_that_does_not_work(tmp_path: Path) -> None:
    path = tmp_path / "a.fold"
    path.write_text('{"a": [' + ",".join(['{"b":0}'] * 2_400_000) + "]}")
    with pytest.raises(
        FileFormatError, match="MB of memory, or the library that reads it crashed; give a simpler one$"
    ):
        apart(lambda: read_fold(path), Limits(megabytes=150), str(path), option=False)


READS_FOREVER = """
import sys
from foldcut.cli.main import main
from foldcut.readers import svg
svg.read = lambda *_: sum(range(10**12))
sys.exit(main(["make", "swan", "-o", "a.svg", *sys.argv[1:]]))
"""


def test_a_time_limit_holds_while_compiled_code_reads(tmp_path: Path) -> None:
    started = time.monotonic()
    done = subprocess.run(
        [sys.executable, "-c", READS_FOREVER, "--timeout", "2"], cwd=tmp_path, capture_output=True, text=True
    )
    assert "timed out after 2 s, no file is half-written" in done.stderr
    assert done.returncode == 1
    assert time.monotonic() - started < 9  # two, and the imports of a busy machine
    assert not list(tmp_path.iterdir())


@pytest.mark.skipif(sys.platform != "linux", reason="Linux tells a process that its parent ended")
def test_the_process_that_reads_ends_with_the_one_that_started_it(tmp_path: Path) -> None:
    with subprocess.Popen([sys.executable, "-c", READS_FOREVER], cwd=tmp_path) as started:
        for _ in range(200):
            children = Path(f"/proc/{started.pid}/task/{started.pid}/children").read_text().split()
            if children:
                break
            time.sleep(0.05)
        assert children
        time.sleep(0.3)
        started.kill()
    for _ in range(100):
        if not Path(f"/proc/{children[0]}").exists():
            return
        time.sleep(0.05)
    raise AssertionError("it goes on")
