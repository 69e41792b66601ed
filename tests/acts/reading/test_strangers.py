"""Mechanisms that sentences of strangers asked for, each by an example that is read wrongly without it."""

import pytest

from acts import Act, read
from acts.plan import FROM_BEHIND
from tests.acts.reading.reading import told


@pytest.mark.parametrize(
    ("text", "acts"),
    [
        # what is refused is what one would do with an offer
        ("A offers B a cup and B refuses it.", [("offer-thing", "a", "b"), ("take-from", "b", "a")]),
        ("A holds out a hand and B refuses it.", [("offer-thing", "a", "b"), ("hold-hands", "b", "a")]),
        # a list behind two who come to each other, and what nobody can show
        (
            "They walk up to each other and hug. Then they dance together.",
            [("walk-up", "ab", None), ("hug", "ab", None), ("dance", "ab", None)],
        ),
        ("A dragon eats the moon.", []),
        # a hand that is caught, where nobody falls
        ("A catches B by the wrist.", [("hold-hands", "a", "b")]),
        # an act that the next one begins with
        ("A bends down, picks up a cup and bows.", [("pick-up-thing", "a", None), ("bow", "a", None)]),
        ("A bends down twice and picks up a cup.", [("bend-down", "a", None), ("pick-up-thing", "a", None)]),
        # a list that goes on in a relative clause, and a verb that is done in return
        (
            "One shoves the other, who stumbles, regains balance and shoves back.",
            [("push", "a", "b"), ("stumble", "b", None), ("stand-still", "b", None), ("push", "b", "a")],
        ),
        # whose shoes they are
        ("A sits down and B ties his shoes for him.", [("sit-down", "a", None), ("tie-other-shoes", "b", "a")]),
        ("A turns away and covers his face.", [("turn-away", "a", "b"), ("cover-face", "a", None)]),
        # WordNet's verbs with their particles
        ("He is bowled over.", [("push-over", "b", "a")]),
        ("He dozes off.", [("lie-down", "a", None)]),
        # a full stop that is missing
        ("A hugs B from behind", [("hug-from-behind", "a", "b")]),
        ("dad and daughter walking hand in hand", [("walk-hand-in-hand", "ab", None)]),
        # a verb where the parser saw none
        ("The person on the left squats twice and the other one claps.", [("crouch", "a", None), ("clap", "b", "a")]),
        # the other is the other of the one who was named first
        ("One person pushes the other and the other sits down.", [("push", "a", "b"), ("sit-down", "b", None)]),
        # "the other ducks" may be birds to the parser
        ("A man punches and the other ducks.", [("punch", "a", None), ("duck", "b", None)]),
        # nouns that are people where they act
        ("emma pinches jakes cheek, jake runs off", [("pinch", "a", "b"), ("run-away", "b", "a")]),
        # an order about one other person is given to one
        ("carry your injured friend over your shoulder", [("carry", "a", "b")]),
        # a clause that the parser made a subject
        ("tickel him", [("tickle", "a", "b")]),
        ("An elderly lady pats an old man on the back.", [("pat", "a", "b")]),
        ("She crawls on hands and knees around him.", [("crawl-under", "a", "b")]),
        # an adverb that the parser takes for a verb, and a safe verb that it takes for an auxiliary
        ("The waiter bows stiffly and pours wine for the lady.", [("bow", "a", None), ("pour-for", "a", "b")]),
        ("These two shake hands.", [("shake-hands", "ab", None)]),
        ("They both reply with a nod.", [("nod", "ab", None)]),
        # a participle that says how somebody is
        ("Seated on the floor, she claps.", [("sit-on-floor", "a", None), ("clap", "a", "b")]),
        (
            "He walks up to her, hands over a parcel and leaves.",
            [("walk-up", "a", "b"), ("hand-over", "a", "b"), ("walk-away", "a", "b")],
        ),
        (
            "hold hands, swing arms, walk",
            [("hold-hands", "ab", None), ("swing-arms", "ab", None), ("walk-together", "ab", None)],
        ),
        ("person 2 tails person 1 down the street", [("follow", "b", "a")]),
        ("Tom helps Jerry up off the ground.", [("help-up", "a", "b")]),
        ("The one on the left waves, and the one on the right bows.", [("wave", "a", "b"), ("bow", "b", None)]),
        # what the two do to each other's hands, to things, and with one's own body
        ("They clap hands with each other.", [("clap-each-other", "ab", None)]),
        ("A taps B and touches the left wrist.", [("pat", "a", "b"), ("touch-own", "a", None)]),
        ("a person grabs something with both hands", [("grab-thing", "a", None)]),
        ("a person moves objects on a shelf", [("move-thing", "a", None)]),
        ("a person returns to a standing position", [("stand-still", "a", None)]),
        # a sentence that names nobody is about one, where its verb says so
        ("B waves.", [("wave", "b", "a")]),
        ("walks forward and sits", [("walk-ahead", "a", None), ("sit-down", "a", None)]),
        ("raises left arm and scratches his head", [("raise-arm", "a", None), ("scratch-head", "a", None)]),
        ("walking in a circular motion.", [("walk-in-circle", "a", None)]),
        ("pushes the other away", [("push", "a", "b")]),
        ("walks up to each other and hugs", [("walk-up", "ab", None), ("hug", "ab", None)]),
        # words that are misspelt, also those of directions and people
        ("a perosn walks foward in a cricle", [("walk-in-circle", "a", None)]),
        # where arms are while one walks, and a side that is said after a pair of words
        ("a man walks backwards with his arms out to his side", [("step-back", "a", None), ("arms-out", "a", None)]),
        ("a man side steps to the left and then to the right", [("step-aside", "a", None), ("step-aside", "a", None)]),
        ("a person walks forward and then backwards.", [("walk-ahead", "a", None), ("step-back", "a", None)]),
        ("a person limps on their left foot.", [("limp-along", "a", None)]),
        ("a person stands with both hands up.", [("stand-still", "a", None), ("raise-arm", "a", None)]),
        ("the man places both hands back at his sides.", [("lower-arm", "a", None)]),
        ("holding hands", [("hold-hands", "ab", None)]),
        ("a man tilts left and right quickly.", [("lean", "a", None), ("lean", "a", None)]),
        (
            "a person walks forward picks up an object and walks back",
            [("walk-ahead", "a", None), ("pick-up-thing", "a", None), ("go-back", "a", None)],
        ),
        # captions of one person, where the other hand, another ball and the first step name nobody else
        ("a person crosses one foot over the other", [("cross-legs", "a", None)]),
        ("a person catches a ball, then throws another ball", [("catch-thing", "a", None), ("throw-ball", "a", "b")]),
        ("a person walks in a figure of eight", [("walk-ahead", "a", None)]),
        ("a person is pulled by the elbow", [("lead", "b", "a")]),
        ("a person continues walking backwards", [("step-back", "a", None)]),
        ("a person waves their hand side to side", [("wave", "a", "b")]),
        ("He strokes her left cheek.", [("touch", "a", "b")]),
        ("He pulls her close.", [("pull", "a", "b")]),
        ("She raises a hand high.", [("raise-arm", "a", None)]),
        ("the man looks to left, then turns to right", [("look-around", "a", None), ("turn-around", "a", None)]),
        ("They tap dance.", [("dance", "ab", None)]),
        ("A punches with alternating hands.", [("punch", "a", None)]),
        ("He places a palm on her lower back.", [("hand-on", "a", "b")]),
        ("She jumps on his back and he carries her.", [("ride-back", "a", "b"), ("carry-back", "b", "a")]),
        ("They circle each other, three metres apart.", [("circle-together", "ab", None)]),
        ("They bow to the audience.", [("bow", "ab", None), ("form-line", "ab", None)]),
        ("An actor takes a bow and the audience claps.", [("bow", "a", None), ("clap", "b", "a")]),
        ("A man walks with arms outstretched as if on a rope.", [("walk-ahead", "a", None), ("extend-arm", "a", None)]),
        (
            "a person moves his hand in a circular motion and lets it fall",
            [("circle-arms", "a", None), ("lower-arm", "a", None)],
        ),
        # both do what two people do
        ("Two people do jumping jacks.", [("jumping-jacks", "ab", None)]),
        # an object that the parser hangs on the verb before
        ("B stands behind A and massages A's shoulders.", [("stand-behind", "b", "a"), ("massage", "b", "a")]),
        # a noun that stands for what is done
        ("B returns the salute.", [("salute", "b", "a")]),
        ("A throws a ball to B and B hits it back.", [("throw-ball", "a", "b"), ("rackets", "b", None)]),
        # neither of the two
        ("He walks a dog.", [("walk-ahead", "a", None)]),
        ("He hugs a dog.", [("feed-animal", "a", None)]),
        ("A person shakes his head left and right.", [("shake-head", "a", None)]),
        # with a part of the body
        ("A person kicks using the right leg.", [("kick", "a", None)]),
        ("His right hand picks up something.", [("pick-up-thing", "a", None)]),
        ("A person drags right leg and waves.", [("swing-leg", "a", None), ("wave", "a", "b")]),
        ("A man nods and moves his hands in front of him.", [("nod", "a", None), ("swing-arms", "a", None)]),
        ("A person holds out both arms and lowers them.", [("extend-arm", "a", None), ("lower-arm", "a", None)]),
        ("A person lifts her left arm and right knee.", [("raise-arm", "a", None), ("raise-knee", "a", None)]),
        ("A boy kicks with his left foot, then the right foot.", [("kick", "a", None)] * 2),
        ("She turns left, then right.", [("turn-around", "a", None)] * 2),
        ("A person makes a bowing motion.", [("bow", "a", None)]),
        ("A man does the motion of digging.", [("dig", "a", None)]),
        ("A man walks back and returns to the original position.", [("go-back", "a", None)] * 2),
        ("B takes both of A's hands and pulls A up.", [("hold-hands", "b", "a"), ("help-up", "b", "a")]),
        ("They hold hands and spin around each other.", [("hold-hands", "ab", None), ("ring", "ab", None)]),
        ("A person who is standing takes two steps.", [("stand-still", "a", None), ("step-forward", "a", None)]),
        ("The person raises its arms.", [("raise-arm", "a", None)]),
        # nobody else is there, so nothing is done to them
        ("A person puts the left hand out.", [("extend-arm", "a", None)]),
        ("A person takes something.", [("grab-thing", "a", None)]),
        # "it" is what was lifted, and a figure
        (
            "A man raises his left hand, rubs his head and then lowers it.",
            [("raise-arm", "a", None), ("scratch-head", "a", None), ("lower-arm", "a", None)],
        ),
        ("A figure jumps, and it waves.", [("jump", "a", None), ("wave", "a", "b")]),
        # a particle that only says which way
        ("A tiptoes up and taps B on the shoulder.", [("walk-up", "a", None), ("pat", "a", "b")]),
        # a verb within a word
        ("They line-dance.", [("dance", "ab", None)]),
        # verbs that mean too many things stand for no others
        ("A man walks and hops sideways.", [("walk-ahead", "a", None), ("jump", "a", None)]),
        ("A man walks down a ramp.", [("walk-ahead", "a", None)]),
        ("A man holds the pose.", [("stand-still", "a", None)]),
        ("A man leans on his knees.", [("lean", "a", None)]),
        ("A man pats the top of his head.", [("touch-face", "a", None)]),
        ("A couple of men hug.", [("hug", "ab", None)]),
        ("A looks into B's eyes.", [("face-other", "a", "b")]),
        ("He frowns.", []),
        # names are no misspelt verbs, and a letter before "is" is one
        ("Tom pushes Leah.", [("push", "a", "b")]),
        ("A is kneeling.", [("kneel", "a", None)]),
        # together, and not past each other
        ("Two men stagger along the road.", [("walk-together", "ab", None)]),
        ("A nurse helps a man get up and walks with him.", [("help-up", "a", "b"), ("walk-together", "a", "b")]),
        ("A nurse walks with her patient arm in arm.", [("walk-hand-in-hand", "a", "b")]),
        ("She opens her arms and he runs into them.", [("arms-out", "a", None), ("hug", "b", "a")]),
        # verbs that the parser takes for nouns, or nouns for verbs
        ("Wave, bow and leave.", [("wave", "ab", None), ("bow", "ab", None), ("walk-away", "ab", None)]),
        ("One does ten jumping jacks while the other bows.", [("jumping-jacks", "a", None), ("bow", "b", None)]),
        ("He looks left and right for her.", [("look-around", "a", "b")]),
        # two steps through WordNet lead anywhere: "tucks" to opening something, "lands" to following
        ("He tucks the letter into his pocket.", []),
    ],
)
def test_a_sentence_is_read(text: str, acts: list[tuple[str, str, str | None]]) -> None:
    assert told(text) == acts


