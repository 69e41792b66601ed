"""Golden motions: what requests of every kind give, so that a change of the code changes no motion unnoticed.

``tests/test_golden.py`` makes them and compares; ``python -m tests.golden`` says which differ and by how much, and with
``--write`` keeps them as they are now. They are short and made in few steps: what they guard is the way from a request
to a motion, not how good the motion is. The positions of :data:`KEY_FRAMES` frames of each are kept.
"""

from __future__ import annotations

import sys
import warnings
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from acts.plan import Act, Plan
from motion import Clip, Duet, stacked_positions
from motion.formats import read
from webdemo.inference import Engine, GenerateRequest, PredictRequest, ReactRequest, SceneRequest
from webdemo.inference.requests.paths import path_of
from webdemo.inference.requests.plans import kept_plan
from webdemo.inference.story.beats import Beat
from webdemo.inference.story.poses import Pose

ROOT = Path(__file__).resolve().parents[1]
DATA = Path(__file__).parent / "data" / "golden.npz"
KEY_FRAMES = 8
"""Frames of a motion that are kept, from its first to its last at equal distances."""
TOLERANCE = 1e-4
"""Metres by which the joints may differ on average."""
FARTHEST = 2e-3
"""Metres by which one joint may differ: processors round differently, and clean-up makes more of it."""

Array = NDArray[np.float32]


@cache
def engine() -> Engine:
    """The shipped networks."""
    return Engine()


@cache
def recorded(name: str) -> Duet:
    """Two people of ``static/examples``."""
    motion = read(ROOT / "static" / "examples" / f"{name}.npz")
    assert isinstance(motion, Duet)
    return motion


def actor(name: str, frames: int = 75, who: int = 0) -> Clip:
    """The first frames of a person of ``static/examples``."""
    return recorded(name).people[who].cut(0, frames)


def made(request: Any) -> Any:
    """The result of a request."""
    *_, result = engine().run(request)
    return result


def sentence(prompt: str, seconds: float = 3.0, **settings: Any) -> GenerateRequest:
    """A sentence in few steps."""
    return GenerateRequest(prompt=prompt, seconds=seconds, **{"steps": 2, "seed": 3, **settings})


def story(*beats: str | Beat, **settings: Any) -> SceneRequest:
    """A scene in few steps, of beats of two seconds where none says otherwise."""
    given = tuple(Beat(words=beat, seconds=2.0) if isinstance(beat, str) else beat for beat in beats)
    return SceneRequest(beats=given, **{"steps": 2, "seed": 5, **settings})


def reaction(clip: Clip, **settings: Any) -> ReactRequest:
    """A reaction in few steps."""
    return ReactRequest(actor=clip, **{"steps": 2, "seed": 7, **settings})


def replayed() -> SceneRequest:
    """A scene with the plan of an earlier result, as from the history."""
    asked = story("Two people walk up to each other.", "A pats B on the shoulder.", seed=12)
    manifest = made(asked).manifest
    return SceneRequest.from_dict(manifest["request"], plan=kept_plan(manifest))


def pose_of(name: str, frame: int, person: str, seconds: float) -> Pose:
    """A pose out of ``static/examples`` at a moment."""
    return Pose(person, seconds, np.asarray(recorded(name).people["ab".index(person)].positions[frame], float))


def line(person: str, *points: Sequence[float]) -> Any:
    """A path of points (seconds, x, z)."""
    return path_of({"person": person, "points": [list(point) for point in points]})


WAVES = Plan(acts=(Act(id="1", act="wave", agents=("a",), side="left"), Act(id="2", act="bow", agents=("b",))))

