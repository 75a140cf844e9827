"""Drawings that the server folds: each by the real command line, in a process and a temporary folder of its own.

So a bad drawing meets the same limits as on the command line, cannot reach another drawing's files, and cannot take
the server down: its process is told to end after ``Settings.job_seconds``, is killed soon after that, and may use
``Settings.job_bytes`` of memory. Formats that are not made at once are made from the FOLD file when the page asks for
them. Folders are deleted with their drawing, after ``Settings.keep_seconds``, and all of them when the server stops.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import os
import secrets
import shutil
import signal
import sys
import tempfile
import time
from collections import deque
from collections.abc import AsyncIterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from foldcut.exporters import JOB_EXPORTERS, PATTERN_EXPORTERS
from foldcut.web.errors import RefusedError
from foldcut.web.options import Wanted

__all__ = ["Jobs", "Settings", "Upload"]

PATTERN = "pattern.fold"
"""The file that all others can be made from."""
PAGE = "pattern.html"
"""The file that has the pattern as the page shows it."""
SO_FAR = "so-far.html"
"""The same for the best pattern found so far, beside the folder of files that can be taken."""
QUICK_FILES = (PATTERN, PAGE)
"""The files of a quick look."""
FILES = ("pattern.svg", PATTERN, PAGE, "pattern.png", "pattern.zip")
"""The files that are made at once where there is no machine; the others are made when the page asks for them."""
MACHINE_FILES = (PATTERN, PAGE, "pattern.png", "job.zip")
"""The files that are made at once for a machine, beside the job in the machine's own format."""
PRINTED = ("pattern-kit.pdf", "pattern.pdf")
"""What to print where there is no machine: the command line takes a usual printer for it."""
GUIDES = {"guide.pdf": "guide", "guide.html": "guide", "pictures.svg": "draw", "pictures.png": "draw"}
"""Files that other commands than ``make`` write, and these commands."""
GRACE_S = 15.0
"""How long a command may take, once its time is over, to verify the best pattern so far and to write it."""
START = (
    "import sys; from foldcut.core.processes import die_with_parent; die_with_parent(); "
    "from foldcut.cli.main import main; sys.exit(main())"
)
"""What a process runs: the command line, which ends with the server even if that is killed."""
TOKEN_BYTES = 16
"""A drawing's token is so long that nobody can guess it: whoever knows it may take the files."""


@dataclass(frozen=True)
class Settings:
    """What the server allows.

    ``upload_bytes``: the size of a drawing; ``job_seconds`` and ``job_bytes``: the time and memory to fold it;
    ``quick_seconds``: the time for a quick look while the drawing is being changed; ``workers``: how many are folded
    at once; ``most_jobs``: how many are kept, and ``most_jobs_each`` of one client; ``keep_seconds``: how long;
    ``hosts``: the names of this machine. ``stall_seconds``: how long to wait for more of a drawing, or for a request;
    ``upload_seconds``: how long a drawing may be on its way; ``connections_each``: how many one client may have.
    """

    upload_bytes: int = 5_000_000
    job_seconds: float = 60.0
    job_bytes: int = 4 * 2**30
    quick_seconds: float = 20.0
    workers: int = 2
    most_jobs: int = 200
    most_jobs_each: int = 100
    keep_seconds: float = 1800.0
    hosts: tuple[str, ...] = ("127.0.0.1", "localhost", "[::1]")
    stall_seconds: float = 10.0
    upload_seconds: float = 60.0
    connections_each: int = 100


@dataclass
class Upload:
    """One drawing that is being folded, or was: its folder, how far it is, and the report or the error.

    ``state`` is "waiting", "folding", "done" or "failed"; ``stage`` and ``fraction``, from 0 to 1, are what the command
    tells of its progress, ``patterns`` the numbers of those found so far; ``started`` is in seconds of the monotonic
    clock; ``client``: the address that it came from.
    """

    folder: Path
    wanted: Wanted
    state: str = "waiting"
    stage: str = ""
    fraction: float = 0.0
    patterns: list[dict[str, Any]] = field(default_factory=list)
    error: str = ""
    report: dict[str, Any] = field(default_factory=dict)
    started: float = field(default_factory=time.monotonic)
    process: asyncio.subprocess.Process | None = None
    task: asyncio.Task[None] | None = None
    client: str = ""

    @property
    def made(self) -> Path:
        """The folder of the files that can be taken."""
        return self.folder / "made"

    def files(self) -> dict[str, Path]:
        """Return the files that can be taken, by name."""
        return {path.name: path for path in sorted(self.made.iterdir())} if self.state == "done" else {}

    def possible_files(self) -> list[str]:
        """Return the names of all files that can be made when the page asks for them."""
        patterns = ["pattern.zip", *(f"pattern{ending}" for ending in PATTERN_EXPORTERS)]
        jobs = [f"job{ending}" for ending in JOB_EXPORTERS] if self.wanted.machine else PRINTED
        return [*GUIDES, *patterns, *jobs]

    def shown(self) -> bytes | None:
        """Return the page of the best pattern so far, None where there is none yet."""
        path = self.made / PAGE if self.state == "done" else self.folder / SO_FAR
        return path.read_bytes() if path.is_file() else None

    def called(self, name: str) -> str:
        """Return what a file is called where it is taken: after the drawing."""
        rest = name.removeprefix("pattern")
        return f"{self.wanted.name}{rest if rest != name else f'-{name}'}"


