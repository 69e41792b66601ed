"""Trains the virtual agent's gesture recogniser: ``python -m training.trainers.recogniser --corpus DIR --out DIR``.

Chopin's thesis, section 5.5.3: the recogniser classifies one second of a person's motion and the two seconds that a
predictor adds. As in the thesis, it is trained on predicted seconds, not on recorded ones. The person is the first
of a scene of :mod:`training.corpus`, the actor; the family of the scene is their gesture. The observed second begins
half a second into the scene or later, and may be its last.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
import torch.nn.functional as F
from torch import Tensor

from models.agent.recogniser import FPS, OBSERVED, PREDICTED, Recogniser, RecogniserConfig, sampled
from models.weights_io import save_network
from motion import InputError
from motion.transforms import mirrored
from training.core.loop import Loop, adamw
from training.core.shell import add_options, add_run_options, chosen, exit_code
from training.prepare import load_corpus
from webdemo.inference.engine import WEIGHTS
from webdemo.inference.pipelines.agent import Eye
from webdemo.inference.pipelines.predict_frame import to_last_pose
from webdemo.inference.pipelines.predictor import PredictorPipeline

NOTHING = "nothing"
GESTURES: dict[str, tuple[str, tuple[str, ...]]] = {
    NOTHING: ("Two people stand around and wait.", ("idle", "talk")),
    "bow": ("One person bows and the other bows back.", ("bow-back",)),
    "bump elbows": ("Two people bump elbows.", ("elbow-bump",)),
    "bump fists": ("Two people bump fists.", ("fist-bump",)),
    "call": ("One person calls the other, who walks up.", ("call-come",)),
    "cheer": ("Two people cheer together.", ("cheer",)),
    "dance": ("Two people dance together.", ("dance-mirrored", "dance-together", "dance-watch")),
    "hand over": ("One person hands something to the other.", ("hand-over", "exchange")),
    "help up": ("One person reaches down and helps the other up.", ("help-up",)),
    "high five": ("Two people give each other a high five.", ("high-five", "high-ten")),
    "hug": ("Two people hug.", ("hug",)),
    "kick": ("One person kicks and the other steps back.", ("kick", "kick-step-back")),
    "low five": ("Two people give each other a low five.", ("low-five",)),
    "pat": ("One person pats the other on the shoulder.", ("pat-shoulder", "hand-on-shoulder", "tap-turn")),
    "pat on the back": ("One person pats the other on the back.", ("pat-back",)),
    "point": ("One person points at the other.", ("point",)),
    "punch": ("One person punches and the other steps back.", ("punch", "punch-dodge", "punch-recoil")),
    "push": ("One person pushes the other, who stumbles back.", ("push",)),
    "raise a hand": ("One person raises a hand and the other does the same.", ("raise-copy", "raise-watch")),
    "run": ("Two people run together.", ("run-together", "chase")),
    "shake hands": ("Two people shake hands.", ("handshake",)),
    "sword": ("Two people fight with swords.", ("sword-fight", "sword-retreat")),
    "turn away": ("One person turns away from the other.", ("turn-away",)),
    "walk": ("Two people walk side by side.", ("walk-together", "walk-past", "follow", "make-way")),
    "walk away": ("Two people walk away from each other.", ("part", "leave", "depart")),
    "walk up": ("Two people walk up to each other.", ("meet", "walk-up", "approach")),
    "wave": ("One person waves and the other waves back.", ("wave-back", "goodbye")),
    "whisper": ("One person whispers something to the other.", ("whisper",)),
}
"""By gesture: the prompt of the response, and the families in which the first person makes it."""
SUMMARY = (
    "The virtual agent of Chopin's thesis (chapter 5): recognises a gesture from one observed second "
    "and two predicted ones, and lets InterGen respond. Research and non-commercial use only."
)
_CHUNK = 256
"""Windows that are predicted at once."""
LONGEST = 300
"""Most frames of a person that the agent uses."""
EARLIEST = 45
"""Frame of a scene at which the first observed second ends."""


@dataclass(frozen=True)
class Settings:
    """The settings of a run; a checkpoint of others is refused.

    windows: number of windows cut from each scene. seen: the input, as in table 5.2: "predicted" (an observed second
    and two predicted ones), "recorded" (three recorded seconds) or "known" (the observed second, its last pose held).
    """

    windows: int = 3
    seen: str = "predicted"
    batch: int = 128
    steps: int = 3000
    learning_rate: float = 1e-3
    warmup: int = 100
    weight_decay: float = 5e-2
    ema: float = 0.995
    noise: float = 0.005
    seed: int = 0

    def __post_init__(self) -> None:
        if self.seen not in ("predicted", "recorded", "known"):
            raise InputError(f"seen is {self.seen!r:.40}: give predicted, recorded or known.")


def cut(corpus: Path, settings: Settings, split: str, predictor: PredictorPipeline) -> tuple[Tensor, Tensor]:
    """Windows of a split's first people.

    Returns:
        (N, FRAMES, 22, 3) metres in the frame of the last observed pose, half of them mirrored, and labels (N,).

    Raises:
        InputError: if no scene with one of the gestures is long enough.
    """
    motions, index = load_corpus(corpus)
    label_of = {f: i for i, (_, families) in enumerate(GESTURES.values()) for f in families}
    rng = np.random.default_rng((settings.seed, split == "train"))
    places, labels = [], []
    for row in index:
        if row["split"] != split or row["family"] not in label_of or row["frames"] < EARLIEST:
            continue
        for end in rng.integers(EARLIEST, row["frames"] + 1, size=settings.windows):
            # A recording shorter than the three seconds is padded with its last pose.
            frames = np.minimum(end - OBSERVED + np.arange(OBSERVED + PREDICTED), row["frames"] - 1)
            places.append(row["start"] + frames)
            labels.append(label_of[row["family"]])
    if not places:
        raise InputError(f"{corpus} has no scenes of the {split} split with a known gesture.")
    found = []
    for i in range(0, len(places), _CHUNK):
        whole = motions[np.stack(places[i : i + _CHUNK]), 0].astype(np.float64)
        if settings.seen == "known":
            whole[:, OBSERVED:] = whole[:, OBSERVED - 1 : OBSERVED]
        if settings.seen == "predicted":
            whole[:, OBSERVED:] = predictor.predict(whole[:, :OBSERVED], PREDICTED)
        mirror = rng.random(len(whole)) < 0.5
        whole[mirror] = mirrored(whole[mirror])
        found.append(sampled(torch.from_numpy(to_last_pose(whole, OBSERVED - 1)[0]).float()))
    return torch.cat(found), torch.tensor(labels)


class Trainer(Loop):
    """One training run, which resumes from its checkpoint in ``out``.

    Args:
        data: of :func:`cut`.
    """

    def __init__(
        self, data: tuple[Tensor, Tensor], settings: Settings, out: Path, *, device: str = "cpu"
    ) -> None:
        self.settings, self.out, self.device = settings, out, device
        self.windows, self.labels = (x.to(device) for x in data)
        torch.manual_seed(settings.seed)
        config = RecogniserConfig(tuple(GESTURES), tuple(sentence for sentence, _ in GESTURES.values()))
        self.model, self.ema = (Recogniser(config).to(device) for _ in range(2))
        self.ema.load_state_dict(self.model.state_dict())
        self.ema.eval().requires_grad_(False)
        counts = torch.bincount(self.labels, minlength=len(GESTURES)).float()
        self.chances = (counts.clamp_min(1) ** -0.5)[self.labels]
        self.optimizer = adamw(self.model.parameters(), settings)
        self.restore(asdict(settings))

    def train_step(self) -> dict[str, float]:
        """One optimiser step; returns the loss and the share of the batch that is named right."""
        s = self.settings
        seed = int(np.random.SeedSequence((s.seed, self.step)).generate_state(1)[0])
        generator = torch.Generator().manual_seed(seed)
        rows = torch.multinomial(self.chances.cpu(), s.batch, replacement=True, generator=generator)
        windows = self.windows[rows] + s.noise * torch.randn(
            (s.batch, *self.windows.shape[1:]), generator=generator
        ).to(self.device)
        torch.manual_seed(seed)  # dropout
        self.model.train()
        logits = self.model(windows)
        loss = F.cross_entropy(logits, self.labels[rows], label_smoothing=0.05)
        self.optimizer_step(loss, self.optimizer, self.model.parameters())
        self.ema_update(self.ema.parameters(), self.model.parameters())
        right = (logits.argmax(1) == self.labels[rows]).float().mean()
        return {"loss": loss.item(), "right": right.item()}


def scores(model: Recogniser, windows: Tensor, labels: Tensor) -> dict[str, Any]:
    """Shares of windows whose gesture is named, and among the three likeliest; and by gesture.

    Every gesture counts the same in ``balanced``.
    """
    with torch.no_grad():
        ranked = torch.cat([model(part).argsort(1, descending=True) for part in windows.split(256)])
    right = ranked[:, 0] == labels
    by = {
        name: float(right[labels == i].float().mean())
        for i, name in enumerate(model.config.labels)
        if (labels == i).any()
    }
    return {
        "windows": len(labels),
        "named": float(right.float().mean()),
        "among three": float((ranked[:, :3] == labels[:, None]).any(1).float().mean()),
        "balanced": float(np.mean(list(by.values()))),
        "by gesture": {name: round(share, 3) for name, share in by.items()},
    }


def answered(corpus: Path, eye: Eye, count: int, *, seed: int = 0) -> dict[str, float]:
    """Scores the agent's decisions on the complete first people of test scenes.

    Args:
        corpus: folder of the corpus.
        eye: the agent's.
        count: scenes, drawn by ``seed``.

    Returns:
        ``scenes``; ``named``: the share whose gesture is the likeliest when the agent stops looking, sure of it
        or at the end, nothing included; and the mean second at which it ``stops``.
    """
    motions, index = load_corpus(corpus)
    place_of = {f: i for i, (_, families) in enumerate(GESTURES.values()) for f in families}
    rows = [row for row in index if row["split"] == "test" and row["family"] in place_of]
    rows = [rows[i] for i in np.random.default_rng(seed).permutation(len(rows))[:count]]
    right, seconds = [], []
    for row in rows:
        person = motions[row["start"] : row["start"] + min(row["frames"], LONGEST), 0]
        decision = eye.decide(eye.looks(person.astype(np.float64)))
        right.append((decision.place or 0) == place_of[row["family"]])
        seconds.append(decision.look.frame / FPS)
    return {
        "scenes": len(rows),
        "named": round(float(np.mean(right)), 3),
        "stops": round(float(np.mean(seconds)), 2),
    }


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(description="Train the virtual agent's recogniser.")
    add_options(parser, "corpus", "device")
    parser.add_argument("--predictor", type=Path, default=WEIGHTS / "motion-mlp", help="a predictor's folder")
    parser.add_argument("--export", type=Path, help="also write the trained network to this folder")
    parser.add_argument("--answered", type=int, default=300, help="test scenes on which the export decides")
    add_run_options(parser, Settings)
    options = parser.parse_args(argv)

    def job() -> None:
        settings, predictor = chosen(options, Settings), PredictorPipeline(options.predictor)
        trainer = Trainer(
            cut(options.corpus, settings, "train", predictor), settings, options.out, device=options.device
        )
        trainer.run_logged(minutes=options.minutes, every=100)
        found = scores(trainer.ema.cpu(), *cut(options.corpus, settings, "test", predictor))
        print(json.dumps(found))
        if options.export:
            measured = {name: round(found[name], 3) for name in ("named", "among three", "balanced")}
            save_network(
                options.export,
                trainer.ema,
                card={"summary": SUMMARY},
                trained_steps=trainer.step,
                test=measured,
            )
            print(json.dumps(answered(options.corpus, Eye(options.export, predictor), options.answered)))

    return exit_code(job)


if __name__ == "__main__":
    raise SystemExit(main())
