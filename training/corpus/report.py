"""The report of a corpus in numbers and pictures: ``python -m training.corpus.report --corpus DIR --out DIR``.

Writes ``corpus.md``, one row a family, and ``corpus/FAMILY.webp``, a contact sheet of one scene a family.
"""

from __future__ import annotations

import argparse
import re
import textwrap
from collections import Counter, defaultdict
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from motion import SMPL22, Duet
from motion.formats.files import replacing, write_text
from motion.metrics import bone_drift, foot_skate, penetration
from training.core.shell import add_options, exit_code
from training.prepare import load_corpus
from webdemo.view.contact_sheet import contact_sheet

from .cues import Label

FPS = 30.0
MEASURED = 15
"""Scenes of a family that are measured."""
PICTURE_WIDTH = 960
RECORDED = ("sbu/", "k3hi/", "cmu-salsa/", "cmu-handshake/")
"""How the sources begin whose two people were recorded together."""
_LINE = 119
"""Characters of a line of prose."""


def touch_gap(duet: Duet, contacts: Sequence[dict[str, Any]]) -> float:
    """Metres between joints that touch where they are nearest, the largest over the contacts."""
    gaps = []
    for contact in contacts:
        between = slice(contact["start"], contact["end"] + 1)
        own, other = (
            person.positions[between, SMPL22.index(contact[role])]
            for person, role in zip((duet.a, duet.b), "ab", strict=True)
        )
        gaps.append(float(np.linalg.norm(own - other, axis=-1).min(initial=np.inf)))
    return max(gaps)


def report(motions: NDArray[np.floating], index: list[dict[str, Any]], out: Path) -> str:
    """Writes the report of a corpus (see :func:`training.prepare.load_corpus`) and returns its Markdown."""
    families: dict[str, list[dict[str, Any]]] = defaultdict(list)
    for scene in index:
        families[scene["family"]].append(scene)
    pictures = out / "corpus"
    pictures.mkdir(parents=True, exist_ok=True)
    rows = [_family(name, scenes, motions, pictures) for name, scenes in sorted(families.items())]
    text = "\n".join([*_head(rows, index), *_table(rows), "", *_acts_table(index), ""])
    write_text(out / "corpus.md", text)
    return text


class _Family(NamedTuple):
    """A row of the table: ``gap`` is the median distance in cm of joints that touch, None if none do."""

    name: str
    scenes: int
    test: int
    minutes: float
    captions: int
    drift: float
    skate: float
    overlap: float
    gap: float | None


