"""A grammar that writes the corpus' captions: the same meaning in many correct English sentences.

A sentence is a frame ("{A} {VA}, then {B} {VB}.") filled with two verb phrases of the family
(:mod:`training.corpus.phrases`), a way to name the people, and what the scene knows about manner, side,
speed and distance. Agreement (waves/wave/waving, is/are, a/an) is worked out as the words are joined.

A fixed tenth of frames and phrases is held out: a "test" caption holds at least one of them, a "train"
caption none, so the words of a test caption are new.
"""

from __future__ import annotations

import re
import zlib
from collections.abc import Mapping
from typing import Any

import numpy as np

from motion.metrics.sentences import kept_out

from .grammar import article, conjugate, expand
from .phrases import ACTIONS, ENTRIES
from .wording import (
    ADJECTIVES,
    BOTH,
    CASES,
    DISTANCES,
    FRAMES,
    GROUPS,
    LEADS,
    MANNERS,
    ONE,
    PAIRS,
    SPEEDS,
    THINGS,
)

FAMILIES: tuple[str, ...] = tuple(ENTRIES)
"""The names of all families that have words."""

SLOTS = ("side_a", "side_b", "manner_a", "manner_b", "speed", "distance", "direction", "thing",
         "act_a", "act_b", "first", "second")  # fmt: skip


def _held_out(pattern: str) -> bool:
    # "them" may be written as the other person's name, so both count as one pattern.
    return zlib.crc32(pattern.replace("{them}", "{other}").encode()) % 100 < 6


class Phrasebook:
    """Writes captions of one family.

    Args:
        family: one of :data:`FAMILIES`.
    """

    def __init__(self, family: str) -> None:
        if family not in ENTRIES:
            raise KeyError(f"No words for the family {family!r}; there are {', '.join(FAMILIES)}.")
        self.family = family

    def sample(
        self,
        rng: np.random.Generator,
        slots: Mapping[str, Any] | None = None,
        n: int = 8,
        split: str = "train",
        *,
        name_side: bool = True,
    ) -> list[str]:
        """Different captions that are all true of one scene, none of them a sentence that the judge keeps.

        Args:
            rng: where the choices come from.
            slots: what is known of the scene, each key only where it applies (:data:`SLOTS`):
                side_a, side_b "left" | "right" | "both" (hand, foot or way that a person uses);
                manner_a, manner_b a style's name; speed "slow" | "fast"; distance "near" | "far";
                direction "clockwise" | "counterclockwise"; thing "a book";
                act_a, act_b actions (:data:`training.corpus.phrases.ACTIONS`) of the families "ordered",
                "together", "copy" (act_a) and "watch" (act_a);
                first, second actions that a does one after the other in "sequence", while b watches.
            n: how many; fewer come back only where the family has no more.
            split: "train" or "test" (held-out frames and phrases).
            name_side: leave out captions that don't name a side that the slots give.

        Returns:
            up to ``n`` distinct captions.
        """
        slots = dict(slots or {})
        unknown = set(slots) - set(SLOTS)
        if unknown:
            raise KeyError(f"Unknown slots {sorted(unknown)}; there are {', '.join(SLOTS)}.")
        slots = {key: value for key, value in slots.items() if value is not None}
        wanted = (
            [slots[key] for key in ("side_a", "side_b", "direction") if key in slots] if name_side else []
        )
        found: dict[str, None] = {}
        for _ in range(60 * n):
            writer = _Writer(self.family, slots, rng)
            text = writer.write()
            if writer.held_out != (split == "test") or any(not _names(text, word) for word in wanted):
                continue
            if kept_out(text):
                continue
            found.setdefault(text)
            if len(found) == n:
                break
        return list(found)

    def alone(
        self, rng: np.random.Generator, person: int, slots: Mapping[str, Any], n: int, split: str
    ) -> list[str]:
        """Different captions of what one person does, 0 a and 1 b; none where there are no such words."""
        slots = {key: value for key, value in slots.items() if value is not None}
        found: dict[str, None] = {}
        for _ in range(25 * n):
            writer = _Writer(self.family, slots, rng)
            text = writer.write(alone=person)
            if text and writer.held_out == (split == "test") and not kept_out(text):
                found.setdefault(text)
            if len(found) == n:
                break
        return list(found)


