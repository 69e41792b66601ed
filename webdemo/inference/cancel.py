"""Ending a run before its end: by its owner, or because it takes too long."""

from __future__ import annotations

import threading
from time import monotonic

from motion import InputError

from .results import Cancelled

LATE = "The run took longer than the {limit} that this lab allows: ask for fewer steps, samples or seconds."


class CancelToken:
    """Set by the owner of a run and checked by the sampling loop before every step.

    Stopping the consumer of a generator does not stop the running step, so the loop itself has to check.
    Safe to use from several threads.

    Args:
        seconds: how long the run may take from :meth:`start` on; 0 for any time.
        late: what a run that takes longer is told; ``{limit}`` stands for the time in words.
    """

    def __init__(self, seconds: float = 0.0, late: str = LATE) -> None:
        self._event = threading.Event()
        self._seconds, self._late = seconds, late
        self._until: float | None = None

    def start(self) -> CancelToken:
        """Lets the time of the run begin, which does not count what it waits before; gives the token itself."""
        if self._seconds:
            self._until = monotonic() + self._seconds
        return self

    def cancel(self) -> None:
        """Asks the run to stop; it stops within one step. May be called more than once."""
        self._event.set()

    @property
    def cancelled(self) -> bool:
        """True if the owner asked the run to stop."""
        return self._event.is_set()

    def is_set(self) -> bool:
        """True if the run shall stop: it was asked to, or its time is over."""
        return self.cancelled or self._late_now()

    def raise_if_cancelled(self) -> None:
        """Ends a run that shall stop.

        Raises:
            Cancelled: if it was asked to stop.
            InputError: one sentence, if its time is over.
        """
        if self.cancelled:
            raise Cancelled("The run was cancelled.")
        if self._late_now():
            raise InputError(self._late.format(limit=_in_words(self._seconds)))

    def _late_now(self) -> bool:
        return self._until is not None and monotonic() > self._until


def _in_words(seconds: float) -> str:
    minutes = seconds / 60
    return f"{minutes:g} minutes" if minutes > 1 and minutes.is_integer() else f"{seconds:g} seconds"
