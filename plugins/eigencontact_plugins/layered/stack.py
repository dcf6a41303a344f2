"""Any number of bonded, isotropic, elastic layers on a half-space: exact answer to traction waves at any depth.

The recursion is in `recursion`; here are the scene table, the choice of materials and the change from the axes along
and across the wavevector to x and y.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from eigencontact.plugin import (
    COMPONENTS,
    SQRT2,
    LayeredMedium,
    Length,
    Material,
    SceneError,
    Stress,
    hookimpl,
    require,
)
from eigencontact_plugins.layered.recursion import Slab, state_at_depth

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

__all__ = ["BondedLayers", "Layer", "Substrate"]

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

# Stress of a uniform traction (k = 0); every other component is 0 there.
UNIFORM = {("p", "zz"): -1.0, ("q_x", "xz"): -1.0, ("q_y", "yz"): -1.0}
#: Thinner layers have waves of more than the largest number [m].
THINNEST = 1e-30
# A depth this close to an interface, in parts of its depth, is that interface: sums of thicknesses are rounded.
SAME_DEPTH = 1e-12


@dataclass(frozen=True, kw_only=True)
class _Solid:
    """What a layer and the substrate share."""

    young_modulus: Stress
    poisson_ratio: float

    @cached_property
    def material(self) -> Material:
        """Elastic constants, checked."""
        return Material(young_modulus=self.young_modulus, poisson_ratio=self.poisson_ratio)

    def check(self, where: str) -> None:
        """Refuse impossible constants; `where` names the table."""
        E, nu = self.young_modulus, self.poisson_ratio
        require(0 < E < np.inf, where, "young_modulus", E, "positive and finite [Pa]")
        require(-1 < nu <= 0.5, where, "poisson_ratio", nu, "in (-1, 0.5] [-]")


@dataclass(frozen=True, kw_only=True)
class Substrate(_Solid):
    """The half-space under the layers.

    Parameters
    ----------
    young_modulus : float
        E [Pa].
    poisson_ratio : float
        ν [-] in (-1, 0.5]; 0.5 is exact.
    """


@dataclass(frozen=True, kw_only=True)
class Layer(_Solid):
    """One layer; it is bonded to what lies above and below.

    Parameters
    ----------
    young_modulus : float
        E [Pa].
    poisson_ratio : float
        ν [-] in (-1, 0.5]; 0.5 is exact.
    thickness : float
        h [m].
    """

    thickness: Length

    def check(self, where: str) -> None:
        """Refuse impossible constants or thickness; `where` names the table."""
        super().check(where)
        require(0 < self.thickness < np.inf, where, "thickness", self.thickness, "positive and finite [m]")
        require(self.thickness >= THINNEST, where, "thickness", self.thickness, f"at least {THINNEST:g} [m]")


@dataclass(frozen=True, kw_only=True)
class BondedLayers(LayeredMedium):
    """Bonded elastic layers of uniform thickness on a half-space.

    Parameters
    ----------
    layers : tables
        From the surface down; see `Layer`. At least one.
    substrate : table
        The half-space under them; see `Substrate`.

    Notes
    -----
    Exact for any thickness, from k h of 0 to infinity, without growing exponentials, and for ν up to 0.5 included. At
    an interface displacement and traction are continuous; the in-plane stresses jump and `response` takes a side.
    """

    key: ClassVar[str] = "bonded-layers"
    references: ClassVar[tuple[str, ...]] = (
        "D. M. Burmister 1945, The general theory of stresses and displacements in layered systems, J. Appl. Phys. 16",
        "K. L. Johnson 1985, Contact Mechanics, sec. 3.1-3.3, doi:10.1017/CBO9781139171731 (homogeneous half-space)",
    )

    layers: tuple[Layer, ...]
    substrate: Substrate

    def __post_init__(self) -> None:
        if not self.layers:
            raise SceneError(
                f"{self.key}.layers must hold at least one layer (got none); a half-space without layers is the "
                "material of the body"
            )
        for number, layer in enumerate(self.layers):
            layer.check(f"{self.key}.layers.{number}")
        self.substrate.check(f"{self.key}.substrate")

    @property
    def surface_material(self) -> Material:
        """Material of the top layer."""
        return self.layers[0].material

    @property
    def deep_material(self) -> Material:
        """Material of the substrate."""
        return self.substrate.material

    @cached_property
    def interfaces(self) -> tuple[float, ...]:
        """Depth of the underside of each layer [m]."""
        return tuple(float(depth) for depth in np.cumsum([layer.thickness for layer in self.layers]))

    def material_at(self, z: float, *, side: Literal["above", "below"] = "below") -> Material:
        """Material of the layer that holds the depth z; see `LayeredMedium.material_at`."""
        return self._cut(z, side)[2]

    def response(
        self,
        quantity: str,
        components: Sequence[str],
        traction: str,
        kx: FloatArray,
        ky: FloatArray,
        z: float,
        *,
        side: Literal["above", "below"] = "below",
    ) -> ComplexArray:
        """Amplitudes of displacement or stress for a traction wave; see `LayeredMedium.response`."""
        self._check_request(quantity, components, traction, z, side)
        kx, ky = np.broadcast_arrays(np.asarray(kx, dtype=float), np.asarray(ky, dtype=float))
        length = np.hypot(kx, ky)
        zero = length == 0
        k = np.where(zero, 1.0, length)
        m, n = kx / k, ky / k
        above, below, material = self._cut(z, side)
        state = state_at_depth(k, above, below, self.deep_material, _load(traction, m, n))
        parts = state.displacement() if quantity == "displacement" else state.stress(material)
        out = np.zeros((len(components), *k.shape), dtype=complex)
        for row, name in enumerate(components):
            at_zero = 0.0 if quantity == "displacement" else UNIFORM.get((traction, name), 0.0)
            factor = 1.0 if name[0] == name[-1] else SQRT2
            out[row] = np.where(zero, at_zero, _turned(name, parts, m, n)) * factor
        return out

    def _check_request(self, quantity: str, components: Sequence[str], traction: str, z: float, side: str) -> None:
        choices = {"displacement": ("x", "y", "z"), "stress": COMPONENTS}
        require(quantity in choices, self.key, "quantity", quantity, "'displacement' or 'stress'")
        for name in components:
            require(name in choices[quantity], self.key, "components", name, f"of {', '.join(choices[quantity])}")
        require(traction in ("p", "q_x", "q_y"), self.key, "traction", traction, "'p', 'q_x' or 'q_y'")
        require(0 <= z < np.inf, self.key, "z", z, "zero or positive, and finite [m]")
        require(side in ("above", "below"), self.key, "side", side, "'above' or 'below'")

    def _cut(self, z: float, side: str) -> tuple[list[Slab], list[Slab], Material]:
        """Slabs above the depth z and below it, from the surface down, and the material at z.

        The layer that holds z is cut in two there, so that every depth is an interface to the recursion.
        """
        bottoms = np.array(self.interfaces)
        nearest = int(np.argmin(np.abs(bottoms - z)))
        if abs(bottoms[nearest] - z) <= SAME_DEPTH * bottoms[nearest]:
            z = float(bottoms[nearest])
        slabs = [Slab(layer.thickness, layer.material) for layer in self.layers]
        index = int(np.searchsorted(bottoms, z, side="right" if side == "below" else "left"))
        top = float(bottoms[index - 1]) if index else 0.0
        material = slabs[index].material if index < len(slabs) else self.deep_material
        above, below = slabs[:index], slabs[index + 1 :]
        if z > top:
            above.append(Slab(z - top, material))
        if index < len(slabs) and z < bottoms[index]:
            whole = z == top
            below.insert(0, slabs[index] if whole else Slab(float(bottoms[index]) - z, material))
        return above, below, material


def _load(traction: str, m: FloatArray, n: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Traction along z, along the wavevector (m, n) and across it (-n, m)."""
    one, nil = np.ones_like(m), np.zeros_like(m)
    return {"p": (one, nil, nil), "q_x": (nil, m, -n), "q_y": (nil, n, m)}[traction]


def _turned(name: str, parts: dict[str, ComplexArray], m: FloatArray, n: FloatArray) -> ComplexArray:
    """Component along x, y, z from components along the wavevector (s), across it (t) and z."""
    part = parts.__getitem__
    match name:
        case "x":
            return m * part("s") - n * part("t")
        case "y":
            return n * part("s") + m * part("t")
        case "xx":
            return m * m * part("ss") + n * n * part("tt") - 2 * m * n * part("st")
        case "yy":
            return n * n * part("ss") + m * m * part("tt") + 2 * m * n * part("st")
        case "xy":
            return m * n * (part("ss") - part("tt")) + (m * m - n * n) * part("st")
        case "xz":
            return m * part("sz") - n * part("tz")
        case "yz":
            return n * part("sz") + m * part("tz")
        case _:  # z and zz
            return part(name)


@hookimpl
def eigencontact_register() -> Iterable[type[LayeredMedium]]:
    """Register bonded elastic layers."""
    return [BondedLayers]
