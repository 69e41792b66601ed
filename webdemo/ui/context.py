"""What every tab of the page is given."""

from __future__ import annotations

from dataclasses import dataclass

from .exports import Shelf
from .runs import EngineLike, Loader, Runs


@dataclass(frozen=True, kw_only=True)
class PageContext:
    """The parts that tabs and API endpoints share.

    Attributes:
        engine: answers requests.
        runs: every session's run, and the line they wait in.
        loader: loads the networks in the background.
        shelf: where files for downloads are put.
    """

    engine: EngineLike
    runs: Runs
    loader: Loader
    shelf: Shelf
