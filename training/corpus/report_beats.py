"""The report of a corpus' composed beats: ``python -m training.corpus.report_beats --corpus DIR --out DIR``.

Writes ``corpus-beats.md``, one row an act, and ``corpus/beats/ACT.webp``, a contact sheet of one beat each.
"""

from __future__ import annotations

import argparse
import re
import textwrap
from collections import Counter, defaultdict
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from motion import Duet
from motion.formats.files import replacing, write_text
from motion.metrics import foot_skate, jerk, penetration
from training.core.shell import add_options, exit_code
from training.prepare import load_corpus
from webdemo.view.contact_sheet import contact_sheet

from .cues import STILL, steps
from .phrasing import phrases
from .report import is_recorded, touch_gap
from .vocabulary import ANIMATED

FPS = 30.0
MEASURED = 250
"""Scenes of each kind that are measured."""
PICTURE_WIDTH = 640
_QUIET = {STILL, "join-side", "turn-to", "listen", "take-from", "stand-up", "walk-ahead"}
"""Acts that show in the picture of what the other does."""


def report(motions: NDArray[np.floating], index: list[dict[str, Any]], out: Path) -> str:
    """Writes the report of a corpus (see :func:`training.prepare.load_corpus`) and returns its Markdown."""
    scenes = [scene for scene in index if scene.get("beats")]
    done: dict[str, list[tuple[dict[str, Any], dict[str, Any]]]] = defaultdict(list)
    for scene in scenes:
        for beat in scene["beats"]:
            for act in set(beat["acts"]):
                done[act].append((scene, beat))
    pictures = out / "corpus" / "beats"
    pictures.mkdir(parents=True, exist_ok=True)
    rows = ["| Act | Beats | Minutes | Answers | Touching joints, cm | Beat |", "|---|---|---|---|---|---|"]
    for act, found in sorted(done.items()):
        minutes = sum(beat["end"] - beat["start"] for _, beat in found) / FPS / 60
        answers = Counter(_other(beat, act) for _, beat in found).most_common(3)
        gaps = [100 * gap for scene, beat in found[:20] if (gap := _touch(motions, scene, beat)) is not None]
        link = "–"
        if act not in _QUIET:
            _draw(motions, *min(found, key=lambda pair: _plainness(pair[1])), act, pictures)
            link = f"[sheet](corpus/beats/{_file(act)}.webp)"
        rows.append(
            f"| {act} | {len(found)} | {minutes:.1f} | {', '.join(name for name, _ in answers)} "
            f"| {f'{np.median(gaps):.0f}' if gaps else '–'} | {link} |"
        )
    text = "\n".join([*_head(motions, index, scenes), *rows, ""])
    write_text(out / "corpus-beats.md", text)
    return text


