"""What one person does alone, at any place on the stage: what recordings show, and gestures of people who stand."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from acts.staging.gestures import GESTURES, Stroke
from motion import FPS
from motion.kinematics import forward_kinematics
from motion.skeleton import SIDES, SMPL22
from motion.smoothing import smoothstep
from motion.vectors import FLAT, unit

from ..compose import ARMS, Array, Motion, join, layer, looped
from ..contact import UP, axes, bend, envelope, impulse, lean_to, nod, on_body, reach_arm, shift_hips
from ..library import Library, Take, pick
from ..touches import Touched
from .play import Done, Effect, Make, Option, Play, Rng

HEAD = SMPL22.index("head")
UPPER = (*ARMS["left"], *ARMS["right"])


def one_of(play: Play, actions: Sequence[str]) -> str:
    """One of some source actions that are there."""
    return pick(play.rng, [name for name in actions if play.library.has(name)])


def taken(*actions: str, frames: tuple[int, int] = (50, 100), side: str | None = None, one: bool = False) -> Make:
    """An act that is one clip of one of some actions; with ``one``, of one hand."""

    def make(play: Play, i: int) -> Done:
        person, rng, action = play.people[i], play.rng, one_of(play, actions)
        own = side or (pick(rng, SIDES) if one else None)
        styles = play.library.styles(action)
        style = person.style if person.style in styles and rng.random() < 0.7 else pick(rng, styles)
        length = (frames[0], max(frames[0] + 15, int(0.72 * frames[1]))) if play.brisk else frames
        return person.perform(play.library.take(rng, action, side=own, style=style, frames=length))

    return make


@dataclass(frozen=True)
class Part:
    """A clip of a chain.

    Attributes:
        action: what it is a recording of; of several, with spaces between them, one that is there.
        skip, cut: frames that are left out at its beginning and at its end.
        times: how often it is played, at least and at most, for a clip that ends as it begins.
        lasts: seconds of a stretch of a clip that goes on and on; the person stays about where they began.
        rests: seconds for which its last pose is held.
    """

    action: str
    skip: int = 0
    cut: int = 0
    times: tuple[float, float] | None = None
    lasts: tuple[float, float] | None = None
    rests: tuple[float, float] | None = None

    def drawn(self, play: Play, side: str | None) -> list[Motion]:
        """A performance, and the rest after it."""
        rng, action = play.rng, one_of(play, self.action.split())
        motion = play.library.take(rng, action, side=side, frames=(1, 10_000 if self.lasts else 400)).motion
        motion = motion[self.skip : len(motion) - self.cut]
        if self.times:
            motion = looped(motion, motion, int(len(motion) * rng.uniform(*self.times)), blend=6)
        if self.lasts:
            frames = play.seconds(*self.lasts)
            motion = looped(motion, motion, frames, blend=6)
            at = int(rng.integers(0, len(motion) - frames + 1))
            motion = motion[at : at + frames]
            way = (motion.root[-1] - motion.root[0]) * FLAT
            if np.linalg.norm(way) > 0.8:
                motion = replace(motion, root=motion.root - np.linspace(0, 0.7, len(motion))[:, None] * way)
        if not self.rests:
            return [motion]
        last = [len(motion) - 1] * play.seconds(*self.rests)
        return [motion, Motion(motion.rotations[last], motion.root[last], motion.sources)]


def chain(*parts: Part, blend: int = 12, one_sided: bool = False) -> Make:
    """An act of clips after one another; ``one_sided``: all mirrored or none, so that legs go on."""

    def make(play: Play, i: int) -> Done:
        side = pick(play.rng, SIDES) if one_sided else None
        first, *more = (motion for part in parts for motion in part.drawn(play, side))
        for motion in more:
            first = join(first, motion, blend=blend)
        return play.people[i].perform(Take(first, "", "normal"))

    return make


def bow(play: Play, i: int) -> Done:
    """Person i bows; where the recording hardly does, the spine bends as much further as needed."""
    done = taken("bow")(play, i)
    drop = play.rng.uniform(0.27, 0.42)

    def effect(rng: Rng, own: Array, other: Array) -> Touched:
        height = own[:, HEAD, 1]
        fallen = height[: max(len(own) // 8, 1)].mean() - height
        if fallen.max() < 0.04:
            raise LookupError("a bow that is none")
        weight, (_, ahead) = smoothstep(fallen / fallen.max()), axes(own)
        angle = float(np.clip((drop - fallen.max()) / 0.5, 0.0, 1.25)) * weight
        return lean_to(shift_hips(own, -0.09 * angle[:, None] * ahead), ahead, angle), other, []

    play.effect(done.start, done.stop, effect, i=i)
    return done


SPOKEN = ("guide", "respond", "talking")
"""Source actions of people who talk with their hands."""


def spin(play: Play, i: int) -> Done:
    """A full turn on the spot."""
    person = play.people[i]
    start = len(person)
    person.hold(play.seconds(1.5, 2.2), turn=2 * np.pi * pick(play.rng, (-1, 1)))
    return Done(start, len(person))


def turn_away(play: Play, i: int) -> Done:
    """Turns the back on the other."""
    person = play.people[i]
    start = len(person)
    person.turn(pick(play.rng, (-1, 1)) * play.rng.uniform(2.2, 3.1))
    play.look(i, start, len(person) + 40, 0.0)
    return Done(start, len(person))


def turn_to(play: Play, i: int) -> Done:
    """Turns to the other."""
    person = play.people[i]
    start = len(person)
    person.turn(play.off(i))
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


def wave(play: Play, i: int) -> Done:
    """Person i waves with one hand, or goodbye as the recording has it."""
    bye = play.library.has("bye") and play.rng.random() < 0.33
    return taken("bye" if bye else "wave", one=not bye)(play, i)


def raise_arm(play: Play, i: int) -> Done:
    """Person i raises one hand or both."""
    both = play.rng.random() < 0.38
    return taken("raise-hand", frames=(40, 80), side="both" if both else None, one=not both)(play, i)


def arms_over(
    library: Library, rng: Rng, base: Motion, action: str, start: int, side: str | None, *, most: int = 100
) -> tuple[Motion, Take]:
    """Arms of a gesture of about ``most`` frames over a motion that goes on: who waves while walking."""
    take = library.take(rng, action, side=side, frames=(40, max(most, 45)))
    return layer(base, take.motion, start=start, joints=UPPER, blend=10), take


# ---- acts that are laid over a person who stands ------------------------------------------------------------


Change = Callable[[Rng, Array, Array, Array, Sequence[str]], Array]
"""A person's positions from (rng, own, other's, weight (T,), hands)."""


def standing(change: Change, low: float, high: float, *, hands: int = 0) -> Make:
    """An act of a person who stands for ``low`` to ``high`` seconds, with no hand, one or both."""

    def make(play: Play, i: int) -> Done:
        sides = SIDES if hands == 2 else (pick(play.rng, SIDES),)
        person = play.people[i]
        start = len(person)
        person.hold(play.seconds(low, high))

        def effect(rng: Rng, own: Array, other: Array) -> Touched:
            weight = envelope(len(own), 0, 16, len(own) - 18, len(own) - 1)
            return change(rng, own, other, weight, sides), other, []

        play.effect(start, len(person), effect, i=i)
        return Done(start, len(person), (None, sides[0], "both")[hands])

    return make


def _nods(rng: Rng, own: Array, other: Array, weight: Array, sides: Sequence[str]) -> Array:
    phase = 2 * np.pi * rng.uniform(1.1, 1.7) * np.arange(len(own)) / FPS
    return nod(own, weight * rng.uniform(0.25, 0.42) * (0.5 - 0.5 * np.cos(phase)))


def _shakes_head(rng: Rng, own: Array, other: Array, weight: Array, sides: Sequence[str]) -> Array:
    """The face shows in the shoulders' small counter-turn."""
    phase = 2 * np.pi * rng.uniform(0.9, 1.4) * np.arange(len(own)) / FPS
    swing = (weight * rng.uniform(0.4, 0.6) * np.sin(phase))[:, None]
    own = bend(own, 0.3 * swing * UP)
    return bend(own, swing * 0.35 * axes(own)[1], joints=(SMPL22.index("neck"),))


