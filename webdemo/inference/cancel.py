"""How a run is told to stop."""

from __future__ import annotations

import threading

from .requests import Cancelled


class CancelToken:
    """Set by whoever owns a run, looked at by the sampling loop before every step.

    Stopping the consumer of a generator does not stop the step that is running, so the loop itself has to
    ask. Safe to use from several threads.
    """

    def __init__(self) -> None:
        self._event = threading.Event()

    def cancel(self) -> None:
        """Asks the run to stop; it does within one step. May be called more than once."""
        self._event.set()

    @property
    def cancelled(self) -> bool:
        return self._event.is_set()

    def is_set(self) -> bool:
        """The same as :attr:`cancelled`, as :class:`threading.Event` names it."""
        return self._event.is_set()

    def raise_if_cancelled(self) -> None:
        """Raises :class:`~webdemo.inference.requests.Cancelled` where the run was asked to stop."""
        if self._event.is_set():
            raise Cancelled("The run was cancelled.")
