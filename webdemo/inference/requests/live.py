"""A live stream that somebody keeps, and a partner in one.

This module does not import torch: the page uses it before any network is loaded.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Protocol

from motion import Clip, Duet, InputError
from motion.metrics import compare
from motion.things import Thing
from motion.vectors import Array
from motion.video.following import Gaze
from webdemo.inference.run import Progress, Result, StageTimer

from .actor import motion_facts

PARTNERS: Mapping[str, str] = {"regennet": "ReGenNet, online", "agent": "Virtual agent"}
"""Live partners by name, with their labels."""
LONGEST = 60.0
"""Seconds of a stream that can be kept."""
SHORTEST = 1.0
"""Seconds: with less there is nothing to measure."""


def check_partner(name: str) -> None:
    """Raises InputError for what is none of :data:`PARTNERS`."""
    if name not in PARTNERS:
        raise InputError(f"There is no live partner {name!r:.40}: choose {' or '.join(PARTNERS)}.")


@dataclass(frozen=True, kw_only=True)
class LiveTake:
    """A live stream that somebody keeps: both people's motion as it was shown. Nothing is generated again.

    Attributes:
        model: who answered, one of :data:`PARTNERS`.
        actor: the person, at 30 fps on SMPL22's joints.
        reactor: the partner, of the same length.

    Raises:
        InputError: for an unknown partner, or a stream that is too short or too long.
    """

    model: str
    actor: Clip
    reactor: Clip
    mode: ClassVar[str] = "online"
    prompt: ClassVar[str] = ""

    def __post_init__(self) -> None:
        check_partner(self.model)
        if self.actor.positions.shape != self.reactor.positions.shape:
            raise InputError("The two people of a live stream must have the same number of frames and joints.")
        if self.actor.num_frames < SHORTEST * self.actor.fps:
            raise InputError("This live stream is shorter than a second: let it go on for longer.")
        if self.actor.seconds > LONGEST + 1:
            raise InputError(f"Only the last {LONGEST:g} s of a live stream can be kept: send no more.")

    @property
    def title(self) -> str:
        """The name of the run in the history."""
        return live_title(self.model)

    def to_dict(self) -> dict[str, Any]:
        """All fields except the motion, which its SHA-256 represents."""
        actor = motion_facts(self.actor)
        return {"kind": "react", "live": True, "model": self.model, "mode": self.mode, "actor": actor}

    def results(self, timer: StageTimer) -> Iterator[Progress | Result]:
        """The two people with their read-outs."""
        yield timer.progress("finish")
        duet = Duet(self.actor, self.reactor, ("actor", "reactor"))
        yield Result(duets=(duet,), readouts=(compare(None, duet),))


def live_title(model: str) -> str:
    """The name of a kept live stream, by its partner."""
    return f"Live with {PARTNERS.get(model, model)}"


# ---- a partner who answers a stream of poses whose end is not known -----------------------------------
@dataclass(frozen=True)
class Belief:
    """A partner's view of the person at this moment.

    Attributes:
        state: "follows" for a partner who does not recognise anything; otherwise "watches", "answers",
            "ignored" or "left".
        text: a sentence about it.
        chances: the likeliest gestures with their probabilities, the likeliest first.
    """

    state: str
    text: str
    chances: tuple[tuple[str, float], ...] = ()


class LivePartner(Protocol):
    """Answers one person. Each pose is computed before the next one of the person is known.

    Attributes:
        gaze: where the person's face points now, set before a step; None where it is not known, as without a camera.
    """

    gaze: Gaze | None

    @property
    def things(self) -> tuple[Thing, ...]:
        """The things about the partner as they are now, each with a track of one frame, always in the same order."""

    @property
    def belief(self) -> Belief:
        """The partner's view of the person now."""

    def step(self, pose: Array) -> Array:
        """The partner's pose (22, 3) for the person's pose (22, 3), both in metres at 30 fps, floor at 0."""
