"""Whatever happens: one line, whatever is in names and titles, whichever stream is closed, whenever Ctrl-C comes."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
import warnings
from argparse import Namespace
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from types import FrameType, SimpleNamespace

import pytest

from foldcut.cli import main as main_module
from foldcut.cli import signals as signals_module
from foldcut.cli import start
from foldcut.cli.console import LONGEST, Console, print_error
from foldcut.cli.main import main, told
from foldcut.cli.signals import TimedOut, signals_raise
from foldcut.core.errors import BadInputError
from foldcut.core.text import LONGEST_TITLE, as_title, shown
from foldcut.readers import read_shape

FOLDCUT = [sys.executable, "-m", "foldcut.cli"]
TRIANGLE = {"loops": [[[0, 0], [30, 0], [0, 30]]]}
FAST = ["--exact", "--sheet", "60x60"]


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Run in a folder with a drawing."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "t.json").write_text(json.dumps(TRIANGLE))
    return tmp_path


# --- titles and names


@pytest.mark.parametrize(
    ("title", "shows"),
    [
        ("\ud800half a letter", "half a letter"),
        ("a\x1b[31mred\x1b]0;owned\x07", "a[31mred]0;owned"),
        ("two\nlines\tand\r\nmore", "two lines and more"),
        ("right\u202eleft", "rightleft"),
        ("Größe 中 א 🐟 ‌x", "Größe 中 א 🐟 ‌x"),
        ("x" * 5000, "x" * LONGEST_TITLE + "..."),
        ("\x00", ""),
    ],
)
def test_a_title_is_one_line_of_letters(title: str, shows: str, folder: Path) -> None:
    assert as_title(title) == shows
    (folder / "t.json").write_text(json.dumps(TRIANGLE | {"title": title}))
    assert read_shape("t.json").title == shows


def test_files_of_every_format_are_made_whatever_the_title_is(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "t.json").write_text(json.dumps(TRIANGLE | {"title": "\ud800\x1b[2J\u202e\n-->]]>*/"}))
    endings = ("svg", "fold", "png", "html", "opx", "dxf", "pdf", "stl", "3mf", "cp")
    assert main(["make", "t.json", *FAST, *(word for ending in endings for word in ("-o", f"o.{ending}"))]) == 0
    out, error = capsys.readouterr()
    assert error == ""
    assert "\x1b" not in out
    assert out.splitlines()[0] == "[2J -->]]>*/"
    again = json.loads((folder / "o.fold").read_text())
    (folder / "o.fold").write_text(json.dumps(again | {"file_title": "\udcff\x1b]0;x\x07"}))
    assert main(["view", "o.fold", "-o", "again.html"]) == 0
    assert capsys.readouterr().out.splitlines()[0] == "]0;x"


def test_names_of_files_do_nothing_to_the_terminal(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name in ("a\x1b[31m.json", "line\nbreak.json", os.fsdecode(b"caf\xe9\xff.json"), "x\u202e.json"):
        (folder / name).write_text(json.dumps(TRIANGLE))
        assert main(["make", name, *FAST, "-o", f"{name}.svg", "-o", f"{name}.zip"]) == 0
        assert main(["make", f"no{name}"]) == 2
        assert main(["make", name, *FAST, "-o", f"{name}.svg", "--force", "--json"]) == 0
        out, error = capsys.readouterr()
        assert error.count("\n") == 1
        assert all(line.isprintable() for line in (out + error).splitlines())
        (folder / name).write_text("{")
        assert main(["make", name]) == 2
        assert capsys.readouterr().err.count("\n") == 1


def test_a_pattern_is_solved_whatever_its_name_is(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    name = os.fsdecode(b"caf\xe9\x1b.cp")
    (folder / name).write_text("1 0 0 40 0\n1 40 0 40 40\n1 40 40 0 40\n1 0 40 0 0\n2 0 0 40 40\n")
    assert main(["solve", name, "--width", "100mm", "-o", "o.html", "-o", "o.fold"]) == 0
    out, error = capsys.readouterr()
    assert error == ""
    assert all(line.isprintable() for line in out.splitlines())


def test_control_characters_are_shown_as_their_escapes() -> None:
    assert shown("a\x1b\x9b\u2028\ud800é") == r"a\x1b\x9b\u2028\ud800é"


def test_a_long_error_keeps_what_is_wrong_and_the_remedy(capsys: pytest.CaptureFixture[str]) -> None:
    line = print_error("what is wrong: " + "9" * 5000 + "; the remedy")
    assert len(line) <= LONGEST + 5
    assert line.startswith("what is wrong: 9")
    assert line.endswith("9; the remedy")
    assert capsys.readouterr().err == f"foldcut: error: {line}\n"


# --- lengths and numbers


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["--ribbon", "1e300mm"], "'1e300mm' is longer than a kilometre"),
        (["--width", "9" * 5000], "is longer than a kilometre"),
        (["--flatten", "1e999in"], "is longer than a kilometre"),
        (["--ribbon", "500mm"], "--ribbon is 500 mm, and the sheet 60 x 60 mm is 84.85 mm from corner to corner"),
        (["--tolerance", "90mm"], "--tolerance is 90 mm"),
        (["--min-crease", "20cm"], "--min-crease is 200 mm"),
        (["--scale", "1e300"], "--scale 1e300 is not a scale"),
        (["--folds", "9" * 5000], "invalid int value"),
        (["--limit", "points=" + "9" * 5000], "give a whole number from 1 up"),
    ],
)
def test_lengths_that_nobody_means_are_refused_before_any_work(
    words: list[str], says: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["make", "t.json", "--sheet", "60x60", *words]) == 2
    error = capsys.readouterr().err
    assert says in error
    assert error.count("\n") == 1
    assert len(error) < LONGEST + 50


def test_a_symmetry_as_large_as_the_drawing_makes_no_point_of_it(capsys: pytest.CaptureFixture[str]) -> None:
    for length in ("30mm", "80mm"):
        assert main(["make", "t.json", "--sheet", "60x60", "--method", "simple", "--symmetry", length]) == 1
        assert "too far where the drawing is 40 mm" in capsys.readouterr().err


# --- streams


def run(command: str) -> subprocess.CompletedProcess[str]:
    """Run a line of a shell in which ``$F`` is foldcut."""
    line = command.replace("$F", " ".join(FOLDCUT))
    return subprocess.run(["bash", "-c", line], capture_output=True, text=True, check=False, timeout=120)


MAKE = f"$F make t.json {' '.join(FAST)} -o o.svg"


@pytest.mark.parametrize(
    ("command", "status", "error"),
    [
        (f"{MAKE} <&- >&- 2>&-", 0, ""),
        (f"{MAKE} --progress 2>/dev/full", 0, ""),
        (f"{MAKE} >/dev/full", 2, "the report cannot be printed: No space left on device"),
        ("$F make - --from svg <&-", 2, "the file is empty"),
        ("$F make nowhere --json >/dev/full", 2, "nowhere: there is no such file"),
        ("$F make nowhere 2>/dev/full", 2, ""),
        ("$F --version >/dev/full", 2, "No space left on device"),
    ],
)
def test_closed_and_full_streams_cost_no_file_and_no_traceback(
    command: str, status: int, error: str, folder: Path
) -> None:
    done = run(command)
    assert done.returncode == status
    assert error in done.stderr
    assert done.stderr.count("\n") == bool(error)
    if "-o o.svg" in command:
        assert (folder / "o.svg").read_text().endswith("</svg>\n")
        assert {path.name for path in folder.iterdir()} == {"t.json", "o.svg"}


# --- Ctrl-C


def wait_after(act: Callable[[], object]) -> None:
    """Do something, and then be busy for ten seconds unless a signal comes."""
    act()
    started = time.monotonic()
    while time.monotonic() < started + 10:
        pass


def test_ctrl_c_while_a_module_is_imported_waits_until_it_is_there(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (folder / "slowly.py").write_text(
        "import os, signal\nos.kill(os.getpid(), signal.SIGINT)\nfor n in range(10000): pass\nthere = True\n"
    )
    monkeypatch.syspath_prepend(str(folder))
    with pytest.raises(KeyboardInterrupt), signals_raise():
        wait_after(lambda: import_module("slowly"))
    assert sys.modules.pop("slowly").there


def test_a_signal_that_waits_as_the_command_ends_does_not_end_the_process(folder: Path) -> None:
    (folder / "last.py").write_text(
        "import os, signal\nos.kill(os.getpid(), signal.SIGTERM)\nfor n in range(1000): pass\n"
    )
    script = """
