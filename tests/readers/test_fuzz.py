"""The fuzz targets take their seeds as they are, without atheris, so that they do not rot."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from fuzz import targets
from fuzz.run import main
from fuzz.targets import TARGETS, BrokenPromiseError, Target, mend_png
from support.places import TESTS

from foldcut.core.errors import FileFormatError
from foldcut.foldfile.patterns import FORMATS
from foldcut.readers import READERS

FOLDER = TESTS / "fuzz"


@pytest.mark.parametrize("reader", TARGETS)
def test_the_seeds_are_taken_or_refused(reader: str) -> None:
    taken = [TARGETS[reader].check(seed) for seed in TARGETS[reader].seeds]
    assert any(taken), "fuzzing that begins with nothing a reader takes does not get far"


def test_every_reader_has_a_target() -> None:
    modules = {row.module.removesuffix("_loops").removesuffix("_points") for row in READERS.values()}
    others = {"text", "css", "values", *(ending[1:] for ending in FORMATS if ending != ".svg"), "creases"}
    assert modules | others == set(TARGETS)
    assert {file.stem for file in (FOLDER / "words").iterdir()} <= set(TARGETS)


def raising(error: Exception) -> Callable[[bytes], None]:
    def read(_: bytes) -> None:
        raise error

    return read


@pytest.mark.parametrize(
    ("error", "expected"),
    [
        (FileFormatError("the file is empty"), None),
        (FileFormatError("two\nlines"), BrokenPromiseError),
        (FileFormatError(" "), BrokenPromiseError),
        (KeyError("of a bug"), KeyError),
    ],
)
def test_what_is_no_documented_error_is_found(error: Exception, expected: type[Exception] | None) -> None:
    target = Target(raising(error), ())
    if expected is None:
        assert target.check(b"") is False
    else:
        with pytest.raises(expected):
            target.check(b"")


def test_a_shape_with_faults_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(targets, "invariant_faults", lambda _: ["a fault"])
    with pytest.raises(BrokenPromiseError, match="a fault"):
        TARGETS["csv"].check(b"0,0\n9,0\n0,9\n")


def test_changed_pictures_get_the_checksums_that_they_should_have() -> None:
    good = next(seed for seed in TARGETS["image"].seeds if b"pHYs" in seed)
    at = good.index(b"pHYs") + 4
    bad = good[:at] + b"\x01" + good[at + 1 :]
    assert mend_png(good) == good
    assert mend_png(bad) != bad
    assert len(mend_png(bad)) == len(bad)
    assert TARGETS["image"].check(mend_png(bad))


def test_one_file_is_tried_without_atheris(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "a").write_bytes(b"0,0\n9,0\n0,9\n")
    monkeypatch.setattr(sys, "argv", ["run.py", "csv", "--input", str(tmp_path / "a")])
    assert main() == 0
    assert capsys.readouterr().out == "taken\n"
    assert "atheris" not in sys.modules
