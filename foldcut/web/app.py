"""The web app: a drawing comes in, ``foldcut make`` runs in a process of its own, its files are there to take.

Each job runs the real command line in its own temporary folder, so a bad drawing meets the same limits as on the
command line, cannot reach another job's files, and cannot take the server down: it is killed after
``Settings.job_seconds``, and may use no more than ``Settings.job_bytes``. Other formats are made from the job's FOLD
file when they are asked for. Folders go away when a job is deleted or old, and all of them when the server stops.

Requests that change something need the header ``X-Foldcut``, which no other site's form or script may send, and every
request must name this machine in ``Host``, against names that others make point here (DNS rebinding).
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
from collections.abc import AsyncIterator, Callable, Mapping
from dataclasses import dataclass, field
from functools import cache
from importlib.resources import files
from mimetypes import guess_type
from pathlib import Path
from typing import Any, get_args

import anyio
from starlette.applications import Starlette
from starlette.datastructures import MutableHeaders
from starlette.middleware.trustedhost import TrustedHostMiddleware
from starlette.requests import Request
from starlette.responses import HTMLResponse, JSONResponse, Response
from starlette.routing import Route
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from foldcut.core.errors import BadInputError
from foldcut.drawing.placement import parse_length, parse_sheet
from foldcut.exporters import JOB_EXPORTERS, PATTERN_EXPORTERS
from foldcut.jobs.marks import DEFAULT_MARKS, MARKS
from foldcut.profiles import Treatment, load_profile, profile_names
from foldcut.readers import READERS
from foldcut.readers.typed_text import font_families
from foldcut.samples import sample_names

QUICK_FILES = ("pattern.html",)
FILES = ("pattern.svg", "pattern.fold", "pattern.html", "pattern.png", "pattern.zip")
MACHINE_FILES = ("pattern.fold", "pattern.html", "pattern.png", "job.zip")
"""What a job makes at once; the rest is made when it is asked for."""
GUIDES = {"guide.pdf": "guide", "guide.html": "guide", "pictures.svg": "draw", "pictures.png": "draw"}
"""Files that commands other than ``make`` write."""
EFFORTS = ("fast", "normal")
LENGTHS = ("margin", "simplify", "min-crease", "symmetry", "ribbon")
LONGEST_TEXT = 100
TOKEN_BYTES = 16
HEADERS = {
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cache-Control": "no-store",
}
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
    """What the server allows.

    ``upload_bytes`` of a drawing; ``job_seconds`` and ``job_bytes`` of memory for a job, ``quick_seconds`` for one
    while the drawing is being changed; ``workers``: jobs at once; ``most_jobs`` in all; ``keep_seconds``: the age of a
    result; ``hosts``: the names of this machine.
    """

    upload_bytes: int = 5_000_000
    job_seconds: float = 60.0
    job_bytes: int = 4 * 2**30
    quick_seconds: float = 10.0
    workers: int = 2
    most_jobs: int = 200
    keep_seconds: float = 1800.0
    hosts: tuple[str, ...] = ("127.0.0.1", "localhost", "[::1]")


@dataclass
class Job:
    """One drawing on its way: its folder, and what came of it."""

    folder: Path
    quick: bool = False
    machine: tuple[str, ...] = ()
    state: str = "waiting"
    stage: str = ""
    fraction: float = 0.0
    error: str = ""
    report: dict[str, Any] = field(default_factory=dict)
    started: float = field(default_factory=time.monotonic)
    process: asyncio.subprocess.Process | None = None
    task: asyncio.Task[None] | None = None

    @property
    def made(self) -> Path:
        """The folder of the files that are there to take."""
        return self.folder / "made"

    def files(self) -> dict[str, Path]:
        """Return the files that are there to take, by name."""
        return {path.name: path for path in sorted(self.made.iterdir())} if self.state == "done" else {}


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

    def require_room(self) -> None:
        """Forget old jobs; raises ``RefusedError`` where there is no room for another."""
        oldest = time.monotonic() - self.settings.keep_seconds
        for token in [t for t, job in self.jobs.items() if job.started < oldest and job.state in ("done", "failed")]:
            shutil.rmtree(self.jobs.pop(token).folder, ignore_errors=True)
        if len(self.jobs) >= self.settings.most_jobs:
            raise RefusedError(503, "the server has too many drawings; try again in a while")

    def upload(self) -> Path:
        """Return a new place for a drawing that is on its way."""
        return self.root / f"upload-{secrets.token_urlsafe(TOKEN_BYTES)}"

    def add(self, upload: Path | None, ending: str, options: Mapping[str, str]) -> str:
        """Start a job with an uploaded drawing, or a sample or a text among the options, and return its token."""
        self.require_room()
        token = secrets.token_urlsafe(TOKEN_BYTES)
        folder = self.root / token
        machine = _machine(options)
        job = Job(folder, "quick" in options, machine)
        drawing = folder / f"drawing{ending}"
        command = [
            "make",
            *_source(None if upload is None else drawing, options),
            *_options(options),
            "--progress",
            "--json",
        ]
        names: tuple[str, ...] = QUICK_FILES if job.quick else FILES
        if machine and not job.quick:
            names = (*MACHINE_FILES, f"job.{load_profile(options['profile']).format}")
            command += machine
        for name in names:
            command += ["-o", str(job.made / name)]
        job.made.mkdir(parents=True)
        if upload is not None:
            upload.rename(drawing)
        self.jobs[token] = job
        job.task = asyncio.create_task(self._run(job, command))
        return token

    async def _run(self, job: Job, command: list[str]) -> None:
        seconds = self.settings.quick_seconds if job.quick else self.settings.job_seconds
        job.report, job.error = await self._command(job, command, seconds)
        job.state = "failed" if job.error else "done"

    async def _command(self, job: Job, command: list[str], seconds: float) -> tuple[dict[str, Any], str]:
        """Run one command of the command line for a job, when its turn comes; return its report and error."""
        async with self.free:
            if not job.folder.is_dir():
                raise RefusedError(404, "this drawing is gone; send it again")
            job.state = "folding" if job.state == "waiting" else job.state
            pipe = asyncio.subprocess.PIPE
            process = job.process = await asyncio.create_subprocess_exec(
                *(sys.executable, "-m", "foldcut.cli", *command),
                stdin=asyncio.subprocess.DEVNULL,
                stdout=pipe,
                stderr=pipe,
                cwd=job.folder,
                start_new_session=True,
            )
            try:
                _bound_memory(process.pid, self.settings.job_bytes)
                assert process.stdout is not None
                async with asyncio.timeout(seconds):
                    out, _, status = await asyncio.gather(process.stdout.read(), _follow(process, job), process.wait())
            except TimeoutError:
                remedy = "press Fold to let it search longer" if job.quick else "simplify the drawing"
                return {}, f"it took more than {seconds:g} s; {remedy}"
            finally:
                await _kill(process)
        report: dict[str, Any] = {}
        with contextlib.suppress(ValueError):
            report = json.loads(out.replace(f"{job.made}/".encode(), b"").replace(f"{job.folder}/".encode(), b""))
        error = report.pop("error", None) or {"message": "no pattern was made; it needs too much memory, or is broken"}
        return report, "" if status == 0 else str(error["message"])

    async def export(self, job: Job, name: str) -> None:
        """Make one more file of a finished job, of its FOLD file; raises ``RefusedError`` where that fails."""
        if "pattern.fold" not in job.files():
            raise RefusedError(409, "there is no pattern yet to make files of")
        if name in job.files():
            return
        making = job.folder / secrets.token_hex(4)
        making.mkdir()
        machine = job.machine if name.startswith("job.") else ()
        verb = GUIDES.get(name, "make")
        command = [verb, str(job.made / "pattern.fold"), "--json", *machine, "-o", str(making / name)]
        _, error = await self._command(job, command, self.settings.job_seconds)
        if error:
            raise RefusedError(400, error)
        with contextlib.suppress(FileNotFoundError):  # the job may have been dropped meanwhile
            (making / name).replace(job.made / name)

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
        if job.process is not None:
            await _kill(job.process)
        shutil.rmtree(job.folder, ignore_errors=True)

    async def close(self) -> None:
        """Stop everything and leave nothing behind."""
        for token in list(self.jobs):
            await self.drop(token)
        shutil.rmtree(self.root, ignore_errors=True)


async def _follow(process: asyncio.subprocess.Process, job: Job) -> None:
    """Read what the command says on standard error to the end, and keep how far it is."""
    assert process.stderr is not None
    while True:
        try:
            line = await process.stderr.readline()
        except ValueError:  # longer than any line of ours
            continue
        if not line:
            return
        with contextlib.suppress(ValueError, KeyError, TypeError):
            told = json.loads(line)
            job.stage, job.fraction = str(told["stage"]), float(told["fraction"])


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


def _source(drawing: Path | None, options: Mapping[str, str]) -> list[str]:
    """Return the words that name what is folded."""
    if drawing is not None:
        return [str(drawing)]
    if sample := options.get("sample"):
        return [_known(sample, "sample", sample_names())]
    text, font = options.get("text", ""), options.get("font", "")
    if not text.isprintable() or not 0 < len(text.strip()) <= LONGEST_TEXT:
        raise RefusedError(400, f"give a text of 1 to {LONGEST_TEXT} letters")
    return [f"--text={text}", f"--font={_known(font, 'font', fonts())}"]


def _options(options: Mapping[str, str]) -> list[str]:
    """Return the options of the command line; each is one of a known list, or a sheet or length that parses."""
    sheet, effort = options.get("sheet", "a4"), options.get("effort", "normal")
    parse_sheet(sheet)
    lengths = {name: options[name] for name in LENGTHS if options.get(name)}
    return [
        *("--sheet", sheet, "--effort", "fast" if "quick" in options else _known(effort, "effort", EFFORTS)),
        *(f"--{name}={parse_length(length)!r}mm" for name, length in lengths.items()),
    ]


def _machine(options: Mapping[str, str]) -> tuple[str, ...]:
    """Return the options that choose a machine, its material, its treatment of creases and marks; none for none."""
    name = options.get("profile", "")
    if not name:
        return ()
    words = ["--profile", _known(name, "machine", machines())]
    if material := options.get("material", ""):
        words += ["--material", _known(material, "material", tuple(load_profile(name).materials))]
    if treatment := options.get("treatment", ""):
        words += ["--treatment", _known(treatment, "treatment", get_args(Treatment))]
    if marks := options.get("marks", ""):
        known = ("none", *MARKS)
        words += ["--marks", ",".join(_known(mark, "mark", known) for mark in marks.split(","))]
    return tuple(words)


def _known(name: str, what: str, names: tuple[str, ...]) -> str:
    """Return a name that is one of a list; raises ``RefusedError``."""
    if name not in names:
        raise RefusedError(400, f"there is no {what} {name!r}; choose one of the list")
    return name


@cache
def machines() -> tuple[str, ...]:
    """Return the names of the profiles that jobs are made for."""
    profiles = {name: load_profile(name) for name in profile_names()}
    return tuple(name for name, p in profiles.items() if p.operations and f".{p.format}" in JOB_EXPORTERS)


@cache
def fonts() -> tuple[str, ...]:
    """Return the fonts that a text may have."""
    families = font_families()
    return ("sans", "serif", "monospace", *families) if families else ()


def more_files(machine: bool) -> list[str]:
    """Return the names of the files that are made when they are asked for."""
    patterns = ["pattern.zip", *(f"pattern{ending}" for ending in PATTERN_EXPORTERS)]
    return [*GUIDES, *patterns, *([f"job{ending}" for ending in JOB_EXPORTERS] if machine else [])]


def _jobs(request: Request) -> Jobs:
    jobs: Jobs = request.app.state.jobs
    return jobs


def _job(request: Request) -> Job:
    return _jobs(request).get(request.path_params["job"])


def _require_own_page(request: Request) -> None:
    if "x-foldcut" not in request.headers:
        raise RefusedError(403, "this request did not come from foldcut's own page")


async def _receive(request: Request, file: Path, most: int) -> None:
    """Write a request's body into a file as it comes: many at once must not fill the memory."""
    size = 0
    async with await anyio.open_file(file, "wb") as to:
        async for piece in request.stream():
            size += len(piece)
            if size > most:
                raise RefusedError(413, f"the drawing is larger than {most / 1e6:g} MB; simplify it")
            await to.write(piece)


