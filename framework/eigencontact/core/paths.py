"""Paths of symmetric tensors over a cycle: smallest balls, shear and normal components on planes, the worst plane.

An amplitude here is half of a range, and of a path that is no line the radius of the smallest circle or ball around
it. The longest chord, halved, is too small: 0.866 of it for three corners of a triangle.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from eigencontact.core.array_types import FloatArray, IntArray
from eigencontact.core.tensors import from_mandel

__all__ = ["PathBounds", "PlanePaths", "half_sphere", "smallest_balls", "worst_planes"]

#: Angle between neighbours of the first sweep, and where the search ends [rad].
_COARSE, _FINE = np.radians(11.0), np.radians(0.04)
#: Searches start from so many of the best planes of the sweep, at least so far apart [rad].
_STARTS, _APART = 3, np.radians(12.0)
#: Search steps at most.
_MOST = 40
#: Values with this relative difference are the same.
_EQUALITY_TOLERANCE = 1e-12


def smallest_balls(paths: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Smallest balls around paths, exact to round-off.

    Parameters
    ----------
    paths : (steps, d, points)
        Points of a space of d dimensions, in any order. For Mandel vectors the distance is the Frobenius norm.

    Returns
    -------
    centres : (d, points)
    radii : (points,)

    Examples
    --------
    >>> centres, radii = smallest_balls(np.array([[[0.0], [0.0]], [[2.0], [0.0]], [[1.0], [1.0]]]))
    >>> centres[:, 0].tolist(), radii.tolist()
    ([1.0, 0.0], [1.0])
    """
    from eigencontact.core.path_loops import balls

    of_points = np.ascontiguousarray(np.moveaxis(np.asarray(paths, dtype=float), -1, 0))
    centres, radii = np.empty((len(of_points), of_points.shape[2])), np.empty(len(of_points))
    balls(of_points, centres, radii)
    return np.ascontiguousarray(centres.T), radii


class PlanePaths:
    """Components of paths of tensors on material planes.

    Parameters
    ----------
    tensors : (steps, 6, points)
        Mandel vectors, of stress or of strain.

    Notes
    -----
    Normals are ``(planes, 3)``, or ``(points, planes, 3)`` where each point has its own. Answers are
    ``(points, planes)``, NaN at points whose first normal is NaN: a search leaves out what it has found. Shear of
    strain is the tensor component, half of the engineering shear.

    Examples
    --------
    >>> torsion = np.zeros((2, 6, 1))
    >>> torsion[:, 5, 0] = np.sqrt(2.0), -np.sqrt(2.0)  # Mandel: the shear stress is 1 and -1
    >>> planes = PlanePaths(torsion)
    >>> planes.shear_amplitude(np.array([[1.0, 0.0, 0.0]])).tolist()
    [[1.0]]
    >>> planes.normal_maximum(np.array([[1.0, 1.0, 0.0]]) / np.sqrt(2.0)).round(12).tolist()
    [[1.0]]
    """

    def __init__(self, tensors: FloatArray) -> None:
        plain = from_mandel(np.moveaxis(np.asarray(tensors, dtype=float), 1, 0))
        self._paths = np.ascontiguousarray(plain[:, _scattered(plain.shape[1])].transpose(2, 0, 1))

    @property
    def points(self) -> int:
        """Number of points."""
        return len(self._paths)

    def shear_amplitude(self, normals: FloatArray) -> FloatArray:
        """Radius of the smallest circle around the path of the shear on each plane ``(points, planes)``."""
        from eigencontact.core.path_loops import shear_radii

        at = _of_points(normals)
        out = np.empty((self.points, at.shape[1]))
        shear_radii(self._paths, at, out)
        return out

    def normal_maximum(self, normals: FloatArray) -> FloatArray:
        """Largest normal component on each plane ``(points, planes)``."""
        return self._extremes(normals)[0]

    def normal_amplitude(self, normals: FloatArray) -> FloatArray:
        """Half of the range of the normal component on each plane ``(points, planes)``."""
        largest, smallest = self._extremes(normals)
        return 0.5 * (largest - smallest)

    def _extremes(self, normals: FloatArray) -> tuple[FloatArray, FloatArray]:
        from eigencontact.core.path_loops import normal_extremes

        at = _of_points(normals)
        largest, smallest = np.empty((self.points, at.shape[1])), np.empty((self.points, at.shape[1]))
        normal_extremes(self._paths, at, largest, smallest)
        return largest, smallest


