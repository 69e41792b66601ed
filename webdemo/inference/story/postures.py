"""Postures: who sits, kneels, crouches or lies down in a story, and stays so, and who jumps.

A network that was trained on people who sit down and get up again does not leave them seated. The words say how the
people hold themselves at the end of each beat; until they get up, their pelvis and legs are given, and the trunk and
head of those who lie or bend down.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from enum import Enum

from .clauses import Clause, clauses


class Posture(Enum):
    """A way to hold oneself."""

    STANDS = "stands"
    SITS = "sits"
    KNEELS = "kneels"
    GROUND = "sits on the ground"
    CROUCHES = "crouches"
    BENDS = "bends down"
    LIES = "lies"


@dataclass(frozen=True)
class Change:
    """A posture that one person takes up in a beat, or in which its words find them.

    Attributes:
        posture: how they hold themselves from then on.
        already: they do so when the beat begins, if nothing before it says otherwise ("while she sits").
        after: how much of the beat's words come before, from 0 to 1.
        passing: they are up again at once, as somebody who ducks is.
    """

    posture: Posture
    already: bool = False
    after: float = 0.0
    passing: bool = False


_SEAT = r"(?:chair|seat|bench|sofa|couch|stool|armchair|settee|step|table|desk|wheelchair|throne|swing|deckchair)s?"
_FLOOR = r"(?:on|in) (?:the|a) (?:floor|ground|grass|carpet|mat|rug|sand|beach|snow|lawn|blanket)\b"
_ON_FLOOR, _ON_SEAT = re.compile(rf"\b{_FLOOR}"), re.compile(rf"\b{_SEAT}\b")
_SELF = r"(?:him|her|them)sel(?:f|ves)"
_SURFACE = r"(?:ground|floor|grass|mat|backs?|bottom|bum|side|knees)"
_GROUND = rf"(?:(?:to|on|onto) (?:the |his |her |their )?{_SURFACE}|over|down)"
_FEET = r"(?:to|on|onto) (?:his|her|their) feet\b"
_UP = re.compile(
    r"\b(?:gets?|getting|stands?|standing|ris(?:es?|ing)|climbs?) (?:\w+ )?up\b|\b(?:rises?|arises?)\b"
    rf"|\b(?:gets?|ris(?:es?|ing)|jumps?|springs?|leaps?|climbs?|scrambles?) (?:back )?{_FEET}|\bback {_FEET}"
    rf"|\b(?:is|are|gets?) (?:pulled|helped|lifted|dragged|hauled) (?:\w+ )?(?:up\b|{_FEET})"
    rf"|\b(?:from|off|out of) (?:the|an?|his|her|their) (?:{_SEAT}|floor|ground)\b|\bleaves? (?:his|her|their) seats?\b"
)
_BY_OTHER = re.compile(r"\b(?:is|are|gets?|being) (?:\w+ )?\w+(?:ed|wn)\b")
_RAISES = re.compile(
    r"\b(?:pull|help|lift|drag|haul|ease)\w* (?:(?:person [ab]|him|her|them|(?:the|an?|his|her) (?:old )?\w+|"
    rf"each other) )?(?:\w+ )?(?:up\b|{_FEET}|(?:out of|off|from) (?:the|an?|his|her|their) "
    rf"(?:{_SEAT}|floor|ground|bed))"
)
"""Acts by which one gets the other up."""
_FELLS = re.compile(
    r"\b(?:knock|push|shov|throw|pull|trip|wrestl)\w* (?:\w+ ){1,3}?(?:over|down|(?:to|on) the (?:ground|floor))\b"
)
"""Acts by which one makes the other fall."""
_DOWN = (
    (
        Posture.KNEELS,
        r"\bkneel(?:s|ing)?\b|\b(?:drop|sink|fall|go|get)(?:s|es)? (?:\w+ )?(?:on|to|onto|upon) "
        r"(?:one|a|his|her|their|both|bended) knees?\b",
    ),
    (
        Posture.GROUND,
        rf"\b(?:sits?|sitting|plops?|flops?) (?:\w+ ){{0,2}}?{_FLOOR}",
    ),
    (
        Posture.SITS,
        r"\b(?:sits?|sitting) (?:\w+ )?down\b|\b(?:takes?|has|have) (?:a|his|her|their) seats?\b|\bsits?\b"
        r"|\b(?:flop|plop|plonk|slump|sink|drop|settle|perch|lower|squeeze|collapse|fall)(?:s|es)? (?:\w+ ){0,2}?"
        rf"(?:on|onto|into|to|in) (?:the|an?|his|her|their) (?:\w+ )?{_SEAT}\b|\b(?:sits|seats|lowers) {_SELF}\b"
        r"|\b(?:plop|settle|squat)s? down\b",
    ),
    (
        Posture.LIES,
        r"\b(?:fall|drop|tumble|topple|collapse|faint)(?:s|ing)?(?: \w+)?(?: backwards?)? "
        rf"{_GROUND}|\b(?:collapse|faint|topple)s?\b|^falls?$|\bfalls? flat\b"
        r"|\b(?:is|are|gets?) (?:knocked|pushed|thrown|shoved) (?:\w+ )?(?:over|down|to the (?:ground|floor))\b"
        r"|\bl(?:ies?|ying) down\b|\bplays? dead\b|\bpass(?:es)? out\b|\bkeels? over\b"
        r"|\b(?:hits?|lands? on|ends? up on) (?:the|his|her) (?:floor|ground|deck|back|bottom)\b",
    ),
    (Posture.BENDS, r"\b(?:bend|lean|stoop)s? (?:\w+ )?(?:down|over)\b(?! backwards?)"),
    (Posture.CROUCHES, r"\b(?:crouch|squat)(?:es|s|ing)?\b"),
)
_STAYS = r"\b(?:is|are|stays?|remains?|keeps?) (?:\w+ )?"
_STATE = (
    (
        Posture.GROUND,
        rf"{_STAYS}(?:seated|sitting) (?:\w+ )?{_FLOOR}|\bsits? (?!down)(?:\w+ )?{_FLOOR}"
        rf"|^(?:seated|sitting) (?!down)(?:\w+ )?{_FLOOR}",
    ),
    (
        Posture.SITS,
        rf"{_STAYS}(?:seated|sitting)\b(?! down)|\bsits?(?! (?:\w+ )?down)\b|^(?:seated|sitting)\b(?! down)"
        rf"|\b(?:is|are|asleep|dozing|reads?\b.*|waits?|reading|waiting|sleeps?|sleeping|doz(?:es|ed)|relax\w+)"
        r" (?:\w+ )?"
        rf"(?:on|in|at) (?:the|an?|his|her|their) (?:\w+(?:'s)? )?{_SEAT}\b|\bperched\b"
        rf"|^(?:on|in) the (?:\w+ )?{_SEAT}\b"
        r"|\b(?:over|at|has|have|having|eats?|eating) (?:dinner|lunch|breakfast|supper)\b",
    ),
    (
        Posture.LIES,
        rf"{_STAYS}(?:lying\b(?! down)|sprawled|flat on|on the (?:floor|ground)\b|on (?:his|her) back\b|out cold|"
        r"unconscious|dead\b|fast asleep on the (?:floor|ground|grass))|^flat on (?:his|her|their) (?:back|face)"
        r"|\bl(?:ies?|ying) (?!down\b)(?:\w+ )?(?:on|flat|still|there|next to|beside|in)\b"
        rf"|\b(?:sleep(?:s|ing)?|asleep)\b(?! (?:in|on) (?:an?|the|his|her) (?:\w+ )?{_SEAT})",
    ),
    (
        Posture.KNEELS,
        rf"{_STAYS}(?:kneeling|on (?:one|his|her|their|both|bended) knees?)\b|^kneeling\b(?! down)",
    ),
    (Posture.CROUCHES, rf"{_STAYS}(?:crouching|squatting)\b"),
)
_PATTERNS = tuple((posture, re.compile(pattern)) for posture, pattern in _DOWN)
_STATES = tuple((posture, re.compile(pattern)) for posture, pattern in _STATE)
_DUCKS = re.compile(r"\bduck(?:s|ing)?\b")
_TIRELESS = re.compile(
    r"\b(?:does|do|doing) (?:\w+ )?squats\b|\bsquats?\b.*\b(?:times|again|repeatedly)\b|\b(?:sit|push|press)-?ups?\b"
)
_JUMPS = re.compile(r"\b(?:jump|hop|leap|bounce|spring)(?:s|ing)?\b")
_ELSEWHERE = re.compile(
    r"\b(?:jump|hop|leap|bounce|spring)(?:s|ing)? (?:over|onto|on(?! the spot| an? trampoline| the trampoline| the bed"
    r"| one leg)|off|out|aside|away|back\w*|at|rope|ahead"
    r"|forwards?|towards?|to\b|into (?!the air))|\bjumping jacks?\b"
)
_OFTEN = re.compile(
    r"\b(?:is|are|keeps?) (?:jump|hopp|leap|bounc)ing\b"
    r"|\b(?:hop|hopping|hops|bounc\w+|jumping)\b.* on the spot\b|\bup and (?:\w+ )?down\b|\bagain and again\b"
    r"|\brepeatedly\b|\b(?:several|three|many|a few) times\b"
)
_COUNTS = ("two", "three", "four", "five")
_COUNTED = re.compile(r"\b(two|three|four|five) (?:\w+ )?(?:jump|hop|leap|bounce)s\b")
_TWICE = re.compile(r"\btwice\b|\btwo times\b")
_NOT = re.compile(
    r"\b(?:do(?:es)?n't|not|without|never|refus\w+ to|wants? to|tries to|about to|almost|nearly)\b"
)
_LEFT_SO = re.compile(r"\b(?:walks? away|leaves? (?:\w+ )?\w+) (?P<so>sitting|seated|lying|kneeling)\b")
"""Words by which one goes and leaves the other as they are."""
_OBJECT_SO = re.compile(
    r"\b(?:the|an?|his|her|their) (?P<so>injured|wounded|fallen|unconscious|sleeping|dead|seated|sitting|kneeling) \w+"
)
"""Objects of verbs that say how the other person holds themselves."""
_POSTURES = {
    "sitting": Posture.SITS, "seated": Posture.SITS, "kneeling": Posture.KNEELS, "lying": Posture.LIES,
    "injured": Posture.LIES, "wounded": Posture.LIES, "fallen": Posture.LIES, "unconscious": Posture.LIES,
    "sleeping": Posture.LIES, "dead": Posture.LIES,
}  # fmt: skip


def changes(sentence: str) -> dict[str, tuple[Change, ...]]:
    """The changes of posture in a beat's sentence, in order, by person "a" and "b"."""
    found: dict[str, tuple[Change, ...]] = {}
    listed = clauses(sentence)
    at_once = any(clause.at_once for clause in listed)
    for i, clause in enumerate(listed):
        share = i / len(listed)
        left = _LEFT_SO.search(clause.words) or _OBJECT_SO.search(clause.words)
        if clause.who != "ab" and left is not None:
            other = "b" if clause.who == "a" else "a"
            kept = Change(_POSTURES[left["so"]], already=other not in found)
            found[other] = (*found.get(other, ()), kept)
        if (change := _caused(clause, share)) is not None:
            other = "b" if clause.who == "a" else "a"
            found[other] = (*found.get(other, ()), change)
            continue
        for who in clause.who:
            if (change := _own(clause, share, first=who not in found, at_once=at_once)) is not None:
                found[who] = (*found.get(who, ()), change)
    return found


