"""The end of every generation: constant bones, planted feet and raised toes; and of a scene, where hands meet."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from acts.staging.score import Score
from motion import FPS, Duet
from motion.cleaning import foot_contacts, plant_feet
from motion.footsteps import pivoting, stepping
from motion.kinematics import bone_lengths, bone_vectors, chained, project_to_skeleton
from motion.limbs import ankle_moved, open_limb, solve_two_bones, steadied
from motion.metrics import compare
from motion.skeleton import ARMS, LEGS
from motion.smoothing import eased_marks, least_jerk, smoothstep
from motion.swings import above_floor, lift_swinging_feet
from motion.touch.apart import bodies_apart, out_of_the_way
from motion.touch.arms import arms_apart, embraced
from motion.touch.hands import backs_straight, hands_clasped, palms_met
from motion.transforms import facing
from motion.vectors import Array, unit
from webdemo.inference.requests import ReactRequest
from webdemo.inference.requests.actor import ROLES
from webdemo.inference.requests.plans import BeatFinish
from webdemo.inference.run import Result
from webdemo.inference.story.request import SceneRequest

_CALM = 0.3
"""Weight of what a network made against least jerk: what is slower than 4 Hz stays."""
_SOFT = 0.04
"""Share of a limb's length before its end that is used up ever more slowly: a straight limb trembles."""
_LANDS = 0.5
"""Metres a second of a foot that lands or leaves, up to which it stands already, or still, at a hand-over of weight:
0.4 leaves both toes gliding for two or three frames, 0.6 has walks jerk a fifth more."""
_STANDS, _LEAVES = 0.5, 0.35
"""Contact scores from which a foot stands, and below which it has left the floor."""
_LOW = 0.1
"""Metres: a toe that stands is not higher."""
_FADE = 0.8
"""Factor by which a correction decays each frame after the foot lifts."""
_FARTHEST = 0.12
"""Metres between a foot's place and the network's beyond which the foot steps instead of standing."""


def clean_person(positions: Array, fps: float = 30.0) -> Array:
    """One person on constant bones, above the floor, in steps, feet planted where they stand, swinging toes raised.

    Bones are made constant by their directions, from the pelvis outwards; wrists and ankles are then taken
    back to their places by two-bone IK, so hands that met still meet. Elbows and knees go round their limbs smoothly,
    and what trembles faster than people do is smoothed first.

    Args:
        positions: (T, 22, 3) metres as a network gave them.
        fps: frames a second.

    Returns:
        (T, 22, 3) metres.
    """
    seen = _calmed(positions)
    bones, _ = project_to_skeleton(seen)
    result = above_floor(_steady_limbs(_limbs_back(_steady_bones(bones), seen), seen))
    result = pivoting(stepping(result, fps), fps)
    swung = lift_swinging_feet(plant_feet(result, foot_contacts(result, fps)), fps)
    # a toe that is raised glides as it lands
    return plant_feet(swung, foot_contacts(swung, fps, speed=_LANDS))


def _calmed(positions: Array) -> Array:
    """Positions (T, 22, 3) without what trembles faster than people do; the pelvis, whose way is given, moves least."""
    pelvis = np.asarray(positions[:, :1], dtype=np.float64)
    beside = least_jerk(positions - pelvis, np.full(len(positions), _CALM))
    return np.asarray(least_jerk(pelvis, np.ones(len(positions))) + beside)


