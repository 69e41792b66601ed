"""The interface of the public pages as the lab's page uses it; the server keeps them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol


@dataclass(frozen=True, kw_only=True)
class PublicPage:
    """A page that shows a result to anybody who knows its address.

    Attributes:
        key: of its address.
        title: of its result.
        created: seconds since 1970.
        until: when it ends, in seconds since 1970.
    """

    key: str
    title: str
    created: float
    until: float


class SharingLike(Protocol):
    """Public pages. Every method raises InputError with a sentence where it cannot."""

    days: float
    """For how many days a page lasts where nothing else is said; also the most."""

    def publish(self, owner: str, run: str, *, days: float | None = None) -> PublicPage:
        """Makes a page of one of the owner's runs."""

    def pages(self, owner: str) -> Sequence[PublicPage]:
        """The owner's pages that have not ended, newest first."""

    def revoke(self, key: str, owner: str) -> None:
        """Ends a page of the owner's."""
