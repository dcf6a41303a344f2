"""Tables of a scene with formulas in them: put at keys, left out, filled in for one variant."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import deepcopy
from typing import Any

import numpy as np

from eigencontact.scene.loader import put_values
from eigencontact_verification.studies.formula import Context, evaluate

__all__ = ["changed", "filled"]

#: An entry of an array with this key stands for several: one for each value of the names in it.
_LOOP = "each"


def changed(tables: Mapping[str, Any], put: Mapping[str, Any], without: Sequence[str] = ()) -> dict[str, Any]:
    """Tables with values at dotted keys, and without others."""
    out = put_values(tables, deepcopy(dict(put)))
    for key in without:
        out.pop(key, None)
    return out


def filled(value: Any, context: Context, place: str) -> Any:
    """Tables with their formulas computed; `place` is their place, for messages.

    A text that begins with "=" is a formula. An entry of an array with a table ``each`` of one name and its values
    stands for an entry for each value, in which the formulas may use the name.

    Examples
    --------
    >>> filled([{"each": {"k": "count(3)"}, "load": "= 2 * k"}], Context({}), "steps")
    [{'load': 2.0}, {'load': 4.0}, {'load': 6.0}]
    """
    if isinstance(value, str):
        return _plain(evaluate(value[1:], context, place)) if value.startswith("=") else value
    if isinstance(value, Mapping):
        return {key: filled(item, context, f"{place}.{key}") for key, item in value.items()}
    if isinstance(value, list):
        return [entry for n, item in enumerate(value) for entry in _entries(item, context, f"{place}.{n}")]
    return value


def _entries(template: Any, context: Context, place: str) -> list[Any]:
    if not isinstance(template, Mapping) or _LOOP not in template:
        return [filled(template, context, place)]
    ((name, values),) = template[_LOOP].items()
    inner = {key: entry for key, entry in template.items() if key != _LOOP}
    listed = evaluate(values, context, place) if isinstance(values, str) else values
    entries: list[Any] = []
    for number in listed:
        entry = Context({**context.names, name: _plain(number)})
        nested = inner.get("entries")  # several entries for each value
        entries += filled(nested, entry, place) if nested is not None else [filled(inner, entry, place)]
    return entries


def _plain(value: Any) -> Any:
    """Numbers and lists instead of arrays."""
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    return value
