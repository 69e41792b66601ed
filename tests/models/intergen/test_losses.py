"""InterGen's losses against the released code's numbers, and what each term must and must not feel."""

from __future__ import annotations

import math

import pytest
import torch

from models.intergen import losses
from models.intergen.losses import InterGenLoss
from motion.skeleton import SMPL22
from tests.models.reference_arrays import Reference

REST = torch.as_tensor(SMPL22.rest_positions()).float()


@pytest.fixture(scope="module")
def ref() -> Reference:
    return Reference("intergen_losses")


def scene(turn: float = math.pi, gap: float = 1.0, frames: int = 4, batch: int = 1) -> torch.Tensor:
    """Two still T-poses, b at +Z turned about Y by `turn`, (B, T, 2, 22, 3)."""
    c, s = math.cos(turn), math.sin(turn)
    rotation = torch.tensor([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    pair = torch.stack([REST, REST @ rotation.T + torch.tensor([0, 0, gap])])
    return pair.expand(batch, frames, 2, 22, 3).clone()


def close(found, expected) -> bool:
    return abs(float(found) - float(expected)) < 1e-4 * max(abs(float(expected)), 1e-3)


def test_all_terms_equal_the_reference(ref):
    t, mask = ref["timesteps"], ref["mask"][..., 0]
    pred, true = ref["prediction"], ref["target"]
    pair = (features[..., : 3 * 22].unflatten(-1, (22, 3)) for features in (pred, true))
    terms = InterGenLoss(t_bar=int(ref["t_bar"])).regularizers(*pair, t, mask)
    terms["simple"] = losses.simple_loss(pred, true, mask)
    names = {"simple": "simple", "DM": "distance_map", "JA": "joint_affinity"}
    for short, name in names.items():
        assert close(terms[name], ref[f"inter/{short}"]), name
    for short, name in {"VEL": "velocity", "FC": "foot_contact", "BL": "bone_length"}.items():
        assert close(terms[name], ref[f"geometric/{short}_A"] + ref[f"geometric/{short}_B"]), name
    alike = sum(terms.values()) - terms["relative_orientation"]  # which is another than the release's
    assert close(alike, ref["inter/total"] + ref["geometric/A"] + ref["geometric/B"] - ref["inter/RO"])


def test_damping_leaves_out_samples_above_the_threshold():
    true = scene(batch=2)
    pred = true.clone()
    pred[1] += torch.randn(true[1].shape, generator=torch.Generator().manual_seed(0))
    loss = InterGenLoss(t_bar=700)
    undamped = loss.regularizers(pred, true, torch.tensor([0, 700]))
    damped = loss.regularizers(pred, true, torch.tensor([0, 701]))
    assert undamped["velocity"] > 0 and undamped["relative_orientation"] > 0
    assert all(value == 0 for value in damped.values())
    all_out = loss.regularizers(pred, true, torch.tensor([900, 701]))
    assert all(value == 0 for value in all_out.values())


def test_a_foot_that_slides_on_the_floor_costs_its_squared_step():
    standing = scene() - REST[10, 1]  # the toes on the floor
    assert losses.foot_contact_loss(standing).max() == 0
    slide = torch.arange(4).view(1, 4, 1, 1, 1) * torch.tensor([0.02, 0, 0])
    expected = 0.02**2 / 3
    assert torch.allclose(losses.foot_contact_loss(standing + slide), torch.full((1, 2), expected))
    lifted = standing + slide + torch.tensor([0, 0.5, 0])
    assert losses.foot_contact_loss(lifted).max() == 0


def test_the_contact_loss_counts_a_touch_for_more_than_a_gap():
    """An error of 0.1 m in one distance, where the joints truly are d apart: 0.01 / (d + 0.1), over all pairs."""
    pairs = 22 * 22
    for gap in (0.0, 0.4, 3.0):
        true = torch.zeros(1, 3, 2, 22, 3)
        true[:, :, 0] += 100 * torch.arange(22)[:, None]  # every other pair is so far apart that it weighs nothing
        true[:, :, 1] = true[:, :, 0].flip(2) + 37
        true[:, :, 1, 0] = true[:, :, 0, 0] + torch.tensor([gap, 0, 0])
        pred = true.clone()
        pred[:, :, 1, 0, 0] += 0.1
        found = losses.contact_loss(pred, true)
        assert torch.allclose(found, torch.tensor(0.01 / (gap + 0.1) / pairs), rtol=0.05), gap
    still = losses.InterGenLoss().regularizers(pred, true, torch.zeros(1))
    weighed = losses.InterGenLoss(losses.LossWeights(contact=2.0)).regularizers(pred, true, torch.zeros(1))
    assert "contact" not in still
    assert torch.allclose(weighed["contact"], 2 * losses.contact_loss(pred, true)[0])


def test_relative_orientation_is_smooth_where_people_face_each_other():
    true, pred = scene(math.pi + 0.01), scene(math.pi - 0.01).requires_grad_()
    loss = losses.relative_orientation_loss(pred, true)
    loss.sum().backward()
    assert 0 < loss < 1e-3
    assert torch.isfinite(pred.grad).all() and pred.grad.abs().sum() > 0


def test_gradients_are_finite_where_bones_and_distances_vanish():
    pred = torch.zeros(2, 4, 2, 22, 3, requires_grad=True)
    terms = InterGenLoss().regularizers(pred, scene(batch=2), torch.zeros(2))
    sum(terms.values()).backward()
    assert torch.isfinite(pred.grad).all()
