"""What a person may use, in one place: connections, requests, events, reading places, runs, live streams and megabytes.

:class:`Quotas` has all of them, made from the settings. What is held at a time is compared with a :class:`Quota`, what
comes again and again with a :class:`RateLimit`, and what is stored with :class:`Rooms`
(:mod:`webdemo.server.store.storage` knows the sizes). A person without an account is a cookie, which they could throw
away, so everybody of one address together has a limit as well.
"""

from __future__ import annotations

import ipaddress
import math
import time
from collections import OrderedDict
from collections.abc import Callable, Iterable
from dataclasses import dataclass

from motion import InputError
from webdemo.server.http.routes import Refused
from webdemo.server.settings import Settings
from webdemo.ui.places import AT_ONCE

GETS = 1500
"""GETs of one person in a minute: the page with all of its files takes about 150."""
ADDRESS_SHARE = 0.5
"""Share of all room that people from one address may have, where strangers are known by their cookies."""
_MOST = 20_000
"""Buckets that are kept; the one that has been idle longest goes first."""


class OverQuota(InputError):
    """Somebody has as much as they may have.

    Attributes:
        whose: the share that is used up: "person", "address" or "everybody".
    """

    def __init__(self, whose: str, sentence: str) -> None:
        super().__init__(sentence)
        self.whose = whose


@dataclass(frozen=True)
class Quota:
    """The most of one thing at a time.

    Attributes:
        what: its name in sentences, in the plural.
        person: of one person.
        address: of all people of one address, where they have no accounts.
        everybody: of all people together.
    """

    what: str
    person: float = math.inf
    address: float = math.inf
    everybody: int = 2**31

    def check(self, person: str, address: str, held: Iterable[tuple[str, str]]) -> None:
        """Raises OverQuota if one more were too many.

        Args:
            person: who wants it.
            address: theirs, where it counts; else "".
            held: the person and the address of each that there is.
        """
        holders = list(held)
        mine = sum(person == other for other, _ in holders)
        near = sum(address == other for _, other in holders) if address else 0
        if mine >= self.person:
            raise OverQuota(
                "person", f"You already have {mine} {self.what}: wait for one or cancel it, then try again."
            )
        if near >= self.address:
            raise OverQuota(
                "address", f"People from your network have {near} {self.what} already: try again in a few minutes."
            )
        if len(holders) >= self.everybody:
            raise OverQuota(
                "everybody", f"There are {len(holders)} {self.what} here already: try again in a few minutes."
            )


@dataclass(frozen=True)
class Rooms:
    """Bytes that may be stored.

    Attributes:
        person: for runs, studies, uploads and downloads of a person for whom nothing else is set.
        address: for runs and studies of all people of one address, where they have no accounts.
        everybody: for all people's runs and studies.
    """

    person: float = math.inf
    address: float = math.inf
    everybody: float = 2e9


@dataclass(frozen=True, kw_only=True)
class Quotas:
    """Everything that is limited for a person.

    Attributes:
        connections: open ones.
        requests, address_requests: a minute, of those that change something, for a person and for an address.
        gets, address_gets: a minute, of the others.
        events: unfinished events of the page: runs, films, files that are read.
        reading: files that are read at a time.
        waiting: runs in the queue.
        live: live streams.
        rooms: bytes.
    """

    connections: Quota
    requests: RateLimit
    address_requests: RateLimit
    gets: RateLimit
    address_gets: RateLimit
    events: Quota
    reading: Quota
    waiting: Quota
    live: Quota
    rooms: Rooms

    @classmethod
    def of(cls, settings: Settings) -> Quotas:
        """Those of a server's settings."""
        people = settings.address_people
        near, gets = settings.events * people, max(GETS, settings.rate)
        total = settings.keep_megabytes * 2**20
        return cls(
            connections=Quota("connections", address=settings.address_connections, everybody=settings.connections),
            requests=RateLimit(settings.rate),
            address_requests=RateLimit(settings.rate * people),
            gets=RateLimit(gets),
            address_gets=RateLimit(gets * people),
            events=Quota("unfinished tasks", settings.events, near, 2 * max(near, settings.queue) + 64),
            reading=Quota("files being read", 1, 1, AT_ONCE),
            waiting=Quota("runs waiting", settings.waiting, settings.waiting * people, settings.queue),
            live=Quota("live streams", 1, max(1, settings.live // 2), settings.live),
            rooms=Rooms(settings.person_bytes, min(people * settings.person_bytes, ADDRESS_SHARE * total), total),
        )


# ---- how often ---------------------------------------------------------------------------------------


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


# ---- whose address -----------------------------------------------------------------------------------

PREFIX = 64
"""Bits of an IPv6 address that a provider gives to one subscriber at least; the rest they choose themselves."""


def network_of(address: str) -> str:
    """An IPv4 address as it is, the /64 network of an IPv6 address, and the IPv4 address within a mapped one.

    Loopback, and what is no address (a name in a test, a socket's path), stays as it is.
    """
    try:
        found = ipaddress.ip_address(address)
    except ValueError:
        return address
    if isinstance(found, ipaddress.IPv4Address) or found.is_loopback:
        return str(found)
    if found.ipv4_mapped is not None:
        return str(found.ipv4_mapped)
    host_bits = 128 - PREFIX
    return f"{ipaddress.IPv6Address(int(found) >> host_bits << host_bits)}/{PREFIX}"
