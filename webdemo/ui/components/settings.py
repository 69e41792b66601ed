"""Controls that say what is true: whether they are as what is shown was made, and what is folded away."""

from __future__ import annotations

import json
from collections.abc import Collection, Mapping, Sequence
from typing import Any

from webdemo.ui.text.texts import SAY, english, say

OPENED = "opened"
"""Stands for the settings of a run that was opened with all controls as they were."""
CHANGED = say("sampling.changed")
UNPLANNED = english("sampling.unplanned")
"""Ends the line over the folded settings where words do not become paths."""
ADVANCED = f"""(guidance, steps, damping, tries = 1, planned = true) => {{
  {SAY}
  const line = say("sampling.folded") + (tries > 1 ? say("sampling.folded_tries") : "")
    + (planned ? "" : say("sampling.unplanned"));
  const values = {{ guidance, steps, damping, tries }};
  return {{ __type__: "update", label: line.replace(/\\{{(\\w+)\\}}/g, (_, name) => values[name]) }};
}}"""
"""JavaScript that gives the line over the folded settings; :func:`advanced_label` begins it in Python."""


def advanced_label(guidance: float, steps: int, damping: float, tries: int = 1) -> str:
    """The line over the folded settings, where words become paths; the browser puts it into its language."""
    more = english("sampling.folded_tries", tries=tries) if tries > 1 else ""
    return english("sampling.folded", guidance=f"{guidance:g}", steps=steps, damping=f"{damping:g}") + more


def folded_at_first(guidance: float, steps: int, damping: float) -> str:
    """The same line as the page is built with it."""
    return say("sampling.folded", guidance=f"{guidance:g}", steps=steps, damping=f"{damping:g}")


def snapshot(fields: Mapping[str, Any], names: Collection[str]) -> str:
    """The values of controls as :func:`differs` compares them; "" where a run used only some of them."""
    return json.dumps({name: fields[name] for name in names}) if set(names) <= fields.keys() else ""


def differs(names: Sequence[str]) -> str:
    """JavaScript that says whether controls of these names differ from a snapshot, given before them."""
    changed = json.dumps(f'<p class="pd-status pd-warning" role="status">{CHANGED}</p>')
    return f"""(asked, ...values) => {{
  if (!asked || asked === "{OPENED}") return "";
  const was = JSON.parse(asked);
  const same = (name, i) => String(was[name] ?? "") === String(values[i] ?? "");
  return {json.dumps(list(names))}.every(same) ? "" : {changed};
}}"""


def taken(names: Sequence[str]) -> str:
    """JavaScript that takes a snapshot of controls of these names where a run was just opened."""
    return f"""(asked, ...values) => {{
  if (asked !== "{OPENED}") return asked;
  return JSON.stringify(Object.fromEntries({json.dumps(list(names))}.map((name, i) => [name, values[i] ?? null])));
}}"""


def looked_up(table: Mapping[str, Sequence[Any]]) -> str:
    """JavaScript that answers with the updates of a table by the value, or values joined by "/", of its inputs.

    The browser answers at once, so that no late update takes back what was set meanwhile.
    """
    return f"(...keys) => ({json.dumps(table)})[keys.map((key) => key ?? '').join('/')]"
