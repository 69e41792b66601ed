"""The virtual agent in front of a stream: ``python -m training.evaluate.live --data DIR``.

The recorded actors of the test lists of SBU and K3HI play as a stream: a second in their first pose, the clip, two
seconds in their last pose. Counted is what the agent answers first, and when. The offline agent decides on the same
frames; it weighs all looks since the start, and the live one those of the last three seconds.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from training.core.shell import exit_code
from training.corpus.pairs import load_pairs
from training.evaluate.reactions import DATASETS, SHORTEST
from training.trainers.recogniser import GESTURES
from webdemo.inference import Engine
from webdemo.inference.pipelines.live_agent import LiveAgent

Array = NDArray[np.floating]

FPS = 30
BEFORE, AFTER = 30, 60
"""Frames in the first and in the last pose."""


@dataclass(frozen=True)
class Answer:
    """The agent's answer to a clip.

    Attributes:
        label: the gesture; None where it was never sure.
        seconds: from the clip's start to the answer's.
        milliseconds: mean time of a frame.
    """

    label: str | None
    seconds: float
    milliseconds: float = 0.0


def as_stream(person: Array) -> Array:
    """A person (T, 22, 3) with stillness before and after."""
    return np.concatenate([np.repeat(person[:1], BEFORE, 0), person, np.repeat(person[-1:], AFTER, 0)])


def live(engine: Engine, person: Array) -> Answer:
    """The first answer to a person (T, 22, 3) who plays as a stream."""
    agent = engine.partner("agent")
    assert isinstance(agent, LiveAgent)
    stream = as_stream(person)
    began = time.perf_counter()
    for frame, pose in enumerate(stream):
        agent.step(pose)
        if agent.gesture is not None:
            spent = 1000 * (time.perf_counter() - began) / (frame + 1)
            return Answer(agent.labels[agent.gesture], (frame + 1 - BEFORE) / FPS, spent)
    return Answer(None, float("nan"), 1000 * (time.perf_counter() - began) / len(stream))


def offline(engine: Engine, person: Array) -> Answer:
    """The offline agent's decision on the same stream."""
    eye = engine.pipeline("agent").eye  # type: ignore[attr-defined]
    decision = eye.decide(eye.looks(as_stream(person)))
    label = eye.recogniser.config.labels[decision.place] if decision.sure else None
    return Answer(label, (decision.look.frame - BEFORE) / FPS)


def row(name: str, answers: Sequence[Answer], wanted: Sequence[str]) -> str:
    """A line of the table."""
    right = [a for a, label in zip(answers, wanted, strict=True) if a.label == label]
    silent = sum(a.label is None for a in answers)
    wrong = len(answers) - len(right) - silent
    when = f"{np.median([a.seconds for a in right]):.1f}" if right else "–"
    return f"| {name} | {len(answers)} | {len(right)} | {wrong} | {silent} | {when} |"


def main(arguments: Sequence[str] | None = None) -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(prog="python -m training.evaluate.live", description=__doc__)
    parser.add_argument("--data", type=Path, required=True, help="folder of the data sets")
    parser.add_argument("--cache", type=Path, help="folder that keeps what was read")
    options = parser.parse_args(arguments)
    engine = Engine()
    gesture_of = {family: label for label, (_, families) in GESTURES.items() for family in families}
    print("| data, agent | clips | right | wrong | no answer | median seconds to a right answer |")
    print("|---|---|---|---|---|---|")
    spent = []
    for key, name in DATASETS.items():
        scenes = [
            scene
            for scene in load_pairs(options.data, options.cache)
            if scene.sources[0].startswith(key) and scene.split != "train" and scene.family in gesture_of
            and scene.positions.shape[1] >= SHORTEST
        ]  # fmt: skip
        wanted = [gesture_of[scene.family] for scene in scenes]
        for kind, ask in (("live", live), ("offline", offline)):
            answers = [ask(engine, scene.positions[0]) for scene in scenes]
            spent += [answer.milliseconds for answer in answers if answer.milliseconds]
            print(row(f"{name}, {kind}", answers, wanted), flush=True)
    print(f"A live frame took {np.mean(spent):.1f} ms on average.")


if __name__ == "__main__":
    sys.exit(exit_code(main))
