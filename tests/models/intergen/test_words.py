"""The grown denoiser: its new parts begin at nothing, and each sentence is heard where it should be."""

import pytest
import torch
from torch import Tensor

from models.diffusion import DRAFTED
from models.intergen.compact import CompactConfig, CompactInterGen
from models.known import KNOWN_FEATURES
from models.motion_tokens import FEATURES
from models.text import TokenFeatures

SIZES = {"latent_dim": 32, "ff_size": 48, "num_layers": 2, "num_heads": 4, "cond_dim": 64}
TOKENS = 6


def stirred(model: CompactInterGen) -> CompactInterGen:
    """The network as training leaves it: nothing in it is zero any more."""
    generator = torch.Generator().manual_seed(0)
    with torch.no_grad():
        for parameter in model.parameters():
            parameter += 0.1 * torch.randn(parameter.shape, generator=generator)
    return model.eval().requires_grad_(False)


def words(*lengths: int, seed: int = 0) -> TokenFeatures:
    """Features of as many sentences, each of so many tokens."""
    mask = torch.arange(max(1, *lengths)) < torch.tensor(lengths)[:, None]
    return TokenFeatures(torch.randn(*mask.shape, 384, generator=torch.Generator().manual_seed(0)), mask)


def inputs(batch: int = 2) -> tuple[Tensor, Tensor]:
    torch.manual_seed(1)
    return torch.randn(batch, TOKENS, 280), torch.tensor([0, 700, 999][:batch])


@pytest.fixture
def untrained() -> CompactInterGen:
    torch.manual_seed(5)
    return CompactInterGen(CompactConfig(**SIZES)).eval().requires_grad_(False)


@pytest.fixture
def model(untrained: CompactInterGen) -> CompactInterGen:
    return stirred(untrained)


def test_the_parts_that_read_begin_at_nothing(untrained):
    """However the other weights are, sentences of each, what is known and drafts count nothing at the start."""
    with torch.no_grad():
        torch.nn.init.normal_(untrained.denoiser.out.linear.weight)
    x, t = inputs()
    both, a, b = words(5, 3), words(4, 2, seed=1), words(0, 6, seed=2)
    known, draft = torch.randn(2, 2, TOKENS, 4 * KNOWN_FEATURES)
    plain = untrained.denoiser(x, t, untrained.condition(both))
    assert plain.abs().max() > 0.1
    read = untrained.denoiser(x, t, untrained.condition(both, a, b), None, untrained.shown(known, draft))
    assert torch.equal(read, plain)


def test_each_sentence_changes_the_prediction(model):
    x, t = inputs()
    both, a, b = words(5, 3), words(4, 2, seed=1), words(3, 6, seed=2)
    conditions = [model.condition(both), model.condition(both, a), model.condition(both, a, b)]
    conditions.append(model.condition(words(0, 0), a, b))
    found = [model.denoiser(x, t, condition) for condition in conditions]
    for i in range(4):
        for j in range(i):
            assert (found[i] - found[j]).abs().max() > 1e-3


def test_word_order_is_heard_beyond_the_vector(model):
    """The attention sees the rows of the words, and not their vector alone."""
    x, t = inputs()
    condition = model.condition(words(5, 3))
    same_vector = condition.clone()
    same_vector[:, 0, 2] *= -1
    assert (model.denoiser(x, t, condition) - model.denoiser(x, t, same_vector)).abs().max() > 1e-4


def test_training_packs_the_text_and_hears_the_same(model):
    x, t = inputs()
    condition = model.condition(words(5, 3), words(0, 2, seed=1), words(3, 0, seed=2))
    expected = model.denoiser(x, t, condition)
    model.denoiser.train()
    text, real = model.denoiser.text_of_each(condition)
    assert text.shape[1] == 6 + 4 < condition.shape[1] * condition.shape[2]
    assert real.sum(1).tolist() == [6 + 4, 4 + 3] * 2
    assert torch.allclose(model.denoiser(x, t, condition), expected, atol=1e-3)
    assert torch.isfinite(model.denoiser(x, t, 0 * condition)).all()


def test_own_and_other_sentence_swap_with_the_people(model):
    with torch.no_grad():
        model.denoiser.role_embedding.zero_()
        model.denoiser.role_text.weight.zero_()
    x, t = inputs()
    both, a, b = words(5, 3), words(4, 2, seed=1), words(3, 6, seed=2)
    found = model.denoiser(x, t, model.condition(both, a, b))
    swapped = model.denoiser(x.roll(140, -1), t, model.condition(both, b, a))
    assert torch.allclose(swapped, found.roll(140, -1), atol=1e-3)
    assert not torch.allclose(model.denoiser(x, t, model.condition(both, b, a)), found, atol=0.05)


def test_what_is_known_is_seen(model):
    x, t = inputs()
    condition = model.condition(words(5, 3))
    known = torch.zeros(1, TOKENS, 8 * KNOWN_FEATURES)
    plain = model.denoiser(x, t, condition)
    assert torch.equal(model.denoiser(x, t, condition, None, known.expand(2, -1, -1)), plain)
    known[:, 2, 80] = 1
    seen = model.denoiser.guided(x, t, condition, known, scale=1.0)
    assert (seen - plain).abs().max() > 1e-4
    halves = [model.denoiser(x, t, c, None, known.expand(2, -1, -1)) for c in (condition, 0 * condition)]
    assert torch.allclose(
        model.denoiser.guided(x, t, condition, known, scale=2.5), 2.5 * halves[0] - 1.5 * halves[1], atol=1e-4
    )


def test_a_draft_is_read_beside_what_is_known(model):
    x, t = inputs()
    condition = model.condition(words(5, 3))
    known, draft = torch.randn(2, 2, TOKENS, 4 * KNOWN_FEATURES)
    known[:, 3:] = draft[:, :3] = 0

    def made(*seen: Tensor | None) -> Tensor:
        return model.denoiser(x, t, condition, None, model.shown(*seen))

    assert torch.equal(made(known, None), made(known, 0 * draft))
    assert torch.equal(made(None, draft), made(0 * known, draft))
    assert (made(known, draft) - made(known, None)).abs().max() > 1e-3
    assert (made(known, draft) - made(draft, known)).abs().max() > 1e-3, "a draft is not what is known"


def test_what_a_draft_says_is_guided_less(model):
    x, t = inputs()
    said = torch.zeros(2, TOKENS, 2, 2, KNOWN_FEATURES)  # people, knots of a token
    said[:, 2:4, 1, 0, FEATURES : FEATURES + 9] = 1.0
    seen = model.shown(None, said.flatten(2))
    condition = model.condition(words(5, 3))
    made = [model.denoiser(x, t, said, None, seen) for said in (condition, torch.zeros_like(condition))]
    guided = model.denoiser.guided(x, t, condition, seen, scale=4.0)
    beyond, slope = (part.view(2, TOKENS, 2, 2, FEATURES) for part in (guided - made[0], 3.0 * (made[0] - made[1])))
    drafted = torch.zeros_like(beyond)
    drafted[:, 2:4, 1, 0, :9] = 1.0
    torch.testing.assert_close(beyond, slope * (1 - (1 - DRAFTED) * drafted))
