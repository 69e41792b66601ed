"""InterGen's training losses with their damping.

Liang et al., "InterGen", section 4.3: bone length (eq. 11), joint distance map (eq. 12), relative
orientation (eq. 13), their sum (eq. 14) and the damping that keeps them to timesteps t ≤ t̄ (eq. 15); velocity
and foot contact after MDM; joint affinity, which the released code has and the paper does not.

Shapes: positions are (B, T, 2, J, 3) in metres, Y up, at 30 frames a second, J the joints of SMPL22.
``mask`` is (B, T) or (B, T, 2), nonzero where a frame is real, or None. A term of one person gives (B, 2), a
term of the pair (B,): the mean over the sample's real frames. `InterGenLoss` weights and damps them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import torch
import torch.nn.functional as F
from torch import Tensor

from motion.representation import CONTACT_HEIGHTS, CONTACT_SQUARED_STEP
from motion.skeleton import FEET, SMPL22

LEFT_HIP, RIGHT_HIP = SMPL22.index("left_hip"), SMPL22.index("right_hip")
NEAR = 1.0  # metres: pairs of joints that the distance map looks at
TOUCH = 0.1  # metres: pairs of joints that joint affinity draws together
EPSILON = 1e-7


def masked_mean(values: Tensor, mask: Tensor | None) -> Tensor:
    """Mean over time of values (B, T, …) where mask (B, T, …) is nonzero → (B, …)."""
    if mask is None:
        return values.mean(1)
    mask = (mask != 0).to(values.dtype)
    return (values * mask).sum(1) / (mask.sum(1) + EPSILON)


def _person_mask(mask: Tensor | None) -> Tensor | None:
    return mask if mask is None or mask.dim() == 3 else mask[..., None].expand(-1, -1, 2)


def _pair_mask(mask: Tensor | None) -> Tensor | None:
    return mask if mask is None or mask.dim() == 2 else (mask != 0).all(-1)


def velocity_loss(pred: Tensor, true: Tensor, mask: Tensor | None = None) -> Tensor:
    """Squared error of the displacement from frame to frame, m² → (B, 2)."""
    error = (pred.diff(dim=1) - true.diff(dim=1)).square().mean((-1, -2))
    mask = _person_mask(mask)
    return masked_mean(error, None if mask is None else mask[:, :-1])


def bone_lengths(positions: Tensor) -> Tensor:
    """Lengths of the 21 bones in metres: (…, J, 3) → (…, 21)."""
    parents, children = zip(*SMPL22.bones, strict=True)
    return torch.linalg.vector_norm(positions[..., children, :] - positions[..., parents, :], dim=-1)


def bone_length_loss(pred: Tensor, true: Tensor, mask: Tensor | None = None) -> Tensor:
    """Squared error of the bone lengths (eq. 11), m² → (B, 2)."""
    error = (bone_lengths(pred) - bone_lengths(true)).square().mean(-1)
    return masked_mean(error, _person_mask(mask))


def foot_contact_loss(pred: Tensor, mask: Tensor | None = None) -> Tensor:
    """Squared displacement of the feet while they touch the floor, m² → (B, 2).

    The contact is detected on the prediction itself, as in the release: a foot joint that is low and nearly
    still is asked to be wholly still. The mean is over the feet in contact, then over frames.
    """
    feet = pred[..., FEET, :]
    step = feet.diff(dim=1)
    low = feet[:, :-1, ..., 1] < torch.as_tensor(CONTACT_HEIGHTS).to(pred)
    contact = ((step.square().sum(-1) < CONTACT_SQUARED_STEP) & low).to(pred.dtype)
    error = (step.square().mean(-1) * contact).sum(-1) / (contact.sum(-1) + EPSILON)
    mask = _person_mask(mask)
    return masked_mean(error, None if mask is None else mask[:, :-1])


def joint_distances(a: Tensor, b: Tensor) -> Tensor:
    """Distance of every joint of a to every joint of b, metres: (…, J, D) each → (…, J, J)."""
    if a.is_cuda:  # cdist is made for many points: for 22 it took four fifths of a training step
        return (a[..., :, None, :] - b[..., None, :, :]).square().sum(-1).clamp_min(1e-12).sqrt()
    return torch.cdist(a, b, compute_mode="donot_use_mm_for_euclid_dist")


def distance_map(positions: Tensor, *, horizontal: bool = False) -> Tensor:
    """Distance of every joint of a to every joint of b, metres: (B, T, 2, J, 3) → (B, T, J, J)."""
    if horizontal:
        positions = positions[..., [0, 2]]
    return joint_distances(*positions.unbind(2))


def _pairs_mean(error: Tensor, pairs: Tensor, mask: Tensor | None) -> Tensor:
    """Mean of error (B, T, J, J) over the chosen pairs of each frame, then over frames → (B,)."""
    chosen = pairs.to(error.dtype)
    frames = (error * chosen).sum((-1, -2)) / (chosen.sum((-1, -2)) + EPSILON)
    return masked_mean(frames, _pair_mask(mask))


def distance_map_loss(
    pred: Tensor, true: Tensor, mask: Tensor | None = None, *, near_by: Literal["prediction", "truth"] = "prediction"
) -> Tensor:
    """Squared error of the distances between the people's joints that are near (eq. 12), m² → (B,).

    `near_by` says whose distance is held against 1 m: that of the ``prediction`` in space, as the released
    code does, or that of the ``truth`` on the floor (XZ), as the paper writes.
    """
    distances = distance_map(pred)
    near = distances < NEAR if near_by == "prediction" else distance_map(true, horizontal=True) < NEAR
    return _pairs_mean((distances - distance_map(true)).square(), near.detach(), mask)


def joint_affinity_loss(pred: Tensor, true: Tensor, mask: Tensor | None = None) -> Tensor:
    """Squared distance of the joint pairs that truly touch (< 0.1 m), m² → (B,). Not in the paper."""
    return _pairs_mean(distance_map(pred).square(), distance_map(true) < TOUCH, mask)


def contact_loss(pred: Tensor, true: Tensor, mask: Tensor | None = None) -> Tensor:
    """Squared error of the distances between the people's joints, nearest first → (B,). Not in the paper.

    A pair of joints at the true distance d weighs 1 / (d + 0.1 m): a pair that touches ten times as much as one
    at 0.9 m, and every pair something. The mean is over all pairs, then over frames.
    """
    true_distance = distance_map(true)
    error = (distance_map(pred) - true_distance).square() / (true_distance + TOUCH)
    return masked_mean(error.mean((-1, -2)), _pair_mask(mask))


def facing(positions: Tensor) -> Tensor:
    """Unit forward vector of each body, Y × (right hip − left hip): (…, J, 3) → (…, 3)."""
    x, _, z = (positions[..., RIGHT_HIP, :] - positions[..., LEFT_HIP, :]).unbind(-1)
    return F.normalize(torch.stack([z, torch.zeros_like(x), -x], -1), dim=-1)


def relative_orientation(positions: Tensor) -> Tensor:
    """(cos, sin) of the turn about Y from a's facing to b's: (B, T, 2, J, 3) → (B, T, 2)."""
    a, b = facing(positions).unbind(2)
    cos = a[..., 0] * b[..., 0] + a[..., 2] * b[..., 2]
    sin = a[..., 2] * b[..., 0] - a[..., 0] * b[..., 2]
    return torch.stack([cos, sin], -1)


def relative_orientation_loss(pred: Tensor, true: Tensor, mask: Tensor | None = None) -> Tensor:
    """Squared error of how the people are turned to each other (eq. 13) → (B,).

    O is taken as (cos, sin) of the angle, which is smooth where people face each other. The release takes two numbers
    of a quaternion, which jump in sign there.
    """
    error = (relative_orientation(pred) - relative_orientation(true)).square().mean(-1)
    return masked_mean(error, _pair_mask(mask))


def damped_mean(values: Tensor, t: Tensor, t_bar: int) -> Tensor:
    """Mean of a term's (B,) or (B, 2) values over the samples with t ≤ t̄, people summed → scalar.

    A conditional mean, E[L | t ≤ t̄], as in the release. The E_t[I(t ≤ t̄) · L] of eq. 15 is a mean over all
    samples: this one times the share of samples with t ≤ t̄. So a lower t̄ does not weaken a term here, as it does
    in the paper's formula. Zero where no sample of the batch is below the threshold.
    """
    per_sample = values.sum(-1) if values.dim() == 2 else values
    chosen = (t <= t_bar).to(values.dtype)
    return (per_sample * chosen).sum() / (chosen.sum() + EPSILON)


@dataclass(frozen=True)
class LossWeights:
    """λ of each term; the defaults are the released ones. A term of weight 0 is not worked out."""

    simple: float = 1.0
    velocity: float = 30.0
    foot_contact: float = 30.0
    bone_length: float = 10.0
    distance_map: float = 3.0
    joint_affinity: float = 3.0
    relative_orientation: float = 0.01
    contact: float = 0.0


class InterGenLoss:
    """The weighted, damped sum of eq. 14 and 15.

    Args:
        weights: λ of each term.
        t_bar: the damping threshold t̄ as a timestep: all terms but *simple* count only where t ≤ t̄.
        near_by: see `distance_map_loss`.
    """

    def __init__(
        self,
        weights: LossWeights | None = None,
        *,
        t_bar: int = 700,
        near_by: Literal["prediction", "truth"] = "prediction",
    ) -> None:
        self.weights, self.t_bar = weights or LossWeights(), t_bar
        self.near_by: Literal["prediction", "truth"] = near_by

    def regularizers(self, pred: Tensor, true: Tensor, t: Tensor, mask: Tensor | None = None) -> dict[str, Tensor]:
        """Every term but *simple*, weighted and damped: positions (B, T, 2, J, 3), t (B,) → scalars."""
        pred, true, w = pred.float(), true.float(), self.weights
        damped: dict[str, Callable[[], Tensor]] = {
            "velocity": lambda: velocity_loss(pred, true, mask),
            "foot_contact": lambda: foot_contact_loss(pred, mask),
            "bone_length": lambda: bone_length_loss(pred, true, mask),
            "distance_map": lambda: distance_map_loss(pred, true, mask, near_by=self.near_by),
            "joint_affinity": lambda: joint_affinity_loss(pred, true, mask),
            "contact": lambda: contact_loss(pred, true, mask),
            "relative_orientation": lambda: relative_orientation_loss(pred, true, mask),
        }
        return {
            name: weight * damped_mean(term(), t, self.t_bar)
            for name, term in damped.items()
            if (weight := getattr(w, name))
        }


def simple_loss(pred: Tensor, true: Tensor, mask: Tensor | None = None) -> Tensor:
    """Mean squared error over the real frames of the whole batch (eq. 8): (B, T, 2, F) → scalar."""
    error = (pred.float() - true.float()).square().mean(-1)
    mask = _person_mask(mask)
    if mask is None:
        return error.mean()
    real = (mask != 0).to(error.dtype)
    return (error * real).sum() / (real.sum() + EPSILON)
