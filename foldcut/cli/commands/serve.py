"""``foldcut serve``: the web page, on this machine."""

from __future__ import annotations

import sys
from argparse import ArgumentParser, Namespace
from contextlib import suppress

from foldcut.cli.commands import Command
from foldcut.cli.console import DONE
from foldcut.core.errors import BadInputError

MOST_REQUESTS = 200
"""More requests than this at a time are turned away."""

SHUTDOWN_S = 2
"""After Ctrl-C, requests that are under way have so many seconds."""

UNTAKEN_S = 60.0
"""A client may take so many seconds for an answer, beside what it takes to make it."""

EXAMPLES = """\
examples:
  foldcut serve                            then open the address that it prints
  foldcut serve --port 9000
"""


def add_options(command: ArgumentParser) -> None:
    """Add where to listen, and how long a drawing may take."""
    command.add_argument("--port", type=int, default=8000, help="(default: %(default)s)")
    command.add_argument("--host", default="127.0.0.1", help="the address to listen on (default: only this machine)")
    command.add_argument(
        "--job-seconds",
        type=float,
        default=60.0,
        metavar="S",
        help="give up on a drawing after this many seconds (default: 60)",
    )


def serve(args: Namespace) -> int:
    """Serve the web page until Ctrl-C."""
    import socket

    host, port, job_seconds = args.host, args.port, args.job_seconds
    try:
        import uvicorn

        from foldcut.web.app import make_app
        from foldcut.web.connections import bounded_protocol
        from foldcut.web.jobs import Settings
    except ModuleNotFoundError as error:
        raise BadInputError(f"serve needs the extra 'serve' ({error.name}): pip install 'foldcut[serve]'") from None
    if not 0 < port < 65536:
        raise BadInputError(f"--port {port} is not a port; give a number from 1 to 65535")
    if not 0 < job_seconds < 1e8:
        raise BadInputError(f"--job-seconds is {job_seconds:g}; give a positive number below 1e8")
    from foldcut.redraw.compiling import get_ready

    name = f"[{host}]" if ":" in host else host
    own = Settings().hosts
    everywhere = host in ("0.0.0.0", "::")
    settings = Settings(job_seconds=job_seconds, hosts=("*",) if everywhere else (*own, name))
    config = uvicorn.Config(
        make_app(settings),
        http=bounded_protocol(settings.connections_each, settings.stall_seconds, job_seconds + UNTAKEN_S),
        ws="none",
        log_level="warning",
        server_header=False,
        limit_concurrency=MOST_REQUESTS,
        timeout_graceful_shutdown=SHUTDOWN_S,
    )
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    try:
        listening = socket.create_server((host, port), family=family)
    except OSError as error:
        what = (error.strerror or str(error)).partition(" (while")[0]
        raise BadInputError(f"cannot listen at {name}:{port}: {what}; give another --port or --host") from None
    with listening:
        # a drawing has less time than that takes
        get_ready(lambda text: print(f"foldcut: {text}", file=sys.stderr, flush=True))
        print(f"http://{name}:{port}/ until Ctrl-C; nothing is kept afterwards", flush=True)
        if name not in own:
            print("everyone who reaches this address can use it, and there is no password", file=sys.stderr)
        with suppress(KeyboardInterrupt):
            uvicorn.Server(config).run(sockets=[listening])
    return DONE


SERVE = Command(
    "Serve a page on which you drop or draw a drawing, fold it, look at it and download the files (extra: serve).",
    EXAMPLES,
    add_options,
    serve,
)
