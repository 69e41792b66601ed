"""What the handlers of the Scene tab do, without a browser."""

from pathlib import Path
from typing import Any

import gradio as gr
import numpy as np
import pytest

from motion import InputError
from tests.ui.tab_events import built, changes
from webdemo.inference.story import Beat, FloorPath, FloorPoint, Pose, sentences
from webdemo.ui.components.exports import Record
from webdemo.ui.components.scene_parts import part_request
from webdemo.ui.components.story import story_value
from webdemo.ui.components.story_words import edited, lay_out, settled, story_text, written
from webdemo.ui.history import Entry, Kept, Opened
from webdemo.ui.tabs.scene import SceneTab

SETTINGS = {"seed": 3, "samples": 1, "guidance": 4.3, "steps": 2, "damping": 0.7, "tries": 1}
PLACE = '{"frame": 60, "sample": 0}'


@pytest.fixture
def tab(tmp_path: Path) -> SceneTab:
    return built(SceneTab, tmp_path / "files")


def shown(tab: SceneTab, updates: Any) -> list[dict[str, Any]]:
    """What each update changes, by the output's name."""
    return [changes(tab.outputs, update) for update in updates]


def generate(tab: SceneTab, prompt: str = "They meet. Then they hug.", story: Any = None) -> list[dict[str, Any]]:
    return shown(tab, tab.run("session", {"prompt": prompt, "story": story, **SETTINGS}))


def test_a_sentence_is_laid_out_and_made_beat_by_beat(tab: SceneTab) -> None:
    updates = generate(tab)
    stories = [u["story"] for u in updates if "story" in u]
    assert all(story["__type__"] == "update" for story in stories), "the page changes them in place"
    laid = stories[0]["value"]
    assert [beat["words"] for beat in laid["beats"]] == ["They meet.", "They hug."]
    seen = [u["player"]["value"]["samples"][0] for u in updates if "value" in u.get("player", {})]
    lengths = [sample["frames"] for sample in seen]
    assert lengths == sorted(lengths) and len(set(lengths)) == 2
    assert {tuple(sample["roles"]) for sample in seen} == {("a", "b")}, "nobody is an actor in a scene"
    record = updates[-1]["record"]
    assert (record.prompt, record.result.manifest["request"]["seed"]) == ("They meet. They hug.", 3)


def test_of_a_cancelled_story_a_part_stays_without_what_is_said_of_a_result(tab: SceneTab) -> None:
    last: dict[str, Any] = {}
    for update in tab.run("session", {"prompt": "They meet. Then they hug.", "story": None, **SETTINGS}):
        last = changes(tab.outputs, update)
        if "value" in last.get("player", {}):
            tab._cancelled["session"] = True
    assert "Cancelled" in last["line"] and last["player"]["value"]["samples"] and "record" not in last
    assert not (last["under"]["visible"] or last["spans"]["visible"] or last["readouts"])


def test_of_the_words_and_the_beats_what_was_changed_last_is_made_and_shown(tab: SceneTab) -> None:
    def made(prompt: str, story: Any) -> tuple[list[str], dict[str, Any]]:
        last = generate(tab, prompt, story)[-1]
        return [b["words"] for b in last["record"].result.manifest["request"]["beats"]], last

    laid = lay_out("They meet. Then they hug.")[1]
    laid["beats"][1] |= {"seconds": 6.0}
    words, last = made("They meet. Then they hug.", laid)
    assert words == ["They meet.", "They hug."] and "prompt" not in last, "the words stay as they were typed"
    assert last["story"]["value"]["beats"][1]["seconds"] == 6.0
    changed = laid | {"beats": [laid["beats"][0], {"words": "They bow."}], "ahead": True}
    words, last = made("They meet. Then they hug.", changed)
    assert words == ["They meet.", "They bow."]
    assert last["prompt"] == "They meet. They bow." and not last["story"]["value"]["ahead"]
    words, last = made("They wave.", laid)
    assert words == ["They wave."] and "prompt" not in last
    words, last = made(" ", laid)
    assert words == ["They meet.", "They hug."] and last["prompt"] == "They meet. They hug."
    words, last = made('[[beat]]\nwords = "They bow."\na = "nods"\n', laid)
    assert words == ["They bow."] and last["prompt"] == "They bow. One person nods."


