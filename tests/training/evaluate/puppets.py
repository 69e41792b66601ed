"""Toy duets from one line of stage directions each: puppets that walk, bow, sit and touch on cue.

``"gap 0.9; hands 1 2; a turn 2 3 180; a go 3 5 0 -2"``: a stands at the origin and looks along +Z, b stands
``gap`` metres ahead and looks back; times are seconds, places metres, turns degrees to the left. Arms stretch
as far as a cue asks, and feet glide: the puppets show where joints are, not how people move.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from acts.staging.poses import about, placed
from motion import FPS, SMPL22
from motion.limbs import solve_two_bones
from motion.skeleton import LEGS, SIDES
from motion.smoothing import smoothstep
from motion.vectors import unit

Array = NDArray[np.floating]

REST = SMPL22.rest_positions()
STANDING = 0.956
POSES = {"sit": (0.50, 0.30), "squat": (0.55, 0.05), "floor": (0.2, 0.5), "crouch": (0.78, 0.0)}
"""Height of the pelvis as a share of standing, and metres by which the feet are ahead."""
UPPER = [
    SMPL22.index(n) for n in SMPL22.joint_names if not any(p in n for p in ("hip", "knee", "ankle", "foot", "pelvis"))
]


class Puppet:
    """One person's tracks, one value a frame."""

    def __init__(self, seconds: float, x: float, z: float, heading: float) -> None:
        self.time = np.arange(round(seconds * FPS)) / FPS
        self.x, self.z = np.full_like(self.time, x), np.full_like(self.time, z)
        self.heading = np.full_like(self.time, heading)
        self.lean, self.hop = np.zeros_like(self.time), np.zeros_like(self.time)
        self.poses: list[tuple[str, Array]] = []
        self.arms: list[tuple[str, str, Array, Array]] = []
        self.kicks: list[tuple[str, Array]] = []

    def ramp(self, start: float, stop: float) -> Array:
        """0 before, 1 after, smooth between."""
        return smoothstep(self.time, start, max(stop, start + 1e-6))

    def span(self, start: float, stop: float, ease: float = 0.3) -> Array:
        """1 between the two times, eased over ``ease`` seconds within them."""
        rise = self.ramp(start, start + ease)
        return rise * (1 - self.ramp(stop - ease, stop)) if stop < self.time[-1] else rise

    def go(self, start: float, stop: float, x: float, z: float) -> None:
        s = np.clip((self.time - start) / (stop - start), 0, 1)
        first = int(np.searchsorted(self.time, start))
        self.x, self.z = self.x + s * (x - self.x[first]), self.z + s * (z - self.z[first])

    def walk(self, start: float, stop: float, x: float, z: float) -> None:
        first = min(int(np.searchsorted(self.time, start)), len(self.time) - 1)
        aim = np.degrees(np.arctan2(x - self.x[first], z - self.z[first]))
        off = (aim - self.heading[first] + 180) % 360 - 180
        self.turn(start - 0.5 * (abs(off) > 20), start + 0.2, off)
        self.go(start, stop, x, z)

    def turn(self, start: float, stop: float, degrees: float) -> None:
        self.heading = self.heading + degrees * self.ramp(start, stop)

    def circle(self, other: Puppet, start: float, stop: float, degrees: float) -> None:
        first = int(np.searchsorted(self.time, start))
        dx, dz = self.x[first] - other.x[first], self.z[first] - other.z[first]
        s = np.clip((self.time - start) / (stop - start), 0, 1)
        angle = np.arctan2(dx, dz) + np.radians(degrees) * s
        radius = np.hypot(dx, dz)
        on = self.time >= start
        self.x = np.where(on, other.x[first] + radius * np.sin(angle), self.x)
        self.z = np.where(on, other.z[first] + radius * np.cos(angle), self.z)
        self.heading = self.heading + degrees * s

    def body(self) -> Array:
        """(T, 22, 3) the body in the world, arms hanging."""
        count = len(self.time)
        local = np.repeat(REST[None], count, axis=0)
        for i, side in enumerate(SIDES):
            shoulder = local[:, SMPL22.index(f"{side}_shoulder")]
            out = 0.03 * (1 - 2 * i)
            local[:, SMPL22.index(f"{side}_elbow")] = shoulder + np.array([out, -0.26, 0.0])
            local[:, SMPL22.index(f"{side}_wrist")] = shoulder + np.array([2 * out, -0.51, 0.05])
        share, ahead, kneel, lie = np.ones(count), np.zeros(count), np.zeros(count), np.zeros(count)
        for name, weight in self.poses:
            if name == "kneel":
                share, kneel = share + weight * (0.55 - share), np.maximum(kneel, weight)
            elif name == "lie":
                lie = np.maximum(lie, weight)
            else:
                height, forward = POSES[name]
                share, ahead = share + weight * (height - share), ahead + weight * forward
        local[:, UPPER] = local[:, UPPER] @ np.swapaxes(about(0, np.radians(self.lean)), 1, 2)
        local[:, :, 1] += (share * STANDING)[:, None]
        for side in SIDES:
            hip, knee, ankle, foot = (SMPL22.index(f"{side}_{n}") for n in ("hip", "knee", "ankle", "foot"))
            local[:, ankle] = np.stack([local[:, hip, 0], np.full(count, 0.06), ahead], axis=-1)
            down = kneel[:, None]
            local[:, ankle] += down * np.array([0, 0.02, -0.42])
            for kicked, weight in self.kicks:
                if kicked == side:
                    local[:, ankle] += weight[:, None] * [0, 0.6, 0.75]
            straight = _knee(local[:, hip], local[:, ankle])
            kneeling = local[:, hip] * [1, 0, 1] + [0, 0.06, 0.05]
            local[:, knee] = straight + down * (kneeling - straight)
            local[:, foot] = local[:, ankle] + [0, -0.05, 0.13] * (1 - down) + down * [0, -0.05, -0.1]
        flat = np.stack([local[..., 0], 0.12 - local[..., 2], local[..., 1] - STANDING], axis=-1)
        local = local + lie[:, None, None] * (flat - local)
        local[..., 1] += self.hop[:, None]
        return placed(local, np.stack([self.x, self.z], axis=-1), np.radians(self.heading))


