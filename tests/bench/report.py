"""The bench's tables in Markdown, fitted exponents, and the log-log plot as SVG."""

from __future__ import annotations

import html
import math
from collections.abc import Sequence
from typing import Any

import numpy as np

Row = dict[str, Any]
LEAST = 700
"""Exponents are fitted from so many boundary disks on."""
PATHS = {"exponent": None, "exponent, simple packing": False, "exponent, compiled packing": True}
"""Rows whose packing is done by simple code, by compiled code, or either."""


def values(rows: Sequence[Row], name: str) -> list[float | None]:
    """Return a column: a number of the pattern, or an item's seconds."""
    return [row[name] if name in row else row["items"].get(name, {}).get("s") for row in rows]


def exponent(rows: Sequence[Row], name: str, least: float = LEAST) -> float | None:
    """Return the slope of log(value) over log(boundary disks), by least squares; None of fewer than two rows."""
    pairs = zip(rows, values(rows, name), strict=True)
    used = [(row["boundary_disks"], value) for row, value in pairs if row["boundary_disks"] >= least and value]
    if len(used) < 2:
        return None
    x, y = np.log(np.array(used, dtype=float)).T
    return float(np.polyfit(x, y, 1)[0])


def exponents_of(rows: Sequence[Row], names: Sequence[str]) -> dict[str, dict[str, float | None]]:
    """Return the exponents by what rows they are fitted to: all from ``LEAST`` on, and those of either packing."""
    found = {}
    for title, compiled in PATHS.items():
        some = [row for row in rows if compiled is None or row["compiled"] == compiled]
        found[title] = {name: exponent(some, name, LEAST if compiled is None else 0) for name in names}
    return found


def markdown(result: dict[str, Any], stages: Sequence[str], yardsticks: Sequence[str]) -> tuple[str, dict[str, Any]]:
    """Return what was measured as Markdown, and the exponents of every column by kind of loop."""
    packages = ", ".join(f"{name} {version}" for name, version in result["packages"].items() if version)
    parts = [
        "# Bench",
        f"Python {result['python']} on {result['machine']}, {packages}; seed {result['seed']}; "
        f"{result['took_s']:.0f} s in all, {result['processor_s']:.0f} s of the processor. Seconds below are the "
        f"processor's. Exponents are fitted from {LEAST} boundary disks on, and to all rows whose packing is done by "
        "simple or by compiled code.",
        "![Seconds over boundary disks, both logarithmic](bench.svg)",
    ]
    exponents = {}
    for kind, left_out in result["left_out"].items():
        rows = [row for row in result["rows"] if row["kind"] == kind]
        if not rows:
            continue
        items = list(dict.fromkeys(name for row in rows for name in row["items"]))
        exponents[kind] = exponents_of(rows, [*stages, "build_s", *items])
        parts += [f"## {kind}", _patterns(rows, stages, exponents[kind])]
        parts += ["Seconds:", _seconds(rows, items, yardsticks, exponents[kind]["exponent"])]
        parts += ["Peak memory of the process in MB, the pattern included:", _memory(rows, items)]
        if left_out:
            parts += ["Left out:", "\n".join(f"- {name}: {why}" for name, why in left_out.items())]
    return "\n\n".join(parts) + "\n", exponents


def _patterns(rows: Sequence[Row], stages: Sequence[str], exponents: dict[str, dict[str, float | None]]) -> str:
    """Return a row for each pattern."""
    columns = [
        "boundary_disks", "disks", "creases", "faces", *stages, "build_s", "load_s", "verify_to_build", "kb_a_disk",
    ]  # fmt: skip
    lines = [[name.removesuffix("_s").replace("_", " ") + " s" * name.endswith("_s") for name in columns]]
    for row in rows:
        verify = row["items"].get("verify", {}).get("s")
        numbers = {**row, "verify_to_build": verify and verify / row["build_s"]}
        lines.append([_cell(numbers[name]) for name in columns])
    for title, fitted in exponents.items():
        cells = [_exponent(fitted.get(name)) for name in columns]
        if any(cells):
            lines.append([title, *cells[1:]])
    return _table(lines)


def _seconds(
    rows: Sequence[Row], items: Sequence[str], yardsticks: Sequence[str], exponents: dict[str, float | None]
) -> str:
    """Return a row for each item, and one for the ratio of the whole pattern to each yardstick."""
    lines = [_disks(rows, "exponent")]
    for title, name in (("packing", "packing_s"), ("whole pattern", "build_s"), *((name, name) for name in items)):
        cells = [
            "failed" if "failed" in row["items"].get(name, {}) else _cell(value)
            for row, value in zip(rows, values(rows, name), strict=True)
        ]
        lines.append([title, *cells, _exponent(exponents[name])])
    for name in yardsticks:
        if name in items:
            ratios = [
                _cell(value and row["build_s"] / value) for row, value in zip(rows, values(rows, name), strict=True)
            ]
            lines.append([f"whole pattern to {name}", *ratios, ""])
    return _table(lines)


def _memory(rows: Sequence[Row], items: Sequence[str]) -> str:
    lines = [_disks(rows), ["whole pattern", *(f"{row['peak_mb']:,.0f}" for row in rows)]]
    for name in items:
        peaks = [row["items"].get(name, {}).get("peak_mb") for row in rows]
        lines.append([name, *("" if peak is None else f"{peak:,.0f}" for peak in peaks)])
    return _table(lines)


