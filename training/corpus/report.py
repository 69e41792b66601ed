"""The contents of a corpus, in numbers and pictures: ``python -m training.corpus.report --corpus DIR --out DIR``.

Writes ``corpus.md``, one row an act of the lexicon, and ``corpus/ACT.png``, a contact sheet of a scene that shows it.
"""

from __future__ import annotations

import argparse
from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from motion import SMPL22, Duet
from motion.formats.files import write_text
from motion.metrics import foot_skate, jerk, penetration
from training.core.shell import add_options, exit_code
from training.prepare import load_corpus
from webdemo.view.sheet import write_sheet

from .cues import STILL, Label

FPS = 30.0
MEASURED = 250
"""Scenes of each kind that are measured."""
PICTURE_WIDTH = 640
RECORDED = ("sbu/", "k3hi/", "cmu-salsa/", "cmu-handshake/")
"""How the sources begin whose two people were recorded together."""


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


def is_recorded(scene: dict[str, Any]) -> bool:
    """True if the scene's two people were recorded together."""
    return any(source.startswith(RECORDED) for source in scene.get("sources") or ())


def report(motions: NDArray[np.floating], index: list[dict[str, Any]], out: Path) -> str:
    """Writes the report of a corpus (see :func:`training.prepare.load_corpus`) and returns its Markdown."""
    (out / "corpus").mkdir(parents=True, exist_ok=True)
    text = "\n".join([*_head(motions, index), *_acts_table(motions, index, out / "corpus"), ""])
    write_text(out / "corpus.md", text)
    return text


def _head(motions: NDArray[np.floating], index: list[dict[str, Any]]) -> list[str]:
    recorded = [scene for scene in index if is_recorded(scene)]
    frames, real = (sum(scene["frames"] for scene in part) for part in (index, recorded))
    captions = {caption for scene in index for caption in scene["captions"]}
    lines = [
        "# The corpus",
        "",
        f"{len(index):,} scenes, {frames / FPS / 3600:.1f} hours at {FPS:.0f} fps, {len(captions):,} different "
        f"captions; {sum(scene['split'] == 'test' for scene in index):,} scenes are for testing.",
        f"{len(recorded):,} scenes ({real / FPS / 60:.0f} minutes, {100 * real / max(frames, 1):.1f} %) are recorded "
        "duets.",
        "",
        "| | Foot skate, cm/s | Jerk, m/s³ | Penetration, cm |",
        "|---|---|---|---|",
    ]
    composed = [scene for scene in index if not is_recorded(scene)]
    for name, kind in (("composed", composed), ("recorded duets", recorded)):
        if kind:
            duets = [_duet(motions, scene) for scene in kind[:: max(len(kind) // MEASURED, 1)]]
            skate, shake, depth = np.mean(
                [(foot_skate(duet).speed, jerk(duet), penetration(duet).mean) for duet in duets], axis=0
            )
            lines.append(f"| {name} ({len(duets)}) | {skate:.1f} | {shake:.0f} | {depth:.2f} |")
    return [*lines, ""]


def _acts_table(motions: NDArray[np.floating], index: list[dict[str, Any]], pictures: Path) -> list[str]:
    """One row an act of the lexicon, done or only offered: scenes, minutes, those of recorded duets, and a sheet."""
    shown: dict[str, list[tuple[int, int, dict[str, Any]]]] = defaultdict(list)
    for scene in index:
        if scene.get("label"):
            known = Label.of_row(scene["label"])
            for act in known.plan.acts:
                name = act.act if act.modality == "told" else f"{act.act}-{act.modality}"
                shown[name].append((*known.spans[act.id], scene))
    lines = [
        "| Act | Scenes | Minutes | of these recorded duets | Touching joints, cm | Scene |",
        "|---|---:|---:|---:|---:|---|",
    ]
    for name, found in sorted(shown.items()):
        minutes, recorded = (
            sum(stop - start for start, stop, scene in found if not only or is_recorded(scene)) / FPS / 60
            for only in (False, True)
        )
        gaps = [100 * gap for start, stop, scene in found[:20] if (gap := _touch(motions, scene, start, stop))]
        link = "–"
        if name != STILL:
            # A short scene shows an act best.
            _draw(motions, min((scene for *_, scene in found), key=lambda one: one["frames"]), name, pictures)
            link = f"[sheet](corpus/{name}.png)"
        lines.append(
            f"| {name} | {len({scene['start'] for *_, scene in found})} | {minutes:.1f} | {recorded:.1f} "
            f"| {f'{np.median(gaps):.0f}' if gaps else '–'} | {link} |"
        )
    return lines


def _touch(motions: NDArray[np.floating], scene: dict[str, Any], start: int, stop: int) -> float | None:
    """Metres between the joints that touch while an act lasts, or None."""
    contacts = (scene.get("events") or {}).get("contact") or ()
    within = [contact for contact in contacts if start <= contact["start"] < stop]
    return touch_gap(_duet(motions, scene), within) if within else None


def _draw(motions: NDArray[np.floating], scene: dict[str, Any], name: str, folder: Path) -> None:
    title = f"{name}: {scene['captions'][0]}"
    write_sheet(_duet(motions, scene), folder / f"{name}.png", frames=6, width=PICTURE_WIDTH, title=title)


def _duet(motions: NDArray[np.floating], scene: dict[str, Any]) -> Duet:
    part = np.array(motions[scene["start"] : scene["start"] + scene["frames"]], dtype=np.float32)
    return Duet.from_positions(part.swapaxes(0, 1), fps=FPS, roles=("actor", "reactor"))


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(description="Report what a corpus holds, with a picture of every act.")
    add_options(parser, "corpus")
    parser.add_argument("--out", type=Path, required=True, help="folder for corpus.md and corpus/")
    options = parser.parse_args(argv)
    return exit_code(lambda: print(report(*load_corpus(options.corpus), options.out)))


if __name__ == "__main__":
    raise SystemExit(main())
