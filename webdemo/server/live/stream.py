"""One live stream: a person's poses at the pace at which they come, and the partner's at 30 frames a second."""

from __future__ import annotations

import asyncio
import base64
import binascii
import json
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import scipy  # its parts are loaded with their first use

from motion import FPS, SMPL22, InputError
from motion.things import Thing
from motion.vectors import Array
from motion.video import Landmarks
from motion.video.following import FollowedPerson
from motion.video.landmarks import landmarks_of
from webdemo.inference.requests.live import Belief, LivePartner
from webdemo.view.payload import pack_positions
from webdemo.view.things import thing_payload

LONGEST_GAP = 1.0
"""Seconds without a pose over which the person's motion is interpolated; a longer pause is left out."""
MOST_FRAMES = 120
"""Frames after which the rest of a message is left out: a partner who is seconds late answers nothing."""
AHEAD = MOST_FRAMES
"""Frames that a stream may get beyond those of the time that has passed: nobody moves faster than the clock."""
LOST = 1.0
"""Seconds without anybody in the picture after which the page says so."""


class StreamEnded(InputError):
    """A live stream has ended."""


class Resampled:
    """Poses at uneven times → poses at 30 fps, between the last two that have come."""

    def __init__(self) -> None:
        self._time = 0.0
        self._pose: Array = np.zeros((0, 3))
        self._next = 0.0

    def add(self, time: float, pose: Array) -> Iterator[Array]:
        """The poses at 30 fps up to a time; none for a time that does not come after the last one."""
        if not len(self._pose) or time - self._time > LONGEST_GAP:
            self._time, self._pose, self._next = time, pose, time + 1 / FPS
            yield pose
            return
        if time <= self._time:
            return
        while self._next <= time + 1e-6:
            share = (self._next - self._time) / (time - self._time)
            yield self._pose + min(share, 1.0) * (pose - self._pose)
            self._next += 1 / FPS
        self._time, self._pose = time, pose


@dataclass(eq=False)
class LiveStream:
    """A person and the partner who answers them.

    Attributes:
        id: unguessable.
        person: whose it is.
        address: where they come from, where that limits them.
        partner: answers.
        clock: gives the time; seconds.
        frames: that were answered.
        spent: seconds of computing, for all frames together.
        ended: why there is no more, for the page; empty while it runs.
        one: is held by the message that is answered; others wait for it.
        newest: stands for the last message that came.
    """

    id: str
    person: str
    address: str
    partner: LivePartner
    clock: Callable[[], float] = time.monotonic
    frames: int = 0
    spent: float = 0.0
    ended: str = ""
    one: asyncio.Lock = field(default_factory=asyncio.Lock)
    newest: object = None

    def __post_init__(self) -> None:
        self._camera = FollowedPerson()
        self._even = Resampled()
        self._shown_things: tuple[Thing, ...] = ()
        self.began = self.heard = self.found = self.clock()

    @property
    def milliseconds(self) -> float:
        """Mean time of computing a frame."""
        return 1000 * self.spent / self.frames if self.frames else 0.0

    def answer(self, body: bytes) -> Iterator[dict[str, Any] | None]:
        """Computes the answer to a message: None after each frame, at last both people's new ones and what is said.

        Raises:
            StreamEnded: if the stream has ended, also between two steps.
            InputError: for a message that cannot be read.
        """
        frames: list[Array] = []
        spent, made = 0.0, self._frames(read_message(body))
        while True:
            if self.ended:
                raise StreamEnded(self.ended)
            if self.frames + len(frames) >= AHEAD + FPS * (self.clock() - self.began):
                break
            self.heard = began = self.clock()
            frame = next(made, None)
            spent += self.clock() - began
            if frame is None:
                break
            frames.append(frame)
            yield None
        self.heard = self.clock()
        self.spent += spent
        self.frames += len(frames)
        yield {
            "frames": pack_positions(np.stack(frames, axis=1)) if frames else None,
            **(self._things() if frames else {}),
            "belief": _plain(self.partner.belief),
            "hint": self._hint(),
        }

    def _things(self) -> dict[str, Any]:
        """The partner's things: whole at first, and later the pose of each that has moved since, by its number."""
        now = self.partner.things
        before, self._shown_things = self._shown_things, now
        if not before:
            return {"things": [thing_payload(thing) for thing in now]} if now else {}
        pairs = enumerate(zip(before, now, strict=True))
        moved = [
            i
            for i, (old, new) in pairs
            if not (np.array_equal(old.places, new.places) and np.array_equal(old.rotations, new.rotations))
        ]
        return {"moved": [[i, *_pose(now[i])] for i in moved]} if moved else {}

    def _frames(self, content: Landmarks | Poses | None) -> Iterator[Array]:
        """(2, 22, 3) the person and the partner, for each frame at 30 fps that a message completes."""
        made = 0
        for time_, pose in self._poses(content):
            for given in self._even.add(time_, pose):
                yield np.stack([given, self.partner.step(given)])
                made += 1
            if made >= MOST_FRAMES:
                return

    def _poses(self, content: Landmarks | Poses | None) -> Iterator[tuple[float, Array]]:
        if content is None:
            return
        if isinstance(content, Poses):
            yield from zip(content.times.tolist(), content.positions, strict=True)
            self.found = self.clock()
            return
        for picture, time_ in enumerate(content.times):
            pose = self._camera.add(content, picture)
            self.partner.gaze = self._camera.gaze
            if (content.frames == picture).any():
                self.found = self.clock()
            if pose is not None:
                yield float(time_), pose

    def _hint(self) -> str:
        """Advice for the person in front of the camera; empty where all is well."""
        if self.clock() - self.found > LOST:
            return "Nobody is seen: step into the picture, from head to feet."
        return self._camera.hint


