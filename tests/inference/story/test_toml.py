"""A story is read from TOML; a mistake is named with its line and key."""

import time
from pathlib import Path

import numpy as np
import pytest

from motion import SMPL22, Duet, InputError
from motion.formats import write
from webdemo.inference.story import FloorPoint, SceneRequest, read_story, read_words

STORY = """
seed = 4
tries = 3
loop = true

[[beat]]
words = "They \\"meet\\"."
seconds = 2.5

[[beat]]
a = "waves"
seed = 9

[[path]]
person = "b"
points = [[0, 0, 1.5], [2, 0.5, 2, 90], [3, 0, 2]]
"""


def test_a_story_is_read() -> None:
    found = read_story(STORY)
    assert [beat.words for beat in found["beats"]] == ['They "meet".', ""]
    assert found["beats"][1].seed == 9 and found["seed"] == 4 and found["tries"] == 3 and found["loop"] is True
    assert found["paths"][0].points[1] == FloorPoint(0.5, 2, 2, 90)
    assert SceneRequest(**found).tries == 3


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("seed = \n", "line 1, column 8"),
        (
            '[[beat]]\nwords = "x"\n\n[[beat]]\nwrods = "y"\n',
            "Line 5: there is no key 'wrods' in a beat; did you mean 'words'",
        ),
        ('[[beat]]\nwords = "x"\nseconds = "long"\n', "Line 3: seconds must be a number"),
        ("sede = 3\n", "Line 1: there is no key 'sede' in a story; did you mean 'seed'"),
        ("seed = 1.5\n", "Line 1: seed must be a whole number"),
        ('[[path]]\nperson = "a"\npoints = [[0, 1], [1]]\n', "Line 3: Point 2 of a path"),
        ('[[path]]\nperson = "a"\npoints = [[0, 1], 0.5]\n', "Line 3: Point 2 of a path"),
        ('[[path]]\nperson = "a"\npoints = [[0, 1, 2, 3, 4]]\n', "Line 3: Point 1 of a path"),
        ('[[pose]]\nperson = "a"\nfile = "x.npz"\n', "Line 3: a file is only read from the shell"),
    ],
)
def test_a_mistake_is_named_with_line_and_key(text: str, says: str) -> None:
    with pytest.raises(InputError) as error:
        read_story(text)
    assert says in str(error.value)


def test_a_pose_is_read_from_a_file_beside_the_story(tmp_path: Path) -> None:
    rest = SMPL22.rest_positions() + np.array([0, 0.98, 0])
    two = np.stack([np.repeat(rest[None], 3, axis=0), np.repeat(rest[None] + [0, 0, 1.5], 3, axis=0)])
    write(Duet.from_positions(two, fps=30.0), tmp_path / "x.npz")
    text = '[[pose]]\nperson = "b"\nseconds = 2\nfile = "x.npz"\nframe = 2\n'
    (pose,) = read_story(text, tmp_path)["poses"]
    np.testing.assert_allclose(pose.positions, two[1, 2], atol=1e-6)
    with pytest.raises(InputError, match=r"Line 5: x.npz has frames 0 to 2, not 7"):
        read_story(text.replace("frame = 2", "frame = 7"), tmp_path)


@pytest.mark.parametrize("path", sorted((Path(__file__).parents[3] / "docs" / "stories").glob("*.toml")))
def test_the_example_stories_can_be_made(path: Path) -> None:
    request = SceneRequest(**read_story(path.read_text(encoding="utf-8"), path.parent))
    assert len(request.beats) >= 3


def unread(text: str) -> str:
    """The sentence with which a story is refused."""
    with pytest.raises(InputError) as refused:
        read_words(text)
    return str(refused.value)


TOO_LARGE = [
    ("[[path]]\n" * 2000, "2000 paths: keep to 2"),
    ("x = 1\n" + "a." * 70_000 + "a = 1", "Line 2: 'a.a.a.a.a.a.a.a.a' … is longer than any key"),
    ("seed = " + "[" * 70_000, "nested too deeply"),
    ("seed = " + "9" * 5000, "longer than any key or number"),
    ("beat = [" + '{words="a"},' * 10_000 + "]", "10000 beats"),
    ('[[path]]\nperson="a"\npoints=[' + "[1,2,3]," * 10_000 + "]", "10000 points"),
    ("[[beat]]\n" + '"""' + '\\"""' * 30_000, "not valid TOML"),
    ("They walk and " + "hug and " * 3000 + "part.", "characters: shorten it to 500"),
]
"""Texts that are more than a story may be, and what the refusal says."""


@pytest.mark.parametrize(("text", "says"), TOO_LARGE)
def test_a_text_that_is_too_large_is_refused_in_time(text, says):
    began = time.process_time()
    assert says in unread(text)
    assert time.process_time() - began < 2


def test_full_stops_in_a_sentence_are_no_parts_of_a_key():
    words = "They walk. Sit. Bow. Run. Hop. Wave. Nod. Clap. Part... a.b.c.d.e.f.g.h.i.j"
    for quoted in (f'"{words}"', f"'{words}'", f'"""\n{words} "x" {words}"""', f"'''{words}''''", f'"\\"{words}"'):
        assert words in read_story(f"[[beat]]\nwords = {quoted}  # {words}\nseconds = 3.5")["beats"][0].words


def test_the_largest_story_is_read():
    """As many beats, points and poses as a scene may have, with all their digits."""
    dice = np.random.default_rng(0)
    text = f'\n[[beat]]\nwords = "{"x" * 499}"\nseconds = 3.0\nseed = 4294967295\n' * 60
    for person in "ab":
        points = dice.uniform(-8, 8, (600, 4)).round(4).tolist()
        text += f'\n[[path]]\nperson = "{person}"\npoints = {points}\n'
    for _ in range(40):
        text += f'\n[[pose]]\nperson = "a"\npositions = {dice.uniform(-8, 8, (22, 3)).tolist()}\n'
    found = read_story(text)
    assert [len(found[key]) for key in ("beats", "paths", "poses")] == [60, 2, 40]
