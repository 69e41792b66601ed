"""People of different sizes: feet that stand still stand, hands that touch still touch, and adults stay as they are."""

from __future__ import annotations

import numpy as np

from motion import SMPL22
from motion.cleaning import foot_contacts, plant_feet
from motion.footsteps import stepping
from motion.kinematics import bone_lengths
from motion.looks import SIZES
from motion.sizes import at_sizes, floor_scale, of_adults
from motion.skeleton import LEGS
from motion.swings import above_floor
from motion.transforms import heading_matrix

FPS, CHILD = 30.0, SIZES["girl"]
MIXED = (1.0, CHILD)
J = SMPL22.index
FLAT = np.array([1.0, 0.0, 1.0])
ANKLES = [J("left_ankle"), J("right_ankle")]


def standing() -> np.ndarray:
    """Somebody on their feet with knees a little bent and arms that hang: (22, 3), facing +Z, the lowest joint at 0."""
    pose = SMPL22.rest_positions()
    for side, out in (("left", 0.1), ("right", -0.1)):
        for joint, reach in ((f"{side}_elbow", 0.26), (f"{side}_wrist", 0.52)):
            pose[J(joint)] = pose[J(f"{side}_shoulder")] + reach * np.array([out, -0.99, 0.1])
    return np.asarray(pose - pose[:, 1].min() * np.array([0.0, 1.0, 0.0]))


def walking(seconds: float = 4.0, speed: float = 0.9) -> np.ndarray:
    """(T, 22, 3) a person who goes along Z in steps."""
    frames = round(seconds * FPS)
    body = np.tile(standing(), (frames, 1, 1))
    body[..., 1] -= 0.03
    body[..., 2] += speed * np.linspace(0, seconds, frames)[:, None]
    walked = stepping(above_floor(body), FPS)
    return plant_feet(walked, foot_contacts(walked, FPS))


def hand_in_hand() -> np.ndarray:
    """(2, T, 22, 3) two who walk side by side and hold hands."""
    one, other = walking(), walking()
    other[..., 0] -= 0.62
    for person, side in ((one, "right"), (other, "left")):
        shoulder = person[:, J(f"{side}_shoulder")]
        hand = 0.5 * (one[:, J("right_shoulder")] + other[:, J("left_shoulder")]) - [0.0, 0.5, 0.0]
        elbow = 0.5 * (shoulder + hand) - [0.0, 0.0, 0.06]
        person[:, J(f"{side}_elbow")], person[:, J(f"{side}_wrist")] = elbow, hand
    return np.stack([one, other])


def slides(person: np.ndarray, size: float) -> float:
    """Metres a second of joints of the feet that stand."""
    stands = foot_contacts(person / size, FPS)
    feet = person[:, [joint for leg in LEGS for joint in leg[2:]]]
    speed = np.linalg.norm(np.diff(feet * FLAT, axis=0), axis=-1) * FPS
    return float(speed[stands[1:] & stands[:-1]].mean())


def test_feet_that_stand_do_not_slide_and_the_two_go_as_far() -> None:
    pair = hand_in_hand()
    found = at_sizes(pair, MIXED)
    for person, size in enumerate(MIXED):
        assert slides(found[person], size) < max(1.2 * slides(pair[person], 1.0), 0.02)
        assert found[person, :, [joint for leg in LEGS for joint in leg[2:]], 1].min() > -1e-6
    went = found[:, -1, 0, 2] - found[:, 0, 0, 2]
    np.testing.assert_allclose(went, floor_scale(MIXED) * (pair[0, -1, 0, 2] - pair[0, 0, 0, 2]), atol=0.03)


def test_hands_that_hold_each_other_still_do() -> None:
    pair = hand_in_hand()
    found = at_sizes(pair, MIXED)
    apart = np.linalg.norm(found[0, :, J("right_wrist")] - found[1, :, J("left_wrist")], axis=-1)
    assert apart.max() < 0.02
    natural = CHILD * pair[1, :, J("left_wrist"), 1]
    assert (found[1, :, J("left_wrist"), 1] > natural + 0.1).all(), "the child's hand is raised"


