"""Ways of moving over the floor, and the words that name them."""

from __future__ import annotations

import re
from enum import Enum


class Way(Enum):
    """A way of moving over the floor, or of staying."""

    TO = "walks up to the other"
    BEHIND = "comes up behind the other"
    AWAY = "walks away from the other"
    BACK = "steps back"
    PAST = "walks past the other"
    ROUND = "walks around the other"
    ALONG = "walks side by side with the other"
    AFTER = "follows the other"
    HOLD = "goes round with the other, in hold"
    SPAR = "stands before the other"
    TURN = "turns around"
    AVERTED = "stands with their back to the other"
    ASIDE = "steps aside"
    FACE = "turns to the other"
    BACKS = "stands with their back to the other's"
    AHEAD = "walks ahead"
    PACE = "walks to and fro"
    STAY = "stays in place"


_GO = (
    r"(?:walk|go|goes|going|stroll|wander|run|jog|rush|hurr[yi]|sprint|dash|march|strid|stomp|storm|step|mov|creep|"
    r"(?<!the )(?<!his )(?<!her )(?<!their )head|"
    r"sneak|tiptoe|wade|shuffl|limp|stagger|skip|danc|drift|saunter|trot|charg|stumbl|ambl|pac(?:e|ing)|bolt|scurr[yi]|"
    r"dart|trudg|plod|glid|swagger|slip|roam|parad|scamper|hobbl|totter|stalk|pranc|inch|race|racing|spring|squeez|"
    r"brush|sidl|mosey|swan|strut|waddl|toddl|scuttl|scoot|lumber|lurch|slink|steal|prowl|stump|clomp|tramp|traips|"
    r"canter|gallop|hasten|hurtl|zoom|zip|speed|tear|shoot|barg|breez|bustl|flounc|sashay|sweep|weav|zigzag|gambol|hik|"
    r"lop|meander|mill|pad|potter|rambl|scrambl|skulk|slither|slop|sleepwalk|slouch|bound|hotfoot|power|nip|pop|travel|"
    r"wend|goose-?step|moonwalk)\w*"
)
_OTHER = r"(?:person [ab]|(?:the|his|her|their|an?|another) (?:\w+ )?\w+|him|her|them|each other|one another)"
_PERSON = (
    r"(?:person [ab]|each other|one another|him|her|them|the (?:other|first|second)(?: person| one)?"
    r"|(?:the|an?|another) (?:man|woman|boy|girl|person|stranger|friend))"
)
_AROUND = r"(?:a?round)"
_HIS = r"(?:his|her|their)"
_PLACES = re.compile(
    r"\b(?:to|towards?|for|into|through|out of) (?:the|an?|his|her|their) (?:\w+ )?(?:door|exit|window|kitchen|car|bus|"
    r"train|taxi|house|home|street|park|shop|store|office|school|bar|bathroom|bedroom|garden|gate|corner|stairs|hall|"
    r"fridge|bed|stage|shower|forest|woods|beach|water|lift|elevator|goal|finish line|shelf|cupboard)s?\b"
)
"""Places that are not where the other person is."""
_WAYS: tuple[tuple[Way, tuple[str, ...]], ...] = (
    (Way.BACKS, (r"\b(?:stand|sit|lean|wait)\w* (?:\w+ )?back[- ]to[- ]back\b", r"^back[- ]to[- ]back\b")),
    (
        Way.AVERTED,
        (
            r"\b(?:with|has|have|keeps?) (?:his|her|their) back(?:s)? (?:to|turned|towards)\b",
            r"\b(?:is|stands?|sits?|waits?) (?:facing|turned|looking) (?:away\b|the other way\b)",
        ),
    ),
    (
        Way.AFTER,
        (
            r"\b(?:follow|chas|pursu|trail|shadow)\w*|\btags? along\b|\btails\b",
            rf"\b{_GO} (?:\w+ )?after {_OTHER}",
            rf"\b(?:walk|stroll|march|run|jog|trot)\w* (?:(?!up\b)\w+ ){{0,2}}?behind {_OTHER}",
            r"\bin pursuit\b|\b(?:hot |close )?on (?:his|her|their|person [ab]'s|the other's) heels\b",
        ),
    ),
    (
        Way.BEHIND,
        (
            rf"\b(?:{_GO}|com\w+|approach\w*) (?:\w+ )?(?:up )?(?:from )?behind\b",
            r"\bapproach\w* .*\bfrom behind\b",
            rf"\b(?:sneak|creep|steal)s? up on {_OTHER}",
        ),
    ),
    (
        Way.PAST,
        (
            rf"\b(?:{_GO}|com\w+) (?:\w+ )?(?:past\b|(?<!side )by\b(?! the (?:hand|arm)| side))",
            r"\bovertak\w+|^(?:right|straight|just) past\b",
            rf"\bpass(?:es|ing)? (?:by\b|{_PERSON}(?! (?:an?|the)\b))",
        ),
    ),
    (
        Way.ROUND,
        (
            rf"\bcircl\w+ (?:{_AROUND} )?{_OTHER}",
            r"\borbit\w*",
            rf"\b(?!turn|spin|look){_GO} (?:\w+ ){{0,5}}?{_AROUND}(?: and around)? {_OTHER}",
            rf"\b{_GO} in (?:a )?circles? {_AROUND}",
        ),
    ),
    (
        Way.BACK,
        (
            r"\b(?:back|step|mov|shrink|jump|hop|walk|go|tak|retreat|recoil|stagger|stumbl|edg|flinch|lean)\w*"
            r" (?:(?:a|one|two|\w+) (?:step|pace)s? )?(?:away backwards|backwards?|back(?! to(?!\w)| into)\b"
            r"|off a step)",
            r"\bbacks? (?:away|off|up)\b",
            r"\bbacking (?:away|off)",
            r"\bretreats?\b",
            r"\brecoils?\b",
            r"\b(?:shies|shy|shrinks?|flinch\w*) away\b",
        ),
    ),
    (
        Way.ASIDE,
        (
            r"\b(?:step|mov|jump|dodg|leap|hop|slip|duck)\w* (?:\w+ )?(?:aside|sideways)\b",
            r"\b(?:step|mov|jump|dodg|leap|hop)\w* to (?:the|one|his|her|their) (?:\w+ )?side\b",
            r"\bout of the way\b",
            r"\bmakes? way\b(?! (?:to|over|up))",
            r"\bsidesteps?\b",
        ),
    ),
    (
        Way.AWAY,
        (
            rf"\b{_GO} (?:\w+ ){{0,2}}?(?:away|off|out\b(?! (?:a|the|his|her|their) (?:hand|arm))|home|elsewhere)\b",
            r"\bleav(?:e|es|ing)\b(?! \w+ (?:hand|arm))",
            r"\b(?:depart|separat|escap|withdr[ae]w|disappear|vanish)\w*",
            r"\b(?:mak|tak)(?:e|es|ing) off\b(?! (?:together|side by side|in the same))",
            r"\btak(?:es?|ing) (?:his|her|their) leave\b",
            r"\bon (?:his|her|their) heels?\b",
            r"\bgets? away\b",
            r"\bpart(?:s|ing)?(?: again| ways| company)?$",
            r"\b(?:go|goes|going|walk|head|run)\w* (?:\w+ )?(?:their|his|her) (?:separate |own |different )?ways?\b",
            r"\bopposite directions\b",
            rf"\b{_GO} apart\b",
            r"\bheads? for\b",
            rf"\b(?:go|goes|walks?|heads?|runs?|gets?) back to (?!(?!her (?!\w+ly\b|again\b)\w){_PERSON})",
            r"\bsplit up\b",
            r"\bflees?\b",
            r"\bexits?\b",
            r"\bsets? off\b(?! together| side)",
            r"\bcarr(?:y|ies) on\b",
            r"\b(?:run|walk|go|jog)s? on ahead\b",
            r"\bgoes on\b",
            r"\bon (?:his|her|their) way out\b",
        ),
    ),
    (
        Way.ALONG,
        (
            rf"\b{_GO} (?:\w+ ){{0,3}}?(?:side by side|next to (?:each other|one another)|abreast|in step|hand in hand|"
            r"arm in arm|together|alongside|beside|shoulder to shoulder|"
            r"with (?:each other|him|her|them|person [ab]|the other)|in (?:the )?(?:same direction|parallel))",
            r"\baccompan\w+",
            r"\bsets? off (?:together|side by side)\b",
            r"\bin the same direction\b",
            r"\bkeep\w* (?:pace|up) with\b",
            rf"\b(?:side by side|next to each other|hand in hand|arm in arm)\b.*\b{_GO}",
            rf"\b{_GO} (?:on|along)\b",
        ),
    ),
    (
        Way.TO,
        (
            rf"\b(?:{_GO}|com\w+|return\w*) (?:\w+ ){{0,2}}?(?:up to|over to|towards?|closer|nearer|running"
            r"|over\b(?! (?:him|her|it|the|person))"
            rf"|in\b|to {_OTHER}|right up)",
            r"\bcom(?:e|es|ing) (?:up |over |closer|nearer|running|back|along)",
            r"\bcomes?(?: over| closer| nearer)?$",
            rf"\b(?:walks?|comes?|runs?|steps?) up$|\b(?:walk|run|bump|crash)s? (?:\w+ )?into {_OTHER}",
            r"\bcollid\w+",
            r"\b(?:approach|joins?)\w*|\bmeets?\b|\bmeeting\b(?! (?:is|over))|\bkeeps? (?:on )?coming\b",
            r"\bclos\w+ (?:in|the (?:gap|distance))\b",
            r"\bgets? (?:closer|nearer)\b",
            r"\badvanc(?:e|es|ing)\b",
            r"\bmak(?:es?|ing) (?:his|her|their) way (?:over|up|to)\b",
        ),
    ),
    (
        Way.AHEAD,
        (
            r"\b(?:tak(?:es?|ing)|steps?|moves?|walks?|goes|comes?) (?:\w+ ){0,3}?forwards?\b",
            r"\b(?:walk|go|goes|march|tak)\w* (?:(?:a|the|few|some|several|three|four|five|ten) )+"
            r"(?:steps|paces)\b(?! to)",
        ),
    ),
    (
        Way.PACE,
        (
            r"\bpac(?:e|es|ing)\b(?! (?:a?round|behind|up to|away|towards|after|over)\b)",
            r"\bto-and-fro\b",
        ),
    ),
    (
        Way.FACE,
        (
            rf"\bturn\w* (?:all the way )?(?:{_AROUND} )?(?:to|towards) (?!go|leave|walk)",
            r"\bface each other\b",
            rf"\bturns? to {_PERSON}",
            r"\b(?:comes?|turns?|swings?|spins?) (?:back )?(?:a?round|about) to (?:face|look)",
        ),
    ),
    (
        Way.TURN,
        (
            r"\babout[- ]face\b",
            r"^turns?$",
            rf"\bturn\w* (?:\w+ ){{0,3}}?(?:{_AROUND}\b|away|back\b|{_HIS} backs?)",
            r"\b(?:spin|pirouette|twirl|whirl|pivot|swivel|rotat)\w*\b|\b(?:wheel|swing|whip)s? (?:a?round|about)\b",
        ),
    ),
    (
        Way.STAY,
        (
            r"(?<!n't )(?<!not )(?<!never )\b(?:stay|stand|wait|remain|watch|look|freez|stop|paus|halt|linger)\w*",
            r"\bholds? still\b",
            r"\brooted\b",
            r"\bdo(?:es)? ?n[o']t (?:move|react|budge|follow)\b",
            r"\bon the spot\b",
            r"\brefus\w+ to (?:come|move|follow|budge)",
            r"\b(?:motionless|immobile)\b",
            r"\bkeeps? still\b",
        ),
    ),
)
_PATTERNS = tuple((way, re.compile("|".join(patterns))) for way, patterns in _WAYS)
_PERSON_NAMED = re.compile(
    r"\b(?:to|towards?|up|over|at|join\w*|meet\w*) (?:person [ab]|him|her|them|each other|the other)\b"
)
_NOT = re.compile(r"\b(?:do(?:es)?n't|not|without|never|refus\w+ to|wants? to|tries to|let(?:s|ting)?)\b")


def way_of(words: str) -> Way | None:
    """The way of moving that a clause's words name, if they do."""
    denied = _NOT.search(words)
    for way, pattern in _PATTERNS:
        found = pattern.search(words)
        if found is None:
            continue
        if way is not Way.STAY and denied is not None and denied.start() < found.start():
            continue
        if way is Way.TO and _PLACES.search(words) and not _PERSON_NAMED.search(words):
            return Way.AWAY
        return way
    return None
