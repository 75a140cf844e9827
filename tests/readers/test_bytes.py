"""From bytes to a verified pattern or a documented error, whatever the bytes are."""

from __future__ import annotations

import json
import math
import tempfile
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.strategies import simple_polygons

import foldcut
from foldcut.core.errors import FoldcutError
from foldcut.drawing.limits import Limits
from foldcut.drawing.mend import Preparation, prepare
from foldcut.drawing.shape import invariant_faults, make_shape
from foldcut.readers import ReadOptions, read_shape

NUMBERS = st.one_of(
    st.integers(-3, 3),
    st.floats(-10, 10),
    st.floats(allow_nan=True, allow_infinity=True),
    st.sampled_from([1e-300, 1e300, 1e-6, 1e6, 0.1, -0.0]),
)
SCALES = st.sampled_from([1e-6, 1e-3, 1.0, 1e3, 1e6])


def folded(text: str, suffix: str) -> foldcut.Result | None:
    """Return the pattern of a file with this text, or None for an error that is documented."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, f"drawing{suffix}")
        path.write_text(text, encoding="utf-8")
        try:
            return foldcut.fold(path, effort="fast", seconds=0.2, min_crease=0, preparation=Preparation())
        except FoldcutError as error:
            assert str(error).strip()
            return None


@settings(max_examples=25)
@given(simple_polygons(max_corners=9), SCALES, st.sampled_from([".json", ".svg", ".wkt"]))
def test_polygons_of_any_scale_are_verified_or_refused(
    points: list[tuple[float, float]], scale: float, suffix: str
) -> None:
    corners = [(x * scale, y * scale) for x, y in points]
    text = {
        ".json": json.dumps({"loops": [corners]}),
        ".svg": f'<svg><polygon points="{" ".join(f"{x!r},{y!r}" for x, y in corners)}"/></svg>',
        ".wkt": f"POLYGON (({', '.join(f'{x!r} {y!r}' for x, y in [*corners, corners[0]])}))",
    }[suffix]
    result = folded(text, suffix)
    assert result is None or result.verified


@pytest.mark.parametrize("degrees", [0.5, 1, 3, 10])
def test_needles_are_verified_or_refused(degrees: float) -> None:
    tip = 100 * math.tan(math.radians(degrees / 2))
    result = folded(json.dumps({"loops": [[[0, 0], [100, -tip], [100, tip]]]}), ".json")
    assert result is not None, "a triangle always folds"
    assert result.verified


@settings(max_examples=100)
@given(st.lists(st.lists(st.tuples(NUMBERS, NUMBERS), max_size=7), max_size=4))
def test_random_loops_are_mended_to_a_shape_or_refused(loops: list[list[tuple[float, float]]]) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "drawing.json")
        path.write_text(json.dumps({"loops": loops}))
        try:
            prepared = prepare(read_shape(path).loops, Preparation(separate=0.1))
            shape = make_shape(prepared.loops)
        except FoldcutError:
            return
    assert invariant_faults(shape) == []


VALUES = st.recursive(st.none() | st.booleans() | NUMBERS | st.text(max_size=9), lambda v: st.lists(v, max_size=4))
TAGS = [
    "<svg>",
    "</svg>",
    "<g>",
    "</g>",
    "<rect ",
    'width="9" ',
    'height="9"',
    'transform="scale(0)" ',
    "/>",
    "<!",
    "&lt;",
]
PATHS = ['<path d="', "M0 0", "L9 9", "Z", "H5", "1e999", '"/>']
WORDS = st.sampled_from([*TAGS, *PATHS, "POLYGON ((", "0 0, ", "9 0, ", "0 9, ", "0 0", "))", "EMPTY"])


@settings(max_examples=150)
@given(
    st.sampled_from([".json", ".svg", ".wkt"]),
    st.lists(WORDS, max_size=12),
    st.dictionaries(st.sampled_from(["loops", "units", "title"]), VALUES, max_size=3),
    st.text(max_size=20),
)
def test_random_text_is_read_or_refused(suffix: str, words: list[str], document: dict[str, object], more: str) -> None:
    text = json.dumps(document) if suffix == ".json" else "".join(words)
    for content in (text, text + more):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, f"drawing{suffix}")
            path.write_bytes(content.encode("utf-8", "surrogatepass"))
            try:
                make_shape(read_shape(path, ReadOptions(limits=Limits(points=1000))).loops)
            except FoldcutError as error:
                assert str(error).strip()
