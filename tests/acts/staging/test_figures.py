"""Figures of the whole body: what a push-up, a handstand or a cartwheel looks like, and its way over the floor."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from acts.shapes import Figure
from acts.staging.figures import _rested, figured, figures
from acts.staging.poses import CLEARANCES, upright
from acts.staging.recordings import has_takes
from motion import SMPL22

J = {name: i for i, name in enumerate(SMPL22.joint_names)}
FEET, HANDS = [J["left_foot"], J["right_foot"]], [J["left_wrist"], J["right_wrist"]]
LENGTHS = (1.0, 2.3, 6.0)
IN_THE_AIR = ("jumps", "jumping-jacks", "leapfrog", "shoots", "skips-rope", "hops", "smashes")


def made(name: str, seconds: float = 6.0, **more: object) -> NDArray[np.floating]:
    """A figure of a person who stands at the origin and faces +Z."""
    return figured([Figure(figure=name, **more)], np.zeros(2), 0.0, round(seconds * 30))  # type: ignore[arg-type]


def heights(poses: NDArray[np.floating]) -> NDArray[np.floating]:
    """(frames, 22) metres of the skin below each joint over the floor."""
    found: NDArray[np.floating] = poses[..., 1] - CLEARANCES
    return found


def test_what_the_lexicon_names_beside_the_files_figures_was_recorded() -> None:
    named = Figure.model_json_schema()["properties"]["figure"]["enum"]
    assert all(map(has_takes, set(named) - set(figures()))) and set(named) > set(figures())


@pytest.mark.parametrize("seconds", LENGTHS)
@pytest.mark.parametrize("name", figures())
def test_a_figure_is_on_the_floor_at_a_bodys_pace(name: str, seconds: float) -> None:
    poses = made(name, seconds)
    assert np.isfinite(poses).all()
    assert heights(poses).min() > -0.03, "a body is in the floor"
    if name not in IN_THE_AIR:
        assert heights(poses).min(axis=1).max() < 0.06, "a body floats"
    speed = np.linalg.norm(np.diff(poses, axis=0), axis=-1) * 30
    assert speed.max() < 8.0, f"a joint flies at {speed.max():.1f} m/s"


@pytest.mark.parametrize("seconds", LENGTHS)
@pytest.mark.parametrize("name", figures())
def test_a_figure_begins_and_ends_with_standing(name: str, seconds: float) -> None:
    poses = made(name, seconds)
    stands = upright(np.zeros(2), 0.0)
    for pose in (poses[0], poses[-1]):
        assert pose[0, 1] == pytest.approx(stands[0, 1], abs=0.05)
        assert pose[J["head"], 1] > 1.45
    assert poses[0, FEET].mean(axis=0) == pytest.approx(stands[FEET].mean(axis=0), abs=0.03)


def test_a_handstand_has_the_feet_over_the_hands() -> None:
    poses = made("handstand")
    up = poses[:, FEET, 1].min(axis=1) > 1.6
    assert up.sum() > 30
    assert poses[up][:, HANDS, 1].max() < 0.08
    across = poses[up][:, FEET].mean(axis=1) - poses[up][:, HANDS].mean(axis=1)
    assert np.linalg.norm(across[:, [0, 2]], axis=1).mean() < 0.25


def test_a_dive_goes_to_the_right_or_left_with_the_arms_stretched_out() -> None:
    for name, sign in (("right", -1), ("left", 1)):
        poses = made("dives", mirrored=name == "left") * [sign, 1, 1]
        lies = poses[poses[:, HANDS, 0].max(axis=1).argmax()]
        assert lies[0, 0] > 0.7 and lies[J["head"], 0] > lies[0, 0] + 0.4
        assert (lies[HANDS, 0] > lies[J["head"], 0] + 0.2).all()


def test_push_ups_go_down_and_up_over_hands_that_stay() -> None:
    poses = made("push-ups")
    down = (poses[:, HANDS, 1] < 0.075).all(axis=1)
    assert down.sum() > 60
    places = poses[down][10:-10, HANDS]
    assert np.ptp(places[..., [0, 2]], axis=0).max() < 0.03, "hands glide"
    chest = poses[down][:, J["spine3"], 1]
    assert np.ptp(chest) > 0.15
    assert np.abs(poses[down][20:-20, J["head"], 1] - poses[down][20:-20, 0, 1]).max() < 0.5


def test_a_somersault_rolls_ahead_once_over_the_back() -> None:
    poses = made("somersault", 4.0)
    spine = poses[:, J["spine3"]] - poses[:, 0]
    turned = np.unwrap(np.arctan2(spine[:, 2], spine[:, 1]))
    assert turned[-1] - turned[0] == pytest.approx(2 * np.pi, abs=0.1)
    assert 0.8 < poses[-1, 0, 2] < 2.5
    assert (poses[:, FEET, 1].min(axis=1) > poses[:, J["head"], 1]).any()


def test_a_cartwheel_wheels_to_the_left_and_mirrored_to_the_right() -> None:
    left, right = made("cartwheel", 4.0), made("cartwheel", 4.0, mirrored=True)
    assert left[-1, 0, 0] > 1.5
    assert right[-1, 0, 0] == pytest.approx(-left[-1, 0, 0], abs=0.05)
    assert left[:, HANDS, 1].min() < 0.08
    assert left[:, FEET, 1].min(axis=1).max() > 0.9


def test_a_kick_is_over_the_other_foot_which_stays() -> None:
    poses = made("kicks", 2.5)
    assert (poses[:, J["right_foot"], 1] - poses[:, J["left_foot"], 1]).max() > 0.5
    assert np.ptp(poses[:, J["left_foot"]], axis=0).max() < 0.06


def test_more_time_is_more_of_what_is_done_over_and_over() -> None:
    def pressed(seconds: float, **more: object) -> int:
        chest = made("push-ups", seconds, **more)[:, J["spine3"], 1]
        low = chest < 0.335
        return int((low[1:] & ~low[:-1]).sum())

    assert pressed(9.0) > pressed(5.0) >= 1
    assert pressed(9.0, times=1) == 1


def test_there_is_no_time_for_a_figure_that_is_begun_and_taken_back() -> None:
    poses = made("cartwheel", 1.6)
    assert poses[:, FEET, 1].max() < 0.6
    assert np.abs(poses[-1, 0] - poses[0, 0]).max() < 0.1


@pytest.mark.parametrize("times", [1, 3])
def test_who_jumps_is_in_the_air_as_often_as_told_and_as_long_as_a_body_falls(times: int) -> None:
    feet = made("jumps", 5.0, times=times)[:, FEET, 1].min(axis=1)
    air = feet > 0.04
    assert np.sum(np.diff(air.astype(int)) == 1) == times and feet.max() > 0.2
    assert air.sum() / times / 30 == pytest.approx(2 * (2 * 0.22 / 9.81) ** 0.5, abs=0.15)


@pytest.mark.parametrize("name", ["cartwheel", "jumps", "leapfrog"])
def test_after_a_figure_people_stand_by_where_it_ended(name: str) -> None:
    figure = Figure(figure=name, times=1)
    plain = figured([figure], np.zeros(2), 0.0, 240)
    poses = _rested(plain, [figure], 0, 9)
    busy = np.linalg.norm(np.diff(plain, axis=0), axis=-1).max(axis=1) > 0.02
    np.testing.assert_allclose(poses[:-1][busy], plain[:-1][busy], atol=0.05)
    np.testing.assert_allclose(poses[-1, 0, [0, 2]], plain[-1, 0, [0, 2]], atol=0.4)
    assert np.ptp(poses[-40:], axis=0).max() > 0.01 > np.ptp(plain[-20:], axis=0).max(), "they live"
    assert np.linalg.norm(np.diff(poses, axis=0), axis=-1).max() * 30 < 8.0


@pytest.mark.parametrize("name", ["push-ups", "kicks"])
def test_a_late_figure_begins_late(name: str) -> None:
    def begins(poses: NDArray[np.floating]) -> int:
        return int(np.argmax(np.linalg.norm(poses - poses[0], axis=-1).max(axis=1) > 0.1))

    assert begins(made(name, late=1.0)) - begins(made(name)) == pytest.approx(30, abs=8)
