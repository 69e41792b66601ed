"""The room of the live agent: a window with curtains behind it and a hi-fi at its side, which it goes to and uses.

The person's complaints send the agent on an errand: it walks to the thing, its hands come to it, the thing changes, and
the agent comes back. Nothing depends on a later frame of the person.

The complaints are those of Chopin's thesis (Table 5.1), as far as 22 joints tell them. The recogniser has not been
trained on them, and each is a posture that is held, so rules over the last second tell them: hands at the ears, before
the eyes, rubbing the arms, or fanning the neck. Nothing here needs torch.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from acts.things.furniture import BODIES, LEAVES, TAKES, placed_leaf
from motion import FPS, SMPL22
from motion.limbs import solve_two_bones
from motion.metrics.interaction import palms
from motion.smoothing import smoothstep
from motion.steering import Goal
from motion.things import Thing, shape
from motion.transforms import facing
from motion.vectors import FLAT, Array, heading_of

PLACES = {"window": (0.0, 2.2), "hi-fi": (2.0, 0.9)}
"""Metres from where the agent first stands, to its left and behind it, as seen by a person facing it."""
STANDS = 0.62
"""Metres before a thing at which the agent stands to use it."""
LATEST = 300
"""Frames after which the agent gives an errand up that it cannot get to."""
USES, REACHES = 60, 15
"""Frames for which hands are at a thing, and those in which they come to it and leave it."""
HANDS = {"window": (1.3, (0.16, -0.16)), "curtain": (1.4, (0.22, -0.22)), "hi-fi": (1.02, (-0.14,))}
"""Height over the floor, and metres aside of its middle, at which the hands use a thing: both hands, or the right."""
_UP = np.array([0.0, 1.0, 0.0])
FRAMES = 30
"""Frames, a second, over which a complaint must last."""
MOST = 0.85
"""Share of these frames in which it must be seen."""
AT_HEAD, APART = 0.26, 0.21
"""Metres from a palm to the joint of the head at most, and between wrists at the ears; at the eyes they are closer."""
AT_ARM, RUBS = 0.17, 0.1
"""Metres from a palm to the other upper arm at most, and metres a second at which it rubs."""
AT_NECK, FANS, TURNS = 0.4, 0.5, 3
"""Metres from a fanning palm to the neck at most, its metres a second, and its turns back in one: a guard has none."""
NOSE = (0.02, 0.1)
"""Metres from the joint of the head up and ahead to the nose."""
AT_NOSE, ASIDE, UNDER = 0.18, 0.1, 0.03
"""Metres from the wrist of a hand that holds the nose to it at most; aside at most, as it is further at the ear; and
under it at least, as a fist before the face is higher."""
STILL, LOW = 0.12, 0.1
"""Metres a second of that wrist at most, as a hand that rubs is faster, and metres of the other one under the neck."""
_SIDES = ("left", "right")


@dataclass
class Errand:
    """One complaint that the agent does something about.

    Attributes:
        complaint: what is wrong.
        frame: frames since it set out.
        used: frames since it arrived; -1 on the way.
    """

    complaint: Complaint
    frame: int = 0
    used: int = -1


class Room:
    """The things of the room and what has been done with them.

    Args:
        person: (22, 3) the person's first pose.
        agent: (22, 3) the agent's.

    Attributes:
        open: by kind how far a thing is open, or the hi-fi turned up, 0 to 1; all are open at first.
        errand: what the agent is about; None for nothing.
    """

    def __init__(self, person: Array, agent: Array) -> None:
        away = (agent[0] - person[0]) * FLAT
        length = float(np.linalg.norm(away))
        back = away / length if length > 1e-3 else np.array([0.0, 0.0, 1.0])
        left = np.cross(_UP, back)
        begin = agent[0] * FLAT
        self._places = {kind: begin + x * left + z * back for kind, (x, z) in PLACES.items()}
        fronts = {"window": -back, "hi-fi": -left}
        self._yaws = {kind: float(heading_of(front)) for kind, front in fronts.items()}
        self._fronts = fronts
        self.open = {"window": 1.0, "curtain": 1.0, "hi-fi": 1.0}
        self.errand: Errand | None = None

    def wants(self, said: Complaint) -> bool:
        """True if a complaint asks for something that has not been done."""
        return self.open[said.kind] != float(said.opens)

    def goal(self, agent: Array) -> Goal | None:
        """The place to which the agent goes on its errand; None without one.

        Args:
            agent: (22, 3) its pose as shown.
        """
        errand = self.errand
        if errand is None:
            return None
        place = self._places[BODIES.get(errand.complaint.kind, errand.complaint.kind)]
        far = float(np.linalg.norm((place - agent[0]) * FLAT))
        return Goal(place + _UP, walk=errand.used < 0 and far > STANDS)

    def step(self, agent: Array) -> Array:
        """The agent's pose (22, 3) with its hands at what it uses, a frame later."""
        errand = self.errand
        if errand is None:
            return agent
        kind = BODIES.get(errand.complaint.kind, errand.complaint.kind)
        errand.frame += 1
        way = (self._places[kind] - agent[0]) * FLAT
        far = float(np.linalg.norm(way))
        there = far <= STANDS + 0.05 and float(facing(agent) @ way) > 0.8 * far
        if errand.used < 0 and not there:
            self.errand = None if errand.frame > LATEST else errand
            return agent
        errand.used += 1
        if errand.used >= USES:
            self.errand = None
            self.open[errand.complaint.kind] = float(errand.complaint.opens)
            return agent
        if errand.used > REACHES:
            change = (1 if errand.complaint.opens else -1) / (TAKES * FPS)
            self.open[errand.complaint.kind] = float(np.clip(self.open[errand.complaint.kind] + change, 0.0, 1.0))
        share = min(errand.used, USES - errand.used) / REACHES
        return self._reaching(agent, errand.complaint.kind, float(smoothstep(share)))

    def _reaching(self, agent: Array, kind: str, share: float) -> Array:
        """The pose with its hands a share of the way to a thing."""
        body = BODIES.get(kind, kind)
        front = self._fronts[body]
        depth = float(shape(body).vertices[:, 2].max())
        height, asides = HANDS[kind]
        agent, ahead = agent.copy(), facing(agent)
        right = np.cross(front, _UP)  # of the thing, seen by a person facing it: to their left
        for side, aside in zip(("left", "right") if len(asides) == 2 else ("right",), asides, strict=True):
            shoulder, elbow, wrist = (SMPL22.index(f"{side}_{name}") for name in ("shoulder", "elbow", "wrist"))
            goal = self._places[body] + (depth + 0.06) * front + height * _UP + aside * right
            goal = agent[wrist] + share * (goal - agent[wrist])
            pole = -ahead - _UP
            agent[elbow], agent[wrist] = solve_two_bones(agent[shoulder], agent[elbow], agent[wrist], goal, pole)
        return agent

    def things(self) -> tuple[Thing, ...]:
        """All things as they are now, each with a track of one frame."""
        return tuple(thing for kind in PLACES for thing in self._now(kind))

    def _now(self, kind: str) -> Sequence[Thing]:
        place, yaw = self._places[kind], self._yaws[kind]
        body = Thing.at_rest(kind, shape(kind), place, yaw, 1)
        leaves = LEAVES.get(kind, ())
        return [body, *(placed_leaf(leaf, place, yaw, np.array([self.open[leaf.moved_by]])) for leaf in leaves)]


