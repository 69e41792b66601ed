"""Values for the functions of the page, made from what each component declares that it takes."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from gradio.components import Component, Slider
from pydantic import ValidationError

from webdemo.ui.components.accepts import accepts, accepts_event

WRONG: tuple[Any, ...] = (
    *({"path": "{upload}", "meta": {"_type": "gradio.FileData"}}, {"__type__": "update", "value": "{run}"}, ["{run}"]),
    *({}, [[[]]], True, -1, 0.5, 1e308, 10**30, "", "x" * 5000, "\0", "NaN", "../../canary.txt", None),
)
"""Of a type, size or meaning that hardly a component is sent."""

LENGTH = "length of the motion in seconds"


def usual(component: Component) -> Any:
    """What the page would send for a component that nobody touched; lengths are short, as all formats are written."""
    long = isinstance(component, Slider) or LENGTH in (component.label or "")
    value = (getattr(component, "minimum", None) or 1) if long else getattr(component, "value", None)
    try:
        accepts(component).validate_python(value)
    except ValidationError:
        return None
    return value


def takes_text(component: Component) -> bool:
    """True if a text somewhere in the component's value passes the guard."""
    schema = accepts(component).json_schema()
    return '"type": "string"' in str(schema).replace("'", '"') and "Upload" not in str(schema.get("$defs", ""))


def filled(component: Component, text: str) -> Any:
    """A value that the component declares, with the text wherever one may stand."""
    schema = accepts(component).json_schema()
    return _filled(schema, schema.get("$defs", {}), text)


def event_data(component: Any, text: str) -> Iterator[Any]:
    """Data of the component's events, with the text wherever one may stand and each known act."""
    schema = accepts_event(component).json_schema()
    value = _filled(schema, schema.get("$defs", {}), text)
    if isinstance(value, dict) and "act" in value:
        yield from ({**value, "act": act} for act in ("search", "link", "describe", "remove", "compare"))
    else:
        yield value


def _filled(schema: dict[str, Any], known: dict[str, Any], text: str) -> Any:
    """A value of a JSON schema; raises TypeError for what it does not know, so that it is added here."""
    match schema:
        case {"$ref": str(name)}:
            return _filled(known[name.rsplit("/", 1)[1]], known, text)
        case {"const": value}:
            return value
        case {"anyOf": [*choices]}:
            texts = [choice for choice in choices if choice.get("type") == "string"]
            return _filled((texts or choices)[0], known, text)
        case {"type": "string"}:
            return text
        case {"type": "number" | "integer"}:
            return 1
        case {"type": "boolean"}:
            return True
        case {"type": "null"}:
            return None
        case {"type": "array", "items": items}:
            return [_filled(items, known, text)]
        case {"type": "object", "properties": fields}:
            return {name: _filled(field, known, text) for name, field in fields.items()}
    raise TypeError(f"No value is known for {schema}: add a case.")
