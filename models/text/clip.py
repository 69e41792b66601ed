"""InterGen's text side: CLIP's frozen text tower and the trained transformer behind it.

Radford et al. 2021, section 2.4 (the tower: causal transformer, pre-norm, QuickGELU); Liang et al.,
"InterGen", section 5.1 and figure 5 (per-token features, a 2-layer encoder, read out at the end-of-text
token). All weights lie in the authors' `intergen.ckpt`; the byte-pair vocabulary does not. It is read from the
files of the package open-clip-torch, of which nothing is imported, or from a file that the user names.

Shapes: B prompts, 77 tokens, C = 768.
"""

from __future__ import annotations

import gzip
from collections.abc import Mapping, Sequence
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path
from typing import TYPE_CHECKING

import torch
from torch import Tensor, nn

from models.released import Released
from motion.errors import InputError

if TYPE_CHECKING:
    from tokenizers import Tokenizer

NETWORK = "CLIP text"
HEAD_WIDTH = 64  # CLIP's towers all have heads of 64 channels
ENCODER_HEADS = 8
TOWER_PARTS = ("transformer.", "token_embedding.", "positional_embedding", "ln_final.")
PARTS = (*TOWER_PARTS, "clipTransEncoder.", "clip_ln.")
START, END = "<|startoftext|>", "<|endoftext|>"
VOCABULARY_PACKAGE = "open-clip-torch"
VOCABULARY_FILE = "open_clip/bpe_simple_vocab_16e6.txt.gz"
MERGES = 49152 - 256 - 2
"""Merges of CLIP's own vocabulary; its file holds more of them, which CLIP leaves out."""
_MOST_CHARACTERS = 20_000_000
# CLIP's own split of a sentence into words (Radford et al.'s tokenizer).
WORDS = r"'s|'t|'re|'ve|'m|'ll|'d|[\p{L}]+|[\p{N}]|[^\s\p{L}\p{N}]+"


class VocabularyError(InputError):
    """CLIP's byte-pair vocabulary is missing or is not CLIP's."""


def find_vocabulary() -> Path:
    """The vocabulary in the files of the installed package open-clip-torch; nothing of it is imported.

    Raises VocabularyError if the package is not installed.
    """
    try:
        path = Path(str(distribution(VOCABULARY_PACKAGE).locate_file(VOCABULARY_FILE)))
    except PackageNotFoundError:
        path = Path()
    if not path.is_file():
        raise VocabularyError(
            "CLIP's vocabulary is not inside the checkpoint: `pip install --no-deps open-clip-torch` (one of its "
            "files is read, nothing is imported), or name a file that has it as `vocabulary`."
        )
    return path


class ClipTokenizer:
    """Text → (B, 77) token numbers: start, words, end, zeros.

    Args:
        path: of CLIP's own ``bpe_simple_vocab_16e6.txt.gz``.
        tower: whose tokens and length these are.

    Raises VocabularyError if it is another file, or has other tokens than the tower.
    """

    def __init__(self, path: Path, tower: ClipTower) -> None:
        self.tokenizer = _read_merges(path)
        self.context_length = len(tower.positional_embedding)
        known, used = len(tower.token_embedding.weight), self.tokenizer.get_vocab_size()
        if known != used:
            raise VocabularyError(
                f"The checkpoint's text side knows {known:,} tokens and the vocabulary has {used:,}: use CLIP's own."
            )
        self.start, self.end = self.tokenizer.token_to_id(START), self.tokenizer.token_to_id(END)

    def __call__(self, prompts: Sequence[str]) -> Tensor:
        """Longer texts are cut, keeping the end token."""
        rows = torch.zeros(len(prompts), self.context_length, dtype=torch.long)
        for row, prompt in zip(rows, prompts, strict=True):
            ids = self.tokenizer.encode(prompt, add_special_tokens=False).ids[: self.context_length - 2]
            row[: len(ids) + 2] = torch.tensor([self.start, *ids, self.end])
        return rows


