"""Limbs that move by themselves: bones keep their lengths, the other foot stays, and the acts' own rules see it."""

from __future__ import annotations

import numpy as np
import pytest

from acts import lexicon
from acts.checking import checked
from acts.plan import Act, Plan
from acts.shapes import Figure
from acts.staging.figures import LIMBS, _rested, figured
from acts.staging.poses import upright
from acts.staging.stage import score_of
from motion import FPS, SMPL22, Duet
from motion.kinematics import bone_lengths
from webdemo.inference.pipelines.given import NAMES

FRAMES = 150


def motion(*names: str, times: int = 0, mirrored: bool = False) -> np.ndarray:
    listed = [Figure(figure=name, times=times, mirrored=mirrored) for name in names]
    return figured(listed, np.zeros(2), 0.0, FRAMES)


@pytest.mark.parametrize("name", sorted(LIMBS))
@pytest.mark.parametrize("mirrored", [False, True])
def test_bodies_stay_whole_and_on_the_floor(name: str, mirrored: bool) -> None:
    found = motion(name, mirrored=mirrored)
    assert np.ptp(bone_lengths(found), axis=0).max() < 2e-6
    feet = found[:, [SMPL22.index("left_foot"), SMPL22.index("right_foot")]]
    assert feet[..., 1].min() > 0.0 and feet[..., 1].min(axis=1).max() < 0.06
    np.testing.assert_allclose(found[0], upright(np.zeros(2), 0.0), atol=0.06)
    assert np.abs(np.diff(found, axis=0)).max() * FPS < 6.0, "metres a second of a joint"


@pytest.mark.parametrize(
    "name", ["raises leg", "raises leg back", "raises leg out", "raises knee", "kicks", "crosses legs"]
)
def test_the_foot_that_is_not_raised_stays(name: str) -> None:
    left = SMPL22.index("left_foot")
    assert np.ptp(motion(name)[:, left], axis=0).max() < 0.06
    assert np.ptp(motion(name, mirrored=True)[:, left, 1]) > 0.02


def test_the_one_who_is_dipped_leans_far_back_in_the_others_hands() -> None:
    stage = score_of((Act(id="1", act="dip", agents=("a",), patient="b"),))
    assert stage.touch is not None and stage.touch.person == "a" and "a" not in stage.limbs
    found = figured(stage.bodily("b"), np.zeros(2), 0.0, FRAMES)
    neck, pelvis = found[75, SMPL22.index("neck")], found[75, 0]
    back = np.degrees(np.arctan2(pelvis[2] - neck[2], neck[1] - pelvis[1]))
    assert 25 < back < 60


def names() -> list[str]:
    limbs = {n: [getattr(shape, "figure", "") in LIMBS for shape in e.stage] for n, e in lexicon().entries.items()}
    return [n for n, each in limbs.items() if each and all(each) and lexicon().entries[n].rule]


@pytest.mark.parametrize("name", names())
def test_an_act_of_limbs_does_what_its_rule_asks_for(name: str) -> None:
    """The rule fails on a standing person, and holds for the poses that the stage gives."""
    act = Act(id="1", act=name, agents=("a",))
    other = np.tile(upright(np.array([0.0, 1.2]), np.pi), (FRAMES, 1, 1))
    moved = figured(score_of((act,)).bodily("a"), np.zeros(2), 0.0, FRAMES)
    plain = np.tile(upright(np.zeros(2), 0.0), (FRAMES, 1, 1))
    plan = Plan(acts=(act,))
    (still,), (done,) = (
        checked(plan, Duet.from_positions(np.stack([own, other]), fps=FPS, roles=NAMES)) for own in (plain, moved)
    )
    assert done.done and not still.done


def test_sides_directions_and_numbers_reach_the_limbs() -> None:
    raised = Act(id="1", act="raise-leg", agents=("b",), side="left", direction="back", times=2)
    assert score_of((raised,)).bodily("b") == (Figure(figure="raises leg back", mirrored=True, times=2),)
    for direction, name, mirrored in (("left", "aside", True), ("right", "aside", False), ("back", "back", False)):
        lean = Act(id="1", act="lean", agents=("a",), direction=direction)
        assert score_of((lean,)).bodily("a") == (Figure(figure=f"leans {name}", mirrored=mirrored),)
    ahead, back = (motion(name)[75, SMPL22.index("right_foot")] for name in ("raises leg", "raises leg back"))
    assert ahead[2] - back[2] > 0.5
    once, twice = (motion("raises knee", times=t)[:, SMPL22.index("right_foot"), 1] for t in (1, 2))
    rises = [np.count_nonzero(np.diff((h > 0.3).astype(int)) == 1) for h in (once, twice)]
    assert rises == [1, 2]


@pytest.mark.parametrize("times", [2, 3])
def test_all_of_a_number_of_nods_are_as_deep(times: int) -> None:
    found = motion("nods", times=times)
    height = found[:, SMPL22.index("head"), 1] - found[:, SMPL22.index("neck"), 1]
    drop = height[0] - height
    assert np.count_nonzero(np.diff((drop > 0.8 * drop.max()).astype(int)) == 1) == times


def test_a_lunge_is_a_long_step_over_a_bent_knee_as_often_as_it_is_told() -> None:
    found = motion("lunges", times=2, mirrored=True)
    left, right = (found[:, SMPL22.index(f"{side}_ankle")] for side in ("left", "right"))
    wide = np.linalg.norm((left - right)[:, [0, 2]], axis=1) > 0.55
    assert np.sum(np.diff(wide.astype(int)) == 1) == 2
    assert found[wide, 0, 1].max() < found[0, 0, 1] - 0.08, "the pelvis sinks"


def test_the_free_leg_is_held_as_the_other_movement_says() -> None:
    np.testing.assert_allclose(motion("stands on one leg", "raises knee"), motion("raises knee"), atol=0.02)


def test_what_limbs_do_not_move_is_as_it_is_of_people_who_wait() -> None:
    wrist, foot, head = (SMPL22.index(name) for name in ("left_wrist", "left_foot", "head"))
    for name, lives in (("nods", (wrist, foot)), ("leans", (wrist,)), ("reaches down", ())):
        figure = Figure(figure=name)
        plain = figured([figure], np.zeros(2), 0.0, FRAMES)
        rested = _rested(plain.copy(), [figure], 0, 3)
        still = np.abs(rested - plain)[40:110].max(axis=(0, 2))
        assert still[list(lives)].min(initial=1.0) > 0.005
        assert np.ptp(rested[:, head] - rested[:, 0], axis=0).max() > 0.03


def test_legs_are_turned_out_before_they_are_bent() -> None:
    found = motion("bends knees", "turns legs out")[75]
    knees, hips = (
        np.abs(np.diff(found[[SMPL22.index(f"{side}_{name}") for side in ("left", "right")], 0]))
        for name in ("knee", "hip")
    )
    assert knees > hips + 0.25, "the knees open to the sides"
