"""Limits how often something may be done: requests of each person, and tries of passwords."""

from __future__ import annotations

import time
from collections import OrderedDict
from collections.abc import Callable

from .refused import Refused

_MOST = 20_000
"""Buckets that are kept; the one that has been idle longest goes first."""


class Buckets:
    """A token bucket for every key, refilled at a steady rate.

    Args:
        size: tokens in a full one.
        seconds: in which an empty one is filled.
        clock: gives the time; seconds.
    """

    def __init__(self, size: float, seconds: float, clock: Callable[[], float] = time.monotonic) -> None:
        self.size, self.a_second, self.clock = size, size / seconds, clock
        self._left: OrderedDict[str, tuple[float, float]] = OrderedDict()

    def wait(self, key: str, tokens: float = 1.0) -> float:
        """Seconds until a bucket has so many tokens; 0 if it has them now."""
        return max(0.0, tokens - self._now(key)) / self.a_second

    def take(self, key: str, tokens: float = 1.0) -> None:
        """Takes tokens, or what is left of them; a negative number puts some back."""
        left = min(self.size, max(0.0, self._now(key) - tokens))
        self._left.pop(key, None)
        self._left[key] = (left, self.clock())
        while len(self._left) > _MOST:
            self._left.popitem(last=False)

    def _now(self, key: str) -> float:
        left, then = self._left.get(key, (self.size, 0.0))
        return min(self.size, left + (self.clock() - then) * self.a_second)


class RateLimit:
    """Requests of each person: so many a minute, and as many at once.

    The package ``limits`` has no request that weighs more than a full bucket, as a large upload does.

    Args:
        a_minute: how many.
        clock: gives the time; seconds.
    """

    def __init__(self, a_minute: int, clock: Callable[[], float] = time.monotonic) -> None:
        self._buckets = Buckets(a_minute, 60.0, clock)

    def take(self, person: str, weight: float = 1.0) -> None:
        """Takes a request, or one as heavy as several; raises Refused if too little is left.

        A bucket that is full is enough for any one request.
        """
        if self._buckets.wait(person, min(weight, self._buckets.size)):
            raise Refused(429, "Too many requests in one minute: wait a little.", "rate")
        self._buckets.take(person, weight)