def _moves_hands(stroke: Stroke, towards: float = 0.0) -> Change:
    """The hands go along a stroke, and ``towards`` the other by metres."""

    def change(rng: Rng, own: Array, other: Array, weight: Array, sides: Sequence[str]) -> Array:
        seconds, off = np.arange(len(own)) / FPS * rng.uniform(0.85, 1.2), rng.normal(0, 0.015, 3)
        for side in sides:
            way = stroke.way(1.0 if side == "left" else -1.0, seconds) + off
            goal = on_body(own, f"{side}_shoulder" if stroke.from_shoulder else "pelvis", *way.T)
            goal = goal + towards * unit(other[:, 0] + 0.25 * UP - own[:, ARMS[side][1]])
            own = reach_arm(own, side, goal, weight, elbow=stroke.pole)
        return own

    return change


def gesture(name: str, low: float, high: float, *, hands: int = 1) -> Make:
    """A gesture of :data:`acts.staging.gestures.GESTURES` by a person who stands."""
    return standing(_moves_hands(GESTURES[name], 0.5 * (name == "points")), low, high, hands=hands)


_SHRUG = Stroke(at=(0.26, -0.2, 0.22), from_shoulder=True)


# ---- punches, kicks and sword cuts of recordings, and how a body gives way to them ---------------


