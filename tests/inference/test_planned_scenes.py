"""Postures, jumps and gestures of the words are met by a network that has learned nothing."""

from __future__ import annotations

import numpy as np
import pytest

from acts.staging.poses import posed
from acts.staging.postures import posture_joints
from motion import SMPL22
from motion.kinematics import bone_lengths
from motion.metrics.quality import mirror_gap
from webdemo.inference import Engine, GenerateRequest, SceneRequest
from webdemo.inference.story import Beat

from .planned import FEET, QUICK, WRISTS, heights, made
from .runs import positions, run


def test_who_sits_down_stays_seated_until_they_get_up(engine: Engine) -> None:
    beats = (
        Beat("Person A sits down.", seconds=3.0),
        Beat("Person B waves.", seconds=2.0),
        Beat("Person A gets up.", seconds=3.0),
    )
    found = heights(positions(run(engine, SceneRequest(beats=beats, **QUICK))), 0)
    assert found[0] > 0.9, "on their feet at first"
    assert (np.abs(found[60:150] - 0.63) < 0.08).all(), "seated, also in the next beat"
    assert found[-1] > 0.85
    free = heights(positions(run(engine, SceneRequest(beats=beats, planned=False, **QUICK))), 0)
    assert not (np.abs(free[60:150] - 0.63) < 0.08).all()


def test_who_falls_ends_on_the_floor_and_may_be_helped_up(engine: Engine) -> None:
    assert heights(made(engine, "Person A falls over."), 0)[-20:].max() < 0.35
    found = heights(made(engine, "One falls to the ground and the other helps him up again.", seconds=6.0), 0)
    assert found[0] > 0.85 and found.min() < 0.35 and found[-5] > 0.85


def test_who_has_thrown_stands_still_while_the_other_has_it(engine: Engine) -> None:
    found = made(engine, "A throws a ball to B and B catches it.", seconds=6.0)
    hands, holds = (found - found[:, :, :1])[:, :, WRISTS]
    speed = np.linalg.norm(np.diff(hands, axis=0), axis=-1).max(axis=1) * 30
    assert speed[:60].max() > 3.0, "the throw"
    assert speed[110:].max() < 1.0
    assert hands[110:, :, 1].max() < 0.1, "arms hang"
    assert np.abs(holds[110:, :, 2]).min() > 0.3, "the ball is held"
    assert (np.linalg.norm(np.diff(found, axis=1), axis=-1) * 30).max() < 9.0, "a hand jumps"


def test_who_stands_in_a_given_motion_sits_down_for_words_that_have_them_seated(engine: Engine) -> None:
    motion = run(engine, SceneRequest(beats=(Beat("Person B stands still.", seconds=2.0),), **QUICK)).duets[0]
    assert heights(motion.positions, 1)[-1] > 0.85
    beats = (Beat("Person B stays seated.", seconds=3.0),)
    found = heights(positions(run(engine, SceneRequest(beats=beats, motion=motion, **QUICK))), 1)
    assert (np.abs(found[-30:] - 0.63) < 0.08).all()


def test_jumps_leave_the_floor_as_often_as_said(engine: Engine) -> None:
    found = made(engine, "Person A jumps up and down.", cleanup=False)
    feet = found[0][:, FEET, 1].min(axis=1)
    airborne = feet > 0.12
    assert np.sum(np.diff(airborne.astype(int)) == 1) == 3
    assert not (found[1][:, FEET, 1].min(axis=1) > 0.12).any()


def test_a_hand_waves_on_the_way(engine: Engine) -> None:
    prompt = "Person A walks away while waving with the left hand."
    found, free = made(engine, prompt), made(engine, prompt, planned=False)

    def lifted(motion: np.ndarray) -> np.ndarray:
        return motion[0, 30:110, WRISTS[0], 1] - motion[0, 30:110, SMPL22.index("left_shoulder"), 1]

    assert np.median(lifted(found)) > 0.1 > np.median(lifted(free))


def test_who_lies_stays_on_the_floor_in_the_next_beat(engine: Engine) -> None:
    beats = (Beat("Person A lies down.", seconds=3.7), Beat("Person B watches.", seconds=2.0))
    result = run(engine, SceneRequest(beats=beats, **QUICK))
    assert heights(positions(result), 0)[60:].max() < 0.3
    given = [part["frames"] for part in result.manifest["plan"]["windows"][0]["parts"] if part["person"] == 0]
    assert max(map(max, given)) == 111 + 8 - 1, "lying also in the frames that are thrown away"


def test_who_lies_is_given_the_trunk_and_who_sits_the_legs_alone() -> None:
    def sided(*joints: str) -> set[str]:
        return {f"{side}_{joint}" for side in ("left", "right") for joint in joints}

    given = {}
    for name in ("lies", "bends down", "sits"):
        ((joints, frames, poses),) = posture_joints([(3, posed(name, np.zeros(2), 0.0))], 0, 10)
        assert list(frames) == [3] and poses.shape == (1, SMPL22.num_joints, 3)
        given[name] = {SMPL22.joint_names[joint] for joint in joints}
    assert given["lies"] == given["bends down"] > given["sits"]
    assert {"pelvis", "left_ankle", "right_foot"} < given["sits"]
    ((joints, *_),) = posture_joints([(3, posed("bends down", np.zeros(2), 0.0))], 0, 10, arms=True)
    assert {SMPL22.joint_names[joint] for joint in joints} - given["bends down"] == sided("elbow", "wrist")
    assert given["lies"] - given["sits"] == {"spine2", "spine3", "neck", "head"} | sided("collar", "shoulder")


