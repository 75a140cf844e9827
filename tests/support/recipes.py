"""Files without their recipes, to compare what else is in them."""

from __future__ import annotations

import re

RECIPES = re.compile(
    rb'<!-- foldcut recipe: .* -->\n|999\nfoldcut recipe: .*\n|; foldcut recipe: .*\n|,\n"foldcut:recipe": \{.*\}'
)


def without_recipe(data: bytes) -> bytes:
    """Return an SVG, HTML, DXF, G-code or FOLD file without its recipe, of which there is one."""
    left, count = RECIPES.subn(b"", data)
    assert count
    return left
