"""Hostile and odd files are taken or refused as the table of cases says: no traceback, no hang, nothing left behind."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from cases.run import arguments
from cases.table import CASES
from support.programs import run_module

from foldcut.core.errors import FoldcutError
from foldcut.drawing.graph import make_graph, shapes_of
from foldcut.drawing.mend import Preparation, prepare
from foldcut.drawing.shape import invariant_faults
from foldcut.foldfile.decide import decide
from foldcut.foldfile.read import read_fold
from foldcut.readers import read_shape

LONGEST_S = 10


def test_the_command_line_takes_or_refuses_each(tmp_path: Path) -> None:
    """In one process, and in one test, so that it runs once however the tests are distributed."""
    done = run_module("cases.run", folder=tmp_path, timeout=600)
    assert (done.returncode, done.stderr) == (0, "")
    results = json.loads(done.stdout)
    assert len(CASES) >= 120
    assert results["gigabytes"] < 1
    assert {name: fault for name, result in results["cases"].items() if (fault := wrong_with(name, result))} == {}


def wrong_with(name: str, result: dict[str, Any]) -> str:
    """Return what the command line did that it should not have done; empty if nothing."""
    case, error = CASES[name], result["error"]
    one_line = error.startswith("foldcut: error: ") and error.count("\n") == 1
    left = ["out.fold"] if case.taken and not name.endswith(".fold") else []
    faults = {
        f"status {result['status']}, {error}": result["status"] not in ((0,) if case.taken else (1, 2)),
        f"printed {error!r}": bool(error) if case.taken else not one_line,
        f"does not say {case.words!r}": case.words not in (result["out"] if case.taken else error),
        f"took {result['seconds']:.1f} s": result["seconds"] >= LONGEST_S,
        f"left {result['left']}": result["left"] != left,
    }
    return "; ".join(fault for fault, found in faults.items() if found)


@pytest.mark.parametrize("name", CASES)
def test_the_library_takes_or_refuses(name: str, tmp_path: Path) -> None:
    case, path = CASES[name], tmp_path / name
    path.write_bytes(case.data)
    try:
        if name.endswith(".fold"):
            decision = decide(read_fold(path))
            said = "; ".join([decision.sentence, *map(str, decision.findings)])
            assert case.taken == decision.folds
        else:
            drawing = read_shape(path)
            changes: tuple[str, ...] = ()
            if drawing.lines:
                shape = next(make_graph((), drawing.lines).shapes())
            else:
                prepared = prepare(drawing.loops, Preparation())
                shape, changes = shapes_of(prepared.loops)[0], prepared.changes
            assert shape.is_graph or invariant_faults(shape) == []
            said = "; ".join((*drawing.notes, *drawing.ignored, *drawing.repairs, *changes))
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
