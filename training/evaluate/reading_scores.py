"""The reading test: plans as the reader makes them beside those that a careful person wrote.

``python -m training.evaluate.reading_scores FILE`` prints numbers only, so that a sealed file stays unread.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from acts import Act, Plan, lexicon, read
from acts.reading.syntax import parse

from .plans import Act as Expected
from .plans import Reading, read_plans


@dataclass
class Scores:
    """Counts over a set.

    Attributes:
        sentences, whole: all, and those whose acts are all right, with none too many and nothing unread missed.
        expected, found: acts that the sentences have, and those that were read as they should be.
        extra: acts that were read and that no sentence has.
        unread, reported: parts that show nothing, and those of them that were reported.
        orders, ordered: relations between acts that were found, and those that the beats keep.
    """

    sentences: int = 0
    whole: int = 0
    expected: int = 0
    found: int = 0
    extra: int = 0
    unread: int = 0
    reported: int = 0
    orders: int = 0
    ordered: int = 0


def score(readings: Sequence[Reading], reader: Callable[[str], Plan] = read) -> Scores:
    """The counts of a reader on a set."""
    total = Scores()
    for reading in readings:
        plan = reader(reading.words)
        left = list(plan.acts)
        pairs: dict[int, Act] = {}
        for i, expected in enumerate(reading.acts):
            match = next((act for act in left if _same(expected, act, plan)), None)
            if match is not None:
                left.remove(match)
                pairs[i] = match
        reported = sum(_reported(words, plan) for words in reading.unread)
        level = {act.id: number for number, group in enumerate(plan.beats()) for act in group}
        for i, expected in enumerate(reading.acts):
            for kind, other in expected.order:
                if i in pairs and other in pairs:
                    total.orders += 1
                    total.ordered += _kept(kind, level[pairs[i].id], level[pairs[other].id])
        total.sentences += 1
        total.expected += len(reading.acts)
        total.found += len(pairs)
        total.extra += len(left)
        total.unread += len(reading.unread)
        total.reported += reported
        total.whole += len(pairs) == len(reading.acts) and not left and reported == len(reading.unread)
    return total


def _kept(kind: str, level: int, other: int) -> bool:
    if kind == "after":
        return level > other
    if kind == "until":  # what goes on until another act begins before it
        return level <= other
    return level < other if kind == "before" else level == other


def _same(expected: Expected, act: Act, plan: Plan) -> bool:
    entry = lexicon().entries[act.act]
    together = entry.mutual and set(act.agents) | {act.patient} >= {"a", "b"}
    if set(expected.agents) != set(act.agents) and not (together and len(expected.agents) == 2):
        return False
    if expected.patient is not None and expected.patient != act.patient and not together:
        return False
    if (expected.polarity, expected.modality) != (act.polarity, act.modality):
        return False
    if expected.side in ("left", "right") and expected.side != act.side:
        return False
    if expected.times is not None and expected.times > 1 and expected.times != act.times:
        return False
    return _verb_of(expected.verb) & _verbs(act, plan) != set()


def _verb_of(phrase: str) -> set[str]:
    tokens = parse(f"They {phrase}.")
    return {tokens[1].lemma_.lower(), phrase.split()[0].lower()} | ({phrase.split()[-1]} if " " in phrase else set())


def _verbs(act: Act, plan: Plan) -> set[str]:
    """Lemmas that name an act: of its words, and of the frames of its entry."""
    own = {token.lemma_.lower() for token in parse(plan.text(act.words))} if act.words is not None else set()
    known = lexicon()
    frames = {verb for verb, listed in known.frames.items() if any(name == act.act for name, _ in listed)}
    return own | frames


def _reported(words: str, plan: Plan) -> bool:
    start = plan.sentence.find(words)
    spans = [unread.words for unread in plan.unread]
    return any(span.start < start + len(words) and start < span.stop for span in spans) or bool(plan.notes)


def main(argv: Sequence[str] | None = None) -> None:
    """The command."""
    parser = argparse.ArgumentParser(description="Scores the reader of sentences on a file of plans.")
    parser.add_argument("file", type=Path)
    args = parser.parse_args(argv)
    print(json.dumps(vars(score(read_plans(args.file)))))


if __name__ == "__main__":
    main()