def _names(text: str, side: str) -> bool:
    words = {"both": r"both|double|two-handed|arms|hands"}.get(side, side)
    return re.search(rf"\b({words})\b", text, flags=re.IGNORECASE) is not None


class _Writer:
    """One caption in the making."""

    def __init__(self, family: str, slots: Mapping[str, Any], rng: np.random.Generator) -> None:
        self.entry, self.family, self.slots, self.rng = ENTRIES[family], family, slots, rng
        self.held_out = False
        self.number = "s"
        self.mentioned: list[int] = []
        self.thing = slots.get("thing") or self._pick(THINGS)
        weights = np.array([weight for _, weight in PAIRS], dtype=float)
        self.pair = PAIRS[rng.choice(len(PAIRS), p=weights / weights.sum())][0]

    # ---- choices ----------------------------------------------------------------------------------------
    def _pick(self, options: Any) -> Any:
        return options[int(self.rng.integers(len(options)))]

    def _pattern(self, patterns: tuple[str, ...]) -> str:
        """One expanded pattern; notes whether it is held out."""
        chosen = self._pick(expand(self._pick(patterns)))
        self.held_out |= _held_out(chosen)
        return chosen

    def write(self, *, alone: int | None = None) -> str:
        """A caption of both, or of one person alone ("" where there are no words)."""
        entry, slots = self.entry, self.slots
        a, b, both, nouns = entry.a, entry.b, entry.both, entry.nouns
        if self.family in ("ordered", "together", "copy", "watch"):
            verbs_a, nouns_a = ACTIONS[slots["act_a"]]
            verbs_b, nouns_b = ACTIONS[slots.get("act_b", slots["act_a"])]
            a = verbs_a
            if self.family == "ordered":
                b, nouns = verbs_b, tuple(f"{x} and then {y}" for x in nouns_a for y in nouns_b)
            elif self.family == "together":
                same = slots.get("act_b", slots["act_a"]) == slots["act_a"]
                same &= slots.get("side_a") == slots.get("side_b")
                b = tuple(f"{verb} (too|as well)" for verb in verbs_b) if same else verbs_b
                joint = (verb for verb in verbs_a if "{other}" not in verb)
                both = tuple(f"{verb}( together| at the same time|)" for verb in joint) if same else ()
        if self.family == "sequence":
            first, second = (ACTIONS[slots[key]][0] for key in ("first", "second"))
            joins = (" and then ", ", then ", " and after that ", ". Then {they} ")
            a = tuple(f"{self._pick(first)}{link}{self._pick(second)}" for link in joins)
            b = ENTRIES["watch"].b
        if alone is not None:
            verbs, who = ((a, "A"), (b, "B"))[alone]
            if not verbs:
                return ""
            frame = self._pattern((f"{{{who}}} {{V{who}}}.", f"{{{who}}} *is {{V{who}.ing}}."))
            if self.family == "sequence":
                frame = f"{{{who}}} {{V{who}}}."
            phrase = self._mannered(self._pattern(verbs), alone)
            return self._finish(self._fill(frame, alone, {f"V{who}": phrase}))
        kinds = ["pair"] * 6 + ["both"] * (3 if both else 0) + ["nouns"] * bool(nouns)
        kinds += ["sentences"] * (2 if entry.sentences else 0) + ["one"] * (
            1 if a and entry.frames != "order" else 0
        )
        kind = self._pick(kinds)
        if kind == "nouns":
            return self._finish(self._fill(self._pattern(nouns), 0), keyword=True)
        if kind == "both":
            frame, phrase = self._pattern(BOTH), self._pattern(both)
            return self._finish(self._fill(frame, -1, {"V": self._mannered(phrase, -1)}))
        if kind == "sentences":
            return self._finish(self._fill(self._pattern(entry.sentences), 0))
        frame = self._pattern(ONE if kind == "one" else FRAMES[entry.frames])
        if self.family == "sequence" and frame.count(".") > 1:
            frame = "{A} {VA} while {B} {VB}."
        phrases = {"VA": self._mannered(self._pattern(a), 0)}
        if "{VB" in frame:
            phrases["VB"] = self._mannered(self._pattern(b), 1)
        return self._finish(self._lead(self._fill(frame, 0, phrases), frame))

    def _mannered(self, phrase: str, person: int) -> str:
        """The phrase with an adverb of manner or speed where the scene gives one."""
        if person < 0:
            shared = self.slots.get("manner_a") == self.slots.get("manner_b")
            manner = self.slots.get("manner_a") if shared else None
        else:
            manner = self.slots.get(("manner_a", "manner_b")[person])
        adverbs: tuple[str, ...] = MANNERS.get(manner or "", ())
        if person <= 0 and self.slots.get("speed") and (not adverbs or self.rng.random() < 0.4):
            adverbs = SPEEDS[self.slots["speed"]]
        if not adverbs or self.rng.random() < 0.25:
            return phrase
        adverb = self._pick(adverbs)
        if adverb.endswith("ly") and " " not in adverb and self.rng.random() < 0.4:
            return f"{adverb} {phrase}"
        return f"{phrase} {adverb}"

    def _lead(self, text: str, frame: str) -> str:
        """A sentence in front, or a word on the distance."""
        if not frame.startswith("{"):
            return text
        if "distance" in self.slots and self.rng.random() < 0.5:
            return f"{self._pick(DISTANCES[self.slots['distance']]).capitalize()}, {text}"
        if self.pair.first == ("one", "the other") and frame.startswith("{A}") and self.rng.random() < 0.6:
            return (
                f"{self._pick(('Of two people,', 'Two people:', 'Two friends:', 'Of two friends,'))} {text}"
            )
        if self.pair.first == ("one person", "the other") and self.rng.random() < 0.15:
            return f"{self._pick(LEADS)} {text}"
        return text

    # ---- words ------------------------------------------------------------------------------------------
    def _fill(self, frame: str, person: int, phrases: Mapping[str, str] | None = None) -> str:
        """Fills a frame from left to right; ``person`` whose phrase it is (-1: the two together)."""
        out = []
        for token in re.findall(r"\{[^}]*\}|\*[\w-]+|[^{*]+", frame):
            if token.startswith("*"):
                out.append(conjugate(token[1:], self.number))
            elif not token.startswith("{"):
                out.append(token)
            elif (name := token[1:-1]).split(".")[0] in (phrases or {}):
                key, _, form = name.partition(".")
                before, self.number = self.number, form or self.number
                out.append(self._fill((phrases or {})[key], {"VA": 0, "VB": 1, "V": -1}[key]))
                self.number = before
            else:
                out.append(self._word(name, person))
        return "".join(out)

    def _word(self, name: str, person: int) -> str:
        if name in ("A", "B"):
            if self.number in ("s", "plural"):
                self.number = "s"
            return self._mention("AB".index(name))
        if name in ("As", "Bs"):
            return self._possessive("AB".index(name[0]))
        if name == "P":
            group = self._pick(GROUPS)
            self.number = "s" if group.startswith("a pair") else "plural"
            text = self._fill(group, person)
            self.number = "s" if group.startswith("a pair") else "plural"
            return text
        if name == "with_both":
            return self._joint_word(name)
        if name[:2] in ("a_", "b_"):
            return self._word(name[2:], "ab".index(name[0]))
        if person < 0:
            return self._joint_word(name)
        pronoun = CASES[self.pair.pronouns[person]]
        other = 1 - person
        side = self.slots.get(("side_a", "side_b")[person])
        if name == "they":
            self.number = "plural" if pronoun[0] == "they" else "s"
            return pronoun[0]
        if name == "them":
            # As an object: the pronoun of the person that is meant, which is this one only in "b_them".
            return self._object(other)
        if name == "their":
            return pronoun[2]
        if name == "other":
            return self._mention(other)
        if name == "theirs":
            return self._possessive(other)
        return self._side_word(name, side, pronoun[2])

    def _object(self, person: int) -> str:
        if person in self.mentioned and self.rng.random() < 0.6:
            return CASES[self.pair.pronouns[person]][1]
        return self._mention(person)

    def _side_word(self, name: str, side: str | None, their: str) -> str:
        """A hand, arm, foot or way: named where the scene names its side."""
        own = side is not None and self.rng.random() < 0.5
        if name in ("hand", "arm", "fist", "elbow"):
            if side == "both":
                return f"both {name}s"
            if side is None:
                return self._pick(
                    (f"a {name}", f"one {name}") if name != "elbow" else ("an elbow", "one elbow")
                )
            return f"{their if own else 'the'} {side} {name}"
        if name in ("with_hand", "with_foot", "with_arm"):
            limb = name[5:]
            if side is None:
                return ""
            if side == "both":
                return f" with both {limb if limb != 'foot' else 'feet'}" + ("s" if limb != "foot" else "")
            limb = self._pick(("foot", "leg")) if limb == "foot" else limb
            return f" with {their if own else 'the'} {side} {limb}"
        if name == "to_side":
            return f" to the {side}" if side in ("left", "right") else ""
        if name == "round":
            return f" {self.slots['direction']}" if "direction" in self.slots else ""
        if name == "thing":
            return self.thing
        if name == "the_thing":
            return "it" if self.thing == "something" else "the " + self.thing.split(" ", 1)[1]
        raise KeyError(f"The phrase book uses an unknown word {name!r}.")

    def _joint_word(self, name: str) -> str:
        """The words of a phrase whose subject is both people."""
        side = self.slots.get("side_a")
        if name in ("with_hand", "with_both"):
            if side is None:
                return ""
            return " with both hands" if side == "both" else f" with their {side} hands"
        if name == "each_hand":
            return f"their {side} hands" if side in ("left", "right") else "hands"
        if name in ("hand", "arm"):
            return f"both {name}s" if side == "both" else f"their {side + ' ' if side else ''}{name}s"
        if name == "their":
            return "their"
        return self._side_word(name, side, "their")

    def _mention(self, person: int) -> str:
        pair = self.pair
        if person in self.mentioned:
            place = self.mentioned.index(person) if pair.by_text else person
            return pair.later[place]
        self.mentioned.append(person)
        place = len(self.mentioned) - 1 if pair.by_text else person
        name = pair.first[place]
        adjective = ADJECTIVES.get(self.slots.get(("manner_a", "manner_b")[person], ""))
        if adjective and name == "a person" and self.rng.random() < 0.7:
            return f"a {adjective} person"
        return name

    def _possessive(self, person: int) -> str:
        return self._mention(person) + "'s"

    def _finish(self, text: str, *, keyword: bool = False) -> str:
        """Articles, casing and punctuation."""
        text = re.sub(r"\s+", " ", text).strip()
        text = re.sub(r"(?<!erson )\b([Aa])n? (?=(\w+))", article, text)
        text = re.sub(r"^First (?=(the|person) )", "First, ", text)
        text = re.sub(r"(?<=\. )[a-z]", lambda match: match.group(0).upper(), text)
        if keyword:
            return text if self.rng.random() < 0.8 else text[0].upper() + text[1:] + "."
        text = text if text.endswith(".") else text + "."
        style = self.rng.random()
        if style < 0.62:
            return text[0].upper() + text[1:]
        if style < 0.74:
            return text[0].upper() + text[1:-1]
        text = re.sub(r"(^|\. )([A-Z])(?=[a-z])", lambda m: m.group(1) + m.group(2).lower(), text)
        return text[:-1] if style < 0.93 else text
