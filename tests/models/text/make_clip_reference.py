"""Makes ``tests/data/reference/clip_text.npz``: CLIP's text features by the `transformers` library.

``python -m tests.models.text.make_clip_reference``, with `transformers` installed (it is no requirement of the
project). The weights are made from their names (:func:`tests.models.reference_arrays.made_weights`) and not
stored. The frozen tower is that of `transformers`; the trained encoder behind it is written out in NumPy.
"""

from __future__ import annotations

import numpy as np
import torch
from numpy.typing import NDArray
from scipy.special import erf

from tests.models.reference_arrays import FOLDER, made_weights

WIDTH, LAYERS, VOCABULARY, LENGTH, ENCODER_LAYERS, ENCODER_FF, HEADS, SEED = 128, 3, 60, 77, 2, 96, 8, 3
Array = NDArray[np.floating]


def shapes() -> dict[str, tuple[int, ...]]:
    """Names in the released file → shapes."""
    found: dict[str, tuple[int, ...]] = {
        "token_embedding.weight": (VOCABULARY, WIDTH),
        "positional_embedding": (LENGTH, WIDTH),
    }
    for i in range(LAYERS):
        block = f"clip_transformer.resblocks.{i}."
        found |= {
            f"{block}attn.in_proj_weight": (3 * WIDTH, WIDTH),
            f"{block}attn.in_proj_bias": (3 * WIDTH,),
            f"{block}attn.out_proj.weight": (WIDTH, WIDTH),
            f"{block}attn.out_proj.bias": (WIDTH,),
            f"{block}ln_1.weight": (WIDTH,),
            f"{block}ln_1.bias": (WIDTH,),
            f"{block}mlp.c_fc.weight": (4 * WIDTH, WIDTH),
            f"{block}mlp.c_fc.bias": (4 * WIDTH,),
            f"{block}mlp.c_proj.weight": (WIDTH, 4 * WIDTH),
            f"{block}mlp.c_proj.bias": (WIDTH,),
            f"{block}ln_2.weight": (WIDTH,),
            f"{block}ln_2.bias": (WIDTH,),
        }
    for i in range(ENCODER_LAYERS):
        layer = f"clipTransEncoder.layers.{i}."
        found |= {
            f"{layer}self_attn.in_proj_weight": (3 * WIDTH, WIDTH),
            f"{layer}self_attn.in_proj_bias": (3 * WIDTH,),
            f"{layer}self_attn.out_proj.weight": (WIDTH, WIDTH),
            f"{layer}self_attn.out_proj.bias": (WIDTH,),
            f"{layer}linear1.weight": (ENCODER_FF, WIDTH),
            f"{layer}linear1.bias": (ENCODER_FF,),
            f"{layer}linear2.weight": (WIDTH, ENCODER_FF),
            f"{layer}linear2.bias": (WIDTH,),
            f"{layer}norm1.weight": (WIDTH,),
            f"{layer}norm1.bias": (WIDTH,),
            f"{layer}norm2.weight": (WIDTH,),
            f"{layer}norm2.bias": (WIDTH,),
        }
    for name in ("ln_final", "clip_ln"):
        found |= {f"{name}.weight": (WIDTH,), f"{name}.bias": (WIDTH,)}
    return found


