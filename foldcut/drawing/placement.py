"""Understand the name of a sheet, and lay a shape on it.

The name, such as "a4" or "200x300", and a ``Shape`` in drawing units -> the ``Sheet``, the shape in mm on it, and the
``Placement`` that took it there. Lengths are parsed by ``core.units``; ``drawing.shape`` makes the shape.

Invariants: the placed shape is similar to the drawn one and not mirrored, it lies strictly inside the sheet, and it
keeps the margin. Each corner is computed from its distance to the centre of the shape, so that a symmetric drawing
stays as symmetric as float64 allows; ``Placement.matrix`` agrees with the result to 1e-9 mm.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

import numpy as np
import shapely

from foldcut.core.arrays import Floats, points_array
from foldcut.core.errors import ShapeError, SheetError
from foldcut.core.model import Placement, Shape, Sheet
from foldcut.core.units import LENGTH, MM_PER_INCH, MM_PER_UNIT

__all__ = [
    "NAMED_SHEETS",
    "SHEET_LIMITS_MM",
    "Layout",
    "as_it_lies",
    "parse_scale",
    "parse_sheet",
    "place",
]

NAMED_SHEETS = {
    "a0": (841.0, 1189.0),
    "a1": (594.0, 841.0),
    "a2": (420.0, 594.0),
    "a3": (297.0, 420.0),
    "a4": (210.0, 297.0),
    "a5": (148.0, 210.0),
    "a6": (105.0, 148.0),
    "letter": (8.5 * MM_PER_INCH, 11 * MM_PER_INCH),
    "legal": (8.5 * MM_PER_INCH, 14 * MM_PER_INCH),
    "tabloid": (11 * MM_PER_INCH, 17 * MM_PER_INCH),
}
"""Sizes in portrait, in mm.