async def index(request: Request) -> Response:
    """The page itself."""
    page = files(__package__).joinpath("page.html").read_text("utf-8")
    return HTMLResponse(page, headers={"Content-Security-Policy": PAGE_POLICY})


async def choices(request: Request) -> Response:
    """What there is to choose from."""
    known = {name: load_profile(name) for name in machines()}
    return JSONResponse(
        {
            "samples": sample_names(),
            "machines": {name: {"title": p.title, "materials": list(p.materials)} for name, p in known.items()},
            "treatments": get_args(Treatment),
            "marks": {name: name in DEFAULT_MARKS for name in MARKS},
            "endings": list(READERS),
            "fonts": fonts(),
        }
    )


async def create(request: Request) -> Response:
    """Take a drawing as the body, its ending in ``?ending=``, or ``?sample=`` or ``?text=``; answer with a token."""
    _require_own_page(request)
    jobs, options = _jobs(request), dict(request.query_params)
    ending = options.pop("ending", "")
    if ending and ending not in READERS:
        raise RefusedError(400, f"drawings end in {', '.join(READERS)}")
    if not (ending or "sample" in options or "text" in options):
        raise RefusedError(400, "give a drawing with its ending, a sample or a text")
    jobs.require_room()
    upload = jobs.upload() if ending else None
    try:
        if upload is not None:
            await _receive(request, upload, jobs.settings.upload_bytes)
        return JSONResponse({"job": jobs.add(upload, ending, options)}, status_code=201)
    finally:
        if upload is not None:
            upload.unlink(missing_ok=True)


