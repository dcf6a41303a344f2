"""Errors of formulas from the error bars of the numbers that they read."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace
from math import isclose
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.errors import SceneError
from eigencontact_verification.studies.formula import Context, evaluate

if TYPE_CHECKING:
    import xarray as xr

    from eigencontact_verification.studies.study import Study

__all__ = ["Errors", "error_of", "errors_at_end", "with_errors"]

#: Error of numbers and readings by name; None where it is not known.
Errors = Mapping[str, float | None]


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

    None where it reads anything of the results that has no error bar, as fields and earlier steps have none.

    Examples
    --------
    >>> context = Context({"radius": 2.0, "p": 5.0, "E": 9.0})
    >>> float(error_of("radius ** 2 / E", context, {"radius": 0.5, "p": None})), error_of("p / E", context, {"p": None})
    (0.25, None)
    """
    if not errors:
        return None
    names = set(re.findall(r"\w+", formula)) & errors.keys()
    nothing = {name: None if error is None else 0.0 for name, error in errors.items()}
    try:
        value, *others = (
            np.asarray(evaluate(formula, replace(context, shifts={**nothing, **shift})), dtype=float)
            for shift in ({}, *({name: errors[name]} for name in names))
        )
    except SceneError:
        return None
    return np.asarray(sum((np.abs(other - value) for other in others), np.zeros_like(value)))
