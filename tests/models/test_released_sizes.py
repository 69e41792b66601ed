"""InterGen, ReGenNet and InterFormer at the sizes of their releases, beside a second implementation in NumPy.

The reference outputs of the released networks are of reduced width. Here the weights are made from their names, as for
BiGraphDiff (:func:`tests.models.reference_arrays.made_weights`), and what the paper says is computed once more, in
plain NumPy and in double precision. Differences count relative to the largest value.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
import pytest
import torch
from numpy.typing import NDArray
from scipy.special import erf

from models.interformer import InterFormer, InterFormerConfig, joint_distances, target_mask
from models.interformer import from_released as interformer_from_released
from models.intergen import InterGenConfig, InterGenDenoiser
from models.intergen import from_released as intergen_from_released
from models.regennet import ReGenNet, ReGenNetConfig
from models.regennet import from_released as regennet_from_released
from motion.skeleton import SBU15

from .reference_arrays import TOLERANCE, made_weights

pytestmark = pytest.mark.slow

Array = NDArray[np.float64]
Weights = Mapping[str, Array]


def linear(w: Weights, name: str, x: Array) -> Array:
    return x @ w[f"{name}.weight"].T + w[f"{name}.bias"]


def silu(x: Array) -> Array:
    return x / (1 + np.exp(-x))


def gelu(x: Array) -> Array:
    return 0.5 * x * (1 + erf(x / np.sqrt(2)))


def normed(x: Array, eps: float) -> Array:
    return (x - x.mean(-1, keepdims=True)) / np.sqrt(x.var(-1, keepdims=True) + eps)


def sinusoids(places: Array, width: int) -> Array:
    """(…, width): sin on even and cos on odd channels, base 10000."""
    angles = places[..., None] / 10000 ** (np.arange(0, width, 2) / width)
    return np.stack([np.sin(angles), np.cos(angles)], axis=-1).reshape(*places.shape, width)


def attention(
    w: Weights, name: str, query: Array, memory: Array, heads: int, *, zero: bool = False, causal: bool = False
) -> Array:
    """Multi-head attention (B, T, d); ``zero`` adds a key and a value of zeros, as ``add_zero_attn`` does."""
    parts = zip(np.split(w[f"{name}.in_proj_weight"], 3), np.split(w[f"{name}.in_proj_bias"], 3), strict=True)
    q, k, v = (
        (x @ weight.T + bias).reshape(*x.shape[:2], heads, -1).transpose(0, 2, 1, 3)
        for (weight, bias), x in zip(parts, (query, memory, memory), strict=True)
    )
    if zero:
        k, v = (np.concatenate([x, np.zeros_like(x[:, :, :1])], axis=2) for x in (k, v))
    scores = q @ k.swapaxes(-1, -2) / np.sqrt(q.shape[-1])
    if causal:
        scores = np.where(np.tril(np.ones(scores.shape[-2:], dtype=bool)), scores, -np.inf)
    shares = np.exp(scores - scores.max(-1, keepdims=True))
    shares /= shares.sum(-1, keepdims=True)
    mixed = (shares @ v).transpose(0, 2, 1, 3).reshape(query.shape)
    return linear(w, f"{name}.out_proj", mixed)


def time_embedding(w: Weights, t: Array, width: int) -> Array:
    hidden = silu(linear(w, "embed_timestep.time_embed.0", sinusoids(t, width)))
    return linear(w, "embed_timestep.time_embed.2", hidden)


def intergen(w: Weights, x: Array, t: Array, cond: Array, *, layers: int, heads: int) -> Array:
    """InterGen's denoiser (section 4.2): both people from the states of the layer before."""
    width = w["motion_embed.weight"].shape[0]
    places = sinusoids(np.arange(x.shape[1], dtype=float), width)
    people = [linear(w, "motion_embed", person) + places for person in np.split(x, 2, axis=-1)]
    emb = time_embedding(w, t, width) + linear(w, "text_embed", cond)

    def adapted(name: str, h: Array) -> Array:
        scale, shift = np.split(linear(w, f"{name}.emb_layers.1", silu(emb))[:, None], 2, axis=-1)
        return normed(h, 1e-6) * (1 + scale) + shift

    def block(i: int, h: Array, other: Array) -> Array:
        sa, ca, ffn = (f"blocks.{i}.{part}" for part in ("sa_block", "ca_block", "ffn"))
        seen = adapted(f"{sa}.norm", h)
        h = h + attention(w, f"{sa}.attention", seen, seen, heads, zero=True)
        mutual = attention(
            w, f"{ca}.attention", adapted(f"{ca}.norm", h), adapted(f"{ca}.xf_norm", other), heads, zero=True
        )
        h = h + mutual
        return h + linear(w, f"{ffn}.linear2", gelu(linear(w, f"{ffn}.linear1", adapted(f"{ffn}.norm", h))))

    for i in range(layers):
        people = [block(i, people[0], people[1]), block(i, people[1], people[0])]
    return np.concatenate([linear(w, "out.linear", person) for person in people], axis=-1)


