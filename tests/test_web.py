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
from pathlib import Path
from typing import Any

import pytest
from programs import require_program, run_node
from starlette.testclient import TestClient

from foldcut.cli import main
from foldcut.samples import sample_path
from foldcut.web.app import Jobs, Settings, make_app

OWN = {"X-Foldcut": "1"}
SQUARE = json.dumps({"loops": [[[0, 0], [40, 0], [40, 40], [0, 40]]], "units": "mm"}).encode()


def running_app(settings: Settings | None = None) -> TestClient:
    """Return an app to use in a ``with`` statement, under the name that browsers on this machine use."""
    return TestClient(make_app(settings), base_url="http://127.0.0.1")


@pytest.fixture
def client() -> Iterator[TestClient]:
    """Give a running app with a short temper."""
    with running_app(Settings(upload_bytes=100_000, job_seconds=50)) as running:
        yield running


def send(client: TestClient, data: bytes = b"", **query: str) -> str:
    """Start a job and return its token."""
    answer = client.post("/jobs", params={"effort": "fast", **query}, content=data, headers=OWN)
    assert answer.status_code == 201, answer.text
    token: str = answer.json()["job"]
    return token


def outcome(client: TestClient, token: str) -> dict[str, Any]:
    """Wait for a job."""
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
    assert set(state["files"]) == {"job.zip", "pattern.fold", "pattern.html", "pattern.png"}
    archive = zipfile.ZipFile(io.BytesIO(client.get(f"/jobs/{token}/job.zip").content))
    (dxf,) = [name for name in archive.namelist() if name.endswith(".dxf")]
    ours = tmp_path / "job.dxf"
    command = ["make", str(sample_path("triangle")), "--effort", "fast", "--profile", "laser-dxf", "-o", str(ours)]
    assert main([*command, "--quiet"]) == 0
    assert archive.read(dxf) == ours.read_bytes()


def test_any_format_is_made_when_it_is_asked_for(client: TestClient, tmp_path: Path) -> None:
    token = send(client, sample="triangle", profile="laser-dxf")
    more = outcome(client, token)["more"]
    assert {"job.dxf", "job.svg", "pattern.svg", "pattern.cp", "pattern.stl", "guide.pdf", "pictures.svg"} <= set(more)
    for name in ("job.dxf", "pattern.svg", "pattern.zip", "guide.pdf", "pictures.svg"):
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
    ours = {ending: tmp_path / f"ours.{ending}" for ending in ("dxf", "svg")}
    assert main(["make", "triangle", "--effort", "fast", "--quiet", "-o", str(ours["svg"])]) == 0
    machine = ["--profile", "laser-dxf", "-o", str(ours["dxf"])]
    assert main(["make", "triangle", "--effort", "fast", "--quiet", *machine]) == 0
    assert client.get(f"/jobs/{token}/job.dxf").content == ours["dxf"].read_bytes()
    assert client.get(f"/jobs/{token}/pattern.svg").content == ours["svg"].read_bytes()


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


def test_a_quick_look_makes_the_page_only(client: TestClient) -> None:
    state = outcome(client, send(client, SQUARE, ending=".json", quick="1", profile="laser-dxf"))
    assert state["files"] == ["pattern.html"]
    assert state["report"]["warnings"] is not None


def test_a_text_is_folded(client: TestClient) -> None:
    if "sans" not in client.get("/choices").json()["fonts"]:
        pytest.skip("fontconfig: not installed")
    state = outcome(client, send(client, text="I", font="sans"))
    assert (state["state"], state["report"]["corners"]) == ("done", 4)


def test_progress_is_told_in_stages(client: TestClient) -> None:
    token = send(client, sample="swan", effort="normal")
    seen: dict[str, float] = {}
    while (state := client.get(f"/jobs/{token}").json())["state"] != "done":
        assert state["state"] in ("waiting", "folding"), state
        seen[state["stage"].partition(":")[0]] = state["fraction"]
        time.sleep(0.05)
    assert "searching" in seen
    assert 0 < seen["searching"] <= 1
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


def test_what_takes_too_long_is_stopped() -> None:
    with running_app(Settings(job_seconds=0.2)) as running:
        state = outcome(running, send(running, sample="swan", effort="normal"))
        assert "took more than 0.2 s" in state["error"]


def test_cancelling_kills_the_process(client: TestClient) -> None:
    token = send(client, sample="swan", effort="normal")
    job = jobs_of(client).get(token)
    for _ in range(100):
        if job.process is not None:
            break
        time.sleep(0.05)
    assert job.process is not None
    assert client.delete(f"/jobs/{token}", headers=OWN).status_code == 204
    assert job.process.returncode is not None


def test_fifty_uploads_at_once_five_of_them_hostile(client: TestClient) -> None:
    hostile = [
        b"{",
        b"[" * 50_000,
        b'{"loops": [[[0,0],[1e999,0],[0,1]]]}',
        b"\xff\xfe",
        b'{"loops": "../../etc/passwd"}',
    ]
    drawings = [SQUARE] * 45 + hostile
    with ThreadPoolExecutor(10) as pool:
        tokens = list(pool.map(lambda data: send(client, data, ending=".json"), drawings))
    assert len(set(tokens)) == 50
    states = [outcome(client, token) for token in tokens]
    assert [state["state"] for state in states] == ["done"] * 45 + ["failed"] * 5
    for state in states[45:]:
        assert state["error"]
        assert "Traceback" not in state["error"]
    for token in tokens:
        client.delete(f"/jobs/{token}", headers=OWN)
    assert not jobs_of(client).jobs
    assert not list(jobs_of(client).root.iterdir())


@pytest.fixture
def address() -> Iterator[str]:
    """Give the address of a server started by the command line; Ctrl-C ends it."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    command = [sys.executable, "-m", "foldcut.cli", "serve", "--port", str(port)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server:
        assert server.stdout is not None
        assert server.stdout.readline().startswith(f"http://127.0.0.1:{port}/ ")
        for _ in range(200):
            with socket.socket() as tried:
                if tried.connect_ex(("127.0.0.1", port)) == 0:
                    break
            time.sleep(0.05)
        yield f"http://127.0.0.1:{port}/"
        server.send_signal(signal.SIGINT)
        assert server.wait(20) in (0, 130)


def test_the_page_works_in_a_browser(address: str, tmp_path: Path) -> None:
    drawing = tmp_path / "square.json"
    drawing.write_bytes(SQUARE)
    chromium = require_program("chromium")
    seen = run_node("serve.cjs", chromium, address, drawing, tmp_path / "page.png")
    assert seen["complaints"] == []
    assert seen["foreign"] == []
    assert seen["serious"] == []
    assert seen["cancelled"]
    for name in ("sample", "file", "drawn"):
        assert "verified" in seen[name]["said"], name
        assert {"pattern.svg", "pattern.fold", "job.zip"} <= set(seen[name]["files"]), name
    assert "mountains" in seen["shown"]
    corners = [float(number) for pair in seen["corners"].split() for number in pair.split(",")]
    assert corners == pytest.approx([20, 20, 80, 20, 40, 80], abs=0.6)
    archive = zipfile.ZipFile(io.BytesIO(base64.b64decode(seen["zip"])))
    (dxf,) = [name for name in archive.namelist() if name.endswith(".dxf")]
    ours = tmp_path / "job.dxf"
    assert main(["make", "triangle", "--effort", "fast", "--profile", "laser-dxf", "-o", str(ours), "--quiet"]) == 0
    assert archive.read(dxf) == ours.read_bytes()
