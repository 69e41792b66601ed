"""Regularisers without ground truth, and how much of their correction is made at each timestep.

InterGen's damping (section 4.3, eq. 15) applies the regularisers only at small timesteps. In training they
compare with the true motion. At inference there is none, so the terms here need none: constant bone lengths,
feet that stay planted and above the floor, smooth joints, bodies that do not intersect, contact of hands that
nearly touch, and people who nearly face each other turned to face fully. At t ≤ t̄·T and at the last timestep the
predicted clean motion goes towards where a few gradient steps on these terms lead, in the network's space of spline
control points, and t̄ sets how far (:func:`shares`); a given person does not move. If the sentence asks for a touch
(:meth:`models.intergen.compact.CompactInterGen.touches`), its joints are pulled together at the moment when they are
nearest. With t̄ = 0 the sampler is unchanged, bit for bit.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import torch
from torch import Tensor

from models.diffusion import TRAIN_TIMESTEPS
from models.intergen.compact import Touch
from models.intergen.released import ReleasedInterGen
from models.motion_tokens import DuetSpace, foot_contacts
from models.regennet.compact import CompactReGenNet
from motion import SMPL22
from motion.metrics.bodies import CAPSULES
from motion.skeleton import FEET

_WRISTS = torch.tensor([SMPL22.index("left_wrist"), SMPL22.index("right_wrist")])
_FEET = torch.tensor(FEET)
_PARENTS = torch.tensor([parent for parent, _ in SMPL22.bones])
assert [child for _, child in SMPL22.bones] == list(range(1, SMPL22.num_joints))  # a slice is cheaper
_HIPS = [SMPL22.index("left_hip"), SMPL22.index("right_hip")]
_LIMBS = [
    (parent, child) for parent, child in SMPL22.bones if SMPL22.joint_names[child].endswith(("elbow", "wrist", "knee"))
]
_NEAR = 1.8  # metres between two pelvises, beyond which no limb reaches the other


def _spheres() -> tuple[Tensor, Tensor]:
    """The volume of a body as spheres around its joints and around the midpoints of :data:`_LIMBS`.

    Returns:
        (S, 2) the two joints whose midpoint is each centre, and (S,) radii in metres.
    """
    around = dict(zip(CAPSULES.ends.tolist(), CAPSULES.radii.tolist(), strict=True))
    joints = [around.get(joint, around[SMPL22.index("spine1")]) for joint in range(SMPL22.num_joints)]
    ends = [(joint, joint) for joint in range(SMPL22.num_joints)] + _LIMBS
    return torch.tensor(ends), torch.tensor(joints + [around[child] for _, child in _LIMBS])


_ENDS, _RADII = _spheres()


LAMBDAS = {"bone": 1.0, "foot": 20.0, "floor": 1.0, "smooth": 16.0, "overlap": 1.0, "contact": 0.5, "facing": 0.02}
"""λ of each term of :func:`energy`; lengths are in metres, times in frames at 30 a second."""
ASKED = 5.0
"""λ of a touch that the sentence asks for."""
TOUCH = 0.08
"""Metres between two wrists in contact."""
BODY = 0.13
"""Metres from a wrist to the joint inside the part of the body that it touches."""
NEARLY = 0.20
"""Metres within which wrists are pulled together in any case."""
REACH = 0.9
"""Metres within which joints are pulled together if the sentence asks for a touch."""
GRADIENT_STEPS = 2
"""Gradient steps of the correction at each timestep but the last."""
LAST_STEPS = 20
"""Gradient steps of that at the last timestep, since no network pass follows."""
STEP = 0.03
"""Length of a gradient step, and the largest move of any number in it."""


def energy(positions: Tensor, contacts: Tensor) -> Tensor:
    """The weighted sum of the regularisers, summed over frames.

    Args:
        positions: (B, 2, T, 22, 3) metres.
        contacts: (B, 2, T, 4) predicted contact of the feet, about 0 to 1.

    Returns:
        (B,) energy in m².
    """
    lengths = torch.linalg.vector_norm(
        positions[..., 1:, :] - positions.index_select(-2, _PARENTS.to(positions.device)), dim=-1
    )
    true_lengths = positions.new_tensor(SMPL22.bone_lengths[1:])
    bone = (lengths - true_lengths).square().sum((1, 2, 3))

    feet = positions.index_select(-2, _FEET)
    step = feet.diff(dim=2).square().sum(-1)
    standing = torch.minimum(contacts[:, :, 1:], contacts[:, :, :-1]).clamp(0, 1).detach()
    foot = (step * (standing > 0.5) * standing).sum((1, 2, 3))
    floor = (-feet[..., 1]).clamp_min(0).square().sum((1, 2, 3))

    smooth = positions.diff(n=3, dim=2).square().sum((1, 2, 3, 4))

    a, b = positions.unbind(1)
    overlap = _overlap(positions)
    own, other = (person.index_select(-2, _WRISTS) for person in (a, b))
    hands = torch.linalg.vector_norm(own[:, :, :, None] - other[:, :, None] + 1e-6, dim=-1)
    # Only the hands and moments of the smallest distance count; hands that pass farther away are left alone.
    nearest = hands.flatten(1).amin(1)[:, None, None, None]
    due = (hands < nearest + 0.05) & (nearest < NEARLY)
    contact = ((hands - TOUCH).clamp_min(0).square() * due).sum((1, 2, 3))

    terms = {
        "bone": bone,
        "foot": foot,
        "floor": floor,
        "smooth": smooth,
        "overlap": overlap,
        "contact": contact,
        "facing": _turned_away(a, b) + _turned_away(b, a),
    }
    return torch.stack([LAMBDAS[name] * term for name, term in terms.items()]).sum(0)


def _overlap(positions: Tensor) -> Tensor:
    """(B,) squared penetration depth of the two bodies, in m²; positions (B, 2, T, 22, 3).

    A first search finds the pairs of spheres that touch. They are few, and only they contribute to the energy and
    its gradient.
    """
    count, _, length, joints, _ = positions.shape
    ends, radii = _ENDS.to(positions.device), _RADII.to(positions)
    batch, frame, own, other = _touching(positions.detach(), ends, radii)
    points = positions.reshape(-1, 3)

    def centres(person: int, sphere: Tensor) -> Tensor:
        first = ((2 * batch + person) * length + frame) * joints
        return (points.index_select(0, first + ends[sphere, 0]) + points.index_select(0, first + ends[sphere, 1])) / 2

    gap = torch.linalg.vector_norm(centres(0, own) - centres(1, other), dim=-1)
    depth = (radii[own] + radii[other] - gap).clamp_min(0).square()
    return positions.new_zeros(count).index_add(0, batch, depth)


def _touching(positions: Tensor, ends: Tensor, radii: Tensor) -> tuple[Tensor, Tensor, Tensor, Tensor]:
    """(motion, frame, the first person's sphere, the second's) of all pairs that touch, or nearly."""
    apart = (positions[:, 0, :, 0] - positions[:, 1, :, 0]).square().sum(-1)
    batch, frame = (apart < _NEAR**2).nonzero(as_tuple=True)
    people = positions[batch, :, frame]  # (N, 2, 22, 3)
    limbs = ends[people.shape[2] :]  # the spheres before these are centred on single joints
    middles = (people.index_select(2, limbs[:, 0]) + people.index_select(2, limbs[:, 1])) / 2
    spheres = torch.cat([people, middles], dim=2)
    low, high = spheres.amin(-2) - radii.max(), spheres.amax(-2) + radii.max()
    boxes = (low < high.flip(1)).flatten(1).all(1)
    batch, frame, spheres = batch[boxes], frame[boxes], spheres[boxes]
    a, b = (spheres - spheres[:, :1, :1]).unbind(1)  # near 0, where squares are exact enough
    squares = a.square().sum(-1)[..., None] + b.square().sum(-1)[:, None]
    near = torch.baddbmm(squares, a, b.mT, alpha=-2) < (radii[:, None] + radii).square() + 1e-4
    pair = near.flatten().nonzero()[:, 0]
    at, own, other = pair // len(radii) ** 2, pair // len(radii) % len(radii), pair % len(radii)
    return batch[at], frame[at], own, other


def asked_energy(positions: Tensor, touches: Sequence[Touch]) -> Tensor:
    """(B,) energy in m² of the touches that the sentences ask for, at the moments of smallest distance.

    Args:
        positions: (B, 2, T, 22, 3) metres.
        touches: for each of the B.
    """
    totals = []
    for (a, b), touch in zip(positions, touches, strict=True):
        total = positions.new_zeros(())
        for own, other in touch:
            gap = torch.linalg.vector_norm(a[:, SMPL22.index(own)] - b[:, SMPL22.index(other)] + 1e-6, dim=-1)
            limbs = ("wrist", "elbow")
            apart = TOUCH if own.endswith(limbs) and other.endswith(limbs) else BODY
            due = (gap < gap.min() + 0.05) & (gap.min() < REACH)
            total = total + ((gap - apart).clamp_min(0).square() * due).sum()
        totals.append(ASKED * total)
    return torch.stack(totals)


def _turned_away(person: Tensor, other: Tensor) -> Tensor:
    """(B,) summed 1 − cos of the angle to a near partner whom a person nearly faces; (B, T, 22, 3) each."""
    across = person[:, :, _HIPS[0]] - person[:, :, _HIPS[1]]
    forward = torch.stack([-across[..., 2], across[..., 0]], dim=-1)
    forward = forward / torch.linalg.vector_norm(forward, dim=-1, keepdim=True).clamp_min(1e-4)
    towards = (other[:, :, 0] - person[:, :, 0])[..., [0, 2]].detach()
    distance = torch.linalg.vector_norm(towards, dim=-1)
    cos = (forward * towards).sum(-1) / distance.clamp_min(1e-4)
    nearly = (cos > 0.9) & (distance < 1.2)
    return ((1 - cos) * nearly).sum(1)


class Beside:
    """ReGenNet's space, which holds the reactor only, extended by the given actor.

    Args:
        actor: (T, 22, 3) metres, in the network's frame of reference.
    """

    def __init__(self, model: CompactReGenNet, actor: Tensor) -> None:
        self.model, self.actor, self.contacts = model, actor, foot_contacts(actor)

    @property
    def scale(self) -> Tensor:
        """(70,) metres to a unit of network space."""
        return self.model.std

    def positions(self, x: Tensor) -> tuple[Tensor, Tensor]:
        """(B, K, 70) → positions (B, 2, T, 22, 3) in metres, the actor first, and contacts (B, 2, T, 4)."""
        made, contacts = self.model.positions(x, len(self.actor))
        return (
            torch.stack([self.actor.expand_as(made), made], dim=1),
            torch.stack([self.contacts.expand_as(contacts), contacts], dim=1),
        )


Space = DuetSpace | ReleasedInterGen | Beside
"""The space that a network diffuses in, as the correction needs it: its ``scale``, and its way back to positions."""


def shares(threshold: float, timesteps: Sequence[int]) -> dict[int, float]:
    """The share of the correction that is made at each timestep: continuous in t̄, and growing with it.

    A timestep stands for those down to the next one, and its share is that of them which lies below t̄·T: 1 for
    t ≤ t̄·T (eq. 15), and 0 if the next one is above t̄·T, too. At the last timestep it is 1 − (1 − t̄)², 0.91 for the
    default: few steps end at a high timestep (eight at 234), and eq. 15 would then correct all or nothing.

    Args:
        threshold: t̄ as a fraction of T.
        timesteps: of the sampler, largest first.
    """
    limit = threshold * TRAIN_TIMESTEPS
    strengths = {t: min(max((limit - below) / (t - below), 0.0), 1.0) for t, below in pairwise(timesteps)}
    return strengths | {timesteps[-1]: 1 - (1 - threshold) ** 2}


class Damping:
    """Corrects the predicted clean motion, at timesteps t ≤ t̄·T and at the last one.

    Args:
        space: decodes positions from the network's space.
        threshold: t̄ as a fraction of T; 0 turns the damping off.
        frames: number of output frames; further frames of the last token are ignored.
        timesteps: of the sampler, largest first.
        frozen: (tokens, F) true where a number is given and must not move.
        touches: the touches that the sentence of each motion asks for; none by default.
    """

    def __init__(
        self,
        space: Space,
        threshold: float,
        *,
        frames: int,
        timesteps: Sequence[int],
        frozen: Tensor | None = None,
        touches: Sequence[Touch] = (),
    ) -> None:
        self.space, self.frames = space, frames
        self.shares, self.last = shares(threshold, timesteps), timesteps[-1]
        self.frozen, self.touches = frozen, touches
        self.moved: Tensor | None = None
        """(B,) metres by which the correction at the last timestep moved the joints, on average; None without one."""

    def __call__(self, x0: Tensor, timestep: int) -> Tensor:
        """The corrected prediction, (B, tokens, F) as given; the same object if nothing is due."""
        if not self.shares[timestep]:
            return x0
        scale, before = self.space.scale, x0
        for _ in range(LAST_STEPS if timestep == self.last else GRADIENT_STEPS):
            with torch.enable_grad():
                x = x0.detach().requires_grad_(True)
                positions, contacts = self.space.positions(x)
                positions, contacts = positions[:, :, : self.frames], contacts[:, :, : self.frames]
                total = energy(positions, contacts).sum()
                if any(self.touches):
                    total = total + asked_energy(positions, self.touches).sum()
                (gradient,) = torch.autograd.grad(total, x)
            # The step is taken on control points in metres: d/dcontrol = d/dx / std.
            move = (STEP * gradient / scale).clamp(-STEP, STEP)
            if self.frozen is not None:
                move = move.masked_fill(self.frozen, 0.0)
            x0 = x0.detach() - move / scale
        corrected = torch.lerp(before, x0, self.shares[timestep])
        if timestep == self.last:
            self.moved = self._between(before, corrected)
        return corrected

    def _between(self, x: Tensor, other: Tensor) -> Tensor:
        """(B,) metres between the joints of two motions (B, tokens, F), on average."""
        with torch.no_grad():
            apart = self.space.positions(other)[0] - self.space.positions(x)[0]
        return torch.linalg.vector_norm(apart[:, :, : self.frames], dim=-1).mean((1, 2, 3))
