"""Numbers and texts of profiles and of ``--set`` are finite, bounded and plain; each error is one line with a unit."""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest

from foldcut.core.errors import FileFormatError
from foldcut.core.text import is_control
from foldcut.profiles import load_profile, profile_file, profile_names

Z_PEN = ("gcode.tool='z'",)


@pytest.mark.parametrize(
    ("name", "override", "says"),
    [
        ("grbl-plotter", "gcode.pen_down=inf", "gcode.pen_down = inf: give a finite number of mm"),
        ("grbl-plotter", "gcode.pen_up=nan", "gcode.pen_up = nan: give a finite number of mm"),
        ("grbl-plotter", "gcode.pen_up=1e300", "gcode.pen_up = 1e+300: give at most 1000 mm"),
        ("hp-7475a", "hpgl.unit_mm=1e-300", "hpgl.unit_mm = 1e-300: give at least 0.001 mm"),
        ("hp-7475a", "hpgl.unit_mm=50", "hpgl.unit_mm = 50: give at most 1 mm"),
        ("hp-7475a", "papers.a4.final_x_units=99999", "papers.a4: the last place is beyond x_units and y_units"),
        ("grbl-laser", "bed.width_mm=-inf", "bed.width_mm = -inf: give a finite number of mm"),
        ("grbl-laser", "bed.width_mm=300mm", "bed.width_mm = '300mm': give a number of mm, without the unit"),
        ("grbl-laser", "gcode.most_power=1e9", "give at most 1e+06"),
        ("grbl-laser", "materials.card-160g.score.speed_mm_s=1e9", "give at most 10000 mm/s"),
        ("grbl-laser", "materials.card-160g.mountain.gap_mm=1e-9", "give at least 0.01 mm"),
        ("grbl-laser", "motion.acceleration_mm_s2=0", "give at least 1 mm/s2"),
        ("grbl-laser", "motion.travel_mm_s=inf", "give a finite number of mm/s"),
        ("grbl-laser", "kerf_mm=9", "kerf_mm = 9: give less than 5 mm"),
    ],
)
def test_a_number_out_of_bounds_is_refused_with_its_unit(name: str, override: str, says: str) -> None:
    with pytest.raises(FileFormatError, match=re.escape(says)):
        load_profile(name, (*Z_PEN, override) if "pen_" in override else (override,))


@pytest.mark.parametrize(
    ("override", "says"),
    [
        ("#x=1", "this is no key"),
        ("[a]\n#=1", "this is no key"),
        ("[" * 3000 + "=1", "this is no key"),
        ("a." * 3000 + "a=1", "a key has at most 8 parts"),
        ("bed.width_mm=" + "[" * 3000, "brackets are nested too deep"),
        ("bed.width_mm=" + "{a=" * 3000, "brackets are nested too deep"),
        ("bed.width_mm=" + "9" * 5000, "a number has thousands of digits"),
        ("bed.width_mm=0x" + "f" * 5000, "bed.width_mm = a very long number: give a number of mm"),
        ("title=a\x1b[31mb", "title has a control character"),
        ("title=a\udcffb", "title has a control character"),
        ('does.score="a\\nb"', "does.score has a control character"),
        ('operations.cut.layer="a\\u007fb"', "operations.cut.layer has a control character"),
        ('instructions=["a\\rb"]', "instructions has a control character"),
    ],
)
def test_what_no_toml_parser_takes_is_one_error(override: str, says: str) -> None:
    with pytest.raises(FileFormatError, match=re.escape(says)) as raised:
        load_profile("grbl-laser", (override,))
    assert len(str(raised.value)) < 300 or says == "this is no key"


@pytest.mark.parametrize("text", ["[" * 3000, "a=" + "[" * 3000, "a=" + "9" * 5000, "a." * 5000 + "a=1"])
def test_a_profile_file_that_no_parser_takes_is_one_error(text: str, tmp_path: Path) -> None:
    (tmp_path / "mine.toml").write_text(text)
    with pytest.raises(FileFormatError, match=r"profile .*mine\.toml"):
        load_profile(str(tmp_path / "mine.toml"))


def test_a_huge_profile_file_is_not_read(tmp_path: Path) -> None:
    with (tmp_path / "mine.toml").open("wb") as file:
        file.truncate(2**40)  # a file with a hole, which takes no room
    with pytest.raises(FileFormatError, match="more than 1 MiB"):
        load_profile(str(tmp_path / "mine.toml"))


def test_a_named_pipe_is_no_profile(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "mine.toml")
    with pytest.raises(FileFormatError, match="there is no profile file"):
        load_profile(str(tmp_path / "mine.toml"))


def test_profiles_are_found_where_nobody_knows_the_home(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("XDG_CONFIG_HOME", raising=False)
    monkeypatch.setattr(os.path, "expanduser", lambda path: path)  # as for a user without a home
    assert "grbl-laser" in profile_names()
    assert not profile_file("grbl-laser").exists()


def test_characters_that_change_a_terminal_are_told_from_letters() -> None:
    assert all(map(is_control, "\x00\x1b\x7f\x9b\n\u2028\u202e\ud800\udcff"))
    assert not any(map(is_control, "aÄß中א ‌\xa0🐟"))
