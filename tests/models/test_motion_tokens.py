"""Spline tokens: smooth motion survives them, and a mirror seen in a mirror is the scene itself."""

import numpy as np
import pytest
import torch
from scipy.interpolate import BSpline

from models.motion_tokens import FEATURES, TokenLayout, decode, encode, feature_rows, headings, mirror_control
from motion import SMPL22
from motion.transforms import heading, heading_matrix

LAYOUT = TokenLayout()


def smooth(tokens: int, *, people: int = 2) -> torch.Tensor:
    """(people, T, 22, 3) a walk with limbs that swing at up to 1.2 Hz."""
    rng = np.random.default_rng(3)
    time = np.arange(LAYOUT.num_frames(tokens))[None, :, None, None] / 30
    rate = rng.uniform(0.3, 1.2, (people, 1, 22, 3))
    swing = 0.1 * np.sin(2 * np.pi * rate * time + rng.uniform(0, 6, rate.shape))
    path = np.concatenate([0 * time, 0 * time, 1.2 * time], axis=-1)
    return torch.from_numpy(SMPL22.rest_positions() + np.array([0, 0.98, 0]) + path + swing).float()


@pytest.mark.parametrize("tokens", [4, 9, 38])
def test_smooth_motion_comes_back_to_the_millimetre(tokens: int) -> None:
    positions = smooth(tokens)
    contacts = torch.ones(2, positions.shape[1], 4)
    control = encode(positions, contacts, LAYOUT)
    assert control.shape == (2, tokens * LAYOUT.knots_per_token, FEATURES)
    back, scores = decode(control, LAYOUT)
    assert torch.linalg.vector_norm(back - positions, dim=-1).max() < 0.003
    torch.testing.assert_close(scores, contacts, atol=1e-3, rtol=0)


@pytest.mark.parametrize("frames", [2, 30, 31, 45, 119, 300])
def test_tokens_cover_the_frames_asked_for(frames: int) -> None:
    tokens = LAYOUT.num_tokens(frames)
    assert LAYOUT.num_frames(tokens) >= frames
    assert LAYOUT.num_frames(tokens - 1) < frames


def test_mirror_is_that_of_positions_and_contacts() -> None:
    positions = smooth(6)
    contacts = (torch.rand(2, positions.shape[1], 4, generator=torch.Generator().manual_seed(0)) > 0.5).float()
    seen = positions[:, :, list(SMPL22.mirror)] * torch.tensor([-1.0, 1.0, 1.0])
    expected = encode(seen, contacts[..., [2, 3, 0, 1]], LAYOUT)
    mirrored = mirror_control(encode(positions, contacts, LAYOUT), SMPL22.mirror)
    torch.testing.assert_close(mirrored, expected, atol=1e-5, rtol=0)


def turned(positions: torch.Tensor, angle: float) -> torch.Tensor:
    """Two people (2, T, 22, 3), the second turned once more as much, away from the origin."""
    first = positions[0].numpy() @ heading_matrix(angle).T + np.array([2.0, 0.0, -1.0])
    second = positions[1].numpy() @ heading_matrix(2 * angle).T + np.array([3.0, 0.1, 1.0])
    return torch.from_numpy(np.stack([first, second])).float()


@pytest.mark.parametrize("angle", [0.0, 0.8, -2.5])
def test_headings_are_those_of_the_bodies(angle: float) -> None:
    positions = turned(smooth(6), angle)
    found = headings(feature_rows(positions, torch.zeros(*positions.shape[:2], 4)))
    expected = heading(positions.numpy())
    assert np.allclose(found[..., 0], np.sin(expected), atol=1e-5)
    assert np.allclose(found[..., 1], np.cos(expected), atol=1e-5)


def test_the_basis_is_that_of_scipy() -> None:
    for tokens, every in ((3, 4), (12, 4), (7, 5)):
        layout = TokenLayout(frames_per_knot=every)
        intervals = tokens * layout.knots_per_token - 3
        knots = np.arange(-3, intervals + 4, dtype=float)
        times = np.arange(layout.num_frames(tokens)) / every
        expected = BSpline.design_matrix(times, knots, 3).toarray()
        np.testing.assert_allclose(layout.basis(tokens).numpy(), expected, atol=1e-7)
