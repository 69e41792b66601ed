"""Windows whose past is a network's own prediction, as it meets it when it is applied to what it gave."""

from __future__ import annotations

import torch
from torch import Tensor, nn

from webdemo.inference.predict_frame import to_last_pose

ADVANCE = 20
"""Frames by which a pass of the recursion goes on: the page's passes share the rest of a second."""


@torch.no_grad()
def with_own_past(network: nn.Module, windows: Tensor, past: int, future: int, passes: int) -> Tensor:
    """Lets a network go on from the past of windows and cuts them anew where it has come to.

    Args:
        network: (B, past, 22, 3) metres → (B, future, 22, 3), in the frame of the last pose of the past.
        windows: (B, past + passes · ADVANCE + future or more, 22, 3) metres of recorded motion.
        past, future: of the network, ``future`` at least :data:`ADVANCE`.
        passes: how often it goes on by ``ADVANCE`` frames.

    Returns:
        (B, past + future, 22, 3): what was given or made before, and what was recorded after, each in the
        frame of its own last pose before; where the network strayed to is nothing that it can know.
    """
    whole = windows[:, :past]
    for _ in range(passes):
        local, turn, shift = to_last_pose(whole[:, -past:].cpu().numpy())
        made = network(torch.from_numpy(local).to(windows))[:, :ADVANCE]
        turn, shift = (torch.from_numpy(x).to(windows) for x in (turn, shift))
        whole = torch.cat([whole, made @ turn[:, None] + shift[:, None, None]], dim=1)
    start = passes * ADVANCE
    recorded = windows[:, start : start + past + future].cpu().numpy()
    before = to_last_pose(whole[:, start:].cpu().numpy())[0]
    after = to_last_pose(recorded, past - 1)[0][:, past:]
    return torch.cat([torch.from_numpy(part).to(windows) for part in (before, after)], dim=1)
