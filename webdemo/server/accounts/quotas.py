"""What a person may use, in one place: connections, requests, events, runs, live streams and megabytes.

:class:`Quotas` has all of them, made from the settings. What is held at a time is compared with a :class:`Quota`,
and what comes again and again with a :class:`RateLimit`. A person without an account is a cookie, which they could
throw away, so everybody of one address together has a limit as well.
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

    Where it gets scarce, nobody may have more than is left, so that a person who has little finds some, however many
    take all they can: the dynamic thresholds by which switches share their buffers (Choudhury and Hahne 1998).

    Attributes:
        what: its name in sentences, in the plural.
        person: of one person.
        address: of all people of one address, where they have no accounts.
        everybody: of all people together.
    """

    what: str
    person: float = math.inf
    address: float = math.inf
    everybody: float = math.inf

    def left(self, held: int) -> float:
        """The most that one may have where everybody has ``held``: what is left, or one."""
        return max(self.everybody - held, 1.0)

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
        left = self.left(len(holders))
        for whose, count, most, sentence in (
            ("person", mine, self.person, "You already have {} {}: wait for one or cancel it, then try again."),
            ("address", near, self.address, "People from your network have {} {} already: try again in a few minutes."),
            ("everybody", len(holders), self.everybody, "There are {} {} here already: try again in a few minutes."),
        ):
            if count >= (most if whose == "everybody" else min(most, left)):
                raise OverQuota(whose, sentence.format(count, self.what))


class Quotas:
    """Everything that is limited for a person, by a server's settings.

    Attributes:
        connections: open ones.
        requests, address_requests: a minute, of those that change something, for a person and for an address.
        gets, address_gets: a minute, of the others.
        events: unfinished events of the page: runs, films, files that are read.
        large: requests of a size that many of them together would fill the memory.
        sign_ins: of strangers, which wait for their passwords to be checked.
        watched: streams that say how much of an upload has come, which look twenty times a second.
        waiting: runs in the queue.
        live: live streams.
        room: bytes that are stored. A person's is for runs, studies, uploads and downloads, that of an address and of
            everybody for runs and studies.
    """

    def __init__(self, settings: Settings) -> None:
        people = settings.address_people
        near, gets = settings.events * people, max(GETS, settings.rate)
        total, own = settings.keep_megabytes * 2**20, settings.person_bytes
        self.connections = Quota("connections", address=settings.address_connections, everybody=settings.connections)
        self.requests, self.address_requests = RateLimit(settings.rate), RateLimit(settings.rate * people)
        self.gets, self.address_gets = RateLimit(gets), RateLimit(gets * people)
        self.events = Quota("unfinished tasks", settings.events, near, 2 * max(near, settings.queue) + 64)
        self.large = Quota("large requests on their way", 4, 4 * people, 64)
        self.sign_ins = Quota("sign-ins on their way", 8, everybody=64)
        self.watched = Quota("uploads that are watched", 1, people, 64)
        self.waiting = Quota("runs waiting", settings.waiting, settings.waiting * people, settings.queue)
        self.live = Quota("live streams", 1, max(1, settings.live // 2), settings.live)
        self.room = Quota("bytes", own, min(people * own, ADDRESS_SHARE * total), total)


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


class RateLimit(Buckets):
    """Requests of each person: so many a minute, and as many at once.

    The package ``limits`` has no request that weighs more than a full bucket, as a large upload does.

    Args:
        a_minute: how many.
        clock: gives the time; seconds.
    """

    def __init__(self, a_minute: int, clock: Callable[[], float] = time.monotonic) -> None:
        super().__init__(a_minute, 60.0, clock)

    def take(self, key: str, tokens: float = 1.0) -> None:
        """Takes a request, or one as heavy as several; raises Refused if less is left than that, or a full bucket."""
        if self.wait(key, min(tokens, self.size)):
            raise Refused(429, "Too many requests in one minute: wait a little.", "rate")
        super().take(key, tokens)


# ---- whose address -----------------------------------------------------------------------------------

PREFIX = 64
"""Bits of an IPv6 address that a provider gives to one subscriber at least; the rest they choose themselves."""


def network_of(address: str) -> str:
    """An IPv4 address as it is, the /64 network of an IPv6 address, and the IPv4 address within a mapped one.

    Loopback, and what is no address (a name in a test, a socket's path), stays as it is.
    """
    try:
        ip = ipaddress.ip_address(address)
    except ValueError:
        return address
    if isinstance(ip, ipaddress.IPv4Address) or ip.is_loopback:
        return str(ip)
    if ip.ipv4_mapped is not None:
        return str(ip.ipv4_mapped)
    return str(ipaddress.ip_network((ip, PREFIX), strict=False))