async def state(request: Request) -> Response:
    """How far a job is."""
    job = _job(request)
    names = list(job.files())
    return JSONResponse(
        {
            "state": job.state,
            "stage": job.stage,
            "fraction": job.fraction,
            "seconds": time.monotonic() - job.started,
            "error": job.error,
            "report": job.report,
            "files": names,
            "more": [name for name in more_files(bool(job.machine)) if name not in names] if names else [],
        }
    )


async def make_file(request: Request) -> Response:
    """Make one more file of a finished job."""
    _require_own_page(request)
    job = _job(request)
    name = _known(request.path_params["name"], "file", tuple(more_files(bool(job.machine))))
    await _jobs(request).export(job, name)
    return Response(status_code=204)


async def cancel(request: Request) -> Response:
    """Stop a job and forget it."""
    _require_own_page(request)
    await _jobs(request).drop(request.path_params["job"])
    return Response(status_code=204)


async def download(request: Request) -> Response:
    """One of a finished job's files; the name must be one that the job made."""
    known, name = _job(request).files(), request.path_params["name"]
    if name not in known:
        raise RefusedError(404, "there is no such file")
    data = known[name].read_bytes()  # at once: the job may be dropped while the file is on its way
    inline = name.endswith((".html", ".png", ".svg")) and "download" not in request.query_params
    disposition = "inline" if inline else "attachment"
    headers = {"Content-Security-Policy": FILE_POLICY, "Content-Disposition": f'{disposition}; filename="{name}"'}
    return Response(data, headers=headers, media_type=guess_type(name)[0] or "application/octet-stream")