def test_who_lies_from_the_start_lies_across_the_way_of_the_other(engine: Engine) -> None:
    found = made(engine, "Person B is lying on the floor and person A stands by.")
    body = (found[1, 5, SMPL22.index("head")] - found[1, 5, 0])[[0, 2]]
    line = (found[0, 5, 0] - found[1, 5, 0])[[0, 2]]
    assert abs(body @ line) < 0.35 * np.linalg.norm(body) * np.linalg.norm(line)


def test_those_who_only_clap_have_their_hands_led(engine: Engine) -> None:
    for person in made(engine, "They clap."):
        gap = np.linalg.norm(person[:, WRISTS[0]] - person[:, WRISTS[1]], axis=1)
        assert gap[50:-45].min() < 0.25 and gap[50:-45].max() < 0.5


def test_two_who_wave_do_not_wave_as_one(engine: Engine) -> None:
    found = made(engine, "They wave to each other.", seconds=5.0)
    risen = [int(np.argmax(person[:, WRISTS[1], 1] - person[:, 0, 1] > 0.3)) for person in found]
    assert min(risen) > 5 and abs(risen[0] - risen[1]) >= 3


def test_an_arm_begins_where_the_beat_before_left_it(engine: Engine) -> None:
    beats = (Beat("Person A raises the right hand.", seconds=2.0), Beat("Person A waves.", seconds=3.0))
    found = positions(run(engine, SceneRequest(beats=beats, **QUICK)))[0]
    high = found[:, WRISTS[1], 1] - found[:, 0, 1]
    assert high[50:75].min() > 0.45, "the hand that is up stays up"


def test_who_claps_beside_a_jump_brings_the_hands_together(engine: Engine) -> None:
    found = made(engine, "Person A jumps for joy and person B claps.", seconds=6.0)[1]
    wrists = [found[:, SMPL22.index(f"{side}_wrist")] for side in ("left", "right")]
    gap = np.linalg.norm(wrists[0] - wrists[1], axis=1)[15:-15]
    meets = np.sum(np.diff((gap < 0.28).astype(int)) == 1)
    assert gap.min() < 0.25 and meets >= 3 and heights(found[None].repeat(2, axis=0), 0).min() > 0.7


def test_hands_are_at_a_window_from_when_the_person_has_come_to_it(engine: Engine) -> None:
    result = run(engine, GenerateRequest(prompt="A opens the window.", **{"seconds": 5.0, **QUICK}))
    found = positions(result)[0]
    gone = np.linalg.norm((found[:, 0] - found[0, 0])[:, [0, 2]], axis=1)
    out = np.linalg.norm((found[:, WRISTS] - found[:, None, 0])[..., [0, 2]], axis=-1).min(axis=1)
    there = int(np.argmax(gone > gone[-1] - 0.1))
    assert gone[-1] > 1.0 and out[there + 20 :].min() > 0.25
    window = result.manifest["things"][0]
    assert window["kind"] == "window" and window["events"][0]["at"] > there / 30 - 0.5


def test_a_look_at_a_window_is_judged_where_the_window_is_made(engine: Engine) -> None:
    result = run(engine, GenerateRequest(prompt="A looks out of the window.", **{"seconds": 5.0, **QUICK}))
    (row,) = result.manifest["checked"]
    assert row["act"] == "look-at-thing" and row["done"] is not None and row["measure"].startswith("looks at it for ")


@pytest.mark.parametrize(
    ("prompt", "joint", "least"),
    [
        ("He stamps his right foot.", "right_foot", 0.1),
        ("She stands on tiptoe.", "left_ankle", 0.12),
        ("He marches on the spot.", "left_foot", 0.15),
    ],
)
def test_clean_up_leaves_a_foot_that_is_raised_or_a_heel(engine: Engine, prompt: str, joint: str, least: float) -> None:
    motion = made(engine, prompt)
    assert motion[0, :, SMPL22.index(joint), 1].max() > least
    assert np.ptp(bone_lengths(motion), axis=1).max() < 0.01, "an arm that is free goes with the shoulder"


def test_a_head_that_is_tilted_stays_so_and_is_not_turned_to_the_other(engine: Engine) -> None:
    motion = made(engine, "She tilts her head.")
    neck, head = (motion[0, :, SMPL22.index(name)] for name in ("neck", "head"))
    assert np.abs((head - neck)[45:90, 0]).min() > 0.02


@pytest.mark.parametrize(("words", "most"), [("sits on the ground", 0.3), ("lies on the ground", 0.3), ("kneels", 0.7)])
def test_who_goes_down_is_down_whatever_the_network_makes(reading_engine: Engine, words: str, most: float) -> None:
    assert made(reading_engine, f"Person A {words}.")[0, 75:-10, 0, 1].max() < most


def test_the_arms_of_who_moves_a_leg_or_the_head_differ(engine: Engine) -> None:
    for words in ("Person A raises the left leg.", "Person A shakes the head."):
        assert mirror_gap(made(engine, words)[0].astype(np.float64)[20:-20]) > 1.5