def only(text: str) -> Act:
    (act,) = read(text).acts
    return act


def test_a_noun_is_not_forced_to_be_a_verb() -> None:
    for text in ("Her head swims.", "The flag flaps.", "The bridge kneels.", "He looks at her hands."):
        assert not read(text).acts, text


def test_a_repeated_act_is_done_with_the_same_side_or_the_one_that_is_named() -> None:
    for words, side in (("does the same", "left"), ("mirrors her with the right", "right")):
        first, again = read(f"A raises the left arm and B {words}.").acts
        assert (first.side, again.side) == ("left", side)


@pytest.mark.parametrize("joined", ["{}, and {}", "{} and {}"])
@pytest.mark.parametrize("start", ["Two people walk up to each other", "They walk up"])
@pytest.mark.parametrize(
    ("said", "act"), [*((verb, verb) for verb in ("hug", "kiss", "dance", "fight", "talk")), ("high five", "high-five")]
)
def test_a_list_keeps_its_middle(start: str, said: str, act: str, joined: str) -> None:
    acts = [name for name, _, _ in told(joined.format(f"{start}, {said}", "walk away."))]
    assert acts == ["walk-up", act, "walk-away"]


def test_words_in_no_act_are_said() -> None:
    plan = read("A picks up a cup and a plate.")
    assert [plan.text(part.words) for part in plan.unread] == ["plate"]


