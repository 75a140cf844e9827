"""The web app: drawings become files, and bad ones, other sites and path tricks get nowhere."""

from __future__ import annotations

import base64
import io
import json
import signal
import socket
import subprocess
import sys
import time
import zipfile
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import quote

import httpx2
import numpy as np
import pytest
from starlette.testclient import TestClient
from support.programs import require_program, run_node
from support.recipes import without_recipe

from foldcut.cli.main import main
from foldcut.samples import sample_path
from foldcut.web.app import make_app
from foldcut.web.errors import RefusedError
from foldcut.web.jobs import Jobs, Settings
from foldcut.web.options import read_query

OWN = {"X-Foldcut": "1"}
SQUARE = json.dumps({"loops": [[[0, 0], [40, 0], [40, 40], [0, 40]]], "units": "mm"}).encode()


def running_app(settings: Settings | None = None) -> TestClient:
    """Return an app to use in a ``with`` statement, under the name that browsers on this machine use."""
    return TestClient(make_app(settings), base_url="http://127.0.0.1")


@pytest.fixture
def client() -> Iterator[TestClient]:
    """Give a running app that allows small drawings only."""
    with running_app(Settings(upload_bytes=100_000, job_seconds=50)) as running:
        yield running


def send(client: TestClient, data: bytes = b"", **query: str) -> str:
    """Send a drawing and return its token."""
    answer = client.post("/jobs", params={"effort": "fast", **query}, content=data, headers=OWN)
    assert answer.status_code == 201, answer.text
    token: str = answer.json()["job"]
    return token


def outcome(client: TestClient, token: str) -> dict[str, Any]:
    """Wait until a drawing is folded, or is not, and return its state."""
    for _ in range(600):
        state: dict[str, Any] = client.get(f"/jobs/{token}").json()
        if state["state"] in ("done", "failed"):
            return state
        time.sleep(0.1)
    raise AssertionError("the job did not end")


def jobs_of(client: TestClient) -> Jobs:
    """Return the app's jobs."""
    jobs: Jobs = client.app.state.jobs  # type: ignore[attr-defined]
    return jobs


def test_a_sample_becomes_the_files_of_the_command_line(client: TestClient, tmp_path: Path) -> None:
    token = send(client, sample="triangle", profile="laser-dxf")
    state = outcome(client, token)
    assert state["error"] == ""
    assert state["report"]["ok"]
    assert set(state["files"]) == {"job.dxf", "job.zip", "pattern.fold", "pattern.html", "pattern.png"}
    archive = zipfile.ZipFile(io.BytesIO(client.get(f"/jobs/{token}/job.zip").content))
    (dxf,) = [name for name in archive.namelist() if name.endswith(".dxf")]
    ours = tmp_path / "job.dxf"
    command = ["make", str(sample_path("triangle")), "--effort", "fast", "--profile", "laser-dxf", "-o", str(ours)]
    assert main([*command, "--quiet"]) == 0
    assert without_recipe(archive.read(dxf)) == without_recipe(ours.read_bytes())


def test_how_creases_and_marks_are_made_is_told_to_the_machine(client: TestClient, tmp_path: Path) -> None:
    made = set()
    for treatment, marks in (("", "outline,first-folds"), ("perforate", "none"), ("", "none"), ("", "numbers")):
        token = send(client, sample="triangle", profile="laser-dxf", treatment=treatment, marks=marks)
        assert outcome(client, token)["error"] == ""
        archive = zipfile.ZipFile(io.BytesIO(client.get(f"/jobs/{token}/job.zip").content))
        (dxf,) = [name for name in archive.namelist() if name.endswith(".dxf")]
        ours = tmp_path / "job.dxf"
        command = ["make", "triangle", "--effort", "fast", "--profile", "laser-dxf", "--marks", marks, "-o", str(ours)]
        assert main([*command, *(("--treatment", treatment) if treatment else ()), "--quiet", "--force"]) == 0
        assert without_recipe(archive.read(dxf)) == without_recipe(ours.read_bytes())
        made.add(ours.read_bytes())
    assert len(made) == 4