def _knee(hip: Array, ankle: Array) -> Array:
    """Where the knee is, bent forward, for bones of fixed length (straight where the leg is too short)."""
    thigh, shin = SMPL22.bone_lengths[list(LEGS[0][1:3])]
    way = unit(ankle - hip)
    return solve_two_bones(hip, hip + thigh * way, hip + (thigh + shin) * way, ankle, np.array([0.0, 0.0, 1.0]))[0]


def play(script: str, seconds: float) -> Array:
    """(2, T, 22, 3) what a line of stage directions says."""
    cues = [cue.split() for cue in script.split(";") if cue.strip()]
    gap = next((float(cue[1]) for cue in cues if cue[0] == "gap"), 1.5)
    people = {"a": Puppet(seconds, 0.0, 0.0, 0.0), "b": Puppet(seconds, 0.0, gap, 180.0)}
    for cue in cues:
        if cue[0] in people:
            _direct(people[cue[0]], people["b" if cue[0] == "a" else "a"], cue[1], cue[2:])
    bodies = {name: puppet.body() for name, puppet in people.items()}
    return _with_arms(people, bodies, [cue for cue in cues if cue[0] in ("hands", "hands2", "hug")])


def _direct(me: Puppet, other: Puppet, verb: str, words: list[str]) -> None:
    numbers = [float(word) for word in words if word.lstrip("-").replace(".", "", 1).isdigit()]
    text = [word for word in words if word not in POSES and word[0].isalpha()]
    t0, t1, *rest = [*numbers, numbers[0]] if len(numbers) == 1 else numbers
    if verb == "at":
        me.x[:], me.z[:], me.heading[:] = numbers
    elif verb in ("go", "walk"):
        getattr(me, verb)(t0, t1, *rest)
    elif verb == "turn":
        me.turn(t0, t1, *rest)
    elif verb == "circle":
        me.circle(other, t0, t1, *rest)
    elif verb == "bow":
        me.lean = me.lean + (rest[0] if rest else 60.0) * me.span(t0, t1, 0.4)
    elif verb == "jump":
        s = np.clip((me.time - t0) / 0.5, 0, 1)
        me.hop = me.hop + 4 * 0.3 * s * (1 - s)
    elif verb == "pose":
        me.poses.append((words[2], me.span(t0, t1, 0.6)))
    elif verb == "kick":
        me.kicks.append((text[0], me.span(t0, t0 + 0.6)))
    else:
        me.arms.append(
            (
                verb,
                text[0] if text else "both",
                me.span(t0, t1, 0.12 if verb == "strike" else 0.3),
                np.array([SMPL22.index(word) for word in text[1:] if verb == "on"]),
            )
        )


