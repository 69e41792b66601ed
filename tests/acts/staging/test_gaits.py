"""People who crawl, walk on their knees, limp or tiptoe: on the floor, with their own bones, at a body's pace."""

from __future__ import annotations

from typing import get_args

import numpy as np
import pytest
from numpy.typing import NDArray

from acts import shapes
from acts.staging.gaits import CYCLE, GAITS, STEPS, low_gait, stepped
from acts.staging.poses import SOLE
from motion import SMPL22
from motion.metrics.sentences.joints import Motion
from motion.metrics.sentences.language import check
from motion.metrics.sentences.poses import low
from tests.inference.followed import Follower
from tests.inference.test_scenes import positions
from webdemo.inference.story import Beat, SceneRequest

from .staged_words import moves

Array = NDArray[np.floating]
J = {name: i for i, name in enumerate(SMPL22.joint_names)}
KNEES = [SMPL22.index(f"{side}_knee") for side in ("left", "right")]
HANDS = [SMPL22.index(f"{side}_wrist") for side in ("left", "right")]
TOES, ANKLES = [J["left_foot"], J["right_foot"]], [J["left_ankle"], J["right_ankle"]]
FRAMES = 150


def gone(gait: str, metres: float = 2.0, frames: int = 120) -> np.ndarray:
    places = np.stack([np.zeros(frames), np.linspace(0.0, metres, frames)], axis=1)
    return low_gait(gait, places, np.zeros(frames))


@pytest.mark.parametrize("gait", list(GAITS))
def test_bones_are_kept_and_knees_are_on_the_floor(gait: str) -> None:
    found = gone(gait)
    parents, children = np.array(SMPL22.bones).T
    lengths = np.linalg.norm(found[:, children] - found[:, parents], axis=-1)
    np.testing.assert_allclose(lengths, np.tile(SMPL22.bone_lengths[children], (120, 1)), atol=1e-9)
    assert found[..., 1].min() >= 0.0 and found[:, KNEES, 1].min(axis=1).max() < 0.12
    assert low(Motion(np.stack([found, found])), 0).all()


@pytest.mark.parametrize("gait", list(GAITS))
def test_a_knee_stays_where_it_was_set_down(gait: str) -> None:
    speed = np.diff(gone(gait)[:, KNEES, 2], axis=0)
    assert np.median(speed.min(axis=1)) < 0.35 * 2.0 / 120, "while the other one goes ahead"
    assert (speed.max(axis=1) > 2.0 / 120).mean() > 0.8


def test_who_crawls_has_the_trunk_level_and_the_hands_on_the_floor() -> None:
    found = gone("crawls")
    trunk = found[:, SMPL22.index("neck")] - found[:, 0]
    assert (trunk[:, 1] < 0.2).all() and (trunk[:, 2] > 0.35).all()
    assert found[:, HANDS, 1].max() < 0.25 and CYCLE < 1.0


@pytest.mark.parametrize(
    ("words", "gait"),
    [
        ("He crawls across the floor.", "crawls"),
        ("The baby crawls to her mother.", "crawls"),
        ("She walks on her knees.", "on the knees"),
        ("He crawls under her legs.", "crawls"),
    ],
)
def test_who_crawls_gets_on(monkeypatch: pytest.MonkeyPatch, words: str, gait: str) -> None:
    assert moves(words)[0].gait == gait
    found = positions(Follower(monkeypatch).scene(SceneRequest(beats=(Beat(words, seconds=5.0),))))
    assert (found[0, :, 0, 1] < 0.6).all() and np.linalg.norm(found[0, -1, 0] - found[0, 0, 0]) > 1.0


def stepped_way(gait: str, metres: float = 2.5, turn: float = 0.0) -> Array:
    share = np.clip(np.linspace(-0.1, 1.1, FRAMES), 0.0, 1.0)
    places = np.stack([np.zeros(FRAMES), metres * share], axis=1)
    return stepped(gait, places, turn * share)