def standing_clear(result: Result, request: ReactRequest) -> Result:
    """A reaction whose made person does not stand where the given one walks; see :mod:`motion.touch.apart`.

    Frame by frame, what comes is not known, and without clean-up nothing is moved.
    """
    if request.mode != "offline" or not request.cleanup:
        return result
    duets, readouts, farthest = list(result.duets), list(result.readouts), 0.0
    given = ROLES.index(request.role)
    for i, duet in enumerate(result.duets):
        assert isinstance(duet, Duet)  # as every reaction is
        actor, made = duet.people[given], duet.people[1 - given]
        begins = request.first_pose is not None
        way = out_of_the_way(actor.positions, made.positions, duet.fps, first_pose_given=begins)
        if way is None:
            continue
        moved = made.positions + way[:, None].astype(made.positions.dtype)
        if begins:  # who goes there takes steps
            moved[1:] = clean_person(moved, duet.fps)[1:]
        people = [actor, replace(made, positions=moved)]
        duets[i] = clear = replace(duet, a=people[given], b=people[1 - given])
        readouts[i : i + 1] = [compare(None, clear)]
        farthest = max(farthest, float(np.linalg.norm(way, axis=-1).max()))
    if not farthest:
        return result
    said = f"Person {ROLES[1 - given].upper()} was placed {farthest:.1f} m further off, out of the other's way."
    return replace(result, duets=tuple(duets), readouts=tuple(readouts), notes=(*result.notes, said))


def on_constant_bones(positions: Array) -> Array:
    """One person (T, 22, 3) on SMPL22's constant bones, frame by frame; see :func:`clean_person`."""
    target = np.asarray(positions, dtype=np.float64)
    return _limbs_back(project_to_skeleton(target)[0], target, soft=0.0)


def _steady_bones(positions: Array) -> Array:
    """Positions (T, 22, 3) whose bones turn smoothly: a trunk that is fitted to single frames jumps where it folds."""
    bones = bone_vectors(positions)
    calm = unit(least_jerk(bones, np.full(len(bones), _CALM)))
    return chained(positions[:, 0], calm * bone_lengths(positions)[..., None])


def _limbs_back(result: Array, target: Array, *, soft: float = _SOFT) -> Array:
    """Positions (T, 22, 3) whose wrists and ankles are taken as near as they reach to where ``target`` has them."""
    forward = facing(result)
    for shoulder, elbow, wrist in ARMS:
        limb = result[:, shoulder], result[:, elbow], result[:, wrist]
        share = open_limb(*limb) if soft else 1.0
        goal = result[:, wrist] + share * (target[:, wrist] - result[:, wrist])
        result[:, elbow], result[:, wrist] = solve_two_bones(*limb, goal, _elbow_pole(forward), soft=soft)
    for leg in LEGS:
        ankle_moved(result, leg, target[:, leg[2]], forward, soft=soft)
    return result


def _steady_limbs(result: Array, seen: Array) -> Array:
    """Positions (T, 22, 3) whose elbows and knees go round their limbs smoothly, on the side where they were seen."""
    forward = facing(result)
    for shoulder, elbow, wrist in ARMS:
        guide = seen[:, elbow] - seen[:, shoulder] + result[:, shoulder]
        limb = result[:, shoulder], result[:, elbow], result[:, wrist]
        result[:, elbow] = steadied(*limb, guide, _elbow_pole(forward))
    for hip, knee, ankle, _ in LEGS:
        guide = seen[:, knee] - seen[:, hip] + result[:, hip]
        leg = result[:, hip], result[:, knee], result[:, ankle]
        result[:, knee] = steadied(*leg, guide, forward, hinged=True)
    return result


def _elbow_pole(forward: Array) -> Array:
    """(T, 3) the direction in which a straight arm bends: backwards and down."""
    return np.asarray(-forward + np.array([0.0, -1.0, 0.0]))


