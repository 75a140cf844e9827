"""The recipe in a file: it is found again as it was, and programs that are not ours read the file all the same."""

from __future__ import annotations

import io
import json
import xml.etree.ElementTree as ET
import zipfile
from pathlib import Path

import ezdxf
import pikepdf
import pytest
from PIL import Image
from support.folded import folded_sample
from support.patterns import book_fold

from foldcut.core.errors import FileFormatError
from foldcut.exporters import JOB_EXPORTERS, PATTERN_EXPORTERS
from foldcut.exporters.bundle import zipped
from foldcut.exporters.recipe_place import NO_PLACE, PLACES, recipe_in
from foldcut.output.recipe import Recipe, read_recipe
from foldcut.output.render import JobOptions, Maker
from foldcut.profiles import load_profile

AWKWARD = 'a--b */ "c" <d> & é 折り ~!? \\ -->.svg'
RECIPE = Recipe("make", ("--sheet=a4", f"--id={AWKWARD}", "--exact"), AWKWARD, "0123456789abcdef" * 4, {"--font": "ff"})
MACHINES = {".gcode": "grbl-laser", ".lbrn2": "lightburn-diode", ".pdf": "printer-a4", ".dxf": "laser-dxf"}


def made(suffix: str, recipe: Recipe | None = RECIPE) -> bytes:
    if suffix == ".zip":
        data = zipped({"a.txt": b"a"})
        return data if recipe is None else recipe.put_into(data, "x.zip", "x.zip")
    profile = load_profile(MACHINES[suffix]) if suffix in MACHINES else None
    pattern = folded_sample("triangle") if profile else book_fold()
    return Maker(pattern, profile, JobOptions(), recipe).files(Path(f"x{suffix}"))[Path(f"x{suffix}")]


def test_every_format_has_a_place_or_a_reason() -> None:
    assert {*PLACES, *NO_PLACE} == {*PATTERN_EXPORTERS, *JOB_EXPORTERS, ".zip"}


@pytest.mark.parametrize("suffix", [suffix for suffix in PLACES if suffix != ".stl"])
def test_a_recipe_is_found_as_it_was(suffix: str) -> None:
    found = read_recipe(recipe_in(made(suffix), suffix))
    assert found == Recipe(**{**vars(RECIPE), "output": f"x{suffix}", "file": f"x{suffix}"})
    assert recipe_in(made(suffix, None), suffix) == "", "without one there is none"
    assert recipe_in(b"something else", suffix) == ""


@pytest.mark.parametrize("suffix", [".svg", ".opx", ".lbrn2"])
def test_xml_is_the_same_but_for_comments_and_notes(suffix: str) -> None:
    elements = [
        [(one.tag, one.attrib, one.text) for one in ET.fromstring(data.decode()).iter() if one.tag != "Notes"]
        for data in (made(suffix, None), made(suffix))
    ]
    assert elements[0] == elements[1]


def test_other_programs_read_files_with_recipes() -> None:
    text = made(".dxf").decode()
    assert max(map(len, text.splitlines())) < 256
    document = ezdxf.read(io.StringIO(text))
    assert len(document.modelspace()) == len(ezdxf.read(io.StringIO(made(".dxf", None).decode())).modelspace())
    assert not document.audit().errors
    lib3mf = pytest.importorskip("lib3mf")
    model = lib3mf.Wrapper().CreateModel()
    reader = model.QueryReader("3mf")
    reader.SetStrictModeActive(True)
    reader.ReadFromBuffer(bytearray(made(".3mf")))
    assert reader.GetWarningCount() == 0
    with pikepdf.open(io.BytesIO(made(".pdf"))) as pdf:
        assert pdf.docinfo["/Creator"] == "foldcut"
    with Image.open(io.BytesIO(made(".png"))) as picture, Image.open(io.BytesIO(made(".png", None))) as plain:
        assert picture.tobytes() == plain.tobytes()
    with zipfile.ZipFile(io.BytesIO(made(".zip"))) as archive:
        assert archive.testzip() is None
    assert json.loads(made(".fold"))["foldcut:recipe"]["drawing"] == AWKWARD


def test_comments_in_gcode_have_nothing_that_a_controller_obeys() -> None:
    comments = [line for line in made(".gcode").splitlines() if b"recipe" in line]
    assert len(comments) > 3
    for line in comments:
        assert len(line) < 80
        assert not set(b"!?~") & set(line), "GRBL obeys these wherever they are"


def test_stl_has_half_of_the_hash_and_as_many_bytes_as_before() -> None:
    plain, with_hash = made(".stl", None), made(".stl")
    assert plain[80:] == with_hash[80:]
    assert with_hash[:80] == b"foldcut scored sheet, mm; drawing sha256 0123456789abcdef0123456789abcdef".ljust(80)


@pytest.mark.parametrize(
    "text",
    [
        "{",
        "[]",
        "[" * 100_000,
        '{"options":"x"}',
        '{"options":[1]}',
        '{"sha256":1}',
        '{"hashes":[]}',
        '{"x":"' + "y" * 10_000 + '"}',
    ],
)
def test_a_damaged_recipe_is_an_error(text: str) -> None:
    with pytest.raises(FileFormatError, match="damaged"):
        read_recipe(text)