class _Turns:
    """Who may fold: so many at once, and clients in turn, so that nobody waits for all drawings of another."""

    def __init__(self, free: int) -> None:
        self.free = free
        self.waiting: dict[str, deque[asyncio.Future[None]]] = {}

    @contextlib.asynccontextmanager
    async def turn(self, client: str) -> AsyncIterator[None]:
        """Wait for a turn, and give it back."""
        if self.free:
            self.free -= 1
        else:
            mine: asyncio.Future[None] = asyncio.get_running_loop().create_future()
            self.waiting.setdefault(client, deque()).append(mine)
            try:
                await mine
            except asyncio.CancelledError:
                if mine.done() and not mine.cancelled():
                    self._give_back()
                raise
        try:
            yield
        finally:
            self._give_back()

    def _give_back(self) -> None:
        """Let the next one have a turn: of the client that had none for longest."""
        while self.waiting:
            client = next(iter(self.waiting))
            queue = self.waiting.pop(client)
            following = queue.popleft()
            if queue:
                self.waiting[client] = queue  # at the end
            if not following.done():
                following.set_result(None)
                return
        self.free += 1


class Jobs:
    """All drawings of a server, by token."""

    def __init__(self, settings: Settings) -> None:
        self.settings = settings
        self.root = Path(tempfile.mkdtemp(prefix="foldcut-"))
        self.uploads: dict[str, Upload] = {}
        self.turns = _Turns(settings.workers)

    def require_room(self, client: str = "") -> None:
        """Forget old drawings; raises ``RefusedError`` where there is no room for another, or none of this client."""
        oldest = time.monotonic() - self.settings.keep_seconds
        for token, upload in list(self.uploads.items()):
            if upload.started < oldest and upload.state in ("done", "failed"):
                shutil.rmtree(self.uploads.pop(token).folder, ignore_errors=True)
        if len(self.uploads) >= self.settings.most_jobs:
            raise RefusedError(503, "the server has too many drawings; try again in a while")
        if sum(upload.client == client for upload in self.uploads.values()) >= self.settings.most_jobs_each:
            raise RefusedError(429, "the server has too many of your drawings; close some, or try again in a while")

    def new_path(self) -> Path:
        """Return a new path for the bytes of a drawing, to write them to before it is added."""
        return self.root / f"upload-{secrets.token_urlsafe(TOKEN_BYTES)}"

    def add(self, wanted: Wanted, received: Path | None = None, ending: str = "", client: str = "") -> str:
        """Start to fold what is wanted and return its token; a ``received`` drawing is moved, and gets its ending."""
        self.require_room(client)
        token = secrets.token_urlsafe(TOKEN_BYTES)
        upload = Upload(self.root / token, wanted, client=client)
        drawing = upload.folder / "given" / f"{wanted.name}{ending}"
        upload.made.mkdir(parents=True)
        if received is not None:
            drawing.parent.mkdir()
            received.rename(drawing)
        self.uploads[token] = upload
        source = wanted.source if received is None else (str(drawing),)
        upload.task = asyncio.create_task(self._fold(upload, source))
        return token

    async def _fold(self, upload: Upload, source: tuple[str, ...]) -> None:
        """Fold a drawing and make the files that are there at once."""
        wanted = upload.wanted
        machine = () if wanted.quick else wanted.machine
        names = (*MACHINE_FILES, f"job.{wanted.machine_format}") if machine else FILES
        outputs = [
            word for name in (QUICK_FILES if wanted.quick else names) for word in ("-o", str(upload.made / name))
        ]
        so_far = ("--so-far", str(upload.folder / SO_FAR))
        command = ["make", *source, *wanted.options, "--progress", *so_far, "--json", *machine, *outputs]
        seconds = self.settings.quick_seconds if wanted.quick else self.settings.job_seconds
        try:
            upload.report, upload.error = await self._run(upload, command, seconds)
        except RefusedError as error:
            upload.error = str(error)
        upload.state = "failed" if upload.error else "done"

    async def _run(self, upload: Upload, command: list[str], seconds: float) -> tuple[dict[str, Any], str]:
        """Run one command for a drawing when its turn comes; return its report, and its error or an empty text."""
        async with self.turns.turn(upload.client):
            if not upload.folder.is_dir():
                raise RefusedError(404, "this drawing is gone; send it again")
            upload.state = "folding" if upload.state == "waiting" else upload.state
            process = upload.process = await asyncio.create_subprocess_exec(
                *(sys.executable, "-c", START, *command),
                stdin=asyncio.subprocess.DEVNULL,
                stdout=asyncio.subprocess.PIPE,
                stderr=asyncio.subprocess.PIPE,
                cwd=upload.folder,
                start_new_session=True,
            )
            try:
                _bound_memory(process.pid, self.settings.job_bytes)
                assert process.stdout is not None
                ending = asyncio.gather(process.stdout.read(), _follow(process, upload), process.wait())
                late = not (await asyncio.wait([ending], timeout=seconds))[0]
                if late:
                    if upload.fraction < 1:  # as Ctrl-C does: it goes on with the best pattern so far
                        with contextlib.suppress(ProcessLookupError):
                            process.send_signal(signal.SIGINT)
                    await asyncio.wait([ending], timeout=GRACE_S)
                if not ending.done() or (late and process.returncode):
                    remedy = "press Search longer" if upload.wanted.quick else "simplify the drawing"
                    return {}, f"it took more than {seconds:g} s; {remedy}"
                out, _, status = ending.result()
            finally:
                await _kill(process)
        for folder in (upload.made, upload.folder / "given", upload.folder):
            out = out.replace(f"{folder}/".encode(), b"")
        report = _parsed(out)
        error = report.pop("error", None) or {"message": "no pattern was made; it needs too much memory, or is broken"}
        return report, "" if status == 0 else str(error["message"])

    async def export(self, upload: Upload, name: str) -> None:
        """Make one more file from the FOLD file of a drawing that is folded; raises ``RefusedError`` if that fails."""
        if PATTERN not in upload.files():
            raise RefusedError(409, "there is no pattern yet to make files of")
        if name in upload.files():
            return
        making = upload.folder / secrets.token_hex(4)
        making.mkdir()
        machine = upload.wanted.machine if name.startswith("job.") else ()
        verb = GUIDES.get(name, "make")
        command = [verb, str(upload.made / PATTERN), "--json", *machine, "-o", str(making / name)]
        _, error = await self._run(upload, command, self.settings.job_seconds)
        if error:
            raise RefusedError(400, error)
        with contextlib.suppress(FileNotFoundError):  # the drawing may have been dropped meanwhile
            for made in making.iterdir():  # a job may have a file for each tool
                made.replace(upload.made / made.name)

    def get(self, token: str) -> Upload:
        """Return a drawing; raises ``RefusedError`` for an unknown token."""
        if token not in self.uploads:
            raise RefusedError(404, "there is no such drawing, or it is too old; send it again")
        return self.uploads[token]

    async def drop(self, token: str) -> None:
        """Stop folding a drawing and delete its files."""
        upload = self.get(token)
        del self.uploads[token]
        if upload.task is not None:
            upload.task.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await upload.task
        if upload.process is not None:
            await _kill(upload.process)
        shutil.rmtree(upload.folder, ignore_errors=True)

    async def close(self) -> None:
        """Stop everything and leave nothing behind."""
        for token in list(self.uploads):
            await self.drop(token)
        shutil.rmtree(self.root, ignore_errors=True)


