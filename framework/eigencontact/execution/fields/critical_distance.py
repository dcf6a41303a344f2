"""Values of a damage parameter near a hot spot: at a critical distance, and means over a line or a volume."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.units import readable
from eigencontact.errors import SceneError
from eigencontact.execution.fields.stress_cycle import CycleOfRegion

__all__ = ["mean_of_ball", "value_near"]

#: Points of the quadrature over a ball: depths, radii and angles in each disc.
_DEPTHS, _RADII, _ANGLES = 16, 8, 16


def value_near(region: CycleOfRegion, value: FloatArray, length: float, method: str) -> float:
    """Value of a damage parameter near its maximum.

    Parameters
    ----------
    region : CycleOfRegion
        Points of the values.
    value : (points,)
        Damage parameter, in any unit.
    length : float
        Critical distance L [m].
    method : {"point", "line", "volume"}
        "point": value at L/2 below the maximum. "line": mean over a depth of 2 L. "volume": mean over the part of the
        body within L.

    Raises
    ------
    SceneError
        The region does not contain these positions.

    References
    ----------
    D. Taylor, The Theory of Critical Distances, Elsevier, 2007 (point method L/2, line method 2 L). The radius of the
    volume is a parameter of the user: it differs from the L of the other methods.
    """
    axes = _axes(region)
    hot = int(value.argmax())
    place, values = region.places[:, hot], value.reshape(region.shape)
    if "z" not in axes:
        raise SceneError(
            f"distance must be given with a region along z (got {region.region!r}, which has no depths); leave it out"
        )
    if method == "volume":
        if sorted(axes) != ["x", "y", "z"]:
            raise SceneError(
                f'method must be "point" or "line" in a region that is no volume (got "volume" in {region.region!r}); '
                "give a region of shape volume"
            )
        _refuse_outside(region, axes, place, length)
        return mean_of_ball([axes[axis] for axis in "zyx"], values, place[::-1], length)
    depth = list(axes).index("z")
    row = [slice(None) if n == depth else int(at) for n, at in enumerate(np.unravel_index(hot, region.shape))]
    below, values = axes["z"] - place[2], values[tuple(row)]
    reach = (0.5 if method == "point" else 2.0) * length
    if below[-1] < reach:
        raise SceneError(
            f"distance must be such that the region holds {readable(reach, 'm')} below the hot spot (got "
            f"{readable(float(below[-1]), 'm')}); enlarge the region"
        )
    if method == "point":
        return float(np.interp(reach, below, values))
    depths = np.union1d(below[(below > 0) & (below < reach)], [0.0, reach])
    return float(np.trapezoid(np.interp(depths, below, values), depths) / reach)


def mean_of_ball(axes: Sequence[FloatArray], values: FloatArray, centre: FloatArray, radius: float) -> float:
    """Mean over the part of a ball below the surface z = 0; the values are interpolated linearly between grid points.

    Parameters
    ----------
    axes : three arrays
        Coordinates along z, y and x [m]. Above the first depth the values of the first depth apply.
    values : (nz, ny, nx)
    centre : (3,)
        z, y, x of the centre [m].
    radius : float
        Radius of the ball [m].

    Examples
    --------
    >>> z, line = np.linspace(0.0, 1.0, 5), np.linspace(-1.0, 1.0, 9)
    >>> field = np.broadcast_to(z[:, None, None], (5, 9, 9))  # the centroid of a half ball lies at 3/8 of its radius
    >>> round(mean_of_ball([z, line, line], field, np.zeros(3), 0.8), 6)
    0.3
    """
    from scipy.interpolate import RegularGridInterpolator

    top = max(-radius, -float(centre[0]))
    nodes, weights = np.polynomial.legendre.leggauss(_DEPTHS)
    heights = top + 0.5 * (radius - top) * (nodes + 1.0)  # of discs, from the centre downwards
    discs = radius**2 - heights**2
    rings, ring_weights = np.polynomial.legendre.leggauss(_RADII)
    squares = 0.5 * (rings + 1.0)  # rings of a disc by the square of their radius: equal weights are equal areas
    turns = 2.0 * np.pi * (np.arange(_ANGLES) + 0.5) / _ANGLES
    distance = np.sqrt(discs[:, None, None] * squares[None, :, None])
    points = np.stack(
        np.broadcast_arrays(
            np.maximum(centre[0] + heights[:, None, None], axes[0][0]),
            centre[1] + distance * np.sin(turns),
            centre[2] + distance * np.cos(turns),
        ),
        axis=-1,
    )
    share = (weights * discs)[:, None, None] * ring_weights[None, :, None] * np.ones(_ANGLES)
    return float(np.sum(share * RegularGridInterpolator(tuple(axes), values)(points)) / share.sum())


def _axes(region: CycleOfRegion) -> dict[str, FloatArray]:
    """Coordinates along each dimension of a region [m], in order."""
    names = [dim.removeprefix(f"{region.region}_") for dim in region.dims]
    grids = region.places.reshape(3, *region.shape)
    return {
        name: grids["xyz".index(name)][tuple(slice(None) if dim == name else 0 for dim in names)]
        for name in names
        if name in ("x", "y", "z")
    }


def _refuse_outside(region: CycleOfRegion, axes: dict[str, FloatArray], place: FloatArray, radius: float) -> None:
    for axis, at in zip("xyz", place, strict=True):
        low, high = float(axes[axis][0]), float(axes[axis][-1])
        at_surface = axis == "z" and low <= axes[axis][1] - low  # no points lie in the layer above
        room = high - at if at_surface else min(at - low, high - at)
        if room < radius:
            raise SceneError(
                f"distance must be such that region {region.region!r} holds the ball of this radius around the hot "
                f"spot (got {readable(radius, 'm')}, and {readable(max(float(room), 0.0), 'm')} along {axis}); enlarge "
                "the region"
            )
