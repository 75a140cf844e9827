"""The pages about the code: every file that they name is there, and no file of the code has an old name in them."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest
from support.places import ROOT

PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", ROOT / "SECURITY.md", *sorted((ROOT / "docs").glob("*.md"))]
NAMED = re.compile(r"`([\w./-]*\w\.(?:py|toml|html|sh|cjs))`")
EXAMPLES = {"my-laser.toml"}
"""Files of the reader's own."""


def tracked() -> list[str]:
    """Return the files of the repository, or, where there is no git, those of its folders."""
    done = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=False)
    listed = done.stdout.split()
    return listed or [path.relative_to(ROOT).as_posix() for path in ROOT.rglob("*") if path.is_file()]


FILES = tracked()


def missing(page: Path) -> list[str]:
    """Return the files that a page names and that are not there, by any of the last parts of a path."""
    named = set(NAMED.findall(page.read_text("utf-8"))) - EXAMPLES
    return sorted(name for name in named if not any(f"/{file}".endswith(f"/{name}") for file in FILES))


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_file_that_a_page_names_is_there(page: Path) -> None:
    assert missing(page) == []


def test_a_file_that_is_not_there_is_found(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text("`foldcut/pipeline.py`, `jobs/dashes.py`, `foldcut/gapfill.py`, `ashes.py`")
    assert missing(page) == ["ashes.py", "foldcut/gapfill.py"]


def test_the_newcomers_table_has_every_place_that_was_asked_for() -> None:
    rows = dict(re.findall(r"^\| ([^|]+?) \| (.+?) \|$", (ROOT / "docs" / "architecture.md").read_text("utf-8"), re.M))
    for sought, place in {
        "the straight skeleton": "geometry/straight_skeleton/",
        "where `auto` chooses": "methods/auto.py",
        "the ribbon": "methods/disks/ribbon.py",
        "where dashes are decided": "jobs/dashes.py",
        "the layer check": "proof/layers.py",
        "the gusset molecule": "methods/disks/molecules.py",
        "adding a machine": "profiles/",
        "adding a format to write": "exporters/",
        "adding a format to read": "readers/",
        "adding a method": "methods/",
    }.items():
        assert place in rows[sought]
        assert (ROOT / "foldcut" / place).exists()
