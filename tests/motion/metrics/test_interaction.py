"""Distances, facing and contacts of motions whose values are known."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from motion import SMPL22, Duet
from motion.metrics import MEASURES, compare, contact_events
from motion.metrics.interaction import facing_angle
from motion.transforms import turn

from .scenes import duet, face_to_face, put_wrist


@pytest.mark.parametrize("degrees", [0, 60, 90, 180])
def test_facing_is_the_angle_by_which_a_person_has_turned(degrees: float) -> None:
    scene = face_to_face(2.0)
    scene[0] = turn(scene[0], np.radians(degrees))
    angles = facing_angle(duet(scene))
    np.testing.assert_allclose(angles[0], degrees, atol=0.1)
    np.testing.assert_allclose(angles[1], 0, atol=0.1)


def test_hands_that_meet_are_one_contact_with_its_frames() -> None:
    scene = face_to_face(2.0)
    for person, gap in ((0, -0.04), (1, 0.04)):
        put_wrist(scene, person, "right_wrist", np.array([0, 1.0, 1.0 + gap]), slice(20, 40))
    (contact,) = contact_events(duet(scene))
    assert (contact.start, contact.stop, contact.kind) == (20, 40, "hands")


def test_a_hand_on_the_chest_says_whose() -> None:
    scene = face_to_face(2.0)
    chest = scene[1, 0, SMPL22.index("spine3")]
    put_wrist(scene, 0, "left_wrist", chest + np.array([0, 0.08, -0.14]), slice(10, 30))
    (contact,) = contact_events(duet(scene))
    assert (contact.start, contact.stop) == (10, 30)
    assert contact.label == "hand of A on B"


def test_a_kick_is_a_contact_but_standing_toe_to_toe_is_not() -> None:
    scene = face_to_face(2.0)
    scene[0, 30:40, SMPL22.index("right_foot")] = scene[1, 0, SMPL22.index("spine1")] - np.array([0, 0, 0.15])
    (contact,) = contact_events(duet(scene))
    assert (contact.kind, contact.label) == ("foot", "foot of A on B")
    scene = face_to_face(2.0)
    scene[0, :, SMPL22.index("right_foot")] = scene[1, 0, SMPL22.index("left_foot")]
    assert contact_events(duet(scene)) == []


def test_what_is_compared_is_json_with_every_measure() -> None:
    found = json.loads(json.dumps(compare(None, duet(face_to_face(2.0))), allow_nan=False))
    assert list(found["after"]) == [measure.key for measure in MEASURES] and found["before"] is None
    assert found["after"]["distance"] == pytest.approx(2.0, abs=1e-3)


DATA = Path(__file__).resolve().parents[2] / "data" / "contacts.npz"
TOLERANCE = 6  # frames: 0.2 s
AGREE = 26


def _examples() -> list[tuple[Duet, str, int, int]]:
    stored = np.load(DATA)
    whole = np.cumsum(stored["steps"], axis=0, dtype=np.int16) / 1000
    motions = np.split(whole, np.cumsum(stored["frames"])[:-1])
    return [
        (Duet.from_positions(m.reshape(-1, 2, 22, 3).swapaxes(0, 1), fps=30), str(kind), int(start), int(stop))
        for m, kind, start, stop in zip(motions, stored["kind"], stored["start"], stored["stop"], strict=True)
    ]


def _agrees(duet: Duet, kind: str, start: int, stop: int) -> bool:
    """Whether there is one stretch of contact, of the marked kind where hands meet, at the marked time."""
    found = contact_events(duet)
    if kind == "none":
        return not found
    if kind == "hands" and [contact.kind for contact in found] != ["hands"]:
        return False
    touched = sorted({frame for contact in found for frame in range(contact.start, contact.stop)})
    one = bool(touched) and int(np.diff(touched).max(initial=1)) <= 3
    return one and abs(touched[0] - start) <= TOLERANCE and abs(touched[-1] + 1 - stop) <= TOLERANCE


def test_contacts_are_where_a_person_marked_them() -> None:
    examples = _examples()
    assert len(examples) == 30
    agreed = [_agrees(*example) for example in examples]
    assert sum(agreed) >= AGREE, np.flatnonzero(~np.array(agreed))
