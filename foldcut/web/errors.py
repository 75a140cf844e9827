"""The error of a request that cannot be served."""

from __future__ import annotations


class RefusedError(Exception):
    """A request that is refused: the ``status`` of the answer, and a sentence for the page to show."""

    def __init__(self, status: int, message: str) -> None:
        super().__init__(message)
        self.status = status
