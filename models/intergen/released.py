"""The authors' InterGen: denoiser, text side and normaliser of the released files, in the paper's representation.

A sample is (B, T − 1, 524) for T frames: the 262 numbers of each person and frame (:mod:`motion.representation`),
less the mean and over the standard deviation of ``global_mean.npy`` and ``global_std.npy``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from torch import Tensor

from models.errors import WeightsError
from models.released import read_tensors, with_prefix
from models.text.clip import ClipTextEncoder, ClipTokenizer
from models.text.clip import from_released as text_from_released
from models.weights_io import Uninitialised
from motion.representation import CONTACTS, NUM_FEATURES, POSITIONS, VELOCITIES, encode_person

from .network import NETWORK, RELEASED_HEADS, InterGenDenoiser, from_released

DENOISER, WHOLE = "model.decoder.net.", "model."
HEAD_WIDTH = 128
"""Channels of a head in the released network; a narrower one made for a test has fewer heads."""


@dataclass(frozen=True)
class FrameLayout:
    """A token is a frame; the last frame of a motion is restored from the velocities of the one before."""

    token_features: int = NUM_FEATURES

    def num_tokens(self, frames: int) -> int:
        """Tokens of a motion of so many frames."""
        return frames - 1


class ReleasedInterGen:
    """Everything in the released files.

    Args:
        denoiser: D_θ.
        text: sentence → condition.
        tokenizer: of the text side.
        mean, std: (262,) normaliser.
    """

    reads_known = False

    def __init__(
        self, denoiser: InterGenDenoiser, text: ClipTextEncoder, tokenizer: ClipTokenizer, mean: Tensor, std: Tensor
    ) -> None:
        self.denoiser, self.text, self.tokenizer = denoiser, text, tokenizer
        self.mean, self.std, self.layout = mean, std, FrameLayout()

    @property
    def scale(self) -> Tensor:
        """(524,) metres to a unit of each number."""
        return self.std.repeat(2)

    def condition(self, prompts: Sequence[str]) -> Tensor:
        """(B, 768) what the denoiser sees of sentences."""
        with torch.no_grad():
            return self.text(self.tokenizer(prompts))

    def no_condition(self) -> Tensor:
        """(1, 768) the condition of no words."""
        return torch.zeros(1, self.denoiser.config.cond_dim)

    def positions(self, x: Tensor) -> tuple[Tensor, Tensor]:
        """Sample (B, T − 1, 524) → positions (B, 2, T, 22, 3) in metres and contacts (B, 2, T, 4)."""
        people = x.unflatten(-1, (2, NUM_FEATURES)).transpose(1, 2) * self.std + self.mean
        frames, moves = (people[..., part].unflatten(-1, (22, 3)) for part in (POSITIONS, VELOCITIES))
        contacts = people[..., CONTACTS]
        return (
            torch.cat([frames, frames[:, :, -1:] + moves[:, :, -1:]], dim=2),
            torch.cat([contacts, contacts[:, :, -1:]], dim=2),
        )

    def encode(self, positions: np.ndarray) -> Tensor:
        """One person (T, 22, 3) in the network's frame → normalised numbers (T − 1, 262)."""
        return (torch.from_numpy(encode_person(positions)) - self.mean) / self.std


def load_released(checkpoint: Path, mean: Path, std: Path, vocabulary: Path) -> ReleasedInterGen:
    """The network of the authors' files.

    Args:
        checkpoint: ``intergen.ckpt``.
        mean, std: ``global_mean.npy`` and ``global_std.npy``.
        vocabulary: as :class:`~models.text.clip.ClipTokenizer` takes it.

    Raises:
        WeightsError: if a file is missing, damaged or another network's.
        VocabularyError: if the vocabulary is not CLIP's.
    """
    normaliser = read_normaliser(mean, std, NUM_FEATURES)
    tensors = read_tensors(checkpoint, network=NETWORK)
    own = with_prefix(tensors, DENOISER)
    latent_dim = own["motion_embed.weight"].shape[0] if "motion_embed.weight" in own else RELEASED_HEADS
    with Uninitialised():
        denoiser = from_released(own, num_heads=max(1, min(RELEASED_HEADS, latent_dim // HEAD_WIDTH)))
    if denoiser.config.input_features != NUM_FEATURES:
        raise WeightsError(
            f"{checkpoint.name} was trained on {denoiser.config.input_features} numbers a person and frame, and "
            f"InterGen's representation has {NUM_FEATURES}: use the released checkpoint."
        )
    with Uninitialised():
        text = text_from_released(with_prefix(tensors, WHOLE))
    return ReleasedInterGen(denoiser.requires_grad_(False), text, ClipTokenizer(vocabulary, text), *normaliser)


def read_normaliser(mean: Path, std: Path, width: int) -> tuple[Tensor, Tensor]:
    """Mean and standard deviation (width,) of two ``.npy`` files.

    Raises:
        WeightsError: if a file is no such array, or a deviation is not positive.
    """
    values = []
    for path in (mean, std):
        if not path.is_file():
            raise WeightsError(f"There is no file {path}: name the normaliser that came with the checkpoint.")
        try:
            stored = np.load(path, mmap_mode="r", allow_pickle=False)
            if stored.dtype.kind != "f" or stored.size != width:
                raise ValueError(f"{stored.dtype} {stored.shape}")
            values.append(torch.from_numpy(np.array(stored, dtype=np.float32).reshape(width)))
        except (OSError, ValueError, EOFError) as error:
            raise WeightsError(
                f"{path.name} is not {width} numbers ({error}): use the normaliser that came with the checkpoint."
            ) from None
        if not torch.isfinite(values[-1]).all():
            raise WeightsError(f"{path.name} holds numbers that are not finite: copy or download it again.")
    if not (values[1] > 0).all():
        raise WeightsError(
            f"{std.name} holds standard deviations that are not positive: are {mean.name} and {std.name} swapped?"
        )
    return values[0], values[1]
