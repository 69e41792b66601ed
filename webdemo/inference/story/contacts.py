"""Contacts: a hand that is laid on the other's shoulder, a pat on the back, a kiss on the cheek.

The network makes the touches of its training sentences. One that comes after a walk, of somebody who sits or kneels,
or of a part of the body that was not in those sentences, it often misses by a hand's breadth. There, who touches is
led to where they reach the other, and the hand is given.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from motion import SMPL22
from motion.transforms import heading

from .clauses import OTHER, Clause, clauses
from .gestures import SIDES

Array = NDArray[np.floating]


class Region(Enum):
    """A part of the body that is touched."""

    HEAD = "head"
    SHOULDER = "shoulder"
    BACK = "back"
    CHEST = "chest"
    WAIST = "waist, from behind"
    ARM = "arm"
    HAND = "hand"
    LEG = "leg"
    FOOT = "foot"


@dataclass(frozen=True)
class Contact:
    """A touch of one person.

    Attributes:
        person: "a" or "b", who touches the other.
        region: of the other's body.
        sides: the hands that touch, "left", "right" or both; none for a kiss, which the head gives.
        times: how often a short touch is made; 0 for a hand that stays.
        late: something else goes on until then.
        behind: who touches stands behind the other.
        fells: the other falls from it, and stood before.
    """

    person: str
    region: Region
    sides: tuple[str, ...]
    times: int = 0
    late: bool = False
    behind: bool = False
    fells: bool = False


_REGIONS = (
    (Region.HEAD, r"(?:fore)?heads?|hair|cheeks?|faces?|chin|nose|eyes|ears?|mouth|lips|necks?|jaw"),
    (Region.SHOULDER, r"shoulders?"),
    (Region.BACK, r"backs?|shoulder blades?|spine"),
    (Region.CHEST, r"chests?|stomach|belly|tummy|ribs|side|waist|heart"),
    (Region.ARM, r"(?:upper |fore)?arms?|elbows?|sleeves?|biceps"),
    (Region.HAND, r"wrists?"),
    (Region.LEG, r"legs?|knees?|thighs?|calf"),
    (Region.FOOT, r"foot|feet|ankles?|shoes?|shoelaces?|boots?"),
)
_REGION = "|".join(f"(?P<{region.name}>{words})" for region, words in _REGIONS)
_OTHER = r"(?:person [ab]|him|her|them|the other(?: person| one)?|(?:the|an?|his|her|their) (?:\w+ )?\w+)"
_OTHERS = r"(?:his|her|their|the|(?:person [ab]|the other(?: person| one)?|(?:the|his|her|an?) \w+)'s?)"
_HANDS = (
    r"(?:(?:an?|one|his|her|their|the|both|two|left|right|of|comforting|gentle|heavy|firm) )*"
    r"(?:hand|arm|palm|finger)s?"
)
_LAYS = r"(?:lay|put|plac|rest|press|keep|hold)(?:s|es|ing)?"
_SHORT = r"(?:pat|tap|touch|pok|prod|nudg|slap|smack|dab|peck)(?:p?ing|t?ing|e?s)?"
_LONG = (
    r"(?:strok|rub|caress|massag|squeez|grab|grip|seiz|tak|catch|clasp|clutch|shak|hold|comb|brush|cut|trim|dry|wash|braid|ruffl|feel|examin|bandag|ti)"
    r"(?:[bmt]?ing|e?s|e)?"
)
_COVERS = r"cover(?:s|ing)?"
_KISSES = r"(?:kiss(?:es|ing)?|peck(?:s|ing)?)"
_LY = r"(?:\w+ly )?"
_BY = r"(?:on|by|in|at|across|over|against|around) (?:both )?(?:the|his|her|their) (?:(?:left|right|upper|lower) )?"
_ACTS = re.compile(
    rf"\b(?:(?P<lays>{_LAYS}) {_LY}{_HANDS} {_LY}(?:on|onto|upon|over|against) (?:both (?:of )?)?{_OTHERS} |"
    rf"(?P<kiss>{_KISSES}) {_LY}{_OTHER} {_BY}|"
    rf"(?P<short>{_SHORT}) {_LY}{_OTHER} {_LY}(?:once |twice )?{_BY}|"
    rf"(?P<long>{_LONG}) {_LY}(?:hold of )?{_OTHER} {_LY}{_BY}|"
    rf"(?P<gives>giv(?:es?|ing)) {_OTHERS} (?=\w+ an? (?:\w+ )?(?:shake|squeeze|rub|stroke|pat|tap)\b)|"
    rf"(?P<covers>{_COVERS}) {_LY}(?:person [ab]|the other(?: person| one)?|the \w+)'s |"
    rf"(?P<part>{_SHORT}|{_LONG}) {_LY}(?:hold of )?{_OTHERS} )(?:{_REGION})\b"
)
_BRIEF = re.compile(_SHORT)
_ON_BOTH = re.compile(
    r"\bboth (?:\w+ )?hands\b|\btwo hands\b|\bhands on\b|\b(?:shoulders|eyes)\b|\bmassag\w+"
)
_HUGS_BEHIND = re.compile(
    r"\b(?:(?:hug|embrac|cuddl|hold)\w*|(?:wrap|put|throw|sling|fling)\w* (?:both )?(?:his|her|their) arms around)"
    r" .*\bfrom behind\b"
)
_PUSHES = re.compile(rf"\b(?:push|shov|knock)(?:es?|s|ing)? {_OTHER}\b")
_COMFORTS = re.compile(
    rf"\b(?:comfort|consol|reassur|sooth)(?:es|s|e|ing)? {OTHER}\b"
    rf"|\b(?:put|lay|throw|sling|wrap|plac|hav|keep)(?:s|es|ing)? (?:an|his|her|one|their) arm "
    rf"(?:a?round|over|about) {OTHER}\b"
)
_KISSED = re.compile(rf"(?<!for a )\b{_KISSES}(?! {_LY}(?:\w+ )?(?:hand|goodbye to|\w+'s hand))\b")
_PASSIVE = re.compile(
    r"\b(?:is|are|gets?|being) (?:\w+ly )?"
    r"(?P<verb>patted|tapped|touched|poked|slapped|grabbed|stroked|seized|caught|kissed|massaged|hugged|embraced|cuddled|held|pushed|"
    r"shoved|knocked)\b"
    r"(?P<rest>.*)"
)
_ACTIVE = {"patted": "pats", "grabbed": "grabs", "caught": "catches", "tapped": "taps", "kissed": "kisses",
            "pushed": "pushes", "shoved": "shoves"}  # fmt: skip
_NOT = re.compile(
    r"\b(?:do(?:es)?n't|not|without|never|refus\w+ to|wants? to|tries to|about to|almost|nearly)\b"
)
_OWN = re.compile(r"\bhis own\b|\bher own\b|\btheir own\b")
_MANY = re.compile(
    r"\b(?:again and again|repeatedly|several times|three times|patting|tapping|a few times)\b"
)
_BEHIND = re.compile(r"\bbehind\b")  # also of somebody who stands there
_PATS = re.compile(r"\b(?:pat|tap|prod)\w*|\btwice\b")
_SIDE = re.compile(
    r"\b(?:with|using) (?:his|her|their|the) (left|right)\b|\b(?:his|her|their) (left|right) (?:hand|arm) (?:up)?on"
)


_JOINTS = {
    Region.HEAD: "head", Region.SHOULDER: "{side}_shoulder", Region.BACK: "spine3", Region.CHEST: "spine2",
    Region.WAIST: "spine2",
    Region.ARM: "{side}_elbow", Region.HAND: "{side}_wrist", Region.LEG: "{side}_knee", Region.FOOT: "{side}_ankle",
}  # fmt: skip
_SKIN = 0.1
"""Metres between a wrist and the joint inside the part of the body that its hand is on."""
_KISS = 0.22
"""Metres between two heads at a kiss."""
_ARM = 0.45
"""Metres from the shoulder to the wrist of an arm that is nearly straight."""
_TRUNK = 0.47
"""Metres from the pelvis to the line of the shoulders."""
_HIP = 0.93
"""Height in metres of the pelvis of somebody who stands."""


def contact(sentence: str) -> Contact | None:
    """The first contact that a beat's sentence names, if it does."""
    found = clauses(sentence)
    touch = next((touch for touch in map(_of, found) if touch is not None), None)
    if touch is None or touch.behind:
        return touch
    return replace(touch, behind=any(_BEHIND.search(c.words) for c in found if c.who == touch.person))


