"""The page's pieces of HTML: what they say, and that text in them stays text."""

from __future__ import annotations

import html
import re
import time
from dataclasses import replace

import pytest

from acts import read
from motion.metrics import MEASURES
from tests.ui.stub_engine import StubEngine, walking
from webdemo.inference.requests import GenerateRequest
from webdemo.inference.run import Progress, Result
from webdemo.ui.components.player import result_payload
from webdemo.ui.history import Entry
from webdemo.ui.public_html import Place, player_html
from webdemo.ui.text.panels import effect_line, model_state, notes_lines, readout_panel, status
from webdemo.ui.text.words import cancelled_line, link_line, progress_line, text

HOSTILE = "<img src=x onerror=alert(1)> ${alert(2)} {{value}} `x` \"quoted\" 'single'"


def result(**changed: object) -> Result:
    request = GenerateRequest(prompt="unknown " + HOSTILE, seconds=1, steps=2, **changed)
    return list(StubEngine().run(request))[-1]


def test_a_moment_is_one_day_wherever_it_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TZ", "UTC-14")
    time.tzset()
    entry = Entry(id="a", kind="generate", title="They bow.", state="done")
    told = link_line(86_000.0), player_html(entry, {}, Place(files=""), until=86_000.0)
    monkeypatch.undo()
    time.tzset()
    assert all("2 Jan 1970" in each for each in told)


def test_text_is_escaped_and_comes_back_the_same() -> None:
    escaped = text(HOSTILE)
    assert not set("<>${}`\"'") & set(re.sub(r"&#?\w+;", "", escaped))
    assert html.unescape(escaped) == HOSTILE


@pytest.mark.parametrize(
    "made",
    [
        status(HOSTILE, tone="error"),
        model_state("failed", HOSTILE),
        notes_lines({"": Result(duets=result().duets, manifest={}, notes=(HOSTILE,))}),
        readout_panel(Result(duets=result().duets, manifest={"request": {"kind": "react", "model": HOSTILE}})),
    ],
)
def test_no_panel_lets_markup_or_templates_through(made: str) -> None:
    assert "<img" not in made
    assert "${" not in made
    assert "{{" not in made


def test_readouts_show_what_was_before_and_what_is_better() -> None:
    made = readout_panel(result())
    for words in ("before → after damping", "Foot skate", "Jerk", "Penetration", "Bone drift"):
        assert words in made
    assert re.search(r"pd-better\">[\d.]+ → <b>", made)
    assert "nearest that it knows" in notes_lines({"": result()})


def test_notes_of_several_results_stand_once_and_say_whose_they_are() -> None:
    one, other = (replace(result(), notes=("Both.", *more)) for more in ((), ("After 2.0 s it waves.",)))
    said = re.findall(r"pd-(note|warning).*?>([^<]+)<", notes_lines({"seed 1": one, "seed 2": other}))
    assert said == [("warning", "Both."), ("note", "seed 2: After 2.0 s it waves.")]
    heard = read("Zwei Leute umarmen sich und tanzen.")
    shown = replace(
        one, notes=("Both.", *heard.notes), manifest={"plan": {"acts": [heard.model_dump()], "windows": []}}
    )
    assert heard.notes and notes_lines({"": shown}) == status("Both.", tone="warning"), "the reading says the rest"


def test_measures_that_could_not_be_determined_are_dashes() -> None:
    nothing = dict.fromkeys(measure.key for measure in MEASURES)
    readout = {"before": {"jerk": 30.0}, "after": nothing}
    made = readout_panel(Result(duets=(walking(1.0),), manifest={}, readouts=(readout,)))
    assert '<td class="">30 → <b>–</b></td>' in made


def test_the_player_gets_the_contacts_of_the_readouts() -> None:
    made = result()
    contact = {"start": 3, "stop": 9, "kind": "hands", "label": "hand on hand"}
    changed = Result(duets=made.duets, manifest={}, readouts=({**made.readouts[0], "contacts": [contact]},))
    payload = result_payload(changed, title=HOSTILE)
    assert payload["title"] == HOSTILE, "the player sets it as text"
    assert payload["samples"][0]["contacts"] == [contact]
    assert [curve["label"] for curve in payload["samples"][0]["curves"]] == ["Apart", "Hands"]


def test_progress_and_cancellation_name_the_step() -> None:
    event = Progress(stage="sample", step=12, total=50)
    assert progress_line(event) == "Denoising: step 12 of 50"
    frame = Progress(stage="sample", step=12, total=50, unit="frame")
    assert progress_line(frame) == "Generating: frame 12 of 50"
    assert cancelled_line(frame) == "Cancelled at frame 12 of 50."
    paced = Progress(stage="sample", step=12, total=50, elapsed=6.0)
    assert progress_line(paced) == "Denoising: step 12 of 50, about 20 s left"
    assert progress_line(Progress(stage="sample", step=2, total=50, elapsed=1.0)).endswith("of 50")
    assert progress_line(Progress(stage="sample", step=49, total=50, elapsed=10.0)).endswith("of 50")
    second = Progress(stage="sample", step=12, total=50, elapsed=62.0, attempt=2, attempts=4)
    assert progress_line(second) == "Try 2 of 4. Denoising: step 12 of 50, about 40 s left"
    assert progress_line(replace(second, stage="text", step=0)) == "Try 2 of 4. Reading the prompt …"
    assert cancelled_line(second) == "Cancelled at step 12 of 50 of try 2."
    assert cancelled_line(event) == "Cancelled at step 12 of 50."
    assert cancelled_line(Progress(stage="text")) == "Cancelled before the first step."
    assert cancelled_line(None) == "Cancelled before the first step."


def test_a_line_says_what_the_settings_did() -> None:
    def line(*shares: float | None) -> str:
        readouts = tuple({} if share is None else {"planned": share} for share in shares)
        return effect_line([Result(duets=(), manifest={}, readouts=readouts)])

    assert line(None) == "" == line(), "no sentence, no plan"
    assert "fixes all of this motion" in line(0.999) and "The network makes all" in line(0.0, 0.0)
    assert "fixes 62 %" in line(0.62) and "fixes 5 to 62 %" in line(0.62, 0.05)
    damped = Result(
        duets=(), manifest={}, readouts=({"planned": 0.5, "damped": 0.01}, {"planned": 0.5, "damped": 0.03})
    )
    assert "damping moved the joints by 2.0 cm on average" in effect_line([damped])
    assert "foot skate" in effect_line([result()]) and "→" in effect_line([result()])


@pytest.mark.parametrize(
    ("before", "after", "said"),
    [
        (4.191, 4.186, '<td class=""><b>4.19</b></td>'),
        (1.0, 0.5, 'pd-better">1.00 → <b>0.50<'),
        (1.0, 1.5, 'pd-worse">1.00 → <b>1.50<'),
        (0.0, 0.5, 'pd-worse">0.00 → <b>0.50<'),
    ],
)
def test_a_change_is_shown_only_where_the_figures_shown_differ(before: float, after: float, said: str) -> None:
    readout = {"before": {"penetration": before}, "after": {"penetration": after}}
    made = readout_panel(Result(duets=(walking(1.0),), manifest={}, readouts=(readout,)))
    row = next(row for row in made.split("<tr") if "Penetration" in row)
    assert said in row
