"""SVG is read as Chromium paints it: every drawing of the table covers the same area of the sheet in both."""

from __future__ import annotations

import base64
import re
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from support.pictures import assert_alike, painted
from support.places import TESTS
from support.programs import require_program, run_program

from foldcut.core.arrays import Floats
from foldcut.readers import ReadOptions, read_shape

SIDE = 200
"""Pixels to the side of a drawing of 100 by 100 units."""

ROW = 8
"""Drawings side by side in the picture that Chromium makes."""

TABLE = TESTS / "readers" / "painted.txt"

ELEMENTS = {
    "kite": '<path d="M 10 10 L 90 20 L 70 85 L 30 60 Z"/>',
    "frame": '<rect width="100" height="100" {}/>',
    "square": '<rect x="30" y="30" width="30" height="20" {}/>',
}
"""What the table calls by its name."""


def table() -> dict[str, str]:
    """Return the drawings of the table by name."""
    lines = [line for line in TABLE.read_text("utf-8").splitlines() if line and not line.startswith("#")]
    return {name: whole(body) for name, _, body in (line.partition("\t") for line in lines)}


def whole(body: str) -> str:
    """Return what is in an svg element, with the elements that the table calls by name."""
    body = body.replace("@kite", ELEMENTS["kite"])
    while match := re.search(r"@(frame|square)\(", body):
        depth, end = 1, match.end()
        while depth:
            depth += {"(": 1, ")": -1}.get(body[end], 0)
            end += 1
        body = body[: match.start()] + ELEMENTS[match[1]].format(body[match.end() : end - 1]) + body[end:]
    return body


DRAWINGS = table()

PAGE = """<!doctype html><style>body {{ margin: 0; background: white; width: {width}px; font-size: 0 }}
img {{ width: {side}px; height: {side}px }}</style>{pictures}"""


def drawing(body: str) -> str:
    # A unit is two px, so that strokes that do not scale have another width than others.
    size = 'width="200" height="200" viewBox="0 0 100 100"'
    return f'<svg xmlns="http://www.w3.org/2000/svg" {size}>{body}</svg>'


@cache
def seen_by_chromium(folder: Path) -> dict[str, Floats]:
    """Return how dark each pixel of each drawing is, from 0 to 1, as one Chromium paints all of them."""
    chromium = require_program("chromium")
    pictures = "".join(
        f'<img src="data:image/svg+xml;base64,{base64.b64encode(drawing(body).encode()).decode()}">'
        for body in DRAWINGS.values()
    )
    width, height = ROW * SIDE, -(-len(DRAWINGS) // ROW) * SIDE
    (folder / "all.html").write_text(PAGE.format(width=width, side=SIDE, pictures=pictures))
    run_program(
        chromium, "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--force-device-scale-factor=1",
        f"--user-data-dir={folder / 'profile'}", f"--window-size={width},{height + 200}",
        f"--screenshot={folder / 'all.png'}", f"file://{folder / 'all.html'}",
    )  # fmt: skip
    picture = 1 - np.asarray(Image.open(folder / "all.png").convert("L"), dtype=np.float64) / 255
    places = ((number // ROW * SIDE, number % ROW * SIDE) for number in range(len(DRAWINGS)))
    return {name: picture[y : y + SIDE, x : x + SIDE] for name, (y, x) in zip(DRAWINGS, places, strict=True)}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("painted")


@pytest.mark.parametrize("name", DRAWINGS)
def test_what_chromium_paints_is_read(folder: Path, tmp_path: Path, name: str) -> None:
    path = tmp_path / f"{name}.svg"
    path.write_text(drawing(DRAWINGS[name]))
    options = ReadOptions(strokes="outline" if name.startswith("stroke-") else "lines")
    loops = [loop * (2, -2) for loop in read_shape(path, options).loops]
    assert_alike(seen_by_chromium(folder)[name], painted(loops, (SIDE, SIDE)))