class FollowingCleanup:
    """Constant bones and standing feet for one person, one frame after the other.

    A foot that begins to stand keeps its place, as corrected so far; when it leaves the floor the correction
    fades. No frame depends on a later one.
    """

    def __init__(self) -> None:
        self._shift = np.zeros((2, 3))
        self._place: list[Array | None] = [None, None]

    def __call__(self, frame: Array, contacts: Array) -> Array:
        """The frame as it is shown.

        Args:
            frame: (22, 3) metres as the network gave it, floor at 0.
            contacts: (4,) scores of left ankle, left toe, right ankle, right toe.

        Returns:
            (22, 3) metres.
        """
        result = on_constant_bones(np.asarray(frame, dtype=np.float64)[None])[0]
        forward = facing(result)
        for side, (*_, ankle, toe) in enumerate(LEGS):
            shift = self._correction(side, result[toe], float(contacts[2 * side : 2 * side + 2].max()))
            # Neither end of a foot goes below the floor.
            sunk = max(0.0, -(result[toe, 1] + shift[1]), 0.03 - (result[ankle, 1] + shift[1]))
            goal = result[ankle] + shift + np.array([0.0, sunk, 0.0])
            ankle_moved(result, LEGS[side], goal, forward)
        return result

    def _correction(self, side: int, toe: Array, score: float) -> Array:
        """(3,) what the foot is moved by."""
        place = self._place[side]
        faded = _FADE * self._shift[side]
        if place is None and score > _STANDS and toe[1] < _LOW:
            place = toe + faded
        elif place is not None and (score < _LEAVES or np.linalg.norm(place - toe) > _FARTHEST):
            place = None
        self._place[side] = place
        self._shift[side] = faded if place is None else place - toe
        return self._shift[side]


# ---- scenes: people who hold each other come close, arms go round bodies --------------------------------
EASES = 20
"""Frames over which a finish begins and ends: beside beats without it, and beside frames that are kept."""


def finished(request: SceneRequest, scene: Array) -> Array:
    """A scene as it is shown.

    Args:
        request: the scene's request.
        scene: (2, T, 22, 3) metres, its windows joined; frames that are kept of a given motion stay as they are.

    Returns:
        (2, T, 22, 3) float32.
    """
    free = _made(request, scene.shape[1])
    marks = np.zeros((2, scene.shape[1]), dtype=bool)  # palms meet, hands held
    for beat, finish in enumerate(finishes(request)):
        marks[:, request.edges[beat] : request.edges[beat + 1]] = np.array([finish.reaching, finish.held])[:, None]
    raised, held = np.stack([eased_marks(each, EASES) for each in marks]) * free
    result = in_touch(scene, free, raised, held).astype(np.float32)
    result[:, free <= 0] = scene[:, free <= 0]
    return result


def finishes(request: SceneRequest) -> tuple[BeatFinish, ...]:
    """The finish of each beat: as it was kept, or else as the words say."""
    if request.plan is not None and request.plan.finishes:
        return request.plan.finishes[: len(request.beats)]
    return tuple(finish_of(score) for score in (request.scores if request.plans_words else ()))


def finish_of(score: Score) -> BeatFinish:
    """The finish that a beat's words ask for."""
    around = any(gesture.gesture == "around" for gesture in score.gestures.values())
    return BeatFinish(bool(score.reaching), score.linked and not around)


def in_touch(scene: Array, free: Array, raised: Array, held: Array) -> Array:
    """Two people (2, T, 22, 3) who embrace closely, whose hands meet, and whose bodies are not in each other.

    Args:
        scene: (2, T, 22, 3) metres.
        free: (T,) how far a frame may be changed, 0 to 1.
        raised: (T,) likewise, where hands that are raised against each other meet.
        held: (T,) likewise, where hands are held.
    """
    result = backs_straight(bodies_apart(embraced(scene, free), FPS, free), raised)
    result = arms_apart(hands_clasped(result, held), np.stack([free, free]))
    return palms_met(result, raised)


def _made(request: SceneRequest, frames: int) -> Array:
    """(T,) 1 where a scene was made, easing to 0 at frames that are kept of a given motion."""
    if request.motion is None:
        return np.ones(frames)
    first, last = request.made
    at = np.arange(frames)
    before = (at - first + 1) / EASES if first else np.ones(frames)
    after = (last - at) / EASES if last < frames else np.ones(frames)
    return np.asarray(smoothstep(np.minimum(before, after) - 1 / EASES))
