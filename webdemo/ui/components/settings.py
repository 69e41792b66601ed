"""Controls that say what is true: whether they are as what is shown was made, and what is folded away."""

from __future__ import annotations

import json
from collections.abc import Collection, Mapping, Sequence
from typing import Any

from webdemo.ui.text.panels import status

OPENED = "opened"
"""Stands for the settings of a run that was opened with all controls as they were."""
CHANGED = "Settings changed: run again to see what they do."

UNPLANNED = ", no paths"
"""Ends the line over the folded settings where words do not become paths."""
ADVANCED = f"""(guidance, steps, damping, tries = 1, planned = true) => ({{
  __type__: "update",
  label: `Guidance ${{guidance}}, ${{steps}} steps, damping ${{damping}}`
    + (tries > 1 ? `, ${{tries}} tries` : "") + (planned ? "" : "{UNPLANNED}"),
}})"""
"""JavaScript that gives the line over the folded settings; :func:`advanced_label` begins it in Python."""


def advanced_label(guidance: float, steps: int, damping: float, tries: int = 1) -> str:
    """The line over the folded settings, where words become paths."""
    more = f", {tries} tries" if tries > 1 else ""
    return f"Guidance {guidance:g}, {steps} steps, damping {damping:g}{more}"


def snapshot(fields: Mapping[str, Any], names: Collection[str]) -> str:
    """The values of controls as :func:`differs` compares them; "" where a run used only some of them."""
    return json.dumps({name: fields[name] for name in names}) if set(names) <= fields.keys() else ""


def differs(names: Sequence[str]) -> str:
    """JavaScript that says whether controls of these names differ from a snapshot, given before them."""
    changed = json.dumps(status(CHANGED, tone="warning"))
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
