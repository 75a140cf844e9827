"""The command line starts at once: what it must not import, and what it uses instead of slow libraries."""

from __future__ import annotations

import json
import pydoc
import subprocess
import sys
from pathlib import Path

import pytest
from support.places import SAMPLES

import foldcut

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
    "numba",
    "tinycss2",
    "cssselect2",
    "pikepdf",
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
    others = {"scipy", "highspy", "reportlab", "PIL", "rich", "numba"}
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
