"""What a batch says at its end: a table with a row for every drawing, as CSV or Parquet, and the contact sheet.

Rows, or names and thumbnails -> the bytes of a file. Nothing is written here.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Sequence
from types import ModuleType
from typing import Any

from foldcut.exporters.pictures.contact_sheet import Thumbnail, contact_sheet
from foldcut.profiles import load_profile

RESULTS = "results.csv"
"""The name of the table."""

PARQUET = "results.parquet"
"""The name of the table as Parquet."""

CONTACT_SHEET = "contact-sheet"
"""The name of the contact sheet, without its ending."""

COLUMNS = (
    "file",
    "status",
    "method",
    "creases",
    "folds",
    "shortest_crease_mm",
    "off_by_mm",
    "for_hands",
    "difficulty",
    "seconds",
    "error",
    "outputs",
)
"""The columns of the table."""

Row = dict[str, Any]
"""What the table says about a drawing: a value for each of ``COLUMNS``."""


def csv_table(rows: Iterable[Row]) -> bytes:
    """Return the rows as CSV (RFC 4180); a space separates the names of several outputs."""
    text = io.StringIO(newline="")
    writer = csv.DictWriter(text, COLUMNS)
    writer.writeheader()
    for row in rows:
        writer.writerow(row | {"outputs": " ".join(row["outputs"])})
    return text.getvalue().encode("utf-8", "backslashreplace")


def parquet_table(arrow: ModuleType, rows: Sequence[Row]) -> bytes:
    """Return the rows as Parquet, made by ``pyarrow``; ``outputs`` is a list of names."""
    import pyarrow.parquet

    kinds = {"creases": arrow.int64(), "folds": arrow.int64(), "outputs": arrow.list_(arrow.string())}
    kinds |= dict.fromkeys(("shortest_crease_mm", "off_by_mm", "seconds"), arrow.float64())
    kinds |= {"for_hands": arrow.bool_()}
    schema = arrow.schema([(name, kinds.get(name, arrow.string())) for name in COLUMNS])
    table = arrow.Table.from_pylist([_encodable(row) for row in rows], schema=schema)
    out = io.BytesIO()
    pyarrow.parquet.write_table(table, out)
    return out.getvalue()


def _encodable(row: Row) -> Row:
    """Return a row with the escapes of what cannot be encoded in its texts, as the CSV has them."""

    def text(value: Any) -> Any:
        return value.encode("utf-8", "backslashreplace").decode() if isinstance(value, str) else value

    return {name: text(value) for name, value in row.items()} | {"outputs": [text(name) for name in row["outputs"]]}


def contact_sheet_file(pictures: Sequence[tuple[str, Thumbnail]], ending: str) -> bytes:
    """Return the contact sheet of named thumbnails as ".svg" or ".png"."""
    svg, size = contact_sheet(pictures, f"{len(pictures)} crease patterns", load_profile().drawing)
    if ending == ".svg":
        return svg
    from foldcut.exporters.pattern.png import rendered

    return rendered(svg, size)
