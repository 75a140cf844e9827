"""Fold a sheet so that one straight cut cuts out any drawing with straight edges.

Public names:

- ``fold`` computes the crease pattern of a drawing, folds it and verifies it; it returns a ``Result``, which ``save``
  writes to files and which notebooks show. ``Options`` are all that it can be told (``Preparation`` says how a drawing
  is mended), ``JobOptions`` all that a job can.
- ``check`` decides whether a pattern of any program folds flat; it returns a ``Decision``.
- ``Result`` has the ``FoldedPattern`` (``CreasePattern``, ``FoldedState``, ``Sheet``, ``Shape``, ``Placement``), what
  verification found (``Finding``), and how hard the pattern is to fold (``Foldability``).
- Errors: ``FoldcutError`` and, below it, ``BadInputError`` (``FileFormatError``, ``ShapeError``, ``SheetError``,
  ``RibbonError``), and ``UnfoldableError`` (``CreaseTooShortError``, ``VerificationError``).

``foldcut.exporters.export`` makes the bytes of a file, ``foldcut.batch.run_batch`` folds many drawings.

    >>> import foldcut
    >>> result = foldcut.fold("star", "a5", margin="15mm")
    >>> result
    <Result Five-pointed star on A5 landscape (210 x 148 mm): 4 folds, 10 creases by simple, verified>
    >>> result.save("star.pdf")  # doctest: +SKIP
    (PosixPath('star.pdf'),)

The names are imported when they are first used, so that the command line starts at once.
"""

from __future__ import annotations

TYPE_CHECKING = False  # as in typing, which takes time to import
if TYPE_CHECKING:
    from foldcut.checking import check
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
    from foldcut.drawing.mend import Preparation
    from foldcut.foldfile.decide import Decision
    from foldcut.options import Options
    from foldcut.output.render import JobOptions
    from foldcut.pattern.foldability import Foldability
    from foldcut.pipeline import Result, fold

__all__ = [
    "BadInputError",
    "CreasePattern",
    "CreaseTooShortError",
    "Decision",
    "FileFormatError",
    "Finding",
    "Foldability",
    "FoldcutError",
    "FoldedPattern",
    "FoldedState",
    "JobOptions",
    "Options",
    "Placement",
    "Preparation",
    "Result",
    "RibbonError",
    "Shape",
    "ShapeError",
    "Sheet",
    "SheetError",
    "UnfoldableError",
    "VerificationError",
    "check",
    "fold",
]

_HOMES = (
    "foldcut.core.errors",
    "foldcut.core.model",
    "foldcut.pattern.foldability",
    "foldcut.drawing.mend",
    "foldcut.options",
    "foldcut.output.render",
    "foldcut.pipeline",
    "foldcut.foldfile.decide",
    "foldcut.checking",
)


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
