"""Holding tabs: where the line that cuts the sheet out is left uncut, so that the sheet stays in the stock.

A closed outline and ``Tabs`` -> the pieces of it that are cut. Tabs lie evenly along the outline, as far from its
corners as they can: a tab in a corner tears it. The gap in the tool's path is wider than the tab by the kerf, which
eats half of its width at both ends of it.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

import numpy as np

from foldcut.core.arrays import Floats
from foldcut.core.model import Sheet
from foldcut.core.units import LENGTH, parse_length
from foldcut.jobs.errors import JobError
from foldcut.profiles import Profile

__all__ = ["Tabs", "check_tabs", "cut_around_tabs", "parse_tabs"]

CORNER_MM = 2.0
"""How far the end of a tab stays from a corner, at least."""

LEAST_MM, MOST_MM = 0.1, 20.0
"""How wide a tab is: what is narrower holds nothing, and what is wider is an outline that is not cut."""

MOST_TABS = 1000
"""No sheet needs more."""


@dataclass(frozen=True)
class Tabs:
    """How many tabs hold a sheet, and how wide each is, in mm."""

    count: int
    width_mm: float

    def __str__(self) -> str:
        return f"{self.count}x{self.width_mm:g}mm"


def parse_tabs(text: str) -> Tabs:
    """Return the tabs that a text such as ``4x0.5mm`` names. Raises JobError."""
    match = re.fullmatch(rf"([0-9]{{1,9}})\s*[x×]\s*({LENGTH})", text.strip().lower())
    count, width = (int(match[1]), parse_length(match[2])) if match else (0, 0.0)
    if not (0 < count <= MOST_TABS and 0 < width < math.inf):
        raise JobError(f"--tabs {text}: give how many and how wide, from 1 to {MOST_TABS}, such as 4x0.5mm")
    return Tabs(count, width)


def check_tabs(tabs: Tabs, sheet: Sheet, profile: Profile) -> None:
    """Raise JobError if a machine cannot hold a sheet by such tabs."""
    if profile.draws or not profile.cut_outline:
        raise JobError(f"--tabs hold a sheet that is cut out, and {profile.title} cuts nothing; leave them out")
    if profile.blade is not None and tabs.width_mm < profile.blade.offset_mm:
        trail = profile.blade.offset_mm
        raise JobError(
            f"a blade that trails its holder by {trail:g} mm swivels where a cut begins, and tears tabs of "
            f"{tabs.width_mm:g} mm; use --tabs {Tabs(tabs.count, trail)} or wider"
        )
    if not LEAST_MM <= tabs.width_mm <= MOST_MM:
        usual = Tabs(tabs.count, LEAST_MM if tabs.width_mm < LEAST_MM else MOST_MM)
        than = "wider" if tabs.width_mm < LEAST_MM else "narrower"
        raise JobError(
            f"--tabs {tabs}: a tab is from {LEAST_MM:g} to {MOST_MM:g} mm wide; use --tabs {usual} or {than}"
        )
    # before a FOLD file is opened its sheet counts as the smallest there is; there is no room for tabs on that
    if min(sheet.width, sheet.height) > 2 * CORNER_MM:
        cut_around_tabs(np.concatenate([sheet.corners, sheet.corners[:1]]), tabs, profile.kerf_mm)


def cut_around_tabs(outline: Floats, tabs: Tabs, kerf: float = 0.0) -> list[Floats]:
    """Return the pieces, ``(n, 2)`` each, of a closed outline, ``(m, 2)``, between tabs, in their order around it.

    Raises JobError: the tabs have no room between the corners, or leave less than half of the outline to be cut.
    """
    ends = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(outline, axis=0).T))])
    around, gap = float(ends[-1]), tabs.width_mm + kerf
    middle, _ = _farthest_from_corners(ends[:-1], around / tabs.count)
    if not _have_room(tabs, ends[:-1], around, kerf):
        raise JobError(_too_many(tabs, ends[:-1], around, kerf))
    first = middle + around / tabs.count * np.arange(tabs.count)
    starts, stops = first + gap / 2, np.roll(first, -1) - gap / 2
    stops[-1] += around
    return [_between(outline, ends, start, stop) for start, stop in zip(starts.tolist(), stops.tolist(), strict=True)]


def _farthest_from_corners(corners: Floats, every: float) -> tuple[float, float]:
    """Return where the first of tabs that come ``every`` mm is farthest from all corners, and how far that is.

    Seen from the tabs, all corners lie on a circle that is as long as the way from one to the next.
    """
    places = np.unique(np.round(corners % every, 9))
    places = places[places < every - 1e-6]
    gaps = np.diff([*places, places[0] + every])
    widest = int(np.argmax(np.round(gaps, 6)))
    return float((places[widest] + gaps[widest] / 2) % every), float(gaps[widest] / 2)


def _have_room(tabs: Tabs, corners: Floats, around: float, kerf: float) -> bool:
    """Return whether tabs stay away from corners, and half of the outline, or more, is cut."""
    gap = tabs.width_mm + kerf
    _, room = _farthest_from_corners(corners, around / tabs.count)
    return room >= gap / 2 + CORNER_MM and tabs.count * gap <= around / 2


def _too_many(tabs: Tabs, corners: Floats, around: float, kerf: float) -> str:
    """Say that tabs have no room, and how many of this width have, or how wide one may be."""
    fewer = (Tabs(count, tabs.width_mm) for count in range(tabs.count - 1, 0, -1))
    fits = next((some for some in fewer if _have_room(some, corners, around, kerf)), None)
    half = tabs.count * (tabs.width_mm + kerf) > around / 2
    lacks = "would be uncut for more than half of that" if half else "has no room for them between its corners"
    what = f"--tabs {tabs}: a sheet with {around:.0f} mm around it {lacks}"
    if fits:
        return f"{what}; use --tabs {fits}"
    widest = min(MOST_MM, math.floor(20 * (_farthest_from_corners(corners, around)[1] - CORNER_MM - kerf / 2)) / 10)
    return f"{what}; use --tabs {Tabs(1, widest)} or narrower" if widest >= LEAST_MM else f"{what}; leave --tabs out"


def _between(outline: Floats, ends: Floats, start: float, stop: float) -> Floats:
    """Return the part of a closed outline between two places along it, ``stop`` perhaps beyond its end."""
    around = ends[-1]
    inner = np.concatenate([outline[:-1], outline[:-1]])
    along = np.concatenate([ends[:-1], ends[:-1] + around])
    corners = inner[(along > start + 1e-9) & (along < stop - 1e-9)]
    return np.vstack([_point(outline, ends, start), corners, _point(outline, ends, stop)])


def _point(outline: Floats, ends: Floats, place: float) -> Floats:
    """Return the point of a closed outline at a place along it."""
    place %= ends[-1]
    return np.array([np.interp(place, ends, outline[:, 0]), np.interp(place, ends, outline[:, 1])])
