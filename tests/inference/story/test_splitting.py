"""Sentences are split into beats that can be read alone."""

import pytest

from webdemo.inference.story import split_sentence


@pytest.mark.parametrize(
    ("sentence", "beats"),
    [
        ("Two people hug.", ["Two people hug."]),
        ("First they shake hands, then they both walk away.", ["They shake hands.", "They both walk away."]),
        (
            "Person A bows and then walks to person B. Finally both wave.",
            ["Person A bows.", "Person A walks to person B.", "Both wave."],
        ),
        (
            "They walk up to each other, shake hands and part again.",
            ["They walk up to each other.", "They shake hands.", "They part again."],
        ),
        ("They bump fists, and person A then goes away.", ["They bump fists.", "Person A goes away."]),
        ("They hug before they walk away", ["They hug.", "They walk away."]),
        # words without a subject
        ("walk, shake hands", ["They walk up to each other and shake hands."]),
        ("running, hug", ["They run up to each other and hug."]),
        ("strolling and kissing", ["strolling and kissing"]),
        # two show something, then touch
        ("Two friends cheer and hug.", ["They cheer.", "They hug."]),
        ("They smile and shake hands.", ["They smile and shake hands."]),
        # who comes or goes does it before or after the rest
        (
            "A man slaps his friend on the back and strolls off.",
            ["Person A slaps his friend on the back.", "Person A strolls off."],
        ),
        ("She walks over to him and pats him.", ["Person A walks over to him.", "Person A pats him."]),
        (
            "The two hug goodbye, and he leaves while she stays.",
            ["They hug goodbye.", "Person A leaves while person B stays."],
        ),
        ("After a quick high five they run off.", ["A quick high five.", "They run off."]),
        ("high-five, walk", ["High-five.", "Walk."]),
        (
            "He holds out a hand. She looks at it, turns round and leaves.",
            [
                "Person A holds out a hand.",
                "Person B looks at it.",
                "Person B turns round.",
                "Person B leaves.",
            ],
        ),
        (
            "A guard stands at his post; a visitor walks up to him, bows and then waits.",
            [
                "Person A stands at his post and person B walks up to him.",
                "Person B bows.",
                "Person B waits.",
            ],
        ),
        # one thing, or things at the same time
        ("Two joggers run next to each other.", ["Two joggers run next to each other."]),
        ("One falls to the ground and the other helps him up.", None),
        ("They hold hands and walk.", None),
        ("Two people walk up to each other and shake hands.", None),
        ("They stroll along and chat.", None),
        ("She turns round and walks away.", None),
        ("A man walks past another man and waves to him as he goes.", None),
        (
            "Person A pushes person B away and leaves.",
            ["Person A pushes person B away.", "Person A leaves."],
        ),
        ("They jog together until she has to sit down.", ["They jog together.", "Person A has to sit down."]),
        ("A stands up and leaves, B stays.", ["Person A stands up.", "Person A leaves and person B stays."]),
        ("B comes and sits down beside A.", ["Person B comes.", "Person B sits down beside person A."]),
        ("First person A bows.", ["First person A bows."]),
        (
            "She taps him on the shoulder, he turns around, and she gives him a letter.",
            ["Person A taps him on the shoulder.", "Person B turns around.", "Person A gives him a letter."],
        ),
        (
            "He drops to one knee and proposes and they hug.",
            ["Person A kneels down and proposes.", "They hug."],
        ),
        ("They bow, fight and bow again.", ["They bow.", "They fight.", "They bow again."]),
    ],
)
def test_a_sentence_is_split_where_one_thing_follows_another(sentence: str, beats: list[str] | None) -> None:
    assert [beat.words for beat in split_sentence(sentence)] == (beats or [sentence])


def test_nothing_gives_no_beats() -> None:
    assert split_sentence("  \n ") == ()


@pytest.mark.parametrize(
    ("sentence", "beats"),
    [
        ("Sports day: the two race off.", ["Sports day: the two race off."]),
        ("Cha-cha. They dance, then they bow.", ["Cha-cha, they dance.", "They bow."]),
        (
            "Person A runs away, person B hot on their heels.",
            ["Person A runs away, person B hot on their heels."],
        ),
        (
            "Person A waves as she walks away and person B follows.",
            ["Person A waves as she walks away and person B follows."],
        ),
        ("(beat) Joe kneels. Ana walks away.", ["Person A kneels.", "Person B walks away."]),
        ("A high five. They walk away.", ["A high five.", "They walk away."]),
        ('They "hug". They bow. They leave.', ['They "hug".', "They bow.", "They leave."]),
    ],
)
def test_a_setting_is_no_beat_of_its_own(sentence: str, beats: list[str]) -> None:
    assert [beat.words for beat in split_sentence(sentence)] == beats
