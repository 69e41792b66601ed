"""People who crawl, walk on their knees, limp, tiptoe or skip: on the floor, with their bones, as far as they go."""

from __future__ import annotations

from typing import get_args

import numpy as np
import pytest

from acts import shapes
from acts.staging.given import _LOW
from acts.staging.places import Course
from acts.staging.poses import CLEARANCES, posed
from acts.staging.recordings import walking
from motion import SMPL22
from motion.kinematics import bone_lengths
from motion.metrics.sentences.joints import Motion
from motion.metrics.sentences.language import check
from motion.metrics.sentences.poses import low
from motion.vectors import Array
from tests.inference.followed import Follower
from tests.inference.runs import positions
from webdemo.inference.story import Beat, SceneRequest

from .staged_words import score

J = {name: i for i, name in enumerate(SMPL22.joint_names)}
KNEES, HANDS, TOES, ANKLES = ([J[f"left_{joint}"], J[f"right_{joint}"]] for joint in ("knee", "wrist", "foot", "ankle"))
GAITS = [gait for gait in get_args(shapes.Go.model_fields["gait"].annotation) if gait]
STEPS = [gait for gait in GAITS if gait not in _LOW]
FRAMES = 150


def gone(gait: str, metres: float = 2.5, seed: int = 0) -> Array:
    """(T, 22, 3) of somebody who goes straight ahead."""
    places = np.stack([np.zeros(FRAMES), np.linspace(0.0, metres, FRAMES)], axis=1)
    walks, poses = walking(Course(places, np.zeros(FRAMES)), seed, gait)
    assert walks.all()
    return poses


def standing(poses: Array) -> Array:
    """(T, 2) the feet that stand, left first."""
    return np.asarray(poses[:, TOES, 1] < CLEARANCES[TOES] + 0.005)


@pytest.mark.parametrize("gait", GAITS)
def test_each_gait_of_the_lexicon_keeps_the_bones_and_its_way(gait: str) -> None:
    poses = gone(gait)
    np.testing.assert_allclose(bone_lengths(poses) - SMPL22.bone_lengths[1:], 0, atol=0.01)
    np.testing.assert_allclose(poses[:, 0, 2], np.linspace(0.0, 2.5, FRAMES), atol=1e-9)
    assert poses[..., 1].min() > -0.01 and poses[..., 1].min(axis=1).max() < (0.2 if gait == "skips" else 0.03)


@pytest.mark.parametrize("gait", _LOW)
def test_a_knee_stays_where_it_was_set_down(gait: str) -> None:
    poses = gone(gait)
    speed = np.diff(poses[:, KNEES, 2], axis=0) * FRAMES / 2.5
    assert np.median(speed.min(axis=1)) < 0.35, "while the other one goes ahead"
    assert (speed.max(axis=1) > 1.0).mean() > 0.8
    assert poses[:, KNEES, 1].min(axis=1).max() < 0.12 and low(Motion(np.stack([poses, poses])), 0).all()


def test_who_crawls_has_the_trunk_level_and_the_hands_on_the_floor() -> None:
    poses = np.concatenate([gone("crawls"), posed("on all fours", np.array([1.0, 2.0]), 0.0)[None]])
    trunk = poses[:, J["neck"]] - poses[:, 0]
    assert (trunk[:, 1] < 0.2).all() and (trunk[:, 2] > 0.35).all()
    assert poses[:, HANDS, 1].max() < 0.25
    np.testing.assert_allclose(poses[-1, 0, [0, 2]], [1.0, 2.0], atol=2e-3)


@pytest.mark.parametrize("gait", STEPS)
def test_feet_take_turns_and_stay_while_they_stand(gait: str) -> None:
    poses = gone(gait)
    stands = standing(poses)
    assert (~stands[:, 0]).sum() > 20 and (~stands[:, 1]).sum() > 20
    assert (~stands).all(axis=1).any() == (gait == "skips"), "somebody flies"
    both = stands[1:] & stands[:-1]
    glide = np.linalg.norm(np.diff(poses[:, TOES], axis=0)[..., [0, 2]], axis=-1) * 30
    assert np.median(glide[both]) < 0.08, "a standing foot glides"


def test_who_skips_is_seen_to() -> None:
    assert {move.gait for move in score("They skip forward together.").moves} == {"skips"}
    poses = gone("skips", 5.0)
    assert check("happens(both(walks(a, 0.6), hops(a, 0.08)))", Motion(np.stack([poses, np.add(poses, [1.0, 0, 0])])))


def test_who_sneaks_has_the_heels_up() -> None:
    heels, limping = (np.subtract(*np.moveaxis(gone(g)[:, [ANKLES, TOES], 1], 1, 0)) for g in ("on tiptoe", "limps"))
    assert heels.min() > 0.1 and limping.mean() < 0.09


def test_who_limps_leans_over_the_leg_that_hurts() -> None:
    poses = gone("limps", 4.0)
    stands, over = standing(poses), poses[:, J["neck"], 0] - poses[:, 0, 0]
    assert over[~stands[:, 0]].mean() < over[~stands[:, 1]].mean() - 0.02, "to the right while the left foot swings"


@pytest.mark.parametrize(
    ("words", "gait"), [("He limps.", "limps"), ("She tiptoes out of the room.", "on tiptoe"), ("He walks away.", "")]
)
def test_words_name_the_gait(words: str, gait: str) -> None:
    assert score(words).moves[0].gait == gait


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
    assert score(words).moves[0].gait == gait
    found = positions(Follower(monkeypatch).scene(SceneRequest(beats=(Beat(words, seconds=5.0),))))
    assert (found[0, :, 0, 1] < 0.6).all() and np.linalg.norm(found[0, -1, 0] - found[0, 0, 0]) > 1.0
