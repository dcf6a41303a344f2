"""Features and their corners of the parameter space, each with an error against a reference and its bound."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

__all__ = ["Corner", "Feature", "family", "refusal"]


@dataclass(frozen=True, kw_only=True)
class Corner:
    """One point of the parameter space."""

    name: str  #: the parameter and its value: ``"ν = 1/2"``
    #: Computes the answer there and returns its largest error against the reference, relative to the answer's size [-].
    error: Callable[[], float]
    bound: float  #: largest error that holds
    reason: str  #: origin of the bound
    quick: bool = False  #: whether the quick campaign has it; such a corner takes a tenth of a second or so
    refused: str = ""  #: words of the refusal that is the right answer there; empty where an answer is due


def family(
    name: str, error: Callable[..., float], values: Iterable[Any] | Mapping[Any, Any], *,
    bound: float | Callable[..., float], reason: str, quick: bool | Collection[Any] = (),
) -> list[Corner]:  # fmt: skip
    """Corners of one error at several values.

    Parameters
    ----------
    name : str
        Format of the names.
    error : callable
        Error of the values; see `Corner`.
    values : iterable or mapping
        Arguments of `error`, a tuple or a single one; a mapping has them by the values of the name.
    bound : float or callable
        Bound of all, or bound of the arguments.
    reason : str
        See `Corner`.
    quick : bool or collection
        Whether all are quick, or the arguments of those that are.
    """
    pairs = values.items() if isinstance(values, Mapping) else ((value, value) for value in values)
    corners = []
    for label, argument in pairs:
        several = argument if isinstance(argument, tuple) else (argument,)
        corners.append(
            Corner(
                name=name.format(*(label if isinstance(label, tuple) else (label,))),
                error=partial(error, *several),
                bound=bound(*several) if callable(bound) else bound,
                reason=reason,
                quick=quick if isinstance(quick, bool) else argument in quick,
            )
        )
    return corners


def refusal(name: str, call: Callable[[], object], words: str, *, quick: bool = False) -> Corner:
    """Corner whose right answer is one clear message that holds these words."""

    def error() -> float:
        call()
        return 0.0

    reason = "one message that names field, rule and value, or what did not converge and a remedy"
    return Corner(name=name, error=error, bound=0.0, reason=reason, quick=quick, refused=words)


@dataclass(frozen=True, kw_only=True)
class Feature:
    """Corners of one kind."""

    key: str  #: name on the command line
    title: str  #: the parameters
    reference: str  #: closed forms, methods or invariants that the answers are compared with
    corners: tuple[Corner, ...]
