"""A network that OpenVINO runs gives what it gave before, from its cache, too, and is left alone where that fails."""

import copy
import sys
from concurrent.futures import ThreadPoolExecutor
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest
import torch
from torch import Tensor, nn

from models import compiled
from models.bigraphdiff.compact import CompactBiGraphDiff, CompactBiGraphDiffConfig
from models.compiled import compile_network, has_bfloat16
from models.intergen import InterGenConfig, InterGenDenoiser
from models.intergen.words import WordDenoiser

SIZES: dict[str, Any] = {
    "input_features": 10,
    "latent_dim": 32,
    "ff_size": 64,
    "num_layers": 1,
    "num_heads": 2,
    "cond_dim": 16,
}


def bigraphdiff() -> nn.Module:
    sizes = CompactBiGraphDiffConfig(
        labels=("wave",), latent_dim=32, ff_size=16, num_layers=1, num_heads=2, embed_dim=24, cond_dim=16, max_tokens=20
    )
    return CompactBiGraphDiff(sizes).denoiser


NETWORKS = {
    "intergen": lambda: InterGenDenoiser(InterGenConfig(**SIZES)),
    "words": lambda: WordDenoiser(InterGenConfig(**SIZES), 7),
    "bigraphdiff": bigraphdiff,
}


def network(name: str = "intergen", seed: int = 0) -> Any:
    """An untrained network with weights that are all at work."""
    torch.manual_seed(seed)
    made = NETWORKS[name]().eval().requires_grad_(False)
    for parameter in made.parameters():
        nn.init.normal_(parameter, std=0.15)
    return made


def inputs(made: Any, batch: int, tokens: int) -> list[Tensor]:
    """Arguments of ``forward`` of other extents than the example's."""
    grown = []
    extents = {0: batch, 1: tokens, 2: 5}
    for value, axes in zip(made.example(), made.varying.values(), strict=True):
        shape = [extents[i] if i in axes else n for i, n in enumerate(value.shape)]
        if value.dtype == torch.bool:
            grown.append(torch.rand(shape) < 0.8)
        elif value.dtype == torch.int64:
            grown.append(torch.randint(0, 1000, shape))
        else:
            grown.append(torch.randn(shape))
    grown[3][:, 0] = True  # a person has at least one token
    return grown


@pytest.mark.parametrize("name", NETWORKS)
def test_the_numbers_are_the_same_at_other_lengths_and_from_the_cache(name: str, tmp_path: Path) -> None:
    plain = network(name)
    for _ in range(2):  # translated, then from the cache
        made = copy.deepcopy(plain)
        assert compile_network(made, "weights", tmp_path)
        for batch, tokens in ((1, 5), (3, 17)):
            given = inputs(plain, batch, tokens)
            real = given[3].all(-1)
            torch.testing.assert_close(made(*given)[real], plain(*given)[real], atol=1e-5, rtol=1e-5)
            short = [value for value, key in zip(given, made.varying, strict=True) if key in ("x", "t", "cond")]
            torch.testing.assert_close(made.guided(*short, scale=2.0), plain.guided(*short, scale=2.0))
    assert len(list(tmp_path.iterdir())) == 1


def test_the_second_start_translates_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert compile_network(network(), "weights", tmp_path)
    monkeypatch.setattr(compiled, "_translate", lambda *_: pytest.fail("translated again"))
    assert compile_network(network(), "weights", tmp_path)


@pytest.mark.parametrize("damage", ["cut", "empty", "other weights"])
def test_a_cache_that_is_of_no_use_is_made_anew(damage: str, tmp_path: Path) -> None:
    before = network(seed=1 if damage == "other weights" else 0)
    assert compile_network(before, "weights", tmp_path)
    (folder,) = tmp_path.iterdir()
    if damage != "other weights":
        file = folder / compiled.FILE
        whole = file.read_bytes()
        file.write_bytes(whole[: len(whole) // 2] if damage == "cut" else b"")
    made, plain = network(), network()
    assert compile_network(made, "weights", tmp_path)
    given = inputs(plain, 2, 9)
    real = given[3].all(-1)
    torch.testing.assert_close(made(*given)[real], plain(*given)[real], atol=1e-5, rtol=1e-5)


def test_without_openvino_the_network_stays_plain(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "openvino", None)
    made, plain = network(), network()
    assert not compile_network(made, "weights", tmp_path)
    given = plain.example()
    assert torch.equal(made(*given), plain(*given)) and not list(tmp_path.iterdir())


def test_a_translation_that_is_off_is_not_used(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    translate, wrong = compiled._translate, network(seed=1)
    monkeypatch.setattr(compiled, "_translate", lambda openvino, _: translate(openvino, wrong))
    made, plain = network(), network()
    assert not compile_network(made, "weights", tmp_path)
    given = plain.example()
    assert torch.equal(made(*given), plain(*given))


def test_threads_share_a_network(tmp_path: Path) -> None:
    made = network()
    assert compile_network(made, "weights", tmp_path)
    questions = [inputs(made, 2, 5 + i) for i in range(4)]
    expected = [made(*question) for question in questions]

    def same(i: int) -> bool:
        return all(torch.equal(made(*questions[i]), expected[i]) for _ in range(20))

    with ThreadPoolExecutor(4) as threads:
        assert all(threads.map(same, range(4)))


def test_coarser_numbers_stay_near(tmp_path: Path) -> None:
    if not compiled.has_bfloat16():
        pytest.skip("This processor has no bfloat16, and OpenVINO computes in float32.")
    plain, coarse = network(), network()
    if not compile_network(coarse, "coarse", tmp_path, precision="bf16"):
        assert find_spec("openvino") is None
        pytest.skip("OpenVINO is not installed.")
    given = inputs(plain, 2, 9)
    expected = plain(*given)
    off = (coarse(*given) - expected).abs().max() / expected.abs().max()
    assert off < 5e-2
    assert (off > 1e-5) == has_bfloat16(), "coarse numbers cannot be exact where they are at work"
