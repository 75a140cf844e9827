"""Real drawings: silhouettes of icon sets become verified patterns, simplified to 20, 40 or 60 corners."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import pytest
from support.icons import SETS, fold_icon, icon_folders, silhouettes
from support.programs import missing

ICONS = 30
CHUNK = 10
BUDGETS = (12, 20, 30)


@cache
def chosen() -> list[Path]:
    folders = icon_folders()
    if len(folders) < len(SETS):
        missing(", ".join(SETS), "not all in tests/node/node_modules")
    return silhouettes(folders)[:ICONS]


@pytest.mark.parametrize("first", range(0, ICONS, CHUNK))
def test_silhouettes_of_icons_become_verified_patterns(first: int) -> None:
    icons = chosen()[first : first + CHUNK]
    assert len(icons) == CHUNK
    failed = {}
    for number, icon in enumerate(icons):
        budget = BUDGETS[number % len(BUDGETS)]
        row = fold_icon(icon, budget)
        if row["loops"] != 1:
            row["failure"] = f"{row['loops']} loops"
        if row["failure"]:
            failed[icon.stem] = row["failure"]
        else:
            assert 3 <= row["corners"] <= budget, icon.name
    assert failed == {}
