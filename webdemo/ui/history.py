"""What the page shows of a history; :mod:`webdemo.server.store.notebook` keeps it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from motion import Clip
from webdemo.inference.run import Result


@dataclass(frozen=True, kw_only=True)
class Entry:
    """One run of a history.

    Attributes:
        id: by which its owner opens it.
        kind: "generate", "react", …: the tab that it came from.
        title: the name that its owner gave it, or the prompt, or what a reaction is to.
        state: "running", "done", "failed", "cancelled" or "interrupted".
        message: one sentence on what went wrong.
        created: seconds since 1970.
        request: what was asked, without motion.
        favourite: never removed for its age.
        links: how many links open it for others.
        tags: words that its owner put on it.
        note: what its owner wrote about it.
        thumbnail: as :func:`webdemo.view.thumbnail.thumbnail` makes it; "" where there is none.
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
    tags: tuple[str, ...] = ()
    note: str = ""
    thumbnail: str = field(default="", repr=False)


@dataclass(frozen=True, kw_only=True)
class Search:
    """A search in a history: runs that fit everything given.

    Attributes:
        words: each of them is in the title, note, tags or settings.
        kind: of the run; "" for all.
        model: name of its method; "" for all.
        tag: one of its tags; "" for all.
        starred: only those that are kept.
        limit: how many at most.
    """

    words: str = ""
    kind: str = ""
    model: str = ""
    tag: str = ""
    starred: bool = False
    limit: int = 60


@dataclass(frozen=True)
class Found:
    """The answer to a search.

    Attributes:
        entries: newest first, as many as were asked for.
        total: how many fit.
        tags: all tags of the owner's runs.
        models: all methods of the owner's runs.
    """

    entries: Sequence[Entry]
    total: int
    tags: Sequence[str] = ()
    models: Sequence[str] = ()


@dataclass(frozen=True, kw_only=True)
class Usage:
    """The room that a person uses, in bytes.

    Attributes:
        runs: that are no favourites.
        favourites: runs that are never removed on their own.
        studies: with their motions.
        temporary: uploads, films and other files for download, which are soon removed.
        allowed: of everything together.
        kept: of runs, favourites and studies together.
    """

    runs: float = 0
    favourites: float = 0
    studies: float = 0
    temporary: float = 0
    allowed: float
    kept: float

    @property
    def used(self) -> float:
        """Bytes of everything together."""
        return self.runs + self.favourites + self.studies + self.temporary


@dataclass(frozen=True, kw_only=True)
class Kept:
    """The settings of a tab when a run was made, beside its request.

    Attributes:
        controls: values of the tab's controls, by name.
        people: everybody in the file that was chosen.
        compared: ids of the runs that stood beside it.
    """

    controls: Mapping[str, Any] = field(default_factory=dict)
    people: tuple[Clip, ...] = field(default=(), repr=False)
    compared: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Opened:
    """A run that was opened, with its result.

    Attributes:
        entry: the run.
        result: of the run.
        kept: how its tab was set.
        beside: the runs that it was compared with, as far as they are still there.
    """

    entry: Entry
    result: Result = field(repr=False)
    kept: Kept = field(default_factory=Kept)
    beside: tuple[Opened, ...] = field(default=(), repr=False)


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
