"""How wide the ribbon may be: the strip along the shape's boundary that is not folded (paper section 5).

Without a ribbon, sides of molecules between corners on the shape's boundary fold onto the cut line itself, and the cut
severs the paper there.
"""

from __future__ import annotations

from foldcut.core.errors import RibbonError
from foldcut.core.model import Shape, Sheet
from foldcut.methods.disks.loops import loops_of, vertex_radii

__all__ = ["DEFAULT_RIBBON_MM", "default_ribbon", "largest_ribbon", "require_tellable", "ribbon_or_default", "too_wide"]

DEFAULT_RIBBON_MM = 0.25
"""A pencil line's width on either side of the boundary: less is hard to crease, more is a visible strip."""

NARROWEST_RIBBON = 1e-7
"""Verification takes creases of a narrower ribbon, relative to the sheet's diagonal, for points on the cut line."""


def ribbon_or_default(wished: float | None, shape: Shape, sheet: Sheet) -> float:
    """Return the half-width in mm that is wished for, or the default for None; ``shape`` is in the sheet's mm."""
    return default_ribbon(shape, sheet) if wished is None else wished


def default_ribbon(shape: Shape, sheet: Sheet) -> float:
    """Return the half-width in mm of a ribbon that keeps creases off the cut line and changes little else.

    ``shape`` is in the sheet's mm. It is ``DEFAULT_RIBBON_MM``, or half the largest that works where that is less.
    """
    return largest_ribbon(shape, sheet, 2 * DEFAULT_RIBBON_MM) / 2


def largest_ribbon(shape: Shape, sheet: Sheet, at_most: float) -> float:
    """Return the largest half-width, up to ``at_most``, of a ribbon that the shape has room for; all in mm.

    ``shape`` is in the sheet's mm.
    """
    if vertex_radii(loops_of(shape, sheet, at_most)) is not None:
        return at_most
    low, high = 0.0, at_most
    for _ in range(40):
        middle = (low + high) / 2
        if vertex_radii(loops_of(shape, sheet, middle)) is None:
            high = middle
        else:
            low = middle
    return low


def require_tellable(sheet: Sheet, ribbon: float) -> None:
    """Raise ``RibbonError``, with the least half-width, if the ribbon is too narrow to tell its two borders apart."""
    least = NARROWEST_RIBBON * sheet.diagonal
    if 0 < ribbon < least:
        raise RibbonError(
            f"a ribbon of half-width {ribbon:.2g} mm is too narrow to tell its two borders apart; it needs "
            f"{least:.2g} mm: ask for a wider one, or leave more room between the drawing's edges and to the border"
        )


def too_wide(shape: Shape, sheet: Sheet, ribbon: float) -> RibbonError:
    """Return the error for a ribbon that has no room, with the largest half-width that works."""
    widest = float(f"{largest_ribbon(shape, sheet, ribbon) * 0.999:.2e}")
    return RibbonError(
        f"a ribbon of half-width {ribbon:g} mm is too wide for the shape's smallest feature or its distance from the "
        f"sheet's border; the largest half-width that works is {widest:g} mm"
    )
