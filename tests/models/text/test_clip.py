"""InterGen's text side: the tower against torch's own layers, the vocabulary, the checkpoint's names."""

from __future__ import annotations

import gzip

import pytest
import torch
from torch import nn

from models.errors import WeightsError
from models.text.clip import ClipTextEncoder, ClipTokenizer, ClipTower, VocabularyError, from_released
from tests.models.reference_arrays import Reference, assert_equal


@pytest.fixture(scope="module")
def encoder() -> ClipTextEncoder:
    torch.manual_seed(0)
    encoder = ClipTextEncoder(vocabulary=40, context_length=12, width=128, num_layers=2, ff_size=32, encoder_layers=2)
    for parameter in encoder.parameters():
        nn.init.normal_(parameter, std=0.1)
    return encoder.eval().requires_grad_(False)


def test_the_text_side_equals_the_reference():
    """Against the CLIP of `transformers` and an encoder in NumPy."""
    ref = Reference("clip_text")
    encoder = from_released(ref.made_weights())
    assert_equal(encoder.token_features(ref["tokens"]), ref["token_features"])
    assert_equal(encoder(ref["tokens"]), ref["condition"])


def tokens() -> torch.Tensor:
    rows = torch.zeros(2, 12, dtype=torch.long)
    rows[0, :5] = torch.tensor([38, 4, 7, 9, 39])
    rows[1, :8] = torch.tensor([38, 4, 7, 30, 2, 2, 1, 39])
    return rows


def test_the_tower_equals_torch_layers(encoder):
    x = torch.randn(2, 12, 128)
    expected = x
    causal = nn.Transformer.generate_square_subsequent_mask(12)
    for block in encoder.transformer.resblocks:
        layer = nn.TransformerEncoderLayer(
            128, 2, 512, activation=lambda h: h * torch.sigmoid(1.702 * h), batch_first=True, norm_first=True
        ).eval()
        names = {"attn": "self_attn", "mlp.c_fc": "linear1", "mlp.c_proj": "linear2"}
        names |= {"ln_1": "norm1", "ln_2": "norm2"}
        state = {
            ours + name.removeprefix(theirs): value
            for theirs, ours in names.items()
            for name, value in block.state_dict().items()
            if name.startswith(theirs + ".")
        }
        layer.load_state_dict(state)
        expected = layer(expected, src_mask=causal)
    assert_equal(encoder.transformer(x), expected.detach(), 1e-4)


def test_a_tensor_that_is_missing_is_named():
    with pytest.raises(WeightsError, match=r"token_embedding\.weight is missing"):
        from_released({})


def test_clips_own_file_of_merges_is_read(tmp_path):
    path = tmp_path / "bpe_simple_vocab_16e6.txt.gz"
    path.write_bytes(gzip.compress(b'"version: 0.2\nh i</w>\nt h\nth e</w>\n'))
    tower = ClipTower(vocabulary=517, context_length=8, width=64, num_layers=1)
    rows = ClipTokenizer(path, tower)(["Hi  the a", "é"])
    start, end = 512 + 3, 512 + 4
    # Printable bytes come first in CLIP's list: "!" is 0, "a" 64; with the end of a word 256 more.
    assert rows[0].tolist() == [start, 512, 514, 256 + 64, end, 0, 0, 0]
    # Two bytes, 0xC3 and 0xA9; CLIP leaves out 0xAD between the two runs of printable ones.
    assert rows[1].tolist()[:4] == [start, 127, 256 + 102, end]
    path.write_bytes(gzip.compress(b"title\nthree words here\n"))
    with pytest.raises(VocabularyError, match="is not CLIP's vocabulary"):
        ClipTokenizer(path, tower)
