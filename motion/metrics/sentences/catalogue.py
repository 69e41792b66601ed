"""The sentences, what a motion of each must show, the shares of motions that obey, and captions too near to one."""

from __future__ import annotations

import json
import re
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from motion import FPS, SMPL22, Duet, InputError
from motion.formats.files import replacing
from motion.metrics.generation import share
from motion.metrics.quality import PHYSICAL, physical

from .joints import Motion
from .language import check

SENTENCES = Path(__file__).with_name("sentences.json")
_MOST_BYTES = 2 * 2**20
ALIKE = 0.9
"""Share of words (Dice's coefficient) from which a caption is one of the sentences in other words."""
_EMPTY = frozenset({"a", "an", "the", "and", "then"})


@dataclass(frozen=True)
class Judgement:
    """The verdict of one sentence's rule on one motion.

    Attributes:
        passed: whether every condition is fulfilled.
        parts: (condition, whether it is fulfilled); of the two ways to cast the people the better one.
    """

    passed: bool
    parts: tuple[tuple[str, bool], ...]

    @property
    def share(self) -> float:
        """Conditions fulfilled, 0 to 1."""
        return sum(fulfilled for _, fulfilled in self.parts) / max(len(self.parts), 1)


@dataclass(frozen=True)
class Sentence:
    """One sentence.

    Attributes:
        id: a short name.
        words: the sentence.
        seconds: length of the motion that is asked for.
        tags: what is hard about it, such as "two_beats" or "refuse".
        named: whether the words say who is who ("person A", "the first person", "B"); where they do not,
            either person may do what either one does.
        ordered: whether the motion played backwards must fail.
        rule: conditions of :mod:`.language`, all of which must be fulfilled; () for one that is not judged.
        source: who wrote the words, where it was not this project.
        clauses: the parts of the words, one for each condition of the rule; () where the words are not divided.
        sealed: whether the words, the rule and their verdicts must not be shown; scores print numbers only.
    """

    id: str
    words: str
    seconds: float
    tags: tuple[str, ...]
    named: bool
    ordered: bool
    rule: tuple[str, ...]
    source: str = ""
    clauses: tuple[str, ...] = ()
    sealed: bool = False

    def judge(self, motion: Motion | Duet) -> Judgement:
        """The rule's judgement of a motion of SMPL's 22 joints."""
        if isinstance(motion, Duet):
            motion = Motion(motion.positions, motion.fps)
        judgements = [self._cast(motion)]
        if not self.named and not judgements[0].passed:
            judgements.append(self._cast(motion.swapped()))
        return max(judgements, key=lambda judgement: judgement.share)

    def _cast(self, motion: Motion) -> Judgement:
        parts = tuple((rule, check(rule, motion)) for rule in self.rule)
        return Judgement(all(fulfilled for _, fulfilled in parts), parts)


@cache
def load_sentences(path: Path = SENTENCES) -> tuple[Sentence, ...]:
    """All sentences, in the order of the file."""
    rows = json.loads(path.read_text(encoding="utf-8"))
    return tuple(Sentence(**row | {"tags": tuple(row["tags"]), "rule": tuple(row["rule"])}) for row in rows)


def read_sentences(path: Path) -> tuple[Sentence, ...]:
    """Sentences of somebody's own.

    Args:
        path: JSON in the form of ``sentences.json``, in which ``tags``, ``named``, ``ordered`` and ``rule`` may be left
            out, and ``clauses``, a list of [part of the words, condition], may stand in place of ``rule``; or text with
            a sentence a line, of which the known ones bring their rules along.

    Raises:
        InputError: if the file is missing, too large, or a sentence or rule in it cannot be read.
    """
    try:
        if path.stat().st_size > _MOST_BYTES:
            raise InputError(f"{path.name} is larger than {_MOST_BYTES // 2**20} MB: split it.")
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path} cannot be read ({type(error).__name__}): name a text or JSON file.") from None
    if path.suffix.lower() != ".json":
        known = {sentence.words: sentence for sentence in load_sentences()}
        lines = [line.strip() for line in text.splitlines() if line.strip()]
        rows = [{"words": line} for line in lines if line not in known]
        made = iter(_given(rows, path.name))
        sentences = [known.get(line) or next(made) for line in lines]
    else:
        try:
            rows = json.loads(text)
        except ValueError as error:
            raise InputError(f"{path.name} is not JSON ({error}): see docs/own-model.md.") from None
        sentences = _given(rows, path.name)
    if not sentences:
        raise InputError(f"{path.name} holds no sentences: write one a line.")
    return tuple(sentences)


