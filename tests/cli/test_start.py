"""The command line starts at once: what it must not import, and what it uses instead of slow libraries."""

from __future__ import annotations

import json
import pydoc
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import null_space
from support.places import SAMPLES

import foldcut
from foldcut.methods.compact import lengthen
from foldcut.methods.compact import sensitivity as slopes
from foldcut.pattern import face_maps as flatfold

HEAVY = (
    "numpy",
    "scipy",
    "shapely",
    "ezdxf",
    "pydantic",
    "svgelements",
    "fontTools",
    "reportlab",
    "PIL",
    "highspy",
    "pysat",
    "rich",
)
STAR = ["make", str(SAMPLES / "star.svg"), "--effort", "fast", "--quiet"]


def loaded(folder: Path, *arguments: str) -> set[str]:
    """Return the packages that are imported by a command, in a process of its own."""
    code = "import json, sys; from foldcut.cli.main import main\n"
    code += "try: main(sys.argv[1:])\nexcept SystemExit: pass\nfinally: "
    code += "print(json.dumps(sorted({name.partition('.')[0] for name in sys.modules})))"
    done = subprocess.run(
        [sys.executable, "-c", code, *arguments], cwd=folder, capture_output=True, text=True, check=True, timeout=120
    )
    return set(json.loads(done.stdout.splitlines()[-1]))


@pytest.mark.parametrize("arguments", [["--help"], ["make", "--help"], ["batch", "--help"], ["--version"], ["samples"]])
def test_help_imports_nothing_heavy(tmp_path: Path, arguments: list[str]) -> None:
    assert loaded(tmp_path, *arguments) & set(HEAVY) == set()


def test_a_small_pattern_takes_no_scipy_and_only_its_own_formats(tmp_path: Path) -> None:
    others = {"scipy", "highspy", "reportlab", "PIL", "rich"}
    assert loaded(tmp_path, *STAR, "-o", "star.fold") & {*others, "ezdxf", "fontTools"} == set()
    dxf = loaded(tmp_path, *STAR, "-o", "star.dxf", "--profile", "laser-dxf")
    assert "ezdxf" in dxf
    assert dxf & others == set()


def test_garbage_is_looked_for_a_few_times_and_not_at_the_end(tmp_path: Path) -> None:
    code = """
import atexit, gc, sys
from foldcut.cli.main import main
def looks():
    return sum(generation["collections"] for generation in gc.get_stats())
before = looks()
atexit.register(lambda: print(looks() - before, len(gc.get_objects()), gc.get_freeze_count()))
main(sys.argv[1:])
"""
    done = subprocess.run(
        [sys.executable, "-c", code, *STAR, "-o", "star.dxf"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=True,
        timeout=120,
    )
    times, left, kept = map(int, done.stdout.split()[-3:])
    assert times <= 20, "with Python's own setting ten times as many"
    assert left < kept / 100


def test_all_public_names_are_there() -> None:
    assert all(getattr(foldcut, name) is not None for name in foldcut.__all__)
    assert dir(foldcut) == sorted(foldcut.__all__)


def test_help_starts_with_the_public_names() -> None:
    assert foldcut.__doc__ is not None
    start = foldcut.__doc__.partition(">>>")[0]
    assert [name for name in foldcut.__all__ if f"``{name}``" not in start] == []
    shown = pydoc.plain(pydoc.render_doc(foldcut))
    assert shown.index("Public names:") < shown.index("PACKAGE CONTENTS")
    assert "    fold(shape:" in shown


def test_paths_between_few_faces_are_as_short_as_scipys() -> None:
    chance = np.random.default_rng(8)
    for count in (1, 2, 30, 200):
        low, high = np.triu_indices(count, 1)
        some = chance.random(len(low)) < 6 / count
        low, high = low[some], high[some]
        cost = chance.random(len(low)) + 0.01
        ours, before = flatfold._short_paths(low, high, cost, count)
        theirs, before_theirs = flatfold._paths(low, high, cost, count)
        assert np.allclose(ours, theirs, rtol=1e-12)
        assert (before < 0).tolist() == (before_theirs < 0).tolist()


def test_full_and_sparse_matrices_have_the_same_solution() -> None:
    chance = np.random.default_rng(8)
    matrix = chance.normal(size=(90, 60)) * (chance.random((90, 60)) < 0.2) + np.eye(90, 60)
    rows, columns = matrix.nonzero()
    given = chance.normal(size=(12, 3))
    entries = (rows, columns, matrix[rows, columns])
    full, sparse = (solve(entries, matrix.shape, given) for solve in (slopes._dense, slopes._sparse))
    assert full.shape == (48, 3)
    assert np.allclose(full, sparse, rtol=1e-9, atol=1e-9)


def test_null_space_is_scipys() -> None:
    matrix = np.random.default_rng(8).normal(size=(4, 9))
    matrix[3] = matrix[0] + matrix[1]
    ours, theirs = lengthen.null_space(matrix), null_space(matrix)
    assert ours.shape == theirs.shape == (9, 6)
    assert np.allclose(ours @ ours.T, theirs @ theirs.T)