def _of(clause: Clause) -> Contact | None:
    words, person = clause.words, clause.who
    if (passive := _PASSIVE.search(words)) is not None:
        stem = _ACTIVE.get(passive["verb"], f"{passive['verb'].removesuffix('ed')}s")
        words, person = f"{stem} them{passive['rest']}", "b" if person == "a" else "a"
    act, denied = _ACTS.search(words), _NOT.search(words)
    kiss = _KISSED.search(words)
    match = act or kiss
    if (hug := _HUGS_BEHIND.search(words)) is not None and not (denied and denied.start() < hug.start()):
        return Contact(person if person != "ab" else "a", Region.WAIST, SIDES, behind=True)
    if person != "ab" and _PUSHES.search(words) and not denied:
        return Contact(person, Region.CHEST, SIDES, 1, fells=True)
    if person == "ab":  # both kiss; of other touches it is not said who of them touches the other
        act, match, person = None, kiss, "a"
    if match is None and person != "ab" and _COMFORTS.search(words) and not denied:
        return Contact(person, Region.SHOULDER, ("right",), late=clause.until)
    if match is None or _OWN.search(words) or (denied and denied.start() < match.start()):
        return None
    if kiss is not None or act is None:
        return Contact(person, Region.HEAD, (), late=clause.until)
    region = next(region for region, _ in _REGIONS if act[region.name])
    side = _SIDE.search(words)
    sides = SIDES if _ON_BOTH.search(words) else ((side[1] or side[2]),) if side else ("right",)
    behind = bool(_BEHIND.search(words)) or (region is Region.SHOULDER and "massag" in words)
    return Contact(person, region, sides, _times(act, words), clause.until, behind)