def _read_merges(path: Path) -> Tokenizer:
    """CLIP's own file: a title, then one merge a line; letters, merges and the two marks are the vocabulary."""
    from tokenizers import Regex, Tokenizer, normalizers, pre_tokenizers
    from tokenizers.models import BPE
    from tokenizers.pre_tokenizers import ByteLevel

    try:
        with gzip.open(path, "rt", encoding="utf-8") as file:
            lines = file.read(_MOST_CHARACTERS).splitlines()[1 : MERGES + 1]
        merges = [(first, second) for first, second in (line.split() for line in lines if line)]
        letters = sorted(ByteLevel.alphabet(), key=_byte_order)
        names = [*letters, *(f"{letter}</w>" for letter in letters), *("".join(merge) for merge in merges)]
        vocabulary = {name: i for i, name in enumerate([*names, START, END])}
        tokenizer = Tokenizer(BPE(vocabulary, merges, end_of_word_suffix="</w>", unk_token=END))
    except Exception as error:  # gzip, Unicode, a line that is no merge, or what tokenizers raises
        raise VocabularyError(f"{path.name} is not CLIP's vocabulary: download it again.") from error
    spaces = normalizers.Replace(Regex(r"\s+"), " ")
    tokenizer.normalizer = normalizers.Sequence([normalizers.NFC(), spaces, normalizers.Lowercase()])
    words = pre_tokenizers.Split(Regex(WORDS), behavior="removed", invert=True)
    tokenizer.pre_tokenizer = pre_tokenizers.Sequence([words, ByteLevel(add_prefix_space=False)])
    return tokenizer


def _byte_order(letter: str) -> tuple[bool, int]:
    """CLIP lists the bytes that can be printed as themselves first, then the stand-ins of the others."""
    return ord(letter) > 255, ord(letter)


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


class ClipTower(nn.Module):
    """CLIP's frozen text tower, by OpenAI's names.

    Args:
        vocabulary, context_length: sizes of the tables of tokens and positions.
        width, num_layers: of the transformer.
    """

    def __init__(self, *, vocabulary: int, context_length: int, width: int, num_layers: int) -> None:
        super().__init__()
        self.token_embedding = nn.Embedding(vocabulary, width)
        self.positional_embedding = nn.Parameter(torch.zeros(context_length, width))
        self.transformer = Tower(width, num_layers)
        self.ln_final = nn.LayerNorm(width)

    def token_features(self, tokens: Tensor) -> Tensor:
        """(B, 77) int64 → features of every token (B, 77, C) after the last norm."""
        x = self.token_embedding(tokens) + self.positional_embedding
        return self.ln_final(self.transformer(x))


class ClipTextEncoder(ClipTower):
    """Token numbers → the 768-vector `cond` of `models.intergen`: the tower, and InterGen's trained layers behind it.

    Args:
        ff_size, encoder_layers: of the trained layers.
        sizes: of the tower.
    """

    def __init__(self, *, width: int, ff_size: int, encoder_layers: int, **sizes: int) -> None:
        super().__init__(width=width, **sizes)
        layer = nn.TransformerEncoderLayer(width, ENCODER_HEADS, ff_size, activation="gelu", batch_first=True)
        self.clipTransEncoder = nn.TransformerEncoder(layer, encoder_layers, enable_nested_tensor=False)
        self.clip_ln = nn.LayerNorm(width)

    def forward(self, tokens: Tensor) -> Tensor:
        """(B, 77) int64 → (B, C), read at the end-of-text token, which has the largest number."""
        features = self.clip_ln(self.clipTransEncoder(self.token_features(tokens)))
        return features[torch.arange(len(tokens), device=tokens.device), tokens.argmax(-1)]


def from_released(weights: Mapping[str, Tensor]) -> ClipTextEncoder:
    """The encoder whose released tensors are among these; eval mode, float32.

    Raises WeightsError if a tensor is missing or of another size.
    """
    named = {name.replace("clip_transformer.", "transformer."): value for name, value in weights.items()}
    tensors = Released({name: value for name, value in named.items() if name.startswith(PARTS)}, NETWORK)
    encoder = ClipTextEncoder(
        **_sizes(tensors),
        ff_size=tensors.shape("clipTransEncoder.layers.0.linear1.weight")[0],
        encoder_layers=tensors.layers("clipTransEncoder.layers."),
    )
    return tensors.loaded(encoder).requires_grad_(False)


def tower_from_released(weights: Mapping[str, Tensor]) -> ClipTower:
    """The text tower among CLIP's tensors, whose picture side is left out; eval mode, float32.

    Raises WeightsError if a tensor is missing or of another size.
    """
    tensors = Released({name: value for name, value in weights.items() if name.startswith(TOWER_PARTS)}, NETWORK)
    return tensors.loaded(ClipTower(**_sizes(tensors))).requires_grad_(False)


def _sizes(tensors: Released) -> dict[str, int]:
    """The sizes of a tower."""
    vocabulary, width = tensors.shape("token_embedding.weight")
    length, layers = tensors.shape("positional_embedding")[0], tensors.layers("transformer.resblocks.")
    return {"vocabulary": vocabulary, "context_length": length, "width": width, "num_layers": layers}
