"""Accounts with salted hashes of their passwords, and sign-ins that end."""

from __future__ import annotations

import hashlib
import hmac
import math
import re
import secrets
import threading
import time
from collections.abc import Callable

from sqlalchemy import delete, select
from sqlalchemy.dialects.sqlite import insert

from motion import InputError
from webdemo.server.accounts.quotas import Buckets
from webdemo.server.audit import audit
from webdemo.server.http.routes import Refused
from webdemo.server.store.database import Account, Database, SignIn, locked

NAME = re.compile(r"\A[a-z0-9][a-z0-9._-]{0,39}\Z")
SHORTEST = 8
"""Characters of a password at least."""
LONGEST = 256
SUSPENDED = "This account is suspended: ask the person who runs this server."
COST = 2**14
"""scrypt's n for new passwords: 16 MB and about 50 ms a try. Each hash says its own, so this may change."""
ADMIN = "admin"


class Accounts:
    """Accounts and their sign-ins. Of a sign-in only the hash of its cookie is stored.

    Args:
        database: stores them, so a restart signs nobody out.
        hours: lifetime of a sign-in.
    """

    def __init__(self, database: Database, hours: float = 24.0) -> None:
        self.database, self.seconds = database, hours * 3600
        self._throttle, self._lock = Throttle(), threading.Lock()
        self._nobody = _hashed("nobody")

    @property
    def empty(self) -> bool:
        """True if there are none."""
        with self.database.session() as session:
            return session.scalar(select(Account).limit(1)) is None

    def of(self, name: str) -> Account | None:
        """A person's account."""
        with self.database.session() as session:
            return session.get(Account, name)

    def add(self, name: str, password: str) -> bool:
        """Adds a person, or changes their password, which signs them out; whether they had none before.

        Raises:
            InputError: for a name or a password that no account can have.
        """
        if not NAME.match(name):
            raise InputError(f"{name!r:.60} is not a valid account name: use up to 40 of a-z, 0-9, '.', '_' and '-'.")
        if not SHORTEST <= len(password) <= LONGEST:
            raise InputError(f"The password must have {SHORTEST} to {LONGEST} characters.")
        hashed = _hashed(password)
        self.arrive(name)
        with self.database.session.begin() as session:
            locked(session)
            account = session.get_one(Account, name)
            new, account.password = not account.password, hashed
            session.execute(delete(SignIn).where(SignIn.person == name))
        return new

    def arrive(self, name: str) -> Account:
        """The account of a person who signs in elsewhere, made when they first come."""
        if (account := self.of(name)) is None:
            values = {"name": name, "key": f"{name}#{secrets.token_hex(4)}"}
            with self.database.session.begin() as session:
                session.execute(insert(Account).values(**values).on_conflict_do_nothing())
                account = session.get_one(Account, name)
        return account

    def admit(self, name: str, address: str, known: str = "") -> tuple[str, str, str]:
        """Takes one of the tries that a name and an address have, before the password is looked at; :meth:`begin` gives
        it back.

        Args:
            name: of the account.
            address: where the try comes from.
            known: what :meth:`known_browser` gave this browser, if it did.

        Raises:
            Refused: after too many wrong passwords.
        """
        counted = name, address, self._browser(name, known)
        with self._lock:
            wait = self._throttle.take(*counted)
        if wait:
            self._note(name, ok=False, reason="too many tries")
            raise Refused(429, f"Too many wrong passwords: try again in {math.ceil(wait)} seconds.", "tries")
        return counted

    def begin(self, admitted: tuple[str, str, str], password: str) -> str | None:
        """A new sign-in's token, or None if name and password do not match.

        Args:
            admitted: by :meth:`admit`.
            password: to be checked.

        Raises:
            Refused: if an administrator has suspended the account.
        """
        name, _, _ = admitted
        account = self.of(name)
        stored = account.password if account else ""
        fits = _fits(password, stored or self._nobody)  # as long for a name that is not there
        if account is None or not stored or not fits:
            self._note(name, ok=False, reason="wrong name or password")
            return None
        with self._lock:
            self._throttle.take(*admitted, tries=-1)
        if account.suspended:
            self._note(name, ok=False, reason="suspended")
            raise Refused(403, SUSPENDED, "suspended")
        token, now = secrets.token_urlsafe(32), time.time()
        with self.database.session.begin() as session:
            locked(session)
            session.execute(delete(SignIn).where(SignIn.until < now))
            same = select(Account).where(Account.key == account.key, Account.password == stored)
            if session.scalar(same) is None:  # it was changed meanwhile
                return None
            session.add(SignIn(digest=_digest(token), person=name, until=now + self.seconds))
        self._note(name)
        return token

    def _note(self, name: str, *, ok: bool = True, reason: str | None = None) -> None:
        # A name that is none may be a password in the wrong field.
        audit("sign-in", ok=ok, person=name if self.of(name) else "(unknown)", how="password", reason=reason)

    def person(self, token: str) -> Account | None:
        """The person of a sign-in; None if it is unknown or has ended."""
        mine = (SignIn.digest == _digest(token), SignIn.until > time.time(), ~Account.suspended)
        with self.database.session() as session:
            return session.scalar(select(Account).join(SignIn).where(*mine))

    def end(self, token: str) -> None:
        """Signs somebody out."""
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
        account = self.of(name)
        if account is None or not account.password:
            return ""
        return hmac.new(account.password.encode(), browser.encode(), "sha256").hexdigest()


def _digest(token: str) -> str:
    return hashlib.sha256(token.encode()).hexdigest()


def _hashed(password: str) -> str:
    """scrypt's n, the salt and the hash of a password."""
    salt = secrets.token_bytes(16)
    return f"{COST}:{salt.hex()}:{_scrypt(password, COST, salt).hex()}"


def _fits(password: str, stored: str) -> bool:
    """True if it is the password of which a hash is stored."""
    cost, salt, digest = stored.split(":")
    return hmac.compare_digest(_scrypt(password[: LONGEST + 1], int(cost), bytes.fromhex(salt)).hex(), digest)


def _scrypt(password: str, cost: int, salt: bytes) -> bytes:
    given = password.encode(errors="replace")
    return hashlib.scrypt(given, salt=salt, n=cost, r=8, p=1, maxmem=2**20 + 1024 * cost, dklen=32)


# ---- wrong passwords --------------------------------------------------------------------------------


TRIES = 8
"""Wrong passwords at once for one name from one address, or from one browser that has signed in before."""
ADDRESS_TRIES = 40
"""Wrong passwords at once from one address, for all names."""
NAME_TRIES = 40
"""Wrong passwords at once for one name, from all addresses together."""
REFILL_SECONDS = 300.0
"""Time in which all these tries come back, evenly."""


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

    def take(self, name: str, address: str, browser: str = "", tries: int = 1) -> float:
        """Takes a try, before the password is looked at, so that many at once get no further than one by one.

        Args:
            name: of the account; it need not exist.
            address: where the try comes from.
            browser: id of a browser in which this name has signed in before; empty for others.
            tries: how many; -1 gives one back, since the password was right.

        Returns:
            the seconds to wait where there is none left, else 0.
        """
        taken = self._counted(name, address, browser)
        wait = max(buckets.wait(key, tries) for buckets, key in taken)
        if not wait:
            for buckets, key in taken:
                buckets.take(key, tries)
        return wait

    def _counted(self, name: str, address: str, browser: str) -> list[tuple[Buckets, str]]:
        name = name[:64]
        if browser:
            return [(self._pairs, f"{name} browser {browser}")]
        return [(self._pairs, f"{name} address {address}"), (self._addresses, address), (self._names, name)]
