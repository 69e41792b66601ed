"""The objects that every tab of the page shares."""

from __future__ import annotations

from dataclasses import dataclass

from webdemo.study import StudiesLike
from webdemo.ui.components.exports import Shelf

from .history import HistoryLike
from .runs import EngineLike, HealthLike, RunsLike


@dataclass(frozen=True, kw_only=True)
class PageContext:
    """The parts that tabs and API endpoints share.

    Attributes:
        engine: answers requests.
        runs: every session's run, and the line they wait in.
        health: loads the networks in the background and tries them.
        shelf: where files for downloads are put.
        history: runs that can be found again.
        studies: blind studies of those runs.
    """

    engine: EngineLike
    runs: RunsLike
    health: HealthLike
    shelf: Shelf
    history: HistoryLike
    studies: StudiesLike
