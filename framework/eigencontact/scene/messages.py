"""Pydantic's findings in our words: where, rule, value, nearest choice."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import Any

from pydantic import BaseModel

from eigencontact.errors import SceneError, nearest, shown
from eigencontact.scene.annotations import class_within

__all__ = ["explain_error", "find_unknown", "refuse_unknown"]

_RULES = {
    "float_type": "a number",
    "float_parsing": "a number",
    "int_type": "a whole number",
    "int_parsing": "a whole number",
    "int_parsing_size": "a whole number of fewer digits",
    "int_from_float": "a whole number",
    "bool_type": "true or false",
    "bool_parsing": "true or false",
    "string_type": "text",
    "string_pattern_mismatch": (
        "a plain name: letters, digits and '_', beginning with a letter (for an inclusion also blanks, '.' and '-')"
    ),
    "finite_number": "finite",
    "list_type": "an array",
    "tuple_type": "an array",
    "model_type": "a table",
    "dict_type": "a table",
    "model_attributes_type": "a table",
}


def explain_error(error: Mapping[str, Any], where: str) -> str:
    """One line for one finding of ``ValidationError.errors()``."""
    kind, got = error["type"], error.get("input")
    context = error.get("ctx", {})
    place = ".".join([where, *(str(segment).replace("_", "-") for segment in error["loc"])]).strip(".")
    if kind == "missing":
        return f"{place} must be given"
    if kind == "value_error":
        text = str(context.get("error", error["msg"]))
        return text if text.startswith("!") else f"{place} must be {text} (got {shown(got)})"
    if kind == "literal_error":
        choices = context["expected"]
        names = [name.strip("' ") for name in choices.replace(" or ", ",").split(",")]
        return f"{place} must be one of {choices} (got {shown(got)}){nearest(str(got), names)}"
    if kind in ("too_short", "too_long"):
        rule = f"at least {context['min_length']}" if kind == "too_short" else f"at most {context['max_length']}"
        return f"{place} must be an array of length {rule} (got length {context['actual_length']})"
    return f"{place} must be {_RULES.get(kind, error['msg'])} (got {shown(got)})"


def refuse_unknown(table: Iterable[str], known_keys: Iterable[str], where: str, see: str = "") -> None:
    """Refuse unknown keys of a table; the message names the nearest known key and the command that explains it."""
    known_keys = [name.replace("_", "-") for name in known_keys]
    for key in table:
        if key.replace("_", "-") not in known_keys:
            raise SceneError(
                f"unknown key {key!r} in {where or 'the scene'}; known: {', '.join(known_keys)}"
                f"{nearest(key.replace('_', '-'), known_keys)}"
                + (f"; `eigencontact {see}` explains them" if see else "")
            )


def find_unknown(data: Any, model: type[BaseModel], where: str = "") -> None:
    """Raise `SceneError` for the first unknown key of `data` or of a table in it."""
    if not isinstance(data, dict):
        return
    if model.model_config.get("extra") != "allow":  # else other keys belong to a plugin, which checks them
        place = re.sub(r"\.\d+|\.cycle\b", "", where)
        refuse_unknown(data, model.model_fields, where, f"schema {place}".strip())
    for key, value in data.items():
        field = model.model_fields.get(key.replace("-", "_"))
        inner = None if field is None else class_within(field.annotation, lambda cls: issubclass(cls, BaseModel))
        if inner is not None:
            for number, item in enumerate(value if isinstance(value, list) else [value]):
                place = f"{where}.{key}".strip(".") + (f".{number}" if isinstance(value, list) else "")
                find_unknown(item, inner, place)
