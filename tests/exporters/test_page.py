"""The page: it holds the pattern, loads nothing, and works in a browser."""

from __future__ import annotations

import base64
import dataclasses
import hashlib
import html
import json
import re
from pathlib import Path

import pytest
from numpy.testing import assert_allclose
from support.folded import folded_sample
from support.patterns import book_fold, square_out_of_square
from support.programs import require_program, run_node

from foldcut.core.model import Finding, FoldedPattern
from foldcut.exporters import export
from foldcut.exporters.pattern.html_page import page_part, pattern_in
from foldcut.pipeline import fold
from foldcut.samples import sample_path

KINDS = ("mountain", "valley")
CONTROLS = (
    *("print", "save-svg", "save-png"),
    *("pattern-held", "M", "V", "shape", "first", "before", "after", "larger", "smaller", "whole"),
    *("folded-held", "back", "play", "on", "fold", "cut", "only", "spin", "front", "side", "layers", "apart"),
)
BENT = 1e-3
"""Millimetres: places between steps are written with four digits."""


def counted(count: int, kind: str) -> str:
    """Return a number of mountains or valleys in words."""
    return f"{count} {kind}" if count == 1 else f"{count} {'valleys' if kind == 'valley' else 'mountains'}"


def folded(sample: str, method: str = "auto") -> FoldedPattern:
    """Fold a sample on A4."""
    return folded_sample(sample, method=method)


def data_of(page: str) -> dict[str, list[object]]:
    """Return the pattern that is in a page."""
    found = re.search(r'<script type="application/json" id="data">(.*?)</script>', page, re.DOTALL)
    assert found
    data: dict[str, list[object]] = json.loads(found[1])
    return data


def assert_holds_places(data: dict[str, list[object]], pattern: FoldedPattern) -> None:
    """Compare the vertices of a page, flat and folded, with the pattern's."""
    assert_allclose(data["flat"], pattern.creases.vertices_coords, atol=1e-6)
    assert_allclose(data["folded"], pattern.folded.vertices_coords, atol=1e-6)


def test_a_page_holds_the_whole_pattern() -> None:
    pattern = folded("fish")
    data = data_of(export(pattern, ".html").decode())
    assert_holds_places(data, pattern)
    assert data["letters"] == pattern.creases.edges_assignment.tolist()
    assert data["faces"] == pattern.creases.faces_vertices.to_lists()
    assert data["layers"] == pattern.folded.layers.tolist()


def test_a_title_with_markup_does_not_leave_its_place() -> None:
    title = "</script><script>alert(1)</script> DATA &"
    page = export(dataclasses.replace(square_out_of_square(), title=title), ".html").decode()
    assert data_of(page)["title"] == title
    assert page.replace(page_part("page.js"), "").count("<script") == 2
    assert "alert(1)</script>" not in page


def test_a_page_with_a_thousand_creases_is_under_3_mb() -> None:
    pattern = folded("triangle", "paper")
    assert pattern.creases.crease_count > 1000
    assert len(export(pattern, ".html")) < 3e6


PX = 96 / 25.4
"""CSS pixels in a millimetre."""

SHOWN = ("fish", "letter-a", "snowflake")
"""Samples whose pages are opened: of one loop and several, with one first fold, several, and none."""


