"""The command ``gallery``: makes the scenes of the page's examples anew."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

from motion import Duet, InputError
from motion.formats.files import write_text
from webdemo.inference.requests import GenerateRequest
from webdemo.inference.requests.acting import acted

from .running import run

_TRIES = 4


def add_gallery(commands: Any) -> None:
    """Adds ``gallery`` to the shell's commands."""
    parser = commands.add_parser("gallery", help="make the scenes of the page's examples anew")
    parser.add_argument(
        "file",
        type=Path,
        nargs="?",
        default=Path("static/gallery/scenes.json"),
        help="JSON whose scenes have a prompt, seconds and a seed; it is written again",
    )
    parser.add_argument("--sheets", type=Path, metavar="FOLDER", help="also draw a contact sheet of each")
    parser.set_defaults(job=gallery)


def gallery(options: argparse.Namespace) -> dict[str, Any]:
    """Makes every scene of the file, and keeps the seed that does what is said and a thumbnail."""
    try:
        scenes = json.loads(options.file.read_text(encoding="utf-8"))["scenes"]
        asked = [(str(each["prompt"]), float(each["seconds"]), int(each["seed"])) for each in scenes]
    except (OSError, ValueError, KeyError, TypeError):
        raise InputError(f"{options.file} holds no scenes: each needs a prompt, seconds and a seed.") from None
    made = [_made(*one, sheet=_sheet(options.sheets, i)) for i, one in enumerate(asked)]
    lines = ",\n".join(json.dumps(each, ensure_ascii=False) for each in made)
    write_text(options.file, f'{{"scenes": [\n{lines}\n]}}\n')
    return {"files": [str(options.file)], "scenes": len(made)}


def _sheet(folder: Path | None, number: int) -> Path | None:
    if folder is not None:
        folder.mkdir(parents=True, exist_ok=True)
    return folder and folder / f"{number + 1:02d}.png"


def _made(prompt: str, seconds: float, seed: int, *, sheet: Path | None) -> dict[str, Any]:
    from webdemo.view.sheet import write_sheet
    from webdemo.view.thumbnail import thumbnail

    result = run(acted(GenerateRequest(prompt=prompt, seconds=seconds, seed=seed, tries=_TRIES)))
    duet = result.duets[0]
    assert isinstance(duet, Duet)
    if sheet is not None:
        write_sheet(duet, sheet, title=prompt)
    return {
        "prompt": prompt,
        "seconds": seconds,
        "seed": result.manifest.get("tries", {}).get("seed", seed),
        "thumbnail": thumbnail(duet),
    }