def _times(act: re.Match[str], words: str) -> int:
    """The number of times that a short touch is made; 0 for one that lasts."""
    if _MANY.search(words):
        return 3
    if not (act["short"] or (act["part"] and _BRIEF.match(act["part"]))):
        return 0
    return 2 if _PATS.search(words) else 1


def reach(touch: Contact, pose: Array) -> float:
    """Metres between the pelvises at which somebody who stands reaches the other, leaning forward where that is low.

    Args:
        touch: the contact.
        pose: (22, 3) metres of the one who is touched.
    """
    height, angle = float(middle(touch, pose)[1]), lean(touch, pose)
    ahead, up = _TRUNK * np.sin(angle), _HIP + _TRUNK * np.cos(angle)
    if not touch.sides:
        return float(ahead + 0.08 + _KISS)
    if touch.region is Region.WAIST:
        return 0.36
    arm = float(np.sqrt(max(_ARM**2 - (up - height) ** 2, 0.1**2)))
    return float(min(ahead + arm, 0.55)) + _SKIN


def lean(touch: Contact, pose: Array) -> float:
    """Radians by which somebody who stands leans forward to touch the other, whose pose (22, 3) is given."""
    least = 0.05 if touch.sides else 0.15
    return float(np.clip(0.1 + 1.2 * (1.3 - middle(touch, pose)[1]), least, 1.0))


def middle(touch: Contact, pose: Array) -> Array:
    """The middle (3,) of the joints of a pose (22, 3) that are touched."""
    return np.asarray(pose)[_joints(touch.region)].mean(axis=0)


def _joints(region: Region) -> list[int]:
    name = _JOINTS[region]
    return [SMPL22.index(name.format(side=side)) for side in (SIDES if "{" in name else SIDES[:1])]


def touched(touch: Contact, other: Array, own: Array) -> Array:
    """The places of the wrists, or of the head, at a contact.

    Args:
        touch: the contact.
        other: (22, 3) metres, a pose of the one who is touched.
        own: (22, 3) metres, a pose of the one who touches, who leans forward at their place.

    Returns:
        (len(sides), 3) metres; (1, 3) for a kiss.
    """
    joints = _joints(touch.region)
    back = other[SMPL22.index("spine3")]
    if touch.region is Region.BACK and float((own[0] - other[0]) @ _facing(other)) > 0:
        joints = _joints(Region.SHOULDER)  # as far as an arm gets round somebody from the front
    if not touch.sides:
        return other[joints[0]] + _KISS * _unit(own[SMPL22.index("head")] - other[joints[0]])[None]
    found = []
    for side in touch.sides:
        shoulder = own[SMPL22.index(f"{side}_shoulder")]
        joint = min(joints, key=lambda j: float(np.linalg.norm(other[j] - shoulder)))
        place = other[joint] + _SKIN * _unit(shoulder - other[joint])
        if touch.region is Region.WAIST:  # the arms go round
            across = _unit((shoulder - own[0]) * [1.0, 0.0, 1.0])
            place = other[joint] + 0.12 * _facing(other) - 0.02 * across + np.array([0.0, 0.02, 0.0])
        elif len(joints) == 1 and len(touch.sides) == 2:
            place = place + 0.08 * _unit((shoulder - own[0]) * [1.0, 0.0, 1.0])
        if touch.region is Region.BACK and len(joints) == 1:
            place = place + 0.05 * _unit(shoulder - back)
        found.append(place)
    return np.stack(found)


def _facing(pose: Array) -> Array:
    angle = float(heading(np.asarray(pose)[None])[0])
    return np.array([np.sin(angle), 0.0, np.cos(angle)])


def _unit(vector: Array) -> Array:
    return vector / max(float(np.linalg.norm(vector)), 1e-6)
