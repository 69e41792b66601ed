"""The room of the live agent: a window with curtains behind it and a hi-fi at its side, which it goes to and uses.

The person's complaints (:mod:`.complaints`) send the agent on an errand: it walks to the thing, its
hands come to it, the thing changes, and the agent comes back. Nothing depends on a later frame of the person.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from motion import FPS, SMPL22
from motion.cleaning import solve_two_bones
from motion.easing import smoothstep
from motion.steering import Goal
from motion.things import Thing, shape
from motion.transforms import facing
from motion.vectors import FLAT
from webdemo.inference.things.fixtures import BODIES, LEAVES, TAKES, placed_leaf

from .complaints import Complaint

Array = NDArray[np.floating]

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
        self._yaws = {kind: float(np.arctan2(front[0], front[2])) for kind, front in fronts.items()}
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
