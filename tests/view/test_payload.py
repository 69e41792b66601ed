"""The player's payload: small, exact enough, and it refuses what it cannot show."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from motion import SMPL22, Clip, Duet, InputError
from motion.metrics import Contact
from tests.view.packed import unpack_positions
from webdemo.view.payload import Curve, distance_curves, pack_positions, player_payload, sample_payload

NAMES = SMPL22.joint_names


def standing(frames: int = 30, apart: float = 2.0) -> np.ndarray:
    """Two people in T-pose along Z, (2, T, 22, 3)."""
    rest = SMPL22.rest_positions()
    a = np.repeat(rest[None], frames, axis=0)
    return np.stack([a, a + np.array([0.0, 0.0, apart])])


def duet(frames: int = 30, apart: float = 2.0, **kwargs) -> Duet:
    return Duet.from_positions(standing(frames, apart), fps=30.0, **kwargs)


def test_quantisation_is_finer_than_a_fifth_of_a_millimetre_over_ten_metres():
    positions = np.random.default_rng(0).uniform(-5, 5, size=(2, 40, 22, 3))
    back = unpack_positions(pack_positions(positions))
    assert back.shape == positions.shape
    assert np.abs(back - positions).max() < 2e-4 / 2


@settings(max_examples=50, deadline=None)
@given(size=st.floats(1e-3, 100), centre=st.floats(-50, 50), frames=st.integers(1, 6), seed=st.integers(0, 2**16))
def test_round_trip_error_is_half_a_level(size, centre, frames, seed):
    positions = centre + size * np.random.default_rng(seed).standard_normal((2, frames, 5, 3))
    packed = pack_positions(positions)
    error = np.abs(unpack_positions(packed) - positions).max(axis=(0, 1, 2))
    float32 = 1e-7 * np.abs(positions).max()
    assert (error <= 0.501 * np.asarray(packed["scale"]) + float32).all()


def test_ten_seconds_are_small_and_plain_json():
    payload = player_payload(duet(300), title="${alert(1)}")
    text = json.dumps(payload)
    assert len(payload["samples"][0]["positions"]["data"]) < 110_000
    assert len(text) < 130_000
    assert json.loads(text) == payload


def test_one_person_has_no_curves():
    alone = player_payload(Clip(standing()[0], 30.0, name="solo"))
    assert alone["samples"][0]["positions"]["shape"] == [1, 30, 22, 3]
    assert alone["samples"][0]["curves"] == alone["samples"][0]["contacts"] == []


def test_curves_measure_metres():
    curves = {c.label: c.values for c in distance_curves(duet(apart=2.0))}
    assert np.allclose(curves["Apart"], 2.0)
    assert np.allclose(curves["Hands"], 2.0, atol=1e-3)


def test_own_curves_and_contacts_are_kept():
    sample = sample_payload(
        duet(4), curves=[Curve("Label", "s", np.arange(4.0))], contacts=[Contact(1, 3, "hands", "x")]
    )
    assert sample["curves"] == [{"label": "Label", "unit": "s", "values": [0.0, 1.0, 2.0, 3.0]}]
    assert sample["contacts"] == [{"start": 1, "stop": 3, "kind": "hands", "label": "x"}]


def test_looks_are_sent_where_the_words_say_something():
    assert "looks" not in sample_payload(duet())
    assert sample_payload(replace(duet(), looks=("woman", "old-man")))["looks"] == ["woman", "old-man"]


@pytest.mark.parametrize(
    "make",
    [
        lambda: pack_positions(np.zeros((2, 0, 22, 3))),
        lambda: pack_positions(np.zeros((4, 22, 3))),
        lambda: pack_positions(np.full((1, 2, 3, 3), np.nan)),
    ],
)
def test_refuses_in_one_sentence(make):
    with pytest.raises(InputError, match=r"\A.*\.\Z"):
        make()