TIPS = {"punch": "wrist", "kick": "ankle"}


def strike(action: str) -> Make:
    """One or two blows in the air."""

    def make(play: Play, i: int) -> Done:
        take = play.library.take(play.rng, action)
        return play.people[i].perform(take, aim=take.aim)

    return make


def shadow_box(play: Play, i: int) -> Done:
    """Punches the air: one or two blows, or a boxer's or a karateka's practice."""
    practice = play.library.has("shadow-box") and play.rng.random() < 0.6
    return (chain(Part("shadow-box", lasts=(1.8, 3.2))) if practice else strike("punch"))(play, i)


def reach(take: Take) -> float:
    """Reach of the blow at its first peak, in metres in front of the attacker's first place."""
    joint = SMPL22.index(f"{take.side}_{TIPS[take.action]}")
    peak = take.peaks[0]
    tip = forward_kinematics(take.motion.rotations[peak], take.motion.root[peak])[joint]
    return float(np.linalg.norm((tip - take.motion.root[0])[[0, 2]]))


def gives_way(frame: int, *, dodges: bool) -> Effect:
    """The upper body of the other is thrown back at a frame, or leans out of the way around it, and comes back."""

    def effect(rng: Rng, striker: Array, own: Array) -> Touched:
        rise = 10 if dodges else int(rng.integers(5, 8))
        shape = impulse(len(own), max(frame - rise * dodges, 0), rise=rise, fall=int(rng.integers(15, 25)))
        angle = pick(rng, (-1, 1)) * rng.uniform(1.3, 2.3) if dodges else np.pi + rng.normal(0, 0.4)
        left, ahead = axes(own)
        way = np.cos(angle) * ahead + np.sin(angle) * left
        own = shift_hips(own, way * shape[:, None] * rng.uniform(0.08, 0.16))
        return striker, lean_to(own, way, shape * rng.uniform(0.45, 0.8)), []

    return effect


def _act(make: Make, needs: tuple[str, ...], weight: float, room: float = 0.9) -> Option:
    """An act that needs so many metres free in front."""
    return Option(make, needs, weight, (room, 5.0))


def listed(given: Mapping[str, Any]) -> Option:
    """An act as ``acts.toml`` has it: of a clip, of a gesture or of a chain of clips."""
    known = dict(given)
    how = {name: known.pop(name) for name in ("weight", "room") if name in known}
    if "gesture" in known:
        return _act(gesture(known["gesture"], *known["seconds"], hands=known.get("hands", 1)), ("idle",), **how)
    if "action" in known:
        actions = known["action"].split()
        return _act(taken(*actions, frames=tuple(known["frames"])), (actions[0],), **how)
    parts = [Part(**part) for part in known.pop("parts")]
    return _act(chain(*parts, **known), tuple(part.action.split()[0] for part in parts), **how)


ACTS: dict[str, Option] = {
    "wave": _act(wave, ("wave",), 4.5),
    "bow": _act(bow, ("bow",), 3.0),
    "raise-arm": _act(raise_arm, ("raise-hand",), 3.2),
    "nod": _act(standing(_nods, 1.2, 2.0), ("idle",), 2.0),
    "shake-head": _act(standing(_shakes_head, 1.3, 2.0), ("idle",), 1.5),
    "shrug": _act(standing(_moves_hands(_SHRUG), 1.2, 1.8, hands=2), ("idle",), 1.2),
    "spin": _act(spin, ("idle",), 1.5),
    "turn-away": Option(turn_away, ("idle",), 2.0, (0.0, np.inf), (0.0, 0.9)),
    "turn-to": Option(turn_to, ("idle",), 9.0, (0.0, np.inf), (1.6, np.pi)),
    "step-back": Option(lambda play, i: play.back_off(i, 0.4, 0.9), ("walk-back",), 2.5, (0.0, 2.4)),
    "look-around": _act(look_around, ("idle",), 1.0),
    "shadow-box": _act(shadow_box, ("punch",), 1.4, 1.7),
    "kick-air:leg": _act(strike("kick"), ("kick",), 1.2, 1.7),
    "swing-sword": _act(strike("slash"), ("slash",), 0.6, 1.9),
    **{
        cue: listed(given)
        for cue, given in tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8")).items()
    },
}
"""What one person does alone, by its cue."""
