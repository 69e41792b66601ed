"""InterGen's text side: CLIP's frozen text tower and the trained transformer behind it.

Radford et al. 2021, section 2.4 (the tower: causal transformer, pre-norm, QuickGELU); Liang et al.,
"InterGen", section 5.1 and figure 5 (per-token features, a 2-layer encoder, read out at the end-of-text
token). All weights lie in the authors' `intergen.ckpt`; the byte-pair vocabulary does not, so the user names
a folder that has it.

Shapes: B prompts, 77 tokens, C = 768.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import torch
from torch import Tensor, nn

from models.errors import as_tensors, count_layers, load_strictly, shape_of
from models.released import read_lightning
from motion.errors import InputError

if TYPE_CHECKING:
    from tokenizers import Tokenizer

NETWORK = "CLIP text"
HEAD_WIDTH = 64  # CLIP's towers all have heads of 64 channels
ENCODER_HEADS = 8
PARTS = (
    "clip_transformer.",
    "token_embedding.",
    "positional_embedding",
    "ln_final.",
    "clipTransEncoder.",
    "clip_ln.",
)
START, END = "<|startoftext|>", "<|endoftext|>"
# CLIP's own split of a sentence into words (Radford et al.'s tokenizer).
WORDS = r"'s|'t|'re|'ve|'m|'ll|'d|[\p{L}]+|[\p{N}]|[^\s\p{L}\p{N}]+"


class VocabularyError(InputError):
    """CLIP's byte-pair vocabulary is missing or is not CLIP's."""


class ClipTokenizer:
    """Text → (B, 77) token numbers: start, words, end, zeros.

    Args:
        folder: holds ``tokenizer.json``, or ``vocab.json`` and ``merges.txt``, of any CLIP text model.

    Raises VocabularyError if it holds neither.
    """

    def __init__(self, folder: str | Path, *, context_length: int = 77) -> None:
        self.tokenizer = _read_vocabulary(Path(folder))
        self.context_length = context_length
        start, end = self.tokenizer.token_to_id(START), self.tokenizer.token_to_id(END)
        if start is None or end is None:
            raise VocabularyError(f"The vocabulary in {folder} is not CLIP's: it has no {START} and {END}.")
        self.start, self.end = start, end

    def __call__(self, prompts: Sequence[str]) -> Tensor:
        """Longer texts are cut, keeping the end token."""
        rows = torch.zeros(len(prompts), self.context_length, dtype=torch.long)
        for row, prompt in zip(rows, prompts, strict=True):
            ids = self.tokenizer.encode(prompt, add_special_tokens=False).ids[: self.context_length - 2]
            row[: len(ids) + 2] = torch.tensor([self.start, *ids, self.end])
        return rows


def _read_vocabulary(folder: Path) -> Tokenizer:
    from tokenizers import Regex, Tokenizer, models, normalizers, pre_tokenizers

    whole, vocabulary, merges = (folder / name for name in ("tokenizer.json", "vocab.json", "merges.txt"))
    try:
        if whole.is_file():
            tokenizer = Tokenizer.from_file(str(whole))
            tokenizer.no_padding()
            tokenizer.no_truncation()
            return tokenizer
        if vocabulary.is_file() and merges.is_file():
            bpe = models.BPE.from_file(str(vocabulary), str(merges), end_of_word_suffix="</w>", unk_token=END)
            tokenizer = Tokenizer(bpe)
            spaces = normalizers.Replace(Regex(r"\s+"), " ")
            tokenizer.normalizer = normalizers.Sequence([normalizers.NFC(), spaces, normalizers.Lowercase()])
            words = pre_tokenizers.Split(Regex(WORDS), behavior="removed", invert=True)
            letters = pre_tokenizers.ByteLevel(add_prefix_space=False)
            tokenizer.pre_tokenizer = pre_tokenizers.Sequence([words, letters])
            return tokenizer
    except Exception as error:  # tokenizers raises plain Exception for a file that it cannot parse
        raise VocabularyError(f"The vocabulary in {folder} cannot be read: download it again.") from error
    raise VocabularyError(
        f"{folder} holds no CLIP vocabulary: put tokenizer.json, or vocab.json and merges.txt, of a CLIP "
        "text model there (InterGen's checkpoint does not carry it)."
    )


class ResidualBlock(nn.Module):
    """A layer of CLIP's tower: causal self-attention, then QuickGELU, each behind a LayerNorm."""

    def __init__(self, width: int) -> None:
        super().__init__()
        self.attn = nn.MultiheadAttention(width, width // HEAD_WIDTH, batch_first=True)
        self.ln_1 = nn.LayerNorm(width)
        self.mlp = nn.ModuleDict({"c_fc": nn.Linear(width, 4 * width), "c_proj": nn.Linear(4 * width, width)})
        self.ln_2 = nn.LayerNorm(width)

    def forward(self, x: Tensor, causal: Tensor) -> Tensor:
        """x (B, L, d) with the causal mask (L, L) → (B, L, d)."""
        normed = self.ln_1(x)
        x = x + self.attn(normed, normed, normed, need_weights=False, attn_mask=causal)[0]
        hidden = self.mlp["c_fc"](self.ln_2(x))
        return x + self.mlp["c_proj"](hidden * torch.sigmoid(1.702 * hidden))


class Tower(nn.Module):
    """The layers of CLIP's text tower."""

    def __init__(self, width: int, num_layers: int) -> None:
        super().__init__()
        self.resblocks = nn.ModuleList(ResidualBlock(width) for _ in range(num_layers))

    def forward(self, x: Tensor) -> Tensor:
        """Token embeddings (B, L, d) → (B, L, d), each token attending to those before it."""
        length = x.shape[1]
        causal = torch.full((length, length), float("-inf"), device=x.device).triu(1)
        for block in self.resblocks:
            x = block(x, causal)
        return x


class ClipTextEncoder(nn.Module):
    """Token numbers → the 768-vector `cond` of `models.intergen`, by the released names."""

    def __init__(
        self,
        *,
        vocabulary: int,
        context_length: int,
        width: int,
        num_layers: int,
        ff_size: int,
        encoder_layers: int,
    ) -> None:
        super().__init__()
        self.token_embedding = nn.Embedding(vocabulary, width)
        self.positional_embedding = nn.Parameter(torch.zeros(context_length, width))
        self.clip_transformer = Tower(width, num_layers)
        self.ln_final = nn.LayerNorm(width)
        layer = nn.TransformerEncoderLayer(width, ENCODER_HEADS, ff_size, activation="gelu", batch_first=True)
        self.clipTransEncoder = nn.TransformerEncoder(layer, encoder_layers, enable_nested_tensor=False)
        self.clip_ln = nn.LayerNorm(width)

    def token_features(self, tokens: Tensor) -> Tensor:
        """The frozen part: (B, 77) int64 → (B, 77, C)."""
        x = self.token_embedding(tokens) + self.positional_embedding
        return self.ln_final(self.clip_transformer(x))

    def forward(self, tokens: Tensor) -> Tensor:
        """(B, 77) int64 → (B, C), read at the end-of-text token, which has the largest number."""
        features = self.clip_ln(self.clipTransEncoder(self.token_features(tokens)))
        return features[torch.arange(len(tokens), device=tokens.device), tokens.argmax(-1)]


def from_released(weights: Mapping[str, Tensor]) -> ClipTextEncoder:
    """The encoder whose released tensors these are; eval mode, float32.

    Raises WeightsError if a tensor is missing, unknown or of another size.
    """
    tensors = as_tensors(weights)
    vocabulary, width = shape_of(tensors, "token_embedding.weight", network=NETWORK)
    encoder = ClipTextEncoder(
        vocabulary=vocabulary,
        context_length=shape_of(tensors, "positional_embedding", network=NETWORK)[0],
        width=width,
        num_layers=count_layers(tensors, "clip_transformer.resblocks."),
        ff_size=shape_of(tensors, "clipTransEncoder.layers.0.linear1.weight", network=NETWORK)[0],
        encoder_layers=count_layers(tensors, "clipTransEncoder.layers."),
    )
    load_strictly(encoder, tensors, network=NETWORK)
    return encoder.requires_grad_(False)


def from_checkpoint(path: str | Path) -> ClipTextEncoder:
    """The text side of the authors' Lightning file; raises WeightsError for any other file."""
    weights = read_lightning(path, prefix="model.", network="InterGen")
    return from_released({name: value for name, value in weights.items() if name.startswith(PARTS)})