def tower(weights: dict[str, Array], tokens: Array) -> Array:
    """(B, 77) token numbers → (B, 77, C) after the last norm, by `transformers`."""
    from transformers import CLIPTextConfig, CLIPTextModel

    config = CLIPTextConfig(
        vocab_size=VOCABULARY,
        hidden_size=WIDTH,
        intermediate_size=4 * WIDTH,
        num_hidden_layers=LAYERS,
        num_attention_heads=WIDTH // 64,
        max_position_embeddings=LENGTH,
        hidden_act="quick_gelu",
        eos_token_id=VOCABULARY - 1,
    )
    model = CLIPTextModel(config).eval()
    state = model.state_dict()
    prefix = "text_model." if any(name.startswith("text_model.") for name in state) else ""
    named = {
        "embeddings.token_embedding.weight": weights["token_embedding.weight"],
        "embeddings.position_embedding.weight": weights["positional_embedding"],
        "final_layer_norm.weight": weights["ln_final.weight"],
        "final_layer_norm.bias": weights["ln_final.bias"],
    }
    parts = {
        "attn.out_proj": "self_attn.out_proj",
        "ln_1": "layer_norm1",
        "ln_2": "layer_norm2",
        "mlp.c_fc": "mlp.fc1",
        "mlp.c_proj": "mlp.fc2",
    }
    for i in range(LAYERS):
        block, layer = f"clip_transformer.resblocks.{i}.", f"encoder.layers.{i}."
        for kind in ("weight", "bias"):
            for theirs, ours in parts.items():
                named[f"{layer}{ours}.{kind}"] = weights[f"{block}{theirs}.{kind}"]
            projections = np.split(weights[f"{block}attn.in_proj_{kind}"], 3)
            for name, value in zip("qkv", projections, strict=True):
                named[f"{layer}self_attn.{name}_proj.{kind}"] = value
    tensors = {prefix + name: torch.as_tensor(value) for name, value in named.items()}
    missing, unexpected = model.load_state_dict(tensors, strict=False)
    assert not unexpected and all(name.endswith("position_ids") for name in missing), (missing, unexpected)
    with torch.no_grad():
        return model(input_ids=torch.as_tensor(tokens)).last_hidden_state.double().numpy()


def norm(x: Array, weights: dict[str, Array], name: str) -> Array:
    x = (x - x.mean(-1, keepdims=True)) / np.sqrt(x.var(-1, keepdims=True) + 1e-5)
    return x * weights[f"{name}.weight"] + weights[f"{name}.bias"]


def encoder(weights: dict[str, Array], x: Array) -> Array:
    """The trained encoder: post-norm layers of eight heads and an exact GELU, then the last norm."""
    for i in range(ENCODER_LAYERS):
        layer = f"clipTransEncoder.layers.{i}."
        attention = f"{layer}self_attn."
        qkv = x @ weights[f"{attention}in_proj_weight"].T + weights[f"{attention}in_proj_bias"]
        q, k, v = (np.stack(np.split(part, HEADS, -1), 1) for part in np.split(qkv, 3, -1))
        scores = q @ k.swapaxes(-1, -2) / np.sqrt(q.shape[-1])
        shares = np.exp(scores - scores.max(-1, keepdims=True))
        seen = np.concatenate(list((shares / shares.sum(-1, keepdims=True) @ v).swapaxes(0, 1)), -1)
        seen = seen @ weights[f"{attention}out_proj.weight"].T + weights[f"{attention}out_proj.bias"]
        x = norm(x + seen, weights, f"{layer}norm1")
        hidden = x @ weights[f"{layer}linear1.weight"].T + weights[f"{layer}linear1.bias"]
        hidden = hidden * (1 + erf(hidden / np.sqrt(2))) / 2
        hidden = hidden @ weights[f"{layer}linear2.weight"].T + weights[f"{layer}linear2.bias"]
        x = norm(x + hidden, weights, f"{layer}norm2")
    return norm(x, weights, "clip_ln")


def main() -> None:
    sizes = shapes()
    weights = {name: value.numpy() for name, value in made_weights(sizes, SEED).items()}
    tokens = np.zeros((3, LENGTH), dtype=np.int64)
    rng = np.random.default_rng(SEED)
    for row, count in zip(tokens, (2, 9, LENGTH - 2), strict=True):
        row[: count + 2] = [VOCABULARY - 2, *rng.integers(1, VOCABULARY - 2, count), VOCABULARY - 1]
    features = tower(weights, tokens)
    condition = encoder({name: value.astype(np.float64) for name, value in weights.items()}, features)
    np.savez_compressed(
        FOLDER / "clip_text.npz",
        names=np.array(list(sizes)),
        shapes=np.array([",".join(map(str, size)) for size in sizes.values()]),
        seed=np.int64(SEED),
        tokens=tokens,
        token_features=features.astype(np.float32),
        condition=condition[np.arange(3), tokens.argmax(-1)].astype(np.float32),
    )


if __name__ == "__main__":
    main()