def test_any_format_is_made_when_it_is_asked_for(client: TestClient, tmp_path: Path) -> None:
    token = send(client, sample="triangle", profile="laser-dxf")
    more = outcome(client, token)["more"]
    assert {"job.svg", "job.pdf", "pattern.svg", "pattern.cp", "pattern.stl", "guide.pdf", "pictures.svg"} <= set(more)
    for name in ("job.svg", "pattern.svg", "pattern.zip", "guide.pdf", "pictures.svg"):
        assert client.get(f"/jobs/{token}/{name}").status_code == 404
        assert client.post(f"/jobs/{token}/{name}").status_code == 403
        assert client.post(f"/jobs/{token}/{name}", headers=OWN).status_code == 204, name
        assert client.get(f"/jobs/{token}/{name}").status_code == 200
    assert set(zipfile.ZipFile(io.BytesIO(client.get(f"/jobs/{token}/pattern.zip").content)).namelist()) == {
        "README.txt",
        "pattern.svg",
        "pattern.fold",
        "pattern.png",
    }
    for name, machine in (("pattern.svg", []), ("job.svg", ["--profile", "laser-dxf"])):
        command = ["make", "triangle", "--effort", "fast", "--quiet", *machine, "-o", str(tmp_path / name)]
        assert main(command) == 0
        served = client.get(f"/jobs/{token}/{name}").content
        assert without_recipe(served) == without_recipe((tmp_path / name).read_bytes())


@pytest.mark.parametrize("name", ["job.exe", "..%2fx.svg", "pattern.html", "drawing.json"])
def test_no_other_files_are_made(client: TestClient, name: str) -> None:
    token = send(client, SQUARE, ending=".json")
    assert outcome(client, token)["state"] == "done"
    before = set(jobs_of(client).root.rglob("*"))
    answer = client.post(f"/jobs/{token}/{name}", headers=OWN)
    assert answer.status_code == (204 if name == "pattern.html" else 404 if "%2f" in name else 400)
    assert set(jobs_of(client).root.rglob("*")) == before


def test_files_are_made_of_finished_jobs_only(client: TestClient) -> None:
    token = send(client, b"{not json", ending=".json")
    assert outcome(client, token)["more"] == []
    assert client.post(f"/jobs/{token}/pattern.cp", headers=OWN).status_code == 409


def test_a_quick_look_makes_what_all_files_are_made_of(client: TestClient) -> None:
    state = outcome(client, send(client, SQUARE, ending=".json", quick="1", profile="laser-dxf"))
    assert state["files"] == ["pattern.fold", "pattern.html"]
    assert state["report"]["warnings"] is not None


def test_the_page_is_shown_what_is_found(client: TestClient) -> None:
    token = send(client, SQUARE, ending=".json", quick="1", name="../my süß square")
    state = outcome(client, token)
    assert state["name"] == "my süß square"
    disposition = client.get(f"/jobs/{token}/pattern.fold").headers["content-disposition"]
    assert disposition.endswith(f"filename*=UTF-8''{quote('my süß square')}.fold")
    assert {path.name for path in jobs_of(client).get(token).folder.iterdir()} == {"given", "made", "so-far.html"}
    assert len(state["patterns"]) >= 1
    shown = client.get(f"/jobs/{token}/shown")
    assert shown.headers["content-type"] == "application/json"
    assert shown.json()["title"] == "my süß square"
    assert shown.json()["steps"]
    job = jobs_of(client).get(token)
    assert (job.folder / "so-far.html").is_file()
    job.state = "folding"
    assert client.get(f"/jobs/{token}/shown").json()["flat"], "the best so far"
    (job.folder / "so-far.html").unlink()
    assert client.get(f"/jobs/{token}/shown").json() == {}


@pytest.mark.parametrize(
    ("name", "called"),
    [
        ("../../x", "x"),
        ("--force", "force"),
        ("a\nb/c\\d", "a-b-c-d"),
        ("Füchsin (2)", "Füchsin (2)"),
        ("x" * 200, "x" * 50),
        ("...", "drawing"),
    ],
)
def test_a_drawing_keeps_its_name_and_names_no_other_file(name: str, called: str) -> None:
    assert read_query({"name": name}, uploaded=True).name == called


