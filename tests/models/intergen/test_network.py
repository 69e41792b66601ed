"""InterGen's denoiser against the released network's numbers, and what the two-as-one batch must keep."""

from __future__ import annotations

import pytest
import torch

from models.diffusion import make_scheduler, sample_steps
from models.errors import WeightsError
from models.intergen import InterGenConfig, InterGenDenoiser, from_released
from models.intergen.network import attend
from models.released import read_tensors
from tests.models.reference_arrays import Reference, assert_equal

SMALL = InterGenConfig(input_features=9, latent_dim=16, ff_size=24, num_layers=2, num_heads=2, cond_dim=5)


@pytest.fixture(scope="module")
def ref() -> Reference:
    return Reference("intergen_small")


@pytest.fixture(scope="module")
def network(ref: Reference) -> InterGenDenoiser:
    return from_released(ref.weights(), num_heads=int(ref["config"][4])).requires_grad_(False)


def random_network() -> InterGenDenoiser:
    """A network none of whose weights is zero, unlike a freshly initialised one."""
    torch.manual_seed(0)
    network = InterGenDenoiser(SMALL).eval()
    for parameter in network.parameters():
        torch.nn.init.normal_(parameter, std=0.3)
    return network


def test_sizes_are_read_off_the_shapes(ref, network):
    features, d, ff, layers, heads = ref["config"].tolist()
    assert network.config == InterGenConfig(features, d, ff, layers, heads, 768)
    assert not network.training


def test_forward_equals_the_reference(ref, network):
    assert_equal(network(ref["x"], ref["t"], ref["cond"]), ref["forward"])


def test_masked_forward_equals_the_reference(ref, network):
    assert_equal(network(ref["x"], ref["t"], ref["cond"], ref["mask"]), ref["forward_masked"])


def test_guided_equals_the_reference(ref, network):
    found = network.guided(ref["x"], ref["t"], ref["cond"], scale=float(ref["cfg_weight"]))
    assert_equal(found, ref["cfg"])


@pytest.mark.parametrize("steps", [50, 5])
def test_ddim_equals_the_reference(ref, network, steps):
    cond, scale = ref["cond"][:1], float(ref["cfg_weight"])
    scheduler = make_scheduler("ddim", steps)
    assert scheduler.timesteps.flip(0).tolist() == ref[f"ddim{steps}_timesteps"].tolist()
    *_, last = sample_steps(lambda x, t: network.guided(x, t, cond, scale=scale), ref[f"ddim{steps}_noise"], scheduler)
    assert_equal(last.sample, ref[f"ddim{steps}_sample"])


def test_attention_equals_torch_multihead_attention_with_zero_attention():
    attention = random_network().blocks[0].sa_block.attention
    plain = torch.nn.MultiheadAttention(16, 2, add_zero_attn=True, batch_first=True)
    plain.load_state_dict(attention.state_dict())
    query, source = torch.randn(4, 5, 16), torch.randn(4, 6, 16)
    keep = torch.tensor([[1, 1, 1, 1, 1, 1], [1, 1, 0, 0, 0, 0], [0, 1, 0, 1, 0, 1], [0] * 6]).bool()
    expected, _ = plain(query, source, source, key_padding_mask=~keep)
    assert_equal(attention(query, source, keep), expected, 1e-5)


def test_attention_is_in_float32_under_autocast():
    """In bfloat16, which has 8 bits, the two would be a thousand times farther apart."""
    draw = torch.Generator().manual_seed(0)
    q, k, v = (torch.randn(2, 5, 8, generator=draw) for _ in range(3))
    with torch.autocast("cpu", dtype=torch.bfloat16):
        found = attend(q, k, v, None, num_heads=2)
    assert found.dtype == torch.float32
    torch.testing.assert_close(found, attend(q, k, v, None, num_heads=2), atol=1e-6, rtol=0)


def test_wrong_weights_are_named(ref):
    weights = ref.weights()
    with pytest.raises(WeightsError, match=r"motion_embed\.weight is missing"):
        from_released({}, num_heads=4)
    with pytest.raises(WeightsError, match="extra is unknown"):
        from_released({**weights, "extra": torch.zeros(1)}, num_heads=4)
    with pytest.raises(WeightsError, match=r"out\.linear\.bias is \(3,\), and \(262,\) was expected"):
        from_released({**weights, "out.linear.bias": torch.zeros(3)}, num_heads=4)


class Sneaky:
    """Writes a file when it is unpickled."""

    def __init__(self, path):
        self.path = path

    def __reduce__(self):
        return (open, (str(self.path), "w"))


def test_bad_checkpoints_are_refused(tmp_path):
    with pytest.raises(WeightsError, match="There is no file"):
        read_tensors(tmp_path / "absent.ckpt", network="InterGen")
    (tmp_path / "text.ckpt").write_text("hello")
    with pytest.raises(WeightsError, match="cannot be read"):
        read_tensors(tmp_path / "text.ckpt", network="InterGen")
    torch.save({"state_dict": Sneaky(tmp_path / "written")}, tmp_path / "sneaky.ckpt")
    with pytest.raises(WeightsError, match="cannot be read"):
        read_tensors(tmp_path / "sneaky.ckpt", network="InterGen")
    assert not (tmp_path / "written").exists()
