"""Formulas of a study: arithmetic on its constants, its parameters and the results of a variant.

What a formula can say is listed in `FUNCTIONS` and `MOMENTS`; nothing else of the language behind it is understood.
"""

from __future__ import annotations

import ast
import math
import operator
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.errors import SceneError, nearest
from eigencontact_verification.studies.closed_forms import CLOSED_FORMS
from eigencontact_verification.studies.moments import MOMENTS

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["FUNCTIONS", "Context", "evaluate"]

Value = Any

#: Most values that a function of a formula makes.
_MOST = 1_000_000


def _power(base: Value, exponent: Value) -> Value:
    """Power of float64: whole numbers of any length would take any time."""
    return (float(base) if isinstance(base, int) else base) ** exponent


def _bounded(n: Value) -> int:
    if not n <= _MOST:
        raise SceneError(f"a formula must make at most {_MOST} values (got {n:g})")
    return int(n)


_BINARY: dict[type, Callable[[Any, Any], Any]] = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv,
    ast.Pow: _power, ast.Mod: operator.mod, ast.FloorDiv: operator.floordiv,
    ast.BitAnd: np.logical_and, ast.BitOr: np.logical_or,
    ast.Eq: operator.eq, ast.NotEq: operator.ne, ast.Lt: operator.lt, ast.LtE: operator.le, ast.Gt: operator.gt,
    ast.GtE: operator.ge,
}  # fmt: skip
_UNARY: dict[type, Callable[[Any], Any]] = {ast.USub: operator.neg, ast.UAdd: operator.pos, ast.Not: operator.not_}


def _row(value: xr.DataArray) -> xr.DataArray:
    return value.isel(y=int(np.abs(value["y"].values).argmin()))


def _across(value: xr.DataArray) -> xr.DataArray:
    return value.isel(x=int(np.abs(value["x"].values).argmin()))


def _runs(holds: Any) -> int:
    return int(np.sum(np.diff(np.concatenate([[0], np.ravel(holds).astype(int)])) > 0))


def _peaks(values: Any) -> int:
    """Number of places where values stop to rise; a flat top is one."""
    steps = np.sign(np.diff(np.ravel(values)))
    return _runs(steps[steps != 0] > 0)


def _middle(value: xr.DataArray) -> xr.DataArray:
    for axis in ("x", "y"):
        distance = np.abs(value[axis].values)
        value = value.isel({axis: np.flatnonzero(distance <= 1.01 * distance.min())})
    return value.mean()


def _place(coordinate: xr.DataArray, value: xr.DataArray) -> float:
    """Coordinate of the largest value; the first of several."""
    at = np.unravel_index(int(np.nanargmax(value.values)), value.shape)
    return float(coordinate.values[at[value.dims.index(coordinate.dims[0])]])


def _alternating(value: xr.DataArray, *axes: str) -> float:
    numbers = [value.dims.index(next(dim for dim in value.dims if str(dim).endswith(f"_{axis}"))) for axis in axes]
    sign = sum(np.indices(value.shape)[axis] for axis in numbers) % 2 * 2 - 1
    return abs(float((sign * value.values).sum())) / float(value.values.sum())


def _parted(values: Any, places: Any, border: float) -> Any:
    """Values with a gap where the places pass a border."""
    return np.insert(np.asarray(values, dtype=float), int(np.searchsorted(np.asarray(places), border)), np.nan)


def _lattice(x: Any, y: Any, z: Any) -> list[list[float]]:
    _bounded(np.size(x) * np.size(y) * np.size(z))
    return [[float(a), float(b), float(c)] for c in np.ravel(z) for b in np.ravel(y) for a in np.ravel(x)]


def _integral(y: Any, x: Any) -> float:
    heights, steps = np.asarray(y), np.diff(np.asarray(x))
    return float(np.sum(0.5 * (heights[1:] + heights[:-1]) * steps))


def _whole(value: Any) -> Any:
    return round(float(value))


