"""Profiles: the schema, errors that name the nearest key, overrides, sources, and the user's own."""

from __future__ import annotations

import re
import runpy
from pathlib import Path

import pytest
from support.places import ROOT

from foldcut.core.errors import FileFormatError
from foldcut.profiles import Profile, load_profile, parse_profile, profile_names

ASKED_FOR = {
    "laser-dxf",
    "lightburn-diode",
    "lightburn-co2",
    "glowforge",
    "xtool-d1",
    "xtool-m1",
    "xtool-s1",
    "epilog",
    "cricut-maker",
    "silhouette-cameo",
    "scanncut",
    "drag-knife",
    "axidraw-a4",
    "axidraw-a3",
    "hp-7475a",
    "hp-7550a",
    "roland-dxy",
    "grbl-plotter",
    "printer-a4",
    "printer-letter",
    "print-shop-a3",
}
MATERIALS = ["paper-80g", "card-160g", "card-300g", "polypropylene-0.5mm"]

SMALL = """
base = ["drawing", "materials", "laser"]
title = "Mine"
format = "dxf"
instructions = ["a", "b", "c"]
[bed]
width_mm = 300.0
height_mm = 200.0
[sources]
bed = "measured"
"""


def test_every_machine_has_a_profile() -> None:
    assert set(profile_names()) >= ASKED_FOR


@pytest.mark.parametrize("name", sorted(ASKED_FOR))
def test_profiles_are_complete(name: str) -> None:
    profile = load_profile(name)
    assert set(profile.operations) == {"mark", "mountain", "valley", "cut"}
    assert list(profile.materials) == MATERIALS
    assert (profile.bed is None) == bool(profile.papers)
    assert profile.stroke_mm is not None
    if profile.format == "hpgl":
        assert profile.hpgl is not None
        assert all(operation.pen for operation in profile.operations.values())
    if profile.format == "gcode":
        assert profile.gcode is not None
    if profile.kind == "laser":
        assert len({operation.colour for operation in profile.operations.values()}) == 4
        assert all(material.score and material.cut and material.perforate for material in profile.materials.values())


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("[bed]", "[operations.cut]\nlayer = 'a/b'\n[bed]"), "letters that DXF layers may not have"),
        (("width_mm", "widht_mm"), "unknown key bed.widht_mm; did you mean width_mm"),
        (("format = ", "fromat = "), "unknown key fromat; did you mean format|the key format is missing"),
        (("height_mm = 200.0", ""), "the key bed.height_mm is missing"),
        (("300.0", "-3"), "bed.width_mm = -3"),
        (("300.0", "'wide'"), "bed.width_mm = 'wide'"),
        (("300.0", "inf"), "bed.width_mm = inf"),
        (('bed = "measured"', ""), "the number bed.width_mm has no source"),
        (('"laser"]', '"lazer"]'), "there is no base 'lazer'"),
        (('title = "Mine"', 'title = = "Mine"'), "is not valid TOML"),
        (
            ("[bed]", "[operations.cut]\ncolor = '#000000'\n[bed]"),
            "unknown key operations.cut.color; did you mean colour",
        ),
        (("[bed]", "[operations.cut]\ncolour = 'red'\n[bed]"), "is no colour"),
    ],
)
def test_a_wrong_key_is_an_error_that_names_it(change: tuple[str, str], message: str) -> None:
    assert isinstance(parse_profile(SMALL, "mine"), Profile)
    broken = SMALL.replace(*change)
    assert broken != SMALL
    with pytest.raises(FileFormatError, match=message):
        parse_profile(broken, "mine")


def test_values_can_be_set() -> None:
    profile = load_profile(
        "glowforge", ["bed.width_mm=300", 'materials."polypropylene-0.5mm".cut.passes=3', "kerf_mm=0.1"]
    )
    assert profile.bed is not None
    cut = profile.materials["polypropylene-0.5mm"].cut
    assert cut is not None
    assert (profile.bed.width_mm, cut.passes, profile.kerf_mm) == (300.0, 3, 0.1)
    assert load_profile("grbl-plotter", ["gcode.tool=servo"]).gcode.tool == "servo"  # type: ignore[union-attr]
    with pytest.raises(FileFormatError, match="did you mean width_mm"):
        load_profile("glowforge", ["bed.width=300"])
    with pytest.raises(FileFormatError, match="is no KEY=VALUE"):
        load_profile("glowforge", ["bed.width_mm"])
    with pytest.raises(FileFormatError, match="^--set a b is no KEY=VALUE"):
        load_profile("glowforge", ["a\nb"])
    with pytest.raises(FileFormatError, match="this is no key"):
        load_profile("glowforge", ["bed width=3"])


def test_an_unknown_profile_is_an_error_with_the_nearest_name() -> None:
    with pytest.raises(FileFormatError, match="did you mean glowforge"):
        load_profile("glowforg")
    with pytest.raises(FileFormatError, match="no profile file"):
        load_profile("nowhere.toml")


def test_the_users_own_profiles_are_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "foldcut" / "profiles"
    folder.mkdir(parents=True)
    (folder / "mine.toml").write_text(SMALL)
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    assert "mine" in profile_names()
    assert load_profile("mine").title == "Mine"
    assert load_profile(str(folder / "mine.toml")).title == "Mine"


def test_the_page_of_machines_says_of_every_machine_what_its_profile_says() -> None:
    page = (ROOT / "docs" / "machines.md").read_text("utf-8")
    written_by = runpy.run_path(str(ROOT / "docs" / "drawings" / "machines.py"))
    assert page.partition(written_by["MARK"])[2].strip() == written_by["sections"]().strip(), "make pictures"
    for name, profile in written_by["machines"]().items():
        assert f"### {profile.title}\n\n`--profile {name}` writes" in page
        assert all(f"`{key}`: {source}" in page for key, source in profile.sources.items())
    assert set(re.findall(r"\(layers-(\w+)\.svg\)", page)) == {"laser", "cutter", "plotter", "printer"}
    assert all((ROOT / "docs" / f"layers-{kind}.svg").is_file() for kind in written_by["PICTURED"])
