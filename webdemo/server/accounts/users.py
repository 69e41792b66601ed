"""Accounts: a file of names with salted hashes, and sign-ins that end.

What belongs to a person belongs to their key: their name and, after a ``#``, an id that the account got when it was
made. So nobody inherits from an earlier account of the same name.
"""

from __future__ import annotations

import base64
import hashlib
import hmac
import math
import os
import re
import secrets
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from sqlalchemy import delete

from motion import InputError
from motion.formats.files import write_text
from webdemo.server.accounts.quotas import Buckets
from webdemo.server.store.database import Database, SignIn

from .people import People

NAME = re.compile(r"\A[a-z0-9][a-z0-9._-]{0,39}\Z")
SHORTEST = 8
"""Characters of a password at least."""
LONGEST = 256
SUSPENDED = "This account is suspended: ask the person who runs this server."
COST = 2**14
"""scrypt's n for new passwords: 16 MB and about 50 ms a try. Each line says its own, so this may change."""
_COSTS = {2**power for power in range(4, 18)}
_HEADER = "# Accounts of Pas de Deux: name#id, then scrypt's n, salt and hash. `python -m webdemo user` edits it.\n"


class _Password(NamedTuple):
    """The stored form of a password: scrypt's n, its salt and its hash; and the account's key."""

    key: str
    cost: int
    salt: bytes
    digest: bytes

    @classmethod
    def of(cls, key: str, password: str) -> _Password:
        salt = secrets.token_bytes(16)
        return cls(key, COST, salt, _scrypt(password.encode(), COST, salt, 32))

    def fits(self, password: str) -> bool:
        """True if it is this password."""
        given = password[: LONGEST + 1].encode(errors="replace")
        return hmac.compare_digest(_scrypt(given, self.cost, self.salt, len(self.digest)), self.digest)


class Users:
    """The file of accounts, read anew when it changes.

    One line a person: ``name#id:n:salt:hash``, salt and hash in base64. A line made by hand may lack the id, and n,
    which is 2**14 then.

    Args:
        path: the file.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._read_at: tuple[int, int] | None = None
        self._known: dict[str, _Password] = {}
        self._lock = threading.Lock()
        self._hashing = threading.Semaphore(2)  # so that guesses cannot take all memory and cores
        self._nobody = _Password.of("", "nobody")

    @property
    def names(self) -> list[str]:
        """Everybody's name."""
        return sorted(self._entries())

    def add(self, name: str, password: str) -> bool:
        """Adds a person, or changes their password; whether they are new."""
        self.check(name, password)
        entries = self._entries() if self.path.exists() else {}
        new = name not in entries
        key = f"{name}#{secrets.token_hex(4)}" if new else entries[name].key
        self._write(entries | {name: _Password.of(key, password)})
        return new

    def check(self, name: str, password: str) -> None:
        """Raises InputError for a name or a password that no account can have."""
        if not NAME.match(name):
            raise InputError(f"{name!r:.60} is not a valid account name: use up to 40 of a-z, 0-9, '.', '_' and '-'.")
        if not SHORTEST <= len(password) <= LONGEST:
            raise InputError(f"The password must have {SHORTEST} to {LONGEST} characters.")

    def remove(self, name: str) -> None:
        """Removes a person; raises InputError if there is none of that name."""
        entries = self._entries()
        if name not in entries:
            raise InputError(f"There is no account {name!r:.60} in {self.path}: see `admin list`.")
        self._write({other: entry for other, entry in entries.items() if other != name})

    def knows(self, name: str, password: str) -> bool:
        """True if this is the person's password; takes as long for a name that is not there."""
        entries = self._entries()
        with self._hashing:
            fits = entries.get(name, self._nobody).fits(password)
        return fits and name in entries

    def key(self, name: str) -> str | None:
        """The key of a person, to whom their runs belong; None if there is no such account."""
        found = self._entries().get(name)
        return None if found is None else found.key

    def entry(self, name: str) -> str | None:
        """A fingerprint of a person's password, which changes with it; None if there is no such person."""
        found = self._entries().get(name)
        return None if found is None else hashlib.sha256(found.salt + found.digest).hexdigest()

    def _entries(self) -> dict[str, _Password]:
        try:
            status = self.path.stat()
            with self._lock:
                if self._read_at != (status.st_mtime_ns, status.st_size):
                    self._known = _parse(self.path.read_text(encoding="utf-8"))
                    self._read_at = (status.st_mtime_ns, status.st_size)
                return dict(self._known)
        except (OSError, ValueError) as error:
            reason = getattr(error, "strerror", None) or "it is damaged"
            raise InputError(
                f"The file of accounts {self.path} cannot be read ({reason}): "
                "make it with `python -m webdemo user add NAME`."
            ) from None

    def _write(self, entries: dict[str, _Password]) -> None:
        lines = [
            f"{known.key}:{known.cost}:{_base64(known.salt)}:{_base64(known.digest)}"
            for _, known in sorted(entries.items())
        ]
        write_text(self.path, _HEADER + "".join(f"{line}\n" for line in lines))
        os.chmod(self.path, 0o600)


