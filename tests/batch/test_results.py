"""The table of a batch: what a spreadsheet reads is what the rows say."""

from __future__ import annotations

import csv
import io

from foldcut.batch.results import COLUMNS, csv_table


def test_the_table_has_a_line_for_each_row_whatever_is_in_it() -> None:
    row = dict.fromkeys(COLUMNS) | {"file": 'a, "b".svg', "error": "two\nlines", "outputs": ["a.dxf", "a.fold"]}
    other = dict.fromkeys(COLUMNS) | {"file": "\udcff.svg", "creases": 12, "outputs": []}
    read = list(csv.DictReader(io.StringIO(csv_table([row, other]).decode(), newline="")))
    assert [*read[0]] == list(COLUMNS)
    assert (read[0]["file"], read[0]["error"], read[0]["outputs"]) == ('a, "b".svg', "two\nlines", "a.dxf a.fold")
    assert (read[1]["file"], read[1]["creases"], read[1]["outputs"]) == ("\\udcff.svg", "12", "")
