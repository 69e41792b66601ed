"""The compact network as a stream."""

import pytest
import torch

from models.motion_tokens import FEATURES
from models.regennet import compact
from models.regennet.compact import CompactReGenNet, CompactReGenNetConfig, CompactStream
from motion import SMPL22


def test_a_stream_decodes_each_interval_once(monkeypatch: pytest.MonkeyPatch) -> None:
    config = CompactReGenNetConfig(latent_dim=16, ff_size=16, num_layers=1, num_heads=2, cond_dim=16, window=8)
    model = CompactReGenNet(config).eval()
    decoded = []
    decode = compact.decode
    monkeypatch.setattr(compact, "decode", lambda *given: decoded.append(given) or decode(*given))
    stream = CompactStream(model, torch.zeros(1, 16), steps=2, max_frames=12)
    noise = iter(torch.randn(model.num_rows(12) + 1, 1, FEATURES))
    actor = torch.from_numpy(SMPL22.rest_positions()).float()
    frames = torch.stack([stream.step(actor, noise=noise)[0] for _ in range(12)])
    assert len(decoded) == 3, "one for four frames"
    assert len(torch.unique(frames.flatten(1), dim=0)) == 12, "every frame is another"
