"""The bench runs at tiny sizes, and says what it left out."""

from __future__ import annotations

import importlib
import json
import os
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest
from support.places import ROOT, TESTS

import foldcut
from foldcut.exporters import JOB_EXPORTERS, PATTERN_EXPORTERS
from foldcut.samples import sample_path

BENCH = TESTS / "bench" / "bench.py"
SLOW = (".png", ".stl", ".3mf", ".step", "job laser-dxf")
"""What takes a second or more for any loop, and is not run here."""


def test_it_measures_stages_exporters_and_yardsticks_and_writes_three_files(tmp_path: Path) -> None:
    tree = [str(ROOT), os.environ.get("PYTHONPATH", "")]
    command = [sys.executable, str(BENCH), "--sizes", "12", "--kinds", "star", "--without", ",".join(SLOW)]
    done = subprocess.run(
        [*command, "--out", str(tmp_path)],
        capture_output=True,
        text=True,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(tree)},
    )
    assert done.returncode == 0, done.stderr
    result = json.loads((tmp_path / "bench.json").read_text())
    (row,) = result["rows"]
    found = row["items"]
    names = {name.split()[0] for name in [*found, *result["left_out"]["star"], *SLOW]}
    assert names >= {*PATTERN_EXPORTERS, *JOB_EXPORTERS, "Delaunay", "triangle", "shapely-polyskel"}
    assert [item for item in found.values() if "failed" in item] == []
    assert all(item["s"] > 0 and item["peak_mb"] > 10 for item in found.values())
    assert "failed" not in found["verify"]
    assert row["build_s"] >= row["packing_s"] > 0
    for name in {"triangle", "shapely constrained Delaunay"} & set(found):
        assert abs(found[name]["triangles"] / row["faces"] - 1) < 0.1
    assert "| whole pattern to Delaunay |" in (tmp_path / "bench.md").read_text()
    picture = ElementTree.fromstring((tmp_path / "bench.svg").read_text())
    assert len(picture.findall(".//{*}polyline")) == len(found) + 3  # packing, and the whole pattern twice


def test_exponents_are_fitted_to_large_loops_and_to_either_packing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(BENCH.parent))
    report = importlib.import_module("report")
    powers = {100: 3.0, 300: 3.0, 1000: 2.0, 3000: 2.0, 10_000: 2.0, 30_000: 2.0}
    rows = [
        {"boundary_disks": n, "compiled": n > 5000, "build_s": 1e-9 * n**power, "items": {".cp": {"s": 1e-6 * n}}}
        for n, power in powers.items()
    ]
    found = report.exponents_of(rows, ["build_s", ".cp", "triangle"])
    assert found["exponent"] == {"build_s": pytest.approx(2.0), ".cp": pytest.approx(1.0), "triangle": None}
    assert found["exponent, compiled packing"]["build_s"] == pytest.approx(2.0)
    assert report.exponents_of(rows[:2], ["build_s"])["exponent, simple packing"]["build_s"] == pytest.approx(3.0)


def test_what_would_take_longer_than_the_limit_or_failed_is_left_out_and_named(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.syspath_prepend(str(BENCH.parent))
    bench = importlib.import_module("bench")
    first = {".cp": {"s": 0.1}, ".dxf laser-dxf": {"s": 0.1}, "Delaunay": {"s": 5.0}, "triangle": {"failed": "why"}}
    second = {".cp": {"s": 0.3}, ".dxf laser-dxf": {"s": 0.9}, "Delaunay": {"s": 15.0}, "triangle": {}}
    rows = [{"size": 100, "boundary_disks": 104, "items": first}, {"size": 300, "boundary_disks": 312, "items": second}]
    reasons: dict[str, str] = {}
    assert bench.choose([], 100, list(first), 2.0, reasons) == list(first)
    assert bench.choose(rows[:1], 300, list(first), 2.0, reasons) == [".cp", ".dxf laser-dxf", "Delaunay"]
    assert reasons == {"triangle": "why, at 104 boundary disks"}
    assert bench.choose(rows, 900, list(first), 2.0, reasons) == [".cp", "Delaunay"]
    assert reasons[".dxf laser-dxf"].startswith("0.9 s at 312 boundary disks; some 8.1 s expected at 900")


def test_patterns_that_differ_in_size_only_have_the_same_hash(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(BENCH.parent))
    skeleton = importlib.import_module("skeleton")
    hashes = [
        skeleton.pattern_hash(foldcut.fold(sample_path(name), width=width, method="skeleton").folded_pattern)
        for name, width in (("arrow", 60.0), ("arrow", 87.0), ("star", 60.0))
    ]
    assert hashes[0] == hashes[1] != hashes[2]


def test_more_creases_than_in_an_earlier_record_are_told(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.syspath_prepend(str(BENCH.parent))
    skeleton = importlib.import_module("skeleton")
    (tmp_path / "before.tsv").write_text("fish\t93\t67\t0.6\t26\tverified\t1.6\nopel\t-\t-\t-\t-\tno pattern\t1.6\n")
    before = skeleton.read_record(tmp_path / "before.tsv")
    fish, opel = before["fish"]["creases"], before["opel"]["creases"]
    assert [skeleton.is_more(now, fish) for now in ("92", "93", "94", "-")] == [False, False, True, True]
    assert not any(skeleton.is_more("94", was) for was in (opel, None))
