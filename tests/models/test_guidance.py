"""Classifier-free guidance: what it mixes, and what it need not run."""

from __future__ import annotations

import pytest
import torch

from models.diffusion import TwoPersonDenoiser, classifier_free, guide


def test_both_halves_run_in_one_pass_and_are_mixed_by_the_scale():
    passes = []

    def predict(x, other, cond):
        passes.append((len(x), other))
        return x + 10 * cond

    x, cond = torch.tensor([[1.0], [2.0]]), torch.tensor([[3.0], [4.0]])
    found = classifier_free(predict, x, None, cond=cond, scale=2.5)
    torch.testing.assert_close(found, x + 25 * cond)
    torch.testing.assert_close(found, guide(x + 10 * cond, x, 2.5))
    assert passes == [(4, None)]
    assert torch.equal(classifier_free(predict, x, None, cond=cond, scale=1), x + 10 * cond)
    assert passes[1:] == [(2, None)]


def test_what_stands_for_no_condition_may_be_given():
    x, cond = torch.ones(1, 1), torch.zeros(1, 1)
    found = classifier_free(lambda x, cond: x * cond, x, cond=cond, nothing=cond + 2, scale=0.5)
    assert found.item() == 1.0


class Adding(TwoPersonDenoiser):
    """A network whose prediction says whether it read words."""

    widths = (1, 1)

    def __init__(self) -> None:
        super().__init__()
        self.passes: list[int] = []

    def forward(self, x, t, cond, mask=None):
        self.passes.append(len(x))
        return x + (10 + cond[:, 0])[:, None, None]


@pytest.mark.parametrize(("scale", "expected", "rows"), [(3.0, 13.0, 4), (1.0, 11.0, 2), (0.0, 10.0, 2)])
def test_a_prediction_without_weight_is_not_made(scale: float, expected: float, rows: int) -> None:
    network = Adding()
    found = network.guided(torch.zeros(2, 1, 1), torch.zeros(2), torch.ones(2, 1), scale=scale)
    assert found.flatten().tolist() == pytest.approx([expected] * 2)
    assert network.passes == [rows]
