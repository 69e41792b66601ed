"""Features of duets and of sentences, for the judge: ``python -m training.evaluate.extractor --scenes F --out F``.

InterGen (section 5, evaluation metrics) measures R-precision, FID and the rest in the feature space of an
interaction encoder and a text encoder that are trained together by a contrastive loss (Radford et al. 2021),
so that a duet lies near its sentence. Both here are small transformers, over spline tokens and over frozen
MiniLM features; they share nothing with the generators that they judge but the corpus.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict, dataclass
from pathlib import Path

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from models.layers import encoder_layer, sinusoids
from models.motion_tokens import FEATURES, TokenLayout, encode, foot_contacts, pack
from models.text import TextConditioner, TextConditionerConfig, TokenFeatures
from motion import InputError
from training.core import loop
from training.core.checkpoint import read_tensors, write_tensors
from training.core.loop import mixed_precision
from training.core.shell import add_options, exit_code
from training.prepare import Scenes, load
from training.trainers.intergen_data import OneSentence
from training.trainers.intergen_data import Settings as DataSettings


@dataclass(frozen=True)
class Settings:
    """Sizes and the training of an :class:`Extractor`."""

    width: int = 192
    num_layers: int = 4
    num_heads: int = 4
    features: int = 128
    batch: int = 64
    steps: int = 3000
    learning_rate: float = 5e-4
    weight_decay: float = 0.02
    dropout: float = 0.1
    seed: int = 7


class Extractor(nn.Module):
    """Features of duets and of sentences, unit vectors (B, ``settings.features``)."""

    mean: Tensor
    std: Tensor

    def __init__(self, settings: Settings, layout: TokenLayout) -> None:
        super().__init__()
        self.settings, self.layout = settings, layout
        self.embed = nn.Linear(2 * layout.token_features, settings.width)
        self.query = nn.Parameter(0.02 * torch.randn(settings.width))
        layer = encoder_layer(settings.width, settings.num_heads, 4 * settings.width, settings.dropout)
        self.encoder = nn.TransformerEncoder(layer, settings.num_layers, enable_nested_tensor=False)
        self.head = nn.Sequential(nn.LayerNorm(settings.width), nn.Linear(settings.width, settings.features))
        self.conditioner = TextConditioner(
            TextConditionerConfig(latent_dim=settings.width, ff_size=2 * settings.width, dropout=0.1)
        )
        self.text_head = nn.Linear(settings.width, settings.features)
        self.temperature = nn.Parameter(torch.tensor(0.07).log())
        self.register_buffer("mean", torch.zeros(FEATURES))
        self.register_buffer("std", torch.ones(FEATURES))

    def motion(self, x: Tensor, keep: Tensor) -> Tensor:
        """Normalised tokens (B, tokens, 2·token_features) and their mask (B, tokens) → (B, features)."""
        tokens = self.embed(x) + sinusoids(x.shape[1], self.settings.width, device=x.device)
        tokens = torch.cat([self.query.expand(len(x), 1, -1), tokens], dim=1)
        padding = F.pad(~keep, (1, 0), value=False)
        seen = self.encoder(tokens, src_key_padding_mask=padding)[:, 0]
        return F.normalize(self.head(seen).float(), dim=-1)

    def text(self, tokens: TokenFeatures) -> Tensor:
        """Frozen token features of B sentences → (B, features)."""
        return F.normalize(self.text_head(self.conditioner(tokens.features, tokens.mask)).float(), dim=-1)

    @torch.no_grad()
    def of_positions(self, positions: Tensor) -> Tensor:
        """Features of one duet's positions (2, T, 22, 3) in metres at 30 fps → (features,).

        What does not fill a token at the end is left out.
        """
        tokens = self.layout.filled_tokens(positions.shape[1])
        positions = positions[:, : self.layout.num_frames(tokens)].float()
        control = (encode(positions, foot_contacts(positions), self.layout) - self.mean) / self.std
        return self.motion(pack(control[None], self.layout), torch.ones(1, tokens, dtype=torch.bool))[0]


def contrast(motion: Tensor, text: Tensor, temperature: Tensor, same: Tensor) -> Tensor:
    """Symmetric InfoNCE of matched rows (B, D); ``same`` (B, B) true where two captions are the same."""
    logits = motion @ text.T / temperature
    logits = logits.masked_fill(same & ~torch.eye(len(same), dtype=torch.bool, device=same.device), -1e4)
    labels = torch.arange(len(logits), device=logits.device)
    return (F.cross_entropy(logits, labels) + F.cross_entropy(logits.T, labels)) / 2


def fit(scenes: Scenes, settings: Settings, cache: Path, *, device: str = "cpu") -> Extractor:
    """Trains an extractor on the training split; the same seed and data give the same features."""
    torch.manual_seed(settings.seed)
    data = OneSentence(scenes, DataSettings(batch=settings.batch, seed=settings.seed), cache, device)
    model = Extractor(settings, scenes.layout).to(device)
    model.mean.copy_(data.mean)
    model.std.copy_(data.std)

    def loss(step: int) -> Tensor:
        batch = data.on_device(data.batch(step))
        with mixed_precision(device):
            motion = model.motion(batch.x0, batch.mask[..., 0].bool())
            text = model.text(TokenFeatures(batch.text, batch.text_mask))
        same = (batch.text[:, None] == batch.text[None]).flatten(2).all(-1)
        return contrast(motion, text, model.temperature.exp().clamp_min(0.01), same)

    rates = {"rate": settings.learning_rate, "weight_decay": settings.weight_decay}
    loop.fit(model, loss, settings.steps, every=100, **rates)
    return model


def save(model: Extractor, path: Path) -> None:
    """Writes an extractor as float32 ``.safetensors``."""
    tensors = {name: value.contiguous() for name, value in model.state_dict().items()}
    write_tensors(path, tensors, settings=asdict(model.settings), layout=asdict(model.layout))


def load_extractor(path: Path) -> Extractor:
    """Reads what :func:`save` wrote; raises InputError if it is missing or damaged."""
    command = "run `python -m training.evaluate.extractor`."
    tensors, known = read_tensors(path, command)
    try:
        model = Extractor(Settings(**json.loads(known["settings"])), TokenLayout(**json.loads(known["layout"])))
        model.load_state_dict(tensors)
    except (KeyError, TypeError, ValueError, RuntimeError) as error:
        raise InputError(f"{path} holds no extractor ({error}): {command}") from error
    return model.eval().requires_grad_(False)


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(description="Train the feature extractor of the judge.")
    add_options(parser, "scenes", "device")
    parser.add_argument("--out", type=Path, required=True, help="the .safetensors file to write")
    parser.add_argument("--steps", type=int, default=Settings.steps)
    parser.add_argument("--batch", type=int, default=Settings.batch)
    parser.add_argument("--seed", type=int, default=Settings.seed)
    options = parser.parse_args(argv)
    settings = Settings(steps=options.steps, batch=options.batch, seed=options.seed)
    return exit_code(
        lambda: save(fit(load(options.scenes), settings, options.out.parent, device=options.device), options.out)
    )


if __name__ == "__main__":
    raise SystemExit(main())
