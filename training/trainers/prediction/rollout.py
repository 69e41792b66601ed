"""Windows whose past is a network's own prediction, as it meets it when it is applied to what it gave."""

from __future__ import annotations

import numpy as np
import torch
from torch import Tensor, nn

from motion import InputError
from webdemo.inference.pipelines.predictor import to_last_pose

ADVANCE = 20
"""Frames by which a pass of the recursion goes on: the page's passes share the rest of a second."""


def check_own_pasts(own_pasts: int, windows: str, future: int) -> None:
    """Raises InputError if windows or future are none that :func:`with_own_past` can take."""
    if own_pasts < 0 or (own_pasts and (windows != "corpus" or future < ADVANCE)):
        raise InputError(
            f"own_pasts is {own_pasts}: give 0, or more with the windows of the corpus and a future of "
            f"{ADVANCE} frames or more."
        )


@torch.no_grad()
def with_own_past(network: nn.Module, windows: Tensor, past: int, future: int, passes: int) -> tuple[Tensor, Tensor]:
    """Lets a network go on from the past of windows and cuts them anew where it has come to.

    Args:
        network: (B, past, 22, 3) metres → (B, future, 22, 3), in the frame of the last pose of the past.
        windows: (B, past + passes · ADVANCE + future or more, 22, 3) metres of recorded motion.
        past, future: of the network, ``future`` at least :data:`ADVANCE`.
        passes: how often it goes on by ``ADVANCE`` frames.

    Returns:
        (B, past + future, 22, 3): what was given or made before, and what was recorded after, each in the
        frame of its own last pose before; where the network strayed to is nothing that it can know. What was
        recorded begins in the pose that the network came to, and is quite itself at the end.
        And (B, past + future, 22, 3) as it was recorded, in the frame of that last pose.
    """
    whole = windows[:, :past]
    for _ in range(passes):
        local, turn, shift = to_last_pose(whole[:, -past:].cpu().numpy())
        made = network(torch.from_numpy(local).to(windows))[:, :ADVANCE]
        turn, shift = (torch.from_numpy(x).to(windows) for x in (turn, shift))
        whole = torch.cat([whole, made @ turn[:, None] + shift[:, None, None]], dim=1)
    start = passes * ADVANCE
    recorded = to_last_pose(windows[:, start : start + past + future].cpu().numpy(), past - 1)[0]
    before = to_last_pose(whole[:, start:].cpu().numpy())[0]
    strayed = (1 - np.arange(1, future + 1) / future)[:, None, None] * (before[:, -1:] - recorded[:, [past - 1]])
    made = np.concatenate([before, recorded[:, past:] + strayed], axis=1)
    own, true = (torch.from_numpy(x).to(windows) for x in (made, recorded))
    return own, true
