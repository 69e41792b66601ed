"""What the corpus' captions say: the phrase book's words, one entry a family.

Notation (read by :mod:`training.corpus.captions`):
    ``(a|b|)``  one of the alternatives, the last of which is empty here;
    ``*verb``   agrees with its subject: waves, wave, waving;
    ``{other}`` ``{them}`` ``{theirs}``  the other person, by noun, pronoun or possessive; ``{their}`` one's own;
    ``{with_hand}`` ``{hand}`` ``{with_foot}`` ``{to_side}`` ``{round}``  filled from the side that a scene names, or neutral;
    ``{thing}`` ``{the_thing}``  an object that the motion cannot show.
Verb phrases of ``a`` and ``b`` have that person as the subject, those of ``both`` the two people; ``nouns``
are keyword-like prompts; ``sentences`` are whole sentences with ``{A}`` and ``{B}``.
"""

# ruff: noqa: E501 (a table of phrases reads better unbroken)

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Entry:
    """The words of one family.

    Attributes:
        frames: how the two verb phrases are joined: "reply" (b answers a), "order" (one after the other)
            or "while" (at the same time).
        a, b: verb phrases of the two people.
        both: verb phrases with the two people as the subject.
        nouns: keyword-like prompts.
        sentences: whole sentences.
    """

    frames: str
    a: tuple[str, ...] = ()
    b: tuple[str, ...] = ()
    both: tuple[str, ...] = ()
    nouns: tuple[str, ...] = ()
    sentences: tuple[str, ...] = ()


ACTIONS: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    # action: (verb phrases, nouns)
    "bow": (("*bow( politely|)", "*take a bow", "*bow to {other}", "*make a bow", "*bend forward in a bow"),
            ("a bow", "bowing")),
    "wave": (("*wave{with_hand}", "*wave {hand}", "*wave at {other}{with_hand}", "*give a wave{with_hand}"),
             ("a wave", "waving")),
    "bye": (("*wave goodbye{with_hand}", "*say goodbye", "*wave farewell{with_hand}", "*wave bye{with_hand}"),
            ("a goodbye", "waving goodbye")),
    "call": (("*call {other} over", "*beckon{with_hand}", "*call out to {other}", "*signal {other} to come"),
             ("a call", "beckoning")),
    "raise-hand": (("*raise {hand}", "*lift {hand}( up|)", "*put {hand} up", "*hold {hand} up"),
                   ("a raised hand", "raising a hand")),
    "raise-hands": (("*raise both hands", "*lift both (hands|arms)", "*put both hands up", "*throw both arms up"),
                    ("raised hands", "both hands up")),
    "cheer": (("*cheer", "*cheer with both arms up", "*raise both hands and *cheer", "*throw both arms up in joy"),
              ("a cheer", "cheering")),
    "dance": (("*dance", "*do a dance", "*dance on the spot", "*perform a short dance"), ("a dance", "dancing")),
    "guide": (("*show the way{with_hand}", "*point the way", "*gesture the way{with_hand}"),
              ("a guiding gesture", "showing the way")),
    "point": (("*point at {other}{with_hand}", "*point a finger at {other}", "*point{with_hand} at {other}"),
              ("pointing",)),
    "kick": (("*kick{with_foot}", "*throw a kick{with_foot}", "*do a kick"), ("a kick", "kicking")),
    "punch": (("*punch{with_hand}", "*throw (a punch|punches)", "*swing {their} fists"),
              ("a punch", "punching")),
    "slash": (("*swing a sword", "*slash with a sword", "*make a sword cut"), ("a sword slash", "slashing")),
    "respond": (("*answer with a gesture", "*respond with a gesture", "*make an answering gesture"),
                ("a response", "responding")),
    "walk": (("*walk( forward|)", "*take a walk", "*walk along", "*stroll"), ("a walk", "walking")),
    "walk-turn": (("*walk and *turn{to_side}", "*walk, turning{to_side}", "*make a turn{to_side} while walking"),
                  ("a walk with a turn", "walking and turning")),
    "turn": (("*turn{to_side}", "*turn around{to_side}", "*make a turn{to_side}"), ("a turn", "turning")),
    "run": (("*run", "*run along", "*jog", "*go running"), ("a run", "running")),
    "dash": (("*dash", "*rush forward", "*stride in a hurry", "*hurry along"), ("a dash", "rushing")),
    "walk-back": (("*walk backwards", "*back away", "*step back", "*walk back"), ("a step back", "backing away")),
    "walk-left": (("*walk to the left", "*walk off to the left", "*go to the left"),
                  ("a walk to the left",)),
    "walk-right": (("*walk to the right", "*walk off to the right", "*go to the right"),
                   ("a walk to the right",)),
    "idle": (("*stand still", "*wait", "*stand idle", "*watch"), ("standing still", "waiting")),
    "talk": (("*talk with (lively |)gestures", "*talk and *gesture", "*explain something with {their} hands"),
             ("talking", "a talk")),
}  # fmt: skip

