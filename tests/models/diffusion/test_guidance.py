"""Classifier-free guidance: what it mixes, and what it need not run."""

from __future__ import annotations

import pytest
import torch

from models.diffusion import Guided, classifier_free, guide


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


class Adding(Guided):
    """A network whose prediction says what it read: 1 for words, 10 for a plan, 100 for a trait."""

    passes: list[int]

    def __init__(self) -> None:
        self.passes = []

    def untold(self, plan: torch.Tensor) -> torch.Tensor:
        return plan * torch.tensor([0.0, 1.0])

    def __call__(self, x, t, cond, mask=None, known=None, plan=None):
        self.passes.append(len(x))
        own = torch.zeros(len(x)) if plan is None else plan[:, 0] @ torch.tensor([10.0, 100.0])
        return x + (cond[:, 0] + own)[:, None, None]


PLAN = torch.ones(1, 1, 2)


@pytest.mark.parametrize(
    ("scale", "plan_scale", "expected", "rows"),
    [
        (3.0, None, 3 * 11 + 100, 4),  # one scale for both; traits are not guided
        (3.0, 3.0, 3 * 11 + 100, 4),
        (3.0, 2.0, 3 * 1 + 2 * 10 + 100, 6),
        (3.0, 1.0, 3 * 1 + 10 + 100, 4),  # nothing has no weight
        (0.0, 2.0, 2 * 10 + 100, 4),  # words have none
        (1.0, None, 111, 2),
    ],
)
def test_words_and_plan_have_scales_of_their_own(
    scale: float, plan_scale: float | None, expected: float, rows: int
) -> None:
    network = Adding()
    x, t, cond = torch.zeros(2, 1, 1), torch.zeros(2), torch.ones(2, 1)
    found = network.guided(x, t, cond, plan=PLAN, scale=scale, plan_scale=plan_scale)
    assert found.flatten().tolist() == pytest.approx([expected] * 2)
    assert network.passes == [rows]


def test_without_a_plan_there_is_no_scale_of_its_own() -> None:
    found = Adding().guided(torch.zeros(1, 1, 1), torch.zeros(1), torch.ones(1, 1), scale=3.0, plan_scale=2.0)
    assert found.item() == pytest.approx(3.0)
