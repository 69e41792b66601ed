"""Feet that stand."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d

from motion import SMPL22
from motion.cleaning import foot_contacts, plant_feet
from motion.kinematics import bone_lengths, project_to_skeleton
from motion.limbs import solve_two_bones, steadied
from motion.skeleton import FEET

from .bodies import FPS, gliding, marching


def test_a_gliding_person_stands_still_after_planting():
    positions = gliding(speed=0.08, sink=0.02)
    contacts = foot_contacts(positions, FPS)
    assert contacts.all()
    planted = plant_feet(positions, contacts)
    feet = planted[:, list(FEET)]
    assert np.ptp(feet[..., [0, 2]], axis=0).max() < 1e-6
    assert feet[..., 1].min() > -1e-9
    np.testing.assert_allclose(bone_lengths(planted), bone_lengths(positions), atol=1e-6)
    # The body still glides above the feet.
    np.testing.assert_allclose(planted[:, 0, 0], positions[:, 0, 0], atol=1e-9)


def test_marching_is_planted_without_jumps():
    positions, _ = marching(120)
    positions[..., 1] -= 0.03
    planted = plant_feet(positions, foot_contacts(positions, FPS))
    assert planted[:, list(FEET), 1].min() >= -1e-9
    np.testing.assert_allclose(bone_lengths(planted), bone_lengths(positions), atol=1e-6)
    # Metres a frame that the correction itself moves.
    steps = np.linalg.norm(np.diff(planted - positions, axis=0), axis=-1)
    assert steps.max() < 0.06


def test_noise_does_not_cut_a_contact_and_planting_does_not_add_jerk():
    still = gliding(150, speed=0.0, sink=0.0)
    noise = gaussian_filter1d(np.random.default_rng(0).normal(size=still.shape), 4, axis=0)
    noisy, _ = project_to_skeleton(still + 0.02 * noise / noise.std())
    contacts = foot_contacts(noisy, FPS)
    assert contacts.mean() > 0.9
    planted = plant_feet(noisy, contacts)

    def jerk(positions):
        return np.linalg.norm(np.diff(positions[:, list(FEET)], 3, axis=0), axis=-1).mean()

    assert jerk(planted) < 0.8 * jerk(noisy)


@pytest.mark.parametrize("goal", [(0.1, -0.5, 0.2), (0.0, -2.0, 0.0), (0.0, -0.05, 0.0)])
def test_two_bones_reach_or_draw_in(goal):
    hip, knee, ankle = np.zeros(3), np.array([0, -0.4, 0.05]), np.array([0, -0.8, 0.0])
    new_knee, new_ankle = solve_two_bones(hip, knee, ankle, np.array(goal), np.array([0, 0, 1.0]))
    upper, lower = np.linalg.norm(knee), np.linalg.norm(ankle - knee)
    assert np.isclose(np.linalg.norm(new_knee), upper, atol=1e-5)
    assert np.isclose(np.linalg.norm(new_ankle - new_knee), lower, atol=1e-5)
    reach = np.linalg.norm(goal)
    if abs(upper - lower) < reach < upper + lower:
        np.testing.assert_allclose(new_ankle, goal, atol=1e-5)
    else:
        assert np.cross(new_ankle, goal) == pytest.approx(0, abs=1e-6)
    if reach < upper + lower:
        assert new_knee[2] > 0  # knees bend forward


def test_held_frames_stay_and_feet_beside_them_stand_where_they_stood():
    positions, _ = marching(120)
    positions[60:] += [0.03, -0.02, 0.0]
    held = np.arange(120) < 60
    contacts = foot_contacts(positions, FPS)
    assert (contacts[59] & contacts[60]).any()
    planted = plant_feet(positions, contacts, held=held)
    np.testing.assert_array_equal(planted[held], positions[held])
    np.testing.assert_allclose(bone_lengths(planted), bone_lengths(positions), atol=1e-6)
    for foot, stands in zip(FEET, contacts.T, strict=True):
        if stands[59:63].all():
            assert np.linalg.norm(np.diff(planted[59:63, foot], axis=0), axis=-1).max() < 0.01


def test_a_knee_that_was_seen_to_bend_backwards_bends_forwards():
    time = np.linspace(0, np.pi, 60)
    hip, ankle = np.tile([0.0, 0.8, 0.0], (60, 1)), np.zeros((60, 3))
    seen = np.stack([np.full(60, 0.01), np.full(60, 0.4), 0.1 * np.cos(time)], axis=1)
    forward = np.tile([0.0, 0.0, 1.0], (60, 1))
    knee = steadied(hip, seen, ankle, seen, forward, hinged=True)
    assert (knee[:, 2] > -1e-3).all()
    assert np.abs(np.diff(knee, axis=0)).max() < 0.03, "no jump where it turns"


def test_the_heel_of_a_foot_that_is_left_behind_rises_and_the_body_stays_up():
    """A body that goes 45 cm ahead of its right foot, which glides after it: over a flat foot it sinks by 12 cm."""
    positions = gliding(60, speed=0.0, sink=0.0)
    hip, knee, ankle, toe = (SMPL22.index(f"right_{part}") for part in ("hip", "knee", "ankle", "foot"))
    foot = positions[:, [ankle, toe]].copy()
    ahead = np.clip((np.arange(60) - 35) / 15, 0, 1)
    positions[..., 2] += 0.45 * ahead[:, None]
    glides = 0.15 * ahead[:, None] * [0.0, 0.0, 1.0]
    positions[:, knee], positions[:, ankle] = solve_two_bones(
        positions[:, hip], positions[:, knee], positions[:, ankle], foot[:, 0] + glides, np.array([0, 0, 1.0])
    )
    positions[:, toe] = positions[:, ankle] + foot[:, 1] - foot[:, 0]
    contacts = np.zeros((60, 4), bool)
    contacts[:, 2:] = True
    planted = plant_feet(positions, contacts)
    assert positions[-1, 0, 1] - planted[-1, 0, 1] < 0.04
    assert planted[-1, ankle, 1] > foot[0, 0, 1] + 0.05
    np.testing.assert_allclose(planted[-1, toe], foot[0, 1], atol=0.01)
    np.testing.assert_allclose(bone_lengths(planted), bone_lengths(positions), atol=1e-6)


def test_a_body_sinks_no_deeper_than_two_centimetres_for_feet_out_of_reach():
    high = gliding(60, speed=0.0, sink=0.0) + np.array([0, 0.5, 0])
    planted = plant_feet(high, np.ones((60, 4), bool))
    sunk = high[:, 0, 1] - planted[:, 0, 1]
    assert 0.01 < sunk.max() < 0.021
