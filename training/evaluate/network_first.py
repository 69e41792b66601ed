"""The acts that the network makes by itself: with its caption and places alone, judged by the act's own rule.

``python -m training.evaluate.network_first`` makes every act of the lexicon whose score gives poses, and gives the
network only the places of these: ways, headings and distances, at the instants at which they are planned. Zeros in the
place of all that the network makes show what a rule finds in places alone. An act is the network's where a wording
makes it with three of four seeds and zeros do not.
"""

from __future__ import annotations

import argparse
import json
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from acts import Act, Plan, lexicon, read
from acts.captions import worded
from acts.checking import checked
from acts.lexicon import Entry
from acts.shapes import Shape
from motion import Duet
from motion.formats.files import write_text
from training.core.shell import exit_code
from webdemo.inference.ablations import leave_places, silence
from webdemo.inference.pipelines.scene import Parts
from webdemo.inference.run import Result
from webdemo.inference.story.beats import Beat
from webdemo.inference.story.request import SceneRequest

PLACES = frozenset(("go", "turn", "stay", "place", "link"))
"""Shapes that give no poses."""
SEEDS, WANTED, WORDINGS = 4, 3, 3
"""Seeds of a wording, those of them that have to show the act, and wordings that are tried."""
SECONDS = (3.0, 6.0)
"""The shortest and the longest motion that is made of an act."""


@dataclass(frozen=True)
class Made:
    """What was found of an act. Where zeros show it, the rule says nothing of the network, and it is not tried.

    Attributes:
        act: its name in the lexicon.
        shapes: those of its score that give poses.
        words: the wording that did best.
        done: seeds that show the act with it.
        tried: seeds that were tried: no more than it takes to know.
        zeros: zeros with the same places show it already.
    """

    act: str
    shapes: tuple[str, ...]
    words: str
    done: int
    tried: int
    zeros: bool

    @property
    def by_network(self) -> bool:
        """True for an act that the network makes."""
        return self.done >= WANTED


def gives_poses(shape: Shape) -> bool:
    """True for a shape that gives poses; the others give places, or nothing."""
    return shape.do not in PLACES or bool(getattr(shape, "gait", ""))


def wordings(act: Act, entry: Entry) -> list[str]:
    """The captions of an act in words, those that fit its people first."""
    plain = [text for text in entry.caption if ("{a+b}" in text) == (len(act.agents) == 2)]
    listed = dict.fromkeys(worded(act, text.replace("{a+b}", "{a}")) for text in [*plain, *entry.caption])
    return [f"{text[:1].upper()}{text[1:]}." for text in listed]


def example(name: str, entry: Entry) -> Act | None:
    """The act as the entry's first sentence that has it says it, alone."""
    for sentence in entry.reads:
        for act in read(sentence).acts:
            if act.act == name and act.happens:
                return act.model_copy(update={"order": (), "words": None})
    return None


def found(run: Callable[[SceneRequest, bool], Duet], name: str, entry: Entry) -> Made | None:
    """What the network makes of an act; None where no sentence of its entry is read as it.

    Args:
        run: makes a motion, with zeros in the network's place if it is told so.
        name: of the act.
        entry: of the lexicon.
    """
    act = example(name, entry)
    if act is None:
        return None
    seconds = min(max(entry.seconds, SECONDS[0]), SECONDS[1])

    def shows(words: str, seed: int, zeros: bool) -> bool:
        beat = Beat(words=words, seconds=seconds, acts=(act,))
        duet = run(SceneRequest(beats=(beat,), seed=seed, steps=8), zeros)
        return bool(checked(Plan(acts=(act,)), duet)[0].done)

    shapes = tuple(dict.fromkeys(shape.do for shape in entry.stage if gives_poses(shape)))
    told = wordings(act, entry)[:WORDINGS]
    zeros = shows(told[0], 1, True)
    best = Made(name, shapes, told[0], 0, 0, zeros)
    for words in () if zeros else told:
        done = tried = 0
        while tried < SEEDS and done < WANTED and done + SEEDS - tried >= WANTED:
            tried += 1
            done += shows(words, tried, False)
        if not best.tried or done > best.done:
            best = Made(name, shapes, words, done, tried, zeros)
        if done >= WANTED:
            break
    return best


def table(made: Sequence[Made]) -> str:
    """The acts as Markdown, counted by shape, and the names of those that are the network's."""
    lines = ["| Shape | Acts | Zeros do | The network does |", "|---|---|---|---|"]
    count: dict[str, Counter[str]] = {}
    for each in made:
        for kind in (*each.shapes, "all"):
            row = count.setdefault(kind, Counter())
            row.update(acts=1, zeros=int(each.zeros), own=int(each.by_network))
    for kind, row in sorted(count.items(), key=lambda pair: (pair[0] == "all", -pair[1]["acts"])):
        lines.append(f"| {kind} | {row['acts']} | {row['zeros']} | {row['own']} |")
    names = ", ".join(each.act for each in made if each.by_network)
    return "\n".join(lines) + f"\n\nThe network's: {names or 'none'}.\n"


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", nargs="+", default=[], metavar="ACT", help="only these acts")
    parser.add_argument("--out", type=Path, help="JSON file for all acts")
    options = parser.parse_args(argv)
    return exit_code(lambda: _run(options))


def _run(options: argparse.Namespace) -> None:
    from webdemo.inference.engine import Engine

    engine = Engine()
    pipeline: Any = engine.pipeline("intergen")
    guided = pipeline.model.denoiser.guided
    pipeline.scenes.parts = Parts(0)  # zeros are not to be taken for what the network made

    def run(request: SceneRequest, zeros: bool) -> Duet:
        pipeline.model.denoiser.guided = guided
        if zeros:
            silence(pipeline)
        *_, result = engine.run(request)
        assert isinstance(result, Result) and isinstance(result.duets[0], Duet)
        return result.duets[0]

    made = list[Made]()
    leave_places(pipeline)
    for name, entry in lexicon().entries.items():
        given = entry.shown and entry.rule and any(map(gives_poses, entry.stage))
        if not given or (options.only and name not in options.only):
            continue
        each = found(run, name, entry)
        if each is not None:
            made.append(each)
            print(f"{name}: {'zeros' if each.zeros else f'{each.done} of {each.tried}'} ({each.words})", flush=True)
    print(table(made))
    if options.out is not None:
        write_text(options.out, json.dumps([asdict(each) for each in made], indent=1) + "\n")


if __name__ == "__main__":
    raise SystemExit(main())
