"""Closed forms and integral equations that a study may draw beside its curves; code, since they are no data."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from eigencontact_verification.oracles.coated_contact import CoatedContact

__all__ = ["CLOSED_FORMS"]


def _stick_ratio(friction_over_beta: Any) -> Any:
    from eigencontact_verification.oracles.spence import stick_ratio

    values = np.array([stick_ratio(float(value)) for value in np.ravel(friction_over_beta)])
    return values if np.ndim(friction_over_beta) else float(values[0])


@cache
def _coated(load: float, sphere: float, thickness: float, ratio: float, young: float, nu: float) -> CoatedContact:
    from eigencontact_verification.oracles.coated_contact import coated_contact

    return coated_contact(load, sphere, [(thickness, ratio * young, nu)], (young, nu))


def _coated_numbers(read: Callable[[CoatedContact], float], *problem: Any) -> Any:
    """Number of the solution; of several, where one of its arguments has several values."""
    several = np.broadcast_arrays(*(np.asarray(argument, dtype=float) for argument in problem))
    numbers = np.array([read(_coated(*map(float, argument))) for argument in zip(*map(np.ravel, several), strict=True)])
    return numbers if several[0].ndim else float(numbers[0])


@cache
def _sliding(friction: float, depth: float, *problem: float) -> Any:
    from eigencontact_verification.oracles.coated_stress import sliding_stress

    return np.asarray(sliding_stress(_coated(*problem), 0.0, 0.0, depth, friction=friction))


def _coated_stress(component: float, friction: float, depth: Any, *problem: Any) -> Any:
    key = tuple(map(float, problem))
    values = [_sliding(float(friction), float(z), *key)[int(component)] for z in np.ravel(depth)]
    return np.array(values) if np.ndim(depth) else values[0]


_PROBLEM = "(…, load, sphere radius, thickness, E₁/E₂, E₂, ν) by an integral equation"
_STRESS = "(component, friction, depth, load, sphere radius, thickness, E₁/E₂, E₂, ν) on the axis, by Hankel integrals"

#: Function of a formula, and what it gives.
CLOSED_FORMS: dict[str, tuple[Callable[..., Any], str]] = {
    "spence": (_stick_ratio, "stick radius over contact radius of a sphere pressed with friction, by μ/β (Spence)"),
    "coated_pressure": (
        lambda *problem: _coated_numbers(lambda solution: solution.max_pressure, *problem),
        f"largest pressure{_PROBLEM}",
    ),
    "coated_radius": (
        lambda *problem: _coated_numbers(lambda solution: solution.radius, *problem), f"contact radius{_PROBLEM}",
    ),
    "coated_approach": (
        lambda *problem: _coated_numbers(lambda solution: solution.approach, *problem), f"approach{_PROBLEM}",
    ),
    "coated_profile": (
        lambda r, *problem: _coated(*map(float, problem)).pressure(np.asarray(r, dtype=float)),
        f"pressure at radii r{_PROBLEM}",
    ),
    "coated_stress": (_coated_stress, f"tensor component 0 to 5 of the stress{_STRESS}"),
}  # fmt: skip
