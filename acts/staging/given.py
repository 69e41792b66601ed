"""What a window of a story is given: the parts that the scores of its beats ask for.

Who has the body of a person who stays where they are is decided in :meth:`_Beat.on_the_spot`; what comes on the ways of
the two is collected in :meth:`_Beat.on_the_way`.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from motion import FPS
from motion.skeleton import FEET, SIDES
from motion.transforms import Placement, heading
from motion.vectors import Array, direction

from .beginnings import Room, Take, beginning, roomy
from .figures import figure_parts, figure_poses
from .floor import plan
from .gestures import arms_of, hand_parts
from .holds import COUPLE, hold_parts, pull_parts, twirl_parts
from .lifts import Carrying
from .moves import coming, meeting, towards_touched
from .places import AT_TABLE, EVENLY, Standing, Way2D
from .poses import HANDS, JOINT, TRUNK, UPRIGHT, Pose, all_but, upright
from .postures import posture_parts, postures
from .recordings import Performance, dancing, performance, standing_by, walking
from .score import Move, Score, Touch, at_start, goes, leaving
from .strikes import strike_parts
from .touches import touch_parts
from .window import GETS_DOWN, SETTLES, KnownFrames, KnownPath, Part, Stretch, Window

_DRAFTED = 6
"""Frames between two poses of a bystander."""
_RESTS, _STAYS, _FACES = 15, 0.03, 0.2
"""Frames before and after one at which somebody on their way rests, and the metres and radians that they may move."""
_LOW = ("crawls", "on the knees")
"""Gaits of people who are low."""
_PLACED = 30
"""Frames between two given places of a person whose poses are a draft."""


@dataclass(frozen=True)
class Story:
    """A story as it is staged.

    Attributes:
        scores: of its beats.
        seconds: the lengths of the beats.
        edges: the first frame of each beat and the end of the last one.
        seed: draws how people stand and how late they are.
        placed: paths or poses of the request say where it begins, and the words do not.
    """

    scores: Sequence[Score]
    seconds: Sequence[float]
    edges: Sequence[int]
    seed: int
    placed: bool = False

    def beginning(self) -> Standing:
        """The places at which it begins."""
        return Take.of(self.seed).of_places(beginning(self.scores, self.seconds), self.scores[0])


def plan_parts(story: Story, window: Window, scene: Array, placement: Placement, taken: Collection[int]) -> list[Part]:
    """The places, poses and hands that the words of a window's beat ask for, in the network's frame.

    Args:
        story: the story.
        window: the window.
        scene: (2, T, 22, 3), whose frames before the window are there.
        placement: from the scene's world to the network's frame.
        taken: the people whose way or poses the request gives. Two who hold or carry each other are then left to the
            network.
    """
    score, start = story.scores[window.beat], story.edges[window.beat]
    later = next((each.moves for each in story.scores[1:] if goes(each.moves)), ())
    comes = not (window.part or score.reaching) and any(move.way in ("to", "away") for move in later)
    if (taken and score.joined) or (not start and (story.placed or not (score.is_planned or comes))):
        return []
    parts = _Beat(story, window, scene, placement).parts()
    return [part for part in parts if part.person not in taken and len(part.frames)]


def softened(parts: Iterable[Part]) -> list[Part]:
    """The parts, with poses that a network may change: all but those that the finished motion keeps."""
    return [replace(part, soft=True) if isinstance(part, KnownFrames) and not part.kept else part for part in parts]


def places_of(parts: Sequence[Part]) -> list[Part]:
    """The parts, with only the places of soft poses, the headings of those who are upright, and how low others are."""
    held: list[Part] = []
    for part in parts:
        if isinstance(part, KnownPath) or not part.soft:
            held.append(part)
        elif not part.free and (not part.joints or 0 in part.joints):
            frames, poses = np.asarray(part.frames), np.asarray(part.positions)
            low = poses[:, 0, 1] <= UPRIGHT
            if low.any():  # of a body that lies, hips and shoulders say nothing
                held.append(KnownFrames(part.person, frames[low].tolist(), poses[low], (JOINT["pelvis"],)))
            if low.all():
                continue
            frames, poses, kept = frames[~low], poses[~low], [0]
            for i in range(1, len(frames)):
                if frames[i] - frames[kept[-1]] >= _PLACED or i == len(frames) - 1:
                    kept.append(i)
            poses = poses[kept]
            headings = None if low.any() else _headings(part.joints, poses)
            places = poses[:, 0][:, [0, 2]]
            held.append(KnownPath(part.person, frames[kept].tolist(), places, headings, headings is not None))
    return held


def places_alone(parts: Sequence[Part]) -> list[Part]:
    """The places and headings of parts, with how low those are who are not upright, and no pose."""
    return [
        part
        for part in places_of(softened(parts))
        if isinstance(part, KnownPath) or tuple(part.joints) == (JOINT["pelvis"],)
    ]


def _headings(joints: Collection[int], poses: Array) -> Array | None:
    """(N,) radians in which poses (N, 22, 3) face by their hips, or else by their shoulders, if these are given."""
    for pair in ("hip", "shoulder"):
        left, right = (JOINT[f"{side}_{pair}"] for side in SIDES)
        if not joints or {left, right} <= set(joints):
            across = poses[:, left] - poses[:, right]
            return np.asarray(np.arctan2(-across[:, 2], across[:, 0]))
    return None


@dataclass(frozen=True)
class _Beat:
    """One beat of a story, and the window of it that is made; see :func:`plan_parts`."""

    story: Story
    window: Window
    scene: Array
    placement: Placement

    @property
    def score(self) -> Score:
        """Of the beat."""
        return self.story.scores[self.window.beat]

    @property
    def start(self) -> int:
        """Its first frame in the scene."""
        return self.story.edges[self.window.beat]

    @cached_property
    def down(self) -> list[int]:
        """The people who are not on their feet when it begins."""
        return [person for person in (0, 1) if self.start and self.scene[person, self.start - 1, 0, 1] <= UPRIGHT]

    def seats(self) -> list[Array]:
        """The places (2,) of the seats on which people sit when it begins, or sat before, and of the tables at them."""
        scores, edges, begin = self.story.scores, self.story.edges, self.story.beginning()
        spots: list[Array] = []
        for i in range(self.window.beat + 1):
            for person, who in enumerate("ab"):
                if at_start(scores, i)[who] == "sits":
                    pose = self.scene[person, max(edges[i] - 1, 0)] if self.start else None
                    spots.append(begin.places[person] if pose is None else pose[0, [0, 2]])
                    angle = begin.headings[person] if pose is None else heading(pose)
                    if any(change.at_table for score in scores[: i + 1] for change in score.changes.get(who, ())):
                        spots.append(spots[-1] + AT_TABLE * direction(float(angle)))
        return spots

    def last(self, person: int) -> Array | None:
        """A person's pose (22, 3) before it; None if it is the first."""
        return self.scene[person, self.start - 1] if self.start else None

    def stretch(self, stand: Standing) -> Stretch:
        """Its frames, with the people where they stand."""
        return Stretch(self.window, self.placement, stand, self.start, self.story.edges[self.window.beat + 1])

    def parts(self) -> list[Part]:
        """All that the window is given of it."""
        score, start, lift = self.score, self.start, self.score.lift
        before = self.scene[:, max(start - 4, 0) : start]
        stand = _stand(before) if start else self.story.beginning()
        moves = coming(score, stand, self.down) if start else score.moves
        room = self._room(moves, stand)
        stand = room.stand
        stretch = self.stretch(stand)
        parts, posed = ([], {}) if lift else self.on_the_spot(moves, replace(stretch, start=start + room.delay))
        parts += room.steps(stretch)
        touch, moves = meeting(score.touch, moves, posed, stand)
        if lift is not None and not start and not lift.comes:  # they are held from the first frame
            moves = tuple(m for m in moves if (m.person, m.way) != (lift.carrier, "stay"))
        if touch is not None:
            parts = [part for part in parts if part.person != "ab".index(touch.person)]
        if not start and not parts and not moves and score.side:
            moves = tuple(Move(who, "averted") for who in "ab")
        goal = towards_touched(touch, posed, stand, score.pulls)
        there = {part.person for part in parts}
        ways = {
            way.person: way
            for way in plan(moves, goal, stretch.frames, first=not start, seats=self.seats())
            if way.person not in there
        }
        couple: list[Part] = []
        if score.hold == COUPLE and len(ways) == 2:
            busy = [HANDS if who in score.gestures else () for who in "ab"]
            couple, ways = _dancing_parts(stretch, self.story.seed, [all_but(joints) for joints in busy])
        stretch = replace(stretch, ways=ways)
        if lift is not None and len(ways) == 2:
            carrying = Carrying(lift, stretch, score.gestures.get("ab"["ba".index(lift.carrier)]))
            parts += carrying.parts()
            stretch = replace(stretch, ways=carrying.before())
        return parts + couple + self.on_the_way(moves, touch, posed, stretch)

    def on_the_spot(self, moves: Sequence[Move], stretch: Stretch) -> tuple[list[Part], dict[int, Array]]:
        """The parts of people who stay where they are, and a pose (22, 3) of those whose hands are still free.

        A figure, or limbs, come before standing by, and that before a posture. Who stands by has no pose.
        """
        score, seed = self.score, self.story.seed
        gone = leaving(moves)
        parts: list[Part] = []
        posed: dict[int, Array] = {}
        for person, who in enumerate("ab"):
            last, up, stays = self.last(person), person not in self.down, who not in gone
            turned = last is None and _keeps_back(score, who)
            stands = upright(stretch.stand.places[person], float(stretch.stand.headings[person]))
            if stays and (who in score.figures or (up and who in score.limbs)):
                parts += softened(figure_parts(self.story.scores, person, stretch, last, seed))
                posed[person] = stands
            elif up and who in score.idle & score.frozen:
                frames = stretch.every(EVENLY, SETTLES if self.start else 0)
                still = upright(np.tile(stretch.halt(person), (len(frames), 1)), stretch.stand.headings[person])
                parts.append(stretch.known(person, frames, still))
            elif up and who in score.idle:
                parts += _bystander_parts(person, stretch, seed)
            elif stays and up and (turned or who in score.gesturing):
                gesture = score.gestures.get(who)
                arms = arms_of(gesture) if gesture else HANDS
                parts += _bystander_parts(person, stretch, seed, all_but(arms), self.performance(person))
                posed[person] = stands
            elif stays:
                poses = self._postures(person, stretch)
                if len(poses) > 1:
                    posed[person] = poses[-1][1]
                parts += softened(posture_parts(poses, person, score, stretch, self.window.tail(self.story.edges[-1])))
        return [part for part in parts if len(part.frames)], posed

    def on_the_way(
        self, moves: Sequence[Move], touch: Touch | None, posed: dict[int, Array], stretch: Stretch
    ) -> list[Part]:
        """The ways of the two, and the touches, holds, blows and gestures on them."""
        score, ways, parts = self.score, stretch.ways, list[Part]()
        hands = [] if touch is None else touch_parts(touch, posed, stretch)
        parts += hands
        if score.pulls:
            lifted = self._postures(1 - "ab".index(score.pulls), stretch)
            parts += pull_parts(score.pulls, lifted, stretch, both=score.by_both_hands)
        gaits = {"ab".index(move.person): move.gait for move in moves if move.gait}
        alone = not (score.touch or score.joined or score.strike)
        free = alone and not score.linked
        for person, way in ways.items():
            gait = gaits.get(person, "")
            if gait in _LOW or (gait and free):
                parts += _gait_parts(gait, way, self.down, score, stretch, self.story.seed)
            else:
                parts += stretch.known_way(_until_posed(way, hands, stretch))
            if alone and not gait:
                loose = "ab"[person] in score.loose
                joints = () if loose else all_but(HANDS)
                parts += _going_parts(person, stretch, self.story.seed, joints, waits=free and loose)
        leads = "ring" if any(move.backwards for move in moves) and score.by_both_hands else ""
        if (hold := score.hold or leads) not in ("", COUPLE) and len(ways) == 2:
            parts += hold_parts(hold, stretch)
        if len(ways) == 2 and score.twirls:
            parts += twirl_parts(stretch)
        if (strike := score.strike) is not None and "ab".index(strike.turns[0]) in ways:
            parts += strike_parts(strike, score, stretch)
        whole = {who for person, who in enumerate("ab") if who not in leaving(moves) and self.performance(person)}
        gestures = {who: gesture for who, gesture in score.gestures.items() if who not in whole}
        for arms in hand_parts(replace(score, gestures=gestures), moves, posed, stretch, self.story.seed):
            if score.lift is None or "ab"[arms.person] == score.lift.carrier:
                parts.append(arms)
        return parts

    def performance(self, person: int) -> Performance | None:
        """The recorded gesture of a person on their feet who does nothing else; None of others."""
        who, score = "ab"[person], self.score
        if person in self.down or who not in score.gesturing - {*score.limbs, *score.figures}:
            return None
        frames = self.story.edges[self.window.beat + 1] - self.start
        return performance(score.gestures, person, frames, self.story.seed)

    def _postures(self, person: int, stretch: Stretch) -> list[Pose]:
        """The poses by which a person's posture is held."""
        beat, last = self.window.beat, self.last(person)
        return postures(self.story.scores, beat, person, stretch.start, stretch.stop, stretch.stand, last)

    def _room(self, moves: Sequence[Move], stand: Standing) -> Room:
        """The room that the postures of a beat need, in which nobody goes anywhere or touches the other."""
        score, stretch = self.score, self.stretch(stand)
        meets = any(figure.meets for figure in score.figures.values())
        if score.joined or score.strike or score.touch or meets or leaving(moves):
            return Room(stand)
        poses = {
            person: figure_poses(score, person, stretch, self.story.seed)
            if who in score.figures
            else self._postures(person, stretch)
            for person, who in enumerate("ab")
            if who not in score.idle
        }
        return roomy(stand, poses, self.down, first=not self.start)


