"""The names of people: A and B, 1 and 2, or Anna and Tom, spelt out in a way that clauses understand.

These are the only patterns that see a whole story, before it is cut into sentences; they take linear time.
"""

from __future__ import annotations

import re

KIND = (
    r"(?:man|woman|boy|girl|guy|lady|gentleman|person|child|kid|friend|dancer|fighter|boxer|player|stranger|partner|"
    r"teacher|student|mother|father|mom|mum|mommy|mummy|dad|daddy|brother|sister|daughter|son|grandpa|grandma|granny|"
    r"grandfather|grandmother|uncle|aunt|cousin|twin|husband|wife|spouse|fianc[eé]e?|bride|groom|girlfriend|boyfriend|"
    r"buddy|mate|pal|bro|dude|lad|lass|waiter|waitress|guest|host|visitor|guard|boss|manager|employee|worker|intern|"
    r"assistant|secretary|neighbou?r|cop|policeman|policewoman|officer|detective|sheriff|thief|burglar|robber|criminal|"
    r"prisoner|suspect|bully|victim|gangster|soldier|sergeant|cadet|sentry|general|captain|doctor|nurse|medic|patient|"
    r"coach|trainer|referee|ref|umpire|athlete|runner|swimmer|goalkeeper|goalie|striker|defender|attacker|wrestler|king|"
    r"queen|prince|princess|lord|servant|butler|maid|knight|squire|samurai|ninja|warrior|gladiator|pirate|cowboy|wizard|"
    r"witch|vampire|zombie|monster|ghost|robot|alien|hero|heroine|villain|enemy|foe|rival|opponent|npc|avatar|clown|"
    r"actor|actress|singer|musician|director|photographer|painter|artist|barber|hairdresser|tailor|chef|cook|farmer|"
    r"salesman|saleswoman|seller|shopkeeper|cashier|clerk|customer|client|lawyer|judge|priest|monk|nun|pilot|driver|"
    r"passenger|tourist|guide|beggar|baby|toddler|infant|pupil|classmate|teenager|teen|youth|adult|elder|senior|"
    r"colleague|coworker|co-worker|teammate|team-mate|leader|follower|lover|date|crush|ex|couple|human|character|model|"
    r"mime|puppet|individual|agent|spy|assassin|hunter|rider|jogger|cyclist|skater|passer-by|bystander|onlooker)"
)
"""Words for one person."""
NAMED = r"person [ab]"
_LATE = re.compile(
    r"(?<=[a-z])(?<!and)(?<!then)(?<!one)(?<!he)(?<!they)(?<!both)(?<!first)(?<!second)(?<!other)"
    r" (?:finally|eventually)(?= \w+s\b)"
)
"""Marks of time between a name and its verb, which begin nothing new."""
_IS = re.compile(r"\b(he|she|it|they|who|someone|somebody|everyone)'(s|re)\b", re.IGNORECASE)
_AT_THE_SAME_TIME = re.compile(r",? and (?:at the same time|simultaneously),? ", re.IGNORECASE)
_NO_NAME = re.compile(
    r"(?:They|He|She|It|One|Two|Both|The|An?|First|Then|Finally|While|As|When|After|Before|Person|Someone|Somebody|Each|"
    r"People|Everyone|Everybody|Another|His|Her|Their|Suddenly|Without|With|Holding|I|We|You)\b"
)

_NUMBERED = {
    name: re.compile(
        rf"\b(?=(?:the )?[\w-]{{1,14}} ?(?:{number})\b)(?:(?:the )?{KIND} ?(?:{number})|p{number[-1]})\b",
        re.IGNORECASE,
    )
    for name, number in (("A", "one|1|#1"), ("B", "two|2|#2"))
}
"""People called by a number: "person 1", "the man #2", "P1"; looks for the number before it tries the nouns."""


def named(text: str) -> str:
    """The text with people called A and B, 1 and 2, or by a name, called so in a way that clauses understand."""
    text = _IS.sub(lambda m: f"{m[1]} {'is' if m[2] == 's' else 'are'}", text)
    text = _AT_THE_SAME_TIME.sub(" while ", text)
    if re.search(r"\bperson [ab]\b", text, re.IGNORECASE):
        text = re.sub(r"(?<![Pp]erson )\b([AB])\b(?=\s+\w+s\b|'s\b)", r"person \1", text)
    elif re.search(r"\b[Bb]\b", text):
        text = re.sub(r"\b[Bb]\b(?=\s+(?:[a-z]|[-–—])|'s\b|[.,;!?]|$)", "person B", text)
        text = re.sub(
            r"(?<!person )\bA\b(?=,|\s+[-–—]|'s\b|\s+(?:\w+s|\w+ing|\w+ed)\b|[.;!?]|$)", "person A", text
        )
        text = re.sub(r"\ba(?=[.,;!?]|$)", "person A", text)
        text = re.sub(
            r"(?<!person )\bA\b(?= (?:and|in|on|at|by|with|to|from|then|is|has|does|off|over|up|away|aside|for|into"
            r"|onto|around)\b)",
            "person A",
            text,
        )
    text = _LATE.sub("", text)
    for name, numbered in _NUMBERED.items():
        text = numbered.sub(f"person {name}", text)
    return re.sub(
        r"(?<![A-Za-z'])([A-Z][a-z]+)(?= (?:\w+s|\w+ing|and|is|has)\b|'s\b|[.,;]|$)",
        lambda m: m[0] if _is_no_name(m[0]) else f"the {m[0].lower()}",
        text,
    )


_CAPITAL_KIND = re.compile(rf"^{KIND}$", re.IGNORECASE)
_CAPITAL_VERB = re.compile(
    r"^(?:\w+(?:ing|ly|es)$|[A-Z]{2}|(?:High|Low|Fist|Hug|Bow|Wave|Walk|Run|Shake|Kick|Push|Race|Dance|Jump|Hold|Link|"
    r"Join|Take|Swing|Clap|Sit|Stand|Turn|Kneel|Spin|Fight|Box|Hop|Skip|March|Talk|Wrestle|Pat|Tap|Kiss|Throw|Catch|"
    r"Play|Meet|Greet|Stroll|Raise|Lift|Point|Nod|Duck|Punch|Slap|Chase|Follow|Lead|Pull|Carry|Help|Give|Hand|Offer|"
    r"Bump|Circle|Embrace)\b)"
)


def _is_no_name(word: str) -> bool:
    return any(found.match(word) for found in (_NO_NAME, _CAPITAL_VERB, _CAPITAL_KIND))
