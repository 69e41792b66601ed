"""Touches of the words are met by a network that has learned nothing."""

from __future__ import annotations

import numpy as np
import pytest

from motion import SMPL22
from webdemo.inference import Engine

from .test_planned_scenes import made


def nearest(motion: np.ndarray, giver: int, joints: list[str], others: list[str]) -> np.ndarray:
    """(T,) metres between the nearest of a person's joints and of the other's."""
    mine, theirs = ([SMPL22.index(name) for name in names] for names in (joints, others))
    gaps = motion[giver, :, mine][:, None] - motion[1 - giver, :, theirs][None]
    return np.linalg.norm(gaps, axis=-1).min(axis=(0, 1))


@pytest.mark.parametrize(
    ("prompt", "giver", "part"),
    [
        ("Person A lays a hand on person B's head.", 0, ["head"]),
        ("While person B kneels, person A lays a hand on person B's head.", 0, ["head"]),
        ("Person A is tapped on the back by person B.", 1, ["left_shoulder", "right_shoulder", "spine3"]),
        ("Person A puts both hands on person B's shoulders.", 0, ["left_shoulder", "right_shoulder"]),
    ],
)
def test_a_hand_touches_what_the_words_name(engine: Engine, prompt: str, giver: int, part: list[str]) -> None:
    gap = nearest(made(engine, prompt), giver, ["left_wrist", "right_wrist"], part)
    assert gap.min() < 0.2
    free = nearest(made(engine, prompt, planned=False), giver, ["left_wrist", "right_wrist"], part)
    assert gap.min() < free.min()


def test_a_pat_is_given_twice(engine: Engine) -> None:
    gap = nearest(
        made(engine, "Person B pats person A on the shoulder."),
        1,
        ["right_wrist"],
        ["left_shoulder", "right_shoulder"],
    )
    on = gap < gap.min() + 0.08
    assert np.count_nonzero(on[1:] & ~on[:-1]) + on[0] >= 2


def test_a_kiss_brings_the_heads_together(engine: Engine) -> None:
    gap = nearest(made(engine, "The woman kisses the man."), 0, ["head"], ["head"])
    assert gap.min() < 0.4


def test_who_is_tapped_and_turns_round_is_tapped_first(engine: Engine) -> None:
    found = made(engine, "Person A is tapped on the back by person B and turns around.")
    gap = nearest(found, 1, ["right_wrist"], ["left_shoulder", "right_shoulder", "spine3"])
    across = found[0, :, SMPL22.index("left_hip")] - found[0, :, SMPL22.index("right_hip")]
    angle = np.unwrap(np.arctan2(across[:, 0], across[:, 2]))
    turned = np.abs(angle - angle[0]) > 1.0
    assert turned[-1] and gap[: int(np.flatnonzero(turned)[0])].min() < 0.25
