"""The runs that are going on: one a session, its place in the line, and a way to stop it."""

from __future__ import annotations

import logging
import threading
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Protocol

from acts import read
from motion import InputError
from webdemo.inference.run import CancelToken, Progress, Result

log = logging.getLogger(__name__)


class EngineLike(Protocol):
    """The interface of an engine as the page uses it."""

    @property
    def ready(self) -> bool:
        """True if the networks are loaded."""

    def warm_up(self) -> None:
        """Loads the networks; returns when they are ready."""

    def run(self, request: Any, cancel: CancelToken | None = None) -> Iterator[Progress | Result]:
        """Progress, then one result; raises ``Cancelled`` within one step of a cancellation."""


@dataclass(frozen=True, kw_only=True)
class Waiting(Progress):
    """A run in a line whose places are known: ``step`` is its place from 1, ``total`` how many wait.

    Attributes:
        seconds_left: an estimate of the time until it starts; None if there is none.
    """

    seconds_left: float | None = None


class RunsLike(Protocol):
    """The interface with which tabs and endpoints run a request; an earlier run of the session is cancelled.

    Closing the iterator cancels the run.
    """

    def cancel(self, session: str) -> bool:
        """Stops the session's run within one step; False where it has none."""

    def run(self, session: str, request: Any) -> Iterator[Progress | Result]:
        """Runs a request: its progress, with the stage "queue" while it waits, then its result.

        Raises:
            InputError: for what the engine cannot do.
            Cancelled: where the run was cancelled.
        """


class Loader:
    """Loads an engine's networks and the parser of sentences in a thread of its own, once, and reports the outcome."""

    def __init__(self, engine: EngineLike) -> None:
        self.engine = engine
        self._lock = threading.Lock()
        self._thread: threading.Thread | None = None
        self._reads = False
        self.error: str | None = None

    def start(self) -> None:
        """Begins to load where nothing has begun yet; a load that failed is tried again."""
        with self._lock:
            if (self.engine.ready and self._reads) or (self._thread is not None and self._thread.is_alive()):
                return
            self.error = None
            self._thread = threading.Thread(target=self._load, name="warm-up", daemon=True)
            self._thread.start()

    @property
    def state(self) -> str:
        """ "ready", "failed" or "loading"."""
        if self.engine.ready:
            return "ready"
        return "failed" if self.error else "loading"

    def _load(self) -> None:
        if not self.engine.ready:
            self._load_networks()
        if not self._reads:
            self._reads = True
            try:  # so that the first sentence that somebody types is read as fast as later ones
                read("They wave.")
            except InputError as error:  # the page says so under what is typed
                log.warning("Sentences cannot be read: %s", error)

    def _load_networks(self) -> None:
        try:
            self.engine.warm_up()
        except ValueError as error:  # InputError: a sentence for the user
            self.error = str(error)
        except Exception as error:
            log.exception("Loading the model failed.")
            self.error = f"The model could not be loaded ({type(error).__name__}): see the server's log."
