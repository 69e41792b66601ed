"""What a window is given: which poses are held, which are drafts, and which are left to the network."""

from __future__ import annotations

import numpy as np
import pytest

from acts import read
from acts.staging.given import Story, places_alone, plan_parts
from acts.staging.poses import ALL, HANDS, JOINT, upright
from acts.staging.stage import scores_of
from acts.staging.window import KnownFrames, KnownPath, Part, Window
from motion import FPS, SMPL22
from motion.skeleton import FEET
from motion.transforms import Placement
from motion.vectors import direction

SECONDS = 5.0
FRAMES = round(SECONDS * FPS)


def parts_of(words: str) -> list[Part]:
    """What the only window of a sentence is given."""
    story = Story(scores_of([read(words).acts]), [SECONDS], [0, FRAMES], seed=0)
    placement = Placement(np.eye(3), np.zeros(3), np.zeros(3))
    return plan_parts(story, Window(0, 0, 0, FRAMES), np.zeros((2, FRAMES, 22, 3)), placement, ())


def poses_of(words: str) -> list[KnownFrames]:
    """The poses among them."""
    return [part for part in parts_of(words) if isinstance(part, KnownFrames)]


@pytest.mark.parametrize("words", ["They waltz.", "They dance."])
def test_two_who_dance_have_feet_that_are_given_and_do_not_cross(words: str) -> None:
    feet = [np.asarray(part.positions)[:, FEET] for part in poses_of(words) if set(part.joints) == set(FEET)]
    a, b = feet
    assert np.linalg.norm(a[:, :, None] - b[:, None], axis=-1).min() > 0.04


@pytest.mark.parametrize(("words", "towards"), [("A pushes B.", 1.0), ("A pushes B from behind.", -1.0)])
def test_who_is_pushed_is_touched_until_they_step_away(words: str, towards: float) -> None:
    (hands,) = (part for part in poses_of(words) if part.person == 0 and JOINT["left_wrist"] in part.joints)
    (way,) = (part for part in parts_of(words) if isinstance(part, KnownPath) and part.person == 1 and part.turned)
    gone = np.interp(np.arange(FRAMES), way.frames, np.linalg.norm(way.places - way.places[0], axis=1))
    assert gone[hands.frames[0]] < 0.05 < gone[min(hands.frames[-1] + 15, FRAMES - 1)] and gone[-1] > 0.5
    away = np.asarray(way.places[-1]) - np.asarray(hands.positions)[-1, 0, [0, 2]]
    assert way.headings is not None and towards * (direction(way.headings[-1]) @ away) < -0.5, "the face to the other"


def test_jumps_are_held_and_postures_are_drafts() -> None:
    assert {part.soft for part in poses_of("A jumps.") if part.person == 0} == {False}
    assert {part.soft for part in poses_of("A kneels.") if part.person == 0} == {True}


def test_who_keeps_their_back_to_the_other_does_a_figure_where_they_stand() -> None:
    (body,) = (part for part in poses_of("A keeps his back to B and does a push-up.") if part.person == 0)
    assert set(body.joints) == set(ALL) and np.asarray(body.positions)[:, 0, 1].min() < 0.5


@pytest.mark.parametrize(
    ("words", "held", "head"),
    [
        ("A scratches his head.", True, True),
        ("A puts his hands on his hips.", True, False),
        ("A kneels down and hides his face in his hands.", True, True),
        ("A walks past B holding a phone to his ear.", True, True),
        ("A points at B.", False, False),
    ],
)
def test_a_hand_on_ones_own_body_is_held_as_a_touch_is(words: str, held: bool, head: bool) -> None:
    (arms,) = (part for part in poses_of(words) if part.person == 0 and JOINT["right_elbow"] in part.joints)
    assert arms.soft is not held
    assert (JOINT["head"] in arms.joints) is head, "of somebody on their way the head is where the hand finds it"


