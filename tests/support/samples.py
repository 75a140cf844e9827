"""The samples that tests fold: all but those of the gallery, which ``make gallery`` folds, to keep the tests short."""

from __future__ import annotations

from foldcut.samples import sample_names

GALLERY = (
    *("bat", "bell", "butterfly", "candle", "crown", "ghost", "leaf"),
    *("letter-h", "letter-m", "mushroom", "pumpkin", "rabbit", "rocket", "whale"),
)
"""Samples that were drawn for the gallery."""

TESTED = tuple(name for name in sample_names() if name not in GALLERY)
