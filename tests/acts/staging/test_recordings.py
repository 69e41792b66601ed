"""People as recorded: who stands by lives where they are, who walks keeps the feet, and who gestures has a hand up."""

from __future__ import annotations

import numpy as np
import pytest

from acts.shapes import Figure, Gesture
from acts.staging.places import Course, Standing
from acts.staging.recordings import _read, dancing, performance, performing, standing_by, walking
from motion import FPS, SMPL22
from motion.kinematics import bone_lengths
from motion.transforms import heading

FRAMES = np.arange(600)
PLACE = np.array([2.0, -1.0])
FEET = [SMPL22.index(f"{side}_{joint}") for side in ("left", "right") for joint in ("ankle", "foot")]


@pytest.mark.parametrize("seed", range(0, 60, 7))
def test_they_stay_and_move_a_little_all_the_time(seed: int) -> None:
    poses = standing_by(PLACE, 2.0, FRAMES, seed)
    assert np.abs(poses[:, 0][:, [0, 2]] - PLACE).max() < 0.4
    off = heading(poses) - 2.0
    assert abs(np.arctan2(np.sin(off).mean(), np.cos(off).mean())) < 0.35
    speeds = np.linalg.norm(np.diff(poses, axis=0), axis=-1) * FPS
    assert speeds.max() < 2.5, "also where the recording is turned back"
    assert (speeds[:, FEET].max(-1) < 0.2).mean() > 0.85, "the feet stay"
    assert (speeds.max(-1) > 0.2).mean() > 0.3


def test_a_scene_goes_on_where_it_was_and_seeds_differ() -> None:
    whole = standing_by(PLACE, 0.0, FRAMES, 1)
    np.testing.assert_array_equal(standing_by(PLACE, 0.0, FRAMES[300:], 1), whole[300:])
    others = [standing_by(PLACE, 0.0, FRAMES, seed) for seed in range(2, 12)]
    assert min(np.abs(other - whole).max() for other in others) > 0.05


def test_bones_are_those_of_the_skeleton() -> None:
    for poses in _read("idle").values():
        np.testing.assert_allclose(bone_lengths(poses) - SMPL22.bone_lengths[1:], 0, atol=0.004)


def course(speed: float, angle: float = 0.7, backwards: bool = False) -> Course:
    """Four seconds straight ahead, the last of which is rest."""
    gone = np.minimum(np.arange(120), 90) * speed / FPS
    way = np.array([np.sin(angle), np.cos(angle)])
    return Course(gone[:, None] * way, np.full(120, angle + np.pi * backwards))


@pytest.mark.parametrize("speed", [0.8, 1.2, 1.5, 2.4, 3.0])
@pytest.mark.parametrize("seed", [0, 5])
def test_who_walks_or_runs_stands_on_a_foot_that_stays(speed: float, seed: int) -> None:
    walks, poses = walking(course(speed), seed)
    assert walks[5:85].all() and not walks[95:].any()
    going = poses[5:85]
    np.testing.assert_allclose(going[:, 0][:, [0, 2]], course(speed).places[5:85], atol=1e-9)
    assert np.abs(heading(going) - 0.7).max() < 0.7
    toes = going[:, [SMPL22.index("left_foot"), SMPL22.index("right_foot")]]
    lower = toes[np.arange(len(toes)), toes[..., 1].argmin(axis=1)]
    assert lower[:, 1].max() < (0.12 if speed < 1.75 else 0.4), "a foot is down, but for a run's flight"
    slides = np.linalg.norm(np.diff(lower, axis=0)[:, [0, 2]], axis=-1) * FPS
    assert np.median(slides) < 0.35 * speed


def test_who_goes_backwards_or_stays_is_not_drafted() -> None:
    assert not walking(course(1.2, backwards=True), 0)[0].any()
    assert not walking(course(0.0), 0)[0].any()


def test_seeds_are_other_walks_and_scenes_of_one_seed_the_same() -> None:
    one, other, again = (walking(course(1.2), seed)[1] for seed in (1, 2, 1))
    assert np.linalg.norm(one - other, axis=-1)[5:85].mean() > 0.03
    np.testing.assert_array_equal(one, again)


