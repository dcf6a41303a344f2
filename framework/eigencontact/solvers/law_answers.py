"""Responses of constitutive laws for the solvers; invalid responses are refused with the name of the law."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.array_types import FloatArray
from eigencontact.core.arrays import real_answer
from eigencontact.errors import NotConverged, PluginError

__all__ = ["Answer", "AnsweringLaw", "Law", "answer_of", "cell_answer_of", "place_of", "refuse"]

#: Strain beyond which the program attributes non-finite numbers to the iteration, not to the law.
_FAR = 1.0


class Law(Protocol):
    """Constitutive law in the form of the solvers; see `eigencontact.plugin.ConstitutiveLaw`."""

    @property
    def key(self) -> Any:
        """Name in messages."""

    @property
    def advice(self) -> str:
        """Advice to the user where the law softens."""

    @property
    def variables(self) -> Any:
        """Mapping of the names of the internal variables to objects with ``components``."""

    def update(self, strain: FloatArray, before: Mapping[str, FloatArray], step: Any) -> Any:
        """Stress, tangent and new variables."""


@runtime_checkable
class AnsweringLaw(Protocol):
    """Law with a response for whole cells; see `eigencontact.plugin.HasCellAnswer`."""

    def cell_answer(
        self, foreign: FloatArray, prestrain: FloatArray, around: Any, before: Mapping[str, FloatArray], step: Any
    ) -> tuple[FloatArray, Mapping[str, FloatArray]]:
        """Eigenstrain of the cells, and new variables."""


@dataclass(frozen=True, slots=True, eq=False)
class Answer:
    """Response of a law at n points.

    Attributes
    ----------
    stress : (6, n)
        [Pa].
    tangent : (n, 6, 6)
        [Pa].
    variables : mapping of str to (components, n)
        New variables of the points.
    finite : (n,) of bool
        Whether all numbers of a point are finite.
    """

    stress: FloatArray
    tangent: FloatArray
    variables: dict[str, FloatArray]
    finite: NDArray[np.bool_]


def answer_of(law: Law, strain: FloatArray, before: Mapping[str, FloatArray], step: Any) -> Answer:
    """Call a law and check its response.

    Raises
    ------
    PluginError
        The law fails, or returns other shapes, other variables or no numbers.
    """
    where, count = _name_of(law), strain.shape[1]
    response = law.update(strain, before, step)
    with _of_its_form(where):
        stress, tangent = (_numbers(getattr(response, name), where, name) for name in ("stress", "tangent"))
        returned = dict(response.variables)
    _formed(stress, [(6, count)], where, "stress")
    _formed(tangent, [(6, 6, count), (6, 6)], where, "tangent")
    variables = _declared(law, returned, count)
    by_point = np.broadcast_to(tangent, (count, 6, 6)) if tangent.ndim == 2 else np.moveaxis(tangent, 2, 0)
    finite: NDArray[np.bool_] = np.asarray(np.isfinite(stress).all(axis=0) & np.isfinite(tangent).all(axis=(0, 1)))
    for values in variables.values():
        finite &= np.isfinite(values).all(axis=0)
    return Answer(stress, by_point, variables, finite)


def cell_answer_of(
    law: Any, foreign: FloatArray, prestrain: FloatArray, around: Any, before: Mapping[str, FloatArray], step: Any
) -> tuple[FloatArray, dict[str, FloatArray]]:
    """Call an `AnsweringLaw` for the eigenstrain of its cells, and their internal variables.

    Raises
    ------
    PluginError
        The law fails, or returns other shapes, other variables or non-finite numbers.
    """
    where, count = _name_of(law), foreign.shape[1]
    response = law.cell_answer(foreign, prestrain, around, before, step)
    with _of_its_form(where):
        strain_returned, returned = response
        eigenstrain, returned = _numbers(strain_returned, where, "eigenstrain"), dict(returned)
    _formed(eigenstrain, [(6, count)], where, "eigenstrain")
    variables = _declared(law, returned, count)
    fresh = [eigenstrain, *(values for name, values in variables.items() if values is not before[name])]
    with np.errstate(invalid="ignore", over="ignore"):
        total = sum(float(values.sum()) for values in fresh)
    # A finite sum shows that all terms are finite.
    if not np.isfinite(total) and not (finite := np.isfinite(np.concatenate(fresh)).all(axis=0)).all():
        first = int(np.argmin(finite))
        raise PluginError(f"{where} must answer with finite numbers (got others {place_of(first, step)})")
    return eigenstrain, variables


def refuse(law: Law, strain: FloatArray, answer: Answer, step: Any) -> None:
    """Refuse a result that is not finite at some point.

    Raises
    ------
    PluginError
        The strain is in the range in which a law must respond.
    NotConverged
        The strain is outside this range: the caller's iteration has diverged.
    """
    if answer.finite.all():
        return
    bad = np.flatnonzero(~answer.finite)
    sizes = np.linalg.norm(strain[:, bad], axis=0)
    worst = int(bad[np.argmin(np.where(np.isfinite(sizes), sizes, np.inf))])
    message = (
        f"constitutive law {law.key!r} must answer with finite numbers (got others {place_of(worst, step)}, and at"
    )
    message += f" {bad.size} of {strain.shape[1]} points"
    if not np.linalg.norm(strain[:, worst]) <= _FAR:
        raise NotConverged(f"{message}, at strains beyond {_FAR:g}); take smaller load steps")
    raise PluginError(f"{message}, at a strain of {np.array2string(strain[:, worst], precision=4)})")


def place_of(point: int, step: Any) -> str:
    """Description of the position of a point."""
    x, y, z = (float(axis[point]) for axis in (step.x, step.y, step.z))
    return f"at x = {x:.6g} m, y = {y:.6g} m, z = {z:.6g} m"


def _name_of(law: Any) -> str:
    return f"constitutive law {law.key!r}"


@contextmanager
def _of_its_form(where: str) -> Iterator[None]:
    """Report the law whose result has an invalid form."""
    try:
        yield
    except (AttributeError, TypeError, ValueError) as problem:
        raise PluginError(f"{where} failed with {type(problem).__name__}: {problem}") from problem


def _declared(law: Any, returned: dict[str, Any], count: int) -> dict[str, FloatArray]:
    """Variables returned by a law, in their declared form."""
    where = _name_of(law)
    if set(returned) != set(law.variables):
        raise PluginError(
            f"{where} must return the variables that it declares, {sorted(law.variables)} (got {sorted(returned)})"
        )
    variables = {name: _numbers(values, where, f"variable {name!r}") for name, values in returned.items()}
    for name, values in variables.items():
        _formed(values, [(law.variables[name].components, count)], where, f"variable {name!r}")
    return variables


def _numbers(values: Any, where: str, quantity: str) -> FloatArray:
    return real_answer(values, f"{quantity} of {where}")


def _formed(values: FloatArray, shapes: list[tuple[int, ...]], where: str, quantity: str) -> None:
    if values.shape not in shapes:
        rule = " or ".join(map(str, shapes))
        raise PluginError(f"{quantity} of {where} must be of shape {rule} (got shape {values.shape})")
