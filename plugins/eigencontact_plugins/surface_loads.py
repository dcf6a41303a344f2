"""Uniform pressure and shear on a rectangle of a homogeneous half-space: exact at every depth, including z = 0.

A rectangle with an infinite half width along y is a strip in plane strain (`surface_loads_strip`).

Near the rectangle the field is the alternating sum of a corner function (`surface_loads_corner`). Far from it that sum
would lose accuracy, and pointwise evaluation uses Gauss sums of point forces (`surface_loads_far`). `sample` always
uses corner sums: its errors are relative to the largest coefficient of the lattice, which determines the error of a
convolution. `surface_loads_waves` has the traction waves.

Notes
-----
On the surface the stress is the limit from inside the body. On an edge of the rectangle discontinuous components are
the mean of both sides (a quarter at a corner). Some components have logarithmic singularities: ``xy`` of a pressure at
the corners for ν < 1/2, and ``xx, yy`` of q_x on the edges along y, ``xy`` on those along x (likewise q_y). Their
values are large and finite, with the correct sign, as at a distance of 1e-30 half widths. Displacement is continuous.

The wave of zero wavenumber has displacement 0, stress -1 in the component that balances the traction, 0 in the others.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from eigencontact.plugin import CornerInfluence, FloatArray, Material, hook_for
from eigencontact_plugins.surface_loads_corner import corner_field, surface_lift
from eigencontact_plugins.surface_loads_far import gauss_field, is_far
from eigencontact_plugins.surface_loads_strip import strip_field
from eigencontact_plugins.surface_loads_waves import wave_response

__all__ = ["PressureLoad", "ShearLoadX", "ShearLoadY"]

HalfWidths = tuple[float, float]


def _unit_of_length(half_widths: HalfWidths) -> float:
    """Power of two nearest to the longest half width, an exact scale for cells from 1 nm to 1 m."""
    return float(2.0 ** (np.frexp(max(half_widths))[1] - 1))


class _UniformLoad(CornerInfluence):
    """Base of the three loads; `direction` is the axis of the traction."""

    direction: ClassVar[str]
    has_strips: ClassVar[bool] = True

    def displacement_corner(
        self, components: Sequence[str], x: FloatArray, y: FloatArray, z: FloatArray | float, material: Material
    ) -> FloatArray:
        """Corner function of the displacement; see `CornerInfluence.displacement_corner`."""
        return corner_field(self.direction, "displacement", components, (x, y, z), material)

    def stress_corner(
        self, components: Sequence[str], x: FloatArray, y: FloatArray, z: FloatArray | float, material: Material
    ) -> FloatArray:
        """Corner function of the Mandel stress; see `CornerInfluence.stress_corner`."""
        return corner_field(self.direction, "stress", components, (x, y, z), material)

    def at_points(
        self,
        quantity: str,
        components: Sequence[str],
        points: tuple[FloatArray, FloatArray, FloatArray | float],
        half_widths: HalfWidths,
        material: Material,
    ) -> FloatArray:
        """Corner sums near the rectangle, Gauss sums far from it, in the unit of length of the rectangle.

        Measured error of the displacement at any distance, relative to the largest component over the three loads:
        1e-14 for a square, 4e-13 for edges 1:1000.
        """
        if np.isinf(half_widths[1]):
            return strip_field(self.direction, quantity, components, points, half_widths[0], material)
        unit = _unit_of_length(half_widths)
        x, y, z = (np.asarray(coordinate) / unit for coordinate in points)
        widths = half_widths[0] / unit, half_widths[1] / unit
        far = is_far((x, y, z), widths)
        factor = unit if quantity == "displacement" else 1.0
        if not far.any():
            return super().at_points(quantity, components, (x, y, z), widths, material) * factor
        x, y, z = np.broadcast_arrays(x, y, z)
        out = np.empty((len(components), *far.shape))
        near = ~far
        if near.any():
            out[:, near] = super().at_points(quantity, components, (x[near], y[near], z[near]), widths, material)
        out[:, far] = gauss_field(self.direction, quantity, components, (x[far], y[far], z[far]), widths, material)
        return out * factor

    def sample(
        self,
        quantity: str,
        components: Sequence[str],
        x: FloatArray,
        y: FloatArray,
        z: float,
        half_widths: HalfWidths,
        material: Material,
    ) -> FloatArray:
        """Influence coefficients on a lattice; see `SurfaceInfluence.sample`.

        The surface displacement along z by a pressure has a faster method of its own; frictionless contact needs
        nothing else.
        """
        if np.isinf(half_widths[1]):
            points = x[None, :], y[:, None], z
            return strip_field(self.direction, quantity, components, points, half_widths[0], material)
        unit = _unit_of_length(half_widths)
        x, y, a, b = x / unit, y / unit, half_widths[0] / unit, half_widths[1] / unit
        if self.direction == "z" and quantity == "displacement" and tuple(components) == ("z",) and z == 0:
            nodes = surface_lift(np.append(x - a, x[-1] + a), np.append(y - b, y[-1] + b))
            rows = nodes[1:] - nodes[:-1]
            lift = rows[:, 1:] - rows[:, :-1]
            lift *= unit / (np.pi * material.plane_strain_modulus)
            return lift[None]
        values = super().sample(quantity, components, x, y, z / unit, (a, b), material)
        return values * unit if quantity == "displacement" else values

    def wavenumber_response(
        self,
        quantity: str,
        components: Sequence[str],
        kx: FloatArray,
        ky: FloatArray,
        z: float,
        material: Material,
    ) -> NDArray[np.complex128]:
        """Amplitudes for a traction wave; see `HasWavenumberResponse`."""
        return wave_response(self.direction, quantity, components, kx, ky, z, material)


@dataclass(frozen=True, kw_only=True)
class PressureLoad(_UniformLoad):
    """Uniform pressure along +z into the body (Boussinesq; Love's rectangle).

    Examples
    --------
    >>> steel = Material(young_modulus=210e9, poisson_ratio=0.3)
    >>> lift = PressureLoad().displacement("z", np.array(0.0), np.array(0.0), 0.0, (1e-6, 1e-6), steel)
    >>> love = 8 * np.arcsinh(1.0) * 1e-6 / (np.pi * steel.plane_strain_modulus)
    >>> round(float(lift[0] / love), 12)
    1.0
    """

    key: ClassVar[str] = "pressure"
    traction: ClassVar[str] = "p"
    direction: ClassVar[str] = "z"
    references: ClassVar[tuple[str, ...]] = (
        "J. Boussinesq 1885, Application des potentiels, Gauthier-Villars, Paris",
        "A. E. H. Love 1929, Phil. Trans. R. Soc. A 228, 377-420, doi:10.1098/rsta.1929.0009",
        "K. L. Johnson 1985, Contact Mechanics, sec. 3.1-3.3, doi:10.1017/CBO9781139171731",
        (
            "B. Fulleringer, PhD thesis, Semi-analytical modeling of complex mechanical contacts, eqs 2.15-2.48 "
            "(2.22, 2.37 and 2.38 corrected)"
        ),
    )


@dataclass(frozen=True, kw_only=True)
class ShearLoadX(_UniformLoad):
    """Uniform shear traction acting on the body along +x (Cerruti); at the surface the stress xz is minus one."""

    key: ClassVar[str] = "shear-x"
    traction: ClassVar[str] = "q_x"
    direction: ClassVar[str] = "x"
    references: ClassVar[tuple[str, ...]] = (
        "V. Cerruti 1882, Mem. R. Accad. Lincei 13, 81-122",
        "K. L. Johnson 1985, Contact Mechanics, sec. 3.6, doi:10.1017/CBO9781139171731",
        (
            "B. Fulleringer, PhD thesis, Semi-analytical modeling of complex mechanical contacts, eqs 2.15-2.22 and "
            "2.49-2.60 (2.22, 2.49, 2.55 and 2.60 corrected)"
        ),
    )


@dataclass(frozen=True, kw_only=True)
class ShearLoadY(_UniformLoad):
    """Uniform shear traction acting on the body along +y: `ShearLoadX` with x and y exchanged."""

    key: ClassVar[str] = "shear-y"
    traction: ClassVar[str] = "q_y"
    direction: ClassVar[str] = "y"
    references: ClassVar[tuple[str, ...]] = ShearLoadX.references


eigencontact_register = hook_for(PressureLoad, ShearLoadX, ShearLoadY)
