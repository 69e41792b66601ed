"""Punches, kicks and sword cuts that are dodged, taken or answered, without touching."""

from __future__ import annotations

import numpy as np

from motion.kinematics import forward_kinematics
from motion.skeleton import SMPL22
from training.corpus.compose import Motion, drift, lean
from training.corpus.library import Library, Take, pick
from training.corpus.scene import Scene
from training.corpus.stage import Rng, act, finish, oppose, pad, seconds, stride, waiting

from . import register

TIPS = {"punch": "wrist", "kick": "ankle"}


def blow(rng: Rng, library: Library, action: str, *, most: int = 2, least: int = 1) -> Take:
    """``least`` to ``most`` blows in a row."""
    for _ in range(40):
        take = library.take(rng, action)
        if least <= len(take.peaks) <= most:
            break
    return take


def _way(motion: Motion) -> np.ndarray:
    """(3,) from the first to the last root over the ground."""
    return (motion.root[-1] - motion.root[0]) * np.array([1.0, 0.0, 1.0])


def reach(take: Take) -> float:
    """Reach of the blow at its first peak, in metres in front of the attacker's first place."""
    if take.action == "slash":
        return 0.9
    joint = SMPL22.index(f"{take.side}_{TIPS[take.action]}")
    peak = take.peaks[0]
    tip = forward_kinematics(take.motion.rotations[peak], take.motion.root[peak])[joint]
    return float(np.linalg.norm((tip - take.motion.root[0])[[0, 2]]))


def pulse(frames: int, start: int, rise: int, fall: int) -> np.ndarray:
    """(frames,) 0, up to 1 within ``rise`` frames from ``start`` on, back to 0 within ``fall``; smooth."""
    t = np.arange(frames) - start
    up = 0.5 - 0.5 * np.cos(np.pi * np.clip(t / rise, 0, 1))
    down = 0.5 + 0.5 * np.cos(np.pi * np.clip((t - rise) / fall, 0, 1))
    return up * down


def recoil(rng: Rng, motion: Motion, frame: int, *, strength: float = 1.0) -> Motion:
    """The upper body is thrown back at ``frame`` and comes forward again; the hips give way a little."""
    shape = pulse(len(motion), frame, int(rng.integers(5, 8)), int(rng.integers(16, 26))) * strength
    motion = lean(motion, -shape * rng.uniform(0.5, 0.85), towards=float(rng.normal(0, 0.4)))
    back = -np.stack([np.sin(motion.headings), np.zeros(len(motion)), np.cos(motion.headings)], axis=-1)
    return drift(motion, back * shape[:, None] * rng.uniform(0.08, 0.16))


def dodge(rng: Rng, motion: Motion, frame: int) -> Motion:
    """The upper body leans out of the way around ``frame``, to one side and back."""
    shape = pulse(len(motion), max(frame - 10, 0), 10, int(rng.integers(14, 22)))
    towards = pick(rng, (-1, 1)) * rng.uniform(1.3, 2.3)
    motion = lean(motion, shape * rng.uniform(0.45, 0.7), towards=towards)
    angle = motion.headings + towards
    aside = np.stack([np.sin(angle), np.zeros(len(motion)), np.cos(angle)], axis=-1)
    return drift(
        motion, aside * shape[:, None] * rng.uniform(0.08, 0.16) - np.array([0, 0.05, 0]) * shape[:, None]
    )


def retreat(
    rng: Rng, library: Library, start: int, *, distance: tuple[float, float] = (0.6, 1.4), tail: int = 20
) -> Motion:
    """Waits, then takes some steps back from frame ``start`` on."""
    steps = stride(rng, library, "walk-back", rng.uniform(*distance))
    return act(rng, library, (max(start, 4), steps.motion), tail=tail)[0]