def test_pages_work_in_a_browser(tmp_path: Path) -> None:
    chromium = require_program("chromium")
    patterns = {name: folded(name) for name in SHOWN} | {"book": book_fold()}
    for name, pattern in patterns.items():
        (tmp_path / f"{name}.html").write_bytes(export(pattern, ".html"))
    seen = run_node("page.cjs", chromium, *(tmp_path / f"{name}.html" for name in patterns), timeout=400)
    for (name, pattern), page in zip(patterns.items(), seen, strict=True):
        letters = pattern.creases.edges_assignment.tolist()
        assert page["complaints"] == [], name
        assert page["requests"] == [], name
        assert page["serious"] == [], name
        assert page["facts"].startswith(
            " and ".join(counted(letters.count(kind[0].upper()), kind) for kind in KINDS)
        ), name
        assert page["mountains"] == letters.count("M"), name
        assert page["mountainsShown"] == 0, name
        assert page["crease"].startswith(f"Crease 1 of {pattern.creases.crease_count}: "), name
        assert page["layers"] == f"1 of {len(pattern.creases.faces_vertices)}", name
        assert page["flat"] == "Flat, as printed.", name
        steps = json.loads(pattern_in((tmp_path / f"{name}.html").read_bytes()))["steps"]
        assert page["between"].startswith("Exact" if "line" in steps[0] else "This movement is a picture"), name
        assert page["steps"] == len(steps), name
        assert (page["back"], page["on"]) == (str(100 * len(steps) - 100), str(100 * len(steps))), name
        assert page["saved"].endswith(".svg"), name
        assert page["printed"] == pytest.approx([pattern.sheet.width * PX, pattern.sheet.height * PX, 0], abs=0.1), name
        assert page["folded"].startswith("Folded flat"), name
        assert page["pictures"] == 4, name
        assert page["wide"] <= 390, name  # a phone need not scroll sideways
        assert page["zoomed"] == pytest.approx(1 / 1.4), name
        assert page["panned"], name
        assert page["dragged"], name
        assert page["turned"], name
        assert page["hovered"], name
        assert len({dash for dash in page["dashes"] if dash}) == len(
            {letter for letter in letters if letter in "MV"}
        ), name
        assert page["reached"] == [control for control in CONTROLS if control != "first" or pattern.first_folds], name


def test_straight_folds_move_without_bending_or_crossing(tmp_path: Path) -> None:
    names = ("star", "tree", "snowflake", "kite", "plus", "arrow", "letter-l", "heart", "paper-chain", "rosette")
    for name in names:
        (tmp_path / f"{name}.json").write_bytes(pattern_in(export(folded(name), ".html")))
    moved = run_node("folding.mjs", *(tmp_path / f"{name}.json" for name in names))
    assert sum(one["straight"] for one in moved) > 30
    for name, one in zip(names, moved, strict=True):
        assert (one["crossings"], one["through"]) == (0, 0), name
        assert max(one["longest"], one["jump"]) < BENT, name


def test_a_fold_that_goes_the_wrong_way_is_seen(tmp_path: Path) -> None:
    data = json.loads(pattern_in(export(folded("star"), ".html")))
    data["steps"][1]["over"] = not data["steps"][1]["over"]
    (tmp_path / "star.json").write_text(json.dumps(data))
    (seen,) = run_node("folding.mjs", tmp_path / "star.json")
    assert seen["crossings"] > 0


def test_nothing_runs_in_a_page_but_its_own_script() -> None:
    page = export(square_out_of_square(), ".html").decode()
    (policy,) = re.findall(r'Content-Security-Policy" content="([^"]*)"', page)
    for name, kind in (("page.css", "style-src"), ("page.js", "script-src")):
        digest = base64.b64encode(hashlib.sha256(page_part(name).encode()).digest()).decode()
        assert f"{kind} 'sha256-{digest}'" in policy
        assert f">{page_part(name)}<" in page
    assert "unsafe" not in policy


@pytest.mark.parametrize("place", ["flat", "folded"])
def test_the_comparison_sees_a_moved_vertex(place: str) -> None:
    pattern = square_out_of_square()
    data = data_of(export(pattern, ".html").decode())
    data[place][0] = [1e3, 1e3]
    with pytest.raises(AssertionError):
        assert_holds_places(data, pattern)


def test_a_result_shows_itself_in_jupyter() -> None:
    result = fold(sample_path("triangle"), effort="fast")
    (page,) = re.findall(r'srcdoc="([^"]*)"', result._repr_html_())
    assert html.unescape(page).encode() == export(result.folded_pattern, ".html")
    assert (result._repr_svg_() or "").encode() == export(result.folded_pattern, ".svg")
    wrong = dataclasses.replace(result, findings=(Finding("layers", "a < b"),))
    assert wrong._repr_html_() == "layers: a &lt; b"
    assert wrong._repr_svg_() is None
