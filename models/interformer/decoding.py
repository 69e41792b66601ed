"""The compact InterFormer's reaction, a frame at a time, at the cost of one frame's arithmetic.

:meth:`CompactInterFormer.decode` reads all frames of the reactor; run anew for every frame, as eq. 3.4 to 3.6
of Chopin's thesis read, the cost of a frame grows with the motion. :class:`ReactionDecoder` makes the same
numbers with what does not change kept: keys and values of the past frames and of the actor, and whatever the
actor alone decides. One frame of one person is so little arithmetic that calling PyTorch for each operation
would take most of the time, so a frame is NumPy on weights that are folded once:

- queries, keys and values over time and over joints are one product, and so are the two branches' ways out;
- what a layer norm scales and shifts is in the product that follows it. All that is added to the stream has
  mean zero, which no norm after it can tell, so a norm is a division;
- what the network reads of the reactor's poses, and the linear part's guess, are affine in the last two
  poses: one product and a table of the rest for each frame.

Shapes: B reactions, T frames, J = 15 joints, D numbers a frame.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import cast

import numpy as np
import torch
from numpy.typing import NDArray
from scipy.special import erf
from torch import Tensor, nn

from models.interformer import JOINTS
from models.interformer.compact import (
    LARGEST,
    CompactInterFormer,
    DecoderLayer,
    SpatialAttention,
    TemporalAttention,
    frames_around,
    linear_input,
)

Array = NDArray[np.float32]
Exact = NDArray[np.float64]


@dataclass(frozen=True)
class Affine:
    """x @ weight + bias: (B, in) → (B, out)."""

    weight: Array
    bias: Array

    def __call__(self, x: Array) -> Array:
        """x (B, in) → (B, out)."""
        made = x @ self.weight
        made += self.bias
        return made


@dataclass(frozen=True)
class FoldedLayer:
    """A decoder layer's products, each with the norm before it and the centring after it folded in.

    self_in makes, of D numbers, the queries, keys and values over time, then those over joints: 6 D.
    other_in makes the two queries to the actor: 2 D. self_out and other_out take both branches: 2 D to D.
    """

    self_in: Affine
    self_out: Affine
    other_in: Affine
    other_out: Affine
    ff_in: Affine
    ff_out: Affine


class ReactionDecoder:
    """A network's weights, folded to decode frame after frame.

    Args:
        model: in eval mode; later changes of its weights are not seen.
    """

    def __init__(self, model: CompactInterFormer) -> None:
        config = model.config
        self.model = model
        self.heads, self.spatial_heads = config.heads, config.spatial_heads
        self.layers = [_folded(cast(DecoderLayer, layer)) for layer in model.decoder]
        self.mean = np.full((config.width, 1), 1 / config.width, dtype=np.float32)
        self.eps = np.float32(model.out_norm.eps)
        self.graph = model.graph.numpy().astype(np.float32)
        self.reach = np.float32(model.reach.item())
        metres = _exact(model.step_std).ravel()
        out = _dense(model.out)
        self.out = _affine(_after_norm(model.out_norm, (out[0] * metres, out[1] * metres)))
        # What is read is affine in the last two poses: its answer to each of their 90 numbers.
        with torch.inference_mode():
            units = torch.eye(6 * JOINTS).view(-1, 1, 2, JOINTS, 3)
            units = torch.cat([torch.zeros_like(units[:1]), units])
            nobody = torch.zeros(len(units), 1, JOINTS, 3)
            nothing = nobody.new_zeros(len(units), 1, config.width)
            around = torch.zeros_like(frames_around(nobody))
            read = self._read(units[:, :, 0], units[:, :, 1], nobody[:, 0], nobody, nothing, around)
        self.poses = (read[1:, 0] - read[0, 0]).astype(np.float32)

    def _read(
        self, pose: Tensor, previous: Tensor, first: Tensor, actor: Tensor, encoded: Tensor, around: Tensor
    ) -> Exact:
        """(B, T, D + 3 J) the decoder's input, centred, and the next pose as the linear part guesses it.

        Shapes as in :meth:`CompactInterFormer.embed`; first (B, J, 3).
        """
        model = self.model
        x = _exact(model.embed(pose, previous, actor, encoded, 0))
        steps = model.linear(linear_input(pose, previous, first, actor, around))
        guess = _exact(pose.flatten(2)) + _exact(steps) * _exact(model.step_std).ravel()
        return np.concatenate([x - x.mean(-1, keepdims=True), guess], axis=-1)

    def poses_after(self, actor: Tensor, first: Tensor, noise: Tensor, mask: Tensor | None = None) -> Iterator[Array]:
        """The poses (B, J, 3) after the first one, T − 1 of them, each as soon as it is made.

        Args:
            actor: (B, T, J, 3) metres, T ≤ window.
            first: (B, J, 3) metres.
            noise: (B, noise).
            mask: (B, T) bool, false at padding.
        """
        size, length = actor.shape[:2]
        width = self.model.config.width
        rest, memories = self._prepared(actor, first, noise, mask)
        others = np.moveaxis(actor[:, 1:].numpy(), -1, 0)[:, :, :, None]  # (3, B, T − 1, 1, J)
        kept = np.empty((len(self.layers), 2, size, self.heads, length, width // self.heads), np.float32)
        pose = previous = first.flatten(1).numpy().astype(np.float32)
        for i in range(length - 1):
            read = np.concatenate([pose, previous], axis=1) @ self.poses
            read += rest[:, i]
            x = read[:, :width]
            near = self._near(pose, others[:, :, i])
            for layer, past, memory in zip(self.layers, kept, memories, strict=True):
                x = x + layer.self_out(self._among_themselves(layer.self_in(self._norm(x)), past, i))
                x += layer.other_out(self._to_the_other(layer.other_in(self._norm(x)), memory, near, i))
                h = layer.ff_in(self._norm(x))
                x += layer.ff_out(h * (1 + erf(h)))
            pose, previous = read[:, width:] + self.out(self._norm(x)), pose
            yield pose.reshape(size, JOINTS, 3)

    @torch.inference_mode()
    def _prepared(
        self, actor: Tensor, first: Tensor, noise: Tensor, mask: Tensor | None
    ) -> tuple[Array, list[_Memory]]:
        """The part that depends only on actor and first pose: :meth:`_read` of two poses of zeros, and the memories."""
        whole = torch.ones(actor.shape[:2], dtype=torch.bool)
        encoded = self.model.encode(actor, noise, whole if mask is None else mask)
        nobody, around = torch.zeros_like(actor[:, 1:]), frames_around(actor)[:, 1:]
        rest = self._read(nobody, nobody, first, actor[:, 1:], encoded[:, 1:], around).astype(np.float32)
        padding = None if mask is None else np.where(mask.numpy(), 0, -np.inf).astype(np.float32)
        layers = cast(list[DecoderLayer], self.model.decoder)
        return rest, [_Memory(layer, encoded, padding) for layer in layers]

    def react(self, actor: Tensor, first: Tensor, noise: Tensor, mask: Tensor | None = None) -> Tensor:
        """The reaction (B, T, J, 3) to a window of the actor; arguments as in :meth:`poses_after`."""
        made = [first.float(), *(torch.from_numpy(p) for p in self.poses_after(actor, first, noise, mask))]
        return torch.stack(made, dim=1)

    def _norm(self, x: Array) -> Array:
        """A layer norm of numbers whose mean is zero, without scale and shift."""
        return cast(Array, x / np.sqrt((x * x) @ self.mean + self.eps))

    def _near(self, pose: Array, others: Array) -> Array:
        """(B, 1, J, J) :meth:`CompactInterFormer.distances` of poses (B, 3 J) and (3, B, 1, J)."""
        own = pose.reshape(-1, JOINTS, 3).transpose(2, 0, 1)[..., None]
        apart = own - others
        apart *= apart
        near = np.exp(-np.sqrt(apart[0] + apart[1] + apart[2]))
        near *= self.reach / near.sum((1, 2), keepdims=True)
        return near[:, None]

    def _among_themselves(self, products: Array, past: Array, i: int) -> Array:
        """(B, 6 D) → (B, 2 D): attention over the reactor's frames so far, and over this one's joints."""
        size, width = len(products), products.shape[1] // 6
        seen = np.empty((size, 2 * width), np.float32)
        query, key, value = products[:, : 3 * width].reshape(size, 3, self.heads, 1, -1).swapaxes(0, 1)
        past[0, :, :, i], past[1, :, :, i] = key[:, :, 0], value[:, :, 0]
        keys, values = past[:, :, :, : i + 1]
        weights = _softmax(query @ keys.swapaxes(-1, -2))
        seen[:, :width] = (weights @ values).reshape(size, width)
        query, key, value = (
            products[:, k * width : (k + 1) * width].reshape(size, self.spatial_heads, *shape)
            for k, shape in ((3, (JOINTS, -1)), (4, (-1, JOINTS)), (5, (JOINTS, -1)))
        )
        weights = np.exp(np.minimum(query @ key, LARGEST))
        weights *= self.graph
        weights /= weights.sum(-1, keepdims=True)
        seen[:, width:] = (weights @ value).reshape(size, width)
        return seen

    def _to_the_other(self, queries: Array, memory: _Memory, near: Array, i: int) -> Array:
        """(B, 2 D) → (B, 2 D): attention over the actor's frames, and over the joints of the one to come."""
        size, width = len(queries), queries.shape[1] // 2
        seen = np.empty((size, 2 * width), np.float32)
        scores = queries[:, :width].reshape(size, self.heads, 1, -1) @ memory.keys
        if memory.padding is not None:
            scores += memory.padding
        seen[:, :width] = (_softmax(scores) @ memory.values).reshape(size, width)
        query = queries[:, width:].reshape(size, self.spatial_heads, JOINTS, -1)
        weights = np.exp(np.minimum(query @ memory.joint_keys[:, i], LARGEST))
        weights /= weights.sum(-1, keepdims=True)
        weights += near
        seen[:, width:] = (weights @ memory.joint_values[:, i]).reshape(size, width)
        return seen


