"""Read the silhouette in a PNG or JPEG (extra ``image``): threshold, despeckle, trace with vtracer.

A picture is turned as its EXIF data say. The shape is what is darker than the threshold, or in a picture with
transparent parts, what is not transparent. Specks and holes that are smaller than ``SPECK`` of the picture are dropped.
The polygons that vtracer returns are made into an SVG for the SVG reader. ``unit_mm`` follows from the dots per inch,
if the picture gives them.
"""

from __future__ import annotations

import io
import re
import warnings
from collections import Counter
from dataclasses import replace
from typing import Any

import numpy as np
from scipy import ndimage

from foldcut.core.errors import FileFormatError
from foldcut.core.units import MM_PER_INCH
from foldcut.readers import svg
from foldcut.readers.base import Drawing, ReadOptions, Source, counted, missing

SPECK = 2e-4
"""The largest area of a speck, as a share of that of the picture."""

FORMATS = ("PNG", "JPEG")
"""Pillow's names of the formats that are read."""


def read(source: Source, options: ReadOptions) -> Drawing:
    """Return the outlines of the silhouette in a picture; its title is the name of the file."""
    try:
        import vtracer
        from PIL import Image, UnidentifiedImageError
    except ImportError:
        raise missing("pictures", "image") from None
    try:
        with warnings.catch_warnings(action="ignore"), Image.open(io.BytesIO(source.data), formats=FORMATS) as picture:
            width, height = picture.size
            options.limits.check_pixels(width * height)
            dpi = float(picture.info.get("dpi", (0, 0))[0])
            turned = _turned(picture)
            width, height = turned.size
            mask = _silhouette(turned, options.threshold)
    except FileFormatError:
        raise
    except UnidentifiedImageError:  # its message is about a Python object
        raise FileFormatError("not a PNG or JPEG that can be read: it is neither; save the picture again") from None
    except Exception as error:  # Pillow raises all kinds of errors where a picture is broken
        about = " ".join(str(error).split())[:80] or type(error).__name__
        raise FileFormatError(f"not a PNG or JPEG that can be read: {about}; save the picture again") from None
    ignored: Counter[str] = Counter()
    mask = _despeckled(mask, ignored)
    if not mask.any() or mask.all():
        raise FileFormatError(
            "the picture has no silhouette; give a dark shape on a light background, or change --threshold"
        )
    pixels = Image.fromarray(np.pad(np.where(mask, 0, 255).astype(np.uint8), 1, constant_values=255))
    buffer = io.BytesIO()
    pixels.convert("RGB").save(buffer, "PNG")
    traced: str = vtracer.convert_raw_image_to_svg(
        buffer.getvalue(), img_format="png", colormode="binary", mode="polygon", filter_speckle=0, path_precision=3
    )
    paths = "".join(re.findall(r"<path[^<>]*>", traced))
    text = f'<svg viewBox="0 0 {width} {height}">{paths}</svg>'
    drawing = svg.read(Source(text.encode(), source.name), options)
    return replace(drawing, unit_mm=MM_PER_INCH / dpi if dpi > 1 else None, ignored=counted(ignored))


def _turned(picture: Any) -> Any:
    """Return a picture the way up that its EXIF data say; as it is, if these cannot be read."""
    from PIL import ImageOps

    picture.load()  # errors in the picture itself are for the caller
    try:
        return ImageOps.exif_transpose(picture)
    except Exception:  # Pillow raises all kinds of errors where EXIF data are broken
        return picture


def _silhouette(picture: Any, threshold: float) -> np.ndarray[Any, np.dtype[np.bool_]]:
    """Return which pixels are in the shape, ``(height, width)``."""
    if picture.mode.startswith("I"):  # grey of 16 bits, which Pillow cuts off at 255 where it converts it
        grey = np.asarray(picture).astype(np.int64)
        clear = picture.info.get("transparency")
        if isinstance(clear, int) and (grey == clear).any():
            opaque: np.ndarray[Any, np.dtype[np.bool_]] = grey != clear
            return opaque
        dark_grey: np.ndarray[Any, np.dtype[np.bool_]] = grey < threshold * (2**16 - 1)
        return dark_grey
    alpha = np.asarray(picture.convert("RGBA").getchannel("A"))
    if alpha.min() < 128:
        return alpha >= 128
    dark: np.ndarray[Any, np.dtype[np.bool_]] = np.asarray(picture.convert("L")) < threshold * 255
    return dark


def _despeckled(
    mask: np.ndarray[Any, np.dtype[np.bool_]], ignored: Counter[str]
) -> np.ndarray[Any, np.dtype[np.bool_]]:
    """Return the mask without specks, and without holes that are as small."""
    for value, name in ((True, "speck"), (False, "small hole")):
        labels, _ = ndimage.label(mask == value)
        small = np.bincount(labels.ravel()) < max(SPECK * mask.size, 5)
        small[0] = False
        ignored[name] += int(small.sum())
        mask = np.where(small[labels], not value, mask)
    return mask
