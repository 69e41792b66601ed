"""Captions of a scene of beats: of both people together, and of each person separately."""

from __future__ import annotations

import re
import zlib
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from motion.metrics.sentences import kept_out

from ..beats.play import Beat
from ..wording import MANNERS
from .lexicon import Pair, options, phrases, sentences
from .voice import Cast, Voice, draw_cast, finished

Rng = np.random.Generator
FPS = 30
JOINT, ALONE, ONE_BEAT = 8, 3, 2
"""Numbers of captions of a scene, of each single person, and of each beat."""
HELD_OUT = 6
"""Percentage of the phrases and sentences reserved for captions of the test split."""
LASTING = {"hug", "hold-hands", "hand-in-hand", "walk-together", "walk-and-talk", "talk", "dance", "stand", "phone",
           "hands-on-hips", "fold-arms", "clap", "carousel", "cover-face", "hand-on-shoulder", "arm-around",
           "kneel", "sit"}  # fmt: skip
"""Acts whose duration a caption may state."""
QUIET = {"stand", "listen", "take", "walk-and-listen"}
"""Acts that a caption omits when the other person acts."""
_NUMBERS = ("zero", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten")
_LINKS = (
    "Then",
    "Then",
    "After that,",
    "Next,",
    "Afterwards,",
    "A moment later,",
    "And then",
    "Shortly after,",
)


def held_out(text: str) -> bool:
    """True if a phrase is reserved for captions of the test split."""
    return zlib.crc32(text.encode()) % 100 < HELD_OUT


@dataclass
class _Draft:
    """An unfinished caption, and whether it uses words of the test split."""

    voice: Voice
    test: bool = False


class Narrator:
    """Writes the captions of one scene.

    Args:
        beats: the beats of the scene, in order.
        split: "train" or "test": a test caption uses a phrase that no training caption uses.
    """

    def __init__(self, rng: Rng, beats: Sequence[Beat], split: str) -> None:
        self.rng, self.beats, self.split = rng, list(beats), split

    # ---- both -------------------------------------------------------------------------------------------
    def together(self, count: int) -> list[str]:
        """Up to ``count`` different captions of the whole scene."""
        return self._collect(count, self._joint)

    def alone(self, person: int, count: int) -> list[str]:
        """Up to ``count`` different captions of what one person does."""
        return self._collect(count, lambda: self._single(person))

    def beat(self, index: int, count: int) -> list[str]:
        """Up to ``count`` different captions of one beat."""
        return self._collect(count, lambda: self._one_beat(index))

    def _collect(self, count: int, write) -> list[str]:
        found: dict[str, None] = {}
        for _ in range(12 * count):
            draft, text = write()
            if not text or draft.voice.failed or draft.test != (self.split == "test"):
                continue
            text = finished(text)
            if len(text) > 320 or kept_out(text):
                continue
            found.setdefault(text)
            if len(found) == count:
                break
        return list(found)

    def _pick(self, draft: _Draft, items: Sequence[str]) -> str:
        """Picks one phrase; a training caption avoids held-out ones if there are others."""
        chosen = items[int(self.rng.integers(len(items)))]
        for _ in range(6):
            if self.split == "test" or not held_out(chosen):
                break
            chosen = items[int(self.rng.integers(len(items)))]
        draft.test |= held_out(chosen)
        return chosen

    def _chosen_beats(self) -> list[Beat]:
        """The beats that this caption describes; half of the transitions are left out."""
        chosen = [beat for beat in self.beats if not beat.minor or self.rng.random() < 0.5]
        return chosen or self.beats

    def _draft(self, cast: Cast | None = None) -> _Draft:
        return _Draft(Voice(self.rng, cast or draw_cast(self.rng)))

    def _joint(self) -> tuple[_Draft, str]:
        chosen = self._chosen_beats()
        draft = self._draft()
        kind = self.rng.random()
        if len(chosen) > 1 and kind < 0.3:
            text = self._whole(draft, chosen)
            if text:
                return draft, text
        if kind < 0.36:
            text = self._keywords(draft, chosen)
            if text:
                return draft, text
        if len(chosen) > 1 and kind < 0.62:
            return draft, self._chained(draft, chosen)
        return draft, self._sentences(draft, chosen)

    def _whole(self, draft: _Draft, chosen: list[Beat]) -> str:
        """A sentence written for just this sequence of beats."""
        found = []
        for a in (0, 1):
            acts = tuple((beat.acts[a], beat.acts[1 - a]) for beat in chosen)
            found += [(text, a) for text in _written(acts)]
        if not found:
            return ""
        text, a = found[int(self.rng.integers(len(found)))]
        draft.test |= held_out(text)
        draft.voice.sides = chosen[-1].sides
        return draft.voice.sentence(options(text, self._known(chosen[-1], a)), a)

    def _known(self, beat: Beat, person: int) -> bool:
        return beat.sides[person] in ("left", "right") and self.rng.random() < 0.6

    def _keywords(self, draft: _Draft, chosen: list[Beat]) -> str:
        nouns = []
        for beat in chosen:
            known = phrases().get(beat.acts[beat.first])
            if known is None or not known.nouns:
                return ""
            nouns.append(self._pick(draft, known.nouns))
        link = (", then ", " and then ", ", ", " followed by ")[int(self.rng.integers(4))]
        return link.join(nouns)

    def _sentences(self, draft: _Draft, chosen: list[Beat]) -> str:
        """A clause a beat, joined by words of time."""
        text = ""
        for k, beat in enumerate(chosen):
            clause = self._clause(draft, beat)
            if not clause:
                return ""
            if k == 0:
                text = clause
                continue
            draw = self.rng.random()
            if draw < 0.35 and "." not in text.rsplit(". ", 1)[-1].rstrip(".") and len(text) < 110:
                link = (", then ", ", and then ", " and then ", ", and after that ", "; then ", " before ")[
                    int(self.rng.integers(5))
                ]
                text = text.rstrip(".") + link + _lower(clause)
            else:
                link = _LINKS[int(self.rng.integers(len(_LINKS)))]
                if k == len(chosen) - 1 and self.rng.random() < 0.3:
                    link = "Finally," if k > 1 else "In the end,"
                start = f"{link} {_lower(clause)}" if self.rng.random() < 0.8 else clause
                text = f"{text.rstrip('.')}. {start}"
        return text

    def _chained(self, draft: _Draft, chosen: list[Beat]) -> str:
        """One subject that does one thing after the other: "A walks up, shakes B's hand and leaves"."""
        firsts = [beat.first for beat in chosen]
        joint = [beat.acts[0] == beat.acts[1] for beat in chosen]
        voice = draft.voice
        if all(joint) and all(phrases()[beat.acts[0]].both for beat in chosen):
            parts = []
            subject = voice.group()
            for beat in chosen:
                voice.sides = beat.sides
                parts.append(self._both(draft, beat, "plural"))
            return f"{subject} {_listed(self.rng, parts)}"
        who = firsts[0]
        if any(first != who and not same for first, same in zip(firsts, joint, strict=True)):
            return self._sentences(draft, chosen)
        subject = voice.name(who)
        parts = []
        for beat in chosen:
            voice.sides = beat.sides
            parts.append(self._does(draft, beat, who, "s"))
        text = f"{subject} {_listed(self.rng, parts)}"
        last = chosen[-1]
        if last.acts[1 - who] not in QUIET and not joint[-1]:
            link = " while " if last.relation == "while" else " and "
            text += f"{link}{voice.name(1 - who)} {self._does(draft, last, 1 - who, 's')}"
        elif self.rng.random() < 0.3 and last.acts[1 - who] == "stand":
            text += f" while {voice.name(1 - who)} {self._does(draft, last, 1 - who, 's')}"
        return text

    # ---- one beat ---------------------------------------------------------------------------------------
    def _one_beat(self, index: int) -> tuple[_Draft, str]:
        draft = self._draft()
        return draft, self._clause(draft, self.beats[index])

    def _clause(self, draft: _Draft, beat: Beat) -> str:
        """A sentence on one beat: one written by hand, or one of the grammar."""
        voice = draft.voice
        voice.sides = beat.sides
        if self.rng.random() < 0.5:
            found = [
                (text, a)
                for a in ((0, 1) if beat.acts[0] == beat.acts[1] else (beat.first, 1 - beat.first))
                for text in _written(((beat.acts[a], beat.acts[1 - a]),))
                if len(self.beats) == 1 or _NAMED.search(text)  # people of its own would stay for a scene
            ]
            if found:
                text, a = found[int(self.rng.integers(len(found)))]
                draft.test |= held_out(text)
                return voice.sentence(options(text, self._known(beat, a)), a)
        one, other = beat.first, 1 - beat.first
        entry = phrases()[beat.acts[one]]
        same = beat.acts[0] == beat.acts[1]
        if same and entry.both and (beat.relation == "while" or self.rng.random() < 0.35):
            return f"{voice.group()} {self._both(draft, beat, 'plural')}"
        if same and not entry.does:
            return f"{voice.group()} {self._both(draft, beat, 'plural')}"
        if same and entry.both and beat.relation == "while":
            return f"{voice.name(one)} {self._does(draft, beat, one, 's')}"
        if beat.acts[other] in QUIET and self.rng.random() < 0.55:
            return f"{voice.name(one)} {self._does(draft, beat, one, 's')}"
        return self._framed(draft, beat, one, other)

    def _framed(self, draft: _Draft, beat: Beat, one: int, other: int) -> str:
        draw = self.rng.random()

        def says(person: int) -> str:
            return f"{draft.voice.name(person)} {self._does(draft, beat, person, 's')}"

        links: tuple[str, ...]
        if beat.relation == "while":
            if draw < 0.3:
                return f"while {says(one)}, {says(other)}"
            if draw < 0.45:
                return f"{says(other)} as {says(one)}"
            links = (" while ", " while ", " and ", " and at the same time ", ", and ")
        elif beat.relation == "order":
            if draw < 0.2:
                return f"after {says(one)}, {says(other)}"
            if draw < 0.3:
                return f"first {says(one)}, then {says(other)}"
            links = (", then ", " and then ", ", and after that ", " before ", ". Then ")
        else:
            if draw < 0.2:
                return f"when {says(one)}, {says(other)}"
            links = (" and ", ", and ", ", but ", ". ", ", but ") if beat.acts[other].startswith("refuse") else (
                " and ", ", and ", ". ", "; ", ", so ")  # fmt: skip
        return says(one) + links[int(self.rng.integers(len(links)))] + says(other)

    def _both(self, draft: _Draft, beat: Beat, form: str) -> str:
        entry = phrases()[beat.acts[0]]
        text = self._pick(draft, entry.both)
        if "%side" in text and beat.sides[0] not in ("left", "right"):
            text = next((p for p in entry.both if "%side" not in p), text)
        return draft.voice.phrase(text, -1, form) + self._adverb(draft, beat, 0, len(text))

    def _does(self, draft: _Draft, beat: Beat, person: int, form: str) -> str:
        """The verb phrase of what one person does in a beat."""
        voice, act = draft.voice, beat.acts[person]
        entry = phrases()[act]
        echo = beat.acts[0] == beat.acts[1] and person != beat.first and entry.echo
        choices = entry.echo if echo and self.rng.random() < 0.8 else entry.does or entry.both
        side = beat.sides[person]
        named = side in ("left", "right")
        usable = [c for c in choices if named or "%side" not in re.sub(r"\[[^\]]*\]", "", c)] or list(choices)
        text = options(self._pick(draft, usable), named and self.rng.random() < 0.6)
        voice.sides = beat.sides
        spoken = voice.phrase(text, person, form)
        return spoken + self._adverb(draft, beat, person, len(text))

    def _adverb(self, draft: _Draft, beat: Beat, person: int, length: int) -> str:
        """An adverb of manner or duration, if the scene knows one."""
        draw, style = self.rng.random(), beat.styles[person]
        if style in MANNERS and draw < 0.35:
            return " " + self._pick(draft, MANNERS[style])
        if style in ("slow", "brisk") and draw < 0.3:
            return " slowly" if style == "slow" else " briskly"
        if beat.acts[person] in LASTING and 0.35 < draw < 0.55 and length < 45:
            last = (beat.end - beat.start) / FPS
            if last < 1.7:
                return (" briefly", " for a moment", " for a second or so")[int(self.rng.integers(3))]
            number = _NUMBERS[min(round(last), 10)]
            return (f" for {number} seconds", f" for about {number} seconds", " for a while")[
                int(self.rng.integers(3))
            ]
        return ""

    # ---- one person -------------------------------------------------------------------------------------
    def _single(self, person: int) -> tuple[_Draft, str]:
        chosen = self._chosen_beats()
        cast = _SOLO[int(self.rng.integers(len(_SOLO)))]
        if person == 1:
            cast = Cast(cast.first[::-1], cast.later[::-1], cast.pronouns[::-1])
        draft = self._draft(cast)
        parts, before = [], ""
        kept = [beat for beat in chosen if beat.acts[person] != "stand" or self.rng.random() < 0.5] or chosen[
            :1
        ]
        name = draft.voice.name(person)
        for beat in kept:
            if beat.acts[person] == before == "stand":
                continue
            before = beat.acts[person]
            draft.voice.sides = beat.sides
            entry = phrases()[before]
            if not entry.does:
                return draft, ""
            parts.append(self._does(draft, beat, person, "s"))
        text = f"{name} {_listed(self.rng, parts)}"
        return draft, text


_SOLO = (
    Cast(("a person", "someone"), ("the person", "them")),
    Cast(("someone", "another person"), ("they", "them")),
    Cast(("a person", "someone else"), ("the person", "the other")),
    Cast(("one person", "the other"), ("the person", "the other")),
    Cast(("a man", "somebody"), ("he", "the other"), ("he", "they")),
    Cast(("a woman", "somebody"), ("she", "the other"), ("she", "they")),
    Cast(("somebody", "a friend"), ("they", "the friend")),
    Cast(("the person", "a partner"), ("the person", "the partner")),
)
"""Names of the person that a caption of one person describes, and of the other."""


_NAMED = re.compile(r"\b[AB]\b|^(?:They|Both|The two|Each|Neither) ")
"""Matches sentences that use the scene's names A and B or a plural subject, and so combine with others."""


def _listed(rng: Rng, parts: list[str]) -> str:
    """ "x, y and z" or "x, then y, and then z"."""
    if len(parts) == 1:
        return parts[0]
    last = (" and ", " and then ", ", then ", ", and finally " if len(parts) > 2 else " and ")[
        int(rng.integers(4))
    ]
    inner = (", ", ", then ")[int(rng.integers(2))]
    return inner.join(parts[:-1]) + last + parts[-1]


def _lower(text: str) -> str:
    """The first letter small, unless it is a name."""
    first = text.split(" ", 1)[0].rstrip("',")
    names = {"Ben", "Tom", "Paul", "Omar", "Leo", "Jack", "Anna", "Mia", "Eva", "Lena", "Zoe", "Rosa"}
    return text if first in names else text[:1].lower() + text[1:]


def _written(acts: tuple[Pair, ...]) -> list[str]:
    """The sentences of just these beats, A being the first of each pair; "*" matches any act."""
    known = sentences()
    found = list(known.get(acts, ()))
    found += known.get(tuple((one, "*") for one, _ in acts), ())
    return found
