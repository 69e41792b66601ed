"""Places for reading what people send: a large file takes seconds and 200 MB."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

from .visitor import visitor

AT_ONCE = 2
"""Files that are read at a time, of all people together; so many times the memory of one is what they take."""
FILMS = 2
"""Films and figures that are drawn at a time; nobody has more than half of these places, as
:mod:`webdemo.server.queue.events` gives them out."""
_REMEMBERED = 60.0
"""Seconds after which it is forgotten that somebody had a place."""


class Places:
    """One place a person, and for all of them few: whoever had none lately, or the longest ago, goes first.

    Strangers who can throw their cookies away count by their address.

    Args:
        at_once: how many there are.
    """

    def __init__(self, at_once: int = AT_ONCE) -> None:
        self.at_once = at_once
        self._change = threading.Condition()
        self._inside: set[str] = set()
        self._waiting: list[str] = []
        self._last: dict[str, float] = {}

    @contextmanager
    def place(self) -> Iterator[None]:
        """Waits for a place and holds it."""
        person = visitor().source
        with self._change:
            self._waiting.append(person)
            try:
                self._change.wait_for(lambda: self._next() == person)
                self._inside.add(person)
            finally:
                self._waiting.remove(person)
                self._change.notify_all()
        try:
            yield
        finally:
            with self._change:
                self._inside.discard(person)
                now = time.monotonic()
                self._last = {name: at for name, at in self._last.items() if now - at < _REMEMBERED} | {person: now}
                self._change.notify_all()

    def _next(self) -> str | None:
        """The person who takes the next place; None while there is none or nobody may."""
        if len(self._inside) >= self.at_once:
            return None
        able = [person for person in dict.fromkeys(self._waiting) if person not in self._inside]
        return min(able, key=lambda person: self._last.get(person, 0.0), default=None)


READING = Places()