CASES: dict[str, Callable[[], Any]] = {
    # Sentences
    "shake hands": lambda: sentence("Two people shake hands."),
    "wave and bow": lambda: sentence("A waves with the left hand while B bows."),
    "push": lambda: sentence("One person pushes the other, who stumbles back."),
    "punch and dodge": lambda: sentence("A punches B and B dodges."),
    "kick": lambda: sentence("One person kicks the other and he falls down."),
    "dance": lambda: sentence("The two dance a waltz together.", 4.0),
    "talk": lambda: sentence("Two friends stand and talk to each other."),
    "pat": lambda: sentence("She pats him on the shoulder."),
    "follow": lambda: sentence("A woman walks ahead and a man follows her.", 4.0),
    "carry": lambda: sentence("A man carries a woman in his arms.", 4.0),
    "kneel": lambda: sentence("One kneels down in front of the other."),
    "jump": lambda: sentence("Both jump up and down."),
    "point": lambda: sentence("A points to the right and B looks there."),
    "hand in hand": lambda: sentence("They walk hand in hand.", 4.0),
    "fence": lambda: sentence("Two people fight with swords."),
    "then": lambda: sentence("First they hug, then A walks away.", 5.0),
    "not read": lambda: sentence("Zwei Leute unterhalten sich."),
    "no split": lambda: sentence("First they bow, then they part.", split=False),
    "no plan": lambda: sentence("A walks away from B and waves.", planned=False),
    "acts alone": lambda: sentence("", acts=WAVES),
    # Settings
    "no damping": lambda: sentence("They clap their hands.", damping=0.0),
    "weak damping, many steps": lambda: sentence("They clap their hands.", steps=8, damping=0.5),
    "guidance of one": lambda: sentence("They clap their hands.", guidance=1.0),
    "dpm++": lambda: sentence("They clap their hands.", sampler="dpm++", steps=4),
    "no clean-up": lambda: sentence("A walks around B.", cleanup=False),
    "two samples": lambda: sentence("A steps back.", 2.0, samples=2),
    "three tries": lambda: sentence("A claps and B sneezes.", 2.0, tries=3),
    # Kinds that fell unnoticed before
    "three beats": lambda: story(
        *(
            Beat(words=words, seconds=4.0)
            for words in ("They walk up to each other and shake hands.", "They talk.", "They part.")
        )
    ),
    "call and come": lambda: sentence("Somebody calls out and the other comes running to them.", 5.0),
    "refused hand": lambda: sentence("A offers the right hand, but B refuses it and steps back.", 4.0),
    "circled": lambda: sentence("B circles A while A turns to watch.", 5.0),
    "turn holding hands": lambda: sentence("They hold hands and turn round each other.", 5.0),
    "helped up": lambda: sentence("A kneels. B helps A up with both hands.", 5.0),
    "high five left": lambda: sentence("They give each other a high five with their left hands."),
    "hug": lambda: sentence("The two hug each other tightly."),
    "one way": lambda: sentence("They bow, clap and sit down on the floor.", 6.0),
    # People and things
    "child": lambda: sentence("A girl waves at her tall mother."),
    "chair": lambda: sentence("A sits down on a chair and B brings a book.", 4.0),
    "ball": lambda: sentence("They throw a ball to each other."),
    "window": lambda: sentence("A goes to the window and opens it.", 5.0),
    "table": lambda: sentence("Two people sit at a table and drink coffee."),
    # Classes
    "class hug": lambda: sentence("hug", model="bigraphdiff", steps=4),
    "class punch": lambda: sentence("punch, and dodge", model="bigraphdiff", steps=4),
    # Reactions
    "react to words": lambda: reaction(actor("push"), prompt="One person pushes the other.", model="intergen"),
    "act first": lambda: reaction(actor("wave"), role="b", prompt="They wave.", model="intergen"),
    "agent": lambda: reaction(actor("wave")),
    "regennet": lambda: reaction(actor("push"), model="regennet", mode="offline"),
    "regennet online": lambda: reaction(actor("push"), model="regennet", mode="online"),
    "interformer": lambda: reaction(
        actor("shake-hands"), model="interformer", first_pose=recorded("shake-hands").b.positions[0]
    ),
    # Predictions
    "predict one": lambda: PredictRequest(motion=actor("push"), seconds=1.5),
    "predict two": lambda: PredictRequest(motion=recorded("wave"), marker=2.5, model="mawgan"),
    "predict together": lambda: PredictRequest(
        motion=recorded("shake-hands"), marker=1.5, model="intergen-together", seed=2
    ),
    # Scenes, paths and poses
    "scene": lambda: story("Two people walk up to each other.", Beat(a="sits down", b="claps", seconds=3.0)),
    "loop": lambda: story("They dance.", "They clap.", loop=True),
    "goes on": lambda: story("They hug.", motion=recorded("wave")),
    "span": lambda: story("A ducks.", "B laughs.", motion=recorded("push"), start=1.5, end=4.0),
    "paths": lambda: story(
        "They walk past each other.", paths=(line("a", (0, 0, -1), (1.9, 1, 0)), line("b", (0, 1, 2), (1.5, 0, 1)))
    ),
    "path of a sentence": lambda: sentence(
        "A walks ahead and waves.", paths=(line("a", (0, 0, 0), (2, 0, 1), (2.8, 1, 1)),)
    ),
    "poses": lambda: story("They talk.", "They bow.", poses=(pose_of("wave", 60, "a", 1.5),)),
    "replayed": replayed,
}


def motion_of(name: str) -> Array:
    """The motion of a case: (people of all samples × key frames, joints and things, 3) as float32 metres."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        result = made(CASES[name]())
    rows = []
    for motion in result.duets:
        people = stacked_positions(motion)
        frames = np.linspace(0, people.shape[1] - 1, KEY_FRAMES).round().astype(int)
        things = [thing.places[None, frames, None] for thing in getattr(motion, "things", ())]
        rows.append(np.concatenate([people[:, frames].reshape(-1, 3), *(t.reshape(-1, 3) for t in things)]))
    return np.concatenate(rows).astype(np.float32)


def kept() -> dict[str, Array]:
    """The golden motions by name; none where the file is missing."""
    if not DATA.is_file():
        return {}
    with np.load(DATA) as arrays:
        return {name: arrays[name] for name in arrays.files}


def difference(golden: Array | None, motion: Array) -> str:
    """What differs between two motions, as words; "" within :data:`TOLERANCE` and :data:`FARTHEST`."""
    if golden is None:
        return "new"
    if golden.shape != motion.shape:
        return f"{len(golden)} kept positions became {len(motion)}: other people, samples or things"
    if not np.isfinite(motion).all():
        return "no numbers"
    apart = np.linalg.norm(golden - motion, axis=-1)
    if apart.mean() <= TOLERANCE and apart.max() <= FARTHEST:
        return ""
    return f"up to {apart.max():.4f} m, {apart.mean():.4f} on average"


def main(argv: Sequence[str]) -> None:
    """Prints which motions differ from the golden ones; keeps them with ``--write``."""
    golden, motions = kept(), {name: motion_of(name) for name in CASES}
    changed = {name: difference(golden.get(name), motion) for name, motion in motions.items()}
    for name, words in changed.items():
        if words:
            print(f"{name}: {words}")
    for name in golden.keys() - CASES.keys():
        print(f"{name}: gone")
    print(f"{sum(not words for words in changed.values())} of {len(CASES)} as before")
    if "--write" in argv:
        # What is within the tolerance stays as it is, so that small differences never add up.
        np.savez_compressed(DATA, **{n: m if changed[n] else golden[n] for n, m in motions.items()})


if __name__ == "__main__":
    main(sys.argv[1:])
