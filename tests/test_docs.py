"""The pages about the code: every file that they name is there, and no file of the code has an old name in them."""

from __future__ import annotations

import re
import shlex
import subprocess
from pathlib import Path

import pytest
from support.places import ROOT

from foldcut.cli.parser import parse
from foldcut.core.errors import BadInputError

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


LINK = re.compile(r"\]\(([^)#:]+)(?:#[^)]*)?\)")
COMMAND = re.compile(r"^(?:\.venv/bin/)?foldcut (.*)$", re.M)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_link_of_a_page_leads_to_a_file(page: Path) -> None:
    assert [link for link in LINK.findall(page.read_text("utf-8")) if not (page.parent / link).exists()] == []


def test_the_site_leads_to_every_page() -> None:
    named = re.findall(r": ([a-z-]+\.md)$", (ROOT / "mkdocs.yml").read_text("utf-8"), re.M)
    assert sorted(named) == sorted(page.name for page in (ROOT / "docs").glob("*.md"))


def test_the_readme_is_one_screen() -> None:
    lines = (ROOT / "README.md").read_text("utf-8").splitlines()
    assert len(lines) <= 60
    assert not [line for line in lines if line.startswith("|")], "tables are in docs/"
    assert len(COMMAND.findall("\n".join(lines))) == 5


@pytest.mark.parametrize("page", ["README.md", "docs/using.md", "docs/programs.md", "docs/recipes.md"])
def test_every_command_that_a_page_shows_is_understood(page: str) -> None:
    shown = COMMAND.findall((ROOT / page).read_text("utf-8"))
    assert shown
    for words in shown:
        parse(shlex.split(words, comments=True))


def test_a_command_with_an_old_option_is_found() -> None:
    with pytest.raises(BadInputError, match="unrecognized"):
        parse(shlex.split("make icon.svg --exactly  # as drawn", comments=True))