#: Functions of formulas, and what they give.
FUNCTIONS: dict[str, tuple[Callable[..., Any], str]] = {
    "abs": (np.abs, "absolute value"),
    "sqrt": (np.sqrt, "square root"),
    "exp": (np.exp, "exponential"),
    "log": (np.log, "natural logarithm"),
    "round": (_whole, "nearest whole number"),
    "max": (lambda *values: np.max(values[0]) if len(values) == 1 else max(values), "largest value"),
    "min": (lambda *values: np.min(values[0]) if len(values) == 1 else min(values), "smallest value"),
    "sum": (np.sum, "sum"),
    "mean": (np.mean, "mean"),
    "sort": (np.sort, "values in order"),
    "join": (lambda *arrays: np.concatenate([np.ravel(array) for array in arrays]), "values one after the other"),
    "if_else": (lambda condition, first, second: first if condition else second, "the second value if the first holds"),
    "count": (lambda n: np.arange(1.0, _bounded(n) + 1.0), "1, 2, … n"),
    "places": (lambda n: np.arange(_bounded(n)) - 0.5 * (n - 1), "n places one apart, with 0 in their middle"),
    "column": (lambda values, n: values[:, int(n)], "one column of a table: of points over steps, the course of one"),
    "linspace": (lambda a, b, n: np.linspace(a, b, _bounded(n)), "n values from a to b, evenly"),
    "geomspace": (lambda a, b, n: np.geomspace(a, b, _bounded(n)), "n values from a to b, by one ratio"),
    "lattice": (_lattice, "points [x, y, z] of all combinations, x fastest"),
    "interp": (lambda at, x, y: np.interp(at, np.ravel(x), np.ravel(y)), "y at a place, linear between values of x"),
    "integral": (_integral, "∫ y dx by the trapezoidal rule; first y, then x"),
    "where": (lambda value, condition: value.where(condition), "values where a condition holds"),
    "row": (_row, "surface field along the row of cells next to y = 0"),
    "across": (_across, "surface field along the column of cells next to x = 0"),
    "diagonal": (lambda value: np.diagonal(value.transpose("y", "x").values), "surface field along x = y"),
    "runs": (_runs, "number of separate stretches of a row where a condition holds"),
    "peaks": (_peaks, "number of maxima along a row"),
    "middle": (_middle, "surface field at x = y = 0"),
    "nearest": (lambda value, x: value.sel(x=float(x), method="nearest"), "value of a row at the cell nearest to x"),
    "pitch": (lambda axis: float(axis[1] - axis[0]), "distance of the first two places of an axis"),
    "plane": (lambda value: value.isel(y=0) if "y" in value.dims else _middle_plane(value), "cells in the plane y = 0"),
    "place": (_place, "coordinate at which a field is largest; first the coordinate, then the field"),
    "parted": (_parted, "values with a gap where places pass a border: parted(values, places, border)"),
    "alternating": (_alternating, "part of the sum that alternates from cell to cell along the axes named"),
    **CLOSED_FORMS,
}


def _middle_plane(value: xr.DataArray) -> xr.DataArray:
    dim = next(str(dim) for dim in value.dims if str(dim).endswith("_y"))
    return value.isel({dim: int(np.abs(value[dim].values).argmin())})


@dataclass(frozen=True)
class Context:
    """Meaning of the names in a formula."""

    names: Mapping[str, Value]  #: constants, parameters and readings
    dataset: xr.Dataset | None = None  #: results of a variant; a bare name is the value at the end
    at: Any = field(default=-1)
    #: Added to numbers and fields at the end and to readings; then nothing else of the results may be read, nor what
    #: has None.
    shifts: Mapping[str, Any] | None = None


def evaluate(text: str, context: Context, place: str = "formula") -> Value:
    """Value of a formula; `place` is its place, for messages.

    Raises
    ------
    SceneError
        A formula that cannot be read, or an unknown name, with the nearest.

    Examples
    --------
    >>> evaluate("E / (1 - nu**2)", Context({"E": 91.0, "nu": 0.3}))
    100.0
    """
    try:
        return _value(_parsed(text), context)
    except SceneError as problem:
        raise SceneError(f"{place}: {problem} in {text!r}") from None
    except OverflowError:
        raise SceneError(f"{place} must stay within the range of float64 (got {text!r})") from None
    except Exception as problem:
        if isinstance(problem, KeyboardInterrupt | MemoryError):
            raise
        raise SceneError(f"{place} must be a formula (got {text!r}): {problem}") from None


@cache
def _parsed(text: str) -> ast.expr:
    if len(text) > 2000:
        raise SceneError(f"a formula must have at most 2000 letters (got {len(text)})")
    try:
        return ast.parse(text.strip(), mode="eval").body
    except (SyntaxError, ValueError, RecursionError):
        raise SceneError("a formula must be arithmetic, as 'max_pressure / p0'") from None


