"""Slows down guesses of passwords, so that nobody is locked out by a stranger."""

from __future__ import annotations

import math
import time
from collections.abc import Callable

from motion import InputError

from .quotas import Buckets

TRIES = 8
"""Wrong passwords at once for one name from one address, or from one browser that has signed in before."""
ADDRESS_TRIES = 40
"""Wrong passwords at once from one address, for all names."""
NAME_TRIES = 40
"""Wrong passwords at once for one name, from all addresses together."""
REFILL_SECONDS = 300.0
"""Time in which all these tries come back, evenly."""


class TooManyTries(InputError):
    """Too many wrong passwords for one name or from one address."""


class Throttle:
    """Allows so many wrong passwords at once, and then one every few seconds.

    A name is slowed down for all addresses together, or a stranger with many addresses could go on guessing. A browser
    in which its owner has signed in before is not affected by that, or the stranger would lock the owner out.

    Args:
        clock: gives the time; seconds.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._pairs = Buckets(TRIES, REFILL_SECONDS, clock)
        self._addresses = Buckets(ADDRESS_TRIES, REFILL_SECONDS, clock)
        self._names = Buckets(NAME_TRIES, REFILL_SECONDS, clock)

    def take(self, name: str, address: str, browser: str = "") -> None:
        """Takes a try, before the password is looked at, so that many at once get no further than one by one.

        Args:
            name: of the account; it need not exist.
            address: where the try comes from.
            browser: id of a browser in which this name has signed in before; empty for others.

        Raises:
            TooManyTries: with the seconds to wait.
        """
        taken = self._counted(name, address, browser)
        wait = max(buckets.wait(key) for buckets, key in taken)
        if wait:
            raise TooManyTries(f"Too many wrong passwords: try again in {math.ceil(wait)} seconds.")
        for buckets, key in taken:
            buckets.take(key)

    def give_back(self, name: str, address: str, browser: str = "") -> None:
        """Gives a try back, since the password was right."""
        for buckets, key in self._counted(name, address, browser):
            buckets.take(key, -1)

    def _counted(self, name: str, address: str, browser: str) -> list[tuple[Buckets, str]]:
        name = name[:64]
        if browser:
            return [(self._pairs, f"{name} browser {browser}")]
        return [(self._pairs, f"{name} address {address}"), (self._addresses, address), (self._names, name)]