def _disks(rows: Sequence[Row], *more: str) -> list[str]:
    return ["boundary disks", *(f"{row['boundary_disks']:,}" for row in rows), *more]


def _table(lines: Sequence[Sequence[str]]) -> str:
    head, *rest = lines
    rule = ["---", *["---:"] * (len(head) - 1)]
    return "\n".join("| " + " | ".join(line) + " |" for line in (head, rule, *rest))


def _cell(value: float | None) -> str:
    if value is None:
        return ""
    if isinstance(value, int) or value >= 1000:
        return f"{value:,.0f}"
    return f"{value:.3g}"


def _exponent(value: float | None) -> str:
    return "" if value is None else f"{value:.2f}"


WIDTH, PANEL, LEFT, TOP, BOTTOM, NAMES = 730.0, 440.0, 60.0, 30.0, 40.0, 225.0
COLOURS = (
    "#c0392b", "#e67e22", "#2471a3", "#7f8c8d", "#17a589", "#8e44ad", "#34495e", "#b7950b", "#d35400", "#1e8449",
    "#5dade2", "#cb4f9b", "#6e2c00", "#000000", "#839192", "#7d6608", "#f1948a", "#117864",
)  # fmt: skip
DASHES = ("", "5 3", "1.5 2.5")


def plot(rows: Sequence[Row], yardsticks: Sequence[str]) -> str:
    """Return seconds over boundary disks, both logarithmic, as an SVG: pattern and yardsticks, then exporters."""
    items = list(dict.fromkeys(name for row in rows for name in row["items"]))
    compared = {name: name for name in items if name in ("verify", *yardsticks)}
    exporters = {name: name for name in items if name not in compared}
    panels = [{"whole pattern": "build_s", "packing": "packing_s"} | compared]
    if exporters:
        panels.append({"whole pattern": "build_s"} | exporters)
    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH:g} {PANEL * len(panels):g}" '
        'font-family="sans-serif" font-size="11">',
        f'<rect width="{WIDTH:g}" height="{PANEL * len(panels):g}" fill="white"/>',
    ]
    for number, columns in enumerate(panels):
        out += [f'<g transform="translate(0 {number * PANEL:g})">', *_panel(rows, columns), "</g>"]
    return "\n".join([*out, "</svg>"]) + "\n"


def _panel(rows: Sequence[Row], columns: dict[str, str]) -> list[str]:
    """Return one diagram: a colour for each column, a dash for each kind of loop."""
    kinds = list(dict.fromkeys(row["kind"] for row in rows))
    lines = {}
    for title, name in columns.items():
        for kind in kinds:
            some = [row for row in rows if row["kind"] == kind]
            pairs = zip(some, values(some, name), strict=True)
            lines[title, kind] = [(row["boundary_disks"], value) for row, value in pairs if value]
    points = [point for line in lines.values() for point in line]
    if not points:
        return []
    (x0, y0), (x1, y1) = (
        np.floor(np.log10(points).min(axis=0)).astype(int).tolist(),
        np.ceil(np.log10(points).max(axis=0)).astype(int).tolist(),
    )

    def at(x: float, y: float) -> tuple[float, float]:
        return (
            LEFT + (math.log10(x) - x0) / max(x1 - x0, 1) * (WIDTH - LEFT - NAMES),
            PANEL - BOTTOM - (math.log10(y) - y0) / max(y1 - y0, 1) * (PANEL - BOTTOM - TOP),
        )

    out = []
    for power in range(x0, x1 + 1):
        (x, low), (_, high) = at(10.0**power, 10.0**y0), at(10.0**power, 10.0**y1)
        out.append(
            f'<path d="M{x:.1f} {low:.1f}V{high:.1f}" stroke="#ddd"/>'
            f'<text x="{x - 8:.1f}" y="{low + 16:.1f}">1e{power}</text>'
        )
    for power in range(y0, y1 + 1):
        (low, y), (high, _) = at(10.0**x0, 10.0**power), at(10.0**x1, 10.0**power)
        out.append(
            f'<path d="M{low:.1f} {y:.1f}H{high:.1f}" stroke="#ddd"/>'
            f'<text x="{low - 34:.1f}" y="{y + 4:.1f}">1e{power}</text>'
        )
    for (title, kind), line in lines.items():
        colour = COLOURS[list(columns).index(title) % len(COLOURS)]
        dash = DASHES[kinds.index(kind) % len(DASHES)]
        places = [at(*point) for point in line]
        path = " ".join(f"{x:.1f},{y:.1f}" for x, y in places)
        out.append(
            f'<polyline points="{path}" fill="none" stroke="{colour}" stroke-width="1.5" stroke-dasharray="{dash}"/>'
        )
        out += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="2" fill="{colour}"/>' for x, y in places]
    x = WIDTH - NAMES + 20
    legend = [(title, COLOURS[number % len(COLOURS)], "") for number, title in enumerate(columns)]
    legend += [(kind, "black", dash) for kind, dash in zip(kinds, DASHES, strict=False)]
    for number, (title, colour, dash) in enumerate(legend):
        y = 30 + 16 * number
        out.append(
            f'<path d="M{x:g} {y - 4:g}h24" stroke="{colour}" stroke-width="2" stroke-dasharray="{dash}"/>'
            f'<text x="{x + 30:g}" y="{y:g}">{html.escape(title)}</text>'
        )
    out.append(
        f'<text x="{(WIDTH - NAMES) / 2:g}" y="{PANEL - 6:g}">boundary disks</text><text x="4" y="12">seconds</text>'
    )
    return out
