"""The share of captions of motion that is read: ``python -m training.evaluate.reading_coverage CAPTIONS_FILE``.

The file has a caption a line, plain or packed (``.xz``, ``.gz``); 2,000 of them, always the same, are read.
"""

from __future__ import annotations

import argparse
import gzip
import json
import lzma
import random
import time
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from acts import read
from acts.reading.syntax import parse
from motion import InputError
from motion.formats.files import write_text
from training.core.shell import exit_code

SAMPLE = 2000
"""Captions that are read."""
_CONTENT = frozenset(("NOUN", "PROPN", "VERB", "ADV", "ADJ", "NUM"))


def sampled(file: Path, count: int = SAMPLE) -> list[str]:
    """Captions of a file, drawn with a fixed seed."""
    packed = {".xz": lzma.decompress, ".gz": gzip.decompress}.get(file.suffix, bytes)
    try:
        text = packed(file.read_bytes()).decode()
    except (OSError, EOFError, ValueError, lzma.LZMAError) as error:
        raise InputError(
            f"{file} holds no captions ({error}): give a text file, plain or packed (.xz, .gz)."
        ) from error
    captions = sorted({line.strip() for line in text.splitlines()} - {""})
    return random.Random(0).sample(captions, min(count, len(captions)))


def coverage(captions: Sequence[str]) -> dict[str, Any]:
    """The shares of captions, how long one takes, words left over by frequency, and each caption with what is read.

    Returns:
        ``whole``, the share of which every word with a meaning of its own is read, and an act at least; ``doubtful``,
        the share of which two parses say different acts; ``milliseconds``, the mean of a caption; ``left``, lemmas
        with how often they are left over; ``read``, for each caption its acts, what was not read, and the doubts.
    """
    read("They wave.")  # loads the parser
    left, rows, began = Counter[str](), [], time.perf_counter()
    plans = [read(caption) for caption in captions]
    seconds = time.perf_counter() - began
    for caption, plan in zip(captions, plans, strict=True):
        parts = [plan.text(part.words) for part in plan.unread]
        left.update(t.lemma_.lower() for part in parts for t in parse(part) if t.pos_ in _CONTENT)
        acts = [
            " ".join(filter(None, (*act.agents, act.polarity * (act.polarity == "not"), act.act, act.side)))
            for act in plan.acts
        ]
        doubts = [plan.text(doubt.words) for doubt in plan.doubts]
        rows.append({"caption": caption, "acts": acts, "unread": parts, "doubts": doubts})
    count = max(len(rows), 1)
    return {
        "whole": sum(bool(row["acts"]) and not row["unread"] for row in rows) / count,
        "doubtful": sum(bool(row["doubts"]) for row in rows) / count,
        "milliseconds": 1000 * seconds / count,
        "left": dict(left.most_common()),
        "read": rows,
    }


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(description="Counts what of people's captions the reader understands.")
    parser.add_argument("file", type=Path, help="captions, one a line")
    parser.add_argument("--out", type=Path, help="JSON file for each caption with its acts")
    options = parser.parse_args(argv)

    def job() -> None:
        result = coverage(sampled(options.file))
        if options.out:
            write_text(options.out, json.dumps(result, indent=1))
        words = ", ".join(f"{word} {count}" for word, count in list(result["left"].items())[:60])
        print(f"read whole {result['whole']:.1%}, two parses disagree {result['doubtful']:.1%}, ", end="")
        print(f"{result['milliseconds']:.0f} ms a caption\nwords left over: {words}")

    return exit_code(job)


if __name__ == "__main__":
    raise SystemExit(main())
