"""The web app: a drawing comes in, ``foldcut make`` runs in a process of its own, its files are there to take.

Each job runs the real command line in its own temporary folder, so a bad drawing meets the same limits as on the
command line, cannot reach another job's files, and cannot take the server down: it is killed after
``Settings.job_seconds``. Folders go away when a job is deleted or old, and all of them when the server stops.

Requests that change something need the header ``X-Foldcut``, which no other site's form or script may send, and every
request must name this machine in ``Host``, against names that others make point here (DNS rebinding).
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import secrets
import shutil
import sys
import tempfile
import time
from collections.abc import AsyncIterator
from dataclasses import dataclass, field
from importlib.resources import files
from pathlib import Path
from typing import Any

from starlette.applications import Starlette
from starlette.middleware.trustedhost import TrustedHostMiddleware
from starlette.requests import Request
from starlette.responses import FileResponse, HTMLResponse, JSONResponse, Response
from starlette.routing import Route

from foldcut.errors import BadInputError
from foldcut.exporters import JOB_EXPORTERS
from foldcut.profiles import load_profile, profile_names
from foldcut.readers import READERS
from foldcut.samples import sample_names, sample_path
from foldcut.sheet import parse_sheet

PATTERN_FILES = ("svg", "fold", "html", "png")
TOKEN_BYTES = 16
PAGE_POLICY = (
    "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:; connect-src 'self'; "
    "frame-src 'self'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'"
)
FILE_POLICY = (
    "sandbox allow-scripts; default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:"
)
"""Whatever is in a drawing, its files run nothing with the page's rights."""


@dataclass(frozen=True)
class Settings:
    """What the server allows: bytes of an upload, seconds of a job, jobs at once and in all, age of a result."""

    upload_bytes: int = 5_000_000
    job_seconds: float = 60.0
    workers: int = 2
    most_jobs: int = 200
    keep_seconds: float = 1800.0
    hosts: tuple[str, ...] = ("127.0.0.1", "localhost", "[::1]", "testserver")


@dataclass
class Job:
    """One drawing on its way: its folder, its process, and what came of it."""

    folder: Path
    command: list[str]
    state: str = "waiting"
    error: str = ""
    report: dict[str, Any] = field(default_factory=dict)
    started: float = field(default_factory=time.monotonic)
    process: asyncio.subprocess.Process | None = None
    task: asyncio.Task[None] | None = None


class RefusedError(Exception):
    """A request that cannot be served: status and a sentence."""

    def __init__(self, status: int, message: str) -> None:
        super().__init__(message)
        self.status = status


class Jobs:
    """All jobs of a server, by token."""

    def __init__(self, settings: Settings) -> None:
        self.settings = settings
        self.root = Path(tempfile.mkdtemp(prefix="foldcut-"))
        self.jobs: dict[str, Job] = {}
        self.free = asyncio.Semaphore(settings.workers)

    def add(self, data: bytes | None, suffix: str, sample: str, options: dict[str, str]) -> str:
        """Start a job with a drawing's bytes, or a sample, and return its token."""
        self._forget_old()
        if len(self.jobs) >= self.settings.most_jobs:
            raise RefusedError(503, "the server has too many drawings; try again in a while")
        token = secrets.token_urlsafe(TOKEN_BYTES)
        folder = self.root / token
        drawing = sample_path(sample) if data is None else folder / f"drawing{suffix}"
        job = Job(folder, _command(drawing, folder, options))
        folder.mkdir()
        if data is not None:
            drawing.write_bytes(data)
        self.jobs[token] = job
        job.task = asyncio.create_task(self._run(job))
        return token

    async def _run(self, job: Job) -> None:
        async with self.free:
            job.state = "folding"
            pipe = asyncio.subprocess.PIPE
            job.process = await asyncio.create_subprocess_exec(
                *job.command, stdin=asyncio.subprocess.DEVNULL, stdout=pipe, stderr=pipe, cwd=job.folder
            )
            try:
                out, _ = await asyncio.wait_for(job.process.communicate(), self.settings.job_seconds)
            except TimeoutError:
                job.state = "failed"
                job.error = f"it took more than {self.settings.job_seconds:g} s; simplify the drawing"
                return
            finally:
                await _kill(job.process)
        with contextlib.suppress(ValueError):
            job.report = json.loads(out.replace(f"{job.folder}/".encode(), b""))
        done = job.process.returncode == 0
        message = str(job.report.get("error", "")) or "no pattern was made"
        findings = job.report.get("findings") or []
        job.error = "" if done else message or "; ".join(str(finding.get("message")) for finding in findings)
        job.state = "done" if done else "failed"

    def get(self, token: str) -> Job:
        """Return a job; raises ``RefusedError`` for a token that is none."""
        if token not in self.jobs:
            raise RefusedError(404, "there is no such drawing, or it is too old; send it again")
        return self.jobs[token]

    async def drop(self, token: str) -> None:
        """Stop a job and delete its files."""
        job = self.get(token)
        del self.jobs[token]
        if job.task is not None:
            job.task.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await job.task
        shutil.rmtree(job.folder, ignore_errors=True)

    def _forget_old(self) -> None:
        oldest = time.monotonic() - self.settings.keep_seconds
        for token in [t for t, job in self.jobs.items() if job.started < oldest and job.state in ("done", "failed")]:
            shutil.rmtree(self.jobs.pop(token).folder, ignore_errors=True)

    async def close(self) -> None:
        """Stop everything and leave nothing behind."""
        for token in list(self.jobs):
            await self.drop(token)
        shutil.rmtree(self.root, ignore_errors=True)


