"""Touches that a beat's words name, and where the hand goes."""

from __future__ import annotations

import numpy as np
import pytest

from acts.shapes import Part
from acts.staging.poses import bending, posed, upright
from acts.staging.score import Touch
from acts.staging.touches import beside, kneels, lean, middle, reach, touched, touching
from motion import SMPL22

from .staged_words import score

ORIGIN = np.zeros(2)


@pytest.mark.parametrize(
    ("sentence", "found"),
    [
        ("Person B pats person A on the shoulder.", ("b", "shoulder", 1, 2)),
        ("Person A lays a hand on person B's head.", ("a", "head", 1, 0)),
        ("A puts both hands on B's shoulders", ("a", "shoulder", 2, 0)),
        ("Person A is tapped on the back by person B.", ("b", "back", 1, 2)),
        ("The man kisses her.", ("a", "head", 0, 0)),
        ("She examines his knee.", ("a", "leg", 1, 0)),
        ("Person B gets hugged from behind by person A.", ("a", "waist", 2, 0)),
        ("Person A pushes person B to the ground.", ("a", "chest", 2, 1)),
        # none that is planned
        ("He kisses her hand.", None),
        ("They shake hands.", None),
    ],
)
def test_contacts_are_read(sentence: str, found: tuple[str, str, int, int] | None) -> None:
    touch = score(sentence).touch
    assert (touch and (touch.person, touch.part, len(touch.sides), touch.times)) == found


def test_a_named_hand_touches_and_a_touch_may_come_late() -> None:
    touch = score("Person A taps person B on the shoulder with the left hand.").touch
    assert touch is not None and touch.sides == ("left",) and not touch.late
    late = score("They argue until person A pats person B on the head.").touch
    assert late is not None and late.late


@pytest.mark.parametrize("part", ["head", "shoulder", "back", "chest", "arm", "hand"])
def test_a_hand_that_comes_near_is_at_the_joint(part: Part) -> None:
    touch = Touch(person="a", part=part, hands="right")
    for pose in (upright(ORIGIN, np.pi), posed("kneels", ORIGIN, np.pi)):
        apart = reach(touch, pose)
        assert 0.3 < apart < 1.0
        head = pose[SMPL22.index("head")] if part == "head" else pose[0]
        place = np.array([head[0], head[2] - apart])
        own = bending(place, 0.0, lean(touch, pose))
        (wrist,) = touched(touch, pose, own)
        assert np.linalg.norm(pose - wrist, axis=1).min() < 0.16
        assert np.linalg.norm(own[SMPL22.index("right_shoulder")] - wrist) < 0.75, "about an arm away"


@pytest.mark.parametrize("part", ["head", "shoulder", "chest", "leg", "foot"])
def test_who_touches_a_person_who_lies_kneels_down_beside_them(part: Part) -> None:
    touch, pose = Touch(person="a", part=part, hands="right"), posed("lies", ORIGIN, 0.0)
    heading = beside(pose, np.array([2.0, -1.0]))
    assert heading is not None and abs(heading + np.pi / 2) < 0.01, "across the body, from their side of it"
    place = middle(touch, pose)[[0, 2]] + reach(touch, pose) * np.array([1.0, 0.0])
    own = touching(touch, pose, place, heading)
    (wrist,) = touched(touch, pose, own)
    assert kneels(touch, pose) and own[0, 1] < 0.6
    assert np.linalg.norm(own[SMPL22.index("right_shoulder")] - wrist) < 0.6, "about an arm away"


def test_nobody_kneels_to_touch_a_person_on_their_feet_above_the_knee() -> None:
    parts: tuple[Part, ...] = ("head", "arm", "hand", "chest")
    for part in parts:
        assert not kneels(Touch(person="a", part=part, hands="right"), upright(ORIGIN, 0.0))
    assert kneels(Touch(person="a", part="foot", hands="right"), upright(ORIGIN, 0.0))
    assert beside(upright(ORIGIN, 0.0), np.ones(2)) is None


def test_arms_go_round_who_is_hugged_or_blinded_from_behind() -> None:
    touch = score("Person A hugs person B from behind.").touch
    assert touch is not None and touch.behind
    other = upright(ORIGIN, 0.0)
    own = upright(np.array([0.0, -reach(touch, other)]), 0.0)
    for wrist in touched(touch, other, own):
        assert wrist[2] > other[SMPL22.index("spine2"), 2] and abs(wrist[0]) < 0.1, "before the chest"
    touch = score("A covers B's eyes.").touch
    assert touch is not None and touch.behind
    own = upright(np.array([0.0, -reach(touch, other)]), 0.0)
    for wrist in touched(touch, other, own) - other[SMPL22.index("head")]:
        assert 0.02 < wrist[2] < 0.12 and 0.05 < abs(wrist[0]) < 0.15, "at the temples, the palms before the eyes"


def test_who_reaches_down_leans_forward_and_who_reaches_up_does_not() -> None:
    touch = Touch(person="a", part="shoulder", hands="right")
    assert lean(touch, posed("lies", ORIGIN, 0.0)) > 0.9 > 0.2 > lean(touch, upright(ORIGIN, 0.0))


def test_two_hands_are_apart_and_a_back_is_touched_from_behind() -> None:
    other, own = upright(ORIGIN, 0.0), upright(np.array([0.0, -0.5]), 0.0)
    left, right = touched(Touch(person="a", part="head", hands="both"), other, own)
    assert left[0] - right[0] > 0.1
    (wrist,) = touched(Touch(person="a", part="back", hands="right"), other, own)
    spine, shoulder = (other[SMPL22.index(name)] for name in ("spine3", "right_shoulder"))
    assert np.linalg.norm(wrist - spine) < 0.2 and wrist[2] < spine[2]
    (front,) = touched(Touch(person="a", part="back", hands="right"), other, upright(np.array([0.0, 0.5]), np.pi))
    assert np.linalg.norm(front - shoulder) > np.linalg.norm(front - other[SMPL22.index("left_shoulder")])
