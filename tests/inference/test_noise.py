"""The noise that sampling starts from."""

import torch

from models.diffusion import sample_noise


def test_a_sample_depends_on_seed_and_index_alone() -> None:
    one, four = sample_noise(7, 1, (5, 6)), sample_noise(7, 4, (5, 6))
    assert four.shape == (4, 5, 6) and torch.equal(four[0], one[0])
    assert not any(torch.equal(four[i], four[j]) for i in range(4) for j in range(i))
    assert not torch.equal(sample_noise(8, 1, (5, 6)), one)


def test_it_leaves_the_global_generator_alone() -> None:
    torch.manual_seed(3)
    expected = torch.rand(2)
    torch.manual_seed(3)
    sample_noise(0, 2, (4,))
    assert torch.equal(torch.rand(2), expected)
