"""Blind pairs in a folder: sheets, choices that are final, and a key that opens last."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from motion import Duet, InputError
from motion.formats.files import write_text
from motion.metrics.sentences import Sentence, load_sentences
from motion.metrics.sentences.kept import Motions
from motion.metrics.sentences.scores import share

from .pages import pair_page

KEY, PAIRS, CHOICES = "key.json", "pairs.json", "choices.json"
PICKS = ("1", "2", "tie")
OLD, NEW = "old", "new"


@dataclass(frozen=True, eq=False)
class InPair:
    """Two motions of one sentence.

    Attributes:
        words: stand above the sheet.
        motions: each by its name, which only the key tells; one of them is :data:`NEW`.
        about: the key's further entries, such as the seed.
    """

    words: str
    motions: dict[str, Callable[[], Duet]] = field(repr=False)
    about: dict[str, Any]


def lay_out(pairs: Sequence[InPair], out: Path, rng: np.random.Generator) -> int:
    """Writes ``pair-NN.png``, the list of pairs and the key; ``rng`` draws which motion stands above.

    Returns:
        how many pairs there are.
    """
    out.mkdir(parents=True, exist_ok=True)
    key, shown = {}, {}
    for number, pair in enumerate(pairs, start=1):
        places = sorted(pair.motions)
        if rng.random() < 0.5:
            places.reverse()
        page = pair_page(f"{number}  {pair.words}", [pair.motions[name]() for name in places])
        page.save(out / f"pair-{number:02d}.png")
        key[str(number)] = {"1": places[0], "2": places[1], **pair.about}
        shown[str(number)] = pair.words
    _write(out / PAIRS, shown)
    _write(out / CHOICES, {})
    _write(out / KEY, key)
    return len(pairs)


def refuse_pairs(out: Path) -> None:
    """Raises InputError where a folder already holds pairs."""
    if (out / KEY).exists():
        raise InputError(f"{out.name} already holds pairs: name another folder.")


def make(old: Path, new: Path, out: Path, *, count: int = 60, seeds: int = 4, seed: int = 0) -> int:
    """Lays out pairs of two models.

    Args:
        old, new: folders of motions that ``training.evaluate.sentences`` or ``webdemo score`` has drawn.
        out: where the sheets go.
        count: pairs, at most; every sentence comes once before one comes twice.
        seeds: seeds of each sentence that are looked for in the folders.
        seed: draws the pairs and their order.

    Returns:
        how many pairs there are.

    Raises:
        InputError: if the folders share no motion, or ``out`` already holds pairs.
    """
    refuse_pairs(out)
    rng = np.random.default_rng(seed)
    folders = {OLD: Motions(old), NEW: Motions(new)}
    found = _pairs(folders[OLD], folders[NEW], seeds, rng)[:count]
    if not found:
        raise InputError(f"{old.name} and {new.name} have no sentence and seed in common: draw both first.")

    def reader(name: str, sentence: Sentence, drawn: int) -> Callable[[], Duet]:
        return lambda: folders[name].read(sentence, drawn)

    pairs = [
        InPair(
            sentence.words,
            {name: reader(name, sentence, drawn) for name in folders},
            {"sentence": sentence.id, "seed": drawn},
        )
        for sentence, drawn in found
    ]
    return lay_out(pairs, out, rng)


def _pairs(old: Motions, new: Motions, seeds: int, rng: np.random.Generator) -> list[tuple[Sentence, int]]:
    """(sentence, seed) of which both folders have a motion: every sentence once, then every one again, …"""
    sentences = load_sentences()
    both = {
        sentence.id: [
            int(drawn)
            for drawn in rng.permutation(seeds)
            if old.path(sentence, int(drawn)).is_file() and new.path(sentence, int(drawn)).is_file()
        ]
        for sentence in sentences
    }
    return [
        (sentences[i], both[sentences[i].id][turn])
        for turn in range(seeds)
        for i in rng.permutation(len(sentences))
        if turn < len(both[sentences[i].id])
    ]


def choose(folder: Path, picks: Sequence[str]) -> int:
    """Writes choices down; they stay as they are once written.

    Args:
        folder: of the pairs.
        picks: such as "7=1", "8=tie": the pair and which one is better.

    Returns:
        pairs that have no choice yet.

    Raises:
        InputError: for a pair that is not there or has its choice, or another word.
    """
    pairs, choices = _read(folder / PAIRS), _read(folder / CHOICES)
    for pick in picks:
        number, _, word = pick.partition("=")
        if number not in pairs or word not in PICKS:
            raise InputError(
                f"{pick!r} is no choice: write PAIR=1, PAIR=2 or PAIR=tie, pairs 1 to {len(pairs)}."
            )
        if choices.get(number, word) != word:
            raise InputError(f"Pair {number} has been chosen already ({choices[number]}): choices are final.")
        choices[number] = word
    _write(folder / CHOICES, choices)
    return len(pairs) - len(choices)


def reveal(folder: Path) -> dict[str, Any]:
    """Counts whose motions were chosen.

    Returns:
        pairs by the name of the motion that was chosen, and ``tie``; ``pairs``: a row each with the sentence, what
        else the key says, and the choice.

    Raises:
        InputError: before every pair has been chosen.
    """
    pairs, choices = _read(folder / PAIRS), _read(folder / CHOICES)
    open_pairs = [number for number in pairs if number not in choices]
    if open_pairs:
        raise InputError(
            f"{len(open_pairs)} pairs have no choice yet ({', '.join(open_pairs[:8])}): choose first."
        )
    key = _read(folder / KEY)
    names = sorted({entry[place] for entry in key.values() for place in ("1", "2")})
    rows = [
        {
            "pair": int(number),
            **{name: value for name, value in key[number].items() if name not in ("1", "2")},
            "chosen": key[number].get(word, "tie"),
        }
        for number, word in choices.items()
    ]
    counts = {name: sum(row["chosen"] == name for row in rows) for name in (*names, "tie")}
    return counts | {"pairs": rows}


def verdict(found: dict[str, Any]) -> str:
    """The result in one line: ties count for neither."""
    decided = sum(count for name, count in found.items() if name not in ("tie", "pairs"))
    return f"The new model's motion was chosen in {share(found[NEW], decided)}; {found['tie']} ties."


def _read(path: Path) -> dict[str, Any]:
    try:
        found = json.loads(path.read_text())
    except (OSError, ValueError) as error:
        raise InputError(f"{path.name} is missing or damaged: make the pairs again.") from error
    if not isinstance(found, dict):
        raise InputError(f"{path.name} holds no pairs: make them again.")
    return found


def _write(path: Path, content: dict[str, Any]) -> None:
    write_text(path, json.dumps(content, indent=1) + "\n")


def save_result(folder: Path, found: dict[str, Any]) -> None:
    """Writes what :func:`reveal` found beside the pairs."""
    _write(folder / "result.json", found)
