"""Lifts, as words name them and as bodies make them."""

from __future__ import annotations

import numpy as np
import pytest

from acts.staging import recordings
from acts.staging.score import Lift
from motion import SMPL22
from motion.metrics.quality import limb_depth
from motion.vectors import Array

from .staged_words import beginning, score


def carried(carry: str, place: Array, angle: float) -> Array:
    """(2, 22, 3) the person carried, and the carrier at a place (2,) with a heading."""
    return np.concatenate(recordings.carried(carry, place[None], np.array([angle])))


@pytest.mark.parametrize(
    ("words", "found"),
    [
        ("He picks her up.", Lift(carrier="a", carry="up")),
        ("He picks her up and spins her around.", Lift(carrier="a", carry="up", spins=True)),
        ("She runs to him and jumps into his arms.", Lift(carrier="b", carry="up", comes="a")),
        ("A father carries his daughter on his back.", Lift(carrier="a", carry="back")),
        ("Person A jumps onto person B's back.", Lift(carrier="b", carry="back", comes="a")),
        ("Person A is riding on person B's back.", Lift(carrier="b", carry="back")),
        ("She is carried away by him.", Lift(carrier="b", carry="arms")),
        ("He walks up to her, picks her up and carries her away.", Lift(carrier="a", carry="arms", comes="a")),
        ("Someone is dragging an unconscious man across the floor.", Lift(carrier="a", carry="drags")),
    ],
)
def test_lifts_are_read(words: str, found: Lift) -> None:
    assert score(words).lift == found
    assert {move.person for move in score(words).moves} == {"a", "b"}


@pytest.mark.parametrize(
    "words",
    [
        "He picks up the box.",
        "She lifts her arms.",
        "He carries a tray.",
        "He tries to lift her up.",
        "She helps him up.",
    ],
)
def test_other_words_lift_nobody(words: str) -> None:
    assert score(words).lift is None


@pytest.mark.parametrize("carry", ["up", "arms", "back", "drags"])
@pytest.mark.parametrize("angle", [0.0, 1.9])
def test_who_is_carried_is_off_the_floor_in_reach_of_both_hands(carry: str, angle: float) -> None:
    pose, carrier = carried(carry, np.array([0.4, -0.2]), angle)
    feet = [SMPL22.index(f"{side}_{part}") for side in ("left", "right") for part in ("ankle", "foot")]
    assert pose[feet, 1].min() > 0.15 and pose[:, 1].min() > -0.02 and np.abs(carrier[feet, 1]).max() < 0.15
    arm = SMPL22.bone_lengths[SMPL22.index("left_elbow")] + SMPL22.bone_lengths[SMPL22.index("left_wrist")]
    for one, other in ((pose, carrier), (carrier, pose)):
        for side in ("left", "right"):
            shoulder, wrist = one[SMPL22.index(f"{side}_shoulder")], one[SMPL22.index(f"{side}_wrist")]
            assert np.linalg.norm(wrist - shoulder) < arm + 0.12
            loose = one is pose and (
                carry == "drags" or (carry == "arms" and side == "left")
            )  # their arms trail on the floor, or a hand lies in the lap
            assert loose or np.linalg.norm(other - wrist, axis=-1).min() < 0.25
    still, other = carried(carry, np.zeros(2), 0.0)
    np.testing.assert_allclose(np.sort(pose[:, 1]), np.sort(still[:, 1]), atol=1e-9)
    assert np.linalg.norm(pose[0] - carrier[0]) == pytest.approx(np.linalg.norm(still[0] - other[0]))


def test_the_legs_of_somebody_on_the_back_are_beside_the_carrier_and_not_inside() -> None:
    pose, carrier = carried("back", np.zeros(2), 0.4)
    arms = [SMPL22.index(f"{side}_{joint}") for side in ("left", "right") for joint in ("elbow", "wrist")]
    pose[arms], carrier[arms] = [0.0, 9.0, 0.0], [0.0, 19.0, 0.0]  # arms are bent later
    assert limb_depth(pose[None], carrier[None])[0] < 0.02
    assert limb_depth(carrier[None], pose[None])[0] < 0.02


def test_the_arm_that_carries_the_legs_goes_under_the_thighs_and_not_through() -> None:
    pose, carrier = carried("arms", np.zeros(2), 0.4)
    carrier[[SMPL22.index("left_elbow"), SMPL22.index("left_wrist")]] = carrier[SMPL22.index("left_shoulder")]
    pose[[SMPL22.index("right_elbow"), SMPL22.index("right_wrist")]] = pose[SMPL22.index("right_shoulder")]
    assert limb_depth(carrier[None], pose[None])[0] < 0.03
    elbow, wrist = (SMPL22.index(f"right_{joint}") for joint in ("elbow", "wrist"))
    assert carrier[wrist, 1] < pose[SMPL22.index("right_knee"), 1] - 0.05
    forearm = float(np.linalg.norm(carrier[wrist] - carrier[elbow]))
    assert forearm == pytest.approx(SMPL22.bone_lengths[wrist], abs=0.01)


def test_who_is_carried_from_the_start_is_behind_and_who_is_lifted_before_the_other() -> None:
    behind, before = beginning("He carries her away."), beginning("She is lifted up by him.")
    assert behind is not None and behind.places[1, 1] < behind.places[0, 1] and not behind.headings.any()
    assert before is not None and before.gap() == pytest.approx(0.45)
    other = beginning("Person B carries person A away.")
    assert other is not None and other.places[0, 1] < other.places[1, 1]
    assert beginning("He walks up to her and picks her up.") is None