def _value(node: ast.expr, context: Context) -> Value:
    match node:
        case ast.Constant(value=int() | float() | str() as value) if not isinstance(value, bool):
            return value
        case ast.Name(id=name):
            return _of_name(name, context)
        case ast.UnaryOp(op=op, operand=operand) if type(op) in _UNARY:
            return _UNARY[type(op)](_value(operand, context))
        case ast.BinOp(left=left, op=op, right=right) if type(op) in _BINARY:
            operands = _value(left, context), _value(right, context)
            if any(isinstance(operand, str) for operand in operands):
                raise SceneError("texts in a formula must not be used in arithmetic")
            return _BINARY[type(op)](*operands)
        case ast.Compare(left=left, ops=[op], comparators=[right]) if type(op) in _BINARY:
            return _BINARY[type(op)](_value(left, context), _value(right, context))
        case ast.BoolOp(op=op, values=values):
            several = (_value(item, context) for item in values)
            return all(several) if isinstance(op, ast.And) else any(several)
        case ast.Subscript(value=value, slice=index):
            return _value(value, context)[_index(index, context)]
        case ast.List(elts=several) | ast.Tuple(elts=several):
            return np.asarray([_value(item, context) for item in several])
        case ast.Call(func=ast.Name(id=name), args=arguments, keywords=[]):
            return _of_call(name, arguments, context)
        case _:
            raise SceneError(
                f"a formula must have only numbers, names, + - * / **, comparisons, {', '.join(_functions())}"
            )


def _index(node: ast.expr, context: Context) -> Any:
    if isinstance(node, ast.Slice):
        ends = [None if end is None else int(_value(end, context)) for end in (node.lower, node.upper)]
        return slice(*ends)
    return int(_value(node, context))


def _functions() -> list[str]:
    return [*FUNCTIONS, *MOMENTS, "given", "has"]


def _of_call(name: str, arguments: list[ast.expr], context: Context) -> Value:
    first = arguments[0].id if arguments and isinstance(arguments[0], ast.Name) else ""
    if name == "given":
        return first in context.names
    if name == "has":
        return context.dataset is not None and first in context.dataset
    if name in MOMENTS:
        if context.dataset is None:
            raise SceneError(f"{name}() requires results, which are not available here")
        *leading, inner = arguments
        places = [_value(item, replace(context, at=slice(None), shifts=None)) for item in leading]
        return _value(inner, replace(context, at=MOMENTS[name][0](context.dataset, *places)))
    if name == "if_else":  # only what is chosen must have a value
        condition, item, alternative = arguments
        return _value(item if bool(_value(condition, context)) else alternative, context)
    if name not in FUNCTIONS:
        raise SceneError(
            f"function must be one of {', '.join(_functions())} (got {name!r}){nearest(name, _functions())}"
        )
    return FUNCTIONS[name][0](*(_value(item, context) for item in arguments))


def _of_name(name: str, context: Context) -> Value:
    if name == "pi":
        return math.pi
    if context.shifts is not None and (name in context.shifts or name not in context.names):
        return _shifted(name, context, context.shifts.get(name))
    if name in context.names:
        return context.names[name]
    dataset = context.dataset
    if dataset is None or name not in dataset:
        names = [*context.names, *(() if dataset is None else map(str, dataset.variables))]
        raise SceneError(f"name must be one of {', '.join(names)} (got {name!r}){nearest(name, names)}")
    variable = dataset[name]
    if "step" in variable.dims:
        return variable.isel(step=context.at)
    if "history_step" in variable.dims:
        numbers = np.atleast_1d(dataset["step"].values[context.at])
        stored_places = np.flatnonzero(np.isin(dataset["history_step"].values, numbers))
        if stored_places.size == 0:
            raise SceneError(f"{name} is not stored for the requested step")
        return variable.isel(history_step=int(stored_places[-1]))
    return variable


def _shifted(name: str, context: Context, shift: Any) -> Value:
    """Value of a reading, or of a number or field at the end, with its shift."""
    steps = 0 if context.dataset is None else context.dataset.sizes.get("step", 0)
    if shift is None or (name not in context.names and context.at not in (-1, steps - 1)):
        raise SceneError(f"{name} has no error bar there")
    return _of_name(name, replace(context, shifts=None)) + shift
