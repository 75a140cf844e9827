"""``foldcut check --shape`` judges within what the file states that the drawing was moved by."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from support.patterns import square_out_of_square

from foldcut.cli.main import main
from foldcut.exporters import export


@pytest.mark.parametrize(
    ("width", "stated", "status", "words"),
    [
        (40.0, 0.0, 0, "verified"),
        (40.3, 0.3, 0, "at most 0.3 mm off the drawing"),
        (40.3, 0.2, 1, "moved from the drawing by 0.3 mm, and the file states 0.2 mm"),
        (40.3, None, 1, "does not state by how much"),
        (30.0, 1000.0, 1, "over 2 % of the drawing's size"),
    ],
)
def test_an_outline_is_judged_within_what_the_file_states(
    width: float,
    stated: float | None,
    status: int,
    words: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    document = json.loads(export(square_out_of_square(), ".fold"))
    if stated is not None:
        document["foldcut:movedBy"] = stated
    pattern, drawing = tmp_path / "a.fold", tmp_path / "d.json"
    pattern.write_text(json.dumps(document))
    loop = [[4, 4], [4 + width, 4], [4 + width, 44], [4, 44]]
    drawing.write_text(json.dumps({"loops": [loop], "units": "mm"}))
    assert main(["check", str(pattern), "--shape", str(drawing)]) == status
    told = capsys.readouterr()
    assert words in told.out + told.err
