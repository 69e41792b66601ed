"""The fast mode of a grown InterGen: a small change of its matrices by which one pass of few does what many did.

A pass takes the scale of the guidance as an input (Meng et al. 2023, "On Distillation of Guided Diffusion Models"),
and :data:`PASSES` passes stand for a whole sampling (progressive distillation, Salimans & Ho 2022). The change is of
low rank (Hu et al. 2022, "LoRA"), so the network itself stays as it is and goes on sampling with any number of
steps; :mod:`training.trainers.intergen_fast` fits it.
"""

from __future__ import annotations

import torch
from torch import Tensor, nn

from models.layers import TimestepEmbedding

from .words import WordDenoiser

PASSES = 8
"""DDIM steps, with timesteps from the top, that the change is fitted for."""


class FastChange(nn.Module):
    """The change: for each matrix of the blocks an addition ``up @ down``, and the embedding of the scale.

    Args:
        denoiser: whose matrices are changed; it is not kept.
        rank: of each addition.
    """

    def __init__(self, denoiser: WordDenoiser, rank: int) -> None:
        super().__init__()
        self.down, self.up = nn.ParameterDict(), nn.ParameterDict()
        for name, weight in denoiser.blocks.named_parameters():
            if weight.dim() == 2:
                key = name.replace(".", "-")  # a ParameterDict takes no dots
                self.down[key] = nn.Parameter(torch.randn(rank, weight.shape[1]) / weight.shape[1] ** 0.5)
                self.up[key] = nn.Parameter(torch.zeros(weight.shape[0], rank))
        self.embed_guidance = TimestepEmbedding(denoiser.config.latent_dim)
        self.embed_guidance.start_at_zero()

    def tensors(self, denoiser: WordDenoiser) -> dict[str, Tensor]:
        """State of a :class:`WordDenoiser` with ``guidance_input``: the given network's with the change."""
        state = dict(denoiser.state_dict())
        for key, down in self.down.items():
            name = "blocks." + key.replace("-", ".")
            state[name] = state[name] + self.up[key] @ down
        return state | {f"embed_guidance.{k}": v for k, v in self.embed_guidance.named_parameters()}

    @torch.no_grad()
    def applied_to(self, denoiser: WordDenoiser) -> WordDenoiser:
        """The network in fast mode: its ``guided`` is one pass; in eval mode, without gradients."""
        changed = WordDenoiser(
            denoiser.config,
            denoiser.known_embed.in_features,
            plan_features=denoiser.plan_features,
            traits=denoiser.traits,
            guidance_input=True,
        )
        changed.load_state_dict(self.tensors(denoiser))
        return changed.to(denoiser.out.linear.weight.device).eval().requires_grad_(False)
