"""Batches: every drawing has its row and its files, whatever becomes of the others, of processes and of workers."""

from __future__ import annotations

import csv
import fcntl
import io
import json
import signal
import subprocess
import sys
import time
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from support.recipes import without_recipe

from foldcut import pipeline
from foldcut.batch import run as batches
from foldcut.batch.drawings import find_drawings
from foldcut.batch.journal import JOURNAL
from foldcut.batch.results import RESULTS
from foldcut.batch.run import Batch, run_batch
from foldcut.batch.worker import Outcome, Process, Recipe, Task, WorkerError, work
from foldcut.cli.main import main
from foldcut.core.errors import BadInputError
from foldcut.exporters.pattern.png import rendered
from foldcut.exporters.pictures.contact_sheet import Thumbnail, contact_sheet
from foldcut.output.atomic import OutputError
from foldcut.output.render import JobOptions
from foldcut.profiles import load_profile

QUICK = {"sheet": "60x60", "effort": "fast"}
FOLD = Recipe(QUICK, endings=(".fold",))


def draw(folder: Path, *names: str) -> Path:
    """Write a square of its own size under each name, and return the folder."""
    for number, name in enumerate(names):
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        side = 20 + number
        path.write_text(json.dumps({"loops": [[[0, 0], [side, 0], [side, 20], [0, 20]]]}))
    return folder


def rows(out: Path) -> list[dict[str, str]]:
    """Return the rows of ``results.csv``."""
    with (out / RESULTS).open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def made(out: Path) -> dict[str, bytes]:
    """Return the patterns in a folder and below by their names."""
    return {path.relative_to(out).as_posix(): path.read_bytes() for path in sorted(out.rglob("*.fold"))}


def journal(out: Path) -> list[dict[str, Any]]:
    """Return the records of the journal that are whole."""
    lines = (out / JOURNAL).read_bytes().splitlines(keepends=True) if (out / JOURNAL).exists() else []
    return [json.loads(line) for line in lines[1:] if line.endswith(b"\n")]


