"""Contact sheets of a few sentences, written during training to show its progress."""

from __future__ import annotations

from pathlib import Path

import torch
from PIL import Image

from models.diffusion import denoise, make_scheduler
from models.intergen.compact import CompactInterGen
from models.text import MiniLM
from motion import Duet
from motion.formats.files import replacing
from webdemo.view.contact_sheet import contact_sheet

PROMPTS = (
    "Two people shake hands.",
    "One person waves with the left hand, and the other waves back.",
    "One person pushes the other, who stumbles back.",
    "Two people walk side by side.",
)


@torch.no_grad()
def write_sheet(
    model: CompactInterGen, path: Path, *, frames: int = 120, steps: int = 20, guidance: float = 3.0
) -> None:
    """Generates motions for :data:`PROMPTS` with a network in eval mode; writes their sheets as one PNG.

    Sampling runs without damping or clean-up, to show what the network itself has learned.
    """
    device = model.mean.device
    tokens = MiniLM().to(device)(PROMPTS)
    condition = model.condition(tokens)
    layout = model.layout
    generator = torch.Generator().manual_seed(0)
    noise = torch.randn(len(PROMPTS), layout.num_tokens(frames), 2 * layout.token_features, generator=generator).to(
        device
    )
    x = denoise(
        lambda x, t: model.denoiser.guided(x, t, condition, scale=guidance),
        noise,
        make_scheduler("ddim", steps, spacing="top"),
    )
    positions = model.positions(x)[0][:, :, :frames].float().cpu().numpy()
    sheets = [
        contact_sheet(Duet.from_positions(pair, fps=30.0), title=prompt, tile=140)
        for pair, prompt in zip(positions, PROMPTS, strict=True)
    ]
    page = Image.new("RGB", (sheets[0].width, sum(sheet.height for sheet in sheets)))
    top = 0
    for sheet in sheets:
        page.paste(sheet, (0, top))
        top += sheet.height
    with replacing(path) as temporary:
        page.save(temporary, "png")
