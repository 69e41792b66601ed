"""Contacts against thirty motions in which a person marked on pictures of the bodies when they touch.

``tests/data/contacts.npz`` holds motions of the shipped model at 30 frames a second (``steps``: millimetres from
frame to frame, all motions one after the other) and for each the marked kind, first frame and end. Every fourth
frame was looked at, so that a mark is true to about 0.1 s. Where a hand is led or walked with, the marks say
that hands stay together though they drift up to 20 cm apart for moments; the measure does not.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from motion import Duet
from motion.metrics import contact_events

DATA = Path(__file__).resolve().parents[2] / "data" / "contacts.npz"
TOLERANCE = 6  # frames: 0.2 s
AGREE = 26


def _examples() -> list[tuple[Duet, str, int, int]]:
    stored = np.load(DATA)
    whole = np.cumsum(stored["steps"], axis=0, dtype=np.int16) / 1000
    motions = np.split(whole, np.cumsum(stored["frames"])[:-1])
    return [
        (Duet.from_positions(m.reshape(-1, 2, 22, 3).swapaxes(0, 1), fps=30), str(kind), int(start), int(stop))
        for m, kind, start, stop in zip(motions, stored["kind"], stored["start"], stored["stop"], strict=True)
    ]


def _agrees(duet: Duet, kind: str, start: int, stop: int) -> bool:
    """Whether there is one stretch of contact, of the marked kind where hands meet, at the marked time."""
    found = contact_events(duet)
    if kind == "none":
        return not found
    if kind == "hands" and [contact.kind for contact in found] != ["hands"]:
        return False
    touched = sorted({frame for contact in found for frame in range(contact.start, contact.stop)})
    one = bool(touched) and int(np.diff(touched).max(initial=1)) <= 3
    return one and abs(touched[0] - start) <= TOLERANCE and abs(touched[-1] + 1 - stop) <= TOLERANCE


def test_contacts_are_where_a_person_marked_them() -> None:
    examples = _examples()
    assert len(examples) == 30
    agreed = [_agrees(*example) for example in examples]
    assert sum(agreed) >= AGREE, np.flatnonzero(~np.array(agreed))


def test_a_handshake_is_one_contact() -> None:
    duet, kind, *_ = _examples()[-1]
    assert kind == "hands"
    assert [contact.label for contact in contact_events(duet)] == ["hand on hand"]