@pytest.fixture
def here(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Do the work in this process, and return the list that the names of drawings are added to."""
    worked: list[str] = []

    def run(self: Process, recipe: Recipe, task: Task, timeout: float) -> Outcome:
        worked.append(task.stem)
        return work(recipe, task)

    monkeypatch.setattr(Process, "run", run)
    return worked


# --- what is made


def test_the_letters_of_a_text_are_folded_once_each_and_not_again(
    tmp_path: Path, here: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["batch", "--text", "ILL LI", "--font", "foldcut", "--format", "fold", "--effort", "fast", "--jobs", "1"]
    assert main([*words, "-o", str(tmp_path / "out")]) == 0
    assert sorted(made(tmp_path / "out")) == ["I.fold", "L.fold"]
    assert sorted(here) == ["I", "L"]
    assert "print      I 2 times, L 3 times" in capsys.readouterr().out
    assert main([*words, "-o", str(tmp_path / "out"), "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert (report["letters"], report["resumed"]) == (["I", "L", "L", "L", "I"], 2)
    assert sorted(here) == ["I", "L"]
    words[2] = "LT"
    assert main([*words, "-o", str(tmp_path / "out"), "--quiet"]) == 0
    assert here[2:] == ["T"]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ([], "give FOLDER|GLOB or a --text\n"),
        (["box.json", "--text", "A"], "give FOLDER|GLOB or a --text, not both"),
        (["--text", "A&B", "--font", "foldcut"], "the font foldcut has no letter '&'"),
        (["--text", " "], "give 1 to 1000"),
    ],
)
def test_a_text_that_cannot_be_drawn_is_told_before_any_work(
    tmp_path: Path, words: list[str], message: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["batch", *words, "-o", "out"]) == 2
    assert message in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_a_row_and_files_for_every_drawing_bad_ones_too(tmp_path: Path) -> None:
    icons = draw(tmp_path / "icons", "a.json", "sub/b.json")
    (icons / "empty.svg").write_text("")
    (icons / "cross.json").write_text('{"loops": [[[0, 0], [9, 9], [9, 0], [0, 9]]]}')
    (icons / "gone.json").symlink_to("nowhere")
    (icons / "notes.txt").write_text("no drawing")
    (icons / ".hidden.json").write_text("no drawing")
    out = tmp_path / "out"
    batch = run_batch([icons], out, FOLD, jobs=2)
    names = [(Path(row["file"]).name, row["status"]) for row in rows(out)]
    assert names == [("a.json", "made"), ("cross.json", "bad-input"), ("empty.svg", "bad-input"), ("b.json", "made")]
    assert "the file is empty" in rows(out)[2]["error"]
    assert batch.counts == {"made": 2, "bad-input": 2}
    assert set(made(out)) == {"a.fold", "sub/b.fold"}
    good = rows(out)[0]
    assert int(good["creases"]) > 0
    assert float(good["shortest_crease_mm"]) > 0.5
    assert float(good["seconds"]) > 0
    assert good["outputs"] == "a.fold"


def test_a_drawing_is_folded_as_make_does(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    draw(tmp_path / "icons", "a.json")
    options = ["--sheet", "60x60", "--effort", "fast", "--profile", "laser-dxf", "--two-sided"]
    assert main(["batch", "icons", "-o", "out", *options, "--quiet"]) == 0
    (tmp_path / "one").mkdir()
    assert main(["make", "icons/a.json", "-o", "one/a.dxf", *options, "--quiet"]) == 0
    for name in ("a-front.dxf", "a-back.dxf"):
        assert (tmp_path / "out" / name).read_bytes() == (tmp_path / "one" / name).read_bytes()


def test_the_order_of_the_work_changes_nothing(tmp_path: Path, here: list[str]) -> None:
    icons = draw(tmp_path / "icons", "a.json", "b.json", "c.json", "d.json")
    run_batch([icons], tmp_path / "one", FOLD, jobs=1)
    backwards = [icons / name for name in ("d.json", "c.json", "b.json", "a.json")]
    run_batch(backwards, tmp_path / "two", FOLD, jobs=4)
    assert made(tmp_path / "one") == made(tmp_path / "two")
    seconds_apart = [[row | {"seconds": ""} for row in rows(tmp_path / out)] for out in ("one", "two")]
    assert seconds_apart[0] == seconds_apart[1]
    assert (tmp_path / "one/contact-sheet.svg").read_bytes() == (tmp_path / "two/contact-sheet.svg").read_bytes()


def test_drawings_of_one_name_get_files_of_their_own(tmp_path: Path, here: list[str]) -> None:
    draw(tmp_path / "x", "a.json", "a.geojson", "results.json", "B.json", "b.wkt", "sub/a.json")
    draw(tmp_path / "y", "other.json", "a.json")
    items = find_drawings([tmp_path / "x", tmp_path / "y", str(tmp_path / "x" / "*.json")], tmp_path / "out")
    stems = {str(item.path.relative_to(tmp_path)): item.stem for item in items}
    assert stems == {
        "x/B.json": "B.json",
        "x/b.wkt": "b.wkt",
        "x/a.geojson": "a.geojson",
        "x/a.json": "a.json",
        "y/a.json": "a.json-2",
        "x/results.json": "results.json",
        "x/sub/a.json": "sub/a",
        "y/other.json": "other",
    }
    run_batch([tmp_path / "x/a.json", tmp_path / "y/a.json"], tmp_path / "out", FOLD, jobs=2)
    assert set(made(tmp_path / "out")) == {"a.json.fold", "a.json-2.fold"}
    assert len(set(made(tmp_path / "out").values())) == 2


def test_what_a_batch_wrote_is_no_drawing_of_it(tmp_path: Path, here: list[str]) -> None:
    icons = draw(tmp_path, "a.json", "b.json")
    for _ in range(2):
        batch = run_batch([icons], icons / "out", Recipe(QUICK, endings=(".svg",)), jobs=1)
    assert [Path(str(row["file"])).name for row in batch.rows] == ["a.json", "b.json"]
    assert batch.resumed == 2


def test_the_contact_sheet_shows_every_pattern_and_its_name(tmp_path: Path, here: list[str]) -> None:
    icons = draw(tmp_path / "icons", *(f"icon{number}.json" for number in range(5)))
    (icons / "empty.svg").write_text("")
    batch = run_batch([icons], tmp_path / "out", FOLD, jobs=1, sheet=".png")
    assert (tmp_path / "out/contact-sheet.png").read_bytes().startswith(b"\x89PNG")
    run_batch([icons], tmp_path / "out", FOLD, jobs=1)
    svg = ET.parse(tmp_path / "out/contact-sheet.svg").getroot()
    ns = {"svg": "http://www.w3.org/2000/svg"}
    words = [*(f"icon{number}" for number in range(5)), "mountain", "valley"]
    assert [text.text for text in svg.iterfind("svg:text", ns)] == words
    samples = [path.get("stroke-dasharray") for path in svg.iterfind("svg:path", ns)]
    assert samples == ["0.9 0.36 0.12 0.36", "0.9 0.36"]
    for group in svg.iterfind("svg:g", ns):
        drawn = {path.get("stroke") or path.get("fill") for path in group.iterfind("svg:path", ns)}
        assert drawn == {"#ffe08a", "#ff0000", "#0000ff"}
    assert batch.counts == {"made": 5, "bad-input": 1}


def test_mountains_and_valleys_are_told_apart_without_colour() -> None:
    """In grey, the row of a mountain and that of a valley, across a thumbnail and in the legend, have other dashes."""
    level = Thumbnail(1000, 500, "", "M0 100L1000 100", "M0 400L1000 400")
    svg, size = contact_sheet([("two creases", level)], "", load_profile().drawing)
    grey = np.asarray(Image.open(io.BytesIO(rendered(svg, size))).convert("L"))

    def dashes(y: float, x: float, length: float) -> set[bool]:
        """Which dashes a row has: long ones, True, and dots, False."""
        per_mm = grey.shape[1] / size[0]
        strip = grey[round((y - 0.3) * per_mm) : round((y + 0.3) * per_mm), round(x * per_mm) :].min(axis=0)
        dark = np.flatnonzero(np.diff(np.concatenate([[0], strip[: round(length * per_mm)] < 215, [0]]))).reshape(-1, 2)
        return set((np.diff(dark, axis=1)[:, 0] > 0.5 * per_mm)[1:-1].tolist())

    assert dashes(3 + 100 * 0.04, 4, 38) == {True, False}
    assert dashes(3 + 400 * 0.04, 4, 38) == {True}
    legend = size[1] - 1.5 * 2.4
    assert dashes(legend, 3, 5) == {True, False}
    assert dashes(legend, 23, 5) == {True}


def test_parquet_has_the_rows_of_the_csv(tmp_path: Path, here: list[str]) -> None:
    parquet = pytest.importorskip("pyarrow.parquet", exc_type=ImportError)
    icons = draw(tmp_path / "icons", "a.json", "b.json")
    (icons / "empty.svg").write_text("")
    out = tmp_path / "out"
    run_batch([icons], out, Recipe(QUICK, endings=(".fold", ".svg")), jobs=1, parquet=True)
    table = parquet.read_table(out / "results.parquet").to_pylist()
    assert [row["file"] for row in table] == [row["file"] for row in rows(out)]
    assert [row["creases"] for row in table] == [int(row["creases"]) if row["creases"] else None for row in rows(out)]
    assert table[0]["outputs"] == ["a.fold", "a.svg"]


# --- what is not done again, and what is


def test_what_is_done_is_not_done_again_unless_something_changed(tmp_path: Path, here: list[str]) -> None:
    icons, out = draw(tmp_path / "icons", "a.json", "b.json", "c.json"), tmp_path / "out"
    (icons / "empty.svg").write_text("")
    run_batch([icons], out, FOLD, jobs=1)
    before = made(out)

    def again(**options: bool) -> list[str]:
        here.clear()
        run_batch([icons], out, FOLD, jobs=1, **options)
        return sorted(here)

    assert again() == []
    (out / "a.fold").unlink()
    assert again() == ["a"]
    assert made(out) == before
    (icons / "b.json").write_text((icons / "c.json").read_text())
    assert again() == ["b"]
    assert made(out) != before
    (icons / "d.json").write_text((icons / "c.json").read_text())
    assert again() == ["d"]
    assert again(retry=True) == ["empty"]
    assert again(replace=True) == ["a", "b", "c", "d", "empty"]


def test_a_line_that_a_crash_cut_off_is_done_again(tmp_path: Path, here: list[str]) -> None:
    icons, out = draw(tmp_path / "icons", "a.json", "b.json", "c.json"), tmp_path / "out"
    run_batch([icons], out, FOLD, jobs=1)
    whole = (out / JOURNAL).read_bytes()
    for cut in (1, 40):
        (out / JOURNAL).write_bytes(whole[:-cut])
        here.clear()
        run_batch([icons], out, FOLD, jobs=1)
        assert here == ["c"]
        assert [record["stem"] for record in journal(out)] == ["a", "b", "c"]


def test_a_folder_of_another_batch_or_with_files_of_the_same_name_is_left_alone(
    tmp_path: Path, here: list[str]
) -> None:
    icons, out = draw(tmp_path / "icons", "a.json"), tmp_path / "out"
    out.mkdir()
    (out / "a.fold").write_text("mine")
    for _ in range(2):
        with pytest.raises(OutputError, match="it is there already"):
            run_batch([icons], out, FOLD, jobs=1)
    assert (out / "a.fold").read_text() == "mine"
    run_batch([icons], out, FOLD, jobs=1, replace=True)
    with pytest.raises(BadInputError, match="made with other options"):
        run_batch([icons], out, Recipe(QUICK | {"sheet": "61x61"}, endings=(".fold",)), jobs=1)
    with (out / JOURNAL).open("rb") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        with pytest.raises(BadInputError, match="another batch is writing"):
            run_batch([icons], out, FOLD, jobs=1)


def test_recipes_are_told_apart_by_all_they_say() -> None:
    laser = load_profile("laser-dxf")
    some = [FOLD, Recipe(QUICK), Recipe(QUICK | {"margin": 5.0}), Recipe(QUICK, profile=laser)]
    some.append(Recipe(QUICK, profile=load_profile("laser-dxf", ("kerf_mm=0.2",))))
    assert len({recipe.fingerprint for recipe in some}) == len(some)
    assert Recipe({"effort": "fast", "sheet": "60x60"}, endings=(".fold",)).fingerprint == FOLD.fingerprint


# --- what may go wrong


def test_a_drawing_that_takes_too_long_or_kills_its_process_costs_only_itself(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "site").mkdir()
    (tmp_path / "site/sitecustomize.py").write_text(
        "import os, time, foldcut.batch.worker as worker\n"
        "work = worker.work\n"
        "def wild(recipe, task):\n"
        "    if task.stem == 'loops': time.sleep(60)\n"
        "    if task.stem == 'crash': os.abort()\n"
        "    if task.stem == 'prints': os.write(1, b'noise')\n"
        "    return work(recipe, task)\n"
        "worker.work = wild\n"
    )
    monkeypatch.setattr(sys, "path", [str(tmp_path / "site"), *sys.path])
    icons = draw(tmp_path / "icons", "a.json", "crash.json", "loops.json", "prints.json", "z.json")
    out = tmp_path / "out"
    run_batch([icons], out, FOLD, jobs=1, timeout=10)
    found = {Path(row["file"]).stem: row for row in rows(out)}
    assert {name: row["status"] for name, row in found.items()} == {
        "a": "made",
        "crash": "crashed",
        "loops": "timed-out",
        "prints": "made",
        "z": "made",
    }
    assert "status -6, 2 times" in found["crash"]["error"]
    assert "timed out after 10 s" in found["loops"]["error"]


def test_a_mistake_in_a_stage_is_that_drawings_error(
    tmp_path: Path, here: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    fold = pipeline.fold

    def broken(drawing: Any, **options: Any) -> Any:
        if drawing.title == "b":
            raise ZeroDivisionError("no width")
        return fold(drawing, **options)

    monkeypatch.setattr(pipeline, "fold", broken)
    run_batch([draw(tmp_path / "icons", "a.json", "b.json", "c.json")], tmp_path / "out", FOLD, jobs=1)
    assert [row["status"] for row in rows(tmp_path / "out")] == ["made", "error", "made"]
    assert rows(tmp_path / "out")[1]["error"] == "ZeroDivisionError: no width"


def test_a_process_that_does_not_start_ends_the_batch(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "site").mkdir()
    (tmp_path / "site/sitecustomize.py").write_text("import os; os._exit(3)")
    monkeypatch.setattr(sys, "path", [str(tmp_path / "site"), *sys.path])
    with pytest.raises(WorkerError, match="status 3"):
        run_batch([draw(tmp_path / "icons", "a.json")], tmp_path / "out", FOLD, jobs=1)
    assert journal(tmp_path / "out") == []


@pytest.fixture
def running(tmp_path: Path) -> Iterator[Any]:
    """Give a function that starts the command on 20 drawings in a process of its own."""
    icons = draw(tmp_path / "icons", *(f"icon{number:02}.json" for number in range(20)))
    options = ["--sheet", "60x60", "--effort", "fast", "--format", "fold", "--jobs", "2"]
    command = [sys.executable, "-m", "foldcut.cli", "batch", str(icons), "-o", str(tmp_path / "out"), *options]
    started = []

    def start() -> subprocess.Popen[str]:
        started.append(subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True))
        return started[-1]

    yield start
    for process in started:
        process.kill()
        process.communicate()


def wait_for(count: int, out: Path) -> None:
    """Wait until the journal has so many records."""
    end = time.monotonic() + 120
    while len(journal(out)) < count:
        assert time.monotonic() < end, "the batch does not go on"
        time.sleep(0.01)


def test_twenty_drawings_are_all_there_after_a_kill(tmp_path: Path, running: Any) -> None:
    out = tmp_path / "out"
    process = running()
    wait_for(5, out)
    process.kill()
    process.wait()
    before = journal(out)
    assert 5 <= len(before) < 20
    process = running()
    printed, error = process.communicate(timeout=300)
    assert process.returncode == 0, error
    assert f"20 drawings: 20 made; {len(before)} were done before" in printed
    after = journal(out)
    assert after[: len(before)] == before, "what was written down stays"
    assert sorted(record["stem"] for record in after) == [f"icon{number:02}" for number in range(20)], "each once"
    run_batch([tmp_path / "icons"], tmp_path / "other", FOLD, jobs=2)
    assert {name: without_recipe(data) for name, data in made(out).items()} == made(tmp_path / "other")
    assert [row["status"] for row in rows(out)] == ["made"] * 20


@pytest.mark.parametrize(("number", "status"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_an_interruption_leaves_what_is_done_and_says_how_to_go_on(
    tmp_path: Path, running: Any, number: signal.Signals, status: int
) -> None:
    out = tmp_path / "out"
    process = running()
    wait_for(3, out)
    process.send_signal(number)
    _, error = process.communicate(timeout=60)
    assert process.returncode == status
    assert error.count("\n") == 1
    assert "of 20 drawings, 0 failed; the same command again goes on from there" in error
    assert len(rows(out)) == len(journal(out)) == len(made(out)) < 20


# --- a cluster


CLUSTER = """
import json, os, signal, sys, threading, time
from pathlib import Path
from distributed import Client, LocalCluster
from foldcut.batch.run import run_batch
from foldcut.batch.worker import Recipe

def main():
    recipe = Recipe({"sheet": "60x60", "effort": "fast"}, endings=(".fold",))
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        first = min(cluster.workers)
        victim = cluster.workers[first].pid
        killed = []
        def watch(text, part):
            if part > 0.2 and not killed:
                os.kill(victim, signal.SIGKILL)
                killed.append(text)
        batch = run_batch([sys.argv[1]], Path(sys.argv[2]), recipe, cluster=cluster.scheduler_address, progress=watch)
        print(json.dumps({"counts": batch.counts, "killed": killed, "alive": cluster.workers[first].pid != victim}))

if __name__ == "__main__":
    main()
"""


def test_a_clusters_worker_is_killed_and_nothing_is_lost(tmp_path: Path) -> None:
    pytest.importorskip("distributed", exc_type=ImportError)
    icons = draw(tmp_path / "icons", *(f"icon{number:02}.json" for number in range(12)))
    (icons / "empty.svg").write_text("")
    script = tmp_path / "cluster.py"
    script.write_text(CLUSTER)
    done = subprocess.run(
        [sys.executable, str(script), str(icons), str(tmp_path / "out")],
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    said = json.loads(done.stdout.splitlines()[-1])
    assert said["counts"] == {"made": 12, "bad-input": 1}
    assert len(said["killed"]) == 1
    assert said["alive"], "dask has put another in its place"
    run_batch([icons], tmp_path / "here", FOLD, jobs=2)
    assert made(tmp_path / "out") == made(tmp_path / "here")


@pytest.mark.filterwarnings("ignore")
def test_a_cluster_out_of_reach_and_a_missing_extra_say_what_to_do(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    icons = draw(tmp_path / "icons", "a.json")
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    monkeypatch.setitem(sys.modules, "distributed", None)
    for options in ({"cluster": "tcp://127.0.0.1:1"}, {"parquet": True}):
        with pytest.raises(BadInputError, match=r"pip install 'foldcut\[batch\]'"):
            run_batch([icons], tmp_path / "out", FOLD, **options)  # type: ignore[arg-type]
    assert not (tmp_path / "out").exists()


# --- the command


def test_batch_prints_counts_and_a_report_for_programs(
    tmp_path: Path, here: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    draw(tmp_path / "icons", "a.json", "b.json")
    (tmp_path / "icons/empty.svg").write_text("")
    command = ["batch", "icons", "-o", "out", "--sheet", "60x60", "--effort", "fast", "--jobs", "1"]
    assert main(command) == 1
    said = capsys.readouterr().out
    assert "3 drawings: 2 made, 1 bad-input" in said
    assert "icons/empty.svg: the file is empty" in said
    assert said.count("icons/empty.svg") == 1, "not once more where the error begins"
    assert main([*command, "--json"]) == 1
    report = json.loads(capsys.readouterr().out)
    assert (report["ok"], report["counts"], report["resumed"]) == (False, {"made": 2, "bad-input": 1}, 3)
    assert [row["file"] for row in report["rows"]] == ["icons/a.json", "icons/b.json", "icons/empty.svg"]
    assert Path("out/a.svg").exists()
    assert Path("out/a.fold").exists()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["nowhere"], "no such file or folder"),
        (["."], "there are no drawings"),
        (["'*.svg'"], "there are no drawings"),
        ([".", "--jobs", "0"], "give 1 or more"),
        ([".", "--timeout", "0"], "positive number"),
        ([".", "--format", "gcode"], "name it with --profile grbl-laser or grbl-plotter"),
        ([".", "--format", "xyz"], "cannot write .xyz"),
        ([".", "--material", "card"], "goes with a machine"),
    ],
)
def test_bad_options_are_told_before_any_work(
    tmp_path: Path,
    options: list[str],
    message: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["batch", *options, "-o", "out"]) == 2
    assert message in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_a_full_disk_ends_the_batch_and_loses_nothing(
    tmp_path: Path, here: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    icons, out = draw(tmp_path / "icons", "a.json", "b.json", "c.json"), tmp_path / "out"
    write = batches.write_files

    def full(contents: Any, *, replace: bool) -> None:
        if any(path.name == "b.fold" for path in contents):
            raise OutputError("the disk is full") from OSError(28, "No space left on device")
        write(contents, replace=replace)

    monkeypatch.setattr(batches, "write_files", full)
    with pytest.raises(OutputError, match="disk is full"):
        run_batch([icons], out, FOLD, jobs=1)
    assert [record["stem"] for record in journal(out)] == ["a"]
    monkeypatch.setattr(batches, "write_files", write)
    batch: Batch = run_batch([icons], out, FOLD, jobs=1)
    assert batch.resumed == 1
    assert batch.counts == {"made": 3}


def test_a_name_that_is_too_long_is_that_drawings_error(tmp_path: Path, here: list[str]) -> None:
    long = "n" * 250
    icons, out = draw(tmp_path / "icons", "b.json"), tmp_path / "out"
    (icons / f"{long}.wkt").write_text("POLYGON ((0 0, 20 0, 20 20, 0 20, 0 0))")
    recipe = Recipe(QUICK, endings=(".dxf",), profile=load_profile("laser-dxf"), job=JobOptions(two_sided=True))
    run_batch([icons], out, recipe, jobs=1)
    assert [row["status"] for row in rows(out)] == ["made", "bad-input"]
    assert "its name is too long" in rows(out)[1]["error"]
    assert sorted(path.name for path in out.glob("*.dxf")) == ["b-back.dxf", "b-front.dxf"]