def test_a_hand_on_the_head_is_on_the_childs_head() -> None:
    man, child = (np.tile(standing(), (60, 1, 1)) for _ in range(2))
    child = child @ heading_matrix(np.pi).T + np.array([0.0, 0.0, 0.6])
    hand = child[:, J("head")] + [0.0, 0.06, -0.09]
    shoulder = man[:, J("right_shoulder")]
    man[:, J("right_wrist")] = shoulder + 0.5 * (hand - shoulder) / np.linalg.norm(hand - shoulder, axis=-1)[:, None]
    man[:, J("right_elbow")] = 0.5 * (shoulder + man[:, J("right_wrist")]) - [0.0, 0.08, 0.0]
    found = at_sizes(np.stack([man, child]), MIXED)
    wrist, head = found[0, :, J("right_wrist")], found[1, :, J("head")]
    assert (np.linalg.norm(wrist - head, axis=-1) < 0.22).all()
    assert (wrist[:, 1] > head[:, 1] + 0.08).all(), "from above"
    np.testing.assert_allclose(head[:, 1], CHILD * child[:, J("head"), 1], atol=0.03)


def test_a_child_is_lifted_to_where_the_adults_hands_are() -> None:
    frames = 90
    pair = np.stack([np.tile(standing(), (frames, 1, 1))] * 2)
    pair[1] = pair[1] @ heading_matrix(np.pi).T + np.array([0.0, 0.0, 0.4])
    up = 0.5 * np.clip((np.arange(frames) - 20) / 20, 0, 1)
    pair[1, ..., 1] += up[:, None]
    chest = J("spine3")
    found = at_sizes(pair, MIXED)
    assert abs(found[1, -1, chest, 1] - pair[1, -1, chest, 1]) < 0.03
    assert abs(found[1, 0, chest, 1] - CHILD * pair[1, 0, chest, 1]) < 0.03
    np.testing.assert_allclose(
        found[0, :, ANKLES], pair[0, :, ANKLES] * [floor_scale(MIXED), 1, floor_scale(MIXED)], atol=0.02
    )


def test_who_lies_with_their_toes_up_is_not_lifted() -> None:
    adult, child = (np.tile(standing(), (60, 1, 1)) for _ in range(2))
    on_back = np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])  # the face and the toes up
    lying = standing() @ on_back.T
    adult[:] = lying + (0.08 - lying[:, 1].min()) * np.array([0.0, 1.0, 0.0])
    child[..., 2] += adult[0, 0, 2] + 0.6
    found = at_sizes(np.stack([adult, child]), MIXED)
    np.testing.assert_allclose(found[0, :, 0, 1], adult[:, 0, 1], atol=0.01)


def test_adults_come_back_from_children() -> None:
    pair = hand_in_hand()
    back = of_adults(at_sizes(pair, MIXED), MIXED)
    np.testing.assert_allclose(bone_lengths(back), bone_lengths(pair), atol=0.01)
    np.testing.assert_allclose(back[:, :, ANKLES], pair[:, :, ANKLES], atol=0.01)
    np.testing.assert_allclose(back[:, :, 0] * FLAT, pair[:, :, 0] * FLAT, atol=0.01)
    assert (np.abs(back - pair)[:, :, 0, 1] < 0.1).all(), "who has bent their knees keeps them bent"
    np.testing.assert_allclose(of_adults(CHILD * pair, (CHILD, CHILD)), pair)


def test_the_taller_looks_down_at_the_child() -> None:
    pair = np.stack([np.tile(standing(), (40, 1, 1))] * 2)
    pair[1] = pair[1] @ heading_matrix(np.pi).T + np.array([0.0, 0.0, 1.0])
    found = at_sizes(pair, MIXED)
    nods = [found[p, 20, J("head")] - found[p, 20, J("neck")] for p in (0, 1)]
    before = pair[0, 20, J("head")] - pair[0, 20, J("neck")]
    assert nods[0][1] < before[1] - 0.01, "down"
    assert nods[1][1] > CHILD * before[1] + 0.005, "up"
