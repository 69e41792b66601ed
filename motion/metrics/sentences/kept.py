"""A folder of motions of the sentences, so that a run that was stopped goes on."""

from __future__ import annotations

import zlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from motion import FPS, Duet, InputError
from motion.formats.files import replacing

from .catalogue import Sentence


@dataclass(frozen=True)
class Motions:
    """A folder with one ``.npy`` of positions (2, T, 22, 3) for each sentence and seed.

    Attributes:
        folder: one for every model and sampling.
    """

    folder: Path

    def path(self, sentence: Sentence, seed: int) -> Path:
        """The file of a sentence; its name changes with the words and the length."""
        text = zlib.crc32(f"{sentence.words} {sentence.seconds}".encode())
        return self.folder / f"{sentence.id}-{text:08x}-{seed}.npy"

    def read(self, sentence: Sentence, seed: int) -> Duet:
        """One motion; raises InputError if it has not been generated or cannot be read."""
        path = self.path(sentence, seed)
        try:
            positions = np.load(path, allow_pickle=False)
        except (OSError, ValueError) as error:
            raise InputError(f"{path.name} is missing or damaged: draw the motions again.") from error
        return Duet.from_positions(positions, fps=FPS)

    def write(self, sentence: Sentence, seed: int, duet: Duet) -> None:
        """Keeps one motion."""
        with replacing(self.path(sentence, seed)) as temporary, temporary.open("wb") as file:
            np.save(file, duet.positions.astype(np.float32))
