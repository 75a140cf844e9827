"""The ways to fold a shape: one package and one row of ``METHODS`` each.

A method's package has a module ``method`` with one function, ``fold(problem, effort) -> Made`` (see ``methods.base``):
it returns a pattern, or raises ``UnfoldableError``. Whatever it returns is verified by the pipeline. The command line's
choices and help, reports, and the remedies in errors read this table; ``methods.auto`` says in which order methods are
tried. Nothing slow is imported here, so that the command line can list the methods at once.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING

from foldcut.core.errors import BadInputError

if TYPE_CHECKING:
    from foldcut.methods.base import Effort, Made, Problem

__all__ = ["AUTO", "CHOICES", "DEFAULT_METHOD", "EFFORTS", "METHODS", "Method", "fewer_creases", "last_resort"]

AUTO = "auto"
"""Not a method: it has several methods tried and takes the pattern that is easiest to fold (``methods.auto``)."""

DEFAULT_METHOD = AUTO

EFFORTS = ("fast", "normal", "best")
"""How long a method searches for the best pattern."""


@dataclass(frozen=True)
class Method:
    """A way to fold a shape.

    - ``summary``: what it does, in words for ``--help``;
    - ``package``: where it is, under ``foldcut.methods``;
    - ``min_crease_mm``: the shortest crease that its patterns may have unless told otherwise;
    - ``needs_ribbon``: without a ribbon along the cut its creases fold onto the cut line;
    - ``few_creases``: it is the one to try where another method's creases get too short;
    - ``construction``: its stages can be drawn;
    - ``graphs``: it folds any planar graph, not only loops that lie apart;
    - ``cuts_down``: more paper around the drawing makes more folds, so the sheet may be cut down first.
    """

    name: str
    summary: str
    package: str
    min_crease_mm: float = 0.0
    needs_ribbon: bool = False
    few_creases: bool = False
    construction: bool = False
    graphs: bool = False
    cuts_down: bool = False

    def fold(self, problem: Problem, effort: Effort) -> Made:
        """Return the pattern that this method makes of a shape on its sheet.

        Raises ``UnfoldableError`` with the reason where it makes none.
        """
        made: Made = import_module(f"{__name__}.{self.package}.method").fold(problem, effort)
        return made


METHODS = {
    method.name: method
    for method in (
        Method(
            "mirror",
            "fold the drawing's mirror axes first, the rest through all layers of what is left",
            package="mirror",
            min_crease_mm=0.5,
        ),
        Method(
            "simple",
            "folds across the whole sheet only, one after another, each through all layers; few drawings",
            package="simple",
            cuts_down=True,
        ),
        Method("compact", "one loop, few creases", package="compact", min_crease_mm=0.5, few_creases=True),
        Method(
            "paper",
            "the disk packing of Bern, Demaine, Eppstein and Hayes, thousands of creases",
            package="disks",
            needs_ribbon=True,
            construction=True,
        ),
        Method(
            "skeleton",
            "any loops, few creases, but not all drawings",
            package="skeleton",
            graphs=True,
            cuts_down=True,
        ),
        Method("gate", "the same as paper for several loops", package="gate", needs_ribbon=True),
    )
}
"""By name, in the order in which they are listed."""

CHOICES = (AUTO, *METHODS)
"""What can be asked for."""


def check_choice(name: str) -> None:
    """Raise ``BadInputError`` unless a pattern can be asked for by this name."""
    if name not in CHOICES:
        raise BadInputError(f"unknown method {name!r}; known: {', '.join(CHOICES)}")


def check_graph(name: str) -> None:
    """Raise ``BadInputError`` if a method that is asked for does not fold open lines and figures that touch."""
    if name != AUTO and not METHODS[name].graphs:
        known = " or ".join(method.name for method in METHODS.values() if method.graphs)
        raise BadInputError(
            f"--method {name} folds closed outlines that lie apart, and this drawing has open lines or outlines that "
            f"touch; leave it out, or give --method {known}"
        )


def fewer_creases(tried: Collection[str] = ()) -> str:
    """Return the name of the method to try where creases get too short; an empty string if it has been ``tried``."""
    return next((method.name for method in METHODS.values() if method.few_creases and method.name not in tried), "")


def last_resort(loops: int) -> str:
    """Return the method for drawings with this many loops that no other folds; its patterns have thousands of folds."""
    return "paper" if loops == 1 else "gate"