@dataclass(frozen=True)
class Complaint:
    """Something that bothers a person, and the act that helps.

    Attributes:
        said: what the gesture stands for.
        kind: of the thing in the room, as the words call it.
        opens: whether the thing is to be opened, or turned up; else closed, or turned down.
        act: what the agent does about it.
    """

    said: str
    kind: str
    opens: bool
    act: str


COLD = Complaint("I am cold", "window", False, "closes the window")
HOT = Complaint("I am hot", "window", True, "opens the window")
LOUD = Complaint("This is too loud", "hi-fi", False, "turns the hi-fi down")
SMELLS = Complaint("This smells bad", "window", True, "opens the window")
BRIGHT = Complaint("It is too bright", "curtain", False, "closes the curtains")


def complaint(seen: Array, fps: float) -> Complaint | None:
    """The complaint that a person makes in their last second; None for none.

    Args:
        seen: (T, 22, 3) metres; with fewer than :data:`FRAMES` frames nothing is told.
        fps: frames a second.
    """
    if len(seen) < FRAMES:
        return None
    last = np.asarray(seen[-FRAMES:], dtype=np.float64)
    hands = np.moveaxis(palms(last), 1, 0)
    speeds = np.linalg.norm(np.gradient(hands - last[:, _j("spine3")], axis=1), axis=-1) * fps
    head, high = last[:, _j("head")], hands[..., 1] > last[:, _j("neck"), 1]
    at_head = ((np.linalg.norm(hands - head, axis=-1) < AT_HEAD) & high).all(axis=0)
    wrists = [last[:, _j(f"{side}_wrist")] for side in _SIDES]
    apart = np.linalg.norm(wrists[0] - wrists[1], axis=-1) > APART
    if _mostly(at_head & apart):
        return LOUD
    ahead = np.einsum("stj,tj->st", hands - head, np.stack([facing(pose) for pose in last])) > 0.04
    if _mostly(at_head & ~apart & ahead.all(axis=0)):
        return BRIGHT
    arms = np.stack([_to_arm(hands[i], last, _SIDES[1 - i]) for i in (0, 1)])
    if _mostly(arms.max(axis=0) < AT_ARM) and speeds.mean() > RUBS:
        return COLD
    if _holds_nose(last, fps):
        return SMELLS
    neck = np.linalg.norm(hands - last[:, _j("neck")], axis=-1) < AT_NECK
    fans = (neck & (hands[..., 1] < head[:, 1] + 0.1)).mean(axis=1) >= MOST
    to_and_fro = np.array([_turns(course - last[:, _j("spine3")]) >= TURNS for course in hands])
    return HOT if (fans & to_and_fro & (speeds.mean(axis=1) > FANS)).any() else None