def regennet(w: Weights, x: Array, t: Array, actor: Array, *, layers: int, heads: int) -> Array:
    """ReGenNet's causal decoder (section 3.2): post-norm layers over the frames, one token as their memory."""
    frames, rows = x.shape[-1], x.shape[1]

    def flat(motion: Array) -> Array:
        return motion.transpose(0, 3, 1, 2).reshape(len(motion), frames, -1)

    both = [
        linear(w, f"{name}.poseEmbedding", flat(motion))
        for name, motion in (("input_process", x), ("cmo_process", actor))
    ]
    h = linear(w, "fuse_process", np.concatenate(both, axis=-1))
    h = h + sinusoids(np.arange(frames, dtype=float), h.shape[-1])
    memory = time_embedding(w, t, h.shape[-1])[:, None]

    def affine(name: str, z: Array) -> Array:
        return normed(z, 1e-5) * w[f"{name}.weight"] + w[f"{name}.bias"]

    for i in range(layers):
        layer = f"seqTransDecoder.layers.{i}"
        h = affine(f"{layer}.norm1", h + attention(w, f"{layer}.self_attn", h, h, heads, causal=True))
        h = affine(f"{layer}.norm2", h + attention(w, f"{layer}.multihead_attn", h, memory, heads))
        h = affine(f"{layer}.norm3", h + linear(w, f"{layer}.linear2", gelu(linear(w, f"{layer}.linear1", h))))
    made = linear(w, "output_process.poseFinal", h)
    return made.reshape(len(x), frames, rows, 6).transpose(0, 2, 3, 1)


def softmax(scores: Array, axes: tuple[int, ...] = (-1,)) -> Array:
    shares = np.exp(scores - scores.max(axes, keepdims=True))
    return shares / shares.sum(axes, keepdims=True)


class FormerLayer:
    """Parts of a layer of InterFormer (section 3.3): frames (T, 45), all x before all y and z."""

    def __init__(self, w: Weights, name: str) -> None:
        self.w, self.name = w, name
        self.graph = np.eye(15, dtype=bool)
        for parent, child in SBU15.bones:
            self.graph[parent, child] = self.graph[child, parent] = True

    def norm(self, part: str, x: Array) -> Array:
        scaled = (x - x.mean(-1, keepdims=True)) / (x.std(-1, ddof=1, keepdims=True) + 1e-6)
        return scaled * self.w[f"{self.name}.{part}.alpha"] + self.w[f"{self.name}.{part}.bias"]

    def time(self, part: str, query: Array, memory: Array, *, causal: bool = False) -> Array:
        """Three heads over frames; the first frame sees the given pose after it."""
        q, k, v = (
            linear(self.w, f"{self.name}.{part}.{letter}_linear", x).reshape(len(x), 3, 15).swapaxes(0, 1)
            for letter, x in (("q", query), ("k", memory), ("v", memory))
        )
        scores = np.abs(q @ k.swapaxes(-1, -2)) / np.sqrt(15)
        if causal:
            seen = np.tril(np.ones(scores.shape[-2:], dtype=bool))
            seen[0, 1] = True
            scores = np.where(seen, scores, -np.inf)
        return linear(self.w, f"{self.name}.{part}.out", (softmax(scores) @ v).swapaxes(0, 1).reshape(-1, 45))

    def joints(self, part: str, query: Array, memory: Array, distances: Array | None = None) -> Array:
        """A head an axis over the joints of a frame: along the skeleton, or with twice the distances beside."""
        q, k, v = (
            linear(self.w, f"{self.name}.{part}.{letter}_linear_sp", x.reshape(-1, 3, 15).swapaxes(1, 2))
            for letter, x in (("q", query), ("k", memory), ("v", memory))
        )
        scores = np.abs(np.einsum("tjh,tih->thji", q, k))
        if distances is None:
            weights = softmax(np.where(self.graph, scores, -np.inf), (-2, -1))
        else:
            weights = softmax(scores, (-2, -1)) + 2 * distances[:, None]
        seen = np.einsum("thji,tih->tjh", weights, v)
        return linear(self.w, f"{self.name}.{part}.out", seen.reshape(-1, 45))

    def feed(self, x: Array) -> Array:
        hidden = np.maximum(linear(self.w, f"{self.name}.ff.linear_1", x), 0)
        return linear(self.w, f"{self.name}.ff.linear_2", hidden)


def former_places(frames: int) -> Array:
    """(T, 45): sin(pos / 10000^(2i / 45)) at even i, cos(pos / 10000^(2(i + 1) / 45)) beside it."""
    table = np.zeros((frames, 46))
    for i in range(0, 45, 2):
        table[:, i] = np.sin(np.arange(frames) / 10000 ** (2 * i / 45))
        table[:, i + 1] = np.cos(np.arange(frames) / 10000 ** (2 * (i + 1) / 45))
    return table[:, :45]


