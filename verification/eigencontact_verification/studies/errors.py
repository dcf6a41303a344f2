"""Errors of formulas from the errors of the numbers and fields that they read."""

from __future__ import annotations

import ast
import re
from collections.abc import Mapping
from dataclasses import replace
from math import isclose
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.field_error import error_name
from eigencontact.errors import SceneError
from eigencontact_verification.studies.formula import Context, evaluate

if TYPE_CHECKING:
    import xarray as xr

    from eigencontact_verification.studies.study import Study

__all__ = ["Errors", "error_of", "errors_at_end", "with_errors"]

#: Error of numbers and readings by name; None where it is not known.
Errors = Mapping[str, float | None]
#: Functions of a field that no value of the field can lower by rising: where every value is off by its error, and to
#: the same side, they are off by the most. Differences and sums with signs would cancel.
_RISING = frozenset({"max", "min", "row", "middle", "nearest", "plane", "column"})


def with_errors(study: Study) -> Study:
    """Study whose runs estimate the errors of their numbers."""
    return replace(study, changes={**study.changes, "output.errors": True})


def errors_at_end(summary: Mapping[str, Any] | None, dataset: xr.Dataset) -> dict[str, float | None]:
    """Errors of the numbers whose bars are those of the last step; empty for a run without bars."""
    bars = (summary or {}).get("errors", {})
    return {
        name: bar["error"]
        for name, bar in bars.items()
        if name in dataset and isclose(float(np.ravel(dataset[name].values)[-1]), bar["value"])
    }


def error_of(formula: str, context: Context, errors: Errors) -> NDArray[np.float64] | None:
    """Error of a formula: what it changes by the error of each name that it reads, in sum.

    A field counts if the formula reads it once, through functions that pick or bound its values: it is shifted by its
    errors at all points, up and down. None where the formula reads anything else of the results that has no error bar,
    as earlier steps have none.

    Examples
    --------
    >>> context = Context({"radius": 2.0, "p": 5.0, "E": 9.0})
    >>> float(error_of("radius ** 2 / E", context, {"radius": 0.5, "p": None})), error_of("p / E", context, {"p": None})
    (0.25, None)
    """
    if not errors:
        return None
    names = set(re.findall(r"\w+", formula)) & errors.keys()
    nothing: dict[str, Any] = {name: None if error is None else 0.0 for name, error in errors.items()}
    fields = _fields(formula, context, errors)
    nothing |= dict.fromkeys(fields, 0.0)
    shifts: list[list[dict[str, Any]]] = [[{name: errors[name]}] for name in names]
    shifts += [[{name: sign * field} for sign in (1.0, -1.0)] for name, field in fields.items()]

    def shifted(shift: Mapping[str, Any]) -> NDArray[np.float64]:
        return np.asarray(evaluate(formula, replace(context, shifts={**nothing, **shift})), dtype=float)

    try:
        value = shifted({})
        changes = [np.max([np.abs(shifted(shift) - value) for shift in group], axis=0) for group in shifts]
    except SceneError:
        return None
    total = np.asarray(sum(changes, np.zeros_like(value)))
    return total if np.isfinite(total).all() else None


def _fields(formula: str, context: Context, errors: Errors) -> dict[str, Any]:
    """Errors at the end of the fields that a formula reads so that they bound its own."""
    data = context.dataset
    if data is None:
        return {}
    nodes = list(ast.walk(ast.parse(formula.strip(), mode="eval")))
    calls = {node.func.id for node in nodes if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)}
    if not calls <= _RISING or any(isinstance(node, ast.Compare) for node in nodes):
        return {}
    read = [node.id for node in nodes if isinstance(node, ast.Name)]
    return {
        name: evaluate(error_name(name), replace(context, shifts=None))
        for name in read
        if read.count(name) == 1 and name not in {*errors, *context.names} and data.get(name) is not None
        and data[name].ndim > 1 and error_name(name) in data
    }  # fmt: skip