class _Memory:
    """A layer's keys and values of the actor: over time, and of the joints of each frame to come.

    keys (B, heads, d, T), values (B, heads, T, d), joint_keys (B, T − 1, heads, w, J), joint_values
    (B, T − 1, heads, J, w), padding (B, 1, 1, T) 0 or −inf.
    """

    def __init__(self, layer: DecoderLayer, encoded: Tensor, padding: Array | None) -> None:
        keys, values = layer.other_time.remember(encoded)
        joint_keys, joint_values = layer.other_space.remember(encoded[:, 1:])
        self.keys, self.values = keys.mT.contiguous().numpy(), values.contiguous().numpy()
        self.joint_keys = joint_keys.mT.contiguous().numpy()
        self.joint_values = joint_values.contiguous().numpy()
        self.padding = None if padding is None else padding[:, None, None]


def _softmax(scores: Array) -> Array:
    weights = np.exp(scores - scores.max(-1, keepdims=True))
    weights /= weights.sum(-1, keepdims=True)
    return weights


Product = tuple[Exact, Exact]
"""Weight (in, out) and bias (out,) of x @ weight + bias, in float64 while they are folded."""


def _exact(values: Tensor) -> Exact:
    return values.detach().double().numpy()


def _dense(linear: nn.Linear) -> Product:
    return _exact(linear.weight).T, _exact(linear.bias)


