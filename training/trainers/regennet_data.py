"""Training data of the compact ReGenNet: scenes of an actor and a reactor, some of which begin late, and a past
of the network's own."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch
from torch import Tensor

from models.diffusion import NoiseSchedule, top_timesteps
from models.motion_tokens import FEATURES, NUM_CONTACTS, NUM_JOINTS, canonical_control, mirror_control
from models.regennet.compact import LEAD, CompactReGenNet
from motion import SMPL22
from motion.smoothing import smoothstep
from training.prepare import ROOT_SCALE
from training.trainers.intergen_data import Batch, OneSentence, balanced


def at_knots(control: Tensor) -> Tensor:
    """Control points (…, K, 70) → the pose's numbers at the knots (…, K − 2, 66)."""
    knots = (control[..., :-2, :] + 4 * control[..., 1:-1, :] + control[..., 2:, :]) / 6
    return knots[..., : FEATURES - NUM_CONTACTS]


def knot_positions(control: Tensor) -> Tensor:
    """Control points (…, K, 70) → positions at the knots (…, K − 2, 22, 3)."""
    return _placed(at_knots(control))


def _placed(pose: Tensor) -> Tensor:
    """A pose's numbers (…, 66) → positions (…, 22, 3)."""
    root, others = pose.unflatten(-1, (-1, 3)).split([1, NUM_JOINTS - 1], dim=-2)
    return torch.cat([root, others + root], dim=-2)


def seen_rows(control: Tensor) -> Tensor:
    """The actor as each row sees it, not normalised: control points (B, K, 70) → (B, K, 132)."""
    pose = at_knots(control)
    place = torch.arange(control.shape[1]) - LEAD
    now, before = pose[:, place.clamp_min(0)], pose[:, (place - 1).clamp_min(0)]
    return torch.cat([now, now - before], dim=-1)


def is_recorded(row: dict[str, Any]) -> bool:
    """True if a scene was recorded with both people, and not composed of two recordings."""
    return any(str(source).startswith(("sbu", "k3hi")) for source in row["sources"])


