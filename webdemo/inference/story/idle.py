"""Bystanders: the people who do nothing in a sentence, and how they stand.

Networks that were trained on people who mostly do the same let a bystander sit down, bow or wave along. A bystander
is therefore given a standing pose twice a second, and the network makes the movement between.
"""

from __future__ import annotations

import re

from .beginnings import beginning
from .clauses import Clause, clauses
from .contacts import contact
from .gestures import STOOD, gestures
from .moves import MOVED, goes, moves
from .postures import bows, changes, leaps
from .ways import Way, way_of

_NOTHING = re.compile(
    r"\b(?:stands?(?! up)|standing(?! up)|stays?|waits?|watch(?:es|ing)?|looks? on|observ\w+|remains?|"
    r"listens?|ignor\w+|nothing|"
    r"motionless|upright|unmoved|idle|rooted|pays? no attention|"
    r"^looks? at (?:it|(?:the|his|her|their) (?:\w+ )?\w+)$|"
    r"star(?:es?|ing)|gaz\w+|just looks?|refus\w+|declin\w+|keeps? still|without (?:moving|reacting|answering)|"
    r"do(?:es)? ?n[o']t (?:\w+ )?(?:move|react|answer|respond|budge|follow|return|take|shake|wave|bow|clap|join|accept"
    r"|\w+ back))\b"
)
_BUSY = re.compile(
    r"\b(?:sit|seated|kneel|crouch|squat|lie|lying|lean|wav(?!e back)|point|hold|talk|speak|laugh|cheer|"
    r"clap(?!s? back)|danc|arms? (?:crossed|folded|raised|up)|hands? (?:up|raised|on)|offer|push|pull|step|turns?|"
    r"back to back)\w*"
)
_ALONE = re.compile(
    r"\b(?:(?:jump|leap|hop|fall|kneel|crawl|roll|spin|squat|crouch|stretch|bow|clap|applaud|beckon|salut|nod|shrug|"
    r"collaps|cheer|danc|faint|yawn|curts|stamp|scratch|juggl|exercis|shiver|trembl|sob|laugh|pray|meditat|march)\w*"
    r"|looks? at|sits?|sitting|lies|lying|wav(?:es?|ing)|points?|pointing|rais\w+|lowers?|"
    r"lifts? (?:his|her|their|the|both)|gets? (?:up|down)|stands? up|trips?|holds? out)\b"
)
"""Acts that need nobody else."""
_TOUCH = re.compile(
    r"\b(?:hug|embrac|pat|pats|tap|hit|slap|grab|hold(?!\w* out)|tak|knock|giv|pull|push|shov|lift|carr|help|kiss|"
    r"cover|comfort|touch|lay|lean|tickl|shak|strok|catch|throw|kick|punch|lead|drag|support|tackl|trip|pass|"
    r"high[- ]fiv|fist)\w*|\bhands? (?:him|her|them|person [ab]|over|an?|the)\b|\bhand in hand\b|\bhandshak\w+"
)
_IN_VAIN = re.compile(r"\b(?:left hanging|in vain|gets? no answer|(?:is|are) ignored)\b")


def idle(sentence: str) -> frozenset[str]:
    """The people, "a" and "b", who stand by and do nothing else in a beat's sentence.

    These are people who are said to wait, to watch or not to answer, or who do nothing of their own while the other
    does something that needs nobody else, such as sitting down or waving.
    """
    found = clauses(sentence)
    vain = {"ab".replace(c.who, "") for c in found if _IN_VAIN.search(c.words) and c.who != "ab"}
    own = {person: [c for c in found if person in c.who] for person in "ab"}
    if any(c.who == "ab" for c in found) or any(
        MOVED.search(c.words) and _TOUCH.search(c.words) for c in found
    ):
        return frozenset(vain)
    by = {p for p, q in ("ab", "ba") if _stands_by(own[p], own[q])}
    if not touches(sentence):
        by |= {q for p, q in ("ab", "ba") if gestures(sentence).get(p) and not own[q]}
    return frozenset(vain | by)


def gesturing(sentence: str) -> frozenset[str]:
    """The people, "a" and "b", who only stand and make one of the gestures that the network knows little of."""
    made = gestures(sentence)
    found = clauses(sentence)
    own = {p: [c for c in found if p in c.who] for p in "ab"}
    each = len(made) == 2 and all(c.who != "ab" for c in found)
    return frozenset(
        p
        for p in made
        if (made[p].hand in STOOD or each)
        and len(own[p]) < 2
        and all(way_of(c.words) is None for c in own[p])
    )


def is_planned(sentence: str) -> bool:
    """True if a beat's words say where people go, who stands by, sits, kneels, lies down, jumps, bows or touches."""
    read = (contact, idle, changes, leaps, bows, gesturing, beginning)
    return goes(moves(sentence)) or any(found(sentence) for found in read)


def touches(sentence: str) -> bool:
    """True if the words of a beat are of a touch."""
    return bool(_TOUCH.search(sentence.lower()))


def _stands_by(own: list[Clause], others: list[Clause]) -> bool:
    if own:
        return all(_NOTHING.search(c.words) and not _BUSY.search(_NOTHING.sub("", c.words)) for c in own)
    acts = [c for c in others if way_of(c.words) is None or way_of(c.words) is Way.TURN]
    return bool(acts) and all(_ALONE.search(c.words) and not _TOUCH.search(c.words) for c in acts)