def _family(
    name: str, scenes: list[dict[str, Any]], motions: NDArray[np.floating], pictures: Path
) -> _Family:
    """Measures a family and draws one of its scenes into ``pictures``."""
    chosen = scenes[:: max(len(scenes) // MEASURED, 1)][:MEASURED]
    duets = [_duet(motions, scene) for scene in chosen]
    contacts = [(scene.get("events") or {}).get("contact") for scene in chosen]
    gaps = [100 * touch_gap(d, c) for d, c in zip(duets, contacts, strict=True) if c]
    found = [(bone_drift(d), foot_skate(d).speed, penetration(d).mean) for d in duets]
    drift, skate, overlap = np.mean(found, axis=0)
    sheet = contact_sheet(duets[-1], title=f"{name}: {chosen[-1]['captions'][0]}", frames=6)
    sheet = sheet.resize((PICTURE_WIDTH, round(sheet.height * PICTURE_WIDTH / sheet.width)))
    with replacing(pictures / f"{name}.webp") as temporary:
        sheet.save(temporary, "webp", quality=60)
    return _Family(
        name=name,
        scenes=len(scenes),
        test=sum(scene["split"] == "test" for scene in scenes),
        minutes=sum(scene["frames"] for scene in scenes) / FPS / 60,
        captions=len({caption for scene in scenes for caption in scene["captions"]}),
        drift=drift,
        skate=skate,
        overlap=overlap,
        gap=float(np.median(gaps)) if gaps else None,
    )


def _table(rows: Sequence[_Family]) -> list[str]:
    lines = [
        "| Family | Scenes (test) | Minutes | Captions | Bone drift, % | Foot skate, cm/s | Penetration, cm "
        "| Touching joints, cm | Scene |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    for row in rows:
        gap = "–" if row.gap is None else f"{row.gap:.0f}"
        lines.append(
            f"| {row.name} | {row.scenes} ({row.test}) | {row.minutes:.1f} | {row.captions} | {row.drift:.2f} "
            f"| {row.skate:.1f} | {row.overlap:.2f} | {gap} | [sheet](corpus/{row.name}.webp) |"
        )
    return lines


def _head(rows: Sequence[_Family], index: list[dict[str, Any]]) -> list[str]:
    """The text above the table: sizes, means weighted by minutes, and how the corpus was split and measured."""
    minutes = np.array([row.minutes for row in rows])
    drift, skate, overlap = (
        np.average([getattr(row, key) for row in rows], weights=minutes)
        for key in ("drift", "skate", "overlap")
    )
    captions = {caption for scene in index for caption in scene["captions"]}
    return [
        "# The corpus",
        "",
        _wrapped(
            f"{len(index):,} scenes of {len(rows)} families, {minutes.sum() / 60:.1f} hours at "
            f"30 fps, with {len(captions):,} different captions. {_together(index)} "
            f"{_people(index)} Overall, bone drift is {drift:.2f} %, foot skate "
            f"{skate:.1f} cm/s and penetration {overlap:.2f} cm."
        ),
        "",
        _wrapped(
            "The test scenes are composed from recordings that no training scene uses, and the phrasings of "
            "their captions are held out too; but an action with fewer than six recordings has them in both "
            "splits. The data sets, the performers and the rules of composition are the same in both splits, so "
            "scores on the test split flatter a network."
        ),
        "",
        _wrapped(
            f"The measures come from up to {MEASURED} scenes per family. *Touching joints* is the median distance "
            "of the joints that touch, at the moment when they are nearest. Wrists that meet are 6 to 9 cm apart, "
            "and a joint of the trunk lies inside the body."
        ),
        "`python -m training.corpus.report` rebuilds this page.",
        "",
    ]


def is_recorded(scene: dict[str, Any]) -> bool:
    """True for a scene whose two people were recorded together."""
    return str((scene.get("sources") or [""])[0]).startswith(RECORDED)


def _together(index: list[dict[str, Any]]) -> str:
    """A sentence on what was recorded of two people."""
    recorded = [scene for scene in index if is_recorded(scene)]
    frames = sum(scene["frames"] for scene in recorded)
    share = 100 * frames / max(sum(scene["frames"] for scene in index), 1)
    return (
        f"{len(recorded):,} scenes ({frames / FPS / 60:.0f} minutes, {share:.1f} %) are recorded duets, cut into "
        "windows that may overlap; the others are composed from single-person recordings."
    )


def _people(index: list[dict[str, Any]]) -> str:
    """A sentence on how many performers the sources name."""
    found = {who for scene in index for source in scene.get("sources") or () for who in performers(source)}
    return f"The files name {len(found)} performers; some sets do not say who performs."


_PERFORMERS = (
    (r"accad_(Female1|Male1)_", "accad {}"),
    (r"cmu-(?:iclone_0|solo_)(\d\d)[_-]", "cmu {}"),
    (r"cmu-dance-martial_(indian|martial)", "cmu {}"),
    (r"perfume_([ABC])_", "perfume {}"),
)
"""Patterns of sources that name their performer."""


def performers(source: str) -> set[str]:
    """The people whom a source names; none where it names nobody.

    >>> sorted(performers("cmu-salsa/05"))
    ['cmu 60', 'cmu 61']
    """
    for pattern, name in _PERFORMERS:
        match = re.match(pattern, source)
        if match:
            return {name.format(match[1])}
    if source.startswith("cmu-salsa/"):
        return {"cmu 60", "cmu 61"}
    if source.startswith("cmu-handshake/"):
        return {"cmu 18", "cmu 19"}
    if source.startswith("sbu/"):
        return {f"sbu {number}" for number in re.findall(r"s(\d\d)", source.split("/")[1])}
    return set()


def _acts_table(index: list[dict[str, Any]]) -> list[str]:
    """One row an act of the lexicon: scenes, minutes, and how many of them are of recorded duets."""
    scenes: Counter[str] = Counter()
    frames: Counter[str] = Counter()
    real: Counter[str] = Counter()
    for scene in index:
        if not scene.get("label"):
            continue
        known = Label.of_row(scene["label"])
        scenes.update({act.act for act in known.plan.acts})
        for act in known.plan.acts:
            start, stop = known.spans[act.id]
            frames[act.act] += stop - start
            real[act.act] += (stop - start) * is_recorded(scene)
    lines = ["| Act | Scenes | Minutes | of these recorded duets |", "|---|---:|---:|---:|"]
    for name in sorted(scenes):
        minutes, recorded = (count[name] / FPS / 60 for count in (frames, real))
        lines.append(f"| {name} | {scenes[name]} | {minutes:.1f} | {recorded:.1f} |")
    return lines


def _wrapped(paragraph: str) -> str:
    return textwrap.fill(paragraph, _LINE, break_on_hyphens=False)


def _duet(motions: NDArray[np.floating], scene: dict[str, Any]) -> Duet:
    part = np.array(motions[scene["start"] : scene["start"] + scene["frames"]], dtype=np.float32)
    return Duet.from_positions(part.swapaxes(0, 1), fps=FPS, roles=("actor", "reactor"))


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(
        description="Report what a corpus holds, with a picture of every family."
    )
    add_options(parser, "corpus")
    parser.add_argument("--out", type=Path, required=True, help="folder for corpus.md and corpus/")
    options = parser.parse_args(argv)
    return exit_code(lambda: print(report(*load_corpus(options.corpus), options.out)))


if __name__ == "__main__":
    raise SystemExit(main())
