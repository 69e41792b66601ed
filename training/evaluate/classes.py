"""Scores of two people from a class: ``python -m training.evaluate.classes --scenes F --extractor F``.

Whether the class is seen in the motion: a linear classifier over the extractor's features, fitted on recorded
training scenes, names the class of what the engine makes, and of recorded test scenes beside it (the accuracy
of the thesis, section 4.4.4); their Fréchet distance; and the rules of :mod:`training.evaluate.judge` for touch,
distance and facing.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import torch
import torch.nn.functional as F
from torch import Tensor, nn

from motion import Duet, InputError
from motion.metrics.generation import frechet_distance
from training.core.shell import add_options, exit_code
from training.corpus.cues import class_of
from training.evaluate.extractor import Extractor, load_extractor
from training.evaluate.judge.prompts import real_duet
from training.evaluate.judge.report import PHYSICAL, score
from training.evaluate.judge.rules import CHECKS, Task
from training.evaluate.prediction import put_into
from training.prepare import Scenes, load
from training.trainers.bigraphdiff import of_classes
from webdemo.inference import GenerateRequest, Result
from webdemo.inference.engine import Engine
from webdemo.inference.methods import method

MODEL = "bigraphdiff"
BEST = 3


def features(extractor: Extractor, duets: Sequence[Duet]) -> Tensor:
    """(N, D) of duets."""
    return torch.stack([extractor.of_positions(torch.from_numpy(duet.positions)) for duet in duets])


def fit_classifier(seen: Tensor, labels: Tensor, count: int, *, steps: int = 600) -> nn.Linear:
    """A linear classifier of features (N, D) with labels (N,) among ``count``; the same for the same data."""
    torch.manual_seed(0)
    made = nn.Linear(seen.shape[1], count)
    optimizer = torch.optim.AdamW(made.parameters(), lr=3e-2, weight_decay=1e-3)
    for _ in range(steps):
        loss = F.cross_entropy(10 * made(seen), labels)
        optimizer.zero_grad(set_to_none=True)
        loss.backward()
        optimizer.step()
    return made.requires_grad_(False)


def accuracy(classifier: nn.Linear, seen: Tensor, labels: Tensor) -> tuple[float, float]:
    """Shares of features (N, D) whose label (N,) is the likeliest, and among the :data:`BEST` likeliest."""
    ranked = classifier(seen).argsort(dim=1, descending=True)[:, :BEST] == labels[:, None]
    return float(ranked[:, 0].float().mean()), float(ranked.any(1).float().mean())


def right_handed(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """The scenes as a class shows them: those in which the left hand leads are left out."""
    return [row for row in rows if row.get("hand") != "left"]


def tasks_of(scenes: Scenes, label: str, rng: np.random.Generator, count: int) -> list[Task]:
    """The tasks of motions of a class: the events of ``count`` recorded ones, drawn by ``rng``."""
    rows = right_handed([row for row in scenes.split("train") if class_of(row) == label])
    chosen = [rows[i] for i in rng.integers(len(rows), size=count)]
    return [
        Task(label, row["family"], row["events"] or {}, scenes.layout.num_frames(row["tokens"]))
        for row in chosen
    ]


def known_classes(scenes: Scenes, labels: Sequence[str]) -> Scenes:
    """The scenes whose class is one of the network's ``labels``.

    Raises:
        InputError: if the training or the test split has none, or a label has no right-handed training scene.
    """
    rows = [row for row in scenes.rows if class_of(row) in labels]
    found = Scenes(scenes.control, rows, scenes.layout)
    shown = {class_of(row) for row in right_handed(found.split("train"))}
    missing = sorted(set(labels) - shown)
    if missing or not right_handed(found.split("test")):
        lacks = f"no training scene of {', '.join(missing[:5])}" if missing else "no test scene of any class"
        raise InputError(f"There is {lacks}: score these weights on the corpus on which they were trained.")
    return found


def evaluate(
    scenes: Scenes,
    extractor: Extractor,
    engine: Engine,
    labels: Sequence[str],
    *,
    samples: int,
    **sampling: Any,
) -> dict[str, Any]:
    """All scores.

    Args:
        scenes: of the corpus.
        labels: names of the classes.
        samples: motions of each, all of the length of a recorded one of the class.
        sampling: fields of the requests, such as ``steps``.
    """
    scenes = known_classes(of_classes(scenes), labels)
    rng = np.random.default_rng(0)
    place = {label: i for i, label in enumerate(labels)}

    def recorded(split: str) -> tuple[list[Duet], Tensor]:
        rows = right_handed(scenes.split(split))
        where = torch.tensor([place[class_of(row)] for row in rows])
        return [real_duet(scenes, row) for row in rows], where

    duets, where = recorded("train")
    train = features(extractor, duets)
    classifier = fit_classifier(train, where, len(labels))
    duets, where = recorded("test")
    test = features(extractor, duets)
    found: dict[str, Any] = {
        **_tested(scenes),
        "real": {
            "accuracy": accuracy(classifier, test, where),
            "FID": frechet_distance(train[rng.permutation(len(train))[: len(test)]].numpy(), test.numpy()),
            **score(duets, [Task("", "", {}, 0)] * len(duets)),
        },
    }
    made, tasks = _generate(scenes, engine, labels, rng, samples=samples, **sampling)
    own = features(extractor, made)
    wanted_labels = torch.arange(len(labels)).repeat_interleave(samples)
    found["generated"] = {
        "accuracy": accuracy(classifier, own, wanted_labels),
        "FID": frechet_distance(own.numpy(), test.numpy()),
        **score(made, tasks),
    }
    missed = classifier(own).argmax(1) != wanted_labels
    found["missed"] = {
        label: int(missed[wanted_labels == i].sum())
        for label, i in place.items()
        if missed[wanted_labels == i].any()
    }
    return found


def _tested(scenes: Scenes) -> dict[str, list[str]]:
    """Classes of the test scenes, ``tested``, and those of them that share a recording with training scenes."""
    trained = {source for row in scenes.split("train") for source in row["sources"]}
    tested = right_handed(scenes.split("test"))
    return {
        "tested": sorted({class_of(row) for row in tested}),
        "known": sorted({class_of(row) for row in tested if trained & set(row["sources"])}),
    }


def _generate(
    scenes: Scenes,
    engine: Engine,
    labels: Sequence[str],
    rng: np.random.Generator,
    *,
    samples: int,
    **sampling: Any,
) -> tuple[list[Duet], list[Task]]:
    """``samples`` motions of each class, and what each of them should show."""
    made: list[Duet] = []
    tasks: list[Task] = []
    for label in labels:
        wanted = tasks_of(scenes, label, rng, samples)
        seconds = float(np.clip(round(2 * wanted[0].frames / 30) / 2, 2.0, 10.0))
        request = GenerateRequest(prompt=label, model=MODEL, seconds=seconds, samples=samples, **sampling)
        made += [
            d for e in engine.run(request) if isinstance(e, Result) for d in e.duets if isinstance(d, Duet)
        ]
        tasks += wanted
    return made, tasks


def table(found: dict[str, Any], about: str) -> str:
    """The scores as Markdown."""
    made, real = found["generated"], found["real"]
    lines = [about, "", "| Measure | Generated | Recorded test scenes |", "|---|---|---|"]
    for i, name in enumerate(("class recognised", f"class among the {BEST} likeliest")):
        lines.append(f"| {name} | {made['accuracy'][i]:.0%} | {real['accuracy'][i]:.0%} |")
    lines.append(f"| FID | {made['FID']:.3f} | {real['FID']:.3f} |")
    for check in CHECKS:
        passed, count = (made["checks"][check][key] for key in ("passed", "count"))
        if count:
            lines.append(
                f"| {check} as in a scene of the class | {passed / count:.0%} ({passed}/{count}) | – |"
            )
    for key, (label, unit) in PHYSICAL.items():
        lines.append(f"| {label}, {unit} | {made['physical'][key]:.3g} | {real['physical'][key]:.3g} |")
    lines += ["", f"Recorded test scenes show {len(found['tested'])} of the classes."]
    if found["known"]:
        lines.append(
            f"Those of {len(found['known'])} share a recording with training scenes, because there are too few "
            f"to hold one out: {'; '.join(found['known'])}."
        )
    if found["missed"]:
        worst = sorted(found["missed"].items(), key=lambda item: -item[1])[:8]
        named = "; ".join(f"{label} ({count})" for label, count in worst)
        lines += ["", f"Most often taken for another class: {named}."]
    return "\n".join(lines) + "\n"


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(description="Score two people from a class.")
    add_options(parser, "scenes", "weights")
    parser.add_argument(
        "--extractor", type=Path, required=True, help="of `python -m training.evaluate.extractor`"
    )
    parser.add_argument("--samples", type=int, default=4, help="motions of each class")
    parser.add_argument("--steps", type=int, default=25, help="DDIM steps")
    parser.add_argument(
        "--guidance", type=float, default=method(MODEL).default("guidance", GenerateRequest.guidance)
    )
    parser.add_argument("--damping", type=float, default=GenerateRequest.damping)
    parser.add_argument("--out", type=Path, help="JSON of all scores")
    parser.add_argument("--table", type=Path, help="Markdown page that the table is put into")
    options = parser.parse_args(argv)

    def job() -> None:
        from models.bigraphdiff.compact import load_folder

        model, source = load_folder(options.weights / MODEL)
        labels = model.config.labels
        sampling = {name: getattr(options, name) for name in ("steps", "guidance", "damping")}
        found = evaluate(
            load(options.scenes), load_extractor(options.extractor), Engine(options.weights), labels,
            samples=options.samples, **sampling,
        )  # fmt: skip
        about = (
            f"{len(labels)} classes, {options.samples} motions each, seed 0; DDIM-{options.steps}, guidance "
            f"{options.guidance:g}, damping {options.damping:g}, weights {source.digest[:12]}."
        )
        if options.out:
            options.out.write_text(json.dumps(found, indent=1) + "\n")
        page = table(found, about)
        if options.table:
            put_into(options.table, page, name="classes")
        print(page)

    return exit_code(job)


if __name__ == "__main__":
    raise SystemExit(main())
