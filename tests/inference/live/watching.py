"""An agent's eye that sees what a test says, the body that it moves, and somebody who stands before it."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np

from motion.steering import Goal, Steering
from motion.transforms import heading_matrix
from tests.inference.people import waver
from webdemo.inference.pipelines.agent import Eye, Look

LABELS = ("nothing", "wave", "bow")
SENTENCES = ("They wait.", "Two people wave.", "Two people bow.")


class Scripted(Eye):
    """An eye that sees what a test says, one row of probabilities after the other; the last one goes on."""

    def __init__(self, *rows: tuple[float, ...]) -> None:
        self.rows = list(rows)
        self.recogniser = SimpleNamespace(config=SimpleNamespace(labels=LABELS, sentences=SENTENCES))

    def looks(self, positions: np.ndarray) -> list[Look]:
        assert len(positions) == 30
        return [Look(30, np.array(self.rows.pop(0) if len(self.rows) > 1 else self.rows[0]))]


class Recorded:
    """Stands before the person, and keeps which words it was given in which frame."""

    def __init__(self) -> None:
        self.frame = 0
        self.words: list[tuple[int, str]] = []
        self.goal: Goal | None = None
        self.steering = Steering()

    def take_words(self, prompt: str) -> None:
        self.words.append((self.frame, prompt))

    def step(self, pose: np.ndarray) -> np.ndarray:
        self.frame += 1
        return self.steering(STANDING @ heading_matrix(np.pi).T + [0, 0, 1.5], self.goal)


STANDING = waver(1.0).positions[0] @ heading_matrix(-np.radians(50)).T
STANDING = STANDING - STANDING[0] * [1, 0, 1]
NOTHING, MAYBE, WAVE, BOW = (1.0, 0.0, 0.0), (0.1, 0.5, 0.4), (0.02, 0.95, 0.03), (0.02, 0.02, 0.96)
