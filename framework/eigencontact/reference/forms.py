"""JSON Schema of the values that a field accepts, from its annotation, and a description in words.

Beside the words of JSON Schema a form has ``x-unit``, ``x-rule``, ``x-kind`` (of plugin) and ``x-file``.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import is_dataclass
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from annotated_types import MinLen
from pydantic import AfterValidator, BaseModel, BeforeValidator
from pydantic.fields import FieldInfo

from eigencontact.core.quantities import AlikeMark, FileMark, Unit
from eigencontact.plugin.component import Component
from eigencontact.scene.annotations import class_within, parts_of
from eigencontact.scene.checks import BOUNDARY_OF_AXES, both_alike, boundary_of_axes
from eigencontact.scene.table import Also, OfKind

__all__ = ["Form", "form_of", "in_words", "kinds_within", "table_within", "unit_within"]

Form = dict[str, Any]
_PLAIN = {bool: "boolean", int: "integer", float: "number", str: "string"}
_WORDS = {"boolean": "true or false", "integer": "a whole number", "number": "a number", "string": "text"}


def form_of(hint: Any) -> Form:
    """Form of an annotation; tables in it are references to the definition of their class."""
    origin, parts = get_origin(hint), get_args(hint)
    if origin is Annotated:
        form = form_of(parts[0])
        for mark in parts[1:]:
            form = _marked(form, mark)
        return form
    if origin is Literal:
        return _any_of([{"const": value} for value in parts])
    if origin in (Union, UnionType):
        return _any_of([form_of(argument) for argument in parts if argument is not NoneType])
    if origin is tuple and parts[-1:] != (...,):
        inner = [form_of(argument) for argument in parts]
        return {"type": "array", "prefixItems": inner, "minItems": len(inner), "maxItems": len(inner)}
    if origin in (list, tuple):
        item = form_of(parts[0])
        several = {"type": "array", "items": item}
        return {"anyOf": [item, several]} if "$ref" in item else several  # one table stands for an array of one
    if origin is dict:
        return {"type": "object", "additionalProperties": form_of(parts[1])}
    if isinstance(hint, type) and issubclass(hint, Component):
        return {"$ref": f"#/$defs/{hint.kind}", "x-kind": hint.kind}
    if isinstance(hint, type) and (issubclass(hint, BaseModel) or is_dataclass(hint)):
        return {"$ref": f"#/$defs/{hint.__name__}"}
    return {"type": _PLAIN[hint]} if hint in _PLAIN else {}


def _any_of(forms: list[Form]) -> Form:
    """One of several; constants together."""
    flat = [inner for form in forms for inner in (form["anyOf"] if set(form) == {"anyOf"} else [form])]
    constants = [value for form in flat for value in ([form["const"]] if "const" in form else form.get("enum", []))]
    further = [form for form in flat if "const" not in form and "enum" not in form]
    forms = ([{"enum": constants}] if constants else []) + further
    return forms[0] if len(forms) == 1 else {"anyOf": forms}


def _marked(form: Form, mark: Any) -> Form:
    """Form with the content of one mark of an annotation."""
    if isinstance(mark, FieldInfo):
        for inner in mark.metadata:
            form = _marked(form, inner)
    elif isinstance(mark, Unit):
        return {"anyOf": [{"type": "number"}, {"type": "string"}], "x-unit": mark.symbol, "x-name": mark.name}
    elif isinstance(mark, OfKind):
        kind = {"$ref": f"#/$defs/{mark.kind}", "x-kind": mark.kind}
        if form.get("type") == "array" or "anyOf" in form:
            return {"anyOf": [kind, {"type": "array", "items": kind}]}
        if mark.default:
            return {"anyOf": [kind, {"type": "object", "not": {"required": ["type"]}}]}
        return kind if form else {"anyOf": [{"type": "number"}, {"type": "array"}, kind]}
    elif isinstance(mark, Also):
        return {"anyOf": [{"const": mark.text}, form]}
    elif isinstance(mark, AlikeMark):
        return {"anyOf": [form["prefixItems"][0], form]}
    elif isinstance(mark, FileMark):
        return {**form, "x-file": True}
    elif isinstance(mark, MinLen):
        return {**form, "minItems" if "items" in form else "minLength": mark.min_length}
    elif isinstance(mark, BeforeValidator) and mark.func is both_alike:
        return {"anyOf": [form["prefixItems"][0], form]}
    elif isinstance(mark, BeforeValidator) and mark.func is boundary_of_axes:
        return _any_of([form, {"enum": [list(axes) for axes in BOUNDARY_OF_AXES]}])
    elif isinstance(mark, AfterValidator) and hasattr(mark.func, "rule"):
        return {**form, "x-rule": mark.func.rule}
    return form


def in_words(form: Mapping[str, Any]) -> str:
    """Form as a phrase: ``a length [m], positive and finite``."""
    rule = form.get("x-rule", "")
    if "x-unit" in form:
        return _ruled(f"{form['x-name']} [{form['x-unit']}]", re.sub(r" \[.*\]$", "", rule))
    if "x-kind" in form:
        return f"a table of a plugin ({form['x-kind']})"
    if "x-file" in form:
        return "path of a file"
    if "$ref" in form:
        return "a table"
    if "enum" in form:
        return "one of " + ", ".join(map(_toml, form["enum"]))
    if "const" in form:
        return _toml(form["const"])
    several = _several(form.get("anyOf", ()))
    if several:
        return f"{in_words(form['anyOf'][0])}; or {several}"
    if "anyOf" in form:
        return _ruled(
            " or ".join(
                dict.fromkeys(in_words(alternative) for alternative in form["anyOf"] if "not" not in alternative)
            ),
            rule,
        )
    if "prefixItems" in form:
        inner = list(dict.fromkeys(map(in_words, form["prefixItems"])))
        return f"an array of {len(form['prefixItems'])}: {'; '.join(inner)}"
    if form.get("type") == "array":
        return "an array" + (f", each {in_words(form['items'])}" if form.get("items") else "")
    if form.get("type") == "object":
        inner_form = form.get("additionalProperties")
        return "a table by name" + (f", each {in_words(inner_form)}" if inner_form else "")
    return _ruled(_WORDS.get(str(form.get("type")), "a value"), rule)


def _several(forms: Sequence[Form]) -> str:
    """Description of the second of two forms if it is an array of the first; else empty."""
    if len(forms) == 2 and forms[1].get("items") == forms[0]:
        return "an array of them"
    inner = forms[1].get("prefixItems") if len(forms) == 2 else None
    return f"an array of {len(inner)} of them" if inner and inner[0] == forms[0] else ""


def _ruled(text: str, rule: str) -> str:
    return f"{text}, {rule.removesuffix(' [-]')}" if rule else text


def _toml(value: Any) -> str:
    if isinstance(value, list):
        return f"[{', '.join(map(_toml, value))}]"
    return str(value).lower() if isinstance(value, bool) else f'"{value}"' if isinstance(value, str) else str(value)


def kinds_within(form: Form) -> list[str]:
    """Kinds of plugin in a form and its inner forms, without repetitions."""
    inner = [*form.get("anyOf", ()), *form.get("prefixItems", ())]
    inner += [form[name] for name in ("items", "additionalProperties") if isinstance(form.get(name), dict)]
    below = [kind for inner_form in inner for kind in kinds_within(inner_form)]
    return list(dict.fromkeys([form["x-kind"], *below] if "x-kind" in form else below))


def table_within(hint: Any) -> type | None:
    """Class of the tables in a field, if they are not components."""

    def fits(cls: type) -> bool:
        return not issubclass(cls, Component) and (issubclass(cls, BaseModel) or is_dataclass(cls))

    table: type | None = class_within(hint, fits)
    return table


def unit_within(hint: Any) -> str | None:
    """SI unit of the numbers in a field."""
    return next((element.symbol for element in parts_of(hint) if isinstance(element, Unit)), None)