def _says(pattern: re.Pattern[str], words: str) -> bool:
    """True if the words have the pattern, and nothing before it takes it back."""
    found, denied = pattern.search(words), _NOT.search(words)
    return (
        found is not None and not (denied and denied.start() < found.start()) and not _TIRELESS.search(words)
    )


def _caused(clause: Clause, share: float) -> Change | None:
    """The posture that one brings the other into."""
    if clause.who == "ab" or _BY_OTHER.search(clause.words):
        return None
    if _says(_RAISES, clause.words):
        return Change(Posture.STANDS, after=share)
    return Change(Posture.LIES, after=max(share, 0.4)) if _says(_FELLS, clause.words) else None


def _own(clause: Clause, share: float, *, first: bool, at_once: bool) -> Change | None:
    """The posture that the people of a clause take up."""
    if _says(_UP, clause.words):
        return Change(Posture.STANDS, after=share)
    if _says(_DUCKS, clause.words):
        return Change(Posture.CROUCHES, after=share, passing=True)
    if (
        first
        and (state := next((p for p, pattern in _STATES if _says(pattern, clause.words)), None)) is not None
    ):
        return Change(_low(state, clause.words), already=True)
    for posture, pattern in _PATTERNS:
        if _says(pattern, clause.words):
            already = at_once and first and posture is not Posture.LIES and " down" not in clause.words
            if posture is Posture.LIES and _BY_OTHER.search(clause.words):
                share = max(share, 0.4)  # what makes them fall comes before
            return Change(_low(posture, clause.words), already=already, after=share)
    return None


