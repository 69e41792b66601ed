"""Geometry of the hypersphere of curves: what must hold of every curve."""

from __future__ import annotations

import math

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from torch import Tensor

from models.mawgan.srvf import exp_map, inner, karcher_mean, log_map, norm, to_curve, to_srvf, to_tangent

settings.register_profile("few", max_examples=20, deadline=None)
settings.load_profile("few")
SEEDS = st.integers(0, 2**31 - 1)
SIZES = st.tuples(st.integers(2, 40), st.integers(1, 60))


def walk(seed: int, size: tuple[int, ...]) -> Tensor:
    """A random curve (…, N, D), as wide as a person in metres."""
    rng = np.random.default_rng(seed)
    return torch.from_numpy(rng.normal(scale=0.1, size=size).cumsum(-2))


def point(seed: int, size: tuple[int, ...]) -> Tensor:
    return to_srvf(walk(seed, size))[0]


@given(SEEDS, SIZES)
def test_curve_round_trip(seed: int, size: tuple[int, int]) -> None:
    curve = walk(seed, size).float()
    q, length = to_srvf(curve)
    assert (to_curve(q, length, curve[0]) - curve).abs().max() < 1e-4 * max(1.0, float(curve.abs().max()))


@given(SEEDS, SIZES)
def test_points_lie_on_the_sphere(seed: int, size: tuple[int, int]) -> None:
    q, length = to_srvf(walk(seed, size))
    assert float(norm(q)) == pytest.approx(1, abs=1e-6)
    assert float(length) > 0


@given(SEEDS, SIZES)
def test_exp_undoes_log(seed: int, size: tuple[int, int]) -> None:
    mean, q = point(seed, size), point(seed + 1, size)
    tangent = log_map(mean, q)
    assert abs(float(inner(mean, tangent))) < 1e-6
    angle = math.acos(float(inner(mean, q).clamp(-1, 1)))
    if angle < math.pi - 1e-3:  # the opposite point has no shortest way
        assert float(norm(tangent)) == pytest.approx(angle, abs=1e-4)
        assert (exp_map(mean, tangent) - q).abs().max() < 1e-4


@settings(max_examples=4)
@given(SEEDS)
def test_karcher_mean_is_least(seed: int) -> None:
    middle = point(seed, (12, 6))
    tangents = to_tangent(middle, torch.from_numpy(np.random.default_rng(seed).normal(size=(6, 12, 6))))
    q = exp_map(middle, 0.8 * tangents / norm(tangents)[:, None, None])
    mean = karcher_mean(q, tolerance=1e-8)

    def spread(p: Tensor) -> float:
        return float(norm(log_map(p, q)).square().sum())

    assert float(norm(mean)) == pytest.approx(1, abs=1e-6)
    assert float(norm(log_map(mean, q).mean(0))) < 1e-6
    for other in tangents:
        assert spread(exp_map(mean, 0.05 * to_tangent(mean, other))) > spread(mean)
