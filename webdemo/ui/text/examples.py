"""Prompts and actors that the page offers."""

from __future__ import annotations

from pathlib import Path

from .texts import STATIC

CLIPS = STATIC / "examples"
"""Folder of the example actors: motion files such as ``reach-out.npz``, one person or two each."""

ARRIVAL = "shake-hands.npz"
"""The example that plays before anything is asked for."""

EXAMPLES: tuple[tuple[str, str], ...] = (
    ("Handshake", "Two people walk up to each other and shake hands."),
    ("Hug", "One person walks up to the other and they hug."),
)
"""(what the chip says, the prompt it puts into the box); each is one that the default model does well"""


def example_clips() -> list[tuple[str, Path]]:
    """(what the chip says, file) of every example actor, by name; empty where none are shipped."""
    return [(path.stem.replace("-", " ").capitalize(), path) for path in sorted(CLIPS.glob("*.npz"))]