def _attack(
    rng: Rng, library: Library, family: str, action: str, answer: str, gap: tuple[float, float]
) -> Scene:
    take = blow(rng, library, action)
    start = seconds(rng, 0.2, 0.7)
    a, starts = act(rng, library, (start, take.motion, take.aim), tail=seconds(rng, 0.4, 0.9))
    hits = [starts[0] + peak for peak in take.peaks]
    frames = min(max(len(a), 60), 260)
    acts = {"acts": ("punch", "step-back")} if (action, answer) == ("punch", "retreat") else {}
    if answer == "retreat":
        b = retreat(rng, library, hits[0] - int(rng.integers(10, 16)))
    elif answer == "recoil":
        b = (
            retreat(rng, library, hits[-1] + 2, distance=(0.4, 1.0))
            if rng.random() < 0.5
            else waiting(rng, library, frames)
        )
    else:
        b = waiting(rng, library, frames)
    frames = min(max(len(a), len(b)), 260)
    a, b = pad(rng, library, a, frames), pad(rng, library, b, frames)
    for hit in hits:
        if answer == "dodge":
            b = dodge(rng, b, hit)
        elif answer == "recoil":
            b = recoil(rng, b, hit)
    b = oppose(rng, a, b, reach(take) + rng.uniform(*gap), aside=0.04)
    side = take.side if rng.random() < 0.6 else None
    events = {"side": {"a": take.side}} if take.side else {}
    return finish(
        rng,
        library,
        family,
        a,
        b,
        slots={"side_a": side if action != "slash" else None} | acts,
        events=events | {"facing": True},
        gaze=(0.3, 0.6),
    )


@register("punch-dodge", "punch", "dodge", relation="reply", needs=("punch", "walk-back"), weight=1.5)
def punch_dodge(rng: Rng, library: Library) -> Scene:
    """A punches, and B dodges or retreats."""
    return _attack(rng, library, "punch-dodge", "punch", pick(rng, ("dodge", "retreat")), (0.12, 0.3))


@register("punch-recoil", "punch", "flinch", relation="reply", needs=("punch", "walk-back"), weight=1.3)
def punch_recoil(rng: Rng, library: Library) -> Scene:
    """A punches, and B recoils without being touched."""
    return _attack(rng, library, "punch-recoil", "punch", "recoil", (0.12, 0.22))


@register("kick-step-back", "kick", "step-back", relation="reply", needs=("kick", "walk-back"), weight=1.5)
def kick_step_back(rng: Rng, library: Library) -> Scene:
    """A kicks, and B steps back."""
    return _attack(rng, library, "kick-step-back", "kick", "retreat", (0.1, 0.45))


@register(
    "sword-retreat", "swing-sword", "step-back", relation="reply", needs=("slash", "walk-back"), weight=1.3
)
def sword_retreat(rng: Rng, library: Library) -> Scene:
    """A cuts with a sword, and B retreats."""
    return _attack(rng, library, "sword-retreat", "slash", "retreat", (0.4, 1.0))


def _exchange(rng: Rng, library: Library, family: str, action: str, distance: tuple[float, float]) -> Scene:
    """Both strike, in turn or at once."""
    frames = seconds(rng, 4, 7.5)
    people = []
    for later in (0.1, rng.uniform(0.3, 1.2)):
        start = seconds(rng, later, later + 0.4)
        bouts = [blow(rng, library, action, most=5, least=2) for _ in range(3)]
        take = max(bouts, key=lambda bout: min(len(bout), frames - start))
        stay = drift(take.motion, -np.linspace(0, 1, len(take))[:, None] * _way(take.motion))
        people.append(act(rng, library, (start, stay, take.aim))[0])
    a, b = (pad(rng, library, person, frames) for person in people)
    b = oppose(rng, a, b, rng.uniform(*distance), aside=0.05)
    return finish(rng, library, family, a, b, events={"facing": True, "distance": "keep"}, gaze=(0.2, 0.2))


@register("spar", "fight", needs=("punch",), weight=1.5)
def spar(rng: Rng, library: Library) -> Scene:
    """Two people exchange punches that miss."""
    return _exchange(rng, library, "spar", "punch", (1.0, 1.4))


@register("sword-fight", "sword-fight", needs=("slash",), weight=1.5)
def sword_fight(rng: Rng, library: Library) -> Scene:
    """Two people exchange sword cuts."""
    return _exchange(rng, library, "sword-fight", "slash", (1.5, 2.1))
