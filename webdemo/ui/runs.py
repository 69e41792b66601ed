"""The runs that are going on: one a session, its place in the line, and a way to stop it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Protocol

from webdemo.inference.run import CancelToken, Progress, Result


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


class HealthLike(Protocol):
    """Tries whether an engine works, for which its networks are loaded."""

    error: str
    """What went wrong last, in a few words; "" for nothing."""

    def probe(self) -> None:
        """Begins to try in a thread of its own, unless that goes on, has worked or has just failed."""