def test_beats_whose_words_stay_keep_what_was_set_for_them() -> None:
    still = np.zeros((22, 3))
    beats = (Beat("They meet.", seconds=3.0, seed=5), Beat("They hug."), Beat("", "waves, turns and bows", "waits"))
    total = sum(beat.length for beat in beats)
    poses = tuple(Pose("a", at, still) for at in (1.0, 4.0, total - 0.5))
    way = FloorPath("a", (FloorPoint(0.0, 0.0, 0.0), FloorPoint(1.0, 1.0, 2.0)))
    story = story_value(beats, (way,), poses, loop=True) | {"span": [0, 1]}
    text = story_text(beats)
    assert text == "They meet. They hug. One person waves, turns and bows, while the other person waits."
    assert settled(story, text) == (story, text) and settled(story, text)[0] is story
    laid, said = settled(story, text.replace("hug", "talk to each other for ten seconds"))
    assert said != text and laid["loop"] is True and len(laid["paths"]) == 1
    kept = [{k: beat[k] for k in ("words", "a", "seconds", "seed")} for beat in laid["beats"]]
    assert kept == [
        {"words": "They meet.", "a": "", "seconds": 3.0, "seed": 5},
        {"words": "They talk to each other for ten seconds.", "a": "", "seconds": None, "seed": None},
        {"words": "", "a": "waves, turns and bows", "seconds": None, "seed": None},
    ]
    later = round(total - 0.5 + 10 - beats[1].length, 4)
    assert [pose["seconds"] for pose in laid["poses"]] == [1.0, later], "poses stay with their beats"
    laid, _ = settled(story, text + " Finally they bow.")
    assert [beat["a"] for beat in laid["beats"]] == ["", "", "waves, turns and bows", ""]
    assert [pose["seconds"] for pose in laid["poses"]] == [pose.seconds for pose in poses]
    laid, _ = settled(story, "They run.")
    assert len(laid["beats"]) == 1 and laid["poses"] == laid["paths"] == []


def test_words_that_were_written_are_laid_out(tab: SceneTab) -> None:
    laid = lay_out("They meet. Then they hug.")[1]
    line_up, line, words = written("They meet. Then they bow.", laid)
    assert [beat["words"] for beat in line_up["laid"]["beats"]] == ["They meet.", "They bow."]
    assert set(line_up["laid"]) == {"beats", "paths", "poses", "at"}, "ticks and the span are the line's own"
    assert "2 beats" in line and words == gr.skip()
    nothing = (gr.skip(),) * 3
    assert written("They meet. Then they hug.", laid) == nothing
    assert written("They run.", laid | {"ahead": True}) == nothing, "the beats are newer"
    assert written("", None) == nothing
    assert written("", laid)[2] == "They meet. They hug."
    assert "not valid TOML" in written("[[beat]]\nwords = 'x", laid)[1]


@pytest.mark.parametrize(
    ("story", "says"),
    [
        (None, "The story is empty"),
        ({"beats": [{"words": "x", "seconds": 0.1}]}, "Beat 1"),
        ({"beats": [{"words": "x"}] * 500}, "beats: keep to 60"),
        ({"beats": [{"words": ["x"]}]}, "must be text"),
        ({"beats": [{"words": "x"}], "paths": [{"person": "a", "points": [[0, 99, 0]]}]}, "outside the floor"),
        ({"beats": [{"words": "x"}], "paths": [{"person": "a", "points": [7]}]}, "Point 1 of a path"),
        ({"beats": [{"words": "x"}], "paths": 3}, "damaged"),
    ],
)
def test_what_cannot_be_made_is_one_sentence(tab: SceneTab, story: Any, says: str) -> None:
    last = generate(tab, "", story)[-1]
    assert says in last["line"] and "pd-error" in last["line"]


def test_an_edit_gives_lengths_and_what_is_wrong(tab: SceneTab) -> None:
    line_up, line, words = edited({"beats": [{"words": "They dance."}, {"words": "They nod."}]})
    assert line_up["lengths"][0] > line_up["lengths"][1] and line == ""
    assert words == gr.skip()
    ahead = {"beats": [{"words": "They dance."}, {"words": ""}, {"a": "waves"}], "ahead": True}
    line_up, line, words = edited(ahead)
    assert "Beat 2 has no words" in line
    assert words == "They dance. One person waves."


