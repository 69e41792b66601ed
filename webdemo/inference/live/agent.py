"""The virtual agent of Chopin's thesis (chapter 5) in front of a stream: it sees only what has happened so far.

Every half second it takes the last second of the person, predicts two more and recognises the gesture (see
:mod:`webdemo.inference.pipelines.agent`). Until it is sure, it stands with the person. When it is sure, the online
ReGenNet receives the sentence of the gesture and answers frame by frame; the thesis plays a prerecorded motion instead.
A second gesture interrupts the answer, and a person who turns away ends it. Where a camera sees the person's face, the
agent answers only if it is addressed: if the face points to the camera, where the agent is seen, or to the agent in the
scene. While it does not answer, the agent turns to the person and looks at them; it leaves a person who turns their
back on it for long, and comes back when they turn round.
"""

from __future__ import annotations

from collections import deque

import numpy as np

from models.agent.recogniser import OBSERVED
from motion import FPS
from motion.steering import Goal
from motion.things import Thing
from motion.transforms import facing
from motion.vectors import Array
from motion.video.following import Gaze
from webdemo.inference.pipelines.agent import BETWEEN, FIRST, Decision, Eye, Look
from webdemo.inference.requests.live import Belief

from .partner_pipeline import ReactingPartner
from .room import Errand, Room, complaint

MEMORY = 6
"""Looks that count together: the last three seconds."""
ANSWER = 75
"""Frames of an answer after which the agent stops when it sees no gesture any more."""
LONGEST_ANSWER = 150
"""Frames after which an answer ends unless the gesture is recognised again."""
AWAY = -0.2
"""Cosine between the person's direction and the way to the agent below which the person looks away."""
IGNORED = 45
"""Frames of looking away after which the agent counts as ignored."""
FACES = 0.64
"""Cosine of the angle (50°) between a face and what it looks at, at most."""
LISTENS = 30
"""Frames of which more than half must have been meant for the agent before it answers."""
LEAVES = 180
"""Frames of looking away after which the agent leaves."""
BACK = 20
"""Frames of not looking away after which an agent that has left comes back."""
LEFT, FARTHEST = 2.0, 5.0
"""Metres that the agent goes when it leaves, and metres from the person beyond which it goes no further."""
BESIDE = 2.0
"""Metres from the person up to which it comes back."""
SHOWN = 3
"""Gestures that are named with their probabilities."""


