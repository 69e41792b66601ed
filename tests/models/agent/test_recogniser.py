"""The virtual agent's recogniser: which joints see each other, what is seen of a motion, its folder."""

from __future__ import annotations

from pathlib import Path

import torch

from models.agent.recogniser import FRAMES, OBSERVED, PREDICTED, Recogniser, RecogniserConfig, sampled
from models.layers import neighbours
from models.weights_io import load_network, save_network
from motion import SMPL22

CONFIG = RecogniserConfig(
    ("nothing", "wave"), ("", "They wave."), joint_width=4, latent_dim=16, ff_size=16, num_layers=1, num_heads=2
)


def test_joints_see_their_neighbours_alone() -> None:
    seen = neighbours(SMPL22)
    assert torch.equal(seen, seen.T) and seen.diagonal().all()
    assert int(seen.sum()) == SMPL22.num_joints + 2 * len(SMPL22.bones)
    elbow = [SMPL22.index(name) for name in ("left_shoulder", "left_elbow", "left_wrist")]
    assert seen[elbow[1]].nonzero().flatten().tolist() == elbow


def test_every_third_frame_is_seen_and_the_last_known_among_them() -> None:
    frames = torch.arange(OBSERVED + PREDICTED).float()[None, :, None, None].expand(1, -1, 22, 3)
    seen = sampled(frames)[0, :, 0, 0].tolist()
    assert len(seen) == FRAMES and OBSERVED - 1 in seen and seen[-1] == OBSERVED + PREDICTED - 1


def test_a_folder_gives_the_same_network_back(tmp_path: Path) -> None:
    torch.manual_seed(0)
    network = Recogniser(CONFIG).half().float().eval().requires_grad_(False)
    save_network(tmp_path, network)
    again, _ = load_network(tmp_path, Recogniser)
    assert again.config == CONFIG
    motion = torch.randn(3, FRAMES, 22, 3)
    logits = network(motion)
    assert logits.shape == (3, 2)
    assert torch.equal(again(motion), logits)
    assert (network(motion.flip(1)) - logits).abs().max() > 1e-4  # the order of the frames is seen
    assert (network(motion + 1) - logits).abs().max() > 1e-4  # and where somebody is
