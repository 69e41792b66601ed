"""What tabs and endpoints share, for tests that need no lab around them."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from unittest.mock import Mock

from webdemo.inference.run import CancelToken, Progress, Result
from webdemo.server.http.health import Health
from webdemo.ui.components.exports import Shelf
from webdemo.ui.context import PageContext
from webdemo.ui.history import Found
from webdemo.ui.runs import EngineLike


class StubRuns:
    """Runs requests at once; a session's can be cancelled."""

    def __init__(self, engine: EngineLike) -> None:
        self.engine = engine
        self._tokens: dict[str, CancelToken] = {}

    def cancel(self, session: str) -> bool:
        token = self._tokens.get(session)
        if token is not None:
            token.cancel()
        return token is not None

    def run(self, session: str, request: Any) -> Iterator[Progress | Result]:
        self._tokens[session] = token = CancelToken()
        try:
            yield from self.engine.run(request, cancel=token)
        finally:
            del self._tokens[session]


def stub_context(engine: EngineLike, files: Path | None = None) -> PageContext:
    """The parts of a page around an engine, whose files go to a folder, and which keeps nothing."""
    history, studies = Mock(), Mock()
    history.search.return_value = Found((), 0)
    studies.mine.return_value = history.pages.return_value = ()
    return PageContext(
        engine=engine,
        runs=StubRuns(engine),
        health=Health(engine),
        shelf=Shelf(files or Path(tempfile.mkdtemp())),
        history=history,
        studies=studies,
    )
