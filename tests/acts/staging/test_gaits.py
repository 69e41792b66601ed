"""People who crawl or walk on their knees: on the floor, with their own bones, one limb after the other."""

from __future__ import annotations

import numpy as np
import pytest

from acts.staging.gaits import CYCLE, GAITS, low_gait
from motion import SMPL22
from motion.metrics.sentences.joints import Motion
from motion.metrics.sentences.poses import low
from tests.inference.followed import Follower
from tests.inference.test_scenes import positions
from webdemo.inference.story import Beat, SceneRequest

from .staged_words import moves

KNEES = [SMPL22.index(f"{side}_knee") for side in ("left", "right")]
HANDS = [SMPL22.index(f"{side}_wrist") for side in ("left", "right")]


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
    ],
)
def test_who_crawls_gets_on(monkeypatch: pytest.MonkeyPatch, words: str, gait: str) -> None:
    assert moves(words)[0].gait == gait
    found = positions(Follower(monkeypatch).scene(SceneRequest(beats=(Beat(words, seconds=5.0),))))
    assert (found[0, :, 0, 1] < 0.6).all() and np.linalg.norm(found[0, -1, 0] - found[0, 0, 0]) > 1.0
