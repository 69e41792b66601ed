"""Touches by pair of body regions, and how made ones compare with recorded ones."""

from __future__ import annotations

import numpy as np
import pytest

from motion import SMPL22
from motion.metrics import contact_precision_recall, region_contacts
from motion.metrics.regions import PAIRS

from .scenes import duet, face_to_face, put_wrist


def joint(positions: np.ndarray, person: int, name: str) -> np.ndarray:
    return positions[person, 0, SMPL22.index(name)]


def touching(name: str, person: int = 0, frames: slice = slice(20, 40)) -> np.ndarray:
    """a's or b's right hand on a joint of the other; the palm is 8 cm below the wrist."""
    positions = face_to_face(1.5)
    goal = joint(positions, 1 - person, name) + np.array([0.0, 0.08, 0.0])
    put_wrist(positions, person, "right_wrist", goal, frames)
    return positions


@pytest.mark.parametrize(
    ("name", "pair"),
    [("left_shoulder", "hand–shoulder"), ("spine2", "hand–chest"), ("head", "hand–head"), ("left_elbow", "hand–arm")],
)
@pytest.mark.parametrize("person", [0, 1])
def test_a_hand_on_a_region_is_that_persons_touch(name: str, pair: str, person: int) -> None:
    found = region_contacts(duet(touching(name, person)))[pair]
    assert found.shape == (2, 60)
    assert found[person, 20:40].all() and not found[person, :19].any()
    assert not found[1 - person].any()


def test_hands_that_meet_are_no_hand_on_an_arm() -> None:
    positions = face_to_face(1.5)
    for person, name in ((0, "right_wrist"), (1, "right_wrist")):
        put_wrist(positions, person, name, np.array([0.0, 1.2, 0.75]), slice(20, 40))
    found = region_contacts(duet(positions))
    assert found["hand–hand"][:, 20:40].all() and not found["hand–arm"].any()


def test_people_apart_touch_nowhere_and_feet_side_by_side_are_no_kick() -> None:
    apart = region_contacts(duet(face_to_face(3.0)))
    assert list(apart) == list(PAIRS) and not any(mask.any() for mask in apart.values())
    close = face_to_face(0.35)
    assert not region_contacts(duet(close))["foot–body"].any()


def test_a_foot_in_the_body_is_a_kick() -> None:
    positions = face_to_face(1.0)
    foot = SMPL22.index("right_foot")
    positions[0, 20:40, foot] = joint(positions, 1, "left_knee") + np.array([0.0, 0.2, 0.0])
    found = region_contacts(duet(positions))["foot–body"]
    assert found[0, 20:40].all() and not found[1].any()


def test_chests_touch_within_five_centimetres() -> None:
    assert region_contacts(duet(face_to_face(0.25)))["chest–chest"].all()
    assert not region_contacts(duet(face_to_face(0.6)))["chest–chest"].any()


def test_exchanged_people_touch_wrongly() -> None:
    on_b = duet(touching("left_shoulder"))
    assert contact_precision_recall([on_b], [on_b])["hand–shoulder"] == {"precision": (1, 1), "recall": (1, 1)}
    other = contact_precision_recall([on_b.swapped()], [on_b])["hand–shoulder"]
    assert other == {"precision": (0, 1), "recall": (0, 1)}
    nothing = contact_precision_recall([duet(face_to_face(3.0))], [on_b])["hand–shoulder"]
    assert nothing == {"precision": (0, 0), "recall": (0, 1)}


def test_a_touch_of_an_instant_does_not_count() -> None:
    blink = duet(touching("left_shoulder", frames=slice(20, 22)))
    assert contact_precision_recall([blink], [blink])["hand–shoulder"]["recall"] == (0, 0)
