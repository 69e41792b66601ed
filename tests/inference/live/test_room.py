"""The room of the live agent: what a person's complaint sends it to, and what it does there."""

from __future__ import annotations

import numpy as np
import pytest

from acts.staging.gestures import wrist
from acts.staging.poses import HANDS
from motion import SMPL22
from motion.kinematics import bone_lengths
from motion.skeleton import SIDES
from motion.transforms import heading_matrix
from motion.video.following import HIDDEN
from webdemo.inference.live.agent import BESIDE, LiveAgent
from webdemo.inference.live.room import BRIGHT, COLD, FRAMES, HOT, LOUD, PLACES, SMELLS, STANDS, Complaint, complaint

from .watching import NOTHING, STANDING, Recorded, Scripted

J = SMPL22.index
LONG = 400
PERSON = SMPL22.standing() - SMPL22.rest_positions()[0] * [1, 0, 1]


def bent(wrists: dict[str, np.ndarray], frames: int) -> np.ndarray:
    """(T, 22, 3) a person who faces +Z with wrists at (T, 3) from the pelvis; the others hang."""
    seen = np.repeat(PERSON[None], frames, axis=0)
    for side, out in (("left", 1.0), ("right", -1.0)):
        place = wrists.get(side, np.tile([0.25 * out, -0.1, 0.05], (frames, 1)))
        seen[:, J(f"{side}_wrist")] = seen[:, 0] + place
        middle = (seen[:, J(f"{side}_wrist")] + seen[:, J(f"{side}_shoulder")]) / 2
        seen[:, J(f"{side}_elbow")] = middle + np.array([0.12 * out, -0.1, 0.0])
    return seen


def gesture(hand: str, frames: int = 60) -> np.ndarray:
    """(T, 22, 3) a person who makes a gesture of the library with both hands."""
    towards = np.tile([0.0, 0.0, 1.0], (frames, 1))
    return bent({side: wrist(hand, side, np.arange(frames) / 30, towards) for side in SIDES}, frames)


def rubbing(speed: float = 2.0) -> np.ndarray:
    """Each hand on the other upper arm, going up and down it."""
    up = 0.06 * np.sin(2 * np.pi * speed * np.arange(60) / 30)
    found = bent({}, 60)
    for side, other in (("left", "right"), ("right", "left")):
        arm = (found[:, J(f"{other}_shoulder")] + found[:, J(f"{other}_elbow")]) / 2
        found[:, J(f"{side}_wrist")] = arm + np.stack([0 * up, up, 0.09 + 0 * up], axis=1)
        found[:, J(f"{side}_elbow")] = found[:, J(f"{side}_wrist")] + [0.2 if side == "left" else -0.2, -0.12, 0]
    for side, other in (("left", "right"), ("right", "left")):  # the arms have moved: once more
        arm = (found[:, J(f"{other}_shoulder")] + found[:, J(f"{other}_elbow")]) / 2
        found[:, J(f"{side}_wrist")] = arm + np.stack([0 * up, up, 0.05 + 0 * up], axis=1)
    return found


def fanning(rate: float = 2.0, wide: float = 0.12) -> np.ndarray:
    """A hand that goes to and fro before the neck, so many times a second."""
    swing = wide * np.sin(2 * np.pi * rate * np.arange(60) / 30)
    place = np.stack([-0.12 + swing, 0.42 + 0 * swing, 0.22 + 0 * swing], axis=1)
    return bent({"right": place}, 60)


def at_nose(
    *, since: int = 0, until: int = 60, aside: float = 0.0, rubs: float = 0.0, guard: bool = False
) -> np.ndarray:
    """The right hand at the nose in some of 60 frames, and hanging before and after; a guard has the left one up."""
    frames = np.arange(60)
    nose = np.tile([-0.04 - aside, 0.54, 0.2], (60, 1))
    nose[:, 1] += rubs * np.sin(2 * np.pi * 2.0 * frames / 30)
    held = ((frames >= since) & (frames < until))[:, None]
    hands = {"right": np.where(held, nose, [-0.25, -0.1, 0.05])}
    return bent(hands | ({"left": np.tile([0.2, 0.5, 0.25], (60, 1))} if guard else {}), 60)


