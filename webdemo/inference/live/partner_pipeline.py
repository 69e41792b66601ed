"""The online ReGenNet as a partner for a stream without an end.

ReGenNet was trained on scenes of some ten seconds, so a stream is generated in segments. A new segment begins with a
replay: the network is given the last frames of the person again, together with the partner's own pose at that time.
The replay runs beside the segment before, a few frames at a time; then the new segment takes over, and what differs
from the pose that is shown fades out. No frame depends on a later frame of the person.
"""

from __future__ import annotations

from collections import deque

import numpy as np
import torch
from torch import Tensor

from models.compiled import take_threads
from models.diffusion import sample_noise
from models.motion_tokens import FEATURES
from models.regennet.compact import CompactStream
from motion import FPS, SMPL22, Clip
from motion.steering import Goal, Steering
from motion.things import Thing
from motion.transforms import Placement, turn
from motion.vectors import FLAT, Array
from motion.video.following import Gaze
from webdemo.inference.finish.cleanup import FollowingCleanup
from webdemo.inference.pipelines.given import settle
from webdemo.inference.pipelines.regennet import ReGenNetPipeline
from webdemo.inference.requests import ReactRequest
from webdemo.inference.requests.live import Belief, LivePartner

SEGMENT = 600
"""Frames of a segment, its replay included: training saw streams of about 25 s."""
REPLAY = 45
"""Frames of the person that a new segment is given again: a gesture that has just been recognised began in them."""
CATCH_UP = 8
"""Frames of a replay that are generated with each frame that is shown."""
STEPS = 5
"""Denoising steps."""
NEAREST = 0.3
"""Metres between the two pelvises at least: by itself the network walks through a person who turns."""
PUSHED = 0.5
"""Metres: when the partner is kept off by more, a new segment begins at the place shown."""
FARTHEST = 6.0
"""Metres between the two beyond which the partner begins anew: training scenes are not wider."""


def warm_up(partner: LivePartner) -> None:
    """Has a partner answer a person who stands still for two seconds: the first passes take longest."""
    for _ in range(2 * int(FPS)):
        partner.step(SMPL22.standing())


class Segment:
    """A stream of ReGenNet with its place in the world.

    Args:
        pipeline: the loaded ReGenNet.
        condition: (1, C) the words.
        person: (22, 3) the person's first pose.
        begin: (22, 3) the partner's pose at that time; None where it is open.
        seed: of the noise.
    """

    def __init__(
        self, pipeline: ReGenNetPipeline, condition: Tensor, person: Array, begin: Array | None, seed: int
    ) -> None:
        model, scale = pipeline.model, ReactRequest.guidance
        self.condition = condition
        self._placement = Placement.of(Clip(np.asarray(person)[None], FPS, SMPL22), "a")
        own = None if begin is None else model.begin_row(self._given(begin))[None]
        self._stream = CompactStream(model, condition, steps=STEPS, scale=scale, max_frames=SEGMENT, begin=own)
        rows = model.num_rows(SEGMENT) + 1
        self._noise = iter(sample_noise(seed, 1, (rows, FEATURES)).transpose(0, 1))

    @property
    def left(self) -> int:
        """Frames until its end."""
        return self._stream.max_frames - self._stream.length

    def step(self, pose: Array) -> tuple[Array, Array]:
        """The network's next pose (22, 3) in the world, and the contact scores (4,) of the feet."""
        made, contacts = self._stream.step(self._given(pose), noise=self._noise)
        return self._placement.to_world(made[0].double().numpy()), contacts[0].numpy()

    def _given(self, pose: Array) -> Tensor:
        return torch.from_numpy(self._placement.to_network(np.asarray(pose))).float()


