"""A command that is killed while it replaces files leaves each one whole: the old one or the new."""

from __future__ import annotations

import json
import os
import re
from pathlib import Path
from typing import Any

import pytest
from support.programs import run_module

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="the system cannot fork")


def killed(folder: Path, *arguments: str) -> dict[str, Any]:
    """Run the driver in a folder and return what it found."""
    done = run_module("support.kill_driver", *arguments, folder=folder, timeout=120)
    assert done.returncode == 0, done.stderr
    found: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return found


def test_files_are_whole_after_each_of_50_kills(tmp_path: Path) -> None:
    found = killed(tmp_path, "50")
    assert found["torn"] == []
    assert len(found["seen"]) == 6, "every file was left in its old and its new version"
    for name, status in found["statuses"]:
        # -15: between two commands of the driver's loop, where the system's own way to end is in force.
        assert status in ((143, -15) if name == "SIGTERM" else (-9,))
    assert sum(status == 143 for _, status in found["statuses"]) >= 10
    # Only SIGKILL leaves something, under the hidden name that a later run removes.
    assert all(name == "SIGKILL" and re.fullmatch(r"\.foldcut-[0-9a-f]{16}\.tmp", left) for name, left in found["left"])


def test_torn_files_would_be_found(tmp_path: Path) -> None:
    assert killed(tmp_path, "20", "careless")["torn"]


def test_files_are_whole_after_kills_at_any_moment_of_a_run(tmp_path: Path) -> None:
    found = killed(tmp_path, "10", "whole")
    assert found["torn"] == []
    assert found["run_s"] > 0.05, "a run that searches takes longer than one that only writes"
    for name, status in found["statuses"]:
        assert status in ((143, -15) if name == "SIGTERM" else (-9,))
    assert all(name == "SIGKILL" and re.fullmatch(r"\.foldcut-[0-9a-f]{16}\.tmp", left) for name, left in found["left"])