import time
from foldcut.cli.signals import signals_raise

with signals_raise():
    import last
started = time.process_time()
while time.process_time() < started + 0.1:  # longer than a signal waits
    pass
print("done")
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False, cwd=folder)
    assert (done.returncode, done.stdout, done.stderr) == (0, "done\n", "")


def test_ctrl_c_in_a_finaliser_is_not_lost(capsys: pytest.CaptureFixture[str]) -> None:
    class Owner:
        def __del__(self) -> None:
            signal.raise_signal(signal.SIGINT)

    with pytest.raises(KeyboardInterrupt), signals_raise():
        wait_after(Owner)
    assert capsys.readouterr().err == ""


def test_what_a_library_makes_of_ctrl_c_is_an_interruption() -> None:
    for ended, says, status in (
        (KeyboardInterrupt(), "interrupted; no file is half-written", 130),
        (TimedOut(3.0), "timed out after 3 s, no file is half-written", 1),
    ):
        error = ImportError("numpy cannot be imported")
        error.__cause__ = ended
        message, found = told(error)
        assert (message.startswith(says), found) == (True, status)
    with pytest.raises(KeyboardInterrupt), signals_raise():
        wait_after(lambda: signal.raise_signal(signal.SIGINT))
    assert told(TypeError("Cannot compare structured arrays"))[1] == 130  # numpy names no cause
    with signals_raise():
        assert told(TypeError("Cannot compare structured arrays"))[1] == 1  # nothing came this time
    timed_out = "timed out after 3 s, no file is half-written; allow more with --timeout"
    for args in (Namespace(), Namespace(again="", effort="best"), None):
        assert told(TimedOut(3.0), args)[0] == timed_out  # there is no search that could be shorter
    refused = BadInputError("the drawing is at fault")
    refused.__context__ = KeyboardInterrupt()
    assert told(refused) == ("the drawing is at fault", 2)


