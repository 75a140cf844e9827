"""The table of commands, and the options that commands share."""

from __future__ import annotations

import json
import pkgutil
import subprocess
import sys
from argparse import Namespace
from dataclasses import replace
from pathlib import Path

import pytest

from foldcut.cli import commands, options
from foldcut.cli.commands import COMMANDS, load
from foldcut.cli.main import main
from foldcut.cli.parser import Parser, parse
from foldcut.core.errors import BadInputError
from foldcut.core.units import in_mm
from foldcut.drawing.limits import Limits
from foldcut.drawing.mend import Preparation
from foldcut.options import Options


def arguments(*words: str) -> Namespace:
    """Return what ``foldcut make`` parses."""
    return parse(["make", *words])[1]


@pytest.mark.parametrize("name", COMMANDS)
def test_a_command_is_a_description_examples_options_and_a_run(name: str) -> None:
    command = load(name)
    assert command.description.endswith(".")
    assert command.examples.startswith(f"examples:\n  foldcut {name}")
    parser = Parser(prog=f"foldcut {name}")
    command.add_options(parser)
    assert "--json" in parser.option_strings() or name == "serve"


def test_every_module_of_commands_is_in_the_table() -> None:
    modules = {module.name for module in pkgutil.iter_modules(commands.__path__)}
    assert modules == {entry.home.partition(":")[0] for entry in COMMANDS.values()}


def test_only_the_chosen_command_is_imported() -> None:
    code = "import sys; from foldcut.cli.main import main\ntry: main(sys.argv[1:])\nexcept SystemExit: pass\n"
    code += "print(*(name.rpartition('.')[2] for name in sys.modules if name.startswith('foldcut.cli.commands.')))"

    def imported(*words: str) -> list[str]:
        done = subprocess.run([sys.executable, "-c", code, *words], capture_output=True, text=True, check=True)
        return done.stdout.splitlines()[-1].split()

    assert imported("--help") == []
    assert imported("samples") == ["samples"]
    assert imported("view", "--help") == ["make"]


def test_the_command_line_says_all_that_fold_can_be_told() -> None:
    made = options.folding(arguments("fish", "--sheet", "a5", "--ribbon", "1mm", "--scale", "1:2", "--corners", "9"))
    assert isinstance(made, Options)
    assert (made.paper.name, made.ribbon, made.scale) == ("A5", 1.0, 0.5)
    assert made.preparation is not None
    assert made.preparation.corners == 9


def test_fold_options_are_those_of_fold_by_default() -> None:
    made = options.folding(arguments("fish"))
    assert made == Options(sheet=made.sheet, preparation=made.preparation)
    assert made.paper == Options().paper


@pytest.mark.parametrize(
    ("words", "same"),
    [
        ((), Options()),
        (
            ("--sheet=120x90mm", "--margin=5mm", "--width=40mm", "--rotate=30", "--method=compact", "--effort=fast"),
            Options(sheet="120x90mm", margin=5, width=40, rotation=30, method="compact", effort="fast"),
        ),
        (
            ("--scale=1:2", "--offset=30mm,4cm", "--tolerance=1mm", "--folds=20", "--min-crease=0.123456789mm"),
            Options(scale="1:2", offset=(30, "4cm"), tolerance="1mm", folds=20, min_crease=0.123456789),
        ),
        (
            (
                "--level=easy",
                "--small-parts=keep",
                "--seconds=2.5",
                "--symmetry=auto",
                "--adjust=0.5mm",
                "--height=2in",
            ),
            Options(level="easy", small_parts="keep", seconds=2.5, symmetry="auto", adjust=0.5, height="2in"),
        ),
        (
            ("--exact", "--ribbon=1mm", "--corners=9", "--strict", "--min-feature=2mm", "--separate=1mm", "--mirror"),
            Options(exact=True, ribbon=1, preparation=Preparation(9, 2, 1, mirror=True, strict=True)),
        ),
        (("--simplify=0.5mm",), Options(simplify=0.5)),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, tuple) else "",
)
def test_python_puts_the_same_words_into_recipes(words: tuple[str, ...], same: Options) -> None:
    args = arguments("fish", *words)
    assert same.words() == options.folding_words(args).options
    plain = replace(options.folding(args), sheet="", scale="")
    assert plain == replace(in_numbers(same), sheet="", scale="")


def in_numbers(given: Options) -> Options:
    """Return options as the command line has them: lengths as numbers, and a preparation."""
    names = ("margin", "width", "height", "ribbon", "min_crease", "tolerance", "simplify", "adjust")
    offset = given.offset and (in_mm(given.offset[0]), in_mm(given.offset[1]))
    lengths = {name: in_mm(getattr(given, name)) for name in names}
    return replace(given, offset=offset, preparation=given.preparation or Preparation(), **lengths)


def test_what_the_command_line_cannot_say_is_in_no_recipe() -> None:
    assert Options(title="a fish").words() is None
    assert Options(limits=Limits(points=5)).words() is None


def test_options_with_a_value_of_their_own_are_told_in_order(tmp_path: Path) -> None:
    pattern = tmp_path / "a.fold"
    pattern.touch()
    args = arguments(str(pattern), "--join", "1mm", "--from", "svg", "--flatten", "0.05mm", "--font", "serif")
    assert options.given(args, options.add_folding) == ["--from", "--join"]
    with pytest.raises(
        BadInputError, match=r"^--font, --from, --join: only for drawings; .* has its sheet and creases"
    ):
        options.request(args)


def test_a_report_says_how_a_wedge_is_folded(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    command = ["make", "rosette", "--effort", "fast", "-o", str(tmp_path / "rosette.svg")]
    assert main(command) == 0
    lines = [" ".join(line.split()) for line in capsys.readouterr().out.splitlines()]
    assert "first fold the sheet in half along the level line at y = 148.5 mm, away from you" in lines
    (then,) = [line for line in lines if line.startswith("then ")]
    assert "into a wedge of 22.5 degrees" in then
    assert "through (105, 148.5) mm" in then
    assert "of its 8 sectors 4, then 2, then 1 stay beside each other" in then
    assert "folds 6 simple folds" in lines
    assert "all but the first four through 16 layers" in lines
    assert main([*command, "--force", "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert (report["first_fold_count"], len(report["first_folds"]), report["axes"]) == (4, 8, 8)