def _holds_nose(last: Array, fps: float) -> bool:
    """True if one hand stays at the nose and the other is low."""
    wrists = np.stack([last[:, _j(f"{side}_wrist")] for side in _SIDES])
    ahead = np.stack([facing(pose) for pose in last])
    off = wrists - last[:, _j("head")] - NOSE[1] * ahead - NOSE[0] * _UP
    aside = np.abs(np.einsum("stj,tj->st", off, np.cross(_UP, ahead)))
    speeds = np.linalg.norm(np.gradient(wrists - last[:, _j("head")], axis=1), axis=-1).mean(axis=1) * fps
    low = wrists[..., 1] < last[:, _j("neck"), 1] - LOW
    held = (np.linalg.norm(off, axis=-1) < AT_NOSE) & (aside < ASIDE) & (off[..., 1] < -UNDER) & low[::-1]
    return bool(((held.mean(axis=1) >= MOST) & (speeds < STILL)).any())


def _turns(course: Array) -> int:
    """The times that a course (T, 3) turns back by a centimetre, along the line on which it is longest."""
    off = course - course.mean(axis=0)
    along = off @ np.linalg.svd(off, full_matrices=False)[2][0]
    count, far, way = 0, along[0], 0.0
    for value in along:
        if (value - far) * way >= 0:
            far, way = value, way or (value - far)
        elif abs(value - far) > 0.01:
            count, far, way = count + 1, value, value - far
    return count


def _mostly(mask: NDArray[np.bool_]) -> bool:
    return bool(mask.mean() >= MOST)


def _j(name: str) -> int:
    return SMPL22.index(name)


def _to_arm(palms: Array, poses: Array, side: str) -> Array:
    """(T,) metres from a palm (T, 3) to an upper arm."""
    shoulder, elbow = poses[:, _j(f"{side}_shoulder")], poses[:, _j(f"{side}_elbow")]
    along = elbow - shoulder
    share = np.einsum("tj,tj->t", palms - shoulder, along) / np.maximum((along**2).sum(-1), 1e-9)
    return np.linalg.norm(palms - shoulder - np.clip(share, 0, 1)[:, None] * along, axis=-1)
