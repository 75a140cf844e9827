"""Read the silhouette in a PNG or JPEG (extra ``image``): threshold, despeckle, trace with vtracer.

What is darker than the threshold is the shape; in a picture with transparent parts, what is not transparent. Specks
and holes of less than ``SPECK`` of the picture go. vtracer's polygons become an SVG, which the SVG reader reads.
``unit_mm`` follows from the picture's dots per inch, if it says.
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
"""The part of the picture's area that a speck may have."""

FORMATS = ("PNG", "JPEG")


def read(source: Source, options: ReadOptions) -> Drawing:
    """Return the outlines of the silhouette in a picture; its title is the file's stem."""
    try:
        import vtracer
        from PIL import Image, UnidentifiedImageError
    except ImportError:
        raise missing("pictures", "image") from None
    try:
        with warnings.catch_warnings(), Image.open(io.BytesIO(source.data), formats=FORMATS) as picture:
            warnings.simplefilter("ignore")
            width, height = picture.size
            options.limits.check_pixels(width * height)
            dpi = float(picture.info.get("dpi", (0, 0))[0])
            mask = _silhouette(picture, options.threshold)
    except FileFormatError:
        raise
    except UnidentifiedImageError:  # its words name an object of Python's
        raise FileFormatError("not a PNG or JPEG that can be read: it is neither; save the picture again") from None
    except Exception as error:  # Pillow lets all kinds of errors out where a picture is broken
        about = " ".join(str(error).split())[:80] or type(error).__name__
        raise FileFormatError(f"not a PNG or JPEG that can be read: {about}; save the picture again") from None
    ignored: Counter[str] = Counter()
    mask = _despeckled(mask, ignored)
    if not mask.any() or mask.all():
        raise FileFormatError(
            "the picture has no silhouette; give a dark shape on a light ground, or change --threshold"
        )
    pixels = Image.fromarray(np.pad(np.where(mask, 0, 255).astype(np.uint8), 1, constant_values=255))
    buffer = io.BytesIO()
    pixels.convert("RGB").save(buffer, "PNG")
    traced: str = vtracer.convert_raw_image_to_svg(
        buffer.getvalue(), img_format="png", colormode="binary", mode="polygon", filter_speckle=0, path_precision=3
    )
    paths = "".join(re.findall(r"<path[^>]*>", traced))
    text = f'<svg viewBox="0 0 {width} {height}">{paths}</svg>'
    drawing = svg.read(Source(text.encode(), source.name), options)
    return replace(drawing, unit_mm=MM_PER_INCH / dpi if dpi > 1 else None, ignored=counted(ignored))


def _silhouette(picture: Any, threshold: float) -> np.ndarray[Any, np.dtype[np.bool_]]:
    """Return which pixels are in the shape."""
    alpha = np.asarray(picture.convert("RGBA").getchannel("A"))
    if alpha.min() < 128:
        return alpha >= 128
    dark: np.ndarray[Any, np.dtype[np.bool_]] = np.asarray(picture.convert("L")) < threshold * 255
    return dark


def _despeckled(
    mask: np.ndarray[Any, np.dtype[np.bool_]], ignored: Counter[str]
) -> np.ndarray[Any, np.dtype[np.bool_]]:
    """Return the mask without specks, and without holes as small."""
    for value, name in ((True, "speck"), (False, "small hole")):
        labels, _ = ndimage.label(mask == value)
        small = np.bincount(labels.ravel()) < max(SPECK * mask.size, 5)
        small[0] = False
        ignored[name] += int(small.sum())
        mask = np.where(small[labels], not value, mask)
    return mask
