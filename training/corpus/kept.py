"""Clips that take minutes to make, kept in a file from one build to the next."""

from __future__ import annotations

import json
import logging
import zipfile
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from motion import InputError
from motion.formats.files import replacing

logger = logging.getLogger(__name__)
Clip = TypeVar("Clip")


def kept(path: Path, kind: Callable[..., Clip], make: Callable[[], list[Any]]) -> list[Clip]:
    """The clips that ``make`` gives, read from ``path`` where they were made before and the file is not damaged.

    Args:
        kind: their dataclass, with an array ``positions``; JSON can hold its other fields.
    """
    if path.exists():
        try:
            with np.load(path, allow_pickle=False) as stored:
                rows = json.loads(str(stored["rows"]))
                return [kind(positions=stored[str(number)], **row) for number, row in enumerate(rows)]
        except (zipfile.BadZipFile, EOFError, OSError, ValueError, KeyError, TypeError):
            logger.warning("%s is damaged; its clips are made again.", path)
    made = make()
    rows = [asdict(clip) for clip in made]
    arrays = {str(number): row.pop("positions") for number, row in enumerate(rows)}
    try:
        with replacing(path) as temporary, open(temporary, "wb") as file:
            np.savez(file, rows=np.array(json.dumps(rows)), **arrays)
    except InputError as error:
        logger.warning("The clips are made again next time: %s", error)
    return made
