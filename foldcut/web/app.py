"""The web app's routes: a drawing comes in, ``web.jobs`` folds it, and the page takes the files.

Requests that change something need the header ``X-Foldcut``, which no other site's form or script can send. Every
request must name this machine in ``Host``; otherwise another site could point a name of its own at this machine and
read the answers (DNS rebinding).
"""

from __future__ import annotations

import asyncio
import contextlib
import math
import time
from collections.abc import AsyncIterator, Callable
from functools import cache
from importlib.resources import files
from mimetypes import guess_type
from pathlib import Path
from typing import Any, get_args
from urllib.parse import quote

import anyio
from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.datastructures import MutableHeaders
from starlette.middleware.trustedhost import TrustedHostMiddleware
from starlette.requests import ClientDisconnect, Request
from starlette.responses import HTMLResponse, JSONResponse, Response
from starlette.routing import Route
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from foldcut.core.errors import BadInputError
from foldcut.exporters.pattern.html_page import page_part, pattern_in
from foldcut.jobs.marks import MARKS
from foldcut.profiles import Treatment, known_profiles
from foldcut.readers import READERS, ReadOptions, read_shape
from foldcut.samples import fold_counts, sample_names, sample_path
from foldcut.web.errors import RefusedError
from foldcut.web.jobs import Jobs, Settings, Upload
from foldcut.web.options import fonts, machines, read_query, require_known

__all__ = ["make_app"]

HEADERS = {
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cache-Control": "no-store",
}
"""What every answer says: keep it from other sites, and keep no copy."""
PAGE_POLICY = (
    "default-src 'none'; style-src 'self'; script-src 'self'; img-src data: blob:; connect-src 'self'; "
    "frame-ancestors 'none'; base-uri 'none'; form-action 'none'"
)
"""The page may reach this server only, and runs no script but its own; blob: is a picture that the user chose."""
FILE_POLICY = (
    "sandbox allow-scripts; default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:"
)
"""Whatever is in a drawing, its files run nothing with the page's rights."""


def _jobs(request: Request) -> Jobs:
    jobs: Jobs = request.app.state.jobs
    return jobs


def _upload(request: Request) -> Upload:
    return _jobs(request).get(request.path_params["job"])


def _require_own_page(request: Request) -> None:
    if "x-foldcut" not in request.headers:
        raise RefusedError(403, "this request did not come from foldcut's own page")


async def _receive(request: Request, file: Path, settings: Settings) -> None:
    """Write a request's body into a file piece by piece, so that many at once do not fill the memory."""
    size, most = 0, settings.upload_bytes
    pieces = request.stream()
    try:
        async with asyncio.timeout(settings.upload_seconds), await anyio.open_file(file, "wb") as to:
            while True:
                async with asyncio.timeout(settings.stall_seconds):
                    piece = await anext(pieces, None)
                if piece is None:
                    return
                size += len(piece)
                if size > most:
                    raise RefusedError(413, f"the drawing is larger than {most / 1e6:g} MB; simplify it")
                await to.write(piece)
    except TimeoutError:
        raise RefusedError(408, "the drawing did not arrive in time; send it again") from None
    except ClientDisconnect:
        raise RefusedError(400, "the drawing did not arrive as a whole") from None  # nobody is there to read it


def _client(request: Request) -> str:
    return request.client.host if request.client else ""


async def index(request: Request) -> Response:
    """Answer with the page itself."""
    page = files(__package__).joinpath("page.html").read_text("utf-8")
    return HTMLResponse(page, headers={"Content-Security-Policy": PAGE_POLICY})


async def page_file(request: Request) -> Response:
    """Answer with the page's script or style sheet, which the page of ``foldcut view`` has inside."""
    name = request.url.path.rpartition("/")[2]
    kind = "text/javascript" if name.endswith(".js") else "text/css"
    return Response(page_part(name), media_type=kind)


@cache
def _sample_loops() -> dict[str, list[list[list[float]]]]:
    """Return the loops of all samples in mm, y up, so that the page can show them at once.

    Few folds come first; samples whose folds nobody has counted come last.
    """
    counts, found = fold_counts(), {}
    for name in sorted(sample_names(), key=lambda name: counts[name].folds if name in counts else math.inf):
        drawing = read_shape(sample_path(name), ReadOptions())
        found[name] = [loop.round(3).tolist() for loop in drawing.loops]
    return found


async def samples(request: Request) -> Response:
    """Answer with the outlines of all samples."""
    return JSONResponse(await run_in_threadpool(_sample_loops))


async def shown(request: Request) -> Response:
    """Answer with the best pattern so far, as the page shows it; empty where there is none yet."""
    page = await run_in_threadpool(_upload(request).shown)
    return Response(b"{}" if page is None else pattern_in(page), media_type="application/json")


