"""The command of vpype: lines become layers on the sheet, and errors are vpype's."""

from __future__ import annotations

from importlib.metadata import entry_points

import click
import numpy as np
import pytest
import vpype as vp
import vpype_cli
from support.folded import fold_sample

from foldcut.plugins.vpype_command import foldcut, pattern_layers
from foldcut.samples import sample_path

PX = 96 / 25.4


def test_vpype_finds_the_command() -> None:
    (entry,) = entry_points(group="vpype.plugins", name="foldcut")
    assert entry.value == "foldcut.plugins.vpype_command:foldcut"
    assert isinstance(foldcut, click.Command)


def test_a_drawing_becomes_layers_on_its_sheet() -> None:
    made = vpype_cli.execute(f"read '{sample_path('star')}' foldcut --sheet a5 --margin 15mm --effort fast")
    assert made.page_size == pytest.approx((210 * PX, 148 * PX))
    assert [made.layers[number].property(vp.METADATA_FIELD_NAME) for number in (1, 2, 3)] == [
        "Mountain",
        "Valley",
        "Cut",
    ]
    (outline,) = made.layers[3]
    assert len(outline) == 11
    assert outline[0] == outline[-1]
    height = np.ptp(outline.imag) / PX
    assert height == pytest.approx(148 - 30)


def test_creases_lie_where_the_pattern_has_them_y_down() -> None:
    pattern = fold_sample("arrow").folded_pattern
    made = pattern_layers(pattern)
    ends = np.array([point for number in (1, 2) for line in made.layers[number] for point in line])
    creases = pattern.creases
    folded = creases.edges_vertices[np.isin(creases.edges_assignment, ("M", "V"))]
    lines = np.concatenate([creases.edges_vertices[creases.edges_assignment == kind] for kind in "MV"])
    assert len(folded) == len(lines) == sum(len(made.layers[number]) for number in (1, 2))
    x, y = creases.vertices_coords[lines.ravel()].T
    assert ends == pytest.approx((x + 1j * (pattern.sheet.height - y)) * PX)


@pytest.mark.parametrize(
    ("pipeline", "error"),
    [
        ("foldcut", "the file has no polygon"),
        ("line 0 0 5cm 5cm foldcut", "close the outline"),
        ("rect 0 0 5cm 5cm foldcut --margin 3ells", "'3ells' is not a length"),
    ],
)
def test_what_cannot_be_folded_is_said(pipeline: str, error: str) -> None:
    with pytest.raises(click.ClickException, match=error):
        vpype_cli.execute(pipeline)


def test_the_remedy_for_lines_that_do_not_meet_works() -> None:
    gap = "line 0 0 5cm 0 line 5cm 0 5cm 5cm line 5cm 5cm 1cm 5mm foldcut --effort fast"
    with pytest.raises(click.ClickException, match=r"with --join ([\d.]+mm)") as refused:
        vpype_cli.execute(gap)
    join = str(refused.value.message).partition("--join ")[2].split()[0].rstrip(";")
    assert len(vpype_cli.execute(f"{gap} --join {join}").layers[3]) == 1
