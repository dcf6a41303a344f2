"""Cases of bonded layers: a circle of the surface under pressure, by axisymmetric elements and by Hankel's transform.

What is judged is the answer of the layered medium to pressure waves; the sum over the waves of a circle is a quadrature
here, so that no grid stands between the medium and the elements.

References
----------
I. N. Sneddon 1951, Fourier Transforms, chapter 10 (axisymmetric problems); K. L. Johnson 1985, Contact Mechanics,
section 3.4 (pressure on circles).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.crosscheck.case import Fields, Level, Outer, Profile, Quantity, in_name
from eigencontact_verification.crosscheck.lines import FieldCase, chosen, in_units
from eigencontact_verification.fem.axisymmetric_model import AxisymmetricLayer, AxisymmetricModel, Disc

__all__ = ["KEY", "LayeredCase", "layered_case"]

FloatArray = NDArray[np.float64]

#: Key of the layered medium that is judged.
KEY = "bonded-layers"
#: Code that decides what the finite elements of a case compute.
_CODE = (
    *(f"{__name__}:LayeredCase.{name}" for name in ("interfaces", "model", "reference", "read")),
    "eigencontact_verification.crosscheck.lines:chosen",
    "eigencontact_verification.crosscheck.lines:columns",
)
_DIVISIONS, _GROWTH = (4, 6, 9), 2.0
#: Reach of the body in radii of the circle.
_REACH = 80.0
#: Points just above and below an interface lie so far from it, in thicknesses of the layer.
_BESIDE = 1e-6
#: Longest wavenumber, in units of the circle's inverse radius, and the exponent beyond which a wave has died out.
_LONGEST, _DECAY = 2000.0, 45.0
#: Gauss points in a part of the wavenumbers over which the argument of no Bessel function grows by more than `_TURN`.
_GAUSS, _TURN = 12, 4.0


@dataclass(frozen=True, kw_only=True, eq=False)
class LayeredCase(FieldCase):
    """Pressure on the circle r <= 1 of a layered body; the substrate has E = 1.

    The outer faces are displaced as a point force displaces a half-space of the substrate, which layers change there by
    one part in the reach R: the surface is off by a term of R^-2, whatever the faces do. So truncation is bracketed by
    two reaches. With D = u(R) - u(R/2) that law gives u(R) + D/3 for the layered half-space; the cross-check takes the
    middle of ``"fixed"`` and ``"free"`` and half their distance, so ``"free"`` returns u(R) + 2 D/3.
    """

    code: ClassVar[tuple[str, ...]] = _CODE

    @property
    def interfaces(self) -> FloatArray:
        """Depths of the lower sides of the layers."""
        return np.cumsum([layer["thickness"] for layer in self.parameters["layers"]])

    def model(self, level: Level, *, reach: float) -> AxisymmetricModel:
        """Finite-element model of one level with its outer faces at `reach`."""
        parameters = self.parameters
        return AxisymmetricModel(
            young_modulus=1.0,
            poisson_ratio=parameters["poisson_ratio"],
            layers=tuple(AxisymmetricLayer(**layer) for layer in parameters["layers"]),
            discs=(Disc(radius=1.0, pressure=1.0, profile=parameters["pressure"]),),
            reach=reach,
            far_field=True,
            fine=parameters["fine"],
            growth=parameters["growth"],
            divisions=parameters["divisions"][level],
            lines=((), (0.0, *self.interfaces.tolist())),
        )

    def reference(self, level: Level, outer: Outer) -> Fields:
        """Values of the finite-element model; see above for what ``"free"`` means."""
        from eigencontact_verification.fem.axisymmetric import solve_axisymmetric

        def values(reach: float) -> Fields:
            solution = solve_axisymmetric(self.model(level, reach=reach))
            return {profile.name: chosen(self.read(solution, profile), profile) for profile in self.profiles}

        reach = self.parameters["reach"]
        fixed = values(reach)
        if outer == "fixed":
            return fixed
        nearer = values(reach / 2)
        return {name: (5 * fixed[name] - 2 * nearer[name]) / 3 for name in fixed}

    def read(self, solution: Any, profile: Profile) -> FloatArray:
        """Displacement, or stress recovered within the layer that each point is in."""
        from eigencontact_verification.fem.section_recovery import recovered_section_stress

        if profile.quantity == "displacement":
            return np.asarray(solution.displacement(profile.points))
        return recovered_section_stress(
            solution, profile.points, side=lambda _x, _y, z: np.searchsorted(self.interfaces, z)
        )

    def field(self, points: FloatArray, quantity: Quantity) -> FloatArray:
        """Displacement ``(n, 3)`` or stress ``(n, 3, 3)`` of the medium at points ``(n, 3)``, y = 0 and x >= 0."""
        from eigencontact import make

        parameters = self.parameters
        substrate = {"young_modulus": 1.0, "poisson_ratio": parameters["poisson_ratio"]}
        medium = make(KEY, kind="layered-medium", layers=parameters["layers"], substrate=substrate)
        values = np.zeros((len(points), 3) if quantity == "displacement" else (len(points), 3, 3))
        for depth in np.unique(points[:, 2]):
            at_depth = points[:, 2] == depth
            values[at_depth] = _at_depth(medium, parameters["pressure"], points[at_depth, 0], float(depth), quantity)
        return values

    @property
    def words(self) -> str:
        """Title of the figures: the problem in words."""
        layers = ", ".join(
            f"{layer['thickness']:g} a of E = {layer['young_modulus']:g}, ν = {layer['poisson_ratio']:g}"
            for layer in self.parameters["layers"]
        )
        return (
            f"{KEY}: {self.parameters['pressure']} pressure on a circle, layers {layers} on E = 1, "
            f"ν = {self.parameters['poisson_ratio']:g}"
        )


def transform(pressure: str, k: FloatArray) -> FloatArray:
    """Hankel transform of order 0 of a pressure on r < 1, uniform or Hertz's, with 1 everywhere or in the middle."""
    from scipy.special import j1

    if pressure == "uniform":
        return np.asarray(j1(k) / k)
    small = k < 0.05
    safe = np.where(small, 1.0, k)
    return np.where(small, 1 / 3 - k**2 / 30 + k**4 / 840, (np.sin(safe) - safe * np.cos(safe)) / safe**3)


