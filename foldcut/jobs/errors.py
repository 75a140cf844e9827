"""What can be wrong with a job."""

from __future__ import annotations

from collections.abc import Sequence

from foldcut.core.errors import BadInputError


class JobError(BadInputError):
    """The job does not suit the machine: the sheet is too large, or the profile lacks something the job needs."""


class LackingError(JobError):
    """A profile lacks what a format needs; ``values`` are examples of it, such as "page.margin_mm=5".

    Without values nothing that could be set makes the machine one for this format.
    """

    def __init__(self, what: str, values: Sequence[str] = ()) -> None:
        add = " ".join(["add it with", *(f"--set {value}" for value in values)])
        self.what, self.remedies = what, [add] if values else []
        super().__init__("; ".join([what, *self.remedies]))


class TooLargeError(JobError):
    """The sheet, or a line on it, goes beyond what a machine reaches.

    ``what`` says how far; ``remedy`` is for drawings, which can still be laid on another sheet, and ``keeping`` for
    patterns, which have theirs.
    """

    def __init__(self, what: str, remedy: str, keeping: str = "take a larger machine, or a printer and --tile") -> None:
        self.what, self.keeping = what, keeping
        super().__init__(f"{what}; {remedy}")