a0 to a6: ISO 216. letter and tabloid: sizes A and B of ANSI/ASME Y14.1 (8.5 x 11 in and 11 x 17 in). legal, which is in
neither, is 8.5 x 14 in.
"""

SHEET_LIMITS_MM = (1.0, 100_000.0)
"""The shortest and the longest side that a sheet can have."""

SMALLEST_SHAPE_MM = 0.1
"""A placed shape that is smaller than this across is taken for a mistake in the scale."""

FIT_TOLERANCE = 1e-9
"""How far rounding may take a corner into the margin, relative to the diagonal of the sheet."""

ROTATIONS = 360
"""The number of angles that are tried; the best of them is then improved."""


LARGEST_SCALE = 1e12
"""Nobody means a larger scale, nor a smaller one than 1 in this."""


def parse_scale(text: str) -> str | float:
    """Return "fit", or the factor that "1.5" or "1:2" (half size) means; raises ``SheetError`` for any other text."""
    if text == "fit":
        return "fit"
    numerator, colon, denominator = text.partition(":")
    try:
        scale = float(numerator) / (float(denominator) if colon else 1.0)
    except (ValueError, ZeroDivisionError):
        scale = 0.0
    if not 1 / LARGEST_SCALE < scale < LARGEST_SCALE:
        raise SheetError(f"--scale {text} is not a scale; give fit, a number such as 1.5, or a ratio such as 1:2")
    return scale


def parse_sheet(text: str) -> Sheet:
    """Return the sheet that ``text`` names.

    ``text`` is a name from ``NAMED_SHEETS`` in upper or lower case, with -portrait or -landscape after it if wanted
    (without that, ``as_it_lies`` chooses), or width x height such as 200x300, 20cmx30cm, "200 mm x 300 mm" or
    8.5x11in, where a unit that is given once counts for both. Raises ``SheetError`` for any other text.
    """
    name, _, orientation = text.strip().lower().partition("-")
    if name in NAMED_SHEETS and orientation in ("", "portrait", "landscape"):
        width, height = NAMED_SHEETS[name]
        title = name.upper() if name[0] == "a" else name
        if orientation == "landscape":
            return Sheet(height, width, f"{title} landscape")
        return Sheet(width, height, title, either_way=not orientation)
    match = re.fullmatch(rf"{LENGTH}\s*[x×]\s*{LENGTH}", text.strip().lower())
    if not match:
        raise SheetError(
            f"{text!r} is not a sheet; give {', '.join(NAMED_SHEETS)}, with -landscape if wanted, or width x "
            "height such as 200x300, 20cmx30cm or 8.5x11in"
        )
    width, height = (
        float(number) * MM_PER_UNIT[unit or match[2] or match[4] or "mm"]
        for number, unit in ((match[1], match[2]), (match[3], match[4]))
    )
    low, high = SHEET_LIMITS_MM
    if not (low <= width <= high and low <= height <= high):
        raise SheetError(f"the sheet {text!r} is {width:g} x {height:g} mm; give sides between {low:g} and {high:g} mm")
    return Sheet(width, height)


def as_it_lies(sheet: Sheet, shape: Shape, rotation: float = 0.0) -> Sheet:
    """Return ``sheet``; if it may lie either way, in landscape for a wide shape and in portrait for others.

    ``rotation`` is as for ``place``.
    """
    if not sheet.either_way:
        return sheet
    width, height = np.ptp(shape.points @ _rotation_matrix(rotation).T, axis=0)
    if width <= (1 + FIT_TOLERANCE) * height:
        return Sheet(sheet.width, sheet.height, sheet.name)
    return Sheet(sheet.height, sheet.width, f"{sheet.name} landscape")


def place(
    shape: Shape,
    sheet: Sheet,
    *,
    margin: float = 10.0,
    scale: str | float = "fit",
    offset: tuple[float, float] | None = None,
    rotation: float = 0.0,
) -> tuple[Shape, Placement]:
    """Return ``shape`` on ``sheet``, in mm, and the similarity that took it there.

    ``scale`` is mm per drawing unit, or "fit": as large as the margin allows. ``rotation`` is in degrees,
    counter-clockwise. ``offset`` is the place of the lower left corner of the bounding box, turned and scaled, in mm;
    None centres the shape. ``margin`` is in mm. Raises ``SheetError`` for numbers that make no sense, and
    ``ShapeError`` for a shape that does not fit inside the margin, strictly inside the sheet.
    """
    _check_numbers(sheet, margin, scale, offset, rotation)
    points = shape.points
    pivot = _box_centre(points)
    turn = _rotation_matrix(rotation)
    turned = (points - pivot) @ turn.T
    centre, size = _box_centre(turned), np.ptp(turned, axis=0)
    room = np.array([sheet.width, sheet.height]) - 2 * margin
    with np.errstate(divide="ignore"):  # a single line has no width or no height
        factor = float((room / size).min()) if scale == "fit" else float(scale)
    with np.errstate(over="ignore"):  # an infinite size is refused as any other that is too large
        target = np.array([sheet.width, sheet.height]) / 2 if offset is None else offset + factor * size / 2
        placed = (turned - centre) * factor + target
    _check_fit(placed, sheet, margin)
    linear = factor * turn
    matrix = np.column_stack([linear, target - linear @ pivot - factor * centre])
    matrix.setflags(write=False)
    return shape.with_points(placed), Placement(matrix)


@dataclass(frozen=True)
class Layout:
    """How a drawing is to lie on a sheet; lengths in mm.

    ``margin``, ``scale`` and ``offset`` are as for ``place``. Instead of a scale, ``width`` or ``height`` give the size
    of the drawing; with both, it fits into them. ``rotation`` is in degrees, or "best" for the angle at which the
    drawing fits largest. None means a quarter turn if no offset is given and the drawing then fits larger, or fits
    only then.
    """

    sheet: Sheet
    margin: float = 10.0
    scale: str | float = "fit"
    offset: tuple[float, float] | None = None
    rotation: str | float | None = None
    width: float | None = None
    height: float | None = None

    def __post_init__(self) -> None:
        if self.scale != "fit" and (self.width is not None or self.height is not None):
            raise SheetError("the drawing has a scale and a width or height; give one or the other")
        if isinstance(self.rotation, str) and self.rotation != "best":
            raise SheetError(f"the rotation is {self.rotation!r}; give degrees, or 'best'")

    def place(self, shape: Shape, turn: float = 0.0) -> tuple[Sheet, Shape, Placement, bool]:
        """Return the sheet as it lies, ``shape`` on it, its placement, and whether a quarter turn gave it more room.

        The shape is turned by ``turn`` degrees in addition. Errors are as for ``place``.
        """
        given = self.rotation if isinstance(self.rotation, int | float) else 0.0
        _check_numbers(self.sheet, self.margin, self.scale, self.offset, given)
        angle = _best_rotation(shape, self.sheet, margin=self.margin) if self.rotation == "best" else given
        scale = self.scale
        if self.width is not None or self.height is not None:
            scale = _scale_to(shape, self.width, self.height, angle)
        angle += turn
        on = as_it_lies(self.sheet, shape, angle)
        free = self.rotation is None and self.offset is None
        quarter = free and _lies_better_turned(shape, on, margin=self.margin, scale=scale, rotation=angle)
        angle += 90.0 * quarter
        placed, placement = place(shape, on, margin=self.margin, scale=scale, offset=self.offset, rotation=angle)
        return on, placed, placement, quarter


def _scale_to(shape: Shape, width: float | None = None, height: float | None = None, rotation: float = 0.0) -> float:
    """Return the mm per drawing unit at which ``shape``, turned by ``rotation``, has this width or height in mm.

    With both, it is the largest scale at which neither is exceeded. Raises ``SheetError`` for lengths that are not
    above 0.
    """
    size = np.ptp(shape.points @ _rotation_matrix(rotation).T, axis=0)
    scales = []
    for name, length, extent in (("width", width, size[0]), ("height", height, size[1])):
        if length is not None:
            if not 0 < length < math.inf:
                raise SheetError(f"the {name} of the drawing is {length:g} mm; give a length above 0")
            if not extent:
                raise SheetError(f"the drawing is a line with no {name}; leave out --{name}")
            scales.append(length / float(extent))
    return min(scales)


def _lies_better_turned(
    shape: Shape, sheet: Sheet, *, margin: float = 10.0, scale: str | float = "fit", rotation: float = 0.0
) -> bool:
    """Whether ``shape`` fits ``sheet`` larger after another quarter turn, or with a fixed ``scale``, fits only then."""
    size = np.ptp(shape.points @ _rotation_matrix(rotation).T, axis=0)
    room = np.array([sheet.width, sheet.height]) - 2 * margin
    with np.errstate(divide="ignore"):
        straight, turned = (float((room / extents).min()) for extents in (size, size[::-1]))
    return straight * (1 + FIT_TOLERANCE) < turned and (
        scale == "fit" or straight * (1 + FIT_TOLERANCE) < float(scale) <= turned * (1 + FIT_TOLERANCE)
    )


def _best_rotation(shape: Shape, sheet: Sheet, *, margin: float = 10.0) -> float:
    """Return the angle in degrees, from 0 to 180, at which ``shape`` fits ``sheet`` largest."""
    points = shapely.get_coordinates(shapely.convex_hull(shapely.multipoints(shape.points)))
    hull = Shape((points_array(points),), (-1,))

    def taken(degrees: float) -> float:
        """Return the share of the room that the shape takes, in the direction that is tighter."""
        on = as_it_lies(sheet, hull, degrees)
        size = np.ptp(points @ _rotation_matrix(degrees).T, axis=0)
        return float((size / (np.array([on.width, on.height]) - 2 * margin)).max())

    from scipy.optimize import minimize_scalar

    step = 180 / ROTATIONS
    start = min((number * step for number in range(ROTATIONS)), key=lambda degrees: round(taken(degrees), 12))
    found = minimize_scalar(taken, bounds=(start - step, start + step), method="bounded", options={"xatol": 1e-9})
    return float(found.x) % 180 if found.fun < taken(start) * (1 - FIT_TOLERANCE) else start


def _box_centre(points: Floats) -> Floats:
    centre: Floats = (points.min(axis=0) + points.max(axis=0)) / 2
    return centre


def _rotation_matrix(degrees: float) -> Floats:
    """Return the matrix of the rotation by ``degrees``, exact for quarter turns."""
    quarters, rest = divmod(degrees, 90.0)
    cosine, sine = math.cos(math.radians(rest)), math.sin(math.radians(rest))
    quarter_turn = np.array([(0.0, -1.0), (1.0, 0.0)])
    turn: Floats = np.linalg.matrix_power(quarter_turn, int(quarters) % 4) @ [(cosine, -sine), (sine, cosine)]
    return turn


def _check_numbers(
    sheet: Sheet, margin: float, scale: str | float, offset: tuple[float, float] | None, rotation: float
) -> None:
    half = min(sheet.width, sheet.height) / 2
    if not 0 <= margin < half:
        raise SheetError(
            f"a margin of {margin:g} mm leaves no room on the sheet {sheet}; give one from 0 to below {half:g} mm"
        )
    if scale != "fit" and not (isinstance(scale, int | float) and 0 < scale < math.inf):
        raise SheetError(f"the scale is {scale!r}; give 'fit' or a number of mm per drawing unit above 0")
    if not math.isfinite(rotation):
        raise SheetError(f"the rotation is {rotation:g} degrees; give a finite number")
    if offset is not None and not all(map(math.isfinite, offset)):
        raise SheetError(f"the offset is ({offset[0]:g}, {offset[1]:g}) mm; give two finite numbers")


def _check_fit(placed: Floats, sheet: Sheet, margin: float) -> None:
    low, high = placed.min(axis=0), placed.max(axis=0)
    size, sides = high - low, np.array([sheet.width, sheet.height])
    slack = FIT_TOLERANCE * sheet.diagonal
    if np.hypot(*size) < SMALLEST_SHAPE_MM:
        raise ShapeError(
            f"the shape is only {size[0]:.2g} x {size[1]:.2g} mm; use --scale fit or a scale that makes it "
            f"at least {SMALLEST_SHAPE_MM:g} mm across"
        )
    what = f"the shape is {size[0]:.1f} x {size[1]:.1f} mm"
    room = sides - 2 * margin
    if (size > room + slack).any():
        raise ShapeError(
            f"{what}, the sheet {sheet} leaves {room[0]:.1f} x {room[1]:.1f} mm inside a {margin:g} mm "
            "margin; use --scale fit, a larger sheet or a smaller margin"
        )
    if (low < margin - slack).any() or (high > sides - margin + slack).any():
        farthest = sides - margin - size
        raise ShapeError(
            f"{what} and reaches from ({low[0]:.1f}, {low[1]:.1f}) to ({high[0]:.1f}, {high[1]:.1f}), over "
            f"the {margin:g} mm margin of the sheet {sheet}; use an offset from ({margin:g}, {margin:g}) to "
            f"({farthest[0]:.1f}, {farthest[1]:.1f})"
        )
    if (low < slack).any() or (high > sides - slack).any():
        raise ShapeError(
            f"{what} and touches the border of the sheet {sheet}; use a margin above 0, or a smaller scale"
        )
