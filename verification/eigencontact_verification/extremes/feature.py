"""What a feature declares: corners of the parameter space, each with an error against a reference and its bound."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

__all__ = ["Corner", "Feature", "refusal"]


@dataclass(frozen=True, kw_only=True)
class Corner:
    """One point of the parameter space.

    Parameters
    ----------
    name : str
        The parameter and its value: ``"ν = 1/2"``.
    error : callable
        Computes the answer there and its largest error against the reference, as a part of the answer's own size [-].
    bound : float
        Largest error that is right.
    reason : str
        Why the bound is what it is.
    quick : bool
        Whether the quick campaign has it; such a corner takes a tenth of a second or so.
    refused : str
        Words of the refusal that is the right answer there; empty where an answer is due.
    """

    name: str
    error: Callable[[], float]
    bound: float
    reason: str
    quick: bool = False
    refused: str = ""


def refusal(name: str, call: Callable[[], object], words: str, *, quick: bool = False) -> Corner:
    """Corner whose right answer is one clear message that holds these words."""

    def error() -> float:
        call()
        return 0.0

    reason = "one message that names field, rule and value, or what did not converge and a remedy"
    return Corner(name=name, error=error, bound=0.0, reason=reason, quick=quick, refused=words)


@dataclass(frozen=True, kw_only=True)
class Feature:
    """Corners of one kind.

    Parameters
    ----------
    key : str
        Name on the command line.
    title : str
        What is taken to its extremes.
    reference : str
        What the answers are compared with, in a sentence.
    corners : tuple of Corner
    """

    key: str
    title: str
    reference: str
    corners: tuple[Corner, ...]