def test_the_page_has_its_parts_and_the_samples(client: TestClient) -> None:
    assert client.get("/page.js").headers["content-type"].startswith("text/javascript")
    assert client.get("/page.css").headers["content-type"].startswith("text/css")
    assert "unsafe" not in client.get("/").headers["content-security-policy"]
    samples = client.get("/samples").json()
    assert sorted(samples) == sorted(client.get("/choices").json()["samples"])
    assert min(len(loop) for loops in samples.values() for loop in loops) >= 3


def test_a_text_is_folded(client: TestClient) -> None:
    if "sans" not in client.get("/choices").json()["fonts"]:
        pytest.skip("fontconfig: not installed")
    state = outcome(client, send(client, text="I", font="sans"))
    assert (state["state"], state["report"]["corners"]) == ("done", 4)


def test_progress_is_told_in_stages(client: TestClient) -> None:
    token = send(client, sample="swan", effort="fast")
    seen: list[tuple[str, float]] = []
    while (state := client.get(f"/jobs/{token}").json())["state"] != "done":
        assert state["state"] in ("waiting", "folding"), state
        seen.append((state["stage"], state["fraction"]))
        time.sleep(0.02)
    assert any(stage and 0 < fraction <= 1 for stage, fraction in seen)
    assert client.get(f"/jobs/{token}").json()["stage"] == "verify"


def test_what_needs_too_much_memory_is_stopped() -> None:
    with running_app(Settings(job_bytes=50_000_000)) as running:
        assert "memory" in outcome(running, send(running, SQUARE, ending=".json"))["error"]


def test_an_upload_is_folded_and_forgotten(client: TestClient) -> None:
    token = send(client, SQUARE, ending=".json")
    assert outcome(client, token)["state"] == "done"
    folder = jobs_of(client).get(token).folder
    assert folder.is_dir()
    assert client.delete(f"/jobs/{token}", headers=OWN).status_code == 204
    assert not folder.exists()
    assert client.get(f"/jobs/{token}").status_code == 404


def test_nothing_is_left_when_the_server_stops() -> None:
    with running_app() as running:
        send(running, SQUARE, ending=".json")
        root = jobs_of(running).root
        assert root.is_dir()
    assert not root.exists()


@pytest.mark.parametrize(
    ("data", "query", "status", "words"),
    [
        (b"{", {"ending": ".exe"}, 400, "drawings end in"),
        (b"{", {"ending": "/../../x.svg"}, 400, "drawings end in"),
        (b"", {"sample": "../../etc/passwd"}, 400, "no sample"),
        (b"", {}, 400, "give a drawing"),
        (b"", {"text": ""}, 400, "give a text"),
        (b"", {"text": "A" * 101}, 400, "give a text"),
        (b"", {"text": "A\0"}, 400, "give a text"),
        (b"", {"text": "A", "font": "/etc/passwd"}, 400, "no font"),
        (SQUARE, {"ending": ".json", "margin": "--force"}, 400, "is not a length"),
        (b" " * 100_001, {"ending": ".json"}, 413, "larger than"),
        (SQUARE, {"ending": ".json", "sheet": "nonsense"}, 400, "nonsense"),
        (SQUARE, {"ending": ".json", "profile": "/etc/x.toml"}, 400, "no machine"),
        (SQUARE, {"ending": ".json", "effort": "best"}, 400, "no effort"),
        (SQUARE, {"ending": ".json", "profile": "laser-dxf", "material": "-o"}, 400, "no material"),
        (SQUARE, {"ending": ".json", "profile": "laser-dxf", "treatment": "melt"}, 400, "no treatment"),
        (SQUARE, {"ending": ".json", "profile": "laser-dxf", "marks": "outline,-o"}, 400, "no mark"),
    ],
)
def test_bad_requests_are_refused(
    client: TestClient, data: bytes, query: dict[str, str], status: int, words: str
) -> None:
    answer = client.post("/jobs", params=query, content=data, headers=OWN)
    assert answer.status_code == status
    assert words in answer.json()["error"]
    assert not list(jobs_of(client).root.iterdir())


def test_bad_drawings_get_their_error_and_no_path_of_the_server(client: TestClient) -> None:
    state = outcome(client, send(client, b"{not json", ending=".json"))
    assert state["state"] == "failed"
    assert "json" in state["error"].lower()
    assert str(jobs_of(client).root) not in json.dumps(state)
    assert state["files"] == []


