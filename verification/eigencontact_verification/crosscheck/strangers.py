"""Parameters and symmetries of a shape without a case in the table, found from the shape alone.

A plugin may say with which parameters it is to be checked: a class attribute ``example``, a mapping of its fields.
Without it, lengths are tried: the fields that have no default get lengths from a short ladder, in every order, until
the shape accepts them and contains something; a field annotated `Place` puts it below the surface, on the axis.
"""

from __future__ import annotations

import hashlib
import inspect
from collections.abc import Iterator, Mapping
from dataclasses import MISSING, fields
from itertools import permutations
from typing import Any, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import NDArray

from eigencontact import EigencontactError, make
from eigencontact.core.places import place_field

__all__ = ["evenly", "example_of", "is_mirrored", "is_revolved", "point_inside", "symmetries_of", "text_digest"]

FloatArray = NDArray[np.float64]

_LENGTHS = (1.0, 0.4, 0.3, 0.6, 0.5)
_SCALES = (1.0, 1e-6)
_GOLDEN = 1.2207440846057596  # root of g^4 = g + 1: powers of 1/g fill the cube evenly


def example_of(component: type, *, clearance: float = 0.75) -> dict[str, Any]:
    """Parameters with which `make` builds a shape of this class below the surface.

    Parameters
    ----------
    component : type
        Class of an inclusion shape.
    clearance : float
        Depth of its top over its longest extent, where it has a centre that can be chosen.

    Raises
    ------
    ValueError
        Nothing that was tried is accepted; says how to declare an example.
    """
    key = str(getattr(component, "key", component.__name__))
    declared = getattr(component, "example", None)
    if isinstance(declared, Mapping):
        return dict(declared)
    for parameters in _guesses(component):
        shape = _shape(key, parameters)
        if shape is None:
            continue
        low, high = (np.asarray(corner, dtype=float) for corner in shape.bounds)
        place = place_field(component)
        if place is not None:
            moved = np.asarray(parameters[place]) - (low + high) / 2
            moved[2] += (high[2] - low[2]) / 2 + clearance * float(np.max(high - low))
            parameters[place] = tuple(float(value) for value in moved)
            shape = _shape(key, parameters)
        if shape is not None and shape.bounds[0][2] >= 0 and point_inside(shape) is not None:
            return parameters
    raise ValueError(
        f"shape {key!r} must be buildable from lengths (got none that it accepts); give its class an attribute "
        "example, a mapping of its parameters"
    )


def _shape(key: str, parameters: Mapping[str, Any]) -> Any:
    try:
        return make(key, kind="inclusion-shape", **parameters)
    except EigencontactError:
        return None


def _guesses(component: type) -> Iterator[dict[str, Any]]:
    """Parameters to try, in a fixed order."""
    hints, place = get_type_hints(component), place_field(component)
    counts: dict[str, int] = {}  # 0: a number, n: that many numbers
    for item in fields(component):
        hint = hints.get(item.name)
        types = get_args(hint) if get_origin(hint) is tuple else ()
        has_default = item.default is not MISSING or item.default_factory is not MISSING
        if item.name == place or has_default:
            continue
        if hint is float:
            counts[item.name] = 0
        elif types and all(kind is float for kind in types):
            counts[item.name] = len(types)
        else:
            return
    numbers = sum(max(1, count) for count in counts.values())
    if numbers > len(_LENGTHS):
        return
    for scale in _SCALES:
        for order in permutations(_LENGTHS[: max(numbers, 3)], numbers):
            values, parameters = iter(order), {}
            for name, count in counts.items():
                lengths = tuple(scale * next(values) for _ in range(max(1, count)))
                parameters[name] = lengths if count else lengths[0]
            if place is not None:
                parameters[place] = (0.0, 0.0, 10.0 * scale)
            yield parameters


def evenly(count: int) -> FloatArray:
    """Evenly spread points of the unit cube ``(count, 3)``, always the same ones."""
    return np.asarray((np.arange(1, count + 1)[:, None] / _GOLDEN ** np.arange(1, 4) + 0.5) % 1.0)


def _samples(shape: Any, count: int = 4096) -> FloatArray:
    """Evenly spread points of the bounds ``(count, 3)``, always the same ones."""
    low, high = (np.asarray(corner, dtype=float) for corner in shape.bounds)
    return np.asarray(low + (high - low) * evenly(count))


def point_inside(shape: Any) -> tuple[float, float, float] | None:
    """A point well inside a shape, at positive x and y where there is one; None if the shape contains nothing."""
    points = _samples(shape)
    points = points[np.asarray(shape.contains(*points.T))]
    if not len(points):
        return None
    middle = np.mean(np.asarray(shape.bounds, dtype=float), axis=0)
    quadrant = points[np.all(points[:, :2] > middle[:2], axis=1)]
    chosen = quadrant if len(quadrant) else points
    size = float(np.max(np.subtract(shape.bounds[1], shape.bounds[0])))
    steps = np.array([(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)], dtype=float)
    clearance = np.zeros(len(chosen))
    for radius in size * np.linspace(0.02, 0.5, 25):
        probes = chosen[:, None, :] + radius * steps
        inside = np.all(np.asarray(shape.contains(*np.moveaxis(probes, -1, 0))), axis=1)
        clearance[inside & (clearance >= radius - 0.0201 * size)] = radius
    x, y, z = chosen[int(np.argmax(clearance))].tolist()
    return x, y, z


def is_mirrored(shape: Any, axis: int) -> bool:
    """Whether a shape is its own mirror image in the plane x = 0 or y = 0 (axis 0 or 1)."""
    points = _samples(shape)
    points[:, axis] += 1e-9 * float(np.max(np.abs(shape.bounds)))  # off the plane itself
    mirrored = points.copy()
    mirrored[:, axis] *= -1
    equal = np.asarray(shape.contains(*points.T)) == np.asarray(shape.contains(*mirrored.T))
    low, high = shape.bounds
    size = max(b - a for a, b in zip(low, high, strict=True))
    return bool(np.mean(equal) > 0.999) and abs(low[axis] + high[axis]) < 1e-9 * size


def is_revolved(shape: Any) -> bool:
    """Whether a shape is one of revolution about the axis z through the origin."""
    if not (is_mirrored(shape, 0) and is_mirrored(shape, 1)):
        return False
    points = _samples(shape)
    inside = np.asarray(shape.contains(*points.T))
    for angle in (0.3, 0.7854, 1.1, 1.9):
        cosine, sine = np.cos(angle), np.sin(angle)
        x, y = cosine * points[:, 0] - sine * points[:, 1], sine * points[:, 0] + cosine * points[:, 1]
        if np.mean(np.asarray(shape.contains(x, y, points[:, 2])) == inside) < 0.999:
            return False
    return True


def symmetries_of(shape: Any) -> dict[str, Any]:
    """Arguments of `inclusion_case` that follow from a shape alone: point inside, symmetry of revolution, planes."""
    return {
        "revolved": is_revolved(shape),
        "mirrored": (is_mirrored(shape, 0), is_mirrored(shape, 1)),
        "anchor": point_inside(shape),
    }


def text_digest(component: Any) -> str:
    """Hash of the text of the module of a class: a stored solution serves no other text."""
    module = inspect.getmodule(component)
    try:
        text = inspect.getsource(module if module is not None else component)
    except (OSError, TypeError):
        text = repr(component)
    return hashlib.sha256(text.encode()).hexdigest()
