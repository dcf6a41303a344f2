"""The kind *surface influence*: the field of a uniformly loaded rectangle of the surface."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from typing import ClassVar, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.arrays import FloatArray
from eigencontact.core.material import Material
from eigencontact.plugin.component import Component

__all__ = ["CornerInfluence", "HasWavenumberResponse", "SurfaceInfluence"]


class SurfaceInfluence(Component, ABC):
    """Field in a half-space z >= 0 of one traction component, uniform on the rectangle |x| <= a, |y| <= b of z = 0.

    Coordinates are *field point minus centre of the rectangle*. All values are per unit traction: displacement in
    m/Pa, stress in Pa/Pa. Stress components follow the order and the Mandel scaling of `COMPONENTS`:
    ``yz, xz, xy`` carry a factor sqrt(2).

    Attributes
    ----------
    traction : str
        ``"p"`` (pushes along +z), ``"q_x"`` or ``"q_y"`` (act on the body along +x, +y).
    mirror_symmetric : bool
        True where the medium is its own mirror image in x and in y; the framework then stores and samples one
        quadrant of each influence coefficient. Set False for general anisotropy.
    has_strips : bool
        True where half widths ``(a, inf)`` give the field of a strip in plane strain, which line contacts need. The
        displacement of a strip has a free constant, proportional to the load on it.

    Examples
    --------
    The bundled ones are plugins as any other; `rectangle_field` adds them up:

    >>> from eigencontact import rectangle_field
    >>> u = rectangle_field((0, 0, 1e6), (1e-6, 1e-6), [[0, 0, 0]], young_modulus=210e9, poisson_ratio=0.3)
    >>> f"{u[0, 2]:.3e} m"
    '9.726e-12 m'
    """

    kind: ClassVar[str] = "surface-influence"
    traction: ClassVar[str]
    mirror_symmetric: ClassVar[bool] = True
    has_strips: ClassVar[bool] = False

    @abstractmethod
    def displacement(
        self,
        components: Sequence[str],
        x: FloatArray,
        y: FloatArray,
        z: FloatArray | float,
        half_widths: tuple[float, float],
        material: Material,
    ) -> FloatArray:
        """Displacement components (of ``"x", "y", "z"``) at points, ``(len(components), ...)`` [m/Pa].

        x, y, z broadcast against each other; ``half_widths`` is ``(a, b)`` along x and y [m].
        """

    @abstractmethod
    def stress(
        self,
        components: Sequence[str],
        x: FloatArray,
        y: FloatArray,
        z: FloatArray | float,
        half_widths: tuple[float, float],
        material: Material,
    ) -> FloatArray:
        """Stress components (of `COMPONENTS`, Mandel) at points, ``(len(components), ...)`` [-]."""

    def sample(
        self,
        quantity: str,
        components: Sequence[str],
        x: FloatArray,
        y: FloatArray,
        z: float,
        half_widths: tuple[float, float],
        material: Material,
    ) -> FloatArray:
        """Influence coefficients on the lattice ``x (nx,)``, ``y (ny,)`` at one depth, ``(len(components), ny, nx)``.

        `quantity` is ``"displacement"`` or ``"stress"``. On a lattice with the spacing of the cells neighbouring
        rectangles share corners; `CornerInfluence` uses that.
        """
        evaluate = self.displacement if quantity == "displacement" else self.stress
        return evaluate(components, x[None, :], y[:, None], z, half_widths, material)


class CornerInfluence(SurfaceInfluence):
    """Surface influence with a corner function: the field is its alternating sum over the four corners.

    ``field(x, y) = C(x+a, y+b) - C(x-a, y+b) - C(x+a, y-b) + C(x-a, y-b)``. The author writes the two corner
    functions; they must be finite at z = 0 and on the lines x = 0 and y = 0.
    """

    @abstractmethod
    def displacement_corner(
        self, components: Sequence[str], x: FloatArray, y: FloatArray, z: FloatArray | float, material: Material
    ) -> FloatArray:
        """Corner function of the displacement, ``(len(components), ...)`` [m/Pa]."""

    @abstractmethod
    def stress_corner(
        self, components: Sequence[str], x: FloatArray, y: FloatArray, z: FloatArray | float, material: Material
    ) -> FloatArray:
        """Corner function of the Mandel stress, ``(len(components), ...)`` [-]."""

    def at_points(
        self,
        quantity: str,
        components: Sequence[str],
        points: tuple[FloatArray, FloatArray, FloatArray | float],
        half_widths: tuple[float, float],
        material: Material,
    ) -> FloatArray:
        """Sum of a corner function over the four corners at points (x, y, z): `displacement` and `stress`.

        A class that has better digits far from the rectangle overrides it. `quantity` is as of `sample`.
        """
        (x, y, z), (a, b), corner = points, half_widths, self._corner(quantity)
        total: FloatArray = corner(components, x + a, y + b, z, material)
        total = total - corner(components, x - a, y + b, z, material)
        total -= corner(components, x + a, y - b, z, material)
        total += corner(components, x - a, y - b, z, material)
        return total

    def _corner(self, quantity: str) -> Callable[..., FloatArray]:
        return self.displacement_corner if quantity == "displacement" else self.stress_corner

    def displacement(
        self,
        components: Sequence[str],
        x: FloatArray,
        y: FloatArray,
        z: FloatArray | float,
        half_widths: tuple[float, float],
        material: Material,
    ) -> FloatArray:
        """Displacement at points; see `SurfaceInfluence.displacement`."""
        return self.at_points("displacement", components, (x, y, z), half_widths, material)

    def stress(
        self,
        components: Sequence[str],
        x: FloatArray,
        y: FloatArray,
        z: FloatArray | float,
        half_widths: tuple[float, float],
        material: Material,
    ) -> FloatArray:
        """Mandel stress at points; see `SurfaceInfluence.stress`."""
        return self.at_points("stress", components, (x, y, z), half_widths, material)

    def sample(
        self,
        quantity: str,
        components: Sequence[str],
        x: FloatArray,
        y: FloatArray,
        z: float,
        half_widths: tuple[float, float],
        material: Material,
    ) -> FloatArray:
        """Evaluate the corner function once per lattice node and form differences, where the rectangles touch.

        Rectangles that do not touch are evaluated one by one; see `SurfaceInfluence.sample`.
        """
        (a, b), corner = half_widths, self._corner(quantity)
        if not (_touch(x, a) and _touch(y, b)):
            return super().sample(quantity, components, x, y, z, half_widths, material)
        nodes_x = np.append(x - a, x[-1] + a)
        nodes_y = np.append(y - b, y[-1] + b)
        values = corner(components, nodes_x[None, :], nodes_y[:, None], z, material)
        out = np.empty((len(values), y.size, x.size))
        for table, component in zip(out, values, strict=True):
            rows = component[1:] - component[:-1]
            np.subtract(rows[:, 1:], rows[:, :-1], out=table)
        return out


def _touch(middles: FloatArray, half_width: float) -> bool:
    """Whether rectangles about these middles share their edges, to a millionth of their width."""
    return middles.size < 2 or bool(np.all(abs(np.diff(middles) / (2 * half_width) - 1) < 1e-6))


@runtime_checkable
class HasWavenumberResponse(Protocol):
    """Optional ability of a surface influence: the response to a traction wave, needed by periodic scenes."""

    def wavenumber_response(
        self,
        quantity: str,
        components: Sequence[str],
        kx: FloatArray,
        ky: FloatArray,
        z: float,
        material: Material,
    ) -> NDArray[np.complex128]:
        """Amplitudes of the field for the traction ``exp(i (kx x + ky y))``, ``(len(components), ...)``.

        At kx = ky = 0 the displacement is defined as 0 (the mean displacement of a periodic half-space is unbounded)
        and the stress is that of a uniform traction.
        """
        ...
