"""Fold a sheet so that one straight cut cuts out any drawing with straight edges.

The library in one call: ``foldcut.fold("fish.svg", "a4")`` computes the crease pattern, folds it and verifies it.

    >>> import foldcut
    >>> result = foldcut.fold([[(0, 0), (40, 0), (0, 30)]], "a5")
    >>> result.verified
    True

The names below are imported when they are first used, so that the command line starts at once.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from foldcut.core.errors import (
        BadInputError,
        CreaseTooShortError,
        FileFormatError,
        FoldcutError,
        RibbonError,
        ShapeError,
        SheetError,
        UnfoldableError,
        VerificationError,
    )
    from foldcut.core.model import CreasePattern, Finding, FoldedPattern, FoldedState, Placement, Shape, Sheet
    from foldcut.pattern.foldability import Foldability
    from foldcut.pipeline import Result, fold

__all__ = [
    "BadInputError",
    "CreasePattern",
    "CreaseTooShortError",
    "FileFormatError",
    "Finding",
    "Foldability",
    "FoldcutError",
    "FoldedPattern",
    "FoldedState",
    "Placement",
    "Result",
    "RibbonError",
    "Shape",
    "ShapeError",
    "Sheet",
    "SheetError",
    "UnfoldableError",
    "VerificationError",
    "fold",
]

_HOMES = ("foldcut.core.errors", "foldcut.core.model", "foldcut.pattern.foldability", "foldcut.pipeline")


def __getattr__(name: str) -> object:
    if name in __all__:
        for home in _HOMES:
            module = import_module(home)
            if hasattr(module, name):
                return getattr(module, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
