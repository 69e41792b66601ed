"""Keeps the server's state of each open page and API client small."""

from __future__ import annotations

import re
from collections import deque
from typing import Any

from gradio.blocks import Blocks
from gradio.routes import App
from gradio.state_holder import SessionState, StateHolder

CALLS = 64
"""States kept of single API calls. No client returns to one, and they must not displace those of pages."""
_CALL = re.compile(r"\A[0-9a-f]{32}\Z")
"""Gradio's session name of a call outside any session."""


class _Undescribed:
    """Blocks that report no components, so none gets described."""

    def __init__(self, blocks: Blocks) -> None:
        self._all, self.blocks = blocks, ()

    def __getattr__(self, name: str) -> Any:
        return getattr(self._all, name)


class LeanState(SessionState):
    """Gradio's state of a page or client, without the current description of every component.

    Gradio needs that description for links to a page's state, which :class:`webdemo.server.http.guard.Guard` forbids.
    It makes up nearly all of a session's memory and most of the time of its first event.
    """

    def __init__(self, blocks: Blocks) -> None:
        super().__init__(_Undescribed(blocks))  # type: ignore[arg-type]  # it has all attributes that are read

    def _update_config(self, key: int) -> None:
        pass

    def _update_value_in_config(self, key: int, value: Any) -> None:
        pass


class LeanStates(StateHolder):
    """The most recent states: ``capacity`` of pages and clients, :data:`CALLS` of single calls."""

    def __init__(self) -> None:
        super().__init__()
        self._calls: deque[str] = deque()

    def __getitem__(self, session_id: str) -> SessionState:
        with self.lock:
            if session_id not in self.session_data:
                self.session_data[session_id] = LeanState(self.blocks)
                if _CALL.match(session_id):
                    self._calls.append(session_id)
                    if len(self._calls) > CALLS:
                        self._drop(self._calls.popleft())
        return super().__getitem__(session_id)

    def _drop(self, session_id: str) -> None:
        self.session_data.pop(session_id, None)
        self.time_last_used.pop(session_id, None)


def kept_in_cache(page: Blocks) -> set[str]:
    """Files in Gradio's cache that belong to the page itself, not to a visitor's events."""
    return {str(file) for block in page.blocks.values() for file in getattr(block, "keep_in_cache", ())}


def keep_states_lean(app: App, page: Blocks) -> None:
    """Gives the application of a page :class:`LeanStates`."""
    app.state_holder = LeanStates()
    app.state_holder.set_blocks(page)