def _with_arms(people: dict[str, Puppet], bodies: dict[str, Array], shared: list[list[str]]) -> Array:
    still = {name: body.copy() for name, body in bodies.items()}
    cues = [(name, *arm) for name, me in people.items() for arm in me.arms]
    # Hands that are laid on somebody come last: the other's arm must be in its place.
    for name, verb, which, weight, joint in sorted(cues, key=lambda cue: cue[1] == "on"):
        me, other = people[name], "b" if name == "a" else "a"
        for side in SIDES if which == "both" else (which,):
            shoulder = still[name][:, SMPL22.index(f"{side}_shoulder")]
            if verb == "on":
                goal = bodies[other][:, joint[0]]
            elif verb == "point":
                line = still[other][:, SMPL22.index("spine3")] - shoulder
                goal = shoulder + 0.5 * line / np.linalg.norm(line, axis=-1, keepdims=True)
            else:
                turned = placed(_gesture(verb, side, me.time)[:, None], np.zeros(2), np.radians(me.heading))
                goal = shoulder + turned[:, 0]
            _arm(bodies[name], side, goal, weight)
    for cue in shared:
        weight = people["a"].span(float(cue[1]), float(cue[2]))
        sides, rise = cue[3:5] or ["right", "right"], float(cue[5]) if len(cue) > 5 else -0.2
        pairs = [tuple(sides)] if cue[0] == "hands" else [("left", "right"), ("right", "left")]
        for pair in pairs:
            shoulders = [
                still[name][:, SMPL22.index(f"{side}_shoulder")] for name, side in zip("ab", pair, strict=True)
            ]
            for name, other, side in (("a", "b", pair[0]), ("b", "a", pair[1])):
                hug = still[other][:, SMPL22.index("spine2")]
                goal = hug if cue[0] == "hug" else np.mean(shoulders, axis=0) + np.array([0, rise, 0])
                _arm(bodies[name], side, goal, weight)
    return np.stack([bodies["a"], bodies["b"]])


def _gesture(verb: str, side: str, time: Array) -> Array:
    """(T, 3) where a wrist is from its shoulder in the body's frame."""
    out = 1.0 if side == "left" else -1.0
    swing = np.sin(2 * np.pi * 1.5 * time)
    middle, sway = {
        "up": ((0.05 * out, 0.45, 0.05), (0.0, 0.0, 0.0)),
        "phone": ((-0.05 * out, 0.12, 0.08), (0.0, 0.0, 0.0)),
        "wave": ((0.1 * out, 0.25, 0.15), (0.15, 0.0, 0.0)),
        "beckon": ((0.0, -0.1, 0.3), (0.0, 0.1, 0.1)),
        "talk": ((-0.05 * out, -0.2, 0.25), (0.1, 0.06, 0.08)),
        "reach": ((-0.05 * out, -0.25, 0.42), (0.0, 0.0, 0.0)),
        "strike": ((-0.1 * out, -0.05, 0.5), (0.0, 0.0, 0.0)),
        "clap": ((-0.12 * out, -0.2, 0.3), (0.1 * out, 0.0, 0.0)),
    }[verb]
    return np.array(middle) + swing[:, None] * np.array(sway)


def _arm(body: Array, side: str, goal: Array, weight: Array) -> None:
    shoulder, elbow, wrist = (SMPL22.index(f"{side}_{n}") for n in ("shoulder", "elbow", "wrist"))
    body[:, wrist] += weight[:, None] * (goal - body[:, wrist])
    bent = (body[:, shoulder] + body[:, wrist]) / 2 - [0, 0.05, 0]
    body[:, elbow] += weight[:, None] * (bent - body[:, elbow])
