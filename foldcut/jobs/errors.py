"""What can be wrong with a job."""

from __future__ import annotations

from foldcut.core.errors import BadInputError


class JobError(BadInputError):
    """The job does not suit the machine: the sheet is too large, or the profile lacks something the job needs."""
