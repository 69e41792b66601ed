"""Files with random weights under the names of the released ones, small enough for a test."""

from __future__ import annotations

import gzip
from pathlib import Path

import numpy as np
import torch
from torch import Tensor, nn

from models.bigraphdiff.network import BiGraphDiff, BiGraphDiffConfig, TextSide
from models.interformer.network import InterFormer, InterFormerConfig
from models.intergen import InterGenConfig, InterGenDenoiser
from models.regennet.network import ReGenNet, ReGenNetConfig
from models.text.clip import ClipTextEncoder, ClipTower
from motion import SMPL22
from motion.representation import encode_person

MERGES = ("t w", "tw o</w>", "p e", "pe o", "w a", "wa v", "wav e</w>")


def write_vocabulary(folder: Path) -> Path:
    """A vocabulary in the form of CLIP's own file, with a few merges."""
    path = folder / "bpe_simple_vocab_16e6.txt.gz"
    path.write_bytes(gzip.compress("\n".join(['"bpe_simple_vocab_16e6.txt#version: 0.2', *MERGES]).encode()))
    return path


def drawn(module: nn.Module) -> dict[str, Tensor]:
    """The module's tensors, drawn anew: the zero-initialised ones would hide what the input does."""
    draw = torch.Generator().manual_seed(3)
    for tensor in module.parameters():
        tensor.data = 0.05 * torch.randn(tensor.shape, generator=draw)
    return {name: tensor.detach().clone() for name, tensor in module.state_dict().items()}


def normaliser() -> tuple[np.ndarray, np.ndarray]:
    """Mean and standard deviation (262,) of a person who stands at the origin."""
    rest = SMPL22.standing()
    numbers = encode_person(np.repeat(rest[None], 3, axis=0))
    return numbers[0], np.full(262, 0.1, dtype=np.float32)


def write_intergen(folder: Path) -> dict[str, Path]:
    """``intergen.ckpt`` as Lightning writes it, with its normaliser and a vocabulary; role → path."""
    denoiser = InterGenDenoiser(InterGenConfig(latent_dim=128, ff_size=64, num_layers=2, num_heads=1, cond_dim=64))
    text = ClipTextEncoder(
        vocabulary=512 + len(MERGES) + 2, context_length=77, width=64, num_layers=1, ff_size=64, encoder_layers=2
    )
    state = {f"model.decoder.net.{name}": value for name, value in drawn(denoiser).items()}
    state |= {
        f"model.{name.replace('transformer.', 'clip_transformer.')}": value for name, value in drawn(text).items()
    }
    state["model.decoder.net.sequence_pos_encoder.pe"] = torch.zeros(4, 1, 8)
    folder.mkdir(parents=True, exist_ok=True)
    paths = {role: folder / name for role, name in FILES.items()}
    torch.save({"state_dict": state, "epoch": 2000, "optimizer_states": []}, paths["checkpoint"])
    for role, value in zip(("mean", "std"), normaliser(), strict=True):
        np.save(paths[role], value)
    return paths | {"vocabulary": write_vocabulary(folder)}


FILES = {"checkpoint": "intergen.ckpt", "mean": "global_mean.npy", "std": "global_std.npy"}


def write_regennet(path: Path, *, online: bool, actions: int = 0) -> None:
    """A file as ReGenNet's trainer writes it, with the position tables that the release stores."""
    network = ReGenNet(
        ReGenNetConfig(latent_dim=128, ff_size=32, num_layers=2, num_heads=1, online=online, num_actions=actions)
    )
    state = drawn(network) | {"sequence_pos_encoder.pe": torch.zeros(9, 1, 128)}
    state["embed_timestep.sequence_pos_encoder.pe"] = torch.zeros(9, 1, 128)
    torch.save(state, path)


def write_interformer(path: Path) -> None:
    """A file as PyTorch's DataParallel names it."""
    network = InterFormer(InterFormerConfig(num_layers=1, ff_size=32, max_length=40))
    torch.save({f"module.{name}": value for name, value in drawn(network).items()}, path)


def write_bigraphdiff(path: Path) -> None:
    """A file by the released names, with the unused parts that the release holds."""
    side = TextSide(clip_dim=64, text_dim=32, ff_size=32, num_layers=1, num_heads=4)
    config = BiGraphDiffConfig(
        latent_dim=64, ff_size=32, num_layers=1, num_heads=1, text_dim=32, max_frames=90, num_nodes=4
    )
    state = {}
    for name, value in drawn(BiGraphDiff(config, text_side=side)).items():
        name = name.removeprefix("text_side.").replace(".bipartite_graph.", ".ga.")
        state[name.replace("text_proj.", "text_proj.0.") if name.startswith("text_proj.") else name] = value
    tower = ClipTower(vocabulary=512 + len(MERGES) + 2, context_length=77, width=64, num_layers=1)
    state |= {f"clip.{name}": value for name, value in drawn(tower).items()}
    unused = {"clip.visual.proj": (2, 2), "temporal_decoder_blocks.0.ffn.linear1.weight": (2, 2)}
    state |= {name: torch.zeros(shape) for name, shape in unused.items()}
    torch.save({"encoder": state, "ep": 3, "opt_encoder": {"state": {}}}, path)