def hand_over_shoulder(name: str, side: str, **more: int) -> np.ndarray:
    """(T,) metres of a hand of somebody who makes a gesture for five seconds."""
    shown = performance({"a": Gesture.model_validate({"gesture": name, "sides": side} | more)}, 0, 150, 3)
    assert shown is not None
    seconds = np.arange(150) / FPS
    poses = shown.over(standing_by(PLACE, 0.4, np.arange(150), 1), seconds, 0.4)
    return np.asarray(poses[:, SMPL22.index(f"{side}_wrist"), 1] - poses[:, SMPL22.index(f"{side}_shoulder"), 1])


@pytest.mark.parametrize("side", ["left", "right"])
def test_a_hand_that_waves_goes_up_and_sinks_and_one_that_is_raised_stays(side: str) -> None:
    waves, raised = (hand_over_shoulder(name, side) for name in ("waves", "up"))
    for height in (waves, raised):
        assert height[0] < -0.3 and np.median(height[45:105]) > 0.05
    assert waves[-1] < -0.3 and raised[-1] > 0.05


def test_two_who_talk_take_turns_and_counted_strokes_are_not_recorded() -> None:
    talks = Gesture(gesture="talks", sides="both")
    first, second = (performance({"a": talks, "b": talks}, person, 150, 0) for person in (0, 1))
    assert first is not None and second is not None
    at = np.arange(150) / FPS
    shares = np.stack([first.share(at), second.share(at)])
    assert shares[0, :60].max() == 1.0 and not shares[1, :60].any()
    assert shares[1, 95:140].max() == 1.0 and not shares[0, 95:].any()
    assert performance({"a": Gesture(gesture="waves", times=3)}, 0, 150, 0) is None


@pytest.mark.parametrize(("figure", "times"), [("bows", 1), ("bows", 3), ("bows deeply", 1)])
def test_who_bows_does_so_as_often_as_told_and_stands_before_and_after(figure: str, times: int) -> None:
    poses = performing(Figure.model_validate({"figure": figure, "times": times}), PLACE, 0.5, 180, 2)
    leans = np.linalg.norm((poses[:, SMPL22.index("neck")] - poses[:, 0])[:, [0, 2]], axis=-1)
    assert np.sum(np.diff((leans > (0.4 if figure == "bows deeply" else 0.2)).astype(int)) == 1) == times
    assert leans[0] < 0.15 and leans[-1] < 0.15
    assert np.linalg.norm(np.diff(poses, axis=0), axis=-1).max() * FPS < 5.0


def test_two_copies_of_a_dance_are_a_second_apart_and_a_mirror_has_the_other_hand() -> None:
    at = np.zeros(2)
    one = performing(Figure(figure="dances", early=1.0), at, 0.0, 180, 4)
    later = performing(Figure(figure="dances", late=1.0), at, 0.0, 180, 4)
    np.testing.assert_allclose(later[60:140], one[30:110], atol=1e-6)
    plain, turned = (performing(Figure(figure="dances", mirrored=how), at, 0.0, 180, 4) for how in (False, True))
    np.testing.assert_allclose(turned[60:120, 20] * [-1, 1, 1], plain[60:120, 21], atol=0.02)


@pytest.mark.parametrize("seed", range(6))
def test_a_couple_dances_from_where_the_two_stand_hand_in_hand(seed: int) -> None:
    stand = Standing(np.array([[1.0, 2.0], [2.1, 2.0]]), np.array([np.pi / 2, -np.pi / 2]))
    couple = dancing(stand, 420, seed)
    np.testing.assert_allclose(couple[:, 0, 0][:, [0, 2]], stand.places, atol=1e-9)
    ways = np.linalg.norm(np.diff(couple, axis=1), axis=-1) * FPS
    assert 0.3 < ways.mean() < 1.5 and ways.max() < 9.0, "they dance, also where the recording turns back"
    hands = couple[:, :, 20:22]
    gaps = np.linalg.norm(hands[0][:, :, None] - hands[1][:, None], axis=-1).min(axis=(1, 2))
    assert (gaps < 0.25).mean() > 0.4
