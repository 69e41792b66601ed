"""Limbs that move by themselves: bones keep their lengths, the other foot stays, and the acts' own rules see it."""

from __future__ import annotations

import numpy as np
import pytest

from acts import lexicon
from acts.checking import checked
from acts.plan import Act, Plan
from acts.shapes import Limb
from acts.staging.limbs import MOVES, RAISES, limbed
from acts.staging.poses import upright
from acts.staging.stage import score_of
from motion import FPS, SMPL22, Duet
from motion.kinematics import bone_lengths
from webdemo.inference.pipelines.given import NAMES

SECONDS = np.arange(150) / FPS


def motion(does: str, **fields: object) -> np.ndarray:
    return limbed([Limb(does=does, **fields)], np.array([0.5, 1.0]), 0.7, SECONDS, 5.0)  # type: ignore[arg-type]


@pytest.mark.parametrize("does", sorted(MOVES))
@pytest.mark.parametrize("side", ["left", "right", "both"])
def test_bodies_stay_whole_and_on_the_floor(does: str, side: str) -> None:
    found = motion(does, side=side)
    assert np.ptp(bone_lengths(found), axis=0).max() < 2e-6
    feet = found[:, [SMPL22.index("left_foot"), SMPL22.index("right_foot")]]
    assert feet[..., 1].min() > 0.0 and feet[..., 1].min(axis=1).max() < 0.03
    np.testing.assert_allclose(found[0], upright(np.array([0.5, 1.0]), 0.7), atol=1e-6)
    assert np.abs(np.diff(found, axis=0)).max() * FPS < 6.0, "metres a second of a joint"


@pytest.mark.parametrize("does", sorted(RAISES))
def test_the_foot_that_is_not_raised_stays(does: str) -> None:
    left = SMPL22.index("left_foot")
    assert np.ptp(motion(does, side="right")[:, left], axis=0).max() < 1e-6
    assert np.ptp(motion(does, side="left")[:, left, 1]) > 0.02


def test_the_one_who_is_dipped_leans_far_back_in_the_others_hands() -> None:
    stage = score_of((Act(id="1", act="dip", agents=("a",), patient="b"),))
    assert stage.touch is not None and stage.touch.person == "a" and "a" not in stage.limbs
    (limb,) = stage.limbs["b"]
    found = limbed([limb], np.zeros(2), 0.0, SECONDS, 5.0)
    neck, pelvis = found[75, SMPL22.index("neck")], found[75, 0]
    back = np.degrees(np.arctan2(pelvis[2] - neck[2], neck[1] - pelvis[1]))
    assert 25 < back < 60


def names() -> list[str]:
    return [n for n, e in lexicon().entries.items() if e.rule and {s.do for s in e.stage} == {"limb"}]


@pytest.mark.parametrize("name", names())
def test_an_act_of_limbs_does_what_its_rule_asks_for(name: str) -> None:
    """The rule fails on a standing person, and holds for the poses that the stage gives."""
    act = Act(id="1", act=name, agents=("a",))
    other = np.tile(upright(np.array([0.0, 1.2]), np.pi), (len(SECONDS), 1, 1))
    moved = limbed(score_of((act,)).limbs["a"], np.zeros(2), 0.0, SECONDS, 5.0)
    plain = np.tile(upright(np.zeros(2), 0.0), (len(SECONDS), 1, 1))
    plan = Plan(acts=(act,))
    (still,), (done,) = (
        checked(plan, Duet.from_positions(np.stack([own, other]), fps=FPS, roles=NAMES)) for own in (plain, moved)
    )
    assert done.done and not still.done


def test_sides_directions_and_numbers_reach_the_limbs() -> None:
    (limb,) = score_of((Act(id="1", act="raise-leg", agents=("b",), side="left", direction="back", times=2),)).limbs[
        "b"
    ]
    assert limb == Limb(does="raises leg", side="left", direction="back", times=2)
    ahead, back = (motion("raises leg", direction=d)[75, SMPL22.index("right_foot")] for d in ("forward", "back"))
    towards = np.array([np.sin(0.7), 0.0, np.cos(0.7)])
    assert (ahead - back) @ towards > 0.5
    once, twice = (motion("kicks", times=t)[:, SMPL22.index("right_foot"), 1] for t in (1, 2))
    rises = [np.count_nonzero(np.diff((h > 0.3).astype(int)) == 1) for h in (once, twice)]
    assert rises == [1, 2]


@pytest.mark.parametrize("times", [2, 3])
def test_all_of_a_number_of_nods_are_as_deep(times: int) -> None:
    found = motion("nods", times=times)
    height = found[:, SMPL22.index("head"), 1] - found[:, SMPL22.index("neck"), 1]
    drop = height[0] - height
    assert np.count_nonzero(np.diff((drop > 0.8 * drop.max()).astype(int)) == 1) == times


def test_a_lunge_is_a_long_step_over_a_bent_knee_as_often_as_it_is_told() -> None:
    found = motion("lunges", side="left", times=2)
    left, right = (found[:, SMPL22.index(f"{side}_ankle")] for side in ("left", "right"))
    wide = np.linalg.norm((left - right)[:, [0, 2]], axis=1) > 0.55
    assert np.sum(np.diff(wide.astype(int)) == 1) == 2
    assert found[wide, 0, 1].max() < found[0, 0, 1] - 0.08, "the pelvis sinks"


def test_the_free_leg_is_held_as_the_other_movement_says() -> None:
    place = np.zeros(2)
    knee, leg = Limb(does="raises knee", side="left"), Limb(does="stands on one leg", side="left")
    np.testing.assert_array_equal(
        limbed([leg, knee], place, 0.0, SECONDS, 5.0), limbed([knee], place, 0.0, SECONDS, 5.0)
    )


def test_legs_are_turned_out_before_they_are_bent() -> None:
    limbs = [Limb(does="bends knees", side="both"), Limb(does="turns legs out", side="both")]
    found = limbed(limbs, np.zeros(2), 0.0, SECONDS, 5.0)[75]
    knees, hips = (
        np.abs(np.diff(found[[SMPL22.index(f"{side}_{name}") for side in ("left", "right")], 0]))
        for name in ("knee", "hip")
    )
    assert knees > hips + 0.25, "the knees open to the sides"
