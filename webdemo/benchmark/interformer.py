"""Speed of InterFormer: with keys and values kept, and with the decoder run anew for every frame."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from typing import Any

FRAMES = 48
SECONDS_GOAL = 0.3
GAIN_GOAL = 5.0


def measure_interformer(repeats: int) -> dict[str, Any]:
    """Figures of the shipped network, or of an untrained one of the same size where none is shipped.

    ``interformer_48_frames``: seconds of one reaction's 48 frames, the encoder included.
    ``interformer_plain_over_cached``: how many times as long the same frames take where the decoder reads all
    past frames again for each.
    """
    import torch
    from torch import Tensor

    from models.interformer import JOINTS
    from models.interformer.compact import CompactInterFormer, CompactInterFormerConfig, load_folder
    from models.interformer.decoding import ReactionDecoder
    from webdemo.inference.engine import WEIGHTS

    folder = WEIGHTS / "interformer"
    shipped = (folder / "config.json").is_file()
    model = load_folder(folder)[0] if shipped else CompactInterFormer(CompactInterFormerConfig()).eval()
    decoder = ReactionDecoder(model)
    torch.manual_seed(0)
    actor, first = torch.randn(1, FRAMES, JOINTS, 3), torch.randn(1, JOINTS, 3)
    noise, mask = torch.randn(1, model.config.noise), torch.ones(1, FRAMES, dtype=torch.bool)

    def cached() -> Tensor:
        return decoder.react(actor, first, noise)

    @torch.inference_mode()
    def plain() -> Tensor:
        encoded, made = model.encode(actor, noise, mask), first[:, None]
        while made.shape[1] < FRAMES:
            made = torch.cat([made, model.decode(actor, encoded, made, mask)[:, -1:]], dim=1)
        return made

    def took(run: Callable[[], Tensor]) -> float:
        run()  # the first run loads kernels
        times = []
        for _ in range(repeats):
            began = time.perf_counter()
            run()
            times.append(time.perf_counter() - began)
        return statistics.median(times)

    seconds = took(cached)
    return {
        "interformer_weights": "shipped" if shipped else "untrained",
        "interformer_48_frames": seconds,
        "interformer_48_frames_goal": SECONDS_GOAL,
        "interformer_plain_over_cached": took(plain) / seconds,
        "interformer_plain_over_cached_goal": GAIN_GOAL,
    }
