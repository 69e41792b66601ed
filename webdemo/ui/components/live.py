"""Live reactions: frames that go to the player as an actor plays, and the panel of a partner who answers at once."""

from __future__ import annotations

import base64
import binascii
import json
import uuid
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import TypeAdapter

from motion import FPS, SMPL22, Clip, InputError
from webdemo.inference.requests.live import LONGEST, LiveProgress, LiveTake
from webdemo.inference.run import Progress
from webdemo.ui.text.panels import status
from webdemo.view.payload import Payload, pack_positions, player_payload

from .accepts import Text
from .camera import CAMERA_FOLDER
from .part import STATIC, Part, on_load
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


LIVE_FOLDER = STATIC / "live"

_MOUNT = """
const addresses = { address: root + "/live", mediapipe: file(%s) + "/mediapipe/" };
const keep = (text) => { props.value = text; trigger("submit"); };
import(file(%s) + "/live.js").then((live) => live.mount(element, keep, addresses));
"""
FARTHEST = 100.0
"""Metres from the origin: nobody in front of a camera walks further."""
_BROKEN = "The live stream could not be kept, since its motion arrived damaged: press Keep again."


class LivePanel(Part):
    """Lets a partner answer live in the player of the same tab.

    A stream that is to be kept is sent as a text for :func:`take_of`; the event is ``submit``.

    Args:
        elem_id: id of the element in the page.
    """

    accepts = TypeAdapter(Text | None)
    template = LIVE_FOLDER / "live.html"
    script = on_load(_MOUNT, CAMERA_FOLDER, LIVE_FOLDER)
    sends = ("string", "a live stream, as the page packs it")


def take_of(text: str | None) -> LiveTake:
    """A live stream that somebody keeps, from what the panel sends; all of it may be hostile.

    The text is JSON with ``partner`` and ``positions``, base64 of little-endian float32 (2, T, 22, 3) in metres at
    30 fps.

    Raises:
        InputError: where it is damaged, too short or too long.
    """
    try:
        fields = json.loads(text or "")
        data = base64.b64decode(fields["positions"], validate=True)
        partner = str(fields["partner"])
    except (TypeError, ValueError, KeyError, RecursionError, binascii.Error):
        raise InputError(_BROKEN) from None
    frame = 2 * SMPL22.num_joints * 3 * 4
    if not data or len(data) % frame or len(data) > (LONGEST + 1) * FPS * frame:
        raise InputError(_BROKEN)
    people = np.frombuffer(data, "<f4").reshape(2, -1, SMPL22.num_joints, 3)
    if not (np.abs(people) < FARTHEST).all():  # nor for what is not a number
        raise InputError(_BROKEN)
    actor, reactor = (
        Clip(one.copy(), FPS, SMPL22, name=name) for one, name in zip(people, ("you", partner), strict=True)
    )
    return LiveTake(model=partner, actor=actor, reactor=reactor)
