"""Prompts and actors that the page offers."""

from __future__ import annotations

from pathlib import Path

CLIPS = Path(__file__).resolve().parents[3] / "static" / "examples"
"""Folder of the example actors: motion files such as ``reach-out.npz``, one person or two each."""

EXAMPLES: tuple[tuple[str, str], ...] = (
    ("Handshake", "Two people walk up to each other and shake hands."),
    ("Cheer", "Two people cheer together."),
    ("High five", "Two people give each other a high five."),
    ("Hug", "One person walks up to the other and they hug."),
    ("Punch", "One person punches, and the other steps back."),
    ("Kick", "One person kicks and the other steps back."),
    ("Push", "One person pushes the other, who stumbles back."),
    ("Wave", "One person waves and the other waves back."),
    ("Hand over", "One person hands a book to the other."),
    ("Dance", "Two people dance together."),
)
"""(what the chip says, the prompt it puts into the box); each is one that the default model does well"""


def example_clips(folder: Path = CLIPS) -> list[tuple[str, Path]]:
    """(what the chip says, file) of every example actor, by name; empty where none are shipped."""
    return [(path.stem.replace("-", " ").capitalize(), path) for path in sorted(folder.glob("*.npz"))]