def former_distances(source: Array, target: Array) -> Array:
    """(T, 15, 15): a softmax of −‖target joint − source joint‖ over the whole table."""
    a, b = (x.reshape(-1, 3, 15).swapaxes(1, 2) for x in (target, source))
    return softmax(-np.linalg.norm(a[:, :, None] - b[:, None], axis=-1), (-2, -1))


def interformer(w: Weights, source: Array, target: Array, *, layers: int) -> Array:
    """InterFormer's next frame at every frame (T, 45) of the target."""
    x = source * np.sqrt(45) + former_places(len(source))
    for i in range(layers):
        layer = FormerLayer(w, f"encoder.layers.{i}")
        y = layer.norm("norm_1", x)
        time, space = x + layer.time("attn", y, y), x + layer.joints("attn_space", y, y)
        x = time + space + layer.feed(layer.norm("norm_2", time) + layer.norm("norm_space_1", space))
    memory = FormerLayer(w, "encoder").norm("norm", x)
    near, distances = memory[: len(target)], former_distances(source[: len(target)], target)
    x = target * np.sqrt(45) + former_places(len(target))
    for i in range(layers):
        layer = FormerLayer(w, f"decoder.layers.{i}")
        y = layer.norm("norm_1", x)
        time = layer.norm("norm_2", x + layer.time("attn_1", y, y, causal=True))
        time = layer.norm("norm_3", time + layer.time("attn_2", time, memory))
        space = layer.norm("norm_space_1", x + layer.joints("attn_space_1", y, y))
        space = layer.norm("norm_space_2", space + layer.joints("attn_space_2", space, near, distances))
        x = time + space + layer.feed(time + space)
    return linear(w, "out", FormerLayer(w, "decoder").norm("norm", x))


def weights_of(network: torch.nn.Module, seed: int) -> dict[str, torch.Tensor]:
    """Weights made from the names and shapes of a network that has none."""
    return made_weights({name: tuple(value.shape) for name, value in network.state_dict().items()}, seed)


def check(found: torch.Tensor, wanted: Array) -> None:
    scale = np.abs(wanted).max()
    assert scale > 0.01
    np.testing.assert_allclose(found.numpy() / scale, wanted / scale, rtol=0, atol=TOLERANCE)


def as_arrays(weights: Mapping[str, torch.Tensor]) -> Weights:
    return {name: value.numpy().astype(np.float64) for name, value in weights.items()}


def compared(
    made: torch.nn.Module,
    load: Callable[..., torch.nn.Module],
    second: Callable[..., Array],
    inputs: list[Array],
    layers: int,
    heads: int,
) -> None:
    """The network that loads the made weights against the second implementation."""
    weights = weights_of(made, 5)
    network = load(weights, num_heads=heads).requires_grad_(False)
    tensors = [torch.from_numpy(value).float() for value in inputs]
    tensors[1] = tensors[1].long()
    wanted = second(as_arrays(weights), inputs[0], inputs[1].astype(float), inputs[2], layers=layers, heads=heads)
    check(network(*tensors), wanted)


def test_intergen_at_its_released_size() -> None:
    rng = np.random.default_rng(0)
    config = InterGenConfig(latent_dim=1024, ff_size=2048, num_layers=8, num_heads=8)
    with torch.device("meta"):
        made = InterGenDenoiser(config)
    assert sum(p.numel() for p in made.parameters()) > 1.5e8
    inputs = [rng.normal(size=(1, 6, 524)), np.array([437]), rng.normal(size=(1, 768))]
    compared(made, intergen_from_released, intergen, inputs, 8, 8)


def test_regennet_at_its_released_size() -> None:
    rng = np.random.default_rng(1)
    config = ReGenNetConfig(rows=56, latent_dim=512, ff_size=1024, num_layers=8, num_heads=4, online=True)
    with torch.device("meta"):
        made = ReGenNet(config)
    shape = (2, 56, 6, 9)
    inputs = [rng.normal(size=shape), np.array([3, 901]), rng.normal(size=shape)]
    compared(made, regennet_from_released, regennet, inputs, 8, 4)


def test_interformer_at_its_released_size() -> None:
    rng = np.random.default_rng(2)
    weights = weights_of(InterFormer(InterFormerConfig(max_length=16)), 5)
    for name, value in weights.items():
        if name.endswith("pe.pe"):
            weights[name] = torch.from_numpy(former_places(16)).float()[None]
        elif "_sp." in name:  # three numbers wide: larger, so that joints differ in what they see
            weights[name] = 20 * value
        elif name.endswith("alpha"):
            weights[name] = value + 1
    network = interformer_from_released(weights, num_heads=3).requires_grad_(False)
    assert network.config.num_layers == 6 and network.config.ff_size == 2048
    source, target = rng.normal(size=(12, 45)), rng.normal(size=(10, 45))
    wanted = interformer(as_arrays(weights), source, target, layers=6)
    given = [torch.from_numpy(value).float()[None] for value in (source, target)]
    table = joint_distances(given[0][:, :10], given[1])
    check(network(*given, table, torch.ones(1, 1, 12, dtype=torch.bool), target_mask(10))[0], wanted)