def part(tab: SceneTab, which: str, record: Record | None, story: Any, words: str = "") -> dict[str, Any]:
    fields = {"part": which, "story": story, "words": words, "record": record, "frame": 60, "sample": 0}
    return shown(tab, tab.run("session", {**SETTINGS, "strictness": 0.5, **fields}))[-1]


def test_a_span_is_made_again(tab: SceneTab) -> None:
    record = generate(tab)[-1]["record"]
    laid = story_value((Beat("They meet."), Beat("They hug."))) | {"span": [1.0, 3.0]}
    last = part(tab, "span", record, laid)
    asked = last["record"].result.manifest["request"]
    assert (asked["start"], asked["end"], asked["beats"][0]["words"]) == (1.0, 3.0, "They meet.")
    old, new = (r.result.duets[0].positions for r in (record, last["record"]))
    np.testing.assert_array_equal(old[:, 90:], new[:, 90:])


def test_futures_begin_at_the_playhead_and_one_is_taken(tab: SceneTab) -> None:
    record = generate(tab)[-1]["record"]
    last = part(tab, "futures", record, story_value((Beat("They meet."), Beat("They hug."))), "They bow.")
    found = last["record"].result
    assert found.manifest["request"]["start"] == 2.0 and len(found.duets) == 3
    beats = last["story"]["value"]["beats"]
    assert [(b["words"], b["seconds"]) for b in beats] == [("They meet.", 2.0), ("They bow.", 3.0)]
    assert last["prompt"] == "They meet. They bow."
    taken = tab.take_shown(last["record"], ["run"], '{"sample": 2}')
    assert taken[tab.record].result.duets == found.duets[2:] and "number 3" in taken[tab.line]
    assert taken[tab.trail] == ["run", found.run], "Undo opens the choice again"
    assert taken[tab.results.readouts] != last["readouts"] and not taken[tab.results.address]["visible"]


def test_parts_need_a_motion_and_a_span(tab: SceneTab) -> None:
    record = generate(tab)[-1]["record"]
    assert "There is no motion yet" in part(tab, "futures", None, None)["line"]
    assert "No span is selected" in part(tab, "span", record, story_value((Beat("x"),)))["line"]
    assert "There is no motion yet" in tab.take_last(None)[tab.line]
    assert tab.take_last(record)[tab.results.player]["value"]["samples"]


def test_a_kept_run_opens_with_its_story(tab: SceneTab) -> None:
    result = generate(tab)[-1]["record"].result
    entry = Entry(id="x", kind="scene", title="t", state="done", request=result.manifest["request"])
    found = tab.opened(Opened(entry=entry, result=result))
    assert [b["words"] for b in found[tab.line_up]["value"]["beats"]] == ["They meet.", "They hug."]
    assert found[tab.prompt]["value"] == "They meet. They hug."
    kept = Kept(controls={"prompt": "They meet. Then they hug."})
    found = tab.opened(Opened(entry=entry, result=result, kept=kept))
    assert found[tab.prompt]["value"] == "They meet. Then they hug."
    kept = Kept(controls={"prompt": "They run."})  # of a time when the words were not kept with the beats
    assert tab.opened(Opened(entry=entry, result=result, kept=kept))[tab.prompt]["value"] == "They meet. They hug."


def test_a_kept_part_opens_with_the_whole_story(tab: SceneTab) -> None:
    record = generate(tab)[-1]["record"]
    pose = Pose("a", 2.0, record.result.duets[0].a.positions[60])
    laid = story_value((Beat("They meet."), Beat("They hug.")), (), (pose,)) | {"span": [1.0, 3.0]}
    kept = Kept(controls=tab.kept_more({"part": "span", "story": laid}))
    for which, words in (("span", ["They meet.", "They hug."]), ("futures", ["They meet.", "…"])):
        result = part(tab, which, record, laid)["record"].result
        entry = Entry(id="x", kind="scene", title="t", state="done", request=result.manifest["request"])
        found = tab.opened(Opened(entry=entry, result=result, kept=kept))
        story = found[tab.line_up]["value"]
        assert [beat["words"] or "…" for beat in story["beats"]] == words
        assert [pose["seconds"] for pose in story["poses"]] == [2.0]


