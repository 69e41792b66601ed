"""The traits of how a person moves whatever is done: energy and tempo, measured beside what is usual for the same acts.

Energy is how far hands, elbows and head move about the pelvis, tempo how fast the hands move for how far they get. What
the acts explain is taken away by regression: a network that is told a person's traits does not learn the acts from
them, and a run can draw them freely.
"""

from __future__ import annotations

from collections.abc import Sequence

import torch
from torch import Tensor

from models.motion_tokens import decode
from motion import SMPL22
from training.prepare import Scenes
from training.trainers.plan_acts import LabelledAct

TRAITS = ("energy", "tempo")
MOST = 2.5
"""Standard deviations beyond which a trait is cut."""
UNKNOWN = 0.35
"""Share of the plans that tell no traits."""
_RIDGE = 5.0
_HANDS = tuple(SMPL22.joint_names.index(name) for name in ("left_wrist", "right_wrist"))
_MOVED = (*_HANDS, *(SMPL22.joint_names.index(name) for name in ("left_elbow", "right_elbow", "head")))


def measured(positions: Tensor, fps: float = 30.0) -> Tensor:
    """Traits of motions, not yet beside what is usual: positions (…, T, 22, 3) in metres → (…, 2) logarithms."""
    about = positions - positions[..., :1, :]
    spread = about.std(-3).norm(dim=-1)
    speed = (about.diff(dim=-3) * fps).norm(dim=-1).mean(-2)
    energy = spread[..., _MOVED].mean(-1)
    tempo = speed[..., _HANDS].mean(-1) / spread[..., _HANDS].mean(-1).clamp(min=0.02)
    return torch.stack([energy, tempo], -1).clamp(min=1e-3).log()


def beside_usual(values: Tensor, done: Tensor) -> Tensor:
    """Traits in standard deviations from what is usual for the acts, cut at :data:`MOST`.

    Args:
        values: (N, traits) of N people.
        done: (N, acts) what each does, and how much.
    """
    known = torch.cat([done, torch.ones(len(done), 1)], 1)
    penalty = _RIDGE * torch.eye(known.shape[1])
    penalty[-1, -1] = 0.0  # the mean is not drawn to zero
    usual = known @ torch.linalg.solve(known.T @ known + penalty, known.T @ values)
    rest = values - usual
    return (rest / rest.std(0).clamp(min=1e-6)).clamp(-MOST, MOST)


def traits(scenes: Scenes, acts: dict[int, Sequence[LabelledAct]]) -> dict[int, Tensor]:
    """The traits (2, :data:`TRAITS`) of both people of every scene whose acts are known, by where the scene starts."""
    rows = [row for row in scenes.rows if row["start"] in acts]
    if not rows:
        return {}
    words = {word for row in rows for one in acts[row["start"]] for word in _words(one)}
    place = {word: i for i, word in enumerate(sorted(words))}
    values, done = torch.zeros(len(rows), 2, len(TRAITS)), torch.zeros(len(rows), 2, len(place))
    for i, row in enumerate(rows):
        positions = decode(scenes.scene(row), scenes.layout)[0]
        values[i] = measured(positions)
        for one in acts[row["start"]]:
            share = (one.act.stop - one.act.start) / positions.shape[1]
            for person in one.act.agents:
                done[i, person, place[one.act.words[0]]] += share
            if one.act.patient is not None:
                done[i, one.act.patient, place[one.act.undergone]] += share
    found = beside_usual(values.flatten(0, 1), done.flatten(0, 1).clamp(0, 1)).view_as(values)
    return {row["start"]: each for row, each in zip(rows, found, strict=True)}


def _words(one: LabelledAct) -> tuple[str, str]:
    return one.act.words[0], one.act.undergone