class ReactingPartner:
    """Reacts to one person with ReGenNet.

    Args:
        pipeline: the loaded ReGenNet.
        seed: of the noise.

    Attributes:
        goal: where the partner turns and goes by itself, beside what the network has it do; None for nowhere.
        gaze: see :class:`webdemo.inference.requests.live.LivePartner`; this partner reacts to bodies alone.
    """

    belief = Belief("follows", "")
    things: tuple[Thing, ...] = ()
    gaze: Gaze | None = None

    def __init__(self, pipeline: ReGenNetPipeline, *, seed: int = 0) -> None:
        self.pipeline, self.seed = pipeline, seed
        self.goal: Goal | None = None
        self._conditions: dict[str, Tensor] = {}
        self.take_words("")
        self._person: deque[Array] = deque(maxlen=REPLAY)
        self._shown: deque[Array] = deque(maxlen=REPLAY)
        self._segments = 0
        self._begin_anew()

    def _begin_anew(self) -> None:
        """Forgets what has happened."""
        self._person.clear()
        self._shown.clear()
        self._clean = FollowingCleanup()
        self._steering = Steering()
        self._now: Segment | None = None
        self._next: Segment | None = None
        self._replay: deque[Array] = deque()
        self._off, self._settled = np.zeros((22, 3)), 0

    def take_words(self, prompt: str) -> None:
        """Goes on with other words, as soon as their replay is done."""
        if prompt not in self._conditions:
            self._conditions[prompt] = self.pipeline.condition(prompt, 1)
        self.condition = self._conditions[prompt]

    def step(self, pose: Array) -> Array:
        """See :class:`webdemo.inference.requests.live.LivePartner`."""
        take_threads(plain_denoiser=False)  # a stream's messages come to any of several threads
        pose = np.asarray(pose, dtype=np.float64)
        if self._shown and np.linalg.norm((pose[0] - self._shown[-1][0]) * FLAT) > FARTHEST:
            self._begin_anew()
        if self._now is None:
            self._now = self._segment(pose, None)
        raw, contacts = self._now.step(pose)
        raw = raw + settle(self._off, np.array([self._settled]))[0, 0]
        self._settled += 1
        shown = self._steering(self._clean(raw, contacts), self.goal)
        kept_off = self._kept_off(shown, pose)
        shown = shown + kept_off
        self._person.append(pose)
        self._shown.append(shown)
        self._renew(pushed=float(np.linalg.norm(kept_off)) > PUSHED)
        return shown

    def _segment(self, person: Array, begin: Array | None) -> Segment:
        self._segments += 1
        return Segment(self.pipeline, self.condition, person, begin, self.seed + self._segments)

    def _renew(self, *, pushed: bool) -> None:
        """Begins the next segment where one is needed, and goes on with its replay."""
        assert self._now is not None  # the frame was made by it
        if self._next is not None and self._next.condition is not self.condition:
            self._next = None
        if self._next is not None:
            self._replay.append(self._person[-1])
        elif (
            self._now.condition is not self.condition or self._now.left <= REPLAY or (pushed and self._settled > REPLAY)
        ):
            self._next = self._segment(self._person[0], self._shown[0])
            self._replay = deque(self._person)
        if self._next is None:
            return
        for _ in range(min(CATCH_UP, len(self._replay))):
            raw, _ = self._next.step(self._replay.popleft())
        if not self._replay:
            shown = self._shown[-1]
            if not self._steering.idle:  # what it has turned and gone is no error of the new segment's pose
                self._steering.takes_over(raw, shown)
                raw, shown = raw - raw[0] * FLAT, turn(shown - shown[0] * FLAT, -self._steering.yaw)
            self._off, self._settled = shown - raw, 1
            self._now, self._next = self._next, None

    def _kept_off(self, raw: Array, pose: Array) -> Array:
        """(3,) by how much the partner is moved, so that they stay on their side of the person."""
        if not self._shown:
            return np.zeros(3)
        side = (self._shown[-1][0] - self._person[-1][0]) * FLAT
        length = float(np.linalg.norm(side))
        if length < 1e-3:
            return np.zeros(3)
        return max(0.0, NEAREST - float((raw[0] - pose[0]) @ side) / length) * side / length
