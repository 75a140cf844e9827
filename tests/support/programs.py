"""Programs that are not ours: find them, or skip the test with the program's name and the reason."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any, NoReturn

import pytest

from support.places import TESTS

NODE_FOLDER = TESTS / "node"


def require_program(name: str) -> str:
    """Return the path of a program; skip the test without it, or fail where all tools are required."""
    return shutil.which(name) or missing(name, "not installed")


def missing(name: str, reason: str) -> NoReturn:
    """Skip with program and reason; with FOLDCUT_REQUIRE_TOOLS=1, as in CI, fail instead."""
    message = f"{name}: {reason}; tests/tools.sh installs it"
    if os.environ.get("FOLDCUT_REQUIRE_TOOLS") == "1":
        pytest.fail(message)
    pytest.skip(message)


def run_node(script: str, *arguments: object, timeout: float = 120) -> Any:
    """Run a script of tests/node and return the JSON that it prints; ``timeout`` in seconds."""
    node = require_program("node")
    if not (NODE_FOLDER / "node_modules" / "rabbit-ear").is_dir():
        missing("rabbit-ear", "tests/node/node_modules is not there")
    return json.loads(run_program(node, NODE_FOLDER / script, *arguments, timeout=timeout))


def run_program(program: str, *arguments: object, timeout: float = 120) -> str:
    """Run a program and return what it prints; its standard error is shown if it fails.

    Not every program prints UTF-8: admesh prints the header of an STL file as it is.
    """
    command = [program, *map(str, arguments)]
    done = subprocess.run(
        command, capture_output=True, encoding="utf-8", errors="replace", timeout=timeout, check=False
    )
    assert done.returncode == 0, f"{' '.join(command)} exited with {done.returncode}:\n{done.stderr}"
    return done.stdout


def run_module(name: str, *arguments: str, folder: Path, timeout: float) -> subprocess.CompletedProcess[str]:
    """Run a module of tests/, such as ``cases.run``, as a process in ``folder``; ``timeout`` in seconds."""
    paths = os.pathsep.join([str(TESTS), *filter(None, [os.environ.get("PYTHONPATH")])])
    return subprocess.run(
        [sys.executable, "-m", name, *arguments],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": paths},
        capture_output=True,
        text=True,
        timeout=timeout,
        check=False,
    )
