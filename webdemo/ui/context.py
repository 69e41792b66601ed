"""The objects that every tab of the page shares."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from webdemo.ui.components.exports import Shelf

from .runs import EngineLike

if TYPE_CHECKING:  # the server stands on the page, which knows its objects by their types alone
    from webdemo.server.http.health import Health
    from webdemo.server.queue.recorder import Recorder
    from webdemo.server.store.notebook import Notebook
    from webdemo.server.store.studies import Studies


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
    runs: Recorder
    health: Health
    shelf: Shelf
    history: Notebook
    studies: Studies