async def _follow(process: asyncio.subprocess.Process, upload: Upload) -> None:
    """Read a command's standard error to the end, and keep the progress that it tells."""
    assert process.stderr is not None
    while True:
        try:
            line = await process.stderr.readline()
        except ValueError:  # what asyncio raises for a line that is longer than any of ours
            continue
        if not line:
            return
        told = _parsed(line)
        if told.keys() >= {"stage", "fraction"}:
            upload.stage, upload.fraction = str(told["stage"]), float(told["fraction"])
        if isinstance(told.get("pattern"), dict):
            upload.patterns.append(told["pattern"])


def _parsed(data: bytes) -> dict[str, Any]:
    """Return the JSON object in this text; an empty one where a program that broke down wrote something else."""
    try:
        parsed = json.loads(data)
    except (json.JSONDecodeError, UnicodeDecodeError):
        return {}
    return parsed if isinstance(parsed, dict) else {}


async def _kill(process: asyncio.subprocess.Process) -> None:
    """End a process and all that it started."""
    if process.returncode is None:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        await process.wait()


def _bound_memory(pid: int, most: int) -> None:
    """Let a process have no more memory than this, where the system can do that."""
    with contextlib.suppress(ImportError, AttributeError, OSError):
        import resource

        resource.prlimit(pid, resource.RLIMIT_AS, (most, most))