@pytest.mark.parametrize(
    ("sentence", "acts"),
    [
        ("B dances while A turns to watch.", [("dance", "b", "done"), ("turn-to", "a", "done")]),
        ("Kneeling, A holds out a hand to B.", [("kneel", "a", "done"), ("offer-thing", "a", "done")]),
        ("The mother, kneeling, ties his shoes.", [("kneel", "a", "done"), ("tie-other-shoes", "a", "done")]),
        ("A, run at B.", [("run-up", "a", "done")]),
        ("A gets a hug from B.", [("hug", "b", "done")]),
        ("A does not wave or bow.", [("wave", "a", "not"), ("bow", "a", "not")]),
        ("A gives B no hug.", [("hug", "a", "not")]),
    ],
)
def test_clauses_of_few_words_keep_who_does_what_and_whether(sentence: str, acts: list[tuple[str, str, str]]) -> None:
    assert [(act.act, "".join(act.agents), act.polarity) for act in read(sentence).acts] == acts


def test_what_is_prevented_is_not_asked_for() -> None:
    assert [act.modality for act in read("A catches B before he falls.").acts] == ["told", "wished"]


@pytest.mark.parametrize(
    ("text", "fields"),
    [
        ("A lifts B's left leg.", {"side": None, "part_side": "left"}),
        ("A ties the left shoe of B.", {"side": None, "part_side": "left"}),
        ("She taps him on the right shoulder.", {"side": None, "part_side": "right"}),
        ("A touches B's left shoulder with the right hand.", {"side": "right", "part_side": "left"}),
        ("They touch each other's left shoulder.", {"side": None, "part_side": "left"}),
        ("B parries A's left punch.", {"side": None, "part_side": None}),
        ("A throws a left hook.", {"side": "left", "part_side": None}),
        ("A raises the right arm.", {"side": "right", "part_side": None}),
        ("a person uses the left hand to throw a ball", {"act": "throw-ball", "side": "left"}),
        ("The man uses his left hand to wave.", {"act": "wave", "side": "left"}),
        ("She pokes him in the ribs with her index finger.", {"part": "rib", "part_of": "b"}),
        ("He makes a vertical waving motion.", {"manner": ("vertically",)}),
        ("A person makes a right turn.", {"direction": "right"}),
        ("He throws his hat on the floor.", {"patient": None, "direction": "down"}),
        ("a person remains seated", {"already": True}),
        ("She fakes a kick.", {"modality": "pretended"}),
        ("She has finished stretching.", {"polarity": "done"}),
        ("A taps B on the shoulder from behind.", {"manner": (FROM_BEHIND,)}),
        ("A man walks in a clockwise circle.", {"direction": "clockwise"}),
        ("A man walks in a circle clockwise.", {"direction": "clockwise"}),
        ("A man walks in a circle, clockwise.", {"direction": "clockwise"}),
    ],
)
def test_an_act_is_what_the_words_say(text: str, fields: dict[str, object]) -> None:
    act = only(text)
    assert {name: getattr(act, name) for name in fields} == fields
