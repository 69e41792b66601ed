"""A partner's own attention: it turns to somebody, looks at them, walks off and comes back, frame by frame.

The network that moves a partner answers what a person does, and while nothing is done it stands as it stood. So what
it makes is turned about its pelvis and moved over the floor as a whole, and the feet follow in steps: one is set down
while the other stands. No frame depends on a later one. Without a goal it changes nothing.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .clip import FPS
from .limbs import limb_length, sink, solve_two_bones
from .skeleton import LEGS, SMPL22
from .smoothing import minimum_jerk
from .transforms import facing, heading, heading_matrix
from .vectors import FLAT, Array, heading_of, unit, wrapped

TURN_FROM, TURN_UNTIL = np.radians(35), np.radians(6)
"""Angle to the goal from which the body turns, and at which it has turned; between them the head alone does."""
TURN_RATE = np.radians(130) / FPS
"""Radians a frame."""
HEAD_MOST, HEAD_RATE = np.radians(50), np.radians(150) / FPS
"""Radians between head and body at most, and radians a frame."""
WALK = 0.8 / FPS
"""Metres a frame at full speed."""
SPEED_UP = 1 / 12
"""Share of the full speed by which the speed changes in a frame."""
STRIDE = 9
"""Frames of a step."""
STEP_FROM, REST_FROM = 0.07, 0.02
"""Metres between a standing foot and its place beyond which it steps: under a body that moves, and one that stands."""
LIFT = 0.05
"""Metres by which a stepping ankle is lifted."""
FADE = 0.85
"""Factor by which what is left of a foot's distance decays each frame, when all steps are done."""
_NECK, _HEAD = SMPL22.index("neck"), SMPL22.index("head")


@dataclass(frozen=True)
class Goal:
    """A partner's wish to turn, look and go somewhere.

    Attributes:
        towards: (3,) metres, what the body turns to, or away from.
        away: turn the back to it.
        walk: go on in the direction that the body faces, once it has turned.
        look: the head looks at ``towards`` as well.
    """

    towards: Array
    away: bool = False
    walk: bool = False
    look: bool = True


class Steering:
    """Turns and moves one partner; called once a frame, with or without a goal.

    Attributes:
        yaw: radians by which the partner is turned now.
        place: (3,) metres by which it is moved.
    """

    def __init__(self) -> None:
        self.yaw, self.place = 0.0, np.zeros(3)
        self._turning = False
        self._speed = self._head = 0.0
        self._steps = Steps()

    @property
    def idle(self) -> bool:
        """True where the partner stands where the network has it."""
        return not (self.yaw or self.place.any() or self._head or self._steps.busy)

    def __call__(self, pose: Array, goal: Goal | None) -> Array:
        """The pose (22, 3) as it is shown; without a goal, turn and place are given back, in steps."""
        if goal is None and self.idle:
            return pose
        if goal is None:
            self._release()
        moved = self._moved(pose)
        off = 0.0 if goal is None else _angle_to(moved, goal)
        if goal is not None:
            self._turn(off)
            self._walk(moved, wanted=goal.walk and abs(off) < TURN_FROM)
            moved = self._moved(pose)
            off = _angle_to(moved, goal)
        wanted = off if goal is not None and goal.look and not goal.away else 0.0
        self._head += float(np.clip(np.clip(wanted, -HEAD_MOST, HEAD_MOST) - self._head, -HEAD_RATE, HEAD_RATE))
        moved[_HEAD] = moved[_NECK] + heading_matrix(self._head) @ (moved[_HEAD] - moved[_NECK])
        carried = goal is None and bool(self.yaw or self.place.any())
        ahead = self._speed * WALK * STRIDE / 2 * facing(moved)
        return self._steps(moved, moving=carried or self._turning or self._speed > 0, ahead=ahead)

    def takes_over(self, raw: Array, shown: Array) -> None:
        """Goes on from the pose that is shown with another pose (22, 3) of the network at the same moment."""
        self.yaw = wrapped(float(heading(shown[None])[0] - heading(raw[None])[0]))
        self.place = (shown[0] - raw[0]) * FLAT

    def _moved(self, pose: Array) -> Array:
        return (pose - pose[0]) @ heading_matrix(self.yaw).T + pose[0] + self.place

    def _turn(self, off: float) -> None:
        self._turning = abs(off) > (TURN_UNTIL if self._turning else TURN_FROM)
        if self._turning:
            self.yaw = wrapped(self.yaw + float(np.clip(off, -TURN_RATE, TURN_RATE)))

    def _walk(self, moved: Array, *, wanted: bool) -> None:
        self._speed = float(np.clip(self._speed + (SPEED_UP if wanted else -SPEED_UP), 0.0, 1.0))
        self.place = self.place + self._speed * WALK * facing(moved)

    def _release(self) -> None:
        """Gives turn and place back to the network, at the pace of turning and walking."""
        self._turning, self._speed = False, 0.0
        self.yaw -= float(np.clip(self.yaw, -TURN_RATE, TURN_RATE))
        far = float(np.linalg.norm(self.place))
        self.place = self.place * (1 - WALK / far) if far > WALK else np.zeros(3)