_WATCH = (
    "*watch( {them}|)",
    "*look on",
    "*stand (still |)and *watch",
    "*watch {other}",
    "*stand by",
    "*stand still",
)
_BACK = ("*step back", "*back away", "*move back", "*retreat( a few steps|)", "*walk backwards")
_COME = ("*come( over|)", "*walk over( to {them}|)", "*come to {other}", "*approach", "*walk up to {other}")
_RECOIL = ("*recoil", "*flinch back", "*reel( back|)", "*stagger back", "*take the hit and *step back")
_STUMBLE = ("*stumble back(wards|)", "*stagger back(wards|)", "*lose {their} balance and *step back", "*is pushed back",
            "*step back")  # fmt: skip

ENTRIES: dict[str, Entry] = {
    # ---- gestures ------------------------------------------------------------------------------------
    "wave-back": Entry(
        "reply",
        ("*wave{with_hand}", "*wave at {other}{with_hand}", "*greet {other} with a wave", "*wave hello{with_hand}"),
        ("*wave back{with_hand}", "*return the wave", "*wave (too|as well){with_hand}", "*wave in return"),
        ("*wave at each other", "*greet each other with a wave", "*exchange waves", "*wave hello to each other"),
        ("a wave and a wave back", "waving at each other", "greeting with a wave", "friendly wave"),
    ),
    "bow-back": Entry(
        "reply",
        ("*bow( politely|)", "*bow to {other}", "*greet {other} with a bow", "*take a bow"),
        ("*bow back", "*return the bow", "*bow (too|as well)", "*bow in return"),
        ("*bow to each other", "*greet each other with a bow", "*exchange bows", "*bow politely to each other"),
        ("a bow and a bow back", "bowing to each other", "polite bow", "formal greeting"),
    ),
    "raise-copy": Entry(
        "reply",
        ("*raise {hand}", "*lift {hand}( up|)", "*put {hand} up", "*hold {hand} up in the air"),
        ("*do the same", "*copy {them}", "*raise {hand} too", "*lift {hand} as well", "*follow with {hand}"),
        ("*raise {hand} one after the other", "*put {hand} up one after the other"),
        ("raising a hand and copying it", "both raise a hand", "copying a raised hand"),
    ),
    "raise-watch": Entry(
        "while",
        ("*raise {hand}", "*lift {hand}( up|)", "*put {hand} up", "*hold {hand} up in the air"),
        _WATCH,
        (),
        ("raising a hand while being watched", "one raises a hand, one watches"),
    ),
    "call-come": Entry(
        "reply",
        ("*call {other} over{with_hand}", "*beckon{with_hand}", "*wave {other} over", "*signal {other} to come",
         "*call {other}"),
        _COME,
        (),
        ("calling someone over", "beckoning and coming", "come here", "a call and an approach"),
        ("{A} *ask {B} to come, and {B} *walk over.", "{B} *come when {A} *call.", "{B} *follow {As} call and *come."),
    ),
    "goodbye": Entry(
        "reply",
        ("*wave goodbye{with_hand}", "*say goodbye", "*wave farewell{with_hand}", "*bid {other} goodbye"),
        ("*wave back{with_hand}", "*say goodbye too", "*return the goodbye", "*wave goodbye as well"),
        ("*say goodbye( to each other|)", "*wave goodbye( to each other|)", "*part with a wave", "*bid farewell"),
        ("goodbye", "saying goodbye", "farewell wave", "waving goodbye"),
    ),
    "cheer": Entry(
        "while",
        ("*cheer", "*raise both (hands|arms) and *cheer", "*throw both arms up", "*celebrate with both arms up"),
        ("*cheer( along| too|)", "*join in", "*celebrate with {them}", "*raise both arms as well"),
        ("*cheer( together|)", "*celebrate( together|)", "*raise both (hands|arms) in joy", "*cheer each other on"),
        ("cheering", "celebration", "two people cheering", "both arms up in joy"),
    ),
    "dance-together": Entry(
        "while",
        ("*dance", "*dance with {other}", "*dance on the spot"),
        ("*dance (too|along)", "*dance with {them}", "*join the dance"),
        ("*dance( together|)", "*dance with each other", "*dance face to face", "*perform a dance together"),
        ("dancing together", "a dance for two", "pair dance", "partners dancing"),
    ),
    "dance-mirrored": Entry(
        "while",
        ("*dance", "*perform a dance", "*lead a dance"),
        ("*mirror {them}", "*mirror the dance", "*dance as a mirror image", "*copy the steps like a mirror"),
        ("*dance like mirror images", "*mirror each other in a dance", "*dance (face to face |)in mirror image"),
        ("mirrored dance", "mirror dance", "dancing in mirror image"),
    ),
    "dance-watch": Entry(
        "while",
        ("*dance( for {other}|)", "*perform a dance", "*show {other} a dance", "*dance on the spot"),
        _WATCH,
        (),
        ("dancing for someone who watches", "one dances, one watches", "solo dance with a spectator"),
    ),
    "point": Entry(
        "while",
        ("*point at {other}{with_hand}", "*point a finger at {other}", "*point{with_hand} at {other}"),
        ("*stand still", "*watch", "*look at {them}", "*stand there", "*look on"),
        (),
        ("pointing at someone", "pointing a finger"),
        ("{B} *is being pointed at by {A}.", "{B} *stand there and {A} *point at {b_them}."),
    ),
    "talk": Entry(
        "while",
        ("*talk", "*talk with (lively |)gestures", "*explain something( with {their} hands|)", "*tell {other} a story"),
        ("*listen", "*listen to {them}", "*listen and *answer with gestures", "*stand and *listen"),
        ("*talk( to each other|)", "*have a conversation", "*chat( with each other|)", "*talk with lively gestures"),
        ("conversation", "talking with gestures", "a chat"),
    ),
    "copy": Entry("reply", (), ("*do the same", "*copy {them}", "*imitate {them}", "*repeat the movement",
                                "*follow the example")),
    "together": Entry("while", (), ()),
    "watch": Entry("while", (), _WATCH),
    "ordered": Entry("order", (), ()),
    "sequence": Entry("while", (), ()),
    "turn-away": Entry(
        "while",
        ("*turn away( from {other}|)", "*turn {their} back on {other}", "*turn around", "*turn and *face away"),
        _WATCH,
        (),
        ("turning away", "turning one's back"),
    ),
    "idle": Entry(
        "while",
        ("*stand still", "*wait", "*stand around", "*stand idle"),
        ("*stand still too", "*wait as well", "*stand nearby", "*stand there too"),
        ("*stand( still|) facing each other", "*stand around", "*wait( together|)", "*stand idle", "*do nothing"),
        ("standing still", "waiting", "two people standing", "idle"),
    ),
    # ---- locomotion ----------------------------------------------------------------------------------
    "guide-follow": Entry(
        "reply",
        ("*show the way{with_hand}", "*lead the way", "*guide {other}", "*point the way and *walk ahead"),
        ("*follow( {them}|)", "*walk behind( {them}|)", "*go along", "*walk where {other} points"),
        (),
        ("guiding someone", "showing the way", "a guide and a follower"),
    ),
    "walk-together": Entry(
        "while",
        ("*walk( forward|)", "*walk along"),
        ("*walk beside {them}", "*walk alongside", "*keep pace"),
        ("*walk side by side", "*walk together", "*take a walk( together|)", "*walk next to each other"),
        ("walking side by side", "walking together", "a walk together", "two people walking"),
    ),
    "run-together": Entry(
        "while",
        ("*run( forward|)", "*run along", "*jog"),
        ("*run beside {them}", "*run alongside", "*jog along"),
        ("*run side by side", "*run together", "*jog together", "*go for a run( together|)"),
        ("running side by side", "running together", "a jog together", "two people running"),
    ),
    "meet": Entry(
        "while",
        ("*walk towards {other}", "*come to meet {other}", "*come closer"),
        ("*walk towards {them}", "*come to meet {them}", "*come closer too"),
        ("*meet( in the middle|)", "*walk towards each other( and *stop|)", "*approach each other", "*come together"),
        ("meeting", "walking towards each other", "two people meet", "approaching each other"),
    ),
    "part": Entry(
        "while",
        ("*walk away( from {other}|)", "*leave", "*go away", "*turn and *walk off"),
        ("*walk away too", "*leave as well", "*go the other way"),
        ("*part( ways|)", "*walk away from each other", "*go separate ways", "*turn around and *walk apart"),
        ("parting", "walking apart", "going separate ways", "two people part"),
    ),
    "leave": Entry(
        "while",
        ("*walk away( from {other}|)", "*leave( {other}|)", "*turn around and *walk off"),
        ("*stay( behind|)", "*stand and *watch", "*stay in place", "*remain standing"),
        (),
        ("walking away from someone", "one leaves, one stays", "leaving someone"),
    ),
    "follow": Entry(
        "while",
        ("*walk( ahead| in front|)", "*walk forward", "*lead"),
        ("*follow( {them}|)", "*walk behind( {them}|)", "*walk after {them}", "*follow at a distance"),
        ("*walk one behind the other", "*walk in single file"),
        ("following someone", "walking one behind the other", "single file"),
    ),
    "chase": Entry(
        "while",
        ("*run away( from {other}|)", "*flee( from {other}|)", "*run", "*try to escape"),
        ("*chase {them}", "*run after {them}", "*pursue {them}", "*chase after {other}"),
        ("*chase each other", "*run one behind the other"),
        ("a chase", "running after someone", "chasing", "pursuit"),
    ),
    "circle": Entry(
        "while",
        ("*walk (a|in a) circle around {other}{round}", "*circle {other}{round}", "*walk around {other}{round}"),
        _WATCH,
        (),
        ("walking around someone", "circling around a person", "walking in a circle around someone"),
    ),
    "circle-each-other": Entry(
        "while",
        ("*circle around {other}{round}", "*walk in a circle{round}"),
        ("*circle {them}{round}", "*keep opposite {them}", "*walk in a circle too"),
        ("*circle each other{round}", "*walk around each other{round}", "*walk in a circle{round}"),
        ("circling each other", "walking around each other"),
    ),
    "walk-past": Entry(
        "while",
        ("*walk past( {other}|)", "*pass {other}", "*go past {other}", "*walk by"),
        ("*walk past {them}", "*pass {them}", "*walk the other way"),
        ("*walk past each other", "*pass (by |)each other", "*cross paths", "*walk by each other"),
        ("walking past each other", "passing by", "crossing paths"),
    ),
    "walk-up": Entry(
        "while",
        ("*walk up to {other}", "*approach {other}", "*walk towards {other} and *stop", "*come closer"),
        ("*stand still", "*wait", "*stand and *wait", "*watch {them} come"),
        (),
        ("walking up to someone", "approaching someone who waits"),
        ("{B} *wait for {A}, who comes closer.", "{B} *is approached by {A}."),
    ),
    "step-back": Entry(
        "reply",
        ("*walk towards {other}", "*step towards {other}", "*come closer", "*approach( {other}|)"),
        _BACK,
        (),
        ("stepping back from someone who comes closer", "approach and retreat", "backing away"),
    ),
    "make-way": Entry(
        "reply",
        ("*walk towards {other}", "*walk straight at {other}", "*come closer", "*approach( {other}|)"),
        ("*walk off{to_side}", "*walk out of the way{to_side}", "*move out of the way{to_side}", "*make way{to_side}"),
        (),
        ("walking out of the way", "making way for someone", "giving way to someone"),
    ),
    # ---- combat --------------------------------------------------------------------------------------
    "punch-dodge": Entry(
        "reply",
        ("*throw a punch{with_hand}", "*punch at {other}{with_hand}", "*attack with (a punch|{their} fists)",
         "*try to punch {other}"),
        ("*dodge( it| the punch|)", "*step back to avoid it", "*get out of the way", "*evade( it| the punch|)"),
        (),
        ("punch and dodge", "dodging a punch", "a punch that misses"),
    ),
    "punch-recoil": Entry(
        "reply",
        ("*punch {other}{with_hand}", "*throw a punch{with_hand} at {other}", "*strike {other} with a fist"),
        _RECOIL,
        (),
        ("punch and recoil", "taking a punch", "reeling from a punch"),
    ),
    "spar": Entry(
        "while",
        ("*throw punches", "*attack with punches", "*box", "*spar with {other}"),
        ("*fight back", "*throw punches too", "*box as well", "*trade blows with {them}"),
        ("*spar( with each other|)", "*box( against each other|)", "*have a fist fight", "*exchange punches",
         "*fight( each other|)"),
        ("sparring", "boxing match", "fist fight", "two fighters"),
    ),
    "kick-step-back": Entry(
        "reply",
        ("*kick{with_foot}( at {other}|)", "*throw a kick{with_foot}", "*attack with a kick", "*try to kick {other}"),
        ("*step back( to avoid it|)", "*back away", "*move out of reach", "*retreat", "*avoid the kick"),
        (),
        ("kick and step back", "avoiding a kick", "a kick and a retreat"),
    ),
    "sword-retreat": Entry(
        "reply",
        ("*swing a sword( at {other}|)", "*slash at {other} with a sword", "*attack with a sword", "*cut with a sword"),
        ("*retreat", "*back away", "*step back( from the blade|)", "*dodge the blade"),
        (),
        ("sword slash and retreat", "retreating from a sword", "sword attack"),
    ),
    "sword-fight": Entry(
        "while",
        ("*swing a sword", "*slash with a sword", "*attack with a sword"),
        ("*fight back with a sword", "*slash back", "*swing a sword too", "*parry and *strike back"),
        ("*fight with swords", "*have a sword fight", "*cross swords", "*duel( with swords|)", "*fence"),
        ("sword fight", "a duel with swords", "two people sword fighting", "fencing"),
    ),
    # ---- contact -------------------------------------------------------------------------------------
    "handshake": Entry(
        "reply",
        ("*hold out {hand}", "*offer {hand} to shake", "*reach out{with_hand} to shake hands"),
        ("*shake it", "*take it and *shake it", "*shake hands with {them}", "*take it for a handshake"),
        ("*shake hands( with each other|){with_hand}", "*greet each other with a handshake",
         "*meet and *shake hands{with_hand}", "*give each other a handshake", "*shake {each_hand}"),
        ("handshake", "shaking hands", "a (firm|friendly|long|short) handshake", "hand shake greeting"),
        ("{A} *shake hands with {B}{a_with_hand}.", "{A} and {B} shake hands{with_both}.",
         "{A} *shake {Bs} hand{a_with_hand}.", "{B} *get a handshake from {A}."),
    ),
    "high-five": Entry(
        "reply",
        ("*raise {hand} for a high five", "*hold {hand} up", "*offer a high five{with_hand}"),
        ("*slap it", "*meet it with {their} own", "*give a high five", "*high-five {them}"),
        ("*high-five( each other|){with_hand}", "*give each other a high five{with_hand}", "*do a high five{with_hand}",
         "*slap {each_hand} above {their} shoulders"),
        ("high five", "a high five", "slapping hands in the air", "a (quick|happy) high five"),
        ("{A} *give {B} a high five{a_with_hand}.", "{A} *high-five {B}{a_with_hand}."),
    ),
    "low-five": Entry(
        "reply",
        ("*hold {hand} out low", "*offer a low five{with_hand}", "*hold {hand} down with the palm up"),
        ("*slap it", "*slap {theirs} palm", "*give a low five", "*swing down to slap it"),
        ("*give each other a low five{with_hand}", "*do a low five{with_hand}", "*slap {each_hand} low"),
        ("low five", "a low five", "slapping hands down low", "a (quick|happy) low five"),
        ("{A} *give {B} a low five{a_with_hand}.",),
    ),
    "high-ten": Entry(
        "reply",
        ("*hold both hands up", "*raise both hands for a double high five", "*offer both palms"),
        ("*slap both of them", "*clap both hands against them", "*meet them with both hands"),
        ("*high-five with both hands", "*do a high ten", "*give each other a (double|two-handed) high five",
         "*clap both hands together( in the air|)"),
        ("high ten", "double high five", "two-handed high five", "a high five with both hands"),
        ("{A} *high-five {B} with both hands.", "{A} *give {B} a double high five."),
    ),
    "fist-bump": Entry(
        "reply",
        ("*hold out {fist}", "*offer {fist}", "*reach out for a fist bump{with_hand}"),
        ("*bump it", "*bump fists with {them}", "*touch it with {their} own fist"),
        ("*bump fists{with_hand}", "*give each other a fist bump{with_hand}", "*do a fist bump{with_hand}",
         "*greet each other with a fist bump"),
        ("fist bump", "bumping fists", "a (quick|friendly) fist bump", "fist bump greeting"),
        ("{A} *give {B} a fist bump{a_with_hand}.", "{A} *bump fists with {B}."),
    ),
    "elbow-bump": Entry(
        "reply",
        ("*hold out {elbow}", "*offer {elbow}", "*lift {elbow} for an elbow bump"),
        ("*bump it", "*touch it with {their} own", "*bump elbows with {them}"),
        ("*bump elbows", "*greet each other with an elbow bump", "*touch elbows", "*tap elbows( in greeting|)"),
        ("elbow bump", "bumping elbows", "elbow greeting", "a (quick|friendly) elbow bump"),
        ("{A} *give {B} an elbow bump.", "{A} *bump elbows with {B}."),
    ),
    "hug": Entry(
        "reply",
        ("*open {their} arms", "*hug {other}", "*put {their} arms around {other}", "*walk up and *hug {other}",
         "*embrace {other}"),
        ("*hug {them} back", "*return the hug", "*hug back", "*embrace {them}"),
        ("*hug( each other|)", "*embrace( each other|)", "*hold each other (close|tight)", "*share a hug",
         "*greet each other with a hug", "*wrap their arms around each other", "*meet and *hug"),
        ("hug", "a (warm|long|friendly) hug", "an embrace", "hugging", "two people hug"),
    ),
    "pat-back": Entry(
        "while",
        ("*pat {other} on the back{with_hand}", "*pat {theirs} back{with_hand}", "*give {other} a pat on the back"),
        ("*stand still", "*look ahead", "*accept it", "*let it happen"),
        (),
        ("a pat on the back", "patting someone's back", "back pat", "a (friendly|comforting) pat on the back"),
        ("{B} *get a pat on the back from {A}.", "{B} *is patted on the back by {A}{a_with_hand}."),
    ),
    "pat-shoulder": Entry(
        "while",
        ("*pat {other} on the shoulder{with_hand}", "*pat {theirs} shoulder{with_hand}",
         "*give {other} a pat on the shoulder", "*clap {other} on the shoulder{with_hand}"),
        ("*stand still", "*look at {them}", "*accept it", "*face {them}"),
        (),
        ("a pat on the shoulder", "patting someone's shoulder", "shoulder pat", "a friendly pat on the shoulder"),
        ("{B} *get a pat on the shoulder from {A}.", "{B} *is patted on the shoulder by {A}{a_with_hand}."),
    ),
    "hand-on-shoulder": Entry(
        "while",
        ("*put {hand} on {theirs} shoulder", "*lay {hand} on {theirs} shoulder", "*rest {hand} on {theirs} shoulder",
         "*hold {other} by the shoulder{with_hand}", "*comfort {other} with a hand on the shoulder"),
        ("*stand still", "*look at {them}", "*stand there", "*face {them}"),
        (),
        ("a hand on the shoulder", "comforting someone", "palm on the shoulder", "resting a hand on a shoulder"),
        ("{B} *feel {As} hand on the shoulder.", "{B} *is comforted by {A}, whose hand rests on the shoulder."),
    ),
    "hand-over": Entry(
        "reply",
        ("*hand {thing} to {other}{with_hand}", "*hand over {thing}", "*give {other} {thing}{with_hand}",
         "*pass {thing} to {other}", "*hold out {thing}"),
        ("*take it{with_hand}", "*receive it", "*accept it", "*take {the_thing}"),
        (),
        ("handing over {thing}", "passing {thing}", "giving {thing} to someone", "a hand-over"),
        ("{B} *take {thing} from {A}.", "{B} *receive {thing} from {A}.", "{B} *is given {thing} by {A}."),
    ),
    "push": Entry(
        "reply",
        ("*push {other}( away| back|)", "*shove {other}( away| back|)", "*push {other} with both hands",
         "*push against {theirs} chest"),
        _STUMBLE,
        (),
        ("a push", "pushing someone", "push and stumble", "shoving someone back"),
        ("{B} *get pushed( back|) by {A}.", "{B} *stumble back after a push from {A}.", "{B} *is shoved by {A}."),
    ),
    "whisper": Entry(
        "while",
        ("*whisper in {theirs} ear", "*whisper something to {other}", "*lean in and *whisper", "*tell {other} a secret"),
        ("*listen", "*listen closely", "*stand still and *listen", "*lend an ear"),
        (),
        ("whispering", "telling a secret", "a whisper in the ear", "whispering in someone's ear"),
        ("{B} *listen to {As} whisper.", "{B} *hear a secret from {A}."),
    ),
    "help-up": Entry(
        "reply",
        ("*help {other} (up|to stand up)", "*reach down and *pull {other} up{with_hand}", "*offer {hand} to help",
         "*give {other} a hand up"),
        ("*stand up", "*get up", "*rise", "*get back on {their} feet", "*take it and *stand up"),
        (),
        ("helping someone up", "a helping hand", "pulling someone to their feet", "help up"),
        ("{B} *crouch on the ground and {A} *help {b_them} up.", "{B} *get up with help from {A}."),
    ),
    "lead-by-hand": Entry(
        "reply",
        ("*take {other} by the hand( and *walk ahead|)", "*lead {other} by the hand", "*pull {other} along by the hand"),
        ("*follow( {them}|)", "*walk along", "*walk behind {them}", "*let {them} lead"),
        (),
        ("leading someone by the hand", "pulling someone along", "led by the hand"),
        ("{B} *is led by the hand by {A}.", "{B} *follow {A}, hand in hand."),
    ),
    "hold-hands": Entry(
        "while",
        ("*hold {theirs} hand", "*take {theirs} hand", "*stand hand in hand with {other}"),
        ("*hold {theirs} hand too", "*stand still", "*stand beside {them}"),
        ("*hold hands", "*stand hand in hand", "*hold hands while standing( side by side|)",
         "*stand side by side holding hands"),
        ("holding hands", "hand in hand", "standing hand in hand", "two people holding hands"),
    ),
    "walk-hand-in-hand": Entry(
        "while",
        ("*walk hand in hand with {other}", "*hold {theirs} hand while walking", "*walk holding {theirs} hand"),
        ("*walk along", "*walk beside {them}", "*keep pace"),
        ("*walk hand in hand", "*hold hands while walking", "*walk side by side holding hands", "*stroll hand in hand",
         "*take a walk hand in hand"),
        ("walking hand in hand", "a couple walking", "hand in hand walk", "walking and holding hands"),
    ),
    "arm-around": Entry(
        "while",
        ("*put {arm} around {theirs} shoulders", "*lay {arm} around {other}", "*wrap {arm} around {theirs} shoulders",
         "*hold {other} around the shoulders"),
        ("*stand still", "*stand beside {them}", "*stay close", "*look ahead"),
        (),
        ("an arm around the shoulders", "arm around a friend", "standing arm in arm", "arm around someone's shoulders"),
        ("{B} *stand next to {A}, who has {a_arm} around {b_their} shoulders.",),
    ),
    "tap-turn": Entry(
        "reply",
        ("*tap {other} on the shoulder( from behind|){with_hand}", "*poke {theirs} shoulder( from behind|)",
         "*come from behind and *tap {theirs} shoulder"),
        ("*turn around", "*turn to look", "*turn to face {them}", "*turn( around|) to see who it is"),
        (),
        ("a tap on the shoulder", "tapping someone on the shoulder", "shoulder tap and turn", "poking someone"),
        ("{B} *turn around because {A} *tap {b_them} on the shoulder.", "{B} *feel a tap from {A} and *turn around."),
    ),
    "punch": Entry(
        "reply",
        ("*punch {other}{with_hand}", "*hit {other}( with a fist|){with_hand}", "*throw a punch{with_hand} at {other}",
         "*strike {other}{with_hand}"),
        ("*recoil", "*flinch", "*step back", "*take the hit", "*stagger"),
        (),
        ("a punch", "punching someone", "a punch that lands"),
        ("{B} *is punched by {A}{a_with_hand}.", "{B} *get hit by {A}.", "{B} *take a punch from {A}."),
    ),
    "kick": Entry(
        "reply",
        ("*kick {other}{with_foot}", "*land a kick{with_foot} on {other}", "*give {other} a kick{with_foot}"),
        ("*recoil", "*step back", "*take the kick", "*stagger back", "*move back"),
        (),
        ("a kick", "kicking someone", "a kick that lands"),
        ("{B} *is kicked by {A}{a_with_foot}.", "{B} *get kicked by {A}.", "{B} *take a kick from {A}."),
    ),
    # ---- classes of SBU and K3HI that need words of their own --------------------------------------------
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
