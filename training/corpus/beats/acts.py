"""Acts of one person alone, at any place on the stage: gestures, jumps, sitting, falling, dancing."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from motion.kinematics import forward_kinematics
from motion.skeleton import SMPL22
from motion.smoothing import smoothstep

from ..compose import ARMS, Array, Motion, drift, layer, lean
from ..contact import UP, axes, bend, envelope, impulse, nod, on_body, reach_arm
from ..library import Library, Take, pick
from ..touches import Touches
from .play import Act, Done, Make, Play, Rng
from .whole import WHOLE, part_of, perform, taken

HEAD = SMPL22.index("head")
UPPER = (*ARMS["left"], *ARMS["right"])


def deepened(motion: Motion, drop: float) -> Motion:
    """A bow whose head comes down by ``drop`` metres at least: the spine bends as much further as needed."""
    height = forward_kinematics(motion.rotations, motion.root)[:, HEAD, 1]
    fallen = height[: max(len(height) // 8, 1)].mean() - height
    if fallen.max() < 0.04:
        raise LookupError("a bow that is none")
    if fallen.max() >= drop:
        return motion
    weight = smoothstep(fallen / fallen.max())
    angle = 0.0
    bent = motion
    for _ in range(6):
        lacking = drop - (height.max() - forward_kinematics(bent.rotations, bent.root)[:, HEAD, 1].min())
        if lacking < 0.01:
            break
        angle = min(angle + lacking / 0.45, 1.25)
        bent = lean(motion, angle * weight)
        back = np.stack([np.sin(motion.headings), np.zeros(len(motion)), np.cos(motion.headings)], axis=-1)
        bent = drift(bent, -0.09 * angle * weight[:, None] * back)
    return bent


def bow(play: Play, i: int) -> Done:
    """Person i bows."""
    take = play.library.take(play.rng, "bow", frames=(50, 72 if play.brisk else 100))
    return perform(play, i, Take(deepened(take.motion, play.rng.uniform(0.27, 0.42)), "bow", take.style))


def spoken(play: Play) -> list[str]:
    """Source actions of people who talk with their hands."""
    return [name for name in ("guide", "respond", "talking") if play.library.has(name)]


def talk(play: Play, i: int) -> Done:
    """Talks with the hands."""
    return taken(pick(play.rng, spoken(play)), (50, 100))(play, i)


def dance(play: Play, i: int) -> Done:
    """Person i dances."""
    rng = play.rng
    action = pick(rng, [n for n in ("dance", "dance-show", "ballet") if play.library.has(n)])
    clip = play.library.take(rng, action).motion
    frames = min(play.seconds(2.5, 4.0), len(clip))
    at = int(rng.integers(0, len(clip) - frames + 1))
    motion = clip[at : at + frames]
    if action != "dance":
        way = (motion.root[-1] - motion.root[0]) * np.array([1.0, 0.0, 1.0])
        if np.linalg.norm(way) > 0.8:  # it stays about where it began
            motion = drift(motion, -np.linspace(0, 0.7, len(motion))[:, None] * way)
    start, stop = play.people[i].perform(motion)
    return Done(start, stop)


def spin(play: Play, i: int) -> Done:
    """A full turn on the spot."""
    person = play.people[i]
    start = len(person)
    person.hold(play.seconds(1.5, 2.2), turn=2 * np.pi * pick(play.rng, (-1, 1)))
    return Done(start, len(person))


def look_around(play: Play, i: int) -> Done:
    """Person i looks around."""
    person, rng = play.people[i], play.rng
    start = len(person)
    angle = pick(rng, (-1, 1)) * rng.uniform(0.5, 0.9)
    for turn in (angle, -2 * angle, angle):
        person.hold(int(12 + 10 * abs(turn)), turn=turn)
    play.look(i, start, len(person), 0.0)
    return Done(start, len(person))


# ---- acts that are laid over a person who stands ------------------------------------------------------------


def _alone(change: Callable[[Array], Array]) -> Callable[[Array, Array], tuple[Array, Array, Touches]]:
    return lambda own, other: (change(own), other, [])


def _standing(play: Play, i: int, low: float, high: float) -> tuple[int, int]:
    person = play.people[i]
    start = len(person)
    person.hold(play.seconds(low, high))
    return start, len(person)


def nodding(play: Play, i: int) -> Done:
    """Person i nods."""
    rng = play.rng
    start, stop = _standing(play, i, 1.2, 2.0)
    hertz, size = rng.uniform(1.1, 1.7), rng.uniform(0.25, 0.42)

    def change(body: Array) -> Array:
        time = np.arange(len(body)) / 30
        weight = envelope(len(body), 0, 8, len(body) - 10, len(body) - 1)
        return nod(body, weight * size * (0.5 - 0.5 * np.cos(2 * np.pi * hertz * time)))

    play.effect(start, stop, _alone(change), i=i)
    return Done(start, stop)


def head_shake(play: Play, i: int) -> Done:
    """Turns the head from side to side; the face shows in the shoulders' small counter-turn."""
    rng = play.rng
    start, stop = _standing(play, i, 1.3, 2.0)
    hertz, size = rng.uniform(0.9, 1.4), rng.uniform(0.4, 0.6)

    def change(body: Array) -> Array:
        time = np.arange(len(body)) / 30
        weight = envelope(len(body), 0, 8, len(body) - 12, len(body) - 1)
        swing = (weight * size * np.sin(2 * np.pi * hertz * time))[:, None]
        _, forward = axes(body)
        body = bend(body, 0.3 * swing * UP)
        return bend(body, swing * 0.35 * forward, joints=(SMPL22.index("neck"),))

    play.effect(start, stop, _alone(change), i=i)
    play.look(i, start, stop, 0.4)
    return Done(start, stop)


