"""Blind pairs of recorded duets and the lab's motions of the same act and length.

Salsa is cut into windows of four to six seconds. A handshake of CMU and the clips of SBU are taken whole, since the
latter last one to three seconds: of each class those that last longest and that the corpus keeps.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from motion import Duet, InputError
from training.corpus.duet_acts import danced
from training.corpus.duets import SETS, read_takes
from training.corpus.pairs import build_scene
from training.corpus.sbu import CLASSES, read_sbu
from webdemo.inference.engine import Engine
from webdemo.inference.requests import GenerateRequest, Result

from .pairs import NEW, InPair, lay_out, refuse_pairs

Array = NDArray[np.floating]

RECORDED = "recorded"
FPS = 30.0
SALSA = 0.4
"""Share of the pairs that show salsa."""
SECONDS = (4.0, 6.0)
SENTENCES = {
    "salsa": "Two people dance salsa.",
    "handshake": "Two people shake hands.",
    "meet": "Two people walk up to each other.",
    "part": "Two people walk away from each other.",
    "approach": "One person walks up to the other.",
    "depart": "One person walks away from the other.",
    "kick": "One person kicks the other.",
    "push": "One person pushes the other.",
    "exchange": "One person hands the other an object.",
    "punch": "One person punches the other.",
}
"""Plain words for what each family of recordings shows."""


@dataclass(frozen=True, eq=False)
class Recorded:
    """A recorded duet.

    Attributes:
        source: data set and clip, and the first frame of a window.
        family: a key of :data:`SENTENCES`.
        people: (2, T, 22, 3) metres at 30 fps.
    """

    source: str
    family: str
    people: Array = field(repr=False)


def make_recorded(data: Path, out: Path, *, count: int = 40, seed: int = 0) -> int:
    """Lays out pairs of a recorded duet and the lab's motion.

    Args:
        data: holds the sets of :mod:`training.corpus.duets` and SBU.
        out: where the sheets go.
        count: pairs, at most.
        seed: draws windows, order and the lab's seeds.

    Returns:
        how many pairs there are.

    Raises:
        InputError: if nothing is recorded there, or ``out`` already holds pairs.
    """
    refuse_pairs(out)
    rng = np.random.default_rng(seed)
    duets = recorded_duets(data, count, rng)
    if not duets:
        raise InputError(f"{data.name} holds no duets: give the folder of {', '.join(SETS)} and sbu.")
    engine = Engine()
    pairs = [_pair(engine, duets[i], int(rng.integers(1000))) for i in rng.permutation(len(duets))]
    return lay_out(pairs, out, rng)


def _pair(engine: Engine, duet: Recorded, seed: int) -> InPair:
    words = SENTENCES[duet.family]
    return InPair(
        words,
        {
            RECORDED: lambda: Duet.from_positions(duet.people, fps=FPS),
            NEW: _generated(engine, words, duet.people.shape[1], seed),
        },
        {"sentence": duet.family, "source": duet.source, "seed": seed},
    )


def _generated(engine: Engine, words: str, frames: int, seed: int) -> Callable[[], Duet]:
    def motion() -> Duet:
        *_, result = engine.run(GenerateRequest(prompt=words, seconds=frames / FPS, seed=seed))
        assert isinstance(result, Result) and isinstance(result.duets[0], Duet)
        return Duet.from_positions(result.duets[0].positions[:, :frames], fps=FPS)

    return motion


def recorded_duets(data: Path, count: int, rng: np.random.Generator) -> list[Recorded]:
    """Up to ``count`` duets: windows of salsa, the handshakes of CMU, and SBU for the rest."""
    takes = list(read_takes(data))
    salsa = [take for take in takes if SETS[take.name.partition("/")[0]] == "salsa"]
    found = [Recorded(take.name, "handshake", take.people) for take in takes if take not in salsa]
    wanted = round(SALSA * count) if salsa else 0
    order = [i for _ in range(-(-wanted // max(len(salsa), 1))) for i in rng.permutation(len(salsa))]
    for i in order[:wanted]:
        first, last = danced(salsa[i].people)
        frames = min(round(rng.uniform(*SECONDS) * FPS), last - first)
        start = int(rng.integers(first, last - frames + 1))
        found.append(
            Recorded(f"{salsa[i].name}@{start}", "salsa", salsa[i].people[:, start : start + frames])
        )
    for clip in _sbu(data):
        if len(found) >= count:
            break
        found.append(clip)
    return found[:count]


def _sbu(data: Path) -> Iterator[Recorded]:
    """Fitted clips, one of each class in turn, the longest first; those that the corpus rejects are left out."""
    try:
        clips = sorted(read_sbu(data), key=lambda clip: (-clip.num_frames, clip.name))
    except InputError:
        return
    waiting = [[clip for clip in clips if clip.family == family] for family in CLASSES.values()]
    while any(waiting):
        for own in waiting:
            while own:
                clip = own.pop(0)
                if (scene := build_scene(clip)) is not None:
                    yield Recorded(f"sbu/{clip.name}", scene.family, scene.positions)
                    break
