"""The interface of a history as the page uses it; the server keeps one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

from webdemo.inference.requests import Result


@dataclass(frozen=True, kw_only=True)
class Entry:
    """One run of a history.

    Attributes:
        id: by which its owner opens it.
        kind: "generate", "react", …: the tab that it came from.
        title: the prompt, or what a reaction is to.
        state: "running", "done", "failed", "cancelled" or "interrupted".
        message: one sentence on what went wrong.
        created: seconds since 1970.
        request: what was asked, without motion.
        favourite: never removed for its age.
        links: how many links open it for others.
    """

    id: str
    kind: str
    title: str
    state: str
    message: str = ""
    created: float = 0.0
    request: dict[str, Any] = field(default_factory=dict)
    favourite: bool = False
    links: int = 0


@dataclass(frozen=True, kw_only=True)
class Opened:
    """A run that was opened, with its result."""

    entry: Entry
    result: Result = field(repr=False)


class HistoryLike(Protocol):
    """Runs that can be found again. Every method raises InputError with a sentence where it cannot."""

    def entries(self, owner: str) -> Sequence[Entry]:
        """The owner's runs, newest first."""

    def open(self, key: str, owner: str) -> Opened:
        """A run by its id, for its owner, or by a link, for anybody."""

    def favour(self, run: str, owner: str, *, favourite: bool) -> None:
        """Marks a run as one to keep, or no longer."""

    def remove(self, run: str, owner: str) -> None:
        """Deletes a run, its files and its links."""

    def link(self, run: str, owner: str) -> tuple[str, float]:
        """A new link to a run: its key, and when it ends (seconds since 1970)."""

    def revoke(self, run: str, owner: str) -> int:
        """Ends all links to a run; returns how many there were."""
