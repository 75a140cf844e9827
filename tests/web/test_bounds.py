"""What the server does with clients that stall, leave, or ask for too much, and with what is broken on its side."""

from __future__ import annotations

import asyncio
import json
import os
import select
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path

import pytest
from starlette.testclient import TestClient

from foldcut.cli.main import main
from foldcut.profiles import known_profiles
from foldcut.web.app import make_app
from foldcut.web.errors import RefusedError
from foldcut.web.jobs import Jobs, Settings
from foldcut.web.options import machines, read_query

SERVE = """
import sys
from foldcut.web import jobs
for name in ("stall_seconds", "connections_each"):
    default = {"stall_seconds": 1.0, "connections_each": 10}[name]
    at = jobs.Settings.__init__.__code__.co_varnames.index(name) - 1
    defaults = list(jobs.Settings.__init__.__defaults__)
    defaults[at] = default
    jobs.Settings.__init__.__defaults__ = tuple(defaults)
from foldcut.cli.main import main
sys.exit(main(["serve", "--port", sys.argv[1]]))
"""
"""A server that waits for one second, and takes ten connections of a client."""


@dataclass
class Server:
    """A server in a process of its own, and what it prints on standard error."""

    process: subprocess.Popen[str]
    port: int
    errors: Path
    opened: list[socket.socket] = field(default_factory=list)

    def connect(self) -> socket.socket:
        """Return a new connection."""
        self.opened.append(socket.create_connection(("127.0.0.1", self.port), timeout=20))
        return self.opened[-1]

    def ask(self, what: str, *, body: bytes = b"", length: int | None = None) -> socket.socket:
        """Send a request, perhaps only a part of its body, and return the connection."""
        here = self.connect()
        size = len(body) if length is None else length
        head = f"{what} HTTP/1.1\r\nHost: 127.0.0.1:{self.port}\r\nX-Foldcut: 1\r\nContent-Length: {size}\r\n\r\n"
        here.sendall(head.encode() + body)
        return here

    def stop(self) -> float:
        """Press Ctrl-C, and return how long the server takes to end."""
        started = time.monotonic()
        self.process.send_signal(signal.SIGINT)
        assert self.process.wait(20) in (0, 130)
        return time.monotonic() - started


