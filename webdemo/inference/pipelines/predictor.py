"""Predicts the future of one person or two by applying a trained predictor recursively (thesis, 2.5.9)."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import torch

from models.mawgan.network import PredictiveMAWGAN
from models.motion_mlp import MotionMLP
from models.weights_io import WeightsFolder, load_network
from motion import FPS, stacked_positions
from motion.cleaning import foot_contacts, plant_feet
from motion.kinematics import bone_lengths, bone_vectors, chained
from motion.transforms import heading, heading_matrix
from motion.vectors import FLAT, Array, unit
from webdemo.inference.requests.predict import PredictRequest, mean_step, mean_steps, predicted
from webdemo.inference.run import CancelToken, Progress, Result, StageTimer

_STILL = 1e-3
"""Metres: if no joint of a past, or of a future, moves farther than this, the person stands still."""
_OVERLAP = 10
"""Frames that a pass of the recursion shares with the previous one; over them the two are cross-faded."""
_SEAM_TRIES = 8
_SEAM_FADE = 0.7
"""Factor by which a correction at the seam decays each frame."""
_BLEND = 5
"""Frames over which a correction fades in and out."""
_FLOOR = 0.1
"""Metres from 0 within which the lowest that a person was must lie to be the floor that they stand on."""


Predictor = MotionMLP | PredictiveMAWGAN
"""A network that continues positions: (B, past, J, 3) metres → (B, future, J, 3), sizes as in its ``config``."""


def load_predictor(folder: Path) -> tuple[Predictor, WeightsFolder]:
    """A predictor in float32, eval mode, and its weights folder; raises WeightsError as :func:`load_network` does."""
    if WeightsFolder(folder).meta.get("kind") == "mlp":
        return load_network(folder, MotionMLP)
    return load_network(folder, PredictiveMAWGAN)


def without_jump(past: Array, future: Array, largest: Array) -> Array:
    """A future whose first step is no larger than a given mean distance per joint; the rest follows smoothly.

    Args:
        past: (P, T, J, 3) metres.
        future: (P, F, J, 3) metres.
        largest: (P,) metres.
    """
    size = mean_step(past[:, -1], future[:, 0])
    excess = np.maximum(1 - largest / np.maximum(size, 1e-9), 0.0)[:, None, None] * (future[:, 0] - past[:, -1])
    fade = _SEAM_FADE ** np.arange(future.shape[1])
    return future - fade[:, None, None] * excess[:, None]


def fitted_to_past(past: Array, future: Array) -> Array:
    """A future (P, F, 22, 3) that goes on from its past.

    The result keeps the bone lengths of the last pose, its first step is no larger than the largest of the past, and
    it does not sink below the lowest point of the past.
    """
    largest = mean_steps(past).max(axis=1)
    asked = largest
    for _ in range(_SEAM_TRIES):
        made = no_lower_than(past, with_bones_of(past[:, -1], without_jump(past, future, asked)))
        step = mean_step(past[:, -1], made[:, 0])
        if np.all(step <= largest):
            break
        # The bone and floor corrections lengthened the step again: ask for a shorter one.
        asked = asked * np.where(step > largest, 0.98 * largest / np.maximum(step, 1e-9), 1.0)
    return made


def with_bones_of(pose: Array, positions: Array) -> Array:
    """Positions (P, T, 22, 3) with the bone lengths of a pose (P, 22, 3): same root, same directions."""
    lengths = bone_lengths(pose)[:, None, :, None]
    return chained(positions[:, :, 0], lengths * unit(bone_vectors(positions)))


def no_lower_than(past: Array, future: Array) -> Array:
    """Raises the frames of a future that would sink below the lowest point of the past."""
    floor = past[..., 1].min(axis=(1, 2))[:, None]
    lift = np.maximum(floor - future[..., 1].min(axis=-1), 0.0)
    raised = future.copy()
    raised[..., 1] += lift[..., None]
    return raised


def faded(before: Array, after: Array) -> Array:
    """Cross-fades from the steps of one prediction to those of another.

    It fades steps, not positions. A fade of positions would add the offset between the two predictions to the
    motion, and people would speed up at every join.

    Args:
        before: (P, 1 + N, J, 3) the last pose and N frames of the first prediction.
        after: (P, F, J, 3) the second prediction from that pose, F at least N.

    Returns:
        (P, F, J, 3).
    """
    steps = np.diff(np.concatenate([before[:, :1], after], axis=1), axis=1)
    again = before.shape[1] - 1
    share = (np.arange(again) + 1)[:, None, None] / (again + 1)
    steps[:, :again] = (1 - share) * np.diff(before, axis=1) + share * steps[:, :again]
    return before[:, :1] + steps.cumsum(axis=1)


class PredictorPipeline:
    """Continues motions by the predictor of a weights folder; without one, by holding the last pose.

    Raises WeightsError (an InputError) if files are missing or altered.
    """

    def __init__(self, folder: Path | None) -> None:
        self.predictor: Predictor | None = None
        self.name, self.digest = "still", ""
        if folder is not None:
            self.predictor, source = load_predictor(folder)
            self.name, self.digest = folder.name, source.digest

    def predict(self, past: Array, frames: int) -> Array:
        """Predicts the frames that follow a past.

        Args:
            past: (people, T, 22, 3) metres at 30 fps, a second or more.
            frames: how many are predicted.

        Returns:
            (people, frames, 22, 3) metres in the world of the past. Bones keep the lengths of the last pose;
            the first step is no larger than the largest of the past's last second. A person who stands still
            stays still, and planted feet do not slide.
        """
        *_, whole = self.passes(past.astype(np.float64), frames)
        return self._cut(whole, past.shape[1], frames)

    def passes(self, past: Array, frames: int) -> Iterator[Array]:
        """The motion (people, T + …, 22, 3) after each pass of the network, until all frames are there."""
        whole, seen = past, past[:, -round(FPS) :]
        still = np.abs(seen - seen[:, -1:]).max(axis=(1, 2, 3)) < _STILL
        if self.predictor is None:
            still[:] = True
        kept = past.shape[1]  # a pass continues from these frames; it predicts the later ones again
        while whole.shape[1] - past.shape[1] < frames:
            future = held = np.repeat(whole[:, kept - 1 : kept], round(FPS), axis=1)
            if not still.all():
                future = self._next(whole[:, :kept])
                future = with_bones_of(past[:, -1], faded(whole[:, kept - 1 :], future))
                future = no_lower_than(past, future)
            future = np.where(still[:, None, None, None], held, future)
            whole = np.concatenate([whole[:, :kept], future], axis=1)
            kept = whole.shape[1] - _OVERLAP
            yield whole

    @staticmethod
    def _cut(whole: Array, past: int, frames: int) -> Array:
        """The requested frames of a prediction, with planted feet."""
        seen, future = whole[:, :past][:, -round(FPS) :], whole[:, past : past + frames]
        return with_planted_feet(seen, future, FPS)

    def _next(self, whole: Array) -> Array:
        assert self.predictor is not None
        past = whole[:, -self.predictor.config.past :]
        local, turn, shift = to_last_pose(past)
        with torch.no_grad():
            made = self.predictor(torch.from_numpy(local.astype(np.float32))).numpy()
        return fitted_to_past(past, to_world(made.astype(np.float64), turn, shift))

    def run(self, request: PredictRequest, cancel: CancelToken, timer: StageTimer) -> Iterator[Progress | Result]:
        """Progress events, then one :class:`PredictResult` without a manifest."""
        past, frames = stacked_positions(request.past).astype(np.float64), round(request.seconds * FPS)
        whole: Array = past
        total = 1 + max(0, -(-(frames - round(FPS)) // (round(FPS) - _OVERLAP)))
        for step, longer in enumerate(self.passes(past, frames), start=1):
            whole = longer
            yield timer.progress("sample", step, total, "pass")
            cancel.raise_if_cancelled()
        future = self._cut(whole, past.shape[1], frames)
        timer.lap("sample")
        yield predicted(request, [future])


def to_last_pose(positions: Array, frame: int = -1) -> tuple[Array, Array, Array]:
    """Moves people so that one pose of each stands over the origin and faces +Z; heights stay.

    Args:
        positions: (…, T, 22, 3) metres.
        frame: whose pose; the last by default.

    Returns:
        positions (…, T, 22, 3) float64 there, and the matrices (…, 3, 3) and shifts (…, 3) of
        :func:`to_world`.
    """
    pose = positions[..., frame, :, :].astype(np.float64)
    shift = pose[..., 0, :] * FLAT
    turn = heading_matrix(-heading(pose))
    return (positions - shift[..., None, None, :]) @ np.swapaxes(turn, -1, -2)[..., None, :, :], turn, shift


def to_world(positions: Array, turn: Array, shift: Array) -> Array:
    """Inverse of :func:`to_last_pose`: (…, T, 22, 3) back in the clip's world."""
    return positions @ turn[..., None, :, :] + shift[..., None, None, :]


