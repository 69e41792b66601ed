"""An engine as the page and the server use it, and the progress of a run that waits."""

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