def test_other_sites_and_other_names_are_refused(client: TestClient) -> None:
    assert client.post("/jobs", params={"sample": "triangle"}).status_code == 403
    token = send(client, SQUARE, ending=".json")
    assert client.delete(f"/jobs/{token}").status_code == 403
    assert client.get("/", headers={"Host": "evil.example"}).status_code == 400
    for path in ("/", "/choices", f"/jobs/{token}", "/jobs/none"):
        headers = client.get(path).headers
        assert headers["x-content-type-options"] == "nosniff"
        assert headers["cache-control"] == "no-store"
        assert headers["cross-origin-resource-policy"] == "same-origin"
        assert "access-control-allow-origin" not in headers
    assert client.get("/").headers["content-security-policy"].startswith("default-src 'none'")
    outcome(client, token)
    assert client.get(f"/jobs/{token}/pattern.svg").headers["content-security-policy"].startswith("sandbox")


@pytest.mark.parametrize(
    ("host", "status"),
    [
        ("127.0.0.1:8000", 200),
        ("localhost:8000", 200),
        ("[::1]:8000", 200),
        ("evil.example", 400),
        ("localhost.evil.example", 400),
        ("", 400),
        ("127.0.0.1@evil.example", 400),
    ],
)
def test_only_names_of_this_machine_are_served(client: TestClient, host: str, status: int) -> None:
    assert client.get("/", headers={"Host": host}).status_code == status


@pytest.mark.parametrize("name", ["..%2f..%2fetc%2fpasswd", "%2e%2e", "drawing.json", "pattern.dxf"])
def test_only_what_a_job_made_can_be_taken(client: TestClient, name: str) -> None:
    token = send(client, SQUARE, ending=".json")
    assert outcome(client, token)["state"] == "done"
    assert client.get(f"/jobs/{token}/{name}").status_code in (404, 405)
    assert client.get(f"/jobs/{token[:-1]}/pattern.svg").status_code == 404


def test_no_more_drawings_than_there_is_room_for_and_old_ones_make_room() -> None:
    with running_app(Settings(most_jobs=1)) as running:
        token = send(running, SQUARE, ending=".json", quick="1")
        answer = running.post("/jobs", params={"sample": "triangle"}, headers=OWN)
        assert (answer.status_code, "too many" in answer.json()["error"]) == (503, True)
        outcome(running, token)
        jobs_of(running).get(token).started -= Settings().keep_seconds + 1
        other = send(running, SQUARE, ending=".json", quick="1")
        assert running.get(f"/jobs/{token}").status_code == 404
        assert [path.name for path in jobs_of(running).root.iterdir()] == [other]


