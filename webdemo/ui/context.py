"""The objects that every tab of the page shares."""

from __future__ import annotations

from dataclasses import dataclass

from webdemo.study import StudiesLike
from webdemo.ui.components.exports import Shelf

from .history import HistoryLike, SharingLike
from .runs import EngineLike, Loader, RunsLike


@dataclass(frozen=True, kw_only=True)
class PageContext:
    """The parts that tabs and API endpoints share.

    Attributes:
        engine: answers requests.
        runs: every session's run, and the line they wait in.
        loader: loads the networks in the background.
        shelf: where files for downloads are put.
        history: runs that can be found again; None where nothing is kept.
        studies: blind studies of those runs; None where nothing is kept.
        sharing: public pages of those runs; None where nothing is kept.
    """

    engine: EngineLike
    runs: RunsLike
    loader: Loader
    shelf: Shelf
    history: HistoryLike | None = None
    studies: StudiesLike | None = None
    sharing: SharingLike | None = None
