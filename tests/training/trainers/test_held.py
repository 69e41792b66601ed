"""Known parts written in one product are those that are written mask by mask."""

from __future__ import annotations

import torch

from models.known import Hold
from models.motion_tokens import FEATURES, TokenLayout, pack
from training.trainers.given import Held, Shares, known_parts

LAYOUT = TokenLayout()


def test_one_product_writes_the_same_as_one_for_each_mask() -> None:
    generator = torch.Generator().manual_seed(4)
    control = torch.randn(6, 2, 8 * LAYOUT.knots_per_token, FEATURES, generator=generator)
    frames = [LAYOUT.num_frames(8)] * 6
    shares = Shares(person=0.3, past=0.2, span=0.1, poses=0.1, path=0.2, joints=0.1)
    known = known_parts(control, frames, [0, 9, 0, 0, 0, 0], LAYOUT, shares, generator)
    assert known is not None
    mean, std = torch.randn(FEATURES, generator=generator), torch.full((FEATURES,), 0.7)
    hold = Hold(known, LAYOUT, mean, std)
    kinds = {group.move is None for group in hold.groups}
    assert kinds == {True, False} and len(hold.groups) > 5
    x = torch.randn(pack(control, LAYOUT).shape, generator=generator, requires_grad=True)
    held = Held.of(hold)
    assert torch.allclose(held(x), hold(x), atol=2e-5)
    assert (hold(x) - x).abs().max() > 0.1
    one, other = (torch.autograd.grad(f(x).square().sum(), x)[0] for f in (held, hold))
    assert torch.allclose(one, other, atol=2e-3)
    assert torch.allclose(held.features.float(), hold.features, atol=0.01)