def _scrypt(password: bytes, cost: int, salt: bytes, length: int) -> bytes:
    return hashlib.scrypt(password, salt=salt, n=cost, r=8, p=1, maxmem=2**20 + 1024 * cost, dklen=length)


def _base64(part: bytes) -> str:
    return base64.b64encode(part).decode()


def _parse(text: str) -> dict[str, _Password]:
    entries = {}
    for line in text.splitlines():
        if line.strip() and not line.startswith("#"):
            key, *costs, salt, digest = line.strip().split(":")
            (cost,) = costs or [str(2**14)]
            if int(cost) not in _COSTS:
                raise ValueError(cost)
            parts = (base64.b64decode(part, validate=True) for part in (salt, digest))
            entries[key.partition("#")[0]] = _Password(key, int(cost), *parts)
    return entries


class Suspended(InputError):
    """The account is suspended, and the password was right."""


class SignIns:
    """Sessions of signed-in people; only the hash of the cookie is stored.

    Args:
        database: stores them, so a restart signs nobody out.
        users: the accounts. A session ends when its account is removed or its password changed.
        hours: lifetime of a session.
    """

    def __init__(self, database: Database, users: Users, hours: float) -> None:
        self.database, self.users, self.seconds = database, users, hours * 3600
        self.people = People(database)
        self._throttle = Throttle()
        self._lock = threading.Lock()

    def begin(self, name: str, password: str, address: str, known: str = "") -> str | None:
        """A new session's token, or None if name and password do not match.

        Args:
            name: of the account.
            password: to be checked.
            address: where the try comes from.
            known: what :meth:`known_browser` gave this browser, if it did.

        Raises:
            TooManyTries: after too many wrong passwords.
            Suspended: if an administrator has suspended the account.
            InputError: if the accounts cannot be read.
        """
        entry = self.users.entry(name)  # read before the password is checked, which may change meanwhile
        counted = (name, address, self._browser(name, known))
        with self._lock:
            self._throttle.take(*counted)
        if not self.users.knows(name, password) or entry is None:
            return None
        with self._lock:
            self._throttle.give_back(*counted)
        key = self.users.key(name) or ""
        if self.people.of(key).suspended:
            raise Suspended(SUSPENDED)
        token, now = secrets.token_urlsafe(32), time.time()
        with self.database.session.begin() as session:
            session.execute(delete(SignIn).where(SignIn.until < now))
            session.add(SignIn(digest=_digest(token), person=key, entry=entry, until=now + self.seconds))
        return token

    def person(self, token: str) -> str | None:
        """The name of a session's owner; None if it is unknown, has expired, or belongs to an earlier password.

        Raises:
            InputError: if the accounts cannot be read.
        """
        if not 20 <= len(token) <= 100:
            return None
        with self.database.session() as session:
            found = session.get(SignIn, _digest(token))
        if found is None or found.until < time.time():
            return None
        name = found.person.partition("#")[0]
        same = self.users.key(name) == found.person and found.entry == self.users.entry(name)
        return name if same and not self.people.of(found.person).suspended else None

    def end(self, token: str) -> None:
        """Signs a session out."""
        with self.database.session.begin() as session:
            session.execute(delete(SignIn).where(SignIn.digest == _digest(token)))

    def known_browser(self, name: str) -> str:
        """A cookie for a browser in which somebody has signed in; worth nothing once the password is another."""
        browser = secrets.token_urlsafe(12)
        return f"{browser}.{self._signature(name, browser)}"

    def _browser(self, name: str, known: str) -> str:
        """The id in a :meth:`known_browser` of this name; empty if it is none."""
        browser, _, signature = known.partition(".")
        right = self._signature(name, browser)
        return browser if right and hmac.compare_digest(signature.encode(), right.encode()) else ""

    def _signature(self, name: str, browser: str) -> str:
        entry = self.users.entry(name)
        return "" if entry is None else hmac.new(entry.encode(), browser.encode(), "sha256").hexdigest()


def _digest(token: str) -> str:
    return hashlib.sha256(token.encode()).hexdigest()


# ---- wrong passwords --------------------------------------------------------------------------------


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
