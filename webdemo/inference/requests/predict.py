"""Requests and results of motion prediction. This module does not import torch."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from motion import FPS, SMPL22, Clip, Duet, InputError, stacked_positions
from motion.formats.files import check_smpl
from motion.vectors import Array
from webdemo.inference import methods
from webdemo.inference.run import Result

from .actor import at_30_fps, motion_facts
from .sampling import check_settings, number

PAST_SECONDS = 1.0
"""Seconds of past that a prediction needs; only the last so many are used."""
LONGEST = 60.0
_MAX_STEP = 0.5
"""Metres from frame to frame: faster (15 m/s) than any joint of a person."""


@dataclass(frozen=True, kw_only=True)
class PredictRequest:
    """One to four seconds of motion after a given past, of one person or two.

    Attributes:
        motion: on SMPL22's joints, at most a minute. Frames after the marker are not used for the prediction,
            only compared with it.
        marker: second at which the past ends; the end of the motion by default.
        seconds: length of the prediction.
        seed, samples: of a method that draws its futures, and how many it draws; others predict one.
        model: a method that predicts, see :mod:`webdemo.inference.methods`.
    """

    motion: Clip | Duet
    marker: float | None = None
    seconds: float = 2.0
    seed: int = 0
    samples: int = 3
    model: str = "motion-mlp"

    def __post_init__(self) -> None:
        set_ = object.__setattr__
        method = methods.method(self.model, "predict")
        set_(self, "seconds", number("Length", self.seconds, *method.seconds, " seconds"))
        check_settings(self)
        set_(self, "samples", self.samples if "two people" in method.takes else 1)
        set_(self, "motion", check_motion(self.motion))
        if "two people" in method.takes and not isinstance(self.motion, Duet):
            raise InputError(
                f"{method.label} continues two people, but this motion has only one: choose another method, or give "
                "both people."
            )
        length = self.motion.seconds
        marker = length if self.marker is None else number("Marker", self.marker, 0.0, 1e6, " seconds")
        if marker > length + 0.5 / FPS:
            raise InputError(f"The marker, {marker:g} s, is after the end of the motion, which lasts {length:.2f} s.")
        marker = min(marker, length)
        if round(marker * FPS) < round(PAST_SECONDS * FPS):
            short = round(length * FPS) < round(PAST_SECONDS * FPS)
            raise InputError(
                f"The past is {marker:.2f} s long, and {PAST_SECONDS:g} s or more is needed: "
                f"{'give a longer motion' if short else 'move the marker to the right'}."
            )
        set_(self, "marker", marker)
        _check_steps(self.past, marker)

    @property
    def past_frames(self) -> int:
        """Frames before the marker."""
        return round((self.marker or 0.0) * FPS)

    @property
    def past(self) -> Clip | Duet:
        """The motion before the marker."""
        return self.motion.cut(0, self.past_frames)

    @property
    def truth(self) -> Clip | Duet | None:
        """The motion after the marker, cut to the length of the prediction; None if there is none."""
        stop = min(self.past_frames + round(self.seconds * FPS), self.motion.num_frames)
        return self.motion.cut(self.past_frames, stop) if stop > self.past_frames else None

    def to_dict(self) -> dict[str, Any]:
        """Everything but the motion, which is named by its SHA-256."""
        people = len(self.motion.people)
        return {
            "kind": "predict",
            "motion": {**motion_facts(self.motion), "people": people},
            "marker": self.marker,
            "seconds": self.seconds,
            "seed": self.seed,
            "samples": self.samples,
            "model": self.model,
        }


def with_people(motion: Clip | Duet, positions: Array) -> Clip | Duet:
    """The same person or people with other positions (people, T, J, 3)."""
    if isinstance(motion, Duet):
        return replace(motion.with_positions(positions), manifest=None)
    return motion.with_positions(positions[0])


def check_motion(motion: Any, longest: float = LONGEST) -> Clip | Duet:
    """A motion at 30 fps on SMPL22's joints; raises InputError for another, and for one longer than ``longest``."""
    if not isinstance(motion, Clip | Duet):
        raise InputError("Give the motion of one person or of two to predict from.")
    check_smpl(motion, "A network")
    if motion.seconds > longest:
        raise InputError(f"The motion lasts {motion.seconds:.0f} s: cut it to {longest:g} s or less.")
    if isinstance(motion, Duet):
        return replace(motion, a=at_30_fps(motion.a), b=at_30_fps(motion.b))
    return at_30_fps(motion)


def _check_steps(past: Clip | Duet, marker: float) -> None:
    """Raises InputError if a joint jumps in the part of the past that is used."""
    seen = stacked_positions(past)[:, -round(PAST_SECONDS * FPS) :]
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
    """A prediction: ``duets`` holds the past and what follows it, once or as several futures, of one person or two.

    Attributes:
        past_frames: the first predicted frame.
        truth: the recorded continuation, as far as it exists.
        error: (frames of truth,) mean distance of joints from the truth, in millimetres (MPJPE), over all futures.
        speed: (predicted frames,) mean distance per joint and frame, in millimetres (MPJS, eq. 2.13 of
            Chopin's thesis), likewise.
        true_speed: (frames of truth,) the same for the recorded continuation.
    """

    past_frames: int
    truth: Clip | Duet | None = None
    error: tuple[float, ...] = ()
    speed: tuple[float, ...] = ()
    true_speed: tuple[float, ...] = ()

    @property
    def given(self) -> Clip | Duet:
        """The input motion: the past, and the recorded continuation that was compared."""
        motion = self.duets[0].cut(0, self.past_frames)
        if self.truth is None:
            return motion
        return with_people(motion, np.concatenate([stacked_positions(motion), stacked_positions(self.truth)], axis=1))


def mean_step(before: Array, after: Array) -> Array:
    """(…) mean distance of the joints of two poses (…, J, 3)."""
    return np.asarray(np.linalg.norm(after - before, axis=-1).mean(-1))


def mean_steps(positions: Array) -> Array:
    """(…, T, J, 3) → (…, T − 1) mean distance per joint from frame to frame."""
    return mean_step(positions[..., :-1, :, :], positions[..., 1:, :, :])


def predicted(request: PredictRequest, futures: Sequence[Array]) -> PredictResult:
    """The result of a request and its futures, each (people, F, 22, 3) metres in the world of the past."""
    past = stacked_positions(request.past).astype(np.float64)
    whole = np.stack([np.concatenate([past, future], axis=1) for future in futures])  # (N, people, T, 22, 3)
    first = past.shape[1]
    truth, error, true_speed = request.truth, np.empty(0), np.empty(0)
    if truth is not None:
        real = stacked_positions(truth).astype(np.float64)
        error = np.linalg.norm(whole[:, :, first : first + real.shape[1]] - real, axis=-1).mean(axis=(0, 1, 3))
        true_speed = mean_steps(np.concatenate([past[:, -1:], real], axis=1)).mean(0)
    speed = mean_steps(whole[:, :, first - 1 :]).mean(axis=(0, 1))
    return PredictResult(
        duets=tuple(with_people(request.motion, each) for each in whole),
        past_frames=first,
        truth=truth,
        error=tuple((1000 * error).round(2).tolist()),
        speed=tuple((1000 * speed).round(3).tolist()),
        true_speed=tuple((1000 * true_speed).round(3).tolist()),
    )
