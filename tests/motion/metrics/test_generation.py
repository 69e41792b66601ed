"""Measures of a set of generated motions, against closed forms."""

import numpy as np
import pytest

from motion.metrics.generation import (
    diversity,
    frechet_distance,
    interval,
    multimodal_distance,
    multimodality,
    r_precision,
)


@pytest.fixture
def rng():
    return np.random.default_rng(0)


def test_matching_features_are_always_found(rng):
    features = rng.normal(size=(96, 8))
    assert r_precision(features, features, rng=rng).tolist() == [1, 1, 1]


def test_unrelated_features_are_found_by_chance(rng):
    motion, text = rng.normal(size=(2, 3200, 8))
    np.testing.assert_allclose(r_precision(motion, text, rng=rng), np.arange(1, 4) / 32, atol=0.02)


def test_frechet_distance_of_gaussians(rng):
    """Independent numbers of variance s² and t², means m apart: d·m² + d·(s − t)²."""
    first, second = rng.normal(0, 1, (60_000, 4)), rng.normal(0.5, 3, (60_000, 4))
    assert frechet_distance(first, second) == pytest.approx(4 * 0.25 + 4 * 4, rel=0.03)
    assert frechet_distance(first, first) == pytest.approx(0, abs=1e-8)


def test_distances(rng):
    motion = np.zeros((4, 3))
    assert multimodal_distance(motion, motion + np.array([0, 3, 4])) == pytest.approx(5)
    assert diversity(np.array([[0.0], [2.0]]), rng=rng) == pytest.approx(2)
    assert multimodality(np.array([[[0.0], [0.0], [1.0], [3.0]]])) == pytest.approx(2)
    with pytest.raises(ValueError):
        diversity(motion[:1], rng=rng)
    with pytest.raises(ValueError):
        multimodality(motion[None, :1])


def test_interval_is_students():
    mean, half = interval([1.0, 2.0, 3.0])
    assert mean == 2 and half == pytest.approx(4.3027 / np.sqrt(3), rel=1e-4)
    assert interval([4.0]) == (4.0, 0.0)
