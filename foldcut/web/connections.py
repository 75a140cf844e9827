"""Connections to the server: how many one client may have, and how long one may stay without a whole request.

uvicorn's own limit is for all clients together, and it waits for a request for ever.
"""

from __future__ import annotations

import asyncio
from collections import Counter
from typing import Any

from uvicorn.protocols.http.h11_impl import H11Protocol

__all__ = ["bounded_protocol"]


def bounded_protocol(most_each: int, idle_seconds: float, busy_seconds: float) -> type[H11Protocol]:
    """Return the protocol for a server.

    ``most_each``: the connections that one client may have; more are closed at once. A connection on which nothing was
    asked for ``idle_seconds``, or on which one answer takes ``busy_seconds``, since the client does not take it, is
    closed within twice that time.
    """
    connected: Counter[str] = Counter()

    class Bounded(H11Protocol):
        """A connection that is counted and looked at from time to time."""

        who = ""
        asked: Any = None
        since = 0.0
        look: asyncio.TimerHandle | None = None

        def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
            super().connection_made(transport)
            self.who = self.client[0] if self.client else ""
            connected[self.who] += 1
            self.since = self.loop.time()
            self.look = self.loop.call_later(idle_seconds, self.close_if_stuck)
            if connected[self.who] > most_each:
                transport.abort()

        def connection_lost(self, exc: Exception | None) -> None:
            if self.look is not None:
                self.look.cancel()
            connected[self.who] -= 1
            if connected[self.who] <= 0:
                del connected[self.who]
            super().connection_lost(exc)

        def shutdown(self) -> None:
            super().shutdown()
            if self.cycle is not None and self.cycle.more_body:  # what is still on its way would not be used
                self.transport.abort()

        def close_if_stuck(self) -> None:
            busy = self.cycle is not None and not self.cycle.response_complete
            now = self.loop.time()
            if self.cycle is not self.asked:
                self.asked, self.since = self.cycle, now
            if now - self.since >= (busy_seconds if busy else idle_seconds):
                self.transport.abort()
            else:
                self.look = self.loop.call_later(idle_seconds, self.close_if_stuck)

    return Bounded