def _head(
    motions: NDArray[np.floating], index: list[dict[str, Any]], scenes: list[dict[str, Any]]
) -> list[str]:
    hours = sum(scene["frames"] for scene in scenes) / FPS / 3600
    numbers = Counter(sum(not beat["minor"] for beat in scene["beats"]) for scene in scenes)
    spread = ", ".join(f"{count} with {number}" for number, count in sorted(numbers.items()))
    made = sum(scene["frames"] for scene in scenes if any(s.startswith(ANIMATED) for s in scene["sources"]))
    joint, alone, single = (
        len(texts)
        for texts in (
            {c for scene in scenes for c in scene["captions"]},
            {c for scene in scenes for part in scene["alone"] for c in part},
            {c for scene in scenes for beat in scene["beats"] for c in beat["captions"]},
        )
    )
    entries = {name for cue in _acts(scenes) for group in steps(cue) for name, *_ in group}
    spoken = sum(len(phrases(name)) for name in entries)
    recorded = [scene for scene in index if is_recorded(scene)]
    measures = ["| | Foot skate, cm/s | Jerk, m/s³ | Penetration, cm |", "|---|---|---|---|"]
    walking = [s for s in scenes if all(a in _WALKS for beat in s["beats"] for a in beat["acts"])]
    kinds = (("scenes of beats", scenes), ("of these, walking only", walking), ("recorded duets", recorded))
    for name, kind in kinds:
        if kind:
            duets = [_duet(motions, s) for s in kind[:: max(len(kind) // MEASURED, 1)]]
            skate, shake, depth = np.mean(
                [(foot_skate(d).speed, jerk(d), penetration(d).mean) for d in duets], axis=0
            )
            measures.append(f"| {name} ({len(duets)}) | {skate:.1f} | {shake:.0f} | {depth:.2f} |")
    return [
        "# Scenes of beats",
        "",
        _wrapped(
            f"{len(scenes):,} scenes, {hours:.1f} hours: {spread} beats in the captions, transitions not counted. "
            f"There are {joint:,} different captions of both people, {alone:,} of one person alone and "
            f"{single:,} of single beats, made from {spoken} phrases of {len(entries)} entries of the lexicon. "
            f"{made / FPS / 3600:.1f} hours include hand-animated clips (Mesh2Motion, smoothed and slowed to "
            "what a body can do)."
        ),
        "",
        *measures,
        "",
        _wrapped(
            "An act is counted once per beat, no matter which person does it. *Answers* are what the other person "
            "does most often. *Touching joints* is the median distance of the joints that touch, at the moment "
            "when they are nearest. Every sheet shows one beat. `python -m training.corpus.report_beats` rebuilds "
            "this page."
        ),
        "",
    ]


_WALKS = {STILL, "walk-up", "walk-away", "part", "follow", "walk-together", "walk-around", "pace", "turn-to",
          "turn-away", "step-back", "step-forward", "step-aside", "walk-past", "join-side", "walk-ahead"}  # fmt: skip


def _acts(scenes: list[dict[str, Any]]) -> set[str]:
    return {act for scene in scenes for beat in scene["beats"] for act in beat["acts"]}


def _other(beat: dict[str, Any], act: str) -> str:
    return beat["acts"][1 - beat["acts"].index(act)]


def _plainness(beat: dict[str, Any]) -> tuple[bool, int]:
    """Beats in which the other stands, and short ones, show an act best."""
    return STILL not in beat["acts"], abs(beat["end"] - beat["start"] - 75)


def _touch(motions: NDArray[np.floating], scene: dict[str, Any], beat: dict[str, Any]) -> float | None:
    """Metres between the joints that touch in a beat, or None."""
    contacts = (scene.get("events") or {}).get("contact") or ()
    within = [c for c in contacts if beat["start"] <= c["start"] < beat["end"]]
    return touch_gap(_duet(motions, scene), within) if within else None


def _draw(
    motions: NDArray[np.floating], scene: dict[str, Any], beat: dict[str, Any], act: str, folder: Path
) -> None:
    duet = _duet(motions, scene, beat["start"], beat["end"])
    sheet = contact_sheet(duet, title=f"{act}: {(beat['captions'] or scene['captions'])[0]}", frames=6)
    sheet = sheet.resize((PICTURE_WIDTH, round(sheet.height * PICTURE_WIDTH / sheet.width)))
    with replacing(folder / f"{_file(act)}.webp") as temporary:
        sheet.save(temporary, "webp", quality=45)


def _file(cue: str) -> str:
    """The name of a cue's picture."""
    return re.sub("[^a-z-]", "-", cue)


def _duet(
    motions: NDArray[np.floating], scene: dict[str, Any], start: int = 0, stop: int | None = None
) -> Duet:
    first = scene["start"]
    part = np.array(motions[first + start : first + (stop or scene["frames"])], dtype=np.float32)
    return Duet.from_positions(part.swapaxes(0, 1), fps=FPS, roles=("actor", "reactor"))


def _wrapped(paragraph: str) -> str:
    return textwrap.fill(paragraph, 119, break_on_hyphens=False)


def main(argv: list[str] | None = None) -> int:
    """Runs the command; the exit status."""
    parser = argparse.ArgumentParser(
        description="Report the beats that a corpus holds, with a picture of each act."
    )
    add_options(parser, "corpus")
    parser.add_argument(
        "--out", type=Path, required=True, help="folder for corpus-beats.md and corpus/beats/"
    )
    options = parser.parse_args(argv)
    return exit_code(lambda: print(report(*load_corpus(options.corpus), options.out)))


if __name__ == "__main__":
    raise SystemExit(main())