def clap(play: Play, i: int) -> Done:
    """Person i claps."""
    rng = play.rng
    start, stop = _standing(play, i, 1.6, 2.6)
    hertz, wide, height = rng.uniform(2.0, 3.0), rng.uniform(0.1, 0.16), rng.uniform(-0.02, 0.12)

    def change(body: Array) -> Array:
        time = np.arange(len(body)) / 30
        weight = envelope(len(body), 0, 16, len(body) - 18, len(body) - 1)
        gap = 0.035 + wide * (0.5 + 0.5 * np.cos(2 * np.pi * hertz * time))
        left, _ = axes(body)
        middle = on_body(body, "spine3", 0.0, height, 0.33)
        for side, sign in (("left", 1.0), ("right", -1.0)):
            body = reach_arm(body, side, middle + sign * gap[:, None] * left, weight, elbow=(0.9, -0.7, -0.1))
        return body

    play.effect(start, stop, _alone(change), i=i)
    return Done(start, stop, "both")


def _pose(targets: Callable[[Array, str], Array], low: float, high: float, *, both: bool = True) -> Make:
    """An act of hands held at a place on the own body for a while."""

    def make(play: Play, i: int) -> Done:
        rng = play.rng
        start, stop = _standing(play, i, low, high)
        sides = ("left", "right") if both else (pick(rng, ("left", "right")),)

        def change(body: Array) -> Array:
            weight = envelope(len(body), 0, 18, len(body) - 20, len(body) - 1)
            for side in sides:
                body = reach_arm(body, side, targets(body, side), weight, elbow=(1.0, -0.4, -0.1))
            return body

        play.effect(start, stop, _alone(change), i=i)
        return Done(start, stop, "both" if both else sides[0])

    return make


def _out(side: str) -> float:
    return 1.0 if side == "left" else -1.0


hands_on_hips = _pose(lambda body, side: on_body(body, "pelvis", 0.2 * _out(side), 0.12, 0.03), 1.5, 2.8)
cover_face = _pose(lambda body, side: on_body(body, "head", 0.05 * _out(side), 0.0, 0.14), 1.4, 2.4)
fold_arms = _pose(
    lambda body, side: on_body(body, "spine2", -0.12 * _out(side), 0.1 + 0.03 * _out(side), 0.2), 1.6, 3.0
)
shrug = _pose(lambda body, side: on_body(body, f"{side}_shoulder", 0.26 * _out(side), -0.2, 0.22), 1.2, 1.8)
stop_hand = _pose(lambda body, side: on_body(body, f"{side}_shoulder", 0.0, 0.02, 0.5), 1.2, 2.0, both=False)
phone = _pose(lambda body, side: on_body(body, "head", 0.13 * _out(side), -0.02, 0.03), 1.8, 3.0, both=False)
hand_on_chest = _pose(lambda body, side: on_body(body, "spine3", 0.03 * _out(side), 0.0, 0.13), 1.3, 2.2, both=False)
open_arms = _pose(lambda body, side: on_body(body, f"{side}_shoulder", 0.38 * _out(side), -0.06, 0.24), 1.3, 2.2)


def point(play: Play, i: int) -> Done:
    """Points at the other."""
    rng = play.rng
    start, stop = _standing(play, i, 1.4, 2.4)
    side = pick(rng, ("left", "right"))

    def effect(own: Array, other: Array) -> tuple[Array, Array, Touches]:
        weight = envelope(len(own), 0, 16, len(own) - 18, len(own) - 1)
        shoulder = own[:, ARMS[side][1]]
        way = other[:, 0] + np.array([0.0, 0.25, 0.0]) - shoulder
        way = way / np.linalg.norm(way, axis=-1, keepdims=True)
        return reach_arm(own, side, shoulder + 0.56 * way, weight), other, []

    play.effect(start, stop, effect, i=i)
    return Done(start, stop, side)


def strike(action: str) -> Make:
    """One or two blows in the air."""

    def make(play: Play, i: int) -> Done:
        take = blow(play.rng, play.library, action, most=2)
        return perform(play, i, take, aim=take.aim)

    return make


