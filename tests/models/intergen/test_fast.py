"""The fast mode leaves the network as it is, and begins as one of its unguided passes."""

import torch

from models.intergen.compact import CompactConfig, CompactInterGen, load_folder
from models.weights_io import save_network
from tests.models.intergen.test_words import SIZES, inputs, stirred, words


def make(rank: int = 4) -> CompactInterGen:
    torch.manual_seed(0)
    model = CompactInterGen(CompactConfig(**SIZES, words=True, fast_rank=rank))
    change = {k: v.clone() for k, v in model.fast.state_dict().items()}
    stirred(model)
    model.fast.load_state_dict(change)
    return model


def test_an_unfitted_change_changes_nothing_but_the_guidance():
    model = make()
    x, t = inputs()
    condition = model.condition(words(5, 3), words(2, 4, seed=1), words(0, 3, seed=2))
    fast = model.fast_denoiser
    assert fast is model.fast_denoiser
    for scale in (1.0, 4.3):
        assert torch.equal(fast.guided(x, t, condition, scale=scale), model.denoiser(x, t, condition))


def test_a_fitted_change_hears_the_scale_and_leaves_the_network_alone():
    model = make()
    x, t = inputs()
    condition = model.condition(words(5, 3))
    before = model.denoiser(x, t, condition)
    stirred(model.fast)
    fast = model.fast_denoiser
    found = [fast.guided(x, t, condition, scale=scale) for scale in (1.0, 4.3)]
    assert (found[0] - found[1]).abs().max() > 1e-3
    assert (found[0] - before).abs().max() > 1e-3
    assert torch.equal(model.denoiser(x, t, condition), before)
    name = "blocks.1.ffn.linear1.weight"
    up, down = (part["1-ffn-linear1-weight"] for part in (model.fast.up, model.fast.down))
    expected = model.denoiser.get_parameter(name) + up @ down
    assert torch.equal(fast.get_parameter(name), expected)


def test_a_folder_keeps_the_fast_mode_and_one_without_has_none(tmp_path):
    model = make()
    stirred(model.fast)
    save_network(tmp_path / "fast", model)
    again, _ = load_folder(tmp_path / "fast")
    x, t = inputs()
    expected = model.fast_denoiser.guided(x, t, model.condition(words(5, 3)), scale=3.0)
    found = again.fast_denoiser.guided(x, t, again.condition(words(5, 3)), scale=3.0)
    assert torch.allclose(found, expected, atol=0.05)  # stored in float16
    assert not any(name.startswith("fast_denoiser") for name in again.state_dict())
    save_network(tmp_path / "plain", stirred(CompactInterGen(CompactConfig(**SIZES, words=True))))
    assert load_folder(tmp_path / "plain")[0].fast_denoiser is None


def test_with_the_fast_mode_the_weights_stay_below_40_megabytes():
    with torch.device("meta"):
        model = CompactInterGen(CompactConfig(role_text=True, words=True, fast_rank=8))
    megabytes = 2 * sum(value.numel() for value in model.state_dict().values()) / 1e6
    assert 36 < megabytes < 37.6  # the bank of captions takes 2.2 more