def _low(posture: Posture, words: str) -> Posture:
    """The posture, where people who sit on the floor do so however many words lie between."""
    on_floor = _ON_FLOOR.search(words) is not None and _ON_SEAT.search(words) is None
    return Posture.GROUND if posture is Posture.SITS and on_floor else posture


def is_down_or_up(clause: Clause) -> bool:
    """True if the people of a clause go down and stay there, or get up."""
    change = _own(clause, 0.0, first=False, at_once=False)
    return change is not None and not change.passing


def leaps(sentence: str) -> dict[str, int]:
    """The number of jumps on the spot of each person, "a" and "b", in a beat's sentence."""
    found: dict[str, int] = {}
    for clause in clauses(sentence):
        if not _says(_JUMPS, clause.words) or _ELSEWHERE.search(clause.words) or _UP.search(clause.words):
            continue
        times = 3 if _OFTEN.search(sentence.lower()) else 2 if _TWICE.search(clause.words) else 1
        if (counted := _COUNTED.search(clause.words)) is not None:
            times = 2 + _COUNTS.index(counted[1])
        found |= dict.fromkeys(clause.who, times)
    return found


_BOWS = re.compile(r"\b(?:bow(?:s|ing)?(?! (?:and arrow|tie|out))|curts\w+)\b")
_DEEP = re.compile(r"\b(?:deep|low)\w*|\bto the (?:ground|floor)\b")
_SEVERAL = re.compile(r"\b(?:take|make)s? (two|three|four|five) bows\b|\bbows? (two|three|four|five) times\b")


def bows(sentence: str) -> dict[str, tuple[int, bool]]:
    """The number of bows of each person, "a" and "b", in a beat's sentence, and True where they are deep."""
    found: dict[str, tuple[int, bool]] = {}
    for clause in clauses(sentence):
        if _says(_BOWS, clause.words):
            several = _SEVERAL.search(clause.words)
            times = 2 + _COUNTS.index(several[1] or several[2]) if several else 1
            times = 2 if _TWICE.search(clause.words) else times
            found |= dict.fromkeys(clause.who, (times, bool(_DEEP.search(clause.words))))
    return found


_ON_FEET = re.compile(
    r"\b(?:danc|waltz|kick|fight|box|wrestl|spar|bow|curts|march|hug|embrac|exercis|stretch|chas)\w*"
)
"""Acts that need legs: who does them is on their feet again, also where no word says that they get up."""


def on_feet(sentence: str) -> frozenset[str]:
    """The people, "a" and "b", who do what needs legs in a beat's sentence."""
    acts = [clause for clause in clauses(sentence) if _says(_ON_FEET, clause.words)]
    return frozenset(who for clause in acts for who in clause.who)
