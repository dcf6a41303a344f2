"""Exceptions of the package, and the text of messages about refused values.

Every message follows the pattern ``<where> must be <rule> (got <value>); <what to do>``.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from difflib import get_close_matches
from typing import Any

__all__ = [
    "ClusterError",
    "DomainTooSmall",
    "EigencontactError",
    "NotConverged",
    "NotUnique",
    "PlanError",
    "PluginError",
    "ResultsError",
    "SceneError",
    "nearest",
    "require",
    "shown",
]


class EigencontactError(Exception):
    """Base of all errors of this package; ``exit_code`` is the exit code of the command line.

    Examples
    --------
    >>> import eigencontact as ec
    >>> try:
    ...     ec.HalfSpace(210e9, 0.7)
    ... except ec.EigencontactError as problem:
    ...     print(problem)
    HalfSpace.poisson_ratio must be in (-1, 0.5] [-] (got 0.7)
    """

    exit_code = 1


class SceneError(EigencontactError):
    """A scene, an argument or an option that cannot be accepted."""

    exit_code = 2


class PluginError(EigencontactError):
    """Plugin that is missing, defective or registered incorrectly."""

    exit_code = 2


class PlanError(EigencontactError):
    """An output that nothing provides, or that two blocks provide."""

    exit_code = 2


class DomainTooSmall(EigencontactError):
    """Contact that reaches the edge of the computed window.

    Attributes
    ----------
    sides : sequence of str
        Directions in which it does: ``"x"``, ``"y"``.
    step : object
        Load step of a run, `eigencontact.execution.blocks.step.Step`, in which it did.
    """

    exit_code = 4

    def __init__(self, message: str, sides: Sequence[str] = ()) -> None:
        super().__init__(message)
        self.sides = sides
        self.step: Any = None


class ResultsError(EigencontactError):
    """A folder that cannot be written or stored results that cannot be read."""

    exit_code = 5


class ClusterError(EigencontactError):
    """Cluster without connection, or whose workers cannot perform the tasks."""

    exit_code = 6


class NotConverged(EigencontactError):
    """Solver that did not reach its tolerance.

    Attributes
    ----------
    report : object
        The solver's report: its certificate at the last iteration and the history of its residual.

    Examples
    --------
    >>> import eigencontact as ec
    >>> hasty = ec.load_scene("hertz", ["stress=[]", "numerics.max-iterations=1", "grid.cells-per-contact-radius=16"])
    >>> try:
    ...     ec.run(hasty)
    ... except ec.NotConverged as problem:
    ...     print(problem.report is not None)
    True
    """

    exit_code = 3

    def __init__(self, message: str, report: Any = None) -> None:
        super().__init__(message)
        self.report = report


class NotUnique(NotConverged):
    """Softening material without a unique solution at some points.

    Attributes
    ----------
    points : sequence of int
        Numbers of those points in the question.
    """

    def __init__(self, message: str, points: Sequence[int] = ()) -> None:
        super().__init__(message)
        self.points = points


def require(condition: object, where: str, field: str, value: object, rule: str) -> None:
    """Refuse a value of a component or scene unless `condition` holds.

    Parameters
    ----------
    condition : bool
        What must be true. NaN compares false, so ``value > 0`` refuses NaN too.
    where, field : str
        The table (a plugin's key, a scene table) and its field; named in the message.
    value : object
        The value that was given.
    rule : str
        The rule in words, with the unit: ``"positive [m]"``.

    Raises
    ------
    SceneError
        ``<where>.<field> must be <rule> (got <value>)``.

    Examples
    --------
    >>> require(-1.0 > 0, "sphere", "radius", -1.0, "positive [m]")
    Traceback (most recent call last):
    eigencontact.errors.SceneError: sphere.radius must be positive [m] (got -1.0)
    """
    if not condition:
        raise SceneError(f"{where}.{field} must be {rule} (got {shown(value)})")


#: More characters of a refused value than this are left out of a message.
_LONGEST = 160


def shown(value: object) -> str:
    """Value as text for a message: numpy scalars as numbers, long values shortened.

    Examples
    --------
    >>> shown(2.0), shown("[" * 1000)[-22:]
    ('2.0', '[[[... 1002 characters')
    """
    text = repr(value.item() if hasattr(value, "item") and getattr(value, "ndim", 1) == 0 else value)
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}... {len(text)} characters"


def nearest(name: str, choices: Iterable[str]) -> str:
    """Return ``; did you mean 'x'?`` for the nearest known name, or nothing."""
    match = get_close_matches(name, list(choices), n=1, cutoff=0.5)
    return f"; did you mean {match[0]!r}?" if match else ""
