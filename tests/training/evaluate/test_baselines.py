"""Baselines of reactions: what is nearest is found, and a plain Transformer learns."""

from __future__ import annotations

import numpy as np
import pytest

from tests.motion.bodies import marching
from training.evaluate.baselines import conditional_vae, nearest, plain_transformer
from training.evaluate.reactions import Reaction, baselines, long_enough

REST = marching(2)[0][0]
TIME = np.linspace(0, 1, 40)[:, None, None]


def pair(way: float, frames: int = 40) -> np.ndarray:
    """An actor who goes along X by ``way`` metres, and a reactor who goes half as far along Z."""
    time = np.linspace(0, 1, frames)[:, None, None]
    actor = REST + time * np.array([way, 0, 0])
    return np.stack([actor, REST + np.array([0, 0, 1.0]) + time * np.array([0, 0, way / 2])])


def test_the_nearest_reaction_is_stretched_and_begins_in_the_given_pose() -> None:
    react = nearest([pair(0.0), pair(1.0), pair(-1.0)])
    asked = pair(0.9, frames=25)
    asked[1] += np.array([0.05, 0, 0])  # stands elsewhere: the reaction begins there
    made = react(asked)
    assert made.shape == (25, 22, 3)
    np.testing.assert_allclose(made[0], asked[1, 0], atol=1e-12)
    np.testing.assert_allclose((made[-1] - made[0])[:, 2], 0.5, atol=1e-6)  # that of the pair that goes 1 m


def test_a_plain_transformer_learns_to_follow_the_actor() -> None:
    train = [pair(way) for way in np.linspace(-1, 1, 9)]
    asked = pair(0.6)
    errors = {
        steps: np.linalg.norm(plain_transformer(train, seed=0, steps=steps, batch=8)(asked) - asked[1], axis=-1).mean()
        for steps in (1, 120)
    }  # fmt: skip
    still = np.linalg.norm(asked[1, :1] - asked[1], axis=-1).mean()
    assert errors[120] < 0.5 * still < errors[1]
    first = plain_transformer(train[:2], seed=0, steps=2, batch=2)(asked)
    np.testing.assert_array_equal(first, plain_transformer(train[:2], seed=0, steps=2, batch=2)(asked))
    np.testing.assert_array_equal(first[0], asked[1, 0])


def test_a_conditional_vae_learns_to_follow_the_actor_and_varies() -> None:
    train = [pair(way, 20) for way in np.linspace(-1, 1, 9)]
    asked = pair(0.6, 20)
    still = np.linalg.norm(asked[1, :1] - asked[1], axis=-1).mean()
    react = conditional_vae(train, seed=0, steps=80, batch=4)
    made = [react(asked) for _ in range(4)]
    assert np.mean([np.linalg.norm(one - asked[1], axis=-1).mean() for one in made]) < 0.6 * still
    assert not np.allclose(made[0], made[1], atol=1e-3)
    for one in made:
        np.testing.assert_array_equal(one[0], asked[1, 0])


def test_no_baseline_looks_at_the_reaction() -> None:
    train, asked = [pair(way) for way in (-1.0, 0.2, 1.0)], pair(0.5)
    other = asked.copy()
    other[1, 1:] += 3.0
    for make in (lambda: nearest(train), lambda: plain_transformer(train, seed=0, steps=2, batch=2),
                 lambda: conditional_vae(train, seed=0, steps=2, batch=2)):  # fmt: skip
        np.testing.assert_array_equal(make()(asked), make()(other))


def test_all_stand_in_the_table_with_their_seeds() -> None:
    train = [Reaction(pair(way), 0) for way in (0.0, 1.0)]
    found = baselines(train, train[:1], 2, steps=2)
    assert [len(samples) for samples in found.values()] == [1, 2, 2]


@pytest.mark.parametrize(("frames", "wanted"), [(12, 31), (31, 31), (50, 50)])
def test_short_clips_hold_their_last_poses(frames: int, wanted: int) -> None:
    people = pair(1.0, frames)
    found = long_enough(people)
    assert found.shape[1] == wanted
    np.testing.assert_array_equal(found[:, :frames], people)
    np.testing.assert_array_equal(found[:, -1], people[:, -1])
