"""The reactor's own past: what a network predicted earlier takes the place of the recorded rows.

Online, row j sees the rows before it as the network left them, while training on recorded motion shows it the
recorded ones. Here the network first makes its past as it does live, by up to four DDIM steps without gradient, and
only the rows from a random one on are learned. They aim at the recorded motion, reached from where the network's own
past left off: Bengio et al. 2015, "Scheduled Sampling"; Zhao et al. 2025, "DART", section 3.2, on rollouts of motion
diffusion.

Shapes: B batch, K rows; motion in network space (B, K, 70).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor

from models.diffusion import NoiseSchedule, top_timesteps
from models.motion_tokens import FEATURES, NUM_CONTACTS
from models.regennet.compact import LEAD
from motion.smoothing import smoothstep

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
    joints = off[:, :-NUM_CONTACTS].unflatten(-1, (-1, 3))
    root, others = joints[:, :1], joints[:, 1:]
    return torch.cat([root, others + root], dim=1).norm(dim=-1).mean(-1)