class Steps:
    """Feet that stand while the body above them turns or goes, and step one after the other.

    Args:
        stride: frames of a step.
    """

    def __init__(self, stride: int = STRIDE) -> None:
        self.stride = stride
        self._stands: list[tuple[Array, Array] | None] = [None, None]
        self._swings: list[tuple[int, Array, Array] | None] = [None, None]

    @property
    def busy(self) -> bool:
        """True while a foot is not where the pose has it."""
        return any(stand is not None for stand in self._stands)

    def __call__(self, pose: Array, *, moving: bool, ahead: Array) -> Array:
        """The pose (22, 3) with its feet where they stand or step.

        Args:
            moving: the body turns or goes.
            ahead: (3,) metres by which a foot is set down before the body.
        """
        if not moving and not self.busy:
            return pose
        pose = pose.copy()
        goals = [(pose[ankle], pose[toe] - pose[ankle]) for _, _, ankle, toe in LEGS]
        for side, goal in enumerate(goals):
            if self._stands[side] is None:
                self._stands[side] = goal
        self._begin_a_step([goal[0] for goal in goals], STEP_FROM if moving else REST_FROM)
        goals = [(place + ahead, foot) for place, foot in goals]
        feet = [self._foot(side, goals[side], moving=moving) for side in range(2)]
        hips, ankles = [pose[None, leg[0]] for leg in LEGS], [place[None] for place, _ in feet]
        pose[:, 1] -= sink(hips, ankles, [limb_length(pose[None], leg)[:, None] - 1e-5 for leg in LEGS], np.inf)
        for (hip, knee, ankle, toe), (place, foot) in zip(LEGS, feet, strict=True):
            pose[knee], pose[ankle] = solve_two_bones(pose[hip], pose[knee], pose[ankle], place, facing(pose))
            pose[toe] = pose[ankle] + foot
        return pose

    def _begin_a_step(self, goals: list[Array], least: float) -> None:
        """Lifts the foot that is farther from its place, where both stand and it is ``least`` metres off."""
        if any(self._swings):
            return
        stands = [stand for stand in self._stands if stand is not None]
        far = [float(np.linalg.norm((goal - stand[0]) * FLAT)) for goal, stand in zip(goals, stands, strict=True)]
        side = int(np.argmax(far))
        if far[side] > least:
            self._swings[side] = (0, *stands[side])

    def _foot(self, side: int, goal: tuple[Array, Array], *, moving: bool) -> tuple[Array, Array]:
        """(3,) the ankle's place and (3,) the foot from there to its toe."""
        swing, stand = self._swings[side], self._stands[side]
        assert stand is not None  # both feet stand or swing
        if swing is not None:
            frame, began, foot = swing
            share = (frame + 1) / self.stride
            smooth = float(minimum_jerk(share))
            place = began + smooth * (goal[0] - began) + [0.0, LIFT * np.sin(np.pi * share) ** 2, 0.0]
            turned = _turned(foot, goal[1], smooth)
            done = share >= 1
            self._swings[side] = None if done else (frame + 1, began, foot)
            self._stands[side] = (place, turned)
            return place, turned
        far = float(np.linalg.norm((goal[0] - stand[0]) * FLAT))
        if not moving and not any(self._swings) and far <= REST_FROM:
            stand = (goal[0] + FADE * (stand[0] - goal[0]), _turned(goal[1], stand[1], FADE))
            self._stands[side] = stand if np.linalg.norm(stand[0] - goal[0]) > 1e-3 else None
        return stand


def _turned(first: Array, second: Array, share: float) -> Array:
    """A foot (3,) between two others, as long as the second one."""
    return unit(first + share * (second - first)) * np.linalg.norm(second)


def _angle_to(pose: Array, goal: Goal) -> float:
    """Radians from the direction that a pose faces to its goal, positive towards +X."""
    way = (goal.towards - pose[0]) * FLAT * (-1 if goal.away else 1)
    if np.linalg.norm(way) < 1e-6:
        return 0.0
    return wrapped(float(heading_of(way) - heading(pose[None])[0]))
