"""A partner for a stream without an end: causal, without jumps, and an agent that answers only once it is sure."""

from __future__ import annotations

import numpy as np
import pytest

from motion.steering import Goal
from motion.transforms import heading, heading_matrix
from motion.video.following import HIDDEN, Gaze
from tests.inference.live.watching import BOW, MAYBE, NOTHING, SENTENCES, STANDING, WAVE, Recorded, Scripted
from tests.inference.people import waver
from tests.inference.test_reactor import bones_off, engine, folder
from webdemo.inference.engine import Engine
from webdemo.inference.live import partner_pipeline as live_partner
from webdemo.inference.live.agent import BACK, BESIDE, IGNORED, LEAVES, LEFT, LISTENS, LiveAgent
from webdemo.inference.live.partner_pipeline import ReactingPartner
from webdemo.inference.pipelines.agent import BETWEEN, FIRST

__all__ = ["engine", "folder"]


@pytest.fixture
def short_segments(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(live_partner, "SEGMENT", 40)
    monkeypatch.setattr(live_partner, "REPLAY", 12)


def answers(engine: Engine, person: np.ndarray, *, words_at: int | None = None, seed: int = 1) -> np.ndarray:
    partner = engine.partner("regennet", seed=seed)
    assert isinstance(partner, ReactingPartner)
    made = []
    for index, pose in enumerate(person):
        if index == words_at:
            partner.take_words("Two people wave.")
        made.append(partner.step(pose))
    return np.stack(made)


@pytest.mark.usefixtures("short_segments")
def test_no_frame_depends_on_a_later_one_over_several_segments(engine: Engine) -> None:
    person = waver(2.5).positions
    until = 63
    changed = person.copy()
    changed[until:] = changed[until:] @ heading_matrix(2.0).T + [0.4, 0.1, -0.8]
    first, second = answers(engine, person, words_at=45), answers(engine, changed, words_at=45)
    assert np.array_equal(first[:until], second[:until])
    assert not np.array_equal(first[until:], second[until:])
    assert np.array_equal(answers(engine, person, words_at=45), first)
    assert not np.array_equal(answers(engine, person, words_at=45, seed=2), first)


@pytest.mark.usefixtures("short_segments")
def test_a_new_segment_goes_on_where_the_last_one_was(engine: Engine) -> None:
    person = np.repeat(waver(2.0).positions, 2, axis=0)
    made = answers(engine, person)
    steps = np.linalg.norm(np.diff(made, axis=0), axis=-1).max(axis=1)[5:]  # at first it finds its place
    assert counted(engine, person) >= 5
    assert steps.max() < 1.5 * np.percentile(steps, 95) + 0.02
    assert np.isfinite(made).all() and bones_off(made) < 1e-6


def counted(engine: Engine, person: np.ndarray) -> int:
    """The number of segments that a person's stream takes."""
    partner = ReactingPartner(engine.pipeline("regennet"))  # type: ignore[arg-type]
    for pose in person:
        partner.step(pose)
    return partner._segments


@pytest.mark.usefixtures("short_segments")
def test_words_change_what_comes_after_them_alone(engine: Engine) -> None:
    person = waver(2.0).positions[:39]  # one segment
    without, words = answers(engine, person), answers(engine, person, words_at=20)
    assert np.array_equal(without[:22], words[:22]), "the replay of twelve frames takes two"
    assert not np.allclose(without[23:], words[23:], atol=1e-3)
    assert np.abs(np.diff(words, axis=0)[19:24]).max() < 0.1


def test_nobody_is_walked_through(engine: Engine, monkeypatch: pytest.MonkeyPatch) -> None:
    """The network's partner goes straight on through the person; the one that is shown stops before them."""
    monkeypatch.setattr(live_partner, "PUSHED", 100.0)
    person = np.repeat(waver(1.0).positions[:1], 90, axis=0)
    forward = person[0, 0] * [1, 0, 1]
    frames = iter(range(1000))

    def walks(self: object, pose: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return person[0] - forward + [0, 0, 2.0 - 0.05 * next(frames)] + forward, np.zeros(4)

    monkeypatch.setattr(live_partner.Segment, "step", walks)
    made = answers(engine, person)
    apart = (made[:, 0] - person[:, 0])[:, [0, 2]]
    assert apart[:, 1].min() == pytest.approx(live_partner.NEAREST, abs=1e-6)
    assert np.abs(np.diff(made, axis=0)).max() < 0.06


def watched(*rows: tuple[float, ...], frames: int) -> tuple[LiveAgent, Recorded, list[str]]:
    """The agent after it has watched somebody, what it was given, and its state in every frame."""
    partner = Recorded()
    agent = LiveAgent(Scripted(*rows), partner)  # type: ignore[arg-type]
    states = []
    for _ in range(frames):
        agent.step(STANDING)
        states.append(agent.belief.state)
    return agent, partner, states


def test_the_agent_answers_once_it_is_sure_and_not_before() -> None:
    agent, partner, states = watched(MAYBE, WAVE, WAVE, frames=FIRST + 2 * BETWEEN)
    (_, waits), (frame, answer) = partner.words
    assert (waits, answer) == (SENTENCES[0], SENTENCES[1])
    assert frame == FIRST + 2 * BETWEEN, "the third look was the first that was sure"
    assert states[: frame - 1] == ["watches"] * (frame - 1) and states[-1] == "answers"
    assert "wave" in agent.belief.text and agent.belief.chances[0][0] == "wave"
    _, partner, states = watched(MAYBE, frames=200)
    assert len(partner.words) == 1 and set(states) == {"watches"}, "it is never sure"


def test_a_second_gesture_interrupts_the_first() -> None:
    _, partner, _ = watched(WAVE, WAVE, BOW, BOW, frames=FIRST + 4 * BETWEEN)
    assert [words for _, words in partner.words] == [SENTENCES[0], SENTENCES[1], SENTENCES[2]]
    frames = [frame for frame, _ in partner.words]
    assert frames[2] - frames[1] == 2 * BETWEEN


AT_CAMERA = Gaze(np.array([1.0, 0, 0]), 0.95)
AT_AGENT = Gaze(np.array([0, 0, 1.0]), -0.3)
ELSEWHERE = Gaze(np.array([-1.0, 0, 0]), 0.1)


@pytest.mark.parametrize(
    ("gaze", "answers"), [(None, True), (AT_CAMERA, True), (AT_AGENT, True), (ELSEWHERE, False), (HIDDEN, False)]
)
def test_the_agent_answers_only_who_addresses_it(gaze: Gaze | None, answers: bool) -> None:
    partner = Recorded()
    agent = LiveAgent(Scripted(WAVE), partner)  # type: ignore[arg-type]
    agent.gaze = gaze
    for _ in range(FIRST + 3 * BETWEEN):
        agent.step(STANDING)
    assert (agent.belief.state, len(partner.words)) == (("answers", 2) if answers else ("ignored", 1))
    assert answers or "waits to be addressed" in agent.belief.text


def test_the_agent_forgets_what_was_meant_for_others_and_bears_a_short_look_aside() -> None:
    partner = Recorded()
    agent = LiveAgent(Scripted(WAVE), partner)  # type: ignore[arg-type]
    gazes = [ELSEWHERE] * 120 + [AT_CAMERA] * 60 + [ELSEWHERE] * (IGNORED - 5) + [AT_CAMERA] * 40
    states = []
    for gaze in [*gazes, *[ELSEWHERE] * 80]:
        agent.gaze = gaze
        agent.step(STANDING)
        states.append(agent.belief.state)
    began = states.index("answers")
    assert began >= 120 + LISTENS // 2 + BETWEEN, "two looks after it was addressed"
    assert set(states[began : len(gazes)]) == {"answers"}
    assert states[-1] == "ignored" and partner.words[-1][1] == SENTENCES[0]


def test_the_agent_leaves_who_ignores_it_and_comes_back() -> None:
    partner = Recorded()
    agent = LiveAgent(Scripted(NOTHING), partner)  # type: ignore[arg-type]
    turned = STANDING @ heading_matrix(np.pi).T
    apart, states = [], []
    for index in range(800):
        shown = agent.step(turned if 30 <= index < 500 else STANDING)
        apart.append(np.linalg.norm((shown[0] - STANDING[0])[[0, 2]]))
        states.append(agent.belief.state)
    assert states[29] == "watches" and "ignored" in states[30 : 30 + LEAVES]
    assert np.ptp(apart[: 30 + LEAVES]) < 1e-9, "at first it waits"
    assert states[499] == "left"
    assert apart[499] == pytest.approx(1.5 + LEFT, abs=0.2), "it goes, but not for ever"
    assert "left" in states[500 : 500 + BACK] and states[-1] == "watches"
    assert BESIDE - 0.2 < apart[-1] <= BESIDE


@pytest.mark.usefixtures("short_segments")
def test_a_partner_that_has_turned_answers_without_a_jump(engine: Engine) -> None:
    """New words while the partner is turned: what is shown goes on, and in the end is the network's own again."""
    person = np.repeat(waver(1.0).positions[:1], 200, axis=0)

    def steps(*, turned: bool) -> float:
        partner = engine.partner("regennet", seed=1)
        assert isinstance(partner, ReactingPartner)
        made, left = [], []
        for index, pose in enumerate(person):
            partner.goal = Goal(pose[0] + [4.0, 0, 0]) if turned and index < 100 else None
            if index == 100:
                partner.take_words("Two people wave.")
            made.append(partner.step(pose))
            left.append(abs(partner._steering.yaw))
        whole = np.stack(made)
        if turned:
            assert abs(heading(whole[99:100])[0] - np.pi / 2) < np.radians(60), "it has turned to the side"
            assert max(left[:100]) > 0.2 and min(left[150:]) < 1e-6, "and gives the turn back"
        assert np.isfinite(whole).all() and bones_off(whole) < 1e-6
        return float(np.linalg.norm(np.diff(whole, axis=0), axis=-1)[5:].max())

    assert steps(turned=True) < steps(turned=False) + 0.12, "12 cm a frame: a foot in the middle of its step"
