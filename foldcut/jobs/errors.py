"""The error of this package."""

from __future__ import annotations

from foldcut.core.errors import BadInputError


class JobError(BadInputError):
    """The job does not suit the machine: too large, or the profile lacks what it needs."""
