"""Hostile and odd files are taken or refused as the table of cases says: no traceback, no hang, nothing left behind."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from cases.run import arguments
from cases.table import CASES

from foldcut.errors import FoldcutError
from foldcut.prepare import Preparation, prepare
from foldcut.readers import read_shape
from foldcut.readers.fold import read_fold
from foldcut.shape import invariant_faults, make_shape
from foldcut.verify import verify

TESTS = Path(__file__).parent
LONGEST_S = 10


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """Return what the command line made of every case, all in one process."""
    paths = os.pathsep.join([str(TESTS), *filter(None, [os.environ.get("PYTHONPATH")])])
    done = subprocess.run(
        [sys.executable, "-m", "cases.run"],
        cwd=tmp_path_factory.mktemp("cases"),
        env={**os.environ, "PYTHONPATH": paths},
        capture_output=True,
        text=True,
        check=True,
        timeout=600,
    )
    assert done.stderr == ""
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def test_there_are_enough_cases_and_they_take_little_memory(results: dict[str, Any]) -> None:
    assert len(CASES) >= 120
    assert results["gigabytes"] < 1


@pytest.mark.parametrize("name", CASES)
def test_the_command_line_takes_or_refuses(name: str, results: dict[str, Any]) -> None:
    case, result = CASES[name], results["cases"][name]
    assert result["seconds"] < LONGEST_S
    if case.taken:
        assert (result["status"], result["error"]) == (0, "")
        assert case.words in result["out"]
        assert result["left"] == ([] if name.endswith(".fold") else ["out.fold"])
    else:
        assert result["status"] in (1, 2)
        assert result["error"].startswith("foldcut: error: ")
        assert result["error"].count("\n") == 1
        assert case.words in result["error"]
        assert result["left"] == []


@pytest.mark.parametrize("name", CASES)
def test_the_library_takes_or_refuses(name: str, tmp_path: Path) -> None:
    case, path = CASES[name], tmp_path / name
    path.write_bytes(case.data)
    try:
        if name.endswith(".fold"):
            read = read_fold(path)
            said = "; ".join(map(str, verify(read.pattern, read.layers)))
            assert case.taken == (not said)
        else:
            drawing = read_shape(path)
            prepared = prepare(drawing.loops, Preparation())
            assert invariant_faults(make_shape(prepared.loops)) == []
            said = "; ".join((*drawing.notes, *prepared.changes))
            assert case.taken
    except FoldcutError as error:
        said = str(error)
        assert not case.taken, said
    assert case.words in said
    assert [left.name for left in tmp_path.iterdir()] == [name]


@pytest.mark.parametrize("name", ["box.svg", "laughs.svg", "deep.json", "no-layers.fold"])
def test_a_process_of_its_own_does_the_same(name: str, tmp_path: Path) -> None:
    case = CASES[name]
    (tmp_path / name).write_bytes(case.data)
    command = [sys.executable, "-m", "foldcut.cli", *arguments(name)]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=LONGEST_S, check=False)
    assert (done.returncode == 0) == case.taken
    assert "Traceback" not in done.stderr
    assert case.words in (done.stdout if case.taken else done.stderr)