def _pose(thing: Thing) -> list[float]:
    """The place and the rotation, as x, y, z, w, of a thing that has one frame."""
    turn = scipy.spatial.transform.Rotation.from_matrix(thing.rotations[0].astype(np.float64)).as_quat()
    return [round(float(value), 4) for value in (*thing.places[0], *turn)]


def _plain(belief: Belief) -> dict[str, Any]:
    chances = [[label, round(chance, 3)] for label, chance in belief.chances]
    return {"state": belief.state, "text": belief.text, "chances": chances}


# ---- messages ------------------------------------------------------------------------------------
# What a page sends: the landmarks of a few pictures, or poses. All of it may be hostile.


MOST_BYTES = 100_000
"""Of a message: a picture with one person takes 900."""
MOST_PICTURES = 32
"""Pictures or poses in a message."""
MOST_SECONDS = 86_400.0
"""Of a stream's own clock."""
FARTHEST = 50.0
"""Metres from the origin."""
_BROKEN = "The live stream sent something that cannot be read: reload the page and start again."


@dataclass(frozen=True)
class Poses:
    """Poses of a person whose body is known, such as those of a recorded clip.

    Attributes:
        times: (F,) seconds since the stream began, increasing.
        positions: (F, 22, 3) metres, Y up, floor at 0.
    """

    times: Array
    positions: Array


def read_message(body: bytes) -> Landmarks | Poses | None:
    """What a request's body brings; None where it only says that somebody is there.

    Raises:
        InputError: where it is not what the page sends.
    """
    fields = read_fields(body)
    if "landmarks" in fields:
        landmarks = landmarks_of(fields)
        if len(landmarks.times) > MOST_PICTURES:
            raise InputError(_BROKEN)
        return landmarks
    return _poses(fields) if "poses" in fields else None


def read_fields(body: bytes) -> dict[str, Any]:
    """The JSON object in a request's body.

    Raises:
        InputError: where it is too long or not one.
    """
    if len(body) > MOST_BYTES:
        raise InputError(_BROKEN)
    try:
        fields = json.loads(body or b"{}")
    except (ValueError, RecursionError):
        raise InputError(_BROKEN) from None
    if not isinstance(fields, dict):
        raise InputError(_BROKEN)
    return fields


def _poses(fields: dict[str, Any]) -> Poses:
    """Poses as whole millimetres: base64 of little-endian int16, (F, 22, 3)."""
    times = fields.get("times")
    if not isinstance(times, list) or not 1 <= len(times) <= MOST_PICTURES:
        raise InputError(_BROKEN)
    if not all(type(t) in (int, float) and 0 <= t <= MOST_SECONDS for t in times):
        raise InputError(_BROKEN)
    try:
        data = base64.b64decode(fields["poses"], validate=True)
    except (TypeError, ValueError, binascii.Error):
        raise InputError(_BROKEN) from None
    if len(data) != 2 * 3 * SMPL22.num_joints * len(times) or (np.diff(times) <= 0).any():
        raise InputError(_BROKEN)
    positions = np.frombuffer(data, "<i2").reshape(len(times), SMPL22.num_joints, 3) / 1000.0
    if np.abs(positions).max() > FARTHEST:
        raise InputError(_BROKEN)
    return Poses(np.asarray(times, dtype=np.float64), positions)
