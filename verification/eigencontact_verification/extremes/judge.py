"""Corners computed and judged: within the bound, refused where that is right, or a fault."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import isfinite
from time import perf_counter

from eigencontact.errors import EigencontactError
from eigencontact_verification.extremes.feature import Corner, Feature

__all__ = ["CornerVerdict", "FeatureVerdict", "Verdict", "judge", "run"]

# A refusal longer than this is no clear message [characters].
_LONGEST = 400


@dataclass(frozen=True, kw_only=True)
class CornerVerdict:
    """Verdict on one corner."""

    corner: Corner
    word: str  #: "holds", "refused" or "fails"
    error: float | None  #: largest error; None where there was no answer
    message: str  #: text of a refusal, or reason of a failure
    seconds: float  #: wall time [s]


@dataclass(frozen=True, kw_only=True)
class FeatureVerdict:
    """Verdicts on the corners of one feature."""

    feature: Feature
    corners: tuple[CornerVerdict, ...]

    @property
    def word(self) -> str:
        """``"fails"`` where any corner does."""
        return "fails" if any(corner.word == "fails" for corner in self.corners) else "holds"

    @property
    def worst(self) -> CornerVerdict | None:
        """Corner whose error is the largest part of its bound; None where no corner answered."""
        answered = [corner for corner in self.corners if corner.error is not None and not corner.corner.refused]
        return max(answered, key=_share, default=None)

    @property
    def seconds(self) -> float:
        """Wall time."""
        return sum(corner.seconds for corner in self.corners)


def _share(corner: CornerVerdict) -> float:
    error = float("inf") if corner.error is None or not isfinite(corner.error) else corner.error
    return error / corner.corner.bound


def judge(corner: Corner) -> CornerVerdict:
    """Compute one corner.

    Any exception that is not one of eigencontact's own is a fault, and so is a refusal that was not declared, a message
    of several lines, an answer where a refusal was, and an error that is not finite.
    """
    began = perf_counter()
    error: float | None = None
    try:
        error = float(corner.error())
    except EigencontactError as problem:
        word, message = _refused(corner, str(problem))
    except Exception as problem:  # noqa: BLE001 - whatever breaks at a corner is what the campaign looks for
        word, message = "fails", f"{type(problem).__name__}: {problem}"
    else:
        word, message = _answered(corner, error)
    return CornerVerdict(corner=corner, word=word, error=error, message=message, seconds=perf_counter() - began)


def _refused(corner: Corner, message: str) -> tuple[str, str]:
    if not corner.refused:
        return "fails", f"refused where an answer is due: {message}"
    if corner.refused not in message:
        return "fails", f"refused, but without the words {corner.refused!r}: {message}"
    if len(message.splitlines()) != 1 or len(message) > _LONGEST:
        return "fails", f"refused by more than one short sentence: {message}"
    return "refused", message


def _answered(corner: Corner, error: float) -> tuple[str, str]:
    if corner.refused:
        return "fails", f"answered where a refusal that says {corner.refused!r} is due"
    if not isfinite(error):
        return "fails", "the error is not a finite number"
    if error > corner.bound:
        return "fails", f"off by {error:.2g}, more than {corner.bound:.2g}"
    return "holds", ""


#: A feature with the verdict on one of its corners, or on all of them.
Verdict = tuple[Feature, CornerVerdict | FeatureVerdict]


def run(features: Sequence[Feature], *, quick: bool = False) -> Iterator[Verdict]:
    """Judge all corners, or only quick ones; yields each verdict, and each feature after its corners.

    A feature without quick corners is left out of the quick run.
    """
    for feature in features:
        corners = [corner for corner in feature.corners if corner.quick or not quick]
        if not corners:
            continue
        verdicts = []
        for corner in corners:
            verdicts.append(judge(corner))
            yield feature, verdicts[-1]
        yield feature, FeatureVerdict(feature=feature, corners=tuple(verdicts))
