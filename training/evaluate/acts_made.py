"""The acts of the lexicon that are made: each entry's first sentence as the lab makes it, judged by its own rule.

``python -m training.evaluate.acts_made`` prints those that are not made. The sentences stand in the lexicon beside the
shapes that make them, so the share says what the lab can do, and nothing about sentences of strangers.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from acts import lexicon, read
from webdemo.inference.requests import GenerateRequest
from webdemo.inference.run import Result

SECONDS = (4.0, 8.0)
"""The shortest and the longest motion that is made of an act."""


@dataclass(frozen=True)
class Made:
    """The verdict on an act's sentence.

    Attributes:
        act: its name in the lexicon.
        words: the sentence.
        done: whether the motion has it; None where the sentence was read as something else.
        measure: what was measured, in words.
    """

    act: str
    words: str
    done: bool | None
    measure: str = ""


def made(
    run: Callable[[GenerateRequest], Result], *, steps: int = 8, seed: int = 1, only: Collection[str] = ()
) -> Iterator[Made]:
    """The verdict on each act that is shown and has a rule.

    Args:
        run: makes a motion.
        steps: of denoising.
        seed: of every motion.
        only: these acts; all by default.
    """
    for name, entry in lexicon().entries.items():
        if not (entry.shown and entry.rule) or (only and name not in only):
            continue
        words, seconds = entry.reads[0], min(max(entry.seconds + 1, SECONDS[0]), SECONDS[1])
        if all(act.act != name for act in read(words).acts):
            yield Made(name, words, None)
            continue
        result = run(GenerateRequest(prompt=words, seconds=seconds, seed=seed, steps=steps))
        found = [each for each in result.manifest.get("checked", ()) if each["act"] == name]
        verdict = found[0] if found else {"done": None, "measure": ""}
        yield Made(name, words, verdict["done"], verdict["measure"])


def main(arguments: Sequence[str] | None = None) -> None:
    """Prints the acts that are not made, and how many are."""
    from webdemo.inference.engine import Engine

    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--steps", type=int, default=8)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, help="JSON file for all acts")
    options = parser.parse_args(arguments)
    engine = Engine()

    def run(request: GenerateRequest) -> Result:
        *_, result = engine.run(request)
        assert isinstance(result, Result)  # the last event of a run
        return result

    found: list[Made] = []
    for each in made(run, steps=options.steps, seed=options.seed):
        found.append(each)
        if not each.done:
            print(f"{each.act}: {each.words} {each.measure or 'read as something else' * (each.done is None)}")
    print(f"{sum(each.done is True for each in found)} of {len(found)} acts are made.")
    if options.out is not None:
        options.out.write_text(json.dumps([asdict(each) for each in found], indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
