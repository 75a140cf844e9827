"""What can be wrong with a job."""

from __future__ import annotations

from foldcut.core.errors import BadInputError


class JobError(BadInputError):
    """The job does not suit the machine: the sheet is too large, or the profile lacks something the job needs."""


class TooLargeError(JobError):
    """The sheet, or a line on it, goes beyond what a machine reaches.

    ``what`` says how far; ``remedy`` is for drawings, which can still be laid on another sheet.
    """

    def __init__(self, what: str, remedy: str) -> None:
        self.what = what
        super().__init__(f"{what}; {remedy}")