class PathBounds:
    """Upper bounds of the components of paths of tensors, over all planes, without a search for planes.

    Parameters
    ----------
    tensors : (steps, 6, points)
        Mandel vectors, of stress or of strain.

    Notes
    -----
    With c the centre of the box around a path, the shear of every tensor on a plane lies in a circle around the shear
    of c whose radius is the largest shear of the difference: the bound of the shear amplitude is exact for a path that
    is a line. The bound of the normal maximum, the largest principal stress, is always exact. Of more than 1024 points
    both follow from J2, without eigenvalues, and are up to 15 % of the root of J2 larger.

    Examples
    --------
    >>> torsion = np.zeros((2, 6, 1))
    >>> torsion[:, 5, 0] = np.sqrt(2.0), -np.sqrt(2.0)  # Mandel: the shear stress is 1 and -1
    >>> bounds = PathBounds(torsion)
    >>> bounds.shear_amplitude().round(6).tolist(), bounds.normal_maximum().round(6).tolist()
    ([1.0], [1.0])
    """

    def __init__(self, tensors: FloatArray) -> None:
        self._tensors = np.asarray(tensors, dtype=float)

    def shear_amplitude(self) -> FloatArray:
        """At least `PlanePaths.shear_amplitude` on every plane, and the largest shear amplitude in one direction."""
        return self._bounds("SHEAR")

    def normal_maximum(self) -> FloatArray:
        """At least `PlanePaths.normal_maximum` on every plane: the largest principal value."""
        return self._bounds("NORMAL")

    def normal_amplitude(self) -> FloatArray:
        """At least `PlanePaths.normal_amplitude` on every plane."""
        return self._bounds("SIZE")

    def deviator_radius(self) -> FloatArray:
        """At least the radius of the smallest ball around the deviator, in the Frobenius norm."""
        return self._bounds("RADIUS")

    def deviator_widths(self) -> FloatArray:
        """Sum of the half widths of the path of the deviator along orthogonal directions, chosen along long chords.

        It is at least sqrt(10) times the root mean square of the half width along `m n`, over all directions m of all
        planes n: half widths along one direction of parts of the path add up, and so do their norms.
        """
        return self._bounds("WIDTHS")

    def _bounds(self, kind: str) -> FloatArray:
        from eigencontact.core import path_bound_loops

        out = np.empty(self._tensors.shape[2])
        path_bound_loops.bounds(self._tensors, getattr(path_bound_loops, kind), out)
        return out


def worst_planes(value: Callable[[FloatArray], FloatArray]) -> tuple[FloatArray, FloatArray]:
    """Largest value over all planes, and the plane.

    Parameters
    ----------
    value : callable
        Values ``(points, planes)`` on planes of normals ``(planes, 3)`` or ``(points, planes, 3)``; NaN in, NaN out.

    Returns
    -------
    largest : (points,)
    normals : (points, 3)
        Unit normals, z positive; where several planes are alike, one of them.

    Notes
    -----
    A sweep over the half sphere at 11 degrees, then from its three best planes that lie apart six neighbours at once,
    closer and closer, down to 0.04 degrees. Of 1500 random paths of 24 steps the worst was 4e-4 below a sweep at 1.5
    degrees, and four more than 5e-5.

    Examples
    --------
    >>> largest, normals = worst_planes(lambda at: np.atleast_3d(at)[..., 0] + 0.0 if at.ndim == 3 else at[None, :, 0])
    >>> largest.round(6).tolist()
    [1.0]
    """
    sweep = half_sphere(_COARSE)
    near = np.abs(sweep @ sweep.T) > np.cos(_APART)
    values = np.array(value(sweep))
    rows = np.arange(len(values))
    largest, normals = np.full(len(values), -np.inf), np.tile(sweep[0], (len(values), 1))
    for _ in range(_STARTS):
        start = values.argmax(axis=1)
        refined, at = _refined(value, values[rows, start], sweep[start])
        better = refined > largest
        largest, normals = np.where(better, refined, largest), np.where(better[:, None], at, normals)
        values[near[start]] = -np.inf
    return largest, normals * np.where(normals[:, 2:] < 0, -1.0, 1.0)


def half_sphere(angle: float) -> FloatArray:
    """Unit normals ``(n, 3)`` of planes of all directions, rings whose neighbours are about an angle [rad] apart.

    Examples
    --------
    >>> 5000 < len(half_sphere(np.radians(2.0))) < 5300
    True
    """
    rings = max(2, round(0.5 * np.pi / angle))
    normals = [np.array([[0.0, 0.0, 1.0]])]
    for polar in 0.5 * np.pi * np.arange(1, rings + 1) / rings:
        turn = np.pi if polar > 0.5 * np.pi - 1e-9 else 2.0 * np.pi  # the last ring holds each plane twice
        azimuth = (
            turn * np.arange(max(3, round(turn * np.sin(polar) / angle))) / max(3, round(turn * np.sin(polar) / angle))
        )
        z = np.full_like(azimuth, np.cos(polar))
        normals.append(np.stack([np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), z], axis=-1))
    return np.concatenate(normals)


def _refined(
    value: Callable[[FloatArray], FloatArray], largest: FloatArray, normals: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Climb from a plane of each point to a maximum nearby."""
    from eigencontact.core.path_loops import neighbours

    largest, normals = largest.copy(), normals.copy()
    angle = np.full(len(largest), 0.5 * _COARSE)
    turns = 2.0 * np.pi * np.arange(6) / 6
    at = np.full((len(largest), 6, 3), np.nan)
    climbing = np.arange(len(largest))
    for count in range(_MOST):
        # Turned from step to step: a ridge between two neighbours is not there in the next.
        neighbours(climbing, normals, angle, turns + count, at)
        values = np.asarray(value(at))[climbing]
        best = values.argmax(axis=1)
        rows = np.arange(len(climbing))
        risen = values[rows, best] > largest[climbing] + _EQUALITY_TOLERANCE * np.abs(largest[climbing])
        rising = climbing[risen]
        largest[rising] = values[rows, best][risen]
        normals[rising] = at[rising, best[risen]]
        angle[climbing[~risen]] *= 0.5
        converged = angle[climbing] < _FINE
        at[climbing[converged]] = np.nan
        climbing = climbing[~converged]
        if not climbing.size:
            break
    return largest, normals


def _of_points(normals: FloatArray) -> FloatArray:
    at = np.asarray(normals, dtype=float)
    return np.ascontiguousarray(at if at.ndim == 3 else at[None])


def _scattered(steps: int) -> IntArray:
    """Order of steps with distant neighbours, by the golden section."""
    return np.argsort(np.arange(steps) * 0.6180339887498949 % 1.0)
