"""The errors that foldcut raises. Each message says what is wrong, where, with which value, and how to put it right.

``BadInputError`` and its subclasses mean that the input is at fault (the command exits with 2).
``UnfoldableError`` and its subclasses mean that no verified pattern was found (the command exits with 1).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from foldcut.core.model import Finding


class FoldcutError(Exception):
    """The root of every error that foldcut raises on purpose."""


class BadInputError(FoldcutError, ValueError):
    """The input cannot be used as it is."""


class ShapeError(BadInputError):
    """The drawing is not a set of disjoint simple loops, or it does not fit on the sheet."""


class TouchError(ShapeError):
    """Loops of the drawing touch; what they draw may still be a graph that can be cut (``drawing.graph``)."""


class SheetError(BadInputError):
    """A sheet, a length or a placement on the sheet makes no sense."""


class RibbonError(BadInputError):
    """The ribbon is wider than the smallest feature of the shape allows."""


class FileFormatError(BadInputError):
    """A file cannot be read as, or written in, the format that its name promises."""


class UnfoldableError(FoldcutError, RuntimeError):
    """The method found no pattern for a valid shape."""


class UnfoldableWhereError(UnfoldableError):
    """The reason names a ``place`` and ``lengths``, in mm.

    ``reason`` is a format: ``{x}`` and ``{y}`` stand for the place, ``{0}``, ``{1}`` and so on for the lengths.
    """

    def __init__(self, reason: str, place: Sequence[float] = (0.0, 0.0), lengths: Sequence[float] = ()) -> None:
        self.reason, self.place, self.lengths = reason, place, lengths
        super().__init__(reason.format(*lengths, x=place[0], y=place[1]))


class CreaseTooShortError(UnfoldableError):
    """A crease is shorter than the user allows: it is ``length`` mm long, and its middle is at ``place``."""

    def __init__(self, message: str, length: float, place: tuple[float, float]) -> None:
        self.length = length
        self.place = place
        super().__init__(message)


class VerificationError(UnfoldableError):
    """A pattern did not pass verification; ``findings`` say where and by how much."""

    def __init__(self, findings: tuple[Finding, ...]) -> None:
        self.findings = findings
        worst = "; ".join(str(finding) for finding in findings[:3])
        more = f" (and {len(findings) - 3} more)" if len(findings) > 3 else ""
        super().__init__(f"the pattern is not verified: {worst}{more}")


def needed_extra(what: str, extra: str) -> str:
    """Return the message that ``what`` (a plural) need a library from an extra that is not installed."""
    return f"{what} need the extra {extra!r}; install it with pip install 'foldcut[{extra}]'"