@contextmanager
def started(folder: Path) -> Iterator[Server]:
    """Give a running server, whose errors go to a file in a folder."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    with (
        (folder / "errors").open("w") as errors,
        subprocess.Popen(
            [sys.executable, "-c", SERVE, str(port)], stdout=subprocess.PIPE, stderr=errors, text=True
        ) as process,
    ):
        assert process.stdout is not None
        assert process.stdout.readline().startswith("http://")
        for _ in range(200):
            with socket.socket() as tried:
                if tried.connect_ex(("127.0.0.1", port)) == 0:
                    break
            time.sleep(0.05)
        running = Server(process, port, folder / "errors")
        yield running
        for one in running.opened:
            one.close()
        process.kill()


@pytest.fixture
def server(tmp_path: Path) -> Iterator[Server]:
    """Give a server that the test may end."""
    with started(tmp_path) as running:
        yield running


@pytest.fixture(scope="module")
def lasting(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    """Give a server that goes on."""
    with started(tmp_path_factory.mktemp("server")) as running:
        yield running


def test_what_stalls_ends_and_what_leaves_leaves_no_traceback(lasting: Server) -> None:
    server = lasting
    started = time.monotonic()
    idle, slow = server.connect(), server.connect()
    slow.sendall(b"GET / HTTP/1.1\r\nHos")
    stalled = server.ask("POST /jobs?ending=.json", body=b"abc", length=1000)
    for ending in (".json", ".svg", ".pdf"):
        server.ask(f"POST /jobs?ending={ending}", body=b"abc", length=1000).close()
    server.ask("GET /choices").close()
    server.connect().close()
    answer = stalled.recv(10_000) + stalled.recv(10_000)
    assert answer.startswith(b"HTTP/1.1 408 ")
    assert b"send it again" in answer
    for one in (idle, slow):
        with suppress(ConnectionResetError):
            assert one.recv(10) == b""
    assert time.monotonic() - started < 15
    assert server.ask("GET /").recv(12) == b"HTTP/1.1 200"
    assert "Traceback" not in server.errors.read_text()


def test_one_client_cannot_have_all_connections(lasting: Server) -> None:
    for one in lasting.opened:
        one.close()
    time.sleep(0.5)  # until the server knows
    several = [lasting.connect() for _ in range(15)]
    closed: list[socket.socket] = []
    for _ in range(100):
        closed, _, _ = select.select(several, [], [], 0)
        if len(closed) >= 5:
            break
        time.sleep(0.02)
    assert closed == several[10:]


def test_the_server_stops_within_seconds_whatever_is_under_way(server: Server) -> None:
    server.connect()
    server.ask("POST /jobs?ending=.json", body=b"abc", length=1000)
    assert server.ask("POST /jobs?sample=letter-a").recv(12) == b"HTTP/1.1 201"
    time.sleep(0.5)
    assert server.stop() < 5
    assert "Traceback" not in server.errors.read_text()


@pytest.mark.skipif(sys.platform != "linux", reason="Linux tells a process that its parent ended")
def test_what_folds_ends_with_a_server_that_is_killed(server: Server) -> None:
    assert server.ask("POST /jobs?sample=letter-a").recv(12) == b"HTTP/1.1 201"
    pid = server.process.pid
    for _ in range(100):
        children = Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
        if children and b"die_with_parent" in Path(f"/proc/{children[0]}/cmdline").read_bytes():
            break
        time.sleep(0.05)
    time.sleep(0.5)
    server.process.kill()
    for _ in range(100):
        if not any(Path(f"/proc/{child}").exists() for child in children):
            return
        time.sleep(0.05)
    raise AssertionError("it goes on")


def test_one_client_cannot_take_all_places() -> None:
    async def run() -> None:
        jobs = Jobs(Settings(most_jobs=4, most_jobs_each=2, workers=0))
        wanted = read_query({"sample": "swan"}, uploaded=False)
        for _ in range(2):
            jobs.add(wanted, client="one")
        with pytest.raises(RefusedError, match="too many of your drawings") as refused:
            jobs.add(wanted, client="one")
        assert refused.value.status == 429
        jobs.add(wanted, client="other")
        await jobs.close()

    asyncio.run(run())


def test_clients_fold_in_turn() -> None:
    async def run() -> None:
        jobs = Jobs(Settings(workers=1))
        order: list[str] = []

        async def fold(client: str) -> None:
            async with jobs.turns.turn(client):
                order.append(client)
                await asyncio.sleep(0)

        tasks = [asyncio.create_task(fold(client)) for client in ("a", "a", "a", "a", "b", "c", "b")]
        await asyncio.sleep(0)
        tasks[1].cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        assert order == ["a", "b", "c", "a", "b", "a"]
        assert jobs.turns.free == 1
        await jobs.close()

    asyncio.run(run())


@pytest.mark.parametrize("content", [b"name = ", b"\xff\xfe", b'base = ["nothing"]\n'], ids=["toml", "bytes", "base"])
def test_one_broken_profile_does_not_take_the_list_down(
    content: bytes, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "foldcut" / "profiles"
    folder.mkdir(parents=True)
    (folder / "mine.toml").write_bytes(content)
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    machines.cache_clear()
    try:
        with TestClient(make_app(Settings()), base_url="http://127.0.0.1") as client:
            answer = client.get("/choices")
        assert answer.status_code == 200
        assert "grbl-laser" in answer.json()["machines"]
        assert "mine" not in answer.json()["machines"]
    finally:
        machines.cache_clear()
    assert main(["profiles"]) == 0
    told = capsys.readouterr()
    assert "grbl-laser" in told.out
    assert "left out: profile" in told.err
    assert told.err.count("\n") == 1
    assert main(["profiles", "--json"]) == 0
    assert list(json.loads(capsys.readouterr().out)["broken"]) == ["mine"]


def test_a_profile_that_is_no_file_is_not_in_the_list(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "foldcut" / "profiles"
    folder.mkdir(parents=True)
    os.symlink("loop.toml", folder / "loop.toml")
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    known, broken = known_profiles()
    assert "grbl-laser" in known
    assert list(broken) == ["loop"]