async def choices(request: Request) -> Response:
    """Answer with what the page lets people choose from."""
    profiles, _ = known_profiles()  # one may have been broken since the server started
    known = {name: profiles[name] for name in machines() if name in profiles}
    return JSONResponse(
        {
            "samples": sample_names(),
            "machines": {
                name: {"title": p.title, "materials": list(p.materials), "marks": p.marks} for name, p in known.items()
            },
            "treatments": get_args(Treatment),
            "marks": list(MARKS),
            "endings": list(READERS),
            "fonts": fonts(),
        }
    )


async def create(request: Request) -> Response:
    """Take a drawing as the body, its ending in ``?ending=``, or ``?sample=`` or ``?text=``; answer with a token."""
    _require_own_page(request)
    jobs, query = _jobs(request), dict(request.query_params)
    ending = query.pop("ending", "")
    if ending and ending not in READERS:
        raise RefusedError(400, f"drawings end in {', '.join(READERS)}")
    if not (ending or "sample" in query or "text" in query):
        raise RefusedError(400, "give a drawing with its ending, a sample or a text")
    client = _client(request)
    jobs.require_room(client)
    if not ending:
        return JSONResponse({"job": jobs.add(read_query(query, uploaded=False), client=client)}, status_code=201)
    received = jobs.new_path()
    try:
        await _receive(request, received, jobs.settings)
        token = jobs.add(read_query(query, uploaded=True), received, ending, client)
    finally:
        received.unlink(missing_ok=True)
    return JSONResponse({"job": token}, status_code=201)


async def state(request: Request) -> Response:
    """Answer with how far a drawing is, and what can be taken."""
    upload = _upload(request)
    names = list(upload.files())
    return JSONResponse(
        {
            "state": upload.state,
            "stage": upload.stage,
            "fraction": upload.fraction,
            "patterns": upload.patterns,
            "name": upload.wanted.name,
            "seconds": time.monotonic() - upload.started,
            "error": upload.error,
            "report": upload.report,
            "files": names,
            "more": [name for name in upload.possible_files() if name not in names] if names else [],
        }
    )


async def make_file(request: Request) -> Response:
    """Make one more file of a drawing that is folded."""
    _require_own_page(request)
    upload = _upload(request)
    name = require_known(request.path_params["name"], "file", upload.possible_files())
    await _jobs(request).export(upload, name)
    return Response(status_code=204)


async def cancel(request: Request) -> Response:
    """Stop folding a drawing and forget it."""
    _require_own_page(request)
    await _jobs(request).drop(request.path_params["job"])
    return Response(status_code=204)


async def download(request: Request) -> Response:
    """Answer with one of the files that were made of a drawing."""
    known, name = _upload(request).files(), request.path_params["name"]
    if name not in known:
        raise RefusedError(404, "there is no such file")
    data = known[name].read_bytes()  # at once: the drawing may be dropped while the file is on its way
    inline = name.endswith((".html", ".png", ".svg")) and "download" not in request.query_params
    disposition = "inline" if inline else "attachment"
    called = quote(_upload(request).called(name), safe="")
    headers = {
        "Content-Security-Policy": FILE_POLICY,
        "Content-Disposition": f"{disposition}; filename=\"{name}\"; filename*=UTF-8''{called}",
    }
    return Response(data, headers=headers, media_type=guess_type(name)[0] or "application/octet-stream")


async def _refused(request: Request, error: Exception) -> Response:
    assert isinstance(error, RefusedError)
    return JSONResponse({"error": str(error)}, status_code=error.status)


async def _bad_input(request: Request, error: Exception) -> Response:
    return JSONResponse({"error": str(error)}, status_code=400)


class SafeHeaders:
    """Middleware that gives every answer the headers that keep other sites out.

    A request that is still under way when the server stops is told so.
    """

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve one request."""
        started = False

        async def with_headers(message: Message) -> None:
            nonlocal started
            if message["type"] == "http.response.start":
                started = True
                MutableHeaders(scope=message).update(HEADERS)
            await send(message)

        try:
            await self.app(scope, receive, with_headers)
        except asyncio.CancelledError:  # by uvicorn, which would log a traceback
            if not started:
                await JSONResponse({"error": "the server is stopping"}, 503)(scope, receive, with_headers)


def make_app(settings: Settings | None = None) -> Starlette:
    """Return the app; its temporary files exist from start-up to shut-down."""
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
            Route("/page.js", page_file),
            Route("/page.css", page_file),
            Route("/choices", choices),
            Route("/samples", samples),
            Route("/jobs", create, methods=["POST"]),
            Route("/jobs/{job}", state),
            Route("/jobs/{job}", cancel, methods=["DELETE"]),
            Route("/jobs/{job}/shown", shown),
            Route("/jobs/{job}/{name}", download),
            Route("/jobs/{job}/{name}", make_file, methods=["POST"]),
        ],
        exception_handlers=handlers,
        lifespan=lifespan,
    )
    app.add_middleware(TrustedHostMiddleware, allowed_hosts=list(settings.hosts), www_redirect=False)
    app.add_middleware(SafeHeaders)
    return app
