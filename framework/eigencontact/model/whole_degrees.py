"""Degree of each whole inhomogeneity: prescribed by the scene, or chosen by the predicted error."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.material import Material
from eigencontact.errors import SceneError
from eigencontact.model.sources import Inhomogeneity
from eigencontact.scene.whole import HIGHEST_DEGREE, Whole
from eigencontact.solvers.inclusion_reach import contrast_of, degree_for, reflection, stated_error

__all__ = ["LEAST_DEGREE", "WholeDegree", "degrees_of", "functions_up_to"]

#: Least degree that ``"auto"`` takes: differences of lower ones foretell nothing.
LEAST_DEGREE = 3
#: Radii between which neighbours count as near.
_NEAR = 6.0


@dataclass(frozen=True, kw_only=True, slots=True)
class WholeDegree:
    """Degree of one inhomogeneity.

    Attributes
    ----------
    degree : int
    quality : float
        Factor by which its error falls per degree.
    error : float
        Error foretold for the degree, in parts of the load.
    """

    degree: int
    quality: float
    error: float


def functions_up_to(degree: int) -> int:
    """Equilibrated fields up to a degree: unknowns of one inhomogeneity."""
    return 3 * (degree + 1) * (degree + 3) - 3


def degrees_of(
    sources: Sequence[Inhomogeneity], whole: Whole, matrix: Material, *, surface: bool = True
) -> list[WholeDegree]:
    """Degree of each inhomogeneity of a body.

    Raises
    ------
    SceneError
        Inclusions so close to each other or to the surface that the degree misses the error that the scene allows.
    """
    bounds = np.array([source.shape.bounds for source in sources], dtype=float)
    centers, halves = bounds.mean(axis=1), 0.5 * (bounds[:, 1] - bounds[:, 0])
    radii = halves.max(axis=1)
    contrasts = [_contrast(source, matrix) for source in sources]
    degrees = []
    for number, source in enumerate(sources):
        quality, neighbour_number = _closest(number, centers, halves, radii, surface=surface)
        needed = degree_for(contrasts[number], quality, whole.allowed)
        degree = max(LEAST_DEGREE, min(needed, HIGHEST_DEGREE)) if whole.whole == "auto" else whole.whole
        error = stated_error(contrasts[number], quality, degree)
        if degree < needed and whole.is_asked:
            neighbour = "the surface" if neighbour_number is None else repr(sources[neighbour_number].name)
            raise SceneError(
                f"{source.where} ({source.name!r}) must be farther from {neighbour} for numerics.inclusion-resolution "
                f"with error = {whole.allowed:g} (got an error of {error:.2g} with degree {degree}; the error falls by "
                f"a factor {quality:.2f} per degree); allow this error, "
                + ("set a higher degree, " if degree < HIGHEST_DEGREE else "")
                + 'move the region, or set "cells"'
            )
        degrees.append(WholeDegree(degree=degree, quality=quality, error=error))
    return degrees


def _closest(
    number: int, centers: FloatArray, halves: FloatArray, radii: FloatArray, *, surface: bool
) -> tuple[float, int | None]:
    """Strongest interaction of an inclusion, and the neighbour that causes it; None for the surface."""
    best, neighbour = 0.0, None
    if surface:
        best = reflection(2.0 * centers[number, 2], halves[number, 2], halves[number, 2])
    gaps = np.linalg.norm(centers - centers[number], axis=1)
    for index in np.flatnonzero(gaps < _NEAR * (radii + radii[number])):
        if index != number:
            quality = reflection(float(gaps[index]), float(radii[number]), float(radii[index]))
            if quality > best:
                best, neighbour = quality, int(index)
    return best, neighbour


def _contrast(source: Inhomogeneity, matrix: Material) -> float:
    law = source.uniform_law
    return 1.0 if law is None else contrast_of(law, matrix)