def _given(rows: object, name: str) -> list[Sentence]:
    if not isinstance(rows, list) or not all(isinstance(row, dict) and row.get("words") for row in rows):
        raise InputError(f"{name} must be a list of objects that have `words`: see docs/own-model.md.")
    still = Motion(np.zeros((2, 30, SMPL22.num_joints, 3)) + SMPL22.rest_positions(), 30.0)
    made = []
    for i, row in enumerate(rows):
        try:
            row = {"id": f"sentence-{i + 1}", "seconds": 5.0, "named": False, "ordered": False} | row
            clauses = [(str(text), str(rule)) for text, rule in row.get("clauses", ())]
            rule = [rule for _, rule in clauses] or row.get("rule", ())
            row |= {"tags": tuple(row.get("tags", ())), "rule": tuple(rule)}
            sentence = Sentence(**row | {"clauses": tuple(text for text, _ in clauses)})
            if not all(text in sentence.words for text in sentence.clauses):
                raise ValueError("a clause is no part of its words")
            if not re.fullmatch(r"[\w-]{1,60}", sentence.id) or not 0 < float(sentence.seconds) <= 60:
                raise ValueError("its id or its seconds cannot be used")
            sentence.judge(still)
        except (TypeError, ValueError, IndexError, RecursionError) as error:
            why = "its fields or its rule are wrong" if row.get("sealed") else error
            raise InputError(f"Sentence {i + 1} of {name} cannot be used: {why}.") from None
        made.append(sentence)
    return made


# ---- captions ------------------------------------------------------------------------------------------
def _words(text: str) -> frozenset[str]:
    """The words of a sentence without articles, "and" and "then"."""
    return frozenset(re.findall(r"[a-z0-9']+", text.lower())) - _EMPTY


@cache
def _known(path: Path) -> tuple[tuple[str, frozenset[str]], ...]:
    return tuple((sentence.words, _words(sentence.words)) for sentence in load_sentences(path))


def kept_out(caption: str, path: Path = SENTENCES) -> str | None:
    """The sentence of a file, by default of the eighty, that a caption repeats, or None.

    A caption repeats a sentence where they share nine tenths of their words, articles, "and", "then", case,
    order and punctuation aside.
    """
    words = _words(caption)
    for sentence, known in _known(path):
        if 2 * len(words & known) >= ALIKE * (len(words) + len(known)):
            return sentence
    return None


# ---- scores --------------------------------------------------------------------------------------


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
        judgements = [sentence.judge(duet) for duet in drawn]
        _count(tags, sentence, [judgement.passed for judgement in judgements])
        strange = duets[(i + half) % len(sentences)] if half else ()
        _count(other, sentence, [sentence.judge(duet).passed for duet in strange])
        met = {rule: sum(dict(judgement.parts)[rule] for judgement in judgements) for rule in sentence.rule}
        rows.append(
            {
                "id": sentence.id,
                "words": sentence.words,
                "tags": list(sentence.tags),
                "passed": [judgement.passed for judgement in judgements],
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


def table(scores: Mapping[str, Any]) -> str:
    """The scores as Markdown."""
    lines = [scores["about"], "", "| Sentences | Obey (95 % interval) | Motion of other sentences |", "|---|---|---|"]
    order = [ALL, *sorted(set(scores["tags"]) - {ALL})]
    for tag in order:
        passed, count = scores["tags"][tag]
        strange, strangers = scores["other"].get(tag, [0, 0])
        chance = f"{100 * strange / strangers:.0f} %" if strangers else "–"
        lines.append(f"| {tag.replace('_', ' ')} | {share(passed, count)} | {chance} |")
    lines.append(f"| single conditions of the rules | {share(*scores['conditions'])} | – |")
    lines.append(f"| sentences that one of their motions obeys | {share(*scores['any'])} | – |")
    lines += ["", "| Measure | Generated |", "|---|---|"]
    for key, (label, unit) in PHYSICAL.items():
        value = scores["physical"].get(key)
        lines.append(f"| {label}, {unit} | {'–' if value is None else f'{value:.3g}'} |")
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
