"""A live reaction on the page: its frames go to the player in small messages while the actor plays."""

from __future__ import annotations

import uuid
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from motion import Clip
from webdemo.inference.requests.live import LiveProgress
from webdemo.inference.run import Progress
from webdemo.ui.text.panels import status
from webdemo.view.payload import Payload, pack_positions, player_payload

from .player import show, stream
from .show import GIVEN

BATCH = 6
"""Frames a message: five messages a second."""
REPEATED = 30
"""Frames of the messages before that each one holds again, as a browser shows only the last of several."""


class LiveView:
    """Sees a live run's events and says what they change on the page.

    The player is first given the actor alone, in a payload that is marked ``live``, then messages with
    ``id`` (the payload's), ``start``, ``frames`` (packed, (1, F, 22, 3)) and ``text``; a message with
    ``stop`` ends it early.

    Args:
        actor: who plays.
        title: over the player.
    """

    def __init__(self, actor: Clip, title: str) -> None:
        self.id = f"live-{uuid.uuid4().hex}"
        self.actor, self.title = actor, title
        self.made: list[NDArray[np.floating]] = []
        self.delays: list[float] = []

    def __call__(self, event: Progress) -> dict[str, Any] | None:
        """Updates of player and line for a frame, none within a batch; None for any other event."""
        if not isinstance(event, LiveProgress):
            return None
        self.made.append(event.frame.positions[0])
        self.delays.append(event.frame.seconds)
        if event.step == 1:
            return {"player": show(self.payload())}
        if event.step % BATCH and event.step < event.total:
            return {}
        line = f"Streaming: {event.step / self.actor.fps:.1f} of {self.actor.seconds:.1f} s, {self.delay}"
        return {"player": stream(self.message()), "line": status(line, tone="busy")}

    @property
    def delay(self) -> str:
        """The delay from the actor's frame to the reactor's, in words."""
        return f"delay {1000 * float(np.median(self.delays)):.0f} ms, longest {1000 * max(self.delays):.0f} ms"

    def payload(self) -> Payload:
        """The motion that the player shows at first."""
        alone = player_payload(replace(self.actor, name=GIVEN), title=self.title)
        return {**alone, "id": self.id, "live": True}

    def message(self) -> dict[str, Any]:
        """The latest frames."""
        start = max(0, len(self.made) - BATCH - REPEATED)
        frames = pack_positions(np.stack(self.made[start:])[None])
        return {"id": self.id, "start": start, "frames": frames, "text": self.delay}

    def stopped(self) -> dict[str, Any]:
        """The update of a player whose run ended before the actor did."""
        return stream({"id": self.id, "stop": True})
