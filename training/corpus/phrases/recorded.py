"""Classes of SBU and K3HI that no composed family has, in words."""

from __future__ import annotations

from .entry import Entry

RECORDED: dict[str, Entry] = {
    "approach": Entry(
        "while",
        ("*walk towards {other}", "*approach( {other}|)", "*come closer( to {other}|)", "*walk up to {other}"),
        ("*stand still", "*wait", "*stand there", "*watch {them} come"),
        (),
        ("approaching", "walking towards someone", "coming closer"),
        ("{B} *is approached by {A}.", "{A} *come nearer to {B}."),
    ),
    "depart": Entry(
        "while",
        ("*walk away( from {other}|)", "*depart", "*leave( {other}|)", "*move away from {other}"),
        ("*stand still", "*stay( behind|)", "*stand there", "*remain in place"),
        (),
        ("departing", "walking away", "leaving someone"),
        ("{B} *is left alone by {A}.", "{A} *move farther from {B}."),
    ),
    "exchange": Entry(
        "reply",
        ("*hand {thing} to {other}", "*pass {thing}( to {other}|)", "*give {thing} to {other}", "*hold {thing} out"),
        ("*take it", "*receive it", "*accept {the_thing}", "*reach out to take it"),
        ("*exchange {thing}", "*pass {thing} between them"),
        ("exchanging {thing}", "passing {thing}", "an exchange", "object exchange"),
        ("{B} *take {thing} from {A}.", "{B} *receive {thing} from {A}."),
    ),
}  # fmt: skip