def standing(poses: Array) -> Array:
    """(frames, 2) the feet that stand, left first."""
    found: Array = poses[:, TOES, 1] < SOLE + 1e-3
    return found


def test_the_lexicon_may_name_each_gait() -> None:
    assert set(get_args(shapes.Go.model_fields["gait"].annotation)) == {"", *GAITS, *STEPS}


@pytest.mark.parametrize("gait", STEPS)
@pytest.mark.parametrize(("metres", "turn"), [(2.5, 0.0), (1.0, np.pi), (0.1, 0.0), (0.0, 0.0)])
def test_bones_are_kept_and_a_foot_that_stands_stays(gait: str, metres: float, turn: float) -> None:
    poses = stepped_way(gait, metres, turn)
    parents, children = np.array(SMPL22.bones).T
    lengths = np.linalg.norm(poses[:, children] - poses[:, parents], axis=-1)
    np.testing.assert_allclose(lengths, np.tile(SMPL22.bone_lengths[children], (FRAMES, 1)), atol=1e-6)
    stands = standing(poses)
    assert stands.any(axis=1).all() is np.bool_(not STEPS[gait].hops or metres < 0.5), "somebody flies"
    assert poses[..., 1].min() > SOLE - 0.01
    both = stands[1:] & stands[:-1]
    glide = np.linalg.norm(np.diff(poses[:, TOES], axis=0)[..., [0, 2]], axis=-1) * 30
    assert np.percentile(glide[both], 95) < 0.05, "a standing foot glides"
    assert np.linalg.norm(np.diff(poses, axis=0), axis=-1).max() * 30 < 6.0


@pytest.mark.parametrize("gait", STEPS)
def test_the_body_turns_with_its_way(gait: str) -> None:
    poses = stepped_way(gait, 1.0, np.pi)
    across = poses[:, J["left_hip"], 0] - poses[:, J["right_hip"], 0]
    assert across[0] > 0.1 and across[-1] < -0.1
    toes = poses[:, TOES, 2] - poses[:, ANKLES, 2]
    assert toes[0].min() > 0.05 and toes[-1].max() < -0.05


@pytest.mark.parametrize("gait", STEPS)
def test_feet_take_turns(gait: str) -> None:
    stands = standing(stepped_way(gait))
    assert (~stands[:, 0]).sum() > 20 and (~stands[:, 1]).sum() > 20
    assert (~stands).all(axis=1).any() == bool(STEPS[gait].hops)


def test_who_skips_is_seen_to() -> None:
    assert {move.gait for move in moves("They skip forward together.")} == {"skips"}
    poses = stepped_way("skips", 3.0)
    assert check("happens(both(walks(a, 0.6), hops(a, 0.08)))", Motion(np.stack([poses, np.add(poses, [1.0, 0, 0])])))


def test_who_sneaks_has_the_heels_up() -> None:
    poses = stepped_way("on tiptoe")
    heels = poses[:, ANKLES, 1] - poses[:, TOES, 1]
    assert heels.min() > 0.1
    assert (stepped_way("limps")[:, ANKLES, 1] - stepped_way("limps")[:, TOES, 1]).mean() < 0.09


def test_who_limps_takes_a_short_step_with_one_leg_and_leans_over_the_other() -> None:
    poses = stepped_way("limps", 4.0)
    stands = standing(poses)
    ahead = poses[:, TOES, 2] - poses[:, :1, 2]
    landed = stands[1:] & ~stands[:-1]
    left, right = (ahead[1:, side][landed[:, side]][1:-1].mean() for side in (0, 1))
    assert left < right - 0.1
    over = poses[:, J["neck"], 0] - poses[:, 0, 0]
    assert over[~stands[:, 0]].mean() < over[~stands[:, 1]].mean() - 0.02, "to the right while the left foot swings"


@pytest.mark.parametrize(
    ("words", "gait"), [("He limps.", "limps"), ("She tiptoes out of the room.", "on tiptoe"), ("He walks away.", "")]
)
def test_words_name_the_gait(words: str, gait: str) -> None:
    assert moves(words)[0].gait == gait