def test_whose_hands_are_busy_is_drafted_as_walking_without_hands_and_not_as_waiting() -> None:
    parts = [part for part in poses_of("They walk up to each other and shake hands.") if part.person == 1]
    assert parts and not any(set(HANDS) & set(part.joints or ALL) for part in parts)
    assert max(part.frames[-1] for part in parts) < 80, "while they walk"


def test_who_walks_is_drafted_from_head_to_foot_and_held_to_the_way_and_by_the_feet() -> None:
    (feet, walks, _) = (part for part in poses_of("A walks up to B.") if part.person == 0)
    assert walks.soft and walks.free and not walks.joints
    assert not feet.soft and {SMPL22.joint_names[joint][-5:] for joint in feet.joints} == {"ankle", "_foot"}
    legs = np.asarray(walks.positions)[:, [JOINT["left_ankle"], JOINT["right_ankle"]]]
    assert np.ptp(legs[:, 0, 2] - legs[:, 1, 2]) > 0.8, "in strides"


def test_who_moves_the_head_stands_as_recorded_people_do() -> None:
    (held,), (free,) = ([part for part in poses_of("A nods.") if part.person == 0 and part.free == f] for f in (0, 1))
    assert held.kept and not set(held.joints) & set(free.joints) and len(held.joints) + len(free.joints) == 22
    hips = np.asarray(held.positions)[:, 0]
    assert np.ptp(hips, axis=0).max() > 0.01, "they shift their weight"


def test_who_has_arrived_waits_as_recorded_people_do() -> None:
    assert [part for part in poses_of("B walks up to A.") if part.person == 1 and part.free]


def test_who_pulls_the_other_up_bends_down_once_they_are_there() -> None:
    (pulls,) = (p for p in poses_of("B helps A up.") if p.person == 1 and not p.soft and JOINT["neck"] in p.joints)
    ways = [part for part in poses_of("B helps A up.") if part.person == 1 and part.free]
    assert min(pulls.frames) > max(ways[0].frames) - 10, "they walk up bent, with an arm stretched out"


@pytest.mark.parametrize(("words", "together"), [("They flap their arms.", True), ("They beckon.", False)])
def test_two_make_a_gesture_in_time_or_each_in_their_own(words: str, together: bool) -> None:
    a, b = (part.positions for part in poses_of(words) if JOINT["right_wrist"] in part.joints)
    wrist = JOINT["right_wrist"]
    assert np.allclose(np.asarray(a)[:, wrist, 1], np.asarray(b)[:, wrist, 1], atol=1e-3) is together


@pytest.mark.parametrize(("words", "rests"), [("A pats B on the back.", True), ("A pats B on the shoulder.", False)])
def test_the_hand_hangs_after_pats_of_the_back(words: str, rests: bool) -> None:
    (arm,) = (part for part in poses_of(words) if part.person == 0)
    assert (arm.frames[-1] > FRAMES - 10) is rests


def test_without_poses_the_places_of_people_are_left_and_how_low_they_are() -> None:
    frames = list(range(0, 61, 4))
    poses = np.stack([upright(np.array([0.0, t / 60]), 0.5) for t in frames])
    way = KnownPath(1, [3], np.zeros((1, 2)))
    path, same = places_alone([KnownFrames(0, frames, poses), KnownFrames(0, frames, poses, joints=HANDS), way])
    assert same is way and isinstance(path, KnownPath) and path.frames == [0, 32, 60]
    np.testing.assert_allclose(path.places, poses[[0, 8, 15], 0][:, [0, 2]])
    assert path.turned and path.headings == pytest.approx([0.5] * 3)
    low, path = places_alone([KnownFrames(0, frames, poses - np.outer(np.arange(16) > 7, [0.0, 0.6, 0.0])[:, None])])
    assert isinstance(low, KnownFrames) and low.joints == (0,) and low.frames == frames[8:]
    assert isinstance(path, KnownPath) and not path.turned and path.headings is None, "the hips of who lies say nothing"
    assert path.frames == [0, 28]