def test_ctrl_c_before_the_command_begins_is_one_line_and_json(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def interrupted() -> int:
        raise KeyboardInterrupt

    monkeypatch.setattr(main_module, "main", interrupted)
    monkeypatch.setattr(sys, "argv", ["foldcut", "make", "t.json", "--json"])
    with warnings.catch_warnings():
        assert start.main() == 130
    out, error = capsys.readouterr()
    assert error == "foldcut: error: interrupted; no file is half-written\n"
    assert json.loads(out)["error"]["message"] == "interrupted; no file is half-written"


def test_no_signal_that_waits_outlives_the_command() -> None:
    with signals_raise():
        signals_module._come_again(signal.SIGTERM)
        assert signal.getitimer(signal.ITIMER_VIRTUAL)[0] > 0
    assert signal.getitimer(signal.ITIMER_VIRTUAL)[0] == 0


@pytest.mark.parametrize("call", [50, 2000, 5000])
def test_ctrl_c_at_any_call_of_the_first_imports_is_one_line(call: int, folder: Path) -> None:
    script = """
import signal, sys
from foldcut.cli.start import main

left = int(sys.argv.pop(1))
signal.signal(signal.SIGINT, signal.default_int_handler)  # which a shell may have ignored

def count(frame, event, arg):
    global left
    left -= 1
    if not left:
        signal.raise_signal(signal.SIGINT)

sys.settrace(count)
sys.exit(main())
"""
    words = [sys.executable, "-c", script, str(call), "make", "t.json", *FAST, "--json", "-o", "o.svg"]
    done = subprocess.run(words, capture_output=True, text=True, check=False, cwd=folder)
    assert (done.returncode, done.stderr) == (130, "foldcut: error: interrupted; no file is half-written\n")
    assert json.loads(done.stdout)["error"]["type"] == "KeyboardInterrupt"


def test_signals_have_the_handlers_that_they_had_before() -> None:
    def of_the_caller(number: int, frame: FrameType | None) -> None:
        """Do nothing."""

    before = signal.signal(signal.SIGINT, of_the_caller)
    try:
        with signals_raise():
            assert signal.getsignal(signal.SIGINT) is of_the_caller
        assert signal.getsignal(signal.SIGINT) is of_the_caller
        assert signal.getsignal(signal.SIGVTALRM) == signal.SIG_DFL
    finally:
        signal.signal(signal.SIGINT, before)


# --- mistakes in foldcut


@pytest.mark.parametrize(
    ("error", "says"),
    [
        (
            ZeroDivisionError("division by zero"),
            "this is a mistake in foldcut, and no file is half-written: ZeroDivision",
        ),
        (
            RecursionError("too\ndeep"),
            "RecursionError: too deep; please report it with what is printed if FOLDCUT_TRACEBACK=1",
        ),
        (MemoryError(), "there is not enough memory, and no file is half-written; simplify the drawing"),
    ],
)
def test_a_mistake_in_foldcut_is_one_line_and_json(
    error: Exception, says: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def fails(_: object) -> int:
        raise error

    monkeypatch.setattr(main_module, "parse", lambda _: (SimpleNamespace(run=fails), SimpleNamespace()))
    assert main(["make", "t.json", "--json"]) == 1
    out, printed = capsys.readouterr()
    assert says in printed
    assert printed.count("\n") == 1
    assert json.loads(out)["error"]["type"] == type(error).__name__
    monkeypatch.setenv("FOLDCUT_TRACEBACK", "1")
    with pytest.raises(type(error)):
        main(["make", "t.json"])


def test_a_report_with_a_line_break_stays_on_its_line(capsys: pytest.CaptureFixture[str]) -> None:
    Console(as_json=False).report({}, ["one\nline", "two"])
    assert capsys.readouterr().out == "one\\nline\ntwo\n"
