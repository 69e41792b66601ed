"""Bystanders: who they are, and how they stand."""

import numpy as np
import pytest

from acts.staging.poses import standing
from motion import SMPL22
from motion.metrics.quality import mirror_gap
from motion.transforms import heading
from tests.acts.staging.staged_words import gesturing, idle, score


@pytest.mark.parametrize(
    ("sentence", "found"),
    [
        ("Person A sits down.", "b"),
        ("Person B bows.", "a"),
        ("She waves, but he does not wave back.", "b"),
        ("One wants a high five and is left hanging.", "b"),
        ("The first person stands still until the second person has come up to them.", "a"),
        # who is touched, spoken of together, or busy
        ("Person A pats person B on the back.", "b"),
        ("They bow.", ""),
        ("Person A waves and person B waves back.", ""),
        ("Two people hug.", ""),
        ("", ""),
    ],
)
def test_only_bystanders_stand_by(sentence: str, found: str) -> None:
    assert "".join(sorted(idle(sentence))) == found


@pytest.mark.parametrize(
    ("sentence", "found"),
    [
        ("They clap.", "ab"),
        ("Person A holds both arms out.", "a"),
        # what the network knows, and who does something else as well
        ("They talk.", ""),
        ("Person A claps and person A bows.", ""),
        ("Person A walks away with outstretched arms.", ""),
    ],
)
def test_gestures_are_given_to_who_only_stands(sentence: str, found: str) -> None:
    assert "".join(sorted(gesturing(sentence))) == found


def test_a_bystander_stands_on_the_floor_and_sways() -> None:
    poses = standing(np.array([1.0, -2.0]), 0.7, np.arange(20) / 2, seed=3)
    parents, children = np.array(SMPL22.bones).T
    lengths = np.linalg.norm(poses[:, children] - poses[:, parents], axis=-1)
    np.testing.assert_allclose(lengths, np.tile(SMPL22.bone_lengths[children], (20, 1)), atol=1e-9)
    toes = poses[:, [SMPL22.index("left_foot"), SMPL22.index("right_foot")]]
    assert np.abs(toes[..., 1] - 0.02).max() < 0.02 and np.ptp(toes[..., [0, 2]], axis=0).max() < 0.02
    assert np.linalg.norm(poses[:, 0][:, [0, 2]] - [1.0, -2.0], axis=1).max() < 0.1
    assert np.abs(heading(poses) - 0.7).max() < 0.05
    wrists = poses[:, [SMPL22.index("left_wrist"), SMPL22.index("right_wrist")]]
    assert (wrists[..., 1] < poses[:, :1, 1] + 0.1).all(), "the arms hang"
    assert np.ptp(wrists, axis=0).max() > 0.005, "nobody stands like a statue"
    assert not np.allclose(poses, standing(np.array([1.0, -2.0]), 0.7, np.arange(20) / 2, seed=4))


@pytest.mark.parametrize(
    ("sentence", "found"),
    [
        ("Person A walks up to person B.", "a"),
        ("Person A lies down.", "ab"),
        ("Person A waves while person B stands still.", "b"),
        ("They walk hand in hand.", ""),
        ("Person A walks to the door.", "a"),
        ("Person A hugs person B.", ""),
        ("Person A carries a box to person B.", ""),
    ],
)
def test_the_arms_of_those_who_only_walk_or_rest_have_nothing_to_do(sentence: str, found: str) -> None:
    assert "".join(sorted(score(sentence).loose)) == found


def test_two_arms_hang_differently_and_so_do_those_of_others() -> None:
    gaps = [mirror_gap(standing(np.zeros(2), 0.0, np.zeros(4), seed=seed)) for seed in range(20)]
    assert 3.0 < np.median(gaps) < 8.0 and np.ptp(gaps) > 2.0, "recorded people who wait have 6 cm"