def _at_depth(medium: Any, pressure: str, x: FloatArray, z: float, quantity: Quantity) -> FloatArray:
    """Field at points (x, 0, z), x >= 0: integrals over waves along x, whose other directions Bessel functions add."""
    from scipy.special import j0, j1

    end = min(_LONGEST, _DECAY / z) if z > 0 else _LONGEST
    intervals = int(np.ceil(end * (1.0 + float(np.max(x))) / _TURN))
    nodes, weights = np.polynomial.legendre.leggauss(_GAUSS)
    width = end / intervals
    k = (width * (np.arange(intervals)[:, None] + (nodes + 1) / 2)).ravel()
    weight = np.tile(weights * width / 2, intervals) * k * transform(pressure, k)
    names = ("x", "z") if quantity == "displacement" else ("xx", "yy", "zz", "xz")
    wave = medium.response(quantity, names, "p", k, np.zeros_like(k), z)
    J0, J1 = j0(np.outer(x, k)), j1(np.outer(x, k))
    if quantity == "displacement":
        along, down = -J1 @ (weight * wave[0].imag), J0 @ (weight * wave[1].real)
        return np.stack([along, np.zeros_like(along), down], axis=1)
    across = np.where(x[:, None] > 0, J1 / np.where(x[:, None] > 0, np.outer(x, k), 1.0), 0.5)
    s, t, n = (weight * values.real for values in wave[:3])
    out = np.zeros((len(x), 3, 3))
    out[:, 0, 0] = J0 @ s + across @ (t - s)
    out[:, 1, 1] = J0 @ t + across @ (s - t)
    out[:, 2, 2] = J0 @ n
    out[:, 0, 2] = out[:, 2, 0] = -J1 @ (weight * wave[3].imag) / np.sqrt(2.0)
    return out


def layered_case(
    layers: Sequence[Sequence[float]],
    *,
    name: str = "",
    poisson_ratio: float = 0.3,
    pressure: str = "hertz",
    quick: bool = False,
) -> LayeredCase:
    """Case of one stack of layers.

    Parameters
    ----------
    layers : sequence of (thickness, E, ν)
        From the surface down; thickness in radii of the circle, E in units of the substrate's.
    name : str
        Of the case; by default from ratio and thickness of the first layer, and the pressure.
    poisson_ratio : float
        Of the substrate.
    pressure : {"hertz", "uniform"}
        On the circle.
    quick : bool
        Whether the case belongs to the quick cross-check.
    """
    thinnest = min(thickness for thickness, _, _ in layers)
    interfaces = np.cumsum([thickness for thickness, _, _ in layers])
    parameters: dict[str, Any] = {
        "layers": [dict(zip(("thickness", "young_modulus", "poisson_ratio"), layer, strict=True)) for layer in layers],
        "poisson_ratio": poisson_ratio,
        "pressure": pressure,
        "reach": _REACH,
        "fine": min(1.0, 1.5 * thinnest),
        "growth": _GROWTH,
        "divisions": list(_DIVISIONS),
    }
    x = np.linspace(0.0, 4.0, 33)
    x = x[np.abs(x - 1.0) > 0.1]  # beside the edge of the circle a quadrature over waves falls slowly
    depths = np.linspace(0.12, float(interfaces[-1]) + 1.5, 22)
    beside = _BESIDE * thinnest
    depths = depths[np.all(np.abs(depths[:, None] - interfaces) > 0.03 * thinnest, axis=1)]
    depths = np.sort(np.concatenate([depths, interfaces - beside, interfaces + beside]))
    lines = [
        Profile(
            name="surface-x", quantity="displacement", points=np.stack([x, 0 * x, 0 * x], axis=1), along=x,
            label="distance from the axis", components=("u_x", "u_z"), formal_order=3.0,
        ),
        *(
            Profile(
                name=title, quantity="stress",
                points=np.stack([np.full(depths.size, at), 0 * depths, depths], axis=1), along=depths, label="depth",
                components=components, formal_order=3.0,
            )
            for title, at, components in (
                ("axis-stress", 0.0, ("s_xx", "s_zz")),
                ("half-radius-stress", 0.5, ("s_xx", "s_yy", "s_zz", "s_xz")),
            )
        ),
    ]  # fmt: skip
    return LayeredCase(
        subject=KEY,
        name=name or f"ratio-{in_name(layers[0][1])}-thickness-{in_name(layers[0][0])}-{pressure}",
        parameters=parameters,
        quick=quick,
        profiles=in_units(lines, length="a", displacement="p a / E", stress="p"),
        ratio=(_DIVISIONS[2] / _DIVISIONS[0]) ** 0.5,
    )
