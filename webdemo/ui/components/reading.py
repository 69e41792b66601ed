"""The reading of a prompt, under it: the sentence with its marks, and its plan as chips on two lanes.

The browser (``static/reading``) asks as somebody types; what is shown is made here, from the plan that
:func:`acts.read` gives. What a user typed travels as data and is set as text.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from typing import Any, ClassVar

import gradio as gr
from pydantic import TypeAdapter

from acts import Act, Plan, lexicon, read
from acts.captions import short
from acts.checking import NO_RULE
from acts.plan import plan_of
from motion import InputError
from webdemo.inference.requests.paths import FloorPath, path_of
from webdemo.inference.story.sentences import beats_of
from webdemo.ui.text.words import error_line

from .accepts import Finite, Sent, SentPaths, Text
from .part import Part

READERS = 2
"""Texts that are read at once; further ones wait in the fair queue of events, those of programs as well."""
READING_EVENTS = "reading"
"""Their group of events."""

_TYPED = """(text) => ({ __type__: "update", props: { text: text ?? "" } })"""
"""JavaScript that tells the component what is typed; it waits for a pause and asks."""


_READ_FIRST = """async (...values) => {
  const [id, text, seconds] = %s;
  await document.querySelector(`#${id} .pdr`)?.view?.readFirst(values[text] ?? "");
  const shown = document.querySelector("#seconds input[type=number]");
  if (shown) values[seconds] = Number(shown.value);
  return values;
}"""


class SentReading(Sent):
    """The value as the browser sends it.

    Attributes:
        text: stands in the prompt.
        plan: of this text, as JSON, where it was edited; otherwise the text is read.
        number: of the question; its answer has the same.
        paths: drawn on the stage for the next run.
    """

    text: Text = ""
    plan: Text | None = None
    number: Finite = 0
    paths: SentPaths


class Reading(Part):
    """Shows how a text is understood, and lets its plan be edited.

    Props beside the value, which is a :class:`SentReading`: ``text``, what is typed; ``shown``, see :func:`shown`;
    ``checked``, see :func:`checked`.

    Args:
        value: as the browser sends it.
        editable: whether the plan can be edited.
        usual: seconds of the page's slider at first, where it has one.
        elem_id: id of the element in the page.
    """

    accepts = TypeAdapter(SentReading | None)
    folder = "reading"
    styled = True
    declared: ClassVar = {"text": "", "shown": None, "checked": {}, "editable": False, "usual": 0}

    def read_first(self, prompt: gr.Textbox, seconds: gr.Slider, inputs: Iterable[gr.Component]) -> str:
        """JavaScript for a run of ``inputs``, a set, that waits until its prompt is read and takes the length then."""
        order = sorted(inputs, key=lambda part: part._id)  # as Gradio passes a set
        return _READ_FIRST % json.dumps([self.elem_id, order.index(prompt), order.index(seconds)])

    def follow(self, prompt: gr.Textbox, **quiet: Any) -> None:
        """Reads what is typed into a prompt; ``quiet`` are the options of the page's own events."""
        prompt.change(None, inputs=prompt, outputs=self, js=_TYPED, **quiet)
        self.input(
            reread,
            inputs=self,
            outputs=self,
            trigger_mode="always_last",
            concurrency_limit=READERS,
            concurrency_id=READING_EVENTS,
            **quiet,
        )


def reread(sent: Any) -> dict[str, Any]:
    """The update that shows how the text that was sent is understood, or the plan that was sent with it."""
    fields = sent if isinstance(sent, Mapping) else {}
    text = str(fields.get("text") or "")
    asked = {"text": text, "number": fields.get("number"), "edited": bool(fields.get("plan"))}
    try:
        plan = edited_plan(sent, text) or read(text)
        reading = shown(plan)
    except Exception as error:
        reading = {"error": error_line(error)}
    return gr.update(shown=asked | reading)


def edited_plan(sent: Any, text: str) -> Plan | None:
    """The plan that was edited, if it is for this text; otherwise None.

    Raises:
        InputError: if it is no plan, or of acts that nobody knows.
    """
    if not isinstance(sent, Mapping) or not sent.get("plan") or sent.get("text") != text:
        return None
    try:
        values = json.loads(str(sent["plan"]))
    except (ValueError, RecursionError):
        raise InputError("The plan on the page is damaged: press Read again.") from None
    plan = plan_of(values)
    for act in plan.acts:
        if act.act not in lexicon().entries:
            raise InputError(f"There is no act “{act.act}”: press Read again.")
    return plan


def drawn_paths(sent: Any) -> tuple[FloorPath, ...]:
    """The paths that were drawn for the next run.

    Raises:
        InputError: if they are none.
    """
    listed = sent.get("paths") if isinstance(sent, Mapping) else None
    try:
        return tuple(path_of(entry) for entry in listed or ())
    except (TypeError, ValueError, AttributeError) as error:
        raise InputError("The paths on the page are damaged: remove them and draw them again.") from error


def shown(plan: Plan) -> dict[str, Any]:
    """A plan as the component draws it.

    Returns:
        ``plan`` as JSON; ``beats``, the ids of its acts, one list for each; ``said``, each
        act in a few words by its id, ``whys`` of what was not understood, and ``notes``; ``nearest``, the facts of each
        act that is offered for words that were not understood, by its name; ``seconds``, what all its beats take, in
        halves of a second.
    """
    entries = lexicon().entries
    nearest = dict.fromkeys(name for part in plan.unread for name in part.nearest if name in entries)
    return {
        "plan": plan.model_dump(mode="json"),
        "beats": [[act.id for act in group] for group in plan.beats()],
        "said": {act.id: short(act, entries.get(act.act)) for act in plan.acts},
        "whys": [part.why for part in plan.unread],
        "notes": [*plan.notes, *(doubt.why for doubt in plan.doubts)],
        "nearest": {name: entry_facts(name) for name in nearest},
        "seconds": round(2 * sum(beat.length for beat in beats_of(plan))) / 2,
    }


def entry_facts(name: str) -> dict[str, Any]:
    """An act of the lexicon as it is offered for words that were not understood.

    Returns:
        its ``name``; ``said``, in a few words; whether it has a ``patient``; whether it is ``mutual``.
    """
    entry = lexicon().entries[name]
    return {
        "name": name,
        "said": short(Act(id="1", act=name, agents=("a",), patient="b"), entry),
        "patient": any("{b" in text for text in (*entry.caption, *entry.frames)),
        "mutual": entry.mutual,
    }


def checked(text: str, manifest: Mapping[str, Any]) -> dict[str, Any]:
    """The verdicts on a result's acts, as the component marks them; {} where there are none.

    Not None, for which Gradio's page leaves a prop as it is.

    Args:
        text: its prompt.
        manifest: of the result, or of its first sample; ``checked`` has a row for each act in the order of the
            sentence, and ``unread`` the words that are in no act.
    """
    acts = [_verdict(row) for row in manifest.get("checked") or ()]
    return {"text": text, "acts": acts, "unread": list(manifest.get("unread") or ())} if acts else {}


def _verdict(row: Mapping[str, Any]) -> dict[str, Any]:
    """An act's mark and the reason for it; ``done`` is None where a part of what was said is not measured."""
    done, measure = row.get("done"), str(row.get("measure") or "")
    left = [f"read from “{row['wrote']}”"] if row.get("wrote") else row.get("unchecked")
    if left and done is not False:
        done, measure = None, "; ".join(left)
    return {"act": row.get("act"), "done": done, "measure": "" if measure == NO_RULE else measure}
