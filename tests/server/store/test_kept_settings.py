"""Which runs of a workspace stand beside each other, when its file was made by hand."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from motion import Clip, InputError
from motion.skeleton import SBU15
from tests.server.lab import stub_module
from webdemo.server.store.kept_settings import groups, plain_controls

MOTION = stub_module().walking(0.2)


def test_runs_beside_others_are_found_by_their_numbers() -> None:
    assert groups([[2], None, [], [1]], [MOTION] * 4) == {0: [2], 3: [1]}


@pytest.mark.parametrize(
    ("stored", "says"),
    [
        ([[1], [0]], "part of two"), ([[1], [2], []], "part of two"), ([[2], [2], []], "part of two"),
        ([[1, 1], []], "one twice"), ([[0]], "part of two"), ([[True], []], "not there"), ([[9]], "not there"),
        (["1", []], "too many runs"), ([[1] * 9, []], "too many runs"),
    ],
)  # fmt: skip
def test_circles_and_strangers_are_a_sentence(stored: list[Any], says: str) -> None:
    with pytest.raises(InputError, match=says):
        groups(stored, [MOTION] * len(stored))


def test_motions_of_other_joints_stand_beside_none() -> None:
    other = Clip(np.zeros((3, 15, 3)), 30.0, SBU15)
    with pytest.raises(InputError, match="different joints"):
        groups([[1], []], [MOTION, other])


def test_controls_keep_values_of_their_kinds() -> None:
    controls = {
        "seed": 3,
        "steps": float("nan"),
        "guidance": True,
        "keep": 1,
        "prompt": "x" * 6000,
        "person": "b",
        "x": 1,
    }
    assert plain_controls(controls) == {"seed": 3, "person": "b"}
    assert plain_controls(["seed"]) == {}
