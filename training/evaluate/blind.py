"""Blind comparison of two models by people: ``python -m training.evaluate.blind``.

``make`` draws contact sheets of pairs, one motion of each model for the same sentence and seed, above each
other as 1 and 2 in an order drawn by chance; ``choose`` writes down which one does better what the sentence
says, before any name is known; ``reveal`` opens the key once every pair has been chosen.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from motion import InputError
from motion.formats.files import replacing
from motion.metrics.sentences import Sentence, load_sentences
from motion.metrics.sentences.kept import Motions
from motion.metrics.sentences.scores import share
from training.core.shell import exit_code
from webdemo.view.contact_sheet import contact_sheet

KEY, PAIRS, CHOICES = "key.json", "pairs.json", "choices.json"
PICKS = ("1", "2", "tie")
OLD, NEW = "old", "new"


def make(old: Path, new: Path, out: Path, *, count: int = 60, seeds: int = 4, seed: int = 0) -> int:
    """Writes ``pair-NN.png``, the list of pairs and the key.

    Args:
        old, new: folders of motions that ``training.evaluate.sentences`` has drawn.
        count: pairs, at most; every sentence comes once before one comes twice.
        seeds: seeds of each sentence that are looked for in the folders.
        seed: draws the pairs and their order.

    Returns:
        how many pairs there are.

    Raises:
        InputError: if the folders share no motion, or ``out`` already holds pairs.
    """
    if (out / KEY).exists():
        raise InputError(f"{out.name} already holds pairs: name another folder.")
    rng = np.random.default_rng(seed)
    pairs = _pairs(Motions(old), Motions(new), seeds, rng)[:count]
    if not pairs:
        raise InputError(f"{old.name} and {new.name} have no sentence and seed in common: draw both first.")
    out.mkdir(parents=True, exist_ok=True)
    key, shown = {}, {}
    for number, (sentence, drawn) in enumerate(pairs, start=1):
        places = [OLD, NEW] if rng.random() < 0.5 else [NEW, OLD]
        folders = {OLD: Motions(old), NEW: Motions(new)}
        sheets = [
            contact_sheet(
                folders[name].read(sentence, drawn),
                title=f"{number}.{place}  {sentence.words}",
                frames=9,
                tile=150,
            )
            for place, name in enumerate(places, start=1)
        ]
        _above_each_other(sheets).save(out / f"pair-{number:02d}.png")
        key[str(number)] = {"1": places[0], "2": places[1], "sentence": sentence.id, "seed": drawn}
        shown[str(number)] = sentence.words
    _write(out / PAIRS, shown)
    _write(out / CHOICES, {})
    _write(out / KEY, key)
    return len(pairs)


def _pairs(old: Motions, new: Motions, seeds: int, rng: np.random.Generator) -> list[tuple[Sentence, int]]:
    """(sentence, seed) of which both folders have a motion: every sentence once, then every one again, …"""
    sentences = load_sentences()
    found: list[tuple[Sentence, int]] = []
    order = {sentence.id: rng.permutation(seeds) for sentence in sentences}
    for turn in range(seeds):
        for i in rng.permutation(len(sentences)):
            sentence = sentences[i]
            drawn = int(order[sentence.id][turn])
            if old.path(sentence, drawn).is_file() and new.path(sentence, drawn).is_file():
                found.append((sentence, drawn))
    return found


def _above_each_other(sheets: Sequence[Image.Image]) -> Image.Image:
    page = Image.new("RGB", (max(s.width for s in sheets), sum(s.height for s in sheets)), (255, 255, 255))
    top = 0
    for sheet in sheets:
        page.paste(sheet, (0, top))
        top += sheet.height
    return page


def choose(folder: Path, picks: Sequence[str]) -> int:
    """Writes choices down; they stay as they are once written.

    Args:
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
        ``new``, ``old`` and ``tie``: pairs; ``pairs``: a row each with the sentence, the seed and the choice.

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
    rows = [
        {
            "pair": int(n),
            "sentence": key[n]["sentence"],
            "seed": key[n]["seed"],
            "chosen": key[n].get(word, "tie"),
        }
        for n, word in choices.items()
    ]
    return {name: sum(row["chosen"] == name for row in rows) for name in (NEW, OLD, "tie")} | {"pairs": rows}


def verdict(found: dict[str, Any]) -> str:
    """The result in one line: ties count for neither."""
    decided = found[NEW] + found[OLD]
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
    with replacing(path) as temporary:
        temporary.write_text(json.dumps(content, indent=1) + "\n")


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(prog="python -m training.evaluate.blind", description=__doc__)
    steps = parser.add_subparsers(dest="step", required=True)
    making = steps.add_parser("make", help="draw the sheets")
    making.add_argument("--old", type=Path, required=True, help="motions of the one model")
    making.add_argument("--new", type=Path, required=True, help="motions of the other")
    making.add_argument("--out", type=Path, required=True, help="folder for the sheets")
    making.add_argument("--count", type=int, default=60, help="pairs (60)")
    making.add_argument("--seed", type=int, default=0)
    choosing = steps.add_parser("choose", help="write choices down")
    choosing.add_argument("folder", type=Path)
    choosing.add_argument("picks", nargs="+", help="such as 7=1 8=2 9=tie")
    revealing = steps.add_parser("reveal", help="open the key and count")
    revealing.add_argument("folder", type=Path)
    options = parser.parse_args(argv)

    def job() -> None:
        if options.step == "make":
            made = make(options.old, options.new, options.out, count=options.count, seed=options.seed)
            print(f"{made} pairs in {options.out}; choose before you open {KEY}.")
        elif options.step == "choose":
            print(f"{choose(options.folder, options.picks)} pairs have no choice yet.")
        else:
            found = reveal(options.folder)
            _write(options.folder / "result.json", found)
            print(verdict(found))

    return exit_code(job)


if __name__ == "__main__":
    sys.exit(main())