async def _kill(process: asyncio.subprocess.Process) -> None:
    if process.returncode is None:
        with contextlib.suppress(ProcessLookupError):
            process.kill()
        await process.wait()


def _command(drawing: Path, folder: Path, options: dict[str, str]) -> list[str]:
    """Return the command line of a job; every option is one of a known list, or a sheet that parses."""
    sheet, effort = options.get("sheet", "a4"), options.get("effort", "normal")
    parse_sheet(sheet)
    if effort not in ("fast", "normal"):
        raise RefusedError(400, f"there is no effort {effort!r}; choose fast or normal")
    command = [
        sys.executable,
        "-m",
        "foldcut.cli",
        "make",
        str(drawing),
        "--json",
        "--sheet",
        sheet,
        "--effort",
        effort,
    ]
    for ending in PATTERN_FILES:
        command += ["-o", str(folder / f"pattern.{ending}")]
    name = options.get("profile", "")
    if name:
        if name not in profile_names():
            raise RefusedError(400, f"there is no machine {name!r}; choose one of the list")
        profile = load_profile(name)
        if f".{profile.format}" in JOB_EXPORTERS:
            command += ["--profile", name, "-o", str(folder / "job.zip")]
            material = options.get("material", "")
            if material:
                if material not in profile.materials:
                    raise RefusedError(
                        400, f"{name} has no material {material!r}; choose of {', '.join(profile.materials)}"
                    )
                command += ["--material", material]
    return command


def _jobs(request: Request) -> Jobs:
    jobs: Jobs = request.app.state.jobs
    return jobs


def _require_own_page(request: Request) -> None:
    if "x-foldcut" not in request.headers:
        raise RefusedError(403, "this request did not come from foldcut's own page")


async def _body(request: Request, most: int) -> bytes:
    data = bytearray()
    async for piece in request.stream():
        data += piece
        if len(data) > most:
            raise RefusedError(413, f"the drawing is larger than {most // 1_000_000} MB; simplify it")
    return bytes(data)


async def index(request: Request) -> Response:
    """The page itself."""
    page = files(__package__).joinpath("page.html").read_text("utf-8")
    return HTMLResponse(page, headers={"Content-Security-Policy": PAGE_POLICY})


async def choices(request: Request) -> Response:
    """What there is to choose from."""
    machines = {}
    for name in profile_names():
        profile = load_profile(name)
        if profile.operations and f".{profile.format}" in JOB_EXPORTERS:
            machines[name] = {"title": profile.title, "materials": list(profile.materials)}
    return JSONResponse({"samples": sample_names(), "machines": machines, "endings": list(READERS)})


async def create(request: Request) -> Response:
    """Take a drawing as the body, its ending in ``?ending=``, or ``?sample=``; answer with the job's token."""
    _require_own_page(request)
    jobs, options = _jobs(request), dict(request.query_params)
    sample, ending = options.pop("sample", ""), options.pop("ending", "")
    data = None if sample else await _body(request, jobs.settings.upload_bytes)
    if sample and sample not in sample_names():
        raise RefusedError(400, f"there is no sample {sample!r}")
    if not sample and ending not in READERS:
        raise RefusedError(400, f"drawings end in {', '.join(READERS)}")
    return JSONResponse({"job": jobs.add(data, ending, sample, options)}, status_code=201)


async def state(request: Request) -> Response:
    """How far a job is."""
    job = _jobs(request).get(request.path_params["job"])
    names = sorted(path.name for path in job.folder.glob("[pj]*.*")) if job.state == "done" else []
    seconds = time.monotonic() - job.started
    return JSONResponse(
        {"state": job.state, "error": job.error, "seconds": seconds, "report": job.report, "files": names}
    )


async def cancel(request: Request) -> Response:
    """Stop a job and forget it."""
    _require_own_page(request)
    await _jobs(request).drop(request.path_params["job"])
    return Response(status_code=204)


async def download(request: Request) -> Response:
    """One of a finished job's files; the name must be one that the job made."""
    job, name = _jobs(request).get(request.path_params["job"]), request.path_params["name"]
    known = {path.name: path for path in job.folder.glob("[pj]*.*")} if job.state == "done" else {}
    if name not in known:
        raise RefusedError(404, "there is no such file")
    inline = name.endswith((".html", ".png", ".svg")) and "download" not in request.query_params
    disposition = "inline" if inline else "attachment"
    response = FileResponse(known[name], filename=name, content_disposition_type=disposition)
    if inline:
        response.headers["Content-Security-Policy"] = FILE_POLICY
    return response


async def _refused(request: Request, error: Exception) -> Response:
    assert isinstance(error, RefusedError)
    return JSONResponse({"error": str(error)}, status_code=error.status)


async def _bad_input(request: Request, error: Exception) -> Response:
    return JSONResponse({"error": str(error)}, status_code=400)


def make_app(settings: Settings | None = None) -> Starlette:
    """Return the app; its temporary files are there between start-up and shut-down."""
    settings = settings or Settings()

    @contextlib.asynccontextmanager
    async def lifespan(app: Starlette) -> AsyncIterator[None]:
        app.state.jobs = Jobs(settings)
        try:
            yield
        finally:
            await app.state.jobs.close()

    app = Starlette(
        routes=[
            Route("/", index),
            Route("/choices", choices),
            Route("/jobs", create, methods=["POST"]),
            Route("/jobs/{job}", state),
            Route("/jobs/{job}", cancel, methods=["DELETE"]),
            Route("/jobs/{job}/{name}", download),
        ],
        exception_handlers={RefusedError: _refused, BadInputError: _bad_input},
        lifespan=lifespan,
    )
    app.add_middleware(TrustedHostMiddleware, allowed_hosts=list(settings.hosts))
    return app
