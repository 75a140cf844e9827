"""The remedies that errors name work: each is tried, as it is said, on the command that the error refused."""

# ruff: noqa: E501 - a row is a line

from __future__ import annotations

import re
import shlex
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import pytest

from foldcut.cli.main import main
from foldcut.options import Options
from foldcut.pipeline import Result, fold
from foldcut.readers import Drawing

DRAWINGS = {
    "square.json": '{"loops": [[[0,0],[40,0],[40,40],[0,40]]], "units": "mm"}',
    "square.xyz": '{"loops": [[[0,0],[40,0],[40,40],[0,40]]], "units": "mm"}',
    "off.json": '{"loops": [[[0,0],[40,0],[42,40],[0,40]]], "units": "mm"}',
    "twice.json": '{"loops": [[[0,0],[40,0],[0,40]],[[0,0],[40,0],[0,40]]], "units": "mm"}',
    "touch.json": '{"loops": [[[0,0],[40,0],[40,40],[0,40]],[[40,40],[80,40],[80,80],[40,80]]], "units": "mm"}',
    "strip.json": '{"loops": [[[0,0],[40,0],[40,4],[0,4]]], "units": "mm"}',
    "open.svg": '<svg xmlns="http://www.w3.org/2000/svg" width="60mm" height="60mm" viewBox="0 0 60 60">'
    '<path d="M10 10H50V50H10V11.5" fill="none" stroke="#000" stroke-width="3"/></svg>',
    "layers.svg": '<svg xmlns="http://www.w3.org/2000/svg" width="60mm" height="60mm" viewBox="0 0 60 60">'
    '<g id="cut"><path d="M10 10H50V50Z"/></g></svg>',
}
FOLD = fold
FAST = "--effort fast"
SQUARE = f"make square.json {FAST}"