class Data(OneSentence):
    """Batches as :mod:`training.trainers.intergen` draws them, with these differences.

    Recorded pairs count ``recorded`` times. Half of the scenes are
    shown mirrored, since an actor may lead with either hand. A share ``crop`` begins somewhere in their first half;
    ``past`` is 1 for these, as the reactor's first pose is given.
    """

    def weighted(self, rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
        """The rows, each as often as it is drawn."""
        return [row for row in balanced(rows) for _ in range(self.settings.recorded if is_recorded(row) else 1)]

    def mirrors(self, row: dict[str, Any], text: str, draw: float) -> bool:
        """Whether a scene is shown mirrored."""
        return draw < 0.5

    def continued(self, row: dict[str, Any], draw: Sequence[float]) -> tuple[Tensor, int, str] | None:
        """A scene (2, K, 70) from a knot of its first half on, in the frame of the actor's first pose there."""
        if draw[0] >= self.settings.crop:
            return None
        tokens, per_token = row["tokens"], self.scenes.layout.knots_per_token
        left_out = 1 + int(draw[1] * tokens / 2)
        late = self.scenes.scene(row)[:, left_out * per_token :]
        return canonical_control(late), 1, self.caption(row, draw[2])

    def people(self, batch: Batch) -> tuple[Tensor, Tensor, Tensor]:
        """Actor and reactor (B, K, 70) in metres, each with its last control point held, and mask (B, K)."""
        mask = batch.mask[..., 0].repeat_interleave(self.scenes.layout.knots_per_token, dim=1)
        control = self.control(batch.x0)
        place = torch.arange(mask.shape[1], device=mask.device).minimum(mask.sum(1, keepdim=True).long() - 1)
        actor, reactor = control.gather(2, place[:, None, :, None].expand_as(control)).unbind(1)
        return actor, reactor, mask

    def normalize(self, model: CompactReGenNet) -> None:
        """Sets a model's normalisers to those of the training scenes and their mirror images."""
        reactor, actor = [], []
        for row in self.scenes.split("train"):
            a, b = self.scenes.scene(row)
            for one in (a, mirror_control(a, SMPL22.mirror)):
                actor.append(seen_rows(one[None])[0])
            reactor += [b, mirror_control(b, SMPL22.mirror)]
        for name, values in (("", torch.cat(reactor)), ("actor_", torch.cat(actor))):
            scale = values.std(0).clamp_min(0.01)
            scale[[0, 2]] = scale[[0, 2]].clamp_max(ROOT_SCALE)
            getattr(model, f"{name}mean").copy_(values.mean(0))
            getattr(model, f"{name}std").copy_(scale)


# ---- the own past of the reactor -----------------------------------------------------------------
# What a network predicted earlier takes the place of the recorded rows.
# Online, row j sees the rows before it as the network left them, while training on recorded motion shows it the
# recorded ones. Here the network first makes its past as it does live, by up to four DDIM steps without gradient, and
# only the rows from a random one on are learned. They aim at the recorded motion, reached from where the network's own
# past left off: Bengio et al. 2015, "Scheduled Sampling"; Zhao et al. 2025, "DART", section 3.2, on rollouts of motion
# diffusion.
# Shapes: B batch, K rows; motion in network space (B, K, 70).


SHORTEST = 4
"""Rows that are learned at least, beside the ones that come at once with the first frame."""
RETURN = 6
"""Rows over which the aim goes from the network's past to the recorded motion: 0.8 s."""
_LEFT = torch.from_numpy(1 - smoothstep(np.arange(RETURN + 1), 0, RETURN)).float()
FARTHEST = 0.35
"""Metres: a past that is farther from the recorded one, on average over the joints, is not used."""

Predict = Callable[[Tensor, Tensor, Tensor], Tensor]
"""Noised motion of some scenes, their timesteps, and the places of these scenes → predicted clean motion."""


@dataclass(frozen=True)
class Plan:
    """The scenes of a batch that get a past of their own, drawn on the CPU.

    Attributes:
        own: (B,) bool.
        begins: (B,) the place among the sampler's timesteps where the rollout begins, from the recorded motion noised.
        ends: (B,) the place of the timestep at which the network learns; ``ends`` − ``begins`` steps are unrolled.
        cut: (B,) the first row that is learned.
    """

    own: Tensor
    begins: Tensor
    ends: Tensor
    cut: Tensor


@dataclass(frozen=True)
class Past:
    """A batch as it is trained on, once the past is made.

    Attributes:
        x: (B, K, 70) the noised motion that the network sees.
        t: (B,) its timesteps.
        past: (B, K, 70) the network's own clean motion.
        wanted: (B, K, 70) the motion to learn.
        learned: (B, K) bool, the rows that are learned; the others are the past.
        used: (B,) bool, the scenes whose past is the network's own.
    """

    x: Tensor
    t: Tensor
    past: Tensor
    wanted: Tensor
    learned: Tensor
    used: Tensor


def plan(rows: Tensor, *, share: float, steps: int, rollout: int, generator: torch.Generator) -> Plan:
    """Draws which scenes get a past of their own.

    Args:
        rows: (B,) real rows of each scene.
        share: probability of a past of its own.
        steps: timesteps of the sampler.
        rollout: steps that are unrolled at most.
    """
    size = len(rows)
    draw = torch.rand(size, 4, generator=generator)
    room = rows - (1 + LEAD) - SHORTEST
    own = (draw[:, 0] < share) & (room >= 0)
    ends = 1 + (draw[:, 1] * (steps - 1)).long()
    unrolled = 1 + (draw[:, 2] * ends.clamp_max(rollout)).long()
    cut = 1 + LEAD + (draw[:, 3] * (room.clamp_min(0) + 1)).long()
    return Plan(own, ends - unrolled, ends, cut)


def return_share(rows: int, cut: Tensor) -> Tensor:
    """The share of the past's distance from the recorded motion that is left in each row: cut (B,) → (B, rows, 1)."""
    since = torch.arange(rows, device=cut.device) - (cut[:, None] - 1)
    return _LEFT.to(cut.device)[since.clamp(0, RETURN)][..., None]


@torch.no_grad()
def make_past(
    predict: Predict,
    planned: Plan,
    x0: Tensor,
    recorded: tuple[Tensor, Tensor],
    schedule: NoiseSchedule,
    std: Tensor,
    *,
    steps: int,
    noise: Tensor,
) -> Past:
    """Unrolls the sampler for the planned scenes; the others keep what was drawn for them.

    Args:
        predict: the network.
        x0: (B, K, 70) recorded motion.
        recorded: noised motion (B, K, 70) and timesteps (B,) of the scenes whose past is recorded.
        std: (70,) metres of one in network space.
        noise: (B, K, 70) of the rollouts.
    """
    device = x0.device
    grid = torch.from_numpy(top_timesteps(steps, schedule.timesteps)).to(device)
    begins, ends, own, cut = (v.to(device) for v in (planned.begins, planned.ends, planned.own, planned.cut))
    x = schedule.q_sample(x0, grid[begins], noise)
    past = x0.clone()
    for level in range(steps - 1):
        active = planned.own & (planned.begins <= level) & (level < planned.ends)
        places = active.nonzero()[:, 0].to(device)
        if not len(places):
            continue
        t = grid[level].expand(len(places))
        made = predict(x[places], t, places).float()
        past[places] = made
        x[places] = _ddim(schedule, x[places], made, grid[level], grid[level + 1])

    before = (cut - 1)[:, None, None].expand(-1, 1, FEATURES)
    off = (past - x0).gather(1, before)
    off[..., -NUM_CONTACTS:] = 0
    used = own & (_mean_distance(off[:, 0] * std) < FARTHEST)
    wanted = x0 + off * return_share(x0.shape[1], cut) * used[:, None, None]
    t = torch.where(used, grid[ends], recorded[1])
    learned = torch.arange(x0.shape[1], device=device) >= cut[:, None]
    fresh = schedule.q_sample(wanted, grid[ends], noise)
    mixed = torch.where(learned[..., None], fresh, x)
    shown = torch.where(used[:, None, None], mixed, recorded[0])
    return Past(shown, t, past, wanted, learned | ~used[:, None], used)


def _ddim(schedule: NoiseSchedule, x: Tensor, made: Tensor, now: Tensor, following: Tensor) -> Tensor:
    """One DDIM step without added noise (Song et al. 2021, eq. 12)."""
    signal, spread = schedule.sqrt_alphas_cumprod, schedule.sqrt_one_minus_alphas_cumprod
    noise = (x - signal[now] * made) / spread[now]
    return signal[following] * made + spread[following] * noise


def _mean_distance(off: Tensor) -> Tensor:
    """Mean distance of the joints, metres, of differences of control points: (B, 70) → (B,)."""
    return _placed(off[:, :-NUM_CONTACTS]).norm(dim=-1).mean(-1)