@pytest.mark.parametrize(
    ("seen", "said"),
    [
        (at_nose(), SMELLS),
        (at_nose(since=34, until=54), None),
        (at_nose(rubs=0.04), None),
        (at_nose(aside=0.075), None),
        (at_nose(guard=True), None),
        (gesture("ears"), LOUD),
        (gesture("eyes"), BRIGHT),
        (rubbing(), COLD),
        (fanning(), HOT),
        (gesture("fans"), HOT),
        (fanning(rate=0.7, wide=0.24), None),
        (rubbing(speed=0.1), None),
        (bent({}, 60), None),
        (gesture("waves"), None),
        (gesture("claps"), None),
        (gesture("ears", FRAMES - 1), None),
    ],
)
def test_complaints_are_told_from_other_gestures(seen: np.ndarray, said: Complaint | None) -> None:
    turned = seen @ heading_matrix(2.0).T + [1.0, 0.0, -2.0]
    assert complaint(seen, 30) is said and complaint(turned, 30) is said


def watched(complaining: np.ndarray, *, frames: int = LONG, gaze=None) -> tuple[LiveAgent, np.ndarray, list[str]]:
    """The agent, its poses and its beliefs, before a person who complains for two seconds and then stands."""
    agent = LiveAgent(Scripted(NOTHING), Recorded())  # type: ignore[arg-type]
    agent.gaze = gaze
    poses, beliefs = [], []
    for index in range(frames):
        here = 30 <= index < 30 + len(complaining)
        poses.append(agent.step(complaining[index - 30] if here else STANDING))
        beliefs.append(agent.belief.text)
    return agent, np.stack(poses), beliefs


@pytest.mark.parametrize(
    ("seen", "said", "kind"), [(gesture("ears"), LOUD, "hi-fi"), (gesture("eyes"), BRIGHT, "window")]
)
def test_the_agent_goes_to_the_thing_uses_it_and_comes_back(seen: np.ndarray, said: Complaint, kind: str) -> None:
    agent, poses, beliefs = watched(seen)
    assert any(said.said in text and said.act in text for text in beliefs)
    (body,) = [thing for thing in agent.things if thing.kind == kind]
    away = np.linalg.norm((poses[:, 0] - body.places[0])[:, [0, 2]], axis=1)
    assert away[0] == pytest.approx(np.hypot(*PLACES[kind]), abs=0.05)
    assert away.min() < STANDS + 0.1 and away.min() > 0.4, "it stands before it"
    hands = poses[:, [J("left_wrist"), J("right_wrist")]]
    front = np.linalg.norm((hands - body.places[0])[..., [0, 2]], axis=-1).min()
    assert front < 0.42, "a hand is at it"
    assert np.ptp(bone_lengths(poses)[:, [joint - 1 for joint in HANDS]], axis=0).max() < 1e-6
    back = np.linalg.norm((poses[-1, 0] - STANDING[0])[[0, 2]])
    assert back <= BESIDE + 0.05, "it is with the person again"
    jumps = np.linalg.norm(np.diff(hands, axis=0), axis=-1)
    assert jumps.max() < 0.12, "no hand jumps"


def test_who_holds_their_nose_has_a_closed_window_opened() -> None:
    agent = LiveAgent(Scripted(NOTHING), Recorded())  # type: ignore[arg-type]
    agent.step(STANDING)
    assert agent._room is not None and not agent._room.wants(SMELLS), "it is open at first"
    agent._room.open["window"] = 0.0
    for index in range(400):
        agent.step(at_nose()[index] if index < 60 else STANDING)
    assert agent._room.open["window"] == 1.0


def test_curtains_move_while_hands_are_there_and_what_is_done_is_not_done_again() -> None:
    agent = LiveAgent(Scripted(NOTHING), Recorded())  # type: ignore[arg-type]
    seen = gesture("eyes")
    agent.step(STANDING)
    before = [thing.places.copy() for thing in agent.things if thing.kind == "curtain"]
    errands = 0
    for index in range(900):
        was = agent._room.errand
        agent.step(seen[index % 60] if index < 60 or 450 < index < 520 else STANDING)
        errands += was is None and agent._room.errand is not None
    after = [thing.places for thing in agent.things if thing.kind == "curtain"]
    apart = [float(np.linalg.norm(pair[0] - pair[1])) for pair in (before, after)]
    assert errands == 1 and apart[0] > 1.5 and apart[1] < 0.7


def test_who_speaks_to_others_sends_the_agent_nowhere() -> None:
    agent, poses, _ = watched(gesture("ears"), frames=150, gaze=HIDDEN)
    assert np.ptp(poses[:, 0], axis=0).max() < 1e-6 and agent._room.errand is None
