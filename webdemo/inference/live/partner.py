"""A partner who answers a stream of poses whose end is not known: one pose in, one pose out.

This module does not import torch: the server and the page use it before any network is loaded.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from motion.things import Thing
from motion.video.following import Gaze

Array = NDArray[np.floating]


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
