"""What the server keeps of every open page and of every program that calls it, so that it stays little."""

from __future__ import annotations

import re
from collections import deque
from typing import Any

from fastapi import FastAPI
from gradio.blocks import Blocks
from gradio.routes import App
from gradio.state_holder import SessionState, StateHolder
from starlette.routing import Mount

CALLS = 64
"""States kept of single calls of an endpoint; nobody comes back to one, and pages' are not to make room."""
_CALL = re.compile(r"[0-9a-f]{32}\Z")
"""How Gradio names the session of a call that belongs to none."""


class _Undescribed:
    """Blocks none of which is to be described."""

    def __init__(self, blocks: Blocks) -> None:
        self._all, self.blocks = blocks, ()

    def __getattr__(self, name: str) -> Any:
        return getattr(self._all, name)


class LeanState(SessionState):
    """What Gradio keeps of a page or program, without a description of every component as it is now.

    That description is for links to a page's state, which :class:`webdemo.server.guard.Guard` lets nobody
    make; it is nearly all that a session weighs, and most of the time that its first event takes.
    """

    def __init__(self, blocks: Blocks) -> None:
        super().__init__(_Undescribed(blocks))  # type: ignore[arg-type]  # it has all that is asked for

    def _update_config(self, key: int) -> None:
        pass

    def _update_value_in_config(self, key: int, value: Any) -> None:
        pass


class LeanStates(StateHolder):
    """The states of the last pages and programs: ``capacity`` of them, :data:`CALLS` of single calls."""

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
    """Files among Gradio's that belong to the page itself, not to what somebody does with it."""
    return {str(file) for block in page.blocks.values() for file in getattr(block, "keep_in_cache", ())}


def keep_states_lean(app: FastAPI, page: Blocks) -> None:
    """Gives the page that is mounted on an application :class:`LeanStates`."""
    for route in app.routes:
        if isinstance(route, Mount) and isinstance(route.app, App):
            route.app.state_holder = LeanStates()
            route.app.state_holder.set_blocks(page)
