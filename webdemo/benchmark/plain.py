"""The run that the benchmark's ratios are against: the default network as the papers' equations read."""

from __future__ import annotations

from typing import Any, cast

import torch
from torch import Tensor

from models.diffusion import denoise, guide, make_scheduler, sample_noise
from models.diffusion.schedule import Spacing
from models.intergen.network import Block, InterGenDenoiser
from models.intergen.words import WordBlock, WordDenoiser
from models.layers import sinusoids


class PlainSampler:
    """The same network, sampled without batching or caching, in float32.

    Each person and each guidance half is a pass of its own through ``torch.nn.MultiheadAttention``, and the
    prompt is encoded anew at every step: how the papers' equations read, and what the ratios are against.
    """

    def __init__(self, denoiser: InterGenDenoiser, pipeline: Any, request: Any, *, spacing: Spacing = "top") -> None:
        self.denoiser, self.pipeline, self.request, self.spacing = denoiser, pipeline, request, spacing

    def run(self) -> Tensor:
        """Samples one motion; returns it in network space."""
        request, model = self.request, self.pipeline.model
        tokens = model.layout.num_tokens(round(request.seconds * 30))
        noise = sample_noise(request.seed, 1, (tokens, 2 * model.layout.token_features))

        def predict(x: Tensor, t: Tensor) -> Tensor:
            condition, _ = self.pipeline.condition(request.prompt)
            nothing = torch.zeros_like(condition)
            return guide(self.forward(x, t, condition), self.forward(x, t, nothing), request.guidance)

        return denoise(predict, noise, make_scheduler("ddim", request.steps, spacing=self.spacing))

    def forward(self, x: Tensor, t: Tensor, condition: Tensor) -> Tensor:
        """InterGen's denoiser, with or without words, one person at a time: (1, T, 2F) → (1, T, 2F)."""
        net = self.denoiser
        words = net.text_of_each(condition) if isinstance(net, WordDenoiser) else None
        embs = net.embed(t, condition).expand(2, 1, -1)[:, None]
        roles = net.role_embedding if net.config.role_embedding else (0.0, 0.0)
        states = [
            net.motion_embed(person) + sinusoids(x.shape[1], net.config.latent_dim) + role
            for person, role in zip(x.chunk(2, dim=-1), roles, strict=True)
        ]
        for block in cast(list[Block], net.blocks):
            before, after = states, []
            for i, (h, emb) in enumerate(zip(before, embs, strict=True)):
                query = block.sa_block.norm(h[None], emb)[0]
                h = h + _attention(block.sa_block.attention, query, query)
                if words is not None:
                    text, real = (rows[i : i + 1] for rows in words)
                    h = h + cast(WordBlock, block).words(h[None], text, real)[0]
                query = block.ca_block.norm(h[None], emb)[0]
                other = block.ca_block.xf_norm(before[1 - i][None], emb)[0]
                h = h + _attention(block.ca_block.attention, query, other)
                after.append(h + block.ffn(h[None], emb)[0])
            states = after
        return torch.cat([net.out(h[None])[0] for h in states], dim=-1)


def _attention(module: torch.nn.MultiheadAttention, query: Tensor, source: Tensor) -> Tensor:
    """The module's weights in PyTorch's own multi-head attention."""
    return torch.nn.MultiheadAttention.forward(module, query, source, source, need_weights=False)[0]
