"""The floors of the house: a package imports from the floors below it and from itself, and no files import in a circle.

See docs/architecture.md for what is on each floor.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest
from support.places import ROOT

FLOORS = (
    ("core",),
    ("geometry", "profiles", "samples"),
    ("drawing", "pattern"),
    ("readers", "proof", "jobs", "layer_orders"),
    ("methods", "foldfile"),
    ("folding_steps",),
    ("redraw",),
    ("exporters",),
    ("options", "output", "web"),
    ("checking", "pipeline"),
    ("batch", "plugins"),
    ("cli",),
)
ONLY = {
    "readers": {"core", "geometry", "drawing"},
    "exporters.pictures.construction": {"core", "geometry", "profiles", "methods"},
}
"""Rooms that see less than all floors below them."""

METHODS_BELOW = {
    "disks": set(),
    "gate": {"disks"},
    "compact": set(),
    "mirror": {"compact", "skeleton"},
    "simple": {"mirror", "skeleton"},
    "skeleton": set(),
    "auto": {"disks", "gate", "compact", "mirror", "simple", "skeleton", "fewest_folds"},
}
"""Which methods each method may use; all see ``EVERY_METHOD_SEES``."""

EVERY_METHOD_SEES = {"base", "frame", "progress", "sheet_part"}


def modules() -> dict[str, Path]:
    """Return all modules of foldcut by name, without the leading ``foldcut.``; links are followed."""
    found = {}
    for path in sorted((ROOT / "foldcut").rglob("*.py")) + [
        path for link in ("exporters", "profiles", "samples") for path in sorted((ROOT / link).rglob("*.py"))
    ]:
        parts = path.relative_to(ROOT).with_suffix("").parts
        name = ".".join(parts[1:] if parts[0] == "foldcut" else parts).removesuffix("__init__").rstrip(".")
        found[name] = path
    return found


MODULES = modules()


def imports(name: str, *, typing: bool = True) -> frozenset[str]:
    """Return the modules of foldcut that a module imports, anywhere in it; ``typing``: also those for types alone."""
    return frozenset(_imports(name, MODULES[name], typing=typing))


@cache
def _imports(name: str, path: Path, *, typing: bool) -> tuple[str, ...]:
    found = []
    package = name if path.name == "__init__.py" else name.rpartition(".")[0]
    tree = ast.parse(path.read_text("utf-8"))
    left_out = {
        inner
        for node in ast.walk(tree)
        if not typing and isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"
        for inner in ast.walk(node)
    }
    for node in ast.walk(tree):
        if node in left_out:
            continue
        if isinstance(node, ast.Import):
            targets = [(alias.name, "") for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            above = package.split(".")[: len(package.split(".")) - node.level + 1] if node.level else []
            base = ".".join(["foldcut", *above, *filter(None, [node.module])]) if node.level else str(node.module)
            targets = [(base, alias.name) for alias in node.names]
        else:
            continue
        for base, inside in targets:
            if base.partition(".")[0] == "foldcut":
                whole = f"{base}.{inside}".removeprefix("foldcut").strip(".")
                found.append(whole if whole in MODULES else base.removeprefix("foldcut").strip("."))
    return tuple(found)


def room(name: str) -> str:
    return name.partition(".")[0]


def floor(name: str) -> int:
    return next(number for number, rooms in enumerate(FLOORS) if room(name) in rooms)


def faults() -> Iterator[str]:
    """Say which imports go up, sideways, or where they may not."""
    for name in filter(None, MODULES):
        for other in sorted(filter(None, imports(name))):
            if room(other) == room(name):
                continue
            seen = next((rooms for start, rooms in ONLY.items() if f"{name}.".startswith(f"{start}.")), None)
            if floor(other) >= floor(name) or (seen is not None and room(other) not in seen):
                yield f"{name} imports {other}"


def test_imports_go_down_only() -> None:
    assert list(faults()) == []


def test_methods_use_only_those_below_them() -> None:
    wrong = []
    for name in MODULES:
        top, _, rest = name.partition(".")
        method = rest.partition(".")[0]
        if top == "methods" and method in METHODS_BELOW:
            used = {other.split(".")[1] for other in imports(name) if other.startswith("methods.")}
            wrong += [f"{name} uses {other}" for other in used - METHODS_BELOW[method] - EVERY_METHOD_SEES - {method}]
    assert wrong == []


def test_no_files_import_in_a_circle() -> None:
    graph = {
        name: {other for other in imports(name, typing=False) if other and other != name} - parents(name)
        for name in MODULES
        if name
    }
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        pytest.fail(" -> ".join(reversed(error.args[1])))


def parents(name: str) -> set[str]:
    """The packages around a module, of which it may use what they hold themselves (the registry of methods)."""
    parts = name.split(".")
    return {".".join(parts[:count]) for count in range(1, len(parts))}


def test_the_links_lead_to_the_folders_at_the_top() -> None:
    for link in ("exporters", "profiles", "samples"):
        assert (ROOT / "foldcut" / link).resolve() == ROOT / link


def test_every_room_is_on_a_floor_and_every_floor_has_its_rooms() -> None:
    on_floors = {one for rooms in FLOORS for one in rooms}
    assert {room(name) for name in MODULES if name} == on_floors


@pytest.mark.parametrize(
    ("name", "other"), [("core.model", "cli.main"), ("proof.cut", "methods"), ("readers.svg", "pattern")]
)
def test_the_comparison_can_fail(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, name: str, other: str) -> None:
    path = tmp_path / "changed.py"
    path.write_text(f"import foldcut.{other}\n" + MODULES[name].read_text("utf-8").replace("from __future__", "# "))
    monkeypatch.setitem(MODULES, name, path)
    assert f"{name} imports {other}" in list(faults())