REMEDIES = [
    ("make sqare", "did you mean the sample (square)", "make {0} --effort fast"),
    ("make square --effrt fast", "did you mean (--effort)", "make square {0} fast"),
    ("mak square", "did you mean (make)", "{0} square --effort fast"),
    ("make square.xyz", "give a file that ends in .*(\\.json)", "make square.xyz --from {0} --effort fast"),
    ("make square.json --from xyz", "give --from one of .*(\\.json)", "make square.json --from {0} --effort fast"),
    ("make - < square.json", "unrecognized|give one drawing", "make square.json --effort fast"),
    ("make open.svg --effort fast", "with (--join [0-9.]+mm)", "make open.svg {0} --effort fast"),
    ("make open.svg --effort fast", "with (--strokes outline)", "make open.svg {0} --exact --effort fast"),
    ("make layers.svg --layer none", "(cut)", "make layers.svg --id {0} --effort fast"),
    ("make twice.json --strict", "leave out --strict", "make twice.json --effort fast"),
    ("make touch.json --method compact", "or give (--method skeleton)", "make touch.json {0} --effort fast"),
    ("make strip.json --min-feature 60mm", "give a smaller --min-feature", f"make strip.json --min-feature 1mm {FAST}"),
    (f"{SQUARE} --limit points=3", "allow more with (--limit points=)NUMBER", f"{SQUARE} {{0}}9"),
    (f"{SQUARE} --limit bytes=3", "allow more with (--limit bytes=)NUMBER", f"{SQUARE} {{0}}999"),
    (f"{SQUARE} --scale 100", "use (--scale fit), a larger sheet or a smaller margin", f"{SQUARE} {{0}}"),
    (f"{SQUARE} --scale 0.00001", "use (--scale fit)", f"{SQUARE} {{0}}"),
    (f"{SQUARE} --margin 200mm", "give one from 0 to below (105 mm)", f"{SQUARE} --margin 104mm --exact"),
    (f"{SQUARE} --exact --tolerance 1mm", "leave out --tolerance and --level", f"{SQUARE} --exact"),
    (f"{SQUARE} --exact --tolerance 1mm", "or --exact", f"{SQUARE} --tolerance 1mm"),
    (f"{SQUARE} --exact --simplify 1mm", "leave it out", f"{SQUARE} --simplify 1mm"),
    (f"{SQUARE} --scale 1 --width 30mm", "give one of them", f"{SQUARE} --width 30mm"),
    (f"{SQUARE} --scale 1:x", "a ratio such as (1:2)", f"{SQUARE} --scale {{0}}"),
    (f"{SQUARE} --rotate up", "give degrees such as (45)", f"{SQUARE} --rotate {{0}}"),
    (f"{SQUARE} --offset 30", "give X,Y such as (30,40)", f"{SQUARE} --offset {{0}} --scale 1"),
    (f"{SQUARE} --margin 3ells", "such as (10mm)", f"{SQUARE} --margin {{0}}"),
    (f"{SQUARE} --ribbon 500mm", "give a shorter length", f"{SQUARE} --ribbon 1mm --exact"),
    (f"{SQUARE} -o a.xyz", "use one of .fold, (.svg)", f"{SQUARE} -o a{{0}}"),
    (f"{SQUARE} -o a.gcode", "name it with (--profile grbl-laser)", f"{SQUARE} -o a.gcode {{0}}"),
    (f"{SQUARE} --material card-160g", "name it with (--profile)", f"{SQUARE} --material card-160g {{0}} laser-dxf"),
    (f"{SQUARE} --tile --profile plain", "plain is not one; see (foldcut profiles)", f"{SQUARE} --tile --profile printer-a4"),
    (f"{SQUARE} --registration pins -o a.dxf", "goes with (--two-sided)", f"{SQUARE} --registration pins -o a.dxf {{0}}"),
    (f"{SQUARE} --groove v", "give an -o that ends in (.stl)", f"{SQUARE} --groove v -o a{{0}}"),
    (f"{SQUARE} -o a.stl --folded --groove v", "leave one of them out", f"{SQUARE} -o a.stl --folded"),
    (
        f"{SQUARE} --profile laser-dxf --folded -o a.stl",
        "with (--profile scored-sheet)",
        f"{SQUARE} {{0}} --folded -o a.stl",
    ),
    (f"{SQUARE} --profile laser-dxf --sheet a0", "use (--sheet 400x600mm) or smaller", f"{SQUARE} --profile laser-dxf {{0}}"),
    (f"{SQUARE} --profile printer-a4 --sheet a2", "use (--sheet [0-9x]+mm) or smaller", f"{SQUARE} --profile printer-a4 {{0}}"),
    (f"{SQUARE} --profile printer-a4 --sheet a2", "or (--tile) on a printer", f"{SQUARE} --profile printer-a4 --sheet a2 {{0}}"),
    (f"{SQUARE} --profile hp-7475a --sheet a2", "use (--sheet a3)", f"{SQUARE} --profile hp-7475a {{0}}"),
    (f"{SQUARE} --profile hp-7475a --sheet a2", "or ([0-9x]+mm) or smaller", f"{SQUARE} --profile hp-7475a --sheet {{0}}"),
    (f"{SQUARE} --profile grbl-laser --copies 30", "use (--copies 1)", f"{SQUARE} --profile grbl-laser {{0}}"),
    (f"{SQUARE} --profile grbl-laser --at 1000,10", "use (--at 190,103) or less", f"{SQUARE} --profile grbl-laser {{0}}"),
    (f"{SQUARE} --profile printer-a4 --copies 2", "or give (--offset)", f"{SQUARE} --profile printer-a4 {{0}} 30,40 --scale 1"),
    (f"{SQUARE} --profile laser-dxf --tabs 4x30mm", "use (--tabs 4x20mm)", f"{SQUARE} --profile laser-dxf {{0}}"),
    (f"{SQUARE} --profile laser-dxf --tabs 1000x5mm", "use (--tabs [0-9]+x5mm)", f"{SQUARE} --profile laser-dxf {{0}}"),
    (f"{SQUARE} --profile cricut-maker --tabs 4x0.1mm", "use (--tabs 4x0.9mm)", f"{SQUARE} --profile cricut-maker {{0}}"),
    (f"{SQUARE} --profile axidraw-a4 --tabs 4x1mm", "leave them out", f"{SQUARE} --profile axidraw-a4"),
    (f"{SQUARE} --profile laser-dxf --frame", "or write (.gcode)", f"{SQUARE} --profile grbl-laser --frame -o a{{0}}"),
    (f"{SQUARE} --profile laser-dxf --marks x", "choose from (outline)", f"{SQUARE} --profile laser-dxf --marks {{0}}"),
    (f"{SQUARE} --profile laser-dxf --tile", "only printers take several pages", f"{SQUARE} --profile printer-a4 --tile"),
    (f"{SQUARE} --profile laser-dxf --two-sided -o a.fold", "or add (-o) NAME(.dxf)", f"{SQUARE} --profile laser-dxf --two-sided -o a.fold {{0}} b{{1}}"),
    (f"{SQUARE} --profile nosuch", "choose one of .*(laser-dxf)", f"{SQUARE} --profile {{0}}"),
    ("make --text I --font nosuch", "the nearest is (DejaVu Sans)", "make --text I --font '{0}' --exact --effort fast"),
    ("make", "give a SHAPE or a (--text)", "make {0} I --exact --effort fast"),
    ("make off.json --method simple --exact", "try (--method auto)", "make off.json {0} --effort fast"),
    ("make off.json --method mirror --exact", "use (another method)", "make off.json --effort fast"),
    ("make ring --method compact --exact", "try (--method auto)", "make ring {0} --effort fast"),
    (f"{SQUARE} --min-crease 500mm", "give a shorter length", f"{SQUARE} --min-crease 5mm"),
    (f"{SQUARE} --exact --method compact --min-crease 200mm", "only 1[0-9]+ mm .*allow it with (--min-crease [0-9.]+mm)", f"{SQUARE} --exact --method compact {{0}}"),
    (f"{SQUARE} --timeout 0.0001", "allow more with (--timeout)", f"{SQUARE} {{0}} 100"),
    (f"draw square.json {FAST} --show packing -o p.svg", "goes with (--method paper)", "draw square.json --show packing {0} -o p.svg"),
    (f"draw square.json {FAST} --show nothing", "choose from (pattern)", f"draw square.json {FAST} --show {{0}}"),
    (f"guide square.json {FAST} -o b.png", "ends in (.html)", f"guide square.json {FAST} -o b{{0}}"),
    (f"{SQUARE} --preview p.png", "that ends in (.svg)", f"{SQUARE} --preview p{{0}}"),
    ("make open.svg --join 2mm -o open.svg --force", "write to (another) name", "make open.svg --join 2mm -o {0}.svg"),
    ("batch . -o out --nest", "name it with (--profile)", "batch square.json -o out --nest {0} laser-dxf --effort fast"),
    ("profiles show nosuch", "choose one of .*(laser-dxf)", "profiles show {0}"),
]  # fmt: skip
"""What is refused; what is said, with the remedy in brackets; what then works."""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    for name, text in DRAWINGS.items():
        (tmp_path / name).write_text(text)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("foldcut.pipeline.fold", fold_once)
    return tmp_path


def fold_once(drawing: Drawing, options: Options, **_: object) -> Result:
    """Fold as ``pipeline.fold``, but what many of the commands ask for only once."""
    return _folded(Folding(drawing, options))


@dataclass(frozen=True)
class Folding:
    """A drawing, the same if its file is, and how it is folded."""

    drawing: Drawing = field(compare=False)
    options: Options
    sha256: str = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "sha256", self.drawing.sha256)


@cache
def _folded(folding: Folding) -> Result:
    return FOLD(folding.drawing, folding.options)


@pytest.mark.parametrize(("refused", "said", "works"), REMEDIES, ids=[f"{row[0]}: {row[1]}" for row in REMEDIES])
def test_what_an_error_proposes_works(
    refused: str, said: str, works: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(shlex.split(refused)) in (1, 2)
    error = capsys.readouterr().err
    found = re.search(said, error)
    assert found, error
    assert main(shlex.split(works.format(*found.groups()))) == 0, capsys.readouterr().err


def test_a_file_that_is_there_is_replaced_with_force(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    command = shlex.split(f"{SQUARE} -o a.svg")
    assert main(command) == 0
    assert main(command) == 2
    assert "replace it with --force" in capsys.readouterr().err
    assert main([*command, "--force"]) == 0