async def _refused(request: Request, error: Exception) -> Response:
    assert isinstance(error, RefusedError)
    return JSONResponse({"error": str(error)}, status_code=error.status)


async def _bad_input(request: Request, error: Exception) -> Response:
    return JSONResponse({"error": str(error)}, status_code=400)


class SafeHeaders:
    """Middleware that gives every answer the headers that keep other sites out."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve one request."""

        async def with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                MutableHeaders(scope=message).update(HEADERS)
            await send(message)

        await self.app(scope, receive, with_headers)


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

    handlers: dict[Any, Callable[[Request, Exception], Any]] = {RefusedError: _refused, BadInputError: _bad_input}
    app = Starlette(
        routes=[
            Route("/", index),
            Route("/choices", choices),
            Route("/jobs", create, methods=["POST"]),
            Route("/jobs/{job}", state),
            Route("/jobs/{job}", cancel, methods=["DELETE"]),
            Route("/jobs/{job}/{name}", download),
            Route("/jobs/{job}/{name}", make_file, methods=["POST"]),
        ],
        exception_handlers=handlers,
        lifespan=lifespan,
    )
    app.add_middleware(TrustedHostMiddleware, allowed_hosts=list(settings.hosts), www_redirect=False)
    app.add_middleware(SafeHeaders)
    return app
