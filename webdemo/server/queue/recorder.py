"""Runs that are written down: the queue, with the history beside it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import replace
from typing import Any

from motion import InputError
from webdemo.inference.requests.live import live_title
from webdemo.inference.run import Cancelled, Progress, Result
from webdemo.inference.story.beats import story_title
from webdemo.server.store.history import History
from webdemo.ui.visitor import visitor

from .queue import FairQueue


class Recorder:
    """Runs requests in a queue and keeps every one of them.

    Args:
        queue: runs them.
        history: keeps them.
    """

    def __init__(self, queue: FairQueue, history: History) -> None:
        self.queue, self.history = queue, history

    def cancel(self, session: str) -> bool:
        """Stops the session's run, waiting or running; False if it has none."""
        return self.queue.cancel(session)

    def run(self, session: str, request: Any) -> Iterator[Progress | Result]:
        """As :meth:`FairQueue.run`; the result comes when it is kept, or with a note that it could not be.

        Raises:
            InputError: as well where nothing can be written down.
        """
        who, asked = visitor(), request.to_dict()
        run = self.history.begin(who.owner, asked, title_of(asked), address=who.address) if who.owner else ""
        state, message = "refused", ""
        try:
            for event in self.queue.run(session, request):
                if isinstance(event, Result):
                    state, event = "done", self._kept(run, event)
                elif state == "refused":
                    state, message = "cancelled", "This run was cancelled."
                yield event
        except InputError as error:
            if state != "refused":
                state, message = "failed", str(error)
            raise
        except (Cancelled, GeneratorExit):
            raise
        except BaseException as error:
            state, message = "failed", f"Something went wrong inside the program ({type(error).__name__})."
            raise
        finally:
            if run and state != "done":
                self._end(run, who.owner, state, message)

    def _end(self, run: str, owner: str, state: str, message: str) -> None:
        if state == "refused":  # it never was in the line
            with suppress(InputError):
                self.history.delete(run, owner)
                return
        self.history.end(run, state, message)

    def _kept(self, run: str, result: Result) -> Result:
        if not run:
            return result
        result = replace(result, run=run)
        try:
            self.history.finish(run, result)
        except InputError as error:
            return replace(result, run="", notes=(*result.notes, str(error)))
        return result


def title_of(asked: Mapping[str, Any]) -> str:
    """Title of a run from its request's dictionary: its words, or the name of its input."""
    if asked.get("live"):
        return live_title(str(asked.get("model")))
    if words := str(asked.get("prompt", "")).strip():
        return words
    if beats := asked.get("beats"):
        return story_title(beats)
    given = asked.get("actor") or asked.get("motion") or {}
    return f"{'Reaction to' if 'actor' in asked else 'After'} {given.get('name') or 'a motion'}"
