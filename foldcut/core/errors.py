"""The errors foldcut raises: each message says what, where, which value, and the remedy.

``BadInputError`` and its leaves mean that the input is at fault (the command exits with 2);
``UnfoldableError`` and its leaves mean that no verified pattern was found (the command exits with 1).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from foldcut.core.model import Finding


class FoldcutError(Exception):
    """The root of every error that foldcut raises on purpose."""


class BadInputError(FoldcutError, ValueError):
    """What was given cannot be used as it is."""


class ShapeError(BadInputError):
    """The drawing is not a set of disjoint simple loops, or does not fit the sheet."""


class SheetError(BadInputError):
    """The sheet's name, size or margin makes no sense."""


class RibbonError(BadInputError):
    """The ribbon is wider than the shape's smallest feature allows."""


class FileFormatError(BadInputError):
    """A file cannot be read as, or written to, the format its name promises."""


class UnfoldableError(FoldcutError, RuntimeError):
    """The method found no pattern for a valid shape."""


class CreaseTooShortError(UnfoldableError):
    """A pattern has a crease that is shorter than asked for: ``length`` in mm, its middle at ``place``."""

    def __init__(self, message: str, length: float, place: tuple[float, float]) -> None:
        self.length = length
        self.place = place
        super().__init__(message)


class VerificationError(UnfoldableError):
    """A pattern did not pass verification; ``findings`` says where and by how much."""

    def __init__(self, findings: tuple[Finding, ...]) -> None:
        self.findings = findings
        worst = "; ".join(str(finding) for finding in findings[:3])
        more = f" (and {len(findings) - 3} more)" if len(findings) > 3 else ""
        super().__init__(f"the pattern is not verified: {worst}{more}")


def needed_extra(what: str, extra: str) -> str:
    """Return the message for ``what``, a plural, whose library is in an extra that is not installed."""
    return f"{what} need the extra {extra!r}; install it with pip install 'foldcut[{extra}]'"
