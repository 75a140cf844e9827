"""The table of commands, and the options that commands share."""

from __future__ import annotations

import inspect
import json
import pkgutil
import subprocess
import sys
from argparse import Namespace
from dataclasses import fields
from pathlib import Path

import pytest

from foldcut import pipeline
from foldcut.cli import commands, options
from foldcut.cli.commands import COMMANDS, load
from foldcut.cli.main import main
from foldcut.cli.parser import Parser, parse
from foldcut.core.errors import BadInputError


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


def test_fold_options_are_keyword_arguments_of_fold() -> None:
    known = inspect.signature(pipeline.fold).parameters
    assert {field.name for field in fields(options.FoldOptions)} <= known.keys()
    made = options.folding(arguments("fish", "--sheet", "a5", "--ribbon", "1mm", "--scale", "1:2", "--corners", "9"))
    assert made.keywords().keys() == {field.name for field in fields(options.FoldOptions)}
    assert (made.sheet.name, made.ribbon, made.scale, made.preparation.corners) == ("A5", 1.0, 0.5, 9)


def test_fold_options_are_those_of_fold_by_default() -> None:
    known = inspect.signature(pipeline.fold).parameters
    made = options.folding(arguments("fish")).keywords()
    same = made.keys() - {"sheet", "preparation"}
    assert {name: made[name] for name in same} == {name: known[name].default for name in same}


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
