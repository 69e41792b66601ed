"""Blows that land: a fist on the trunk or a shoulder, a foot in the belly."""

from __future__ import annotations

import numpy as np

from motion.kinematics import forward_kinematics
from motion.skeleton import LEGS, SMPL22
from motion.vectors import wrapped

from ..compose import Motion
from ..contact import axes, envelope, impulse, lean_to, nod, on_body, reach_arm, shift_hips, towards
from ..feet import two_bone
from ..library import Library, pick
from ..scene import Scene
from ..stage import Rng, act, beside, forward, pad, seconds, stride
from ..touches import opposite
from . import register
from .combat import blow
from .meeting import Encounter, conclude


def _tip(side: str, family: str) -> int:
    return SMPL22.index(f"{side}_{'wrist' if family == 'punch' else 'ankle'}")


def _blow_lands(motion: Motion, about_frame: int, side: str, family: str) -> tuple[int, float, float]:
    """The frame near ``about_frame`` at which a blow reaches furthest, its heading and reach in metres."""
    near = np.arange(max(about_frame - 18, 9), min(about_frame + 6, len(motion) - 12))
    body = forward_kinematics(motion.rotations[near], motion.root[near])
    tip = body[:, _tip(side, family)]
    if family == "punch":
        extent = np.linalg.norm(tip - body[:, SMPL22.index(f"{side}_shoulder")], axis=-1)
    else:
        extent = np.linalg.norm((tip - body[:, 0])[:, [0, 2]], axis=-1) + 0.5 * tip[:, 1]
    best = int(extent.argmax())
    hit = int(near[best])
    step = (tip[best] - motion.root[hit - 8])[[0, 2]]
    return hit, float(np.arctan2(*step)), float(np.linalg.norm(step))


def _strike(rng: Rng, library: Library, family: str) -> Scene:
    take = blow(rng, library, family, most=1)
    start, tail, aim = seconds(rng, 0.2, 0.7), seconds(rng, 0.5, 1.0), take.aim
    for _ in range(2):  # the first round measures which way the blow goes, the second turns it straight ahead
        a, starts = act(rng, library, (start, take.motion, aim), tail=tail)
        hit, ahead, gap = _blow_lands(a, starts[0] + take.peaks[0], take.side or "right", family)
        aim += wrapped(ahead - forward(a, 0)[1])
    b = library.idle(rng, hit + 30)
    if rng.random() < 0.75:
        steps = stride(rng, library, "walk-back", rng.uniform(0.4, 1.1)).motion
        b, _ = act(rng, library, (0, b[: hit + 12]), (None, steps), tail=20)
    frames = min(max(len(a), len(b)), 240)
    a, b = pad(rng, library, a, frames), pad(rng, library, b, frames)
    # b stands where the blow ends: the trunk's front at the fist, or the belly at the foot.
    gap += rng.uniform(0.02, 0.07) if family == "punch" else rng.uniform(0.07, 0.13)
    origin = a.root[hit - 8, [0, 2]]
    b = beside(b, origin, ahead, gap, 0.0, np.pi + rng.normal(0, 0.1), frame=hit)
    tip_joint = _tip(take.side or "right", family)
    meet = Encounter(a, b, hit - 2, hit + 4, {}, {"facing": True})
    pa, pb = meet.bodies(gaze=(0.3, 0.7))
    line = towards(pa[:, 0], pb[:, 0])
    weight = envelope(frames, hit - 9, hit, hit + 1, hit + 10)
    if family == "punch":
        aim = pick(rng, (("spine3", 0.0, 0.05, 0.1), (f"{opposite(take.side)}_shoulder", 0.0, 0.0, 0.06)))
        pa = reach_arm(pa, take.side, on_body(pb, *aim) - 0.02 * line, weight, elbow=(0.7, -0.5, -0.2))
        joint, target, sign = "wrist", aim[0], 1.0
    else:
        height = float(np.clip(pa[hit, tip_joint, 1], 0.85, 1.2))
        goal = on_body(pb, "spine1", 0.0, 0.0, 0.13)
        goal[:, 1] = height
        leg = LEGS[0 if take.side == "left" else 1]
        hip, knee, ankle, toe = leg
        wanted = pa[:, ankle] * (1 - weight[:, None]) + goal * weight[:, None]
        moved = pa.copy()
        moved[:, knee], moved[:, ankle] = two_bone(pa[:, hip], pa[:, knee], pa[:, ankle], wanted, axes(pa)[1])
        moved[:, toe] += moved[:, ankle] - pa[:, ankle]
        pa = np.where(weight[:, None, None] > 0, moved, pa)
        joint, target, sign = "ankle", "spine1", -0.6
    give = impulse(frames, hit - 1, rise=6, fall=int(rng.integers(20, 30)))
    pb = shift_hips(pb, line * (give * rng.uniform(0.04, 0.08))[:, None])
    pb = lean_to(pb, line * sign, give * rng.uniform(0.3, 0.5))
    pb = nod(pb, give * rng.uniform(0.1, 0.3))
    named = take.side if rng.random() < 0.65 else None
    return conclude(
        library,
        family,
        meet,
        pa,
        pb,
        touches=[(f"{take.side}_{joint}", target, hit - 1, hit + 1)],
        side=named,
    )


@register(
    "punch",
    "punch",
    "flinch",
    relation="reply",
    needs=("punch", "idle", "walk-back"),
    weight=1.5,
    contact=True,
)
def punch(rng: Rng, library: Library) -> Scene:
    """A punches B, who is hit."""
    return _strike(rng, library, "punch")


@register(
    "kick", "kick", "flinch", relation="reply", needs=("kick", "idle", "walk-back"), weight=1.5, contact=True
)
def kick(rng: Rng, library: Library) -> Scene:
    """A kicks B, who is hit."""
    return _strike(rng, library, "kick")
