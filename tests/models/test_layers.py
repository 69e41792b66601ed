"""Layers that several networks share."""

import math

import torch

from models.layers import FeedForward, sinusoids, sinusoids_at


def test_sinusoids_are_those_of_the_paper() -> None:
    table = sinusoids(6, 8)
    for position in range(6):
        for channel in range(8):
            angle = position / 10000 ** (channel // 2 * 2 / 8)
            expected = math.sin(angle) if channel % 2 == 0 else math.cos(angle)
            assert abs(table[position, channel].item() - expected) < 1e-6


def test_rows_from_a_start_are_rows_of_the_table() -> None:
    table = sinusoids(12, 7)
    torch.testing.assert_close(sinusoids(4, 7, start=8), table[8:])
    torch.testing.assert_close(sinusoids_at(torch.tensor([3, 11]), 7), table[[3, 11]])


def test_dropout_acts_in_training_only() -> None:
    torch.manual_seed(0)
    layer, h = FeedForward(8, 64, dropout=0.5), torch.randn(4, 8)
    assert not torch.equal(layer(h), layer(h))
    layer.eval()
    assert torch.equal(layer(h), layer(h))
