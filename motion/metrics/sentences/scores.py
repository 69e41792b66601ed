"""From motions of the sentences to shares that obey, by tag, with Wilson intervals."""

from __future__ import annotations

import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from motion import FPS, Duet, InputError
from motion.formats.files import replacing
from motion.metrics.generation import share
from motion.metrics.quality import PHYSICAL, physical

from .catalogue import Sentence

ALL = "all"


def score(sentences: Sequence[Sentence], duets: Sequence[Sequence[Duet]]) -> dict[str, Any]:
    """Counts the motions that follow their sentence.

    Args:
        duets: for every sentence one motion a seed, of SMPL's 22 joints; some may be missing.

    Returns:
        ``tags``: {tag: [motions that obey, motions]}, "all" first; ``other``: the same where every motion is
        judged by the sentence half the list away, which is what the rules leave to chance; ``sentences``: a
        row each with its verdicts and how often each condition is met, but none for sealed ones; ``conditions``:
        [met, all] over the motions, which moves before whole sentences do; ``any``: [sentences that one of their
        motions obeys, sentences]; ``physical``: means over all motions.
    """
    half = len(sentences) // 2
    tags: dict[str, list[int]] = {ALL: [0, 0]}
    other: dict[str, list[int]] = {ALL: [0, 0]}
    rows: list[dict[str, Any]] = []
    for i, (sentence, drawn) in enumerate(zip(sentences, duets, strict=True)):
        found = [sentence.judge(duet) for duet in drawn]
        _count(tags, sentence, [judgement.passed for judgement in found])
        strange = duets[(i + half) % len(sentences)] if half else ()
        _count(other, sentence, [sentence.judge(duet).passed for duet in strange])
        met = {rule: sum(dict(judgement.parts)[rule] for judgement in found) for rule in sentence.rule}
        rows.append(
            {
                "id": sentence.id,
                "words": sentence.words,
                "tags": list(sentence.tags),
                "passed": [judgement.passed for judgement in found],
                "met": met,
            }
        )
    motions = [duet for drawn in duets for duet in drawn]
    return {
        "tags": tags,
        "other": other,
        "sentences": [row for row, sentence in zip(rows, sentences, strict=True) if not sentence.sealed],
        "any": [sum(any(row["passed"]) for row in rows), len(rows)],
        "conditions": [
            sum(sum(row["met"].values()) for row in rows),
            sum(len(row["met"]) * len(row["passed"]) for row in rows),
        ],
        "physical": physical(motions) if motions else {},
    }


def _count(tally: dict[str, list[int]], sentence: Sentence, flags: Sequence[bool]) -> None:
    for tag in (ALL, *sentence.tags):
        entry = tally.setdefault(tag, [0, 0])
        entry[0] += sum(flags)
        entry[1] += len(flags)


def table(scores: Mapping[str, Any], beside: Mapping[str, Any] | None = None) -> str:
    """The scores as Markdown, with a column of other weights' scores where they are given."""
    heads = ["Sentences", "Obey (95 % interval)", *(["Before"] if beside else []), "Motion of other sentences"]
    lines = [scores["about"], "", f"| {' | '.join(heads)} |", "|---" * len(heads) + "|"]
    order = [ALL, *sorted(set(scores["tags"]) - {ALL})]
    for tag in order:
        passed, count = scores["tags"][tag]
        strange, strangers = scores["other"].get(tag, [0, 0])
        cells = [tag.replace("_", " "), share(passed, count)]
        cells += [share(*beside["tags"].get(tag, (0, 0)))] if beside else []
        cells += [f"{100 * strange / strangers:.0f} %" if strangers else "–"]
        lines.append(f"| {' | '.join(cells)} |")
    columns = [found["conditions"] for found in (scores, beside) if found]
    shown = [share(*column) for column in columns]
    lines.append(f"| single conditions of the rules | {' | '.join(shown)} | – |")
    columns = [found.get("any", (0, 0)) for found in (scores, beside) if found]
    shown = [share(*column) for column in columns]
    lines.append(f"| sentences that one of their motions obeys | {' | '.join(shown)} | – |")
    heads = ["Measure", "Generated", *(["Before"] if beside else [])]
    lines += ["", f"| {' | '.join(heads)} |", "|---" * len(heads) + "|"]
    for key, (label, unit) in PHYSICAL.items():
        columns = [found["physical"].get(key) for found in (scores, beside) if found]
        shown = ["–" if value is None else f"{value:.3g}" for value in columns]
        lines.append(f"| {label}, {unit} | {' | '.join(shown)} |")
    return "\n".join(lines) + "\n"


# ---- Kept motions, so that a run that was stopped goes on ------------------------------------------------------------
@dataclass(frozen=True)
class Motions:
    """A folder with one ``.npy`` of positions (2, T, 22, 3) for each sentence and seed.

    Attributes:
        folder: one for every model and sampling.
    """

    folder: Path

    def path(self, sentence: Sentence, seed: int) -> Path:
        """The file of a sentence; its name changes with the words and the length."""
        text = zlib.crc32(f"{sentence.words} {sentence.seconds}".encode())
        return self.folder / f"{sentence.id}-{text:08x}-{seed}.npy"

    def read(self, sentence: Sentence, seed: int) -> Duet:
        """One motion; raises InputError if it has not been generated or cannot be read."""
        path = self.path(sentence, seed)
        try:
            positions = np.load(path, allow_pickle=False)
        except (OSError, ValueError) as error:
            raise InputError(f"{path.name} is missing or damaged: draw the motions again.") from error
        return Duet.from_positions(positions, fps=FPS)

    def write(self, sentence: Sentence, seed: int, duet: Duet) -> None:
        """Keeps one motion."""
        with replacing(self.path(sentence, seed)) as temporary, temporary.open("wb") as file:
            np.save(file, duet.positions.astype(np.float32))
