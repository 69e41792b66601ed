"""Classifier-free guidance: what it mixes, and what it need not run."""

from __future__ import annotations

import torch

from models.diffusion import classifier_free, guide


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
