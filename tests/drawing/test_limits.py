"""Drawings that are too large are refused, fast and in little memory; --timeout ends what takes too long."""

from __future__ import annotations

import json
import os
import time
from pathlib import Path

import numpy as np
import pytest
from support.patterns import square_out_of_square
from support.programs import run_module

from foldcut import pipeline
from foldcut.cli.main import main
from foldcut.core.errors import BadInputError, FileFormatError
from foldcut.drawing.limits import Limits, parse_limits

MILLION = 1_000_000


def circle(count: int) -> list[str]:
    """Return so many points, written as SVG and WKT write them."""
    angles = np.linspace(0, 2 * np.pi, count, endpoint=False)
    return [f"{x:.4f} {y:.4f}" for x, y in zip(100 * np.cos(angles), 100 * np.sin(angles), strict=True)]


@pytest.mark.parametrize("suffix", [".svg", ".wkt", ".json"])
def test_a_million_points_are_refused_within_10_s_and_1_gb(suffix: str, tmp_path: Path) -> None:
    points = circle(MILLION)
    text = {
        ".svg": lambda: f'<svg xmlns="http://www.w3.org/2000/svg"><path d="M{"L".join(points)}Z"/></svg>',
        ".wkt": lambda: f"POLYGON(({','.join(points)},{points[0]}))",
        ".json": lambda: f'{{"loops":[[[{"],[".join(points).replace(" ", ",")}]]]}}',
    }[suffix]()
    path = tmp_path / f"large{suffix}"
    path.write_text(text)
    started = time.monotonic()
    done = run_module("support.measured", "make", str(path), "-o", "out.svg", folder=tmp_path, timeout=60)
    assert time.monotonic() - started < 10
    assert int(done.stdout) < 1e9
    assert done.returncode == 2
    assert "the file has about 1,000,00" in done.stderr
    assert "and at most 100,000 are allowed; simplify it, or allow more with --limit points=NUMBER" in done.stderr
    assert [path.name for path in tmp_path.iterdir()] == [f"large{suffix}"]


@pytest.mark.parametrize("text", [".5" * 900, "5 " * 900, "H1V2" * 300, "1e5-2,"[:6] * 300])
def test_numbers_are_counted_however_they_are_written(text: str) -> None:
    with pytest.raises(FileFormatError, match=r"about \d+ points, and at most 100 are"):
        Limits(points=100).check_numbers(text.encode())


def test_an_embedded_image_has_no_points() -> None:
    data = b'<svg><image href="data:image/png;base64,' + b"a1b2" * 1000 + b'"/></svg>'
    Limits(points=100).check_numbers(data)
    with pytest.raises(FileFormatError):
        Limits(points=100).check_numbers(data.replace(b"base64", b""))


def test_limits_are_options(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    square = [[0, 0], [40, 0], [40, 40], [0, 40]]
    path = tmp_path / "box.json"
    path.write_text(json.dumps({"loops": [square]}))
    for limit, fault in (
        ("bytes=10", "bytes, and at most 10 are"),
        ("points=3", "has about 4 points, and at most 3 are"),
    ):
        assert main(["make", str(path), "--limit", limit]) == 2
        assert fault in capsys.readouterr().err
    with pytest.raises(FileFormatError, match="the drawing has 2 loops, and at most 1 are allowed; draw fewer"):
        Limits(loops=1).check_loops([square, square])
    for text in ("points", "points=0", "points=-1", "points=1.5", "points=1e99", "points=1e-3", "points=inf"):
        with pytest.raises(BadInputError, match="give a whole number from 1 up, such as points=5000 or points=1e6"):
            parse_limits([text])
    with pytest.raises(BadInputError, match="is not a limit; give NAME=NUMBER"):
        parse_limits(["pints=3"])
    assert parse_limits(["points=1e9", "loops=2.5e2"]) == Limits(points=10**9, loops=250)
    assert parse_limits(["points=7", "loops=8", "nesting=9"]) == Limits(points=7, loops=8, nesting=9)
    with pytest.raises(BadInputError, match="a nesting of 501 is too deep; give at most 500"):
        parse_limits(["nesting=501"])


def test_a_timeout_ends_the_search_and_writes_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    started = time.monotonic()
    assert main(["make", "swan", "--method", "compact", "--effort", "best", "--timeout", "0.5"]) == 1
    assert time.monotonic() - started < 5
    error = capsys.readouterr().err
    assert error.startswith("foldcut: error: timed out after 0.5 s, no file is half-written; allow more with --timeout")
    assert error.count("\n") == 1
    assert error.endswith("or search less with --effort fast or --seconds\n")
    assert os.listdir() == []
    for seconds in ("0", "-1", "nan", "inf"):
        assert main(["make", "swan", f"--timeout={seconds}"]) == 2
        assert "give a positive number" in capsys.readouterr().err


def test_a_command_that_is_done_in_time_is_not_stopped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    pattern = square_out_of_square()
    Path("box.json").write_text(json.dumps({"loops": [pattern.shape.loops[0].tolist()]}))
    made = pipeline.fold("box.json", "60x60", effort="fast")
    monkeypatch.setattr(pipeline, "fold", lambda *_, **__: made)
    assert main(["make", "box.json", "-o", "box.fold", "--quiet", "--timeout", "1"]) == 0
    assert main(["check", "box.fold", "--quiet", "--timeout", "1"]) == 0
    time.sleep(1.1)  # the clock does not go on