class LiveAgent:
    """Recognises what one person does and answers.

    Args:
        eye: recognises a gesture.
        partner: moves the agent.
    """

    def __init__(self, eye: Eye, partner: ReactingPartner) -> None:
        self.eye, self.partner = eye, partner
        self.labels, self.sentences = eye.recogniser.config.labels, eye.recogniser.config.sentences
        partner.take_words(self.sentences[0])
        self.frame = 0
        self.gesture: int | None = None
        self.gaze: Gaze | None = None
        self._seen: deque[Array] = deque(maxlen=OBSERVED)
        self._meant: deque[bool] = deque(maxlen=LISTENS)
        self._elsewhere = 0
        self._looks: deque[Look] = deque(maxlen=MEMORY)
        self._away = self._met = 0
        self._gone = self._returns = False
        self._until = FARTHEST
        self._shown: Array | None = None
        self._room: Room | None = None
        self._began = 0
        self.belief = Belief("watches", "The agent watches.")

    def step(self, pose: Array) -> Array:
        """See :class:`webdemo.inference.requests.live.LivePartner`."""
        self.frame += 1
        self._seen.append(np.asarray(pose, dtype=np.float64))
        self.partner.goal = self._goal(self._seen[-1])
        shown = self._shown = self.partner.step(pose)
        self._room = self._room or Room(self._seen[-1], shown)
        busy = self._room.errand is not None
        shown = self._room.step(shown)
        self._returns = self._returns or (busy and self._room.errand is None)
        away = _looks_away(pose, shown)
        self._away, self._met = (self._away + 1, 0) if away else (0, self._met + 1)
        self._meant.append(self.gaze is None or _looks_at(self.gaze, pose, shown))
        self._elsewhere = 0 if self._meant[-1] else self._elsewhere + 1
        if self.frame >= FIRST and (self.frame - FIRST) % BETWEEN == 0 and not self._is_asked():
            self._look()
        return shown

    @property
    def things(self) -> tuple[Thing, ...]:
        """See :class:`webdemo.inference.requests.live.LivePartner`."""
        return () if self._room is None else self._room.things()

    def _is_asked(self) -> bool:
        """True while the agent is on an errand; a complaint that is meant for it, and not yet seen to, begins one."""
        room = self._room
        if room is None or room.errand is not None:
            return room is not None
        said = complaint(np.stack(self._seen), FPS)
        if said is None or not room.wants(said) or not self._addressed or self._away or self._gone:
            return False
        self._looks.clear()
        self._rest()
        room.errand = Errand(said)
        self.belief = Belief("answers", f"The person shows “{said.said}”, so the agent {said.act}.")
        return True

    def _goal(self, pose: Array) -> Goal | None:
        """The place to which the agent turns and goes by itself; none while it answers."""
        if self._shown is not None and self._room is not None and (goal := self._room.goal(self._shown)) is not None:
            return goal
        if self._shown is None or self.gesture is not None:
            self._returns = False
            return None
        apart = float(np.linalg.norm((pose[0] - self._shown[0])[[0, 2]]))
        if self._away == LEAVES:
            self._gone, self._until = True, min(apart + LEFT, FARTHEST)
        if self._gone and self._met >= BACK:
            self._gone, self._returns = False, True
        if self._gone:
            return Goal(pose[0], away=True, walk=apart < self._until)
        self._returns = self._returns and apart > BESIDE
        return Goal(pose[0], walk=self._returns)

    def _look(self) -> None:
        """Takes a look, and begins, changes or ends the answer from the next frame on."""
        (look,) = self.eye.looks(np.stack(self._seen))
        self._looks.append(Look(self.frame, look.chances))
        if self._gone or self._away >= IGNORED or not self._addressed:
            self._looks.clear()
            self._rest()
            if self._gone:
                self.belief = Belief("left", "The person has looked away for a long time, so the agent leaves.")
            elif self._away >= IGNORED:
                self.belief = Belief("ignored", "The person looks away, so the agent waits.")
            else:
                self.belief = Belief("ignored", "The person looks elsewhere, so the agent waits to be addressed.")
            return
        decision = self.eye.decide(list(self._looks))
        if decision.sure and decision.place is not None:
            self._answer(decision.place)
        elif self.gesture is not None and self._over(look):
            self._rest()
        self.belief = self._believes(decision, look)

    @property
    def _addressed(self) -> bool:
        """True if what the person does is meant for the agent; during an answer they may look elsewhere for a while."""
        if self.gesture is not None:
            return self._elsewhere < IGNORED
        return 2 * sum(self._meant) > len(self._meant)

    def _answer(self, place: int) -> None:
        """Begins the answer to a gesture; one that is being answered goes on."""
        self._looks.clear()
        self._began = self.frame
        if place != self.gesture:
            self.gesture = place
            self.partner.take_words(self.sentences[place])

    def _over(self, look: Look) -> bool:
        """True if the answer has lasted long enough."""
        lasted = self.frame - self._began
        return lasted >= LONGEST_ANSWER or (lasted >= ANSWER and look.chances[0] > 0.5)

    def _rest(self) -> None:
        """Stands and watches again."""
        if self.gesture is not None:
            self.gesture = None
            self.partner.take_words(self.sentences[0])

    def _believes(self, decision: Decision, look: Look) -> Belief:
        """The agent's belief in words."""
        chances = decision.look.chances if decision.place is not None else look.chances
        order = np.argsort(-chances)[:SHOWN]
        named = tuple((self.labels[i], float(chances[i])) for i in order)
        if self.gesture is not None:
            label, sentence = self.labels[self.gesture], self.sentences[self.gesture]
            text = f"Sure of “{label}” since {self._began / FPS:.1f} s, so the agent answers: {sentence}"
            return Belief("answers", text, named)
        if decision.place is None:
            return Belief("watches", "The agent sees no gesture that asks for an answer.", named)
        label = self.labels[decision.place]
        return Belief("watches", f"Perhaps “{label}”, but the agent is not sure yet.", named)


def _looks_at(gaze: Gaze, pose: Array, other: Array) -> bool:
    """True if the face of a person (22, 3) points to the camera or to another."""
    return max(gaze.camera, gaze.towards(other[0] - pose[0])) >= FACES


def _looks_away(pose: Array, other: Array) -> bool:
    """True if a person (22, 3) faces away from another."""
    way = (other[0] - pose[0])[[0, 2]]
    ahead = np.asarray(facing(np.asarray(pose, dtype=np.float64)))[[0, 2]]
    distance = float(np.linalg.norm(way))
    return distance > 0.3 and float(ahead @ way) < AWAY * distance * float(np.linalg.norm(ahead))
