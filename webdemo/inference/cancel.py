"""Cancelling a run."""

from __future__ import annotations

import threading

from .requests import Cancelled


class CancelToken:
    """Set by the owner of a run and checked by the sampling loop before every step.

    Stopping the consumer of a generator does not stop the running step, so the loop itself has to check.
    Safe to use from several threads.
    """

    def __init__(self) -> None:
        self._event = threading.Event()

    def cancel(self) -> None:
        """Asks the run to stop; it stops within one step. May be called more than once."""
        self._event.set()

    @property
    def cancelled(self) -> bool:
        """True if the run was asked to stop."""
        return self._event.is_set()

    def is_set(self) -> bool:
        """The same as :attr:`cancelled`, as :class:`threading.Event` names it."""
        return self._event.is_set()

    def raise_if_cancelled(self) -> None:
        """Raises :class:`~webdemo.inference.requests.Cancelled` if the run was asked to stop."""
        if self._event.is_set():
            raise Cancelled("The run was cancelled.")
