"""Fold a sheet so that one straight cut cuts out any drawing with straight edges.

Public names:

- ``fold`` computes the crease pattern of a drawing, folds it and verifies it; it returns a ``Result``.
- ``Result`` has the ``FoldedPattern`` (``CreasePattern``, ``FoldedState``, ``Sheet``, ``Shape``, ``Placement``), what
  verification found (``Finding``), and how hard the pattern is to fold (``Foldability``).
- Errors: ``FoldcutError`` and, below it, ``BadInputError`` (``FileFormatError``, ``ShapeError``, ``SheetError``,
  ``RibbonError``), and ``UnfoldableError`` (``CreaseTooShortError``, ``VerificationError``).

``foldcut.exporters.export`` makes files of a pattern, ``foldcut.batch.run_batch`` folds many drawings.

    >>> import foldcut
    >>> result = foldcut.fold([[(0, 0), (40, 0), (0, 30)]], "a5")
    >>> result.verified
    True

The names are imported when they are first used, so that the command line starts at once.
"""

from __future__ import annotations

TYPE_CHECKING = False  # as in typing, which takes time to import
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
        from importlib import import_module

        for home in _HOMES:
            module = import_module(home)
            if hasattr(module, name):
                return getattr(module, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
