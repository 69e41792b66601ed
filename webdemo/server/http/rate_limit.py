"""Limits the rate of each person's requests."""

from __future__ import annotations

import time
from collections import OrderedDict

from .body_limits import Refused

_MOST = 20_000
"""People whose buckets are kept; the one that has been idle longest goes first."""


class RateLimit:
    """A token bucket for every person, refilled at a steady rate.

    The package ``limits`` has no request that weighs more than a full bucket, as a large upload does.

    Args:
        a_minute: how many; as many may come at once.
    """

    def __init__(self, a_minute: int) -> None:
        self.a_minute = a_minute
        self._buckets: OrderedDict[str, tuple[float, float]] = OrderedDict()

    def take(self, person: str, weight: float = 1.0) -> None:
        """Takes a request, or one as heavy as several; raises Refused if too little is left.

        A bucket that is full is enough for any one request.
        """
        now = time.monotonic()
        left, then = self._buckets.pop(person, (float(self.a_minute), now))
        left = min(self.a_minute, left + (now - then) * self.a_minute / 60)
        enough = left >= min(weight, self.a_minute)
        self._buckets[person] = (max(left - weight, 0.0) if enough else left, now)
        while len(self._buckets) > _MOST:
            self._buckets.popitem(last=False)
        if not enough:
            raise Refused(429, "Too many requests in one minute: wait a little.", "rate")