def shadow_box(play: Play, i: int) -> Done:
    """Punches the air: one or two blows, or a boxer's or a karateka's practice."""
    if play.library.has("shadow-box") and play.rng.random() < 0.6:
        return part_of("shadow-box", 1.8, 3.2)(play, i)
    return strike("punch")(play, i)


def arms_over(
    library: Library, rng: Rng, base: Motion, action: str, start: int, side: str | None, *, most: int = 100
) -> tuple[Motion, Take]:
    """Arms of a gesture of about ``most`` frames over a motion that goes on: who waves while walking."""
    take = library.take(rng, action, side=side, frames=(40, max(most, 45)))
    return layer(base, take.motion, start=start, joints=UPPER, blend=10), take


def wave(play: Play, i: int) -> Done:
    """Person i waves with one hand, or goodbye as the recording has it."""
    if play.library.has("bye") and play.rng.random() < 0.33:
        return taken("bye", (50, 100))(play, i)
    return taken("wave", (50, 100), one=True)(play, i)


def raise_arm(play: Play, i: int) -> Done:
    """Person i raises one hand or both."""
    both = play.rng.random() < 0.38
    return taken("raise-hand", (40, 80), side="both" if both else None, one=not both)(play, i)


ACTS: dict[str, Act] = {
    "wave": Act(wave, ("wave",), 4.5),
    "bow": Act(bow, ("bow",), 3.0),
    "raise-arm": Act(raise_arm, ("raise-hand",), 3.2),
    "beckon": Act(taken("call", (50, 100)), ("call",), 1.0),
    "talk": Act(talk, ("guide",), 3.0),
    "point": Act(point, ("idle",), 2.0),
    "nod": Act(nodding, ("idle",), 2.0),
    "shake-head": Act(head_shake, ("idle",), 1.5),
    "clap": Act(clap, ("idle",), 2.0),
    "hands-on-hips": Act(hands_on_hips, ("idle",), 1.0),
    "cover-face": Act(cover_face, ("idle",), 1.0),
    "fold-arms": Act(fold_arms, ("idle",), 1.2),
    "shrug": Act(shrug, ("idle",), 1.2),
    "stop-hand": Act(stop_hand, ("idle",), 1.0),
    "phone": Act(phone, ("idle",), 1.0),
    "hand-on-chest": Act(hand_on_chest, ("idle",), 0.7),
    "arms-out": Act(open_arms, ("idle",), 1.0),
    "dance": Act(dance, ("dance",), 1.6, room=1.4),
    "spin": Act(spin, ("idle",), 1.5),
    "look-around": Act(look_around, ("idle",), 1.0),
    "shadow-box": Act(shadow_box, ("punch",), 1.4, room=1.7),
    "kick-air:leg": Act(strike("kick"), ("kick",), 1.2, room=1.7),
    "swing-sword": Act(strike("slash"), ("slash",), 0.6, room=1.9),
    **WHOLE,
}
"""What one person does alone, by its cue."""


# ---- punches, kicks and sword cuts of recordings, and how a body gives way to them ---------------


TIPS = {"punch": "wrist", "kick": "ankle"}


def blow(rng: Rng, library: Library, action: str, *, most: int) -> Take:
    """One to ``most`` blows in a row."""
    for _ in range(40):
        take = library.take(rng, action)
        if 1 <= len(take.peaks) <= most:
            break
    return take


def reach(take: Take) -> float:
    """Reach of the blow at its first peak, in metres in front of the attacker's first place."""
    joint = SMPL22.index(f"{take.side}_{TIPS[take.action]}")
    peak = take.peaks[0]
    tip = forward_kinematics(take.motion.rotations[peak], take.motion.root[peak])[joint]
    return float(np.linalg.norm((tip - take.motion.root[0])[[0, 2]]))


def recoil(rng: Rng, motion: Motion, frame: int) -> Motion:
    """The upper body is thrown back at ``frame`` and comes forward again; the hips give way a little."""
    shape = impulse(len(motion), frame, rise=int(rng.integers(5, 8)), fall=int(rng.integers(16, 26)))
    motion = lean(motion, -shape * rng.uniform(0.5, 0.85), towards=float(rng.normal(0, 0.4)))
    back = -np.stack([np.sin(motion.headings), np.zeros(len(motion)), np.cos(motion.headings)], axis=-1)
    return drift(motion, back * shape[:, None] * rng.uniform(0.08, 0.16))


def dodge(rng: Rng, motion: Motion, frame: int) -> Motion:
    """The upper body leans out of the way around ``frame``, to one side and back."""
    shape = impulse(len(motion), max(frame - 10, 0), rise=10, fall=int(rng.integers(14, 22)))
    towards = pick(rng, (-1, 1)) * rng.uniform(1.3, 2.3)
    motion = lean(motion, shape * rng.uniform(0.45, 0.7), towards=towards)
    angle = motion.headings + towards
    aside = np.stack([np.sin(angle), np.zeros(len(motion)), np.cos(angle)], axis=-1)
    return drift(motion, aside * shape[:, None] * rng.uniform(0.08, 0.16) - np.array([0, 0.05, 0]) * shape[:, None])