@pytest.mark.parametrize(("host", "hosts"), [("192.0.2.1", ("192.0.2.1",)), ("0.0.0.0", ("*",)), ("::1", ("[::1]",))])
def test_the_server_answers_to_the_address_it_listens_at(
    host: str, hosts: tuple[str, ...], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    apps: list[Any] = []
    listens: list[tuple[str, int]] = []
    free = socket.create_server(("127.0.0.1", 0))
    monkeypatch.setattr("socket.create_server", lambda address, **_: listens.append(address) or free)
    monkeypatch.setattr("uvicorn.Server.run", lambda server, sockets: apps.append((server.config.app, sockets)))
    assert main(["serve", "--host", host]) == 0
    ((app, sockets),) = apps
    (middleware,) = [one for one in app.user_middleware if "allowed_hosts" in one.kwargs]
    assert (listens, sockets) == ([(host, 8000)], [free])
    assert set(hosts) <= set(middleware.kwargs["allowed_hosts"])
    assert ("*" in middleware.kwargs["allowed_hosts"]) == (host == "0.0.0.0")
    out, err = capsys.readouterr()
    assert out.startswith(f"http://{'[::1]' if host == '::1' else host}:8000/")
    assert ("no password" in err) == (host != "::1")


def test_an_address_where_nobody_can_listen_is_an_error_of_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = str(taken.getsockname()[1])
        assert main(["serve", "--port", port]) == 2
    assert main(["serve", "--job-seconds", "-1"]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.splitlines() == [
        f"foldcut: error: cannot listen at 127.0.0.1:{port}: Address already in use; give another --port or --host",
        "foldcut: error: --job-seconds is -1; give a positive number below 1e8",
    ]


def test_what_takes_too_long_is_stopped() -> None:
    with running_app(Settings(job_seconds=0.2)) as running:
        state = outcome(running, send(running, sample="swan", effort="normal"))
        assert "took more than 0.2 s" in state["error"]


def test_what_takes_too_long_goes_on_with_the_best_pattern_so_far(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("foldcut.web.jobs.GRACE_S", 60.0)
    with running_app(Settings(job_seconds=60.0)) as running:
        angles = np.sort(np.random.default_rng(2).uniform(0, 2 * np.pi, 70))
        oval = np.column_stack([90 * np.cos(angles), 60 * np.sin(angles)]).tolist()
        token = send(running, json.dumps({"loops": [oval]}).encode(), ending=".json", folds="1")
        job = jobs_of(running).get(token)
        for _ in range(1200):
            if job.patterns or job.state in ("done", "failed"):
                break
            time.sleep(0.05)
        assert job.patterns, "the first pattern is told at once"
        assert job.process is not None
        job.process.send_signal(signal.SIGINT)
        state = outcome(running, token)
        assert state["state"] == "done", state["error"]
        assert state["report"]["ladder"]["interrupted"]


def test_what_has_found_its_pattern_may_write_it_when_the_time_is_over(monkeypatch: pytest.MonkeyPatch) -> None:
    told = "print(json.dumps({'stage': 'verify', 'fraction': 1.0}), file=sys.stderr, flush=True)"
    monkeypatch.setattr("foldcut.web.jobs.START", f"import json, sys, time; {told}; time.sleep(2.5); print('{{}}')")
    with running_app(Settings(job_seconds=2.0)) as running:
        state = outcome(running, send(running, sample="star"))
        assert state["state"] == "done", state["error"]


def test_how_near_the_outline_stays_is_told_to_the_command() -> None:
    query = {"sample": "star", "level": "fine", "folds": "40", "small-parts": "keep", "tolerance": "1cm"}
    words = read_query(query, uploaded=False).options
    assert "--open" not in words
    assert "--open" in read_query({**query, "open": "1"}, uploaded=False).options
    assert {"--level", "fine", "--folds", "40", "--small-parts", "keep", "--tolerance=10.0mm"} <= set(words)
    for name, value in (("level", "rough"), ("folds", "-1"), ("folds", "1e9"), ("folds", "٣"), ("small-parts", "eat")):
        with pytest.raises(RefusedError):
            read_query({"sample": "star", name: value}, uploaded=False)


def test_cancelling_kills_the_process(client: TestClient) -> None:
    token = send(client, sample="swan", effort="fast")
    job = jobs_of(client).get(token)
    for _ in range(100):
        if job.process is not None:
            break
        time.sleep(0.05)
    assert job.process is not None
    assert client.delete(f"/jobs/{token}", headers=OWN).status_code == 204
    assert job.process.returncode is not None


@dataclass(frozen=True)
class Server:
    """A server in a process of its own."""

    address: str
    pid: int


@pytest.fixture
def server() -> Iterator[Server]:
    """Give a server started by the command line; Ctrl-C ends it."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    command = [sys.executable, "-m", "foldcut.cli", "serve", "--port", str(port)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as started:
        assert started.stdout is not None
        assert started.stdout.readline().startswith(f"http://127.0.0.1:{port}/ ")
        for _ in range(200):
            with socket.socket() as tried:
                if tried.connect_ex(("127.0.0.1", port)) == 0:
                    break
            time.sleep(0.05)
        yield Server(f"http://127.0.0.1:{port}/", started.pid)
        started.send_signal(signal.SIGINT)
        assert started.wait(20) in (0, 130)


RETURNS_WITHIN = 32 * 2**20
"""Bytes that the server may hold more after twenty drawings of 4 MB than before: what Python's allocator keeps."""


def memory(pid: int) -> int:
    """Return the bytes that a process has in memory (Linux)."""
    status = Path(f"/proc/{pid}/status").read_text()
    return int(status.partition("VmRSS:")[2].split()[0]) * 1024


def test_twenty_five_uploads_at_once_five_of_them_hostile(server: Server) -> None:
    padded = SQUARE + b" " * 4_000_000
    hostile = [
        b"[" * 4_000_000,
        b'{"loops": [[[0,0],[1e999,0],[0,1]]]}',
        b"\xff\xfe" * 1_000_000,
        b'{"loops": "../../etc/passwd"}',
        b" " * 5_000_001,
    ]
    drawings = [padded] * 20 + hostile

    with httpx2.Client(base_url=server.address, headers=OWN, timeout=300) as client, ThreadPoolExecutor(25) as pool:

        def outcome_of(data: bytes) -> tuple[str, str]:
            answer = client.post("/jobs", params={"ending": ".json", "effort": "fast"}, content=data)
            if answer.status_code != 201:
                return "refused", answer.json()["error"]
            token = answer.json()["job"]
            while (state := client.get(f"/jobs/{token}").json())["state"] in ("waiting", "folding"):
                time.sleep(0.5)
            if state["state"] == "done":
                assert client.get(f"/jobs/{token}/pattern.svg").content.startswith(b"<?xml")
            assert client.delete(f"/jobs/{token}").status_code == 204
            return state["state"], state["error"]

        too_large = [hostile[-1]] * 25
        list(pool.map(outcome_of, [padded, *hostile, *too_large]))  # what is loaded or kept once is so now
        before = memory(server.pid)
        outcomes = list(pool.map(outcome_of, drawings))
        after = memory(server.pid)
    assert [state for state, _ in outcomes] == ["done"] * 20 + ["failed"] * 4 + ["refused"], outcomes
    for _, error in outcomes[20:]:
        assert error
        assert "Traceback" not in error
    assert after - before < RETURNS_WITHIN, f"{before / 2**20:.1f} MiB before, {after / 2**20:.1f} MiB after"


def test_the_page_works_in_a_browser(server: Server, tmp_path: Path) -> None:
    drawing = tmp_path / "square.json"
    drawing.write_bytes(SQUARE)
    seen = run_node("serve.cjs", require_program("chromium"), server.address, drawing, timeout=300)
    assert seen["complaints"] == []
    assert seen["refused"] == 1
    assert seen["foreign"] == []
    assert seen["serious"] == []
    assert seen["heights"] == [900, 900, 900], "nothing is below the fold"
    assert seen["wide"] <= 390
    assert seen["top"] < 844 / 2, "on a phone the pattern is on top"
    needed = ["download", "file", "new", "sample", "level", "sheet", "margin", "corner", "pattern-held", "play", "fold"]
    assert [name for name in seen["reached"] if name in needed] == needed
    for name in ("first", "triangle", "chosen", "dropped", "typed", "drawn", "moved"):
        assert seen[name]["said"].startswith("Verified"), name
        assert seen[name]["folds"] > 0, name
        assert seen[name]["lines"] > 4, name
    assert [seen[name]["name"] for name in ("triangle", "chosen", "dropped", "drawn")] == [
        *("triangle", "square", "dropped one", "drawing"),
    ]
    assert seen["over"] == 1
    assert seen["names"] == ["triangle.pdf", "triangle-job.dxf", "triangle.svg", "dropped one.fold"]
    assert base64.b64decode(seen["pdf"]).startswith(b"%PDF")
    assert corners(seen["corners"]) == pytest.approx([20, 20, 80, 20, 40, 80], abs=1.5)
    assert corners(seen["after"]) != corners(seen["corners"])
    assert seen["shared"] == seen["after"], "the drawing is in the link"
    assert seen["kept"] == [True, True, False]
    assert "nonsense" in seen["bad"]
    assert seen["stale"]
    assert seen["easy"] == "the fewest folds"
    assert seen["stopped"] == "Stopped."
    ours = tmp_path / "job.dxf"
    assert main(["make", "triangle", "--effort", "fast", "--profile", "laser-dxf", "-o", str(ours), "--quiet"]) == 0
    assert without_recipe(base64.b64decode(seen["dxf"])) == without_recipe(ours.read_bytes())
    assert main(["make", "triangle", "--effort", "fast", "-o", str(tmp_path / "made.svg"), "--quiet"]) == 0
    assert without_recipe(base64.b64decode(seen["svg"])) == without_recipe((tmp_path / "made.svg").read_bytes())


def corners(text: str) -> list[float]:
    """Return the numbers of the corners in the page's field."""
    return [float(number) for pair in text.split() for number in pair.split(",")]