def _until_posed(way: Way2D, hands: Sequence[KnownFrames], stretch: Stretch) -> Way2D:
    """A way, up to where the same person kneels down to what they touch: from then on poses say where they are."""
    if not hands or hands[0].person != way.person or 0 not in hands[0].joints:
        return way
    return way.only(np.asarray(stretch.in_window(way.frames)) < min(hands[0].frames))


def _keeps_back(score: Score, who: str) -> bool:
    """True for a person who stands so that the network would turn their trunk to the other, against their feet."""
    touch = score.touch
    if who in score.changes or (touch is not None and touch.beside and touch.person == who):
        return False  # they are down, lean to the other, or reach around them
    return bool(score.side) or (touch is not None and touch.behind and touch.person != who)


def _bystander_parts(
    person: int, stretch: Stretch, seed: int, joints: Sequence[int] = (), gesture: Performance | None = None
) -> list[Part]:
    """The place and the heading of a person who stays, and a recorded draft of some joints, of all by default.

    Of somebody with a recorded gesture the other joints are those of the hands that make it, which the plan may hold.
    """
    spacing, settles = (EVENLY, SETTLES // 2) if gesture else (_DRAFTED, SETTLES)
    frames = stretch.every(spacing, settles if stretch.start else 0)
    angle = float(stretch.stand.headings[person])
    poses = standing_by(stretch.halt(person), angle, frames + stretch.start, seed=2 * seed + person)
    hands: list[Part] = []
    if gesture is not None:
        poses = gesture.over(poses, frames / FPS, angle)
        shown = gesture.share(frames / FPS) > 0
        hands = softened([stretch.known(person, frames[shown], poses[shown], all_but(joints))])
    at = np.isin(frames, stretch.every(2 * spacing, settles if stretch.start else 0))
    way = Way2D(person, frames[at].tolist(), poses[at, 0][:, [0, 2]], np.full(at.sum(), angle))
    return [*stretch.known_way(way), stretch.draft(person, frames, poses, joints or range(len(JOINT))), *hands]


def _going_parts(person: int, stretch: Stretch, seed: int, joints: Sequence[int], *, waits: bool) -> list[Part]:
    """A recorded draft of somebody with a way: of some joints where they walk or run ahead, and where they ``wait``.

    The feet of a gait are held: by itself the network drags them over the floor.
    """
    course, own = stretch.course(person), 2 * seed + person
    at = stretch.every(EVENLY)
    walks, poses = walking(course, own)
    goes, rests, parts = at[walks[at]], at[:0], list[Part]()
    if waits:
        around = np.clip(at + np.array([[-_RESTS], [_RESTS]]), 0, stretch.frames - 1)
        first, last = course.places[around]
        moved, turned = np.linalg.norm(last - first, axis=-1), np.ptp(course.headings[around], axis=0)
        rests = at[(moved < _STAYS) & (turned < _FACES)]
    if len(goes) > 1:
        feet = stretch.known(person, goes, poses[goes], FEET)
        parts += [feet, stretch.draft(person, goes, poses[goes], joints)]
    if len(rests) > 1:
        waiting = standing_by(course.places[rests], course.headings[rests], rests + stretch.start, own)
        parts.append(stretch.draft(person, rests, waiting, (*TRUNK, *HANDS)))
    return parts


def _gait_parts(gait: str, way: Way2D, down: Collection[int], score: Score, stretch: Stretch, seed: int) -> list[Part]:
    """Somebody on their way with a gait that the network does not know: their poses, and where they rest their places.

    Of people who are low, poses at rest as well, from when those who are not ``down`` already have got down.
    """
    person, low = way.person, gait in _LOW
    walks, poses = walking(stretch.course(person), 2 * seed + person, gait)
    at = stretch.every(EVENLY, GETS_DOWN if low and stretch.start and person not in down else 0)
    at = at if low else at[walks[at]]
    joints = () if low else all_but(HANDS if "ab"[person] in score.gestures else ())
    body = softened([stretch.known(person, at, poses[at], joints, kept=not low)])
    return body + ([] if low else stretch.known_way(way.only(~walks[np.asarray(way.frames)])))


def _dancing_parts(stretch: Stretch, seed: int, joints: Sequence[Sequence[int]]) -> tuple[list[Part], dict[int, Way2D]]:
    """The ways of two who dance with each other as a recorded couple does, and a draft of some joints of each."""
    at, every = stretch.every(EVENLY), np.union1d(np.arange(0, stretch.frames, EVENLY), [stretch.frames - 1])
    parts, ways = list[Part](), dict[int, Way2D]()
    for person, poses in enumerate(dancing(stretch.stand, stretch.frames, seed)):
        parts += [stretch.known(person, at, poses[at], FEET), stretch.draft(person, at, poses[at], joints[person])]
        ways[person] = Way2D(person, every.tolist(), poses[every, 0][:, [0, 2]], heading(poses[every]))
    return parts, ways


def _stand(poses: Array) -> Standing:
    """Places and speeds of the two people at the last of some frames (2, N, 22, 3)."""
    poses = np.asarray(poses, dtype=np.float64)
    places = poses[:, :, 0][..., [0, 2]]
    speeds = (places[:, -1] - places[:, 0]) / max(poses.shape[1] - 1, 1) * FPS
    return Standing(places[:, -1], heading(poses[:, -1]), speeds)