def test_a_span_keeps_the_poses_and_the_way_that_fall_into_it(tab: SceneTab) -> None:
    record = generate(tab)[-1]["record"]
    duet = record.result.duets[0]
    own = [
        Pose("a", 2.0, duet.a.positions[60]),
        Pose("b", 3.0, duet.b.positions[90]),
        Pose("b", 1.0, duet.b.positions[30]),
    ]
    way = FloorPath("b", tuple(FloorPoint(0.0, float(duet.b.positions[30 * t, 0, 2]), float(t)) for t in range(5)))
    laid = story_value((Beat("They meet."), Beat("They hug.")), (way,), tuple(own)) | {"span": [1.5, 3.0]}
    asked = part(tab, "span", record, laid)["record"].result.manifest["request"]
    assert [(pose["person"], pose["seconds"]) for pose in asked["poses"]] == [("a", 2.0)]
    assert [point["seconds"] for point in asked["paths"][0]["points"]] == [2.0]
    # What lies behind the frame that futures begin at is given to them.
    last = part(tab, "futures", record, laid)
    left = last["story"]["value"]
    assert sorted(pose["seconds"] for pose in left["poses"]) == [1.0, 2.0, 3.0]
    last = last["record"].result.manifest["request"]
    assert [pose["seconds"] for pose in last["poses"]] == [2.0, 3.0]
    assert [point["seconds"] for point in last["paths"][0]["points"]] == [2.0, 3.0, 4.0]
    # A story that has become shorter has no poses behind its end.
    late = story_value((Beat("They meet."), Beat("They hug.")), (), (Pose("a", 7.0, duet.a.positions[60]),))
    assert part(tab, "futures", record, late, "They bow.")["story"]["value"]["poses"] == []


def test_paths_from_the_words_are_switched_on_the_line(tab: SceneTab) -> None:
    line = {"beats": [], "planned": False}  # ticked off before there is a story
    last = generate(tab, story=line)[-1]
    assert last["record"].result.manifest["request"]["planned"] is False
    assert last["story"]["value"]["planned"] is False
    # It stays so in parts, with another sentence, with an example and when the run is opened.
    laid = last["story"]["value"]
    for which in ("span", "futures"):
        made = part(tab, which, last["record"], laid | {"span": [1.0, 3.0]}, "They bow.")
        assert made["record"].result.manifest["request"]["planned"] is False
        assert which == "span" or made["story"]["value"]["planned"] is False
    assert generate(tab, "They wave.", laid)[-1]["story"]["value"]["planned"] is False
    assert lay_out("They wave.", laid)[1]["planned"] is False
    assert lay_out("They wave.")[1]["planned"] is True
    entry = Entry(id="x", kind="scene", title="t", state="done", request=last["record"].result.manifest["request"])
    opened = tab.opened(Opened(entry=entry, result=last["record"].result))
    assert opened[tab.line_up]["value"]["planned"] is False
    # A story as text says it itself.
    text = 'planned = %s\n[[beat]]\nwords = "They bow."\n'
    assert generate(tab, text % "false", None)[-1]["story"]["value"]["planned"] is False
    assert generate(tab, text % "true", laid)[-1]["story"]["value"]["planned"] is True


def test_every_story_of_the_page_is_read_in_limited_time(tab: SceneTab, monkeypatch: pytest.MonkeyPatch) -> None:
    laid, record = lay_out("They meet.")[1], generate(tab)[-1]["record"]
    monkeypatch.setattr(sentences, "READING_SECONDS", 1e-9)
    said = "The story took longer than 1e-09 seconds to read: shorten it"
    words = "They bow. They hug."
    for updates in (generate(tab, words), generate(tab, words, laid)):
        assert said in str(updates[-1]["line"]) and "record" not in updates[-1]
    assert said in str(written(words, laid)[1])
    fields = {"record": record, "sample": 0, "frame": 30, "story": laid, "words": words, "part": "futures"}
    for part in ({"part": "futures"}, {"part": "span", "story": {**laid, "span": [0.0, 1.0]}}):
        with pytest.raises(InputError, match=said):
            part_request({**fields, **part, "guidance": 1, "steps": 1, "damping": 0, "strictness": 0})
