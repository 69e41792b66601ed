"""What can be asked about the future of a motion, and what comes back; no torch here."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from webdemo.motion import SMPL22, Clip, Duet, InputError

from .actor import FPS, at_30_fps
from .requests import Result, _choice, _number

Array = NDArray[np.floating]

PREDICT_SECONDS = (0.5, 4.0)
PAST_SECONDS = 1.0
"""The least past that a prediction needs; no more of it is looked at."""
METHODS = {
    "motion-mlp": "Motion MLP",
    "mawgan": "PredictiveMA-WGAN",
    "still": "Zero velocity (the last pose, held)",
}
"""By name: what the page calls a method."""
LONGEST = 60.0
_MAX_STEP = 0.5
"""Metres from frame to frame; no joint of a person is that fast (15 m/s)."""


@dataclass(frozen=True, kw_only=True)
class PredictRequest:
    """One to four seconds of motion after a given past, of one person or two.

    Attributes:
        motion: on SMPL22's joints, at most a minute. What lies behind the marker is not looked at, but
            compared with the prediction.
        marker: second at which the past ends; the end of the motion by default.
        seconds: how much is predicted.
        model: one of :data:`METHODS`.
    """

    motion: Clip | Duet
    marker: float | None = None
    seconds: float = 2.0
    model: str = "motion-mlp"

    def __post_init__(self) -> None:
        set_ = object.__setattr__
        _choice("Model", self.model, tuple(METHODS))
        set_(self, "seconds", _number("Length", self.seconds, *PREDICT_SECONDS, " seconds"))
        set_(self, "motion", check_motion(self.motion))
        length = self.motion.seconds
        marker = length if self.marker is None else _number("Marker", self.marker, 0.0, 1e6, " seconds")
        if round(length * FPS) < round(PAST_SECONDS * FPS):
            raise InputError(
                f"The past is {length:.2f} s long, and {PAST_SECONDS:g} s or more is needed: "
                "give a longer motion."
            )
        if marker > length + 0.5 / FPS:
            raise InputError(f"The marker, {marker:g} s, lies behind the motion, which lasts {length:.2f} s.")
        if round(marker * FPS) < round(PAST_SECONDS * FPS):
            raise InputError(
                f"The past is {marker:.2f} s long, and {PAST_SECONDS:g} s or more is needed: "
                "move the marker to the right."
            )
        set_(self, "marker", min(marker, length))
        _check_steps(self.past, self.marker)

    @property
    def past_frames(self) -> int:
        """Frames before the marker."""
        return round((self.marker or 0.0) * FPS)

    @property
    def past(self) -> Clip | Duet:
        return self.motion.cut(0, self.past_frames)

    @property
    def truth(self) -> Clip | Duet | None:
        """What followed the marker, as far as it is predicted; None where nothing does."""
        stop = min(self.past_frames + round(self.seconds * FPS), self.motion.num_frames)
        return self.motion.cut(self.past_frames, stop) if stop > self.past_frames else None

    def to_dict(self) -> dict[str, Any]:
        """Everything but the motion, which is named by its SHA-256."""
        positions = np.ascontiguousarray(people_of(self.motion))
        motion = {
            "name": (self.motion.name if isinstance(self.motion, Clip) else self.motion.a.name)[:100],
            "people": len(positions),
            "frames": self.motion.num_frames,
            "fps": self.motion.fps,
            "sha256": hashlib.sha256(positions.tobytes()).hexdigest(),
        }
        return {
            "kind": "predict", "motion": motion, "marker": self.marker, "seconds": self.seconds,
            "model": self.model,
        }  # fmt: skip


def people_of(motion: Clip | Duet) -> Array:
    """(people, T, J, 3) metres of one person or two."""
    return motion.positions if isinstance(motion, Duet) else motion.positions[None]


def with_people(motion: Clip | Duet, positions: Array) -> Clip | Duet:
    """The same person or people with other positions (people, T, J, 3)."""
    if isinstance(motion, Duet):
        return replace(motion.with_positions(positions), manifest=None)
    return motion.with_positions(positions[0])


def check_motion(motion: Any) -> Clip | Duet:
    """A motion at 30 fps on SMPL22's joints; raises InputError for another, and for one that is too long."""
    if not isinstance(motion, Clip | Duet):
        raise InputError("Give the motion of one person or of two to predict from.")
    if motion.skeleton.joint_names != SMPL22.joint_names:
        raise InputError(
            f"The motion has the joints of {motion.skeleton.name}, not SMPL's 22: bring it onto them "
            "with webdemo.motion.retarget.to_smpl."
        )
    if motion.seconds > LONGEST:
        raise InputError(f"The motion lasts {motion.seconds:.0f} s: cut it to {LONGEST:g} s or less.")
    if isinstance(motion, Duet):
        return replace(motion, a=at_30_fps(motion.a), b=at_30_fps(motion.b))
    return at_30_fps(motion)


def _check_steps(past: Clip | Duet, marker: float) -> None:
    """Raises InputError where a joint teleports in the part of the past that is looked at."""
    seen = people_of(past)[:, -round(PAST_SECONDS * FPS) :]
    steps = np.linalg.norm(np.diff(seen, axis=1), axis=-1)
    if steps.max() <= _MAX_STEP:
        return
    person, frame, joint = np.unravel_index(int(steps.argmax()), steps.shape)
    second = marker - (seen.shape[1] - 1 - int(frame)) / FPS
    who = f" of person {'AB'[person]}" if len(seen) > 1 else ""
    raise InputError(
        f"The {SMPL22.joint_names[joint].replace('_', ' ')}{who} jumps {steps.max():.1f} m from one frame to "
        f"the next at {second:.2f} s: repair the motion, or move the marker a second away from there."
    )


@dataclass(frozen=True, kw_only=True)
class PredictResult(Result):
    """A prediction: the one entry of ``duets`` is the past and what is predicted, of one person or two.

    Attributes:
        past_frames: the first predicted frame.
        truth: what really followed, as far as the motion goes on.
        error: (frames of truth,) mean distance of joints from the truth, in millimetres (MPJPE).
        speed: (predicted frames,) mean distance per joint and frame, in millimetres (MPJS, eq. 2.13 of
            Chopin's thesis).
        true_speed: (frames of truth,) the same of what really followed.
    """

    past_frames: int
    truth: Clip | Duet | None = None
    error: tuple[float, ...] = ()
    speed: tuple[float, ...] = ()
    true_speed: tuple[float, ...] = ()

    @property
    def given(self) -> Clip | Duet:
        """The motion that was asked about: the past, and what really followed as far as it was compared."""
        motion = self.duets[0].cut(0, self.past_frames)
        if self.truth is None:
            return motion
        return with_people(motion, np.concatenate([people_of(motion), people_of(self.truth)], axis=1))
