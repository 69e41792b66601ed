"""Balls and other things that are thrown, rolled, kicked and bounced."""

from __future__ import annotations

import numpy as np
import pytest

from motion import SMPL22
from motion.things.tracks import GRAVITY

from .furnishing import FPS, FRAMES, GAP, act, palms, put_hand, standing, things_of, worded


def test_a_ball_that_is_rolled_leaves_the_lowest_hand_and_rolls_over_the_floor_to_the_other():
    people = standing()
    low = np.tile([0.1, 0.9, 0.3], (FRAMES, 1))
    low[30:50, 1] = 0.2
    put_hand(people[0], "right", low)
    rolls, sentence = worded("A rolls a ball to B.", "bowl", patient="b")
    (ball,) = things_of(people, rolls, sentence=sentence)
    radius = ball.mesh.size[1] / 2
    assert np.ptp(ball.places[:20, 1]) < 0.05 and ball.places[20, 1] > 0.8, "it is in the hand"
    assert ball.places[55:, 1] == pytest.approx(radius, abs=0.005)
    x, _, z = ball.places[-1]
    assert 0.2 < np.hypot(x, z - GAP) < 0.4, "at b's feet"
    way = np.linalg.norm(np.diff(ball.places[55:, [0, 2]], axis=0), axis=1)
    turned = np.arccos(np.clip((np.einsum("tij,tij->t", ball.rotations[56:], ball.rotations[55:-1]) - 1) / 2, -1, 1))
    assert turned == pytest.approx(way / radius, abs=0.02), "it does not slide"


def test_a_ball_that_is_kicked_lies_before_the_foot_and_rolls_from_it_to_the_other():
    people = standing()
    people[1, :, :, 2] += 2.0
    swing = 0.5 * np.exp(-(((np.arange(FRAMES) - 40) / 5.0) ** 2))
    for joint in ("right_ankle", "right_foot"):
        people[0, :, SMPL22.index(joint), 2] += swing
    (ball,) = things_of(people, act("kick-ball", patient="b", thing="ball"))
    lies = ball.places[0]
    assert lies[1] == pytest.approx(ball.mesh.size[1] / 2, abs=0.005) and lies[2] > 0.3
    moved = np.flatnonzero(np.abs(ball.places[:, 2] - lies[2]) > 0.02)[0]
    foot = people[0, moved, SMPL22.index("right_foot")]
    assert 30 < moved < 45 and np.hypot(*(foot - lies)[[0, 2]]) < 0.3, "the foot meets it"
    assert 0.2 < abs(ball.places[-1, 2] - GAP - 2.0) < 0.4, "at b's feet"


def test_two_who_throw_a_ball_have_it_in_turn():
    people = standing()
    people[1, :, :, 2] += 2.0
    frames = np.arange(FRAMES)
    for person, thrown, ahead in ((0, 25, 1.0), (1, 80, -1.0)):
        swing = np.clip((frames - thrown) / 6.0, 0, 1)[:, None]
        start = np.array([-0.2 * ahead, 1.3, person * (GAP + 2.0) - 0.1 * ahead])
        put_hand(people[person], "right", start + swing * np.array([0.0, 0.2, 0.6 * ahead]))
    sentence = "They play catch."
    throws, _ = worded(sentence, "throw-ball", "ab")
    (ball,) = things_of(people, throws, sentence=sentence)
    assert ball.kind == "ball"
    hands = palms(people)
    for frame, person in ((10, 0), (65, 1), (110, 0)):
        gaps = np.linalg.norm(ball.places[frame] - hands[person, :, frame], axis=-1)
        assert gaps.min() < 0.16, f"person {person} has it at frame {frame}"


def test_a_ball_bounces_between_a_hand_that_goes_up_and_down_and_the_floor():
    people = standing()
    hand = np.tile([-0.25, 0.95, 0.3], (FRAMES, 1))
    hand[30:, 1] += 0.1 * np.cos(2 * np.pi * 1.5 * np.arange(FRAMES - 30) / FPS)
    put_hand(people[0], "right", hand)
    bounces, sentence = worded("A bounces a ball.", "dribble", side="right")
    (ball,) = things_of(people, bounces, sentence=sentence)
    radius = ball.mesh.size[1] / 2
    assert ball.places[:, 1].min() > radius - 0.005, "not into the floor"
    low = ball.places[:, 1] < radius + 0.15
    assert np.sum(np.diff(low.astype(int)) == 1) == 4, "as often as the hand goes down, once the ball is back"
    assert np.linalg.norm(ball.places[:25] - palms(people)[0, 1, :25], axis=1).max() < radius + 0.06
    assert np.linalg.norm(np.diff(ball.places, axis=0), axis=1).max() * FPS < 9.0


def test_a_throw_is_a_parabola_from_hand_to_hand():
    people = standing()
    people[1, :, :, 2] += 2.0
    swing = np.clip((np.arange(FRAMES) - 40) / 6.0, 0, 1)[:, None]
    put_hand(people[0], "right", np.array([-0.2, 1.3, -0.1]) + swing * np.array([0.0, 0.2, 0.6]))
    put_hand(people[1], "right", np.array([0.2, 1.2, GAP + 2.0 - 0.35]))
    (ball,) = things_of(people, act("throw-ball", patient="b", thing="ball"))
    hands = palms(people)
    steps = np.diff(ball.places[:, 1], n=2)
    flight = np.flatnonzero(np.abs(steps * FPS**2 + GRAVITY) < 0.2)
    assert len(flight) >= 9 and np.ptp(flight) == len(flight) - 1, "no parabola"
    assert np.linalg.norm(ball.places[20] - hands[0, 1, 20]) < 0.16
    assert np.linalg.norm(ball.places[100] - hands[1, 1, 100]) < 0.16
    assert np.linalg.norm(np.diff(ball.places, axis=0), axis=1).max() * FPS < 12.0, "it jumps"


def test_what_nobody_catches_comes_down_on_the_floor():
    away, up = (act("throw-ball", patient="b", thing="ball", direction=way) for way in ("away", "up"))
    (ball,) = things_of(standing(), away)
    assert ball.places[-1, 1] == pytest.approx(ball.mesh.size[1] / 2, abs=0.02)
    (ball,) = things_of(standing(), up)
    assert np.linalg.norm(ball.places[-1] - palms(standing())[0, :, -1], axis=-1).min() < 0.25