def with_planted_feet(past: Array, future: Array, fps: float) -> Array:
    """A future whose standing feet do not glide.

    Who stood with a foot at the end of the past goes on standing in the same place; that a foot comes down
    is believed only some frames later, so that its correction can fade in after the seam. People who are not
    on the floor are left alone, and so is one whose first step would grow.

    Args:
        past: (P, T, 22, 3) metres.
        future: (P, F, 22, 3) metres, with the bone lengths of the past's last pose.
        fps: frames a second.

    Returns:
        (P, F, 22, 3) with the same bone lengths.
    """
    made = np.array(future, dtype=np.float64)
    for person, before in enumerate(past.astype(np.float64)):
        floor = np.array([0.0, before[..., 1].min(), 0.0])
        moves = np.abs(made[person] - before[-1]).max() > _STILL
        if abs(floor[1]) > _FLOOR or not moves:
            continue
        before, after = before - floor, made[person] - floor
        contacts = foot_contacts(np.concatenate([before, after]), fps)[len(before) - 1 :]
        stood, contacts = contacts[0], contacts[1:]
        contacts[:_BLEND] = contacts[:_BLEND] & stood
        # The last pose, held for as long as the future, outvotes it where a contact's place is sought.
        held = np.repeat(before[-1:], len(after), axis=0)
        whole = plant_feet(
            np.concatenate([held, after]),
            np.concatenate([np.repeat(stood[None], len(after), axis=0), contacts]),
            blend=_BLEND,
            held=np.arange(2 * len(after)) < len(after),
        )
        planted = whole[len(after) :]
        if mean_step(before[-1], planted[0]) <= max(mean_step(before[-1], after[0]), mean_steps(before).max()):
            made[person] = planted + floor
    return made
