"""BiGraphDiff: every part against the released code's numbers, and the network that they make."""

from __future__ import annotations

import pytest
import torch

from models.bigraphdiff import BiGraphDiff, from_released
from models.bigraphdiff import network as bigraphdiff
from models.errors import WeightsError
from tests.models.reference_arrays import Reference, assert_equal


@pytest.fixture(scope="module")
def ref() -> Reference:
    return Reference("bigraphdiff_parts")


def check(ref: Reference, part: str, module: torch.nn.Module, *inputs: str) -> None:
    module.load_state_dict(ref.weights(f"{part}/"))
    found = module.eval()(*(ref[f"{part}/{name}"] for name in inputs))
    assert_equal(found.detach(), ref[f"{part}/y"])


def test_self_attention_equals_the_reference(ref):
    check(ref, "self_attention", bigraphdiff.SelfAttention(64, 64, 4, 96), "x", "emb", "mask")


def test_cross_attention_equals_the_reference(ref):
    check(ref, "cross_attention", bigraphdiff.CrossAttention(64, 48, 4, 96), "x", "text", "emb")


def test_feed_forward_equals_the_reference(ref):
    check(ref, "feed_forward", bigraphdiff.FeedForward(64, 128, 96), "x", "emb")


def test_bipartite_graph_equals_the_reference(ref):
    check(ref, "bipartite_graph", bigraphdiff.BipartiteGraph(32, 16), "x")


def test_timestep_embedding_equals_the_reference(ref):
    found = bigraphdiff.timestep_embedding(ref["timestep_embedding/t"], 32)
    assert_equal(found, ref["timestep_embedding/y"])


@pytest.fixture(scope="module")
def whole() -> tuple[Reference, BiGraphDiff]:
    """The reference of the whole network, and the network of the released file's names."""
    ref = Reference("bigraphdiff_whole")
    weights = ref.made_weights()
    weights |= {"clip.ln_final.weight": torch.ones(512), "clip.visual.proj": torch.ones(2, 2)}
    return ref, from_released(weights, num_heads=int(ref["num_heads"])).requires_grad_(False)


def test_the_whole_network_equals_the_reference(whole):
    ref, network = whole
    mask = torch.arange(ref["x"].shape[1]) < ref["lengths"][:, None]
    found = network(ref["x"], ref["t"], ref["text"], ref["text_vector"], mask)
    assert found.shape == ref["output"].shape
    assert (found - ref["output"]).abs().max() < 1e-4 * ref["output"].abs().max()


def test_the_text_side_reads_the_end_of_text(whole):
    """Against the equations of a transformer's encoder layer, written out."""
    side = whole[1].text_side
    features = torch.randn(2, 7, 512, generator=torch.Generator().manual_seed(0))
    text, vector = side(features, torch.tensor([6, 3]))
    x = side.text_pre_proj(features)
    for layer in side.textTransEncoder.layers:
        attention = layer.self_attn
        q, k, v = (
            part.unflatten(-1, (4, -1)).transpose(1, 2)
            for part in (x @ attention.in_proj_weight.T + attention.in_proj_bias).chunk(3, -1)
        )
        seen = ((q @ k.mT) / q.shape[-1] ** 0.5).softmax(-1) @ v
        x = layer.norm1(x + attention.out_proj(seen.transpose(1, 2).flatten(2)))
        x = layer.norm2(x + layer.linear2(torch.nn.functional.gelu(layer.linear1(x))))
    x = side.text_ln(x)
    assert_equal(text, x)
    assert_equal(vector, torch.stack([x[0, 6], x[1, 3]]))


def test_other_weights_are_refused():
    with pytest.raises(WeightsError, match="not BiGraphDiff weights"):
        from_released({"a": torch.zeros(1)}, num_heads=4)
