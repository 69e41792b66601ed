"""The interface of the public pages as the lab's page uses it; the server keeps them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from .history import Opened


@dataclass(frozen=True, kw_only=True)
class PublicPage:
    """A page that shows results to anybody who knows its address.

    Attributes:
        key: of its address.
        title: above the results.
        created: seconds since 1970.
        until: when it ends, in seconds since 1970.
        runs: how many results it shows.
    """

    key: str
    title: str
    created: float
    until: float
    runs: int


class SharingLike(Protocol):
    """Public pages. Every method raises InputError with a sentence where it cannot."""

    days: float
    """For how many days a page lasts where nothing else is said; also the most."""

    def publish(
        self, owner: str, runs: Sequence[str], *, title: str = "", days: float | None = None
    ) -> PublicPage:
        """Makes a page of the owner's runs, in their order."""

    def pages(self, owner: str) -> Sequence[PublicPage]:
        """The owner's pages that have not ended, newest first."""

    def revoke(self, key: str, owner: str) -> None:
        """Ends a page of the owner's."""

    def results(self, owner: str, runs: Sequence[str]) -> Sequence[Opened]:
        """Finished runs of the owner's, all of them for none given, for a folder of pages."""
