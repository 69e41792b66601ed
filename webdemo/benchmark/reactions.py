"""Speed of ReGenNet: the delay of a frame while the actor moves, and a whole reaction at once."""

from __future__ import annotations

import statistics
import time
from typing import Any

STREAMED = 600
"""Frames of the stream: 20 seconds."""
WHOLE = 300
DELAY_GOAL_MS = 4.0
WHOLE_GOAL = 1.0
_STEPS = 5


def measure_reactions(repeats: int) -> dict[str, Any]:
    """Figures of the shipped network, or of an untrained one of the same size where none is shipped.

    ``reaction_frame_ms*``: milliseconds from an actor's frame to the reaction's, bones and feet included,
    over :data:`STREAMED` frames with DDIM-5: the mean, the median of the frames at which the network runs
    (every fourth) and the longest. ``reaction_last_over_first``: the mean of the last hundred frames over
    that of the second hundred; 1 is flat.
    """
    import numpy as np
    import torch

    from models.diffusion import denoise, make_scheduler
    from models.motion_tokens import FEATURES
    from models.regennet.compact import CompactReGenNet, CompactReGenNetConfig, load_folder
    from motion import SMPL22
    from webdemo.inference.finish.cleanup import FollowingCleanup
    from webdemo.inference.method import WEIGHTS

    folder = WEIGHTS / "regennet"
    shipped = (folder / "config.json").is_file()
    model = load_folder(folder)[0] if shipped else CompactReGenNet(CompactReGenNetConfig()).eval()
    torch.manual_seed(0)
    actor = torch.from_numpy(SMPL22.rest_positions()).float() + torch.tensor([0.0, 0.98, 0.0])
    nothing = torch.zeros(1, model.config.cond_dim)

    def streamed() -> list[float]:
        stream = model.stream(nothing, steps=_STEPS, max_frames=STREAMED)
        noise = iter(torch.randn(model.num_rows(STREAMED) + 1, 1, FEATURES))
        finish, times = FollowingCleanup(), []
        for _ in range(STREAMED):
            began = time.perf_counter()
            positions, contacts = stream.step(actor, noise=noise)
            finish(positions[0].numpy().astype(np.float64), contacts[0].numpy())
            times.append(time.perf_counter() - began)
        return times

    @torch.no_grad()
    def whole() -> float:
        began = time.perf_counter()
        seen = model.actor_rows(actor.expand(1, WHOLE, -1, -1))
        noise = torch.randn(1, model.num_rows(WHOLE), FEATURES)
        scheduler = make_scheduler("ddim", _STEPS, spacing="top")
        x = denoise(lambda x, t: model.guided(x, t, seen, nothing, scale=1.0), noise, scheduler)
        model.positions(x, WHOLE)
        return time.perf_counter() - began

    streamed()  # the first run loads kernels
    runs = [streamed() for _ in range(repeats)]
    times = [statistics.median(frame) for frame in zip(*runs, strict=True)]
    whole()
    return {
        "reaction_weights": "shipped" if shipped else "untrained",
        "reaction_frame_ms": 1000 * statistics.mean(times),
        "reaction_frame_ms_network": 1000 * statistics.median(times[4 :: model.config.frames_per_knot]),
        "reaction_frame_ms_longest": 1000 * max(times[4:]),
        "reaction_frame_ms_goal": DELAY_GOAL_MS,
        "reaction_last_over_first": statistics.mean(times[-100:]) / statistics.mean(times[100:200]),
        "reaction_whole_seconds": statistics.median(whole() for _ in range(repeats)),
        "reaction_whole_goal": WHOLE_GOAL,
    }