def _affine(product: Product) -> Affine:
    return Affine(*(np.ascontiguousarray(part, dtype=np.float32) for part in product))


def _beside(*products: Product) -> Product:
    """Several products of the same numbers, as one."""
    weights, biases = zip(*products, strict=True)
    return np.concatenate(weights, axis=1), np.concatenate(biases)


def _after_norm(norm: nn.LayerNorm, product: Product) -> Product:
    """A product of what the norm scales and shifts, as one of what it divides."""
    weight, bias = product
    return _exact(norm.weight)[:, None] * weight, bias + _exact(norm.bias) @ weight


def _centred(*products: Product) -> Affine:
    """Products whose sum is added to the stream, as one of their inputs side by side; its mean is zero."""
    weight = np.concatenate([weight for weight, _ in products])
    bias = np.sum([bias for _, bias in products], axis=0)
    return _affine((weight - weight.mean(1, keepdims=True), bias - bias.mean()))


def _scaled(product: Product, factor: float) -> Product:
    return product[0] * factor, product[1] * factor


def _split(product: Product) -> tuple[Product, Product]:
    """Keys and values, which come of one product."""
    weight, bias = product
    half = len(bias) // 2
    return (weight[:, :half], bias[:half]), (weight[:, half:], bias[half:])


def _time_query(attention: TemporalAttention) -> Product:
    width = attention.query.out_features
    return _scaled(_dense(attention.query), (width // attention.heads) ** -0.5)


def _of_joints(product: Product, heads: int, order: tuple[int, int, int]) -> Product:
    """A product of each joint's numbers as one of the whole frame's.

    What it makes, (joint, head, number), is put into another order of the three axes.
    """
    weight, bias = product
    index = np.arange(JOINTS * len(bias)).reshape(JOINTS, heads, -1).transpose(order).ravel()
    whole = cast(Exact, np.kron(np.eye(JOINTS), weight))
    return whole[:, index], np.tile(bias, JOINTS)[index]


_BY_HEAD, _TURNED = (1, 0, 2), (1, 2, 0)
"""(head, joint, number), and (head, number, joint), in which keys are multiplied."""


def _space_query(attention: SpatialAttention) -> Product:
    return _of_joints(_scaled(_dense(attention.query), attention.scale), attention.heads, _BY_HEAD)


def _space_out(attention: SpatialAttention) -> Product:
    """The way out of what was seen, which comes in the order (head, joint, number)."""
    weight, bias = _dense(attention.out)
    index = np.arange(len(weight)).reshape(JOINTS, attention.heads, -1).transpose(_BY_HEAD).ravel()
    return weight[index], bias


def _folded(layer: DecoderLayer) -> FoldedLayer:
    space_keys, space_values = _split(_dense(layer.space.memory))
    heads = layer.space.heads
    products = _beside(
        _time_query(layer.time),
        _dense(layer.time.memory),
        _space_query(layer.space),
        _of_joints(space_keys, heads, _TURNED),
        _of_joints(space_values, heads, _BY_HEAD),
    )
    queries = _beside(_time_query(layer.other_time), _space_query(layer.other_space))
    # GELU is x / 2 · (1 + erf(x / √2)): the roots of two are in the products before and after.
    half = math.sqrt(0.5)
    ff_in = _after_norm(layer.norm_3, _dense(layer.ff.linear1))
    weight, bias = _dense(layer.ff.linear2)
    return FoldedLayer(
        self_in=_affine(_after_norm(layer.norm_1, products)),
        self_out=_centred(_dense(layer.time.out), _space_out(layer.space)),
        other_in=_affine(_after_norm(layer.norm_2, queries)),
        other_out=_centred(_dense(layer.other_time.out), _space_out(layer.other_space)),
        ff_in=_affine(_scaled(ff_in, half)),
        ff_out=_centred((weight * half, bias)),
    )
