"""Who is held by the hips is turned as a whole: trunk, arms and feet go along."""

from __future__ import annotations

import numpy as np
import pytest
import torch
from numpy.typing import NDArray
from torch import Tensor

from models.known import Hold, Known
from models.motion_tokens import FEATURES, TokenLayout, decode, encode, feature_rows, pack, unpack
from motion import SMPL22
from motion.transforms import heading_matrix

LAYOUT = TokenLayout()
TOKENS = 16
FRAMES = LAYOUT.num_frames(TOKENS)
MEAN, STD = torch.linspace(-0.5, 0.5, FEATURES), torch.linspace(0.2, 1.5, FEATURES)
HIPS = [SMPL22.index("left_hip"), SMPL22.index("right_hip")]
SHOULDERS = [SMPL22.index("left_shoulder"), SMPL22.index("right_shoulder")]


def standing(angle: float = 0.0) -> Tensor:
    """(T, 22, 3) a person who stands and faces an angle."""
    pose = (SMPL22.rest_positions() + np.array([0, 0.98, 0])) @ heading_matrix(angle).T
    return torch.from_numpy(np.repeat(pose[None], FRAMES, 0)).float()


def predicted() -> Tensor:
    """Two people who stand and face +Z, as a network makes them."""
    control = encode(standing(), torch.zeros(FRAMES, 4), LAYOUT)
    return pack(((control - MEAN) / STD)[None, None].repeat(1, 2, 1, 1), LAYOUT)


def facing(known: Known, angle: float, frames: list[int]) -> None:
    """Holds person a's hips at frames, at an angle."""
    rows = feature_rows(standing(angle)[: len(frames)], torch.zeros(len(frames), 4))
    for hip in HIPS:
        for axis in (0, 2):
            known.rows[:, 0, frames, 3 * hip + axis] = rows[:, 3 * hip + axis]
            known.mask[:, 0, frames, 3 * hip + axis] = True


def angles(x: Tensor, joints: list[int]) -> NDArray[np.floating]:
    """(T,) degrees that the line between two joints of person a is turned by."""
    found = decode(unpack(x, LAYOUT) * STD + MEAN, LAYOUT)[0][0, 0].double().numpy()
    line = found[:, joints[0]] - found[:, joints[1]]
    return np.degrees(np.arctan2(-line[:, 2], line[:, 0]))


def twist(x: Tensor) -> NDArray[np.floating]:
    """(T,) degrees between person a's shoulders and hips."""
    return (angles(x, SHOULDERS) - angles(x, HIPS) + 180) % 360 - 180


@pytest.mark.parametrize("angle", [0.4, 1.6, 3.0, -2.5])
def test_the_shoulders_and_feet_turn_with_the_hips(angle: float) -> None:
    known = Known.nothing(FRAMES)
    facing(known, angle, [50, 60, 70])
    found = Hold(known, LAYOUT, MEAN, STD).bend(predicted())
    wanted = np.degrees(angle)
    assert np.abs(twist(Hold(known, LAYOUT, MEAN, STD)(predicted()))).max() > 0.8 * abs(wanted)
    for joints in (HIPS, SHOULDERS, [SMPL22.index("left_ankle"), SMPL22.index("right_ankle")]):
        assert np.abs(angles(found, joints)[[50, 60, 70]] - wanted).max() < 7
    assert np.abs(twist(found)).max() < 12


def test_a_turn_dies_out_and_the_other_person_stays() -> None:
    known = Known.nothing(FRAMES)
    facing(known, 2.0, [60])
    x = predicted()
    found = Hold(known, LAYOUT, MEAN, STD).bend(x)
    assert np.abs(angles(found, SHOULDERS)[:20]).max() < 1
    assert torch.allclose(unpack(found, LAYOUT)[:, 1], unpack(x, LAYOUT)[:, 1], atol=1e-5)


def test_a_turn_goes_on_past_half_a_turn() -> None:
    known = Known.nothing(FRAMES)
    for frame, angle in ((40, 2.6), (55, 3.3), (70, 4.0)):
        facing(known, angle, [frame])
    found = np.unwrap(np.radians(angles(Hold(known, LAYOUT, MEAN, STD).bend(predicted()), SHOULDERS)))
    assert np.abs(found[[40, 55, 70]] - [2.6, 3.3, 4.0]).max() < 0.2
    assert (np.diff(found[42:66]) > 0).all()
