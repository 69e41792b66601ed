"""Fitting a skeleton of constant bones to a whole noisy clip (inverse kinematics in space and time).

One non-linear least-squares problem over all frames at once, in the spirit of maximum a posteriori
marker fitting: the unknowns are the root's path and one rotation a joint and frame; the terms are

- data: recorded joints, divided by their noise and made robust with Huber's loss, so a flipped or thrown
  joint counts for little (Huber 1964);
- smoothness: accelerations of all joints, divided by the accelerations of human motion;
- a pose prior: how far each joint bends softly, where it stops hard (knees and elbows bend one way, the
  spine twists little), feet that stay level while they are low.

Gauss–Newton steps solve it; the normal matrix is block-pentadiagonal in time, so a step costs one banded
Cholesky factorisation, linear in the number of frames.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from .ik_solver import MIN_NOISE, solve
from .kinematics import fit_rotations, forward_kinematics, kabsch
from .skeleton import SMPL22, Layout, Skeleton, find_layout
from .smoothing import filled
from .vectors import Array


class SkeletonFit(NamedTuple):
    """A fitted clip.

    Attributes:
        positions: (T, 22, 3) metres.
        error: median distance in metres between the recorded joints and the fit.
    """

    positions: Array
    error: float


def fit_skeleton(
    positions: Array,
    joints: Layout | Skeleton | Sequence[str],
    *,
    weights: Array | None = None,
    fps: float = 30.0,
    noise: float | None = None,
    scale: float | None = None,
    iterations: int = 8,
) -> SkeletonFit:
    """Fits a motion of constant bones to recorded joints of another layout.

    The person's own bone lengths are measured over the clip, the pose is fitted on them, and the pose is
    put on SMPL22's bones. Heights shrink or grow with the legs; the path over the floor is divided
    by ``scale``, so give both people of a scene the same one.

    Args:
        positions: (T, J, 3) metres, Y up, floor at 0, in the layout's order.
        joints: a layout, a skeleton (SBU15, K3HI15, NTU25, CMU17), or J names of SMPL22 joints.
        weights: trust in each joint, broadcast to (T, J, 3); 0 leaves a joint out, e.g. where it was lost.
        fps: frames a second of ``positions``.
        noise: metres by which a coordinate is uncertain; by default estimated from how much bones stretch,
            which misses the errors of a tracker that keeps its bones rigid itself.
        scale: the factor that the floor path is divided by; by default this person's :func:`body_scale`.
        iterations: Gauss–Newton steps.
    """
    layout = find_layout(joints)
    positions = np.asarray(positions, dtype=np.float64)
    trust = np.broadcast_to(1.0 if weights is None else weights, positions.shape)[:, layout.columns]
    target = positions[:, layout.columns]
    trust = np.where(np.isfinite(target), trust, 0.0)
    target = filled(target)

    stretch = _noise(target, layout)
    body = _measured_body(target, layout, stretch)
    trust = trust * _length_trust(target, layout, body, noise or stretch)[..., None]
    noise = max(noise or 0.0, stretch)
    rotations, root = _start(target, layout, body)
    rotations, root = solve(rotations, root, target, trust, layout, body, noise, fps, iterations)
    fitted = forward_kinematics(rotations, root, body)[:, layout.observed]
    error = float(np.median(np.linalg.norm(fitted - target, axis=-1)[trust.max(-1) > 0]))

    legs = _leg_length(SMPL22.offsets)
    size = _leg_length(body.offsets) / legs
    root = root / np.array([scale or size, size, scale or size])
    return SkeletonFit(forward_kinematics(rotations, root), error)


def pose_bodies(
    positions: Array, layout: Layout, *, body: Skeleton | None = None
) -> tuple[Array, Array, Skeleton, float]:
    """Poses a body frame by frame, from the directions of its bones: fast, and without regard to other frames.

    Args:
        positions: (T, J, 3) metres in the layout's order, finite.
        layout: of the joints.
        body: the person's body; measured over the frames by default.

    Returns:
        (T, 22, 3, 3) local rotations, (T, 3) the root's path, the body, and the ratio of its legs to SMPL22's.
    """
    target = np.asarray(positions, dtype=np.float64)[:, layout.columns]
    if body is None:
        body = _measured_body(target, layout, _noise(target, layout))
    rotations, root = _start(target, layout, body)
    return rotations, root, body, _leg_length(body.offsets) / _leg_length(SMPL22.offsets)


def body_scale(positions: Array, joints: Layout | Skeleton | Sequence[str]) -> float:
    """Ratio of a person's leg lengths to SMPL22's: 1.05 is a body 5 % larger.

    Args:
        positions: (T, J, 3) metres in the layout's order.
    """
    layout = find_layout(joints)
    target = filled(np.asarray(positions, dtype=np.float64)[:, layout.columns])
    body = _measured_body(target, layout, _noise(target, layout))
    return _leg_length(body.offsets) / _leg_length(SMPL22.offsets)


def _leg_length(offsets: Array) -> float:
    """From the pelvis down to the ankles, standing straight."""
    chain = [SMPL22.index(n) for n in ("left_hip", "left_knee", "left_ankle")]
    return float(-offsets[chain[0], 1] + np.linalg.norm(offsets[chain[1:]], axis=-1).sum())


def _segments(layout: Layout) -> list[tuple[int, int, int, int, list[int]]]:
    """(column, ancestor column, joint, ancestor joint, joints on the way) between observed joints."""
    column = {joint: i for i, joint in enumerate(layout.observed)}
    segments = []
    for joint in layout.observed:
        way, parent = [joint], SMPL22.parents[joint]
        while parent >= 0 and parent not in column:
            way.append(parent)
            parent = SMPL22.parents[parent]
        if parent >= 0:
            segments.append((column[joint], column[parent], joint, parent, way))
    return segments


def _measured_body(target: Array, layout: Layout, noise: float) -> Skeleton:
    """The layout's body with this person's bone lengths: medians over time, left and right alike.

    Noise of ``noise`` metres a coordinate lengthens what is measured, d² = length² + 6 noise² on average;
    that is taken off, and a bone short against the noise follows the rest of the body.
    """

    def ratio(first: int, second: int, expected: float) -> float:
        square = np.median(np.sum((target[:, first] - target[:, second]) ** 2, axis=-1)) - 6 * noise**2
        return float(np.sqrt(np.maximum(square, (0.3 * expected) ** 2)) / expected)

    offsets = layout.offsets.copy()
    ways = {joint: way for _, _, joint, _, way in _segments(layout)}
    lengths = {joint: float(np.linalg.norm(offsets[way].sum(axis=0))) for joint, way in ways.items()}
    ratios = {joint: ratio(column, above, lengths[joint]) for column, above, joint, _, _ in _segments(layout)}
    certain = {joint: length**2 / (length**2 + 30 * noise**2) for joint, length in lengths.items()}
    # The median, weighted by length: one wrong limb does not change the size of the body.
    order = sorted(ratios, key=lambda joint: ratios[joint])
    shares = np.cumsum([certain[joint] * lengths[joint] for joint in order])
    overall = ratios[order[int(np.searchsorted(shares, shares[-1] / 2))]]
    scaled = offsets * overall
    for joint, way in ways.items():
        both = (ratios[joint] + ratios.get(SMPL22.mirror[joint], ratios[joint])) / 2
        # A measure far from the rest of the body is noise too: an arm that is hidden all the time.
        both = np.clip(both, overall / (1 + layout.variety), overall * (1 + layout.variety))
        differs = both - overall
        if len(way) > 1:  # the joints between bend, so this is no bone: only a clear difference counts
            differs = np.sign(differs) * max(abs(differs) - 0.05, 0.0)
        scaled[way] = offsets[way] * (overall + certain[joint] * differs)
    for part in ("hip", "shoulder"):
        left, right = SMPL22.index(f"left_{part}"), SMPL22.index(f"right_{part}")
        if not {left, right} <= set(layout.observed) or {left, SMPL22.parents[left]} <= set(layout.observed):
            continue  # where the joint above is recorded too, the bone itself has been measured
        way = [left] if part == "hip" else [left, SMPL22.parents[left]]
        width = 2 * offsets[way, 0].sum()
        wide = ratio(layout.observed.index(left), layout.observed.index(right), width)
        for bone in way:
            for side in (bone, SMPL22.mirror[bone]):
                scaled[side] = offsets[side] * [wide, overall, overall]
    return Skeleton(layout.name, SMPL22.joint_names, SMPL22.parents, scaled)


def _noise(target: Array, layout: Layout) -> float:
    """Metres of noise a coordinate, from how much bones change length: a rigid bone has none."""
    spreads = []
    for column, ancestor, _, _, way in _segments(layout):
        if len(way) == 1:
            length = np.linalg.norm(target[:, column] - target[:, ancestor], axis=-1)
            spreads.append(1.4826 * np.median(np.abs(length - np.median(length))))
    return max(MIN_NOISE, float(np.percentile(spreads, 75)) / np.sqrt(2)) if spreads else 0.01


def _length_trust(target: Array, layout: Layout, body: Skeleton, noise: float) -> Array:
    """(T, O) at most 1: a joint whose bone is too long or short by d is trusted as if it were off by d."""
    trust = np.ones(target.shape[:2])
    rest = body.rest_positions()
    for column, ancestor, joint, above, way in _segments(layout):
        if len(way) == 1:
            length = np.linalg.norm(target[:, column] - target[:, ancestor], axis=-1)
            wrong = length - np.linalg.norm(rest[joint] - rest[above])
            trust[:, column] = noise**2 / (noise**2 + wrong**2)
    return trust


def _start(target: Array, layout: Layout, body: Skeleton) -> tuple[Array, Array]:
    """Rotations and root path to start from: bone directions, unseen joints where the rest pose has them."""
    rest = body.rest_positions()
    index = SMPL22.index
    column = {joint: i for i, joint in enumerate(layout.observed)}
    trunk_names = ("left_hip", "right_hip", "left_shoulder", "right_shoulder", "neck", "spine2", "spine3", "pelvis")
    trunk = [index(n) for n in trunk_names if index(n) in column]
    seen = target[:, [column[j] for j in trunk]]
    centre, rest_centre = seen.mean(axis=1), rest[trunk].mean(axis=0)
    turn = kabsch(rest[trunk] - rest_centre, seen - centre[:, None])
    placed = centre[:, None] + (rest - rest_centre) @ np.swapaxes(turn, -1, -2)
    for joint in range(SMPL22.num_joints):
        if joint in column:
            placed[:, joint] = target[:, column[joint]]
        elif joint not in (0, 3, 6, 9, 12, 13, 14):  # an unseen limb joint hangs on its parent
            parent = SMPL22.parents[joint]
            toe = SMPL22.children[joint][0] if SMPL22.children[joint] else joint
            if toe != joint and toe in column:  # an ankle of which only the toe is known stands behind it
                placed[:, joint] = target[:, column[toe]] - turn @ body.offsets[toe]
            else:
                placed[:, joint] = placed[:, parent] + turn @ body.offsets[joint]
    return fit_rotations(placed, body), placed[:, 0]
