"""Any number of bonded, isotropic, elastic layers on a half-space: exact field of traction waves at any depth.

`recursion` has the recursion; this module has the scene table, the choice of materials, and the transformation from the
axes along and across the wavevector to x and y.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from eigencontact.plugin import (
    COMPONENTS,
    SQRT2,
    FloatArray,
    LayeredMedium,
    Length,
    Material,
    SceneError,
    Stress,
    hook_for,
    require,
)
from eigencontact_plugins.layered.recursion import Slab, Waves

__all__ = ["BondedLayers", "Layer", "Substrate"]

ComplexArray = NDArray[np.complex128]

# Stress of a uniform traction (k = 0); all other components are 0.
UNIFORM = {("p", "zz"): -1.0, ("q_x", "xz"): -1.0, ("q_y", "yz"): -1.0}
#: Smallest thickness [m]: the wavenumbers of thinner layers overflow.
THINNEST = 1e-30
# Components by a traction across the wavevector; the others follow from one along it, or along z.
ACROSS = ("t", "tz", "st")
# Phases of components with an even and an odd number of indices along the surface, see `State`.
PHASES = {True: (1.0, 1j), False: (-1j, 1.0)}
# Relative difference in depth below which a depth lies on an interface: sums of thicknesses have round-off.
SAME_DEPTH = 1e-12


@dataclass(frozen=True, kw_only=True)
class _Solid:
    """Elastic constants of a layer or of the substrate.

    Parameters
    ----------
    young_modulus : float
        E [Pa].
    poisson_ratio : float
        ν [-] in (-1, 0.5]; 0.5 is exact.
    """

    young_modulus: Stress
    poisson_ratio: float

    @cached_property
    def material(self) -> Material:
        """Elastic constants, checked."""
        return Material(young_modulus=self.young_modulus, poisson_ratio=self.poisson_ratio)

    def check(self, where: str) -> None:
        """Refuse invalid constants; `where` is the name of the table."""
        E, nu = self.young_modulus, self.poisson_ratio
        require(0 < E < np.inf, where, "young_modulus", E, "positive and finite [Pa]")
        require(-1 < nu <= 0.5, where, "poisson_ratio", nu, "in (-1, 0.5] [-]")


@dataclass(frozen=True, kw_only=True)
class Substrate(_Solid):
    """Half-space below the layers."""


@dataclass(frozen=True, kw_only=True)
class Layer(_Solid):
    """Layer bonded to the layers above and below.

    Parameters
    ----------
    thickness : float
        h [m].
    name : str, optional
        For pictures, messages, results, `explain` and laws that distinguish materials; unique among the layers. By
        default ``"layer 1"``, ``"layer 2"`` ... from the surface down.
    """

    thickness: Length
    name: str | None = None

    def check(self, where: str) -> None:
        """Refuse invalid constants or thickness; `where` is the name of the table."""
        super().check(where)
        require(0 < self.thickness < np.inf, where, "thickness", self.thickness, "positive and finite [m]")
        require(self.thickness >= THINNEST, where, "thickness", self.thickness, f"at least {THINNEST:g} [m]")


@dataclass(frozen=True, kw_only=True)
class BondedLayers(LayeredMedium):
    """Bonded elastic layers of uniform thickness on a half-space.

    Parameters
    ----------
    layers : tables
        Layers from the surface down; see `Layer`. At least one.
    substrate : table
        Half-space below the layers; see `Substrate`.

    Notes
    -----
    Exact for any thickness, from k h of 0 to infinity, without growing exponentials, and for ν up to 0.5 included.
    Displacement and traction are continuous at an interface; the in-plane stresses are discontinuous, and `response`
    has an argument for the side.
    """

    key: ClassVar[str] = "bonded-layers"
    example: ClassVar[dict[str, Any]] = {
        "layers": [{"thickness": "1 um", "young_modulus": "420 GPa", "poisson_ratio": 0.25}],
        "substrate": {"young_modulus": "210 GPa", "poisson_ratio": 0.3},
    }
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
        names = [layer.name for layer in self.layers if layer.name]
        duplicate = next((name for number, name in enumerate(names) if name in names[:number]), None)
        require(duplicate is None, self.key, "layers", duplicate, "of different names; rename one of the layers")
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
        """Depth of the lower face of each layer [m]."""
        return tuple(self._undersides.tolist())

    @property
    def layer_names(self) -> tuple[str, ...]:
        """Names of the layers in the scene; numbers for layers without a name."""
        return tuple(layer.name or name for layer, name in zip(self.layers, super().layer_names, strict=True))

    def thinned(self, depth: float) -> BondedLayers | Material:
        """See `Thinning.thinned`."""
        undersides = self._undersides - depth
        layers = tuple(
            replace(layer, thickness=float(min(under, layer.thickness)))
            for layer, under in zip(self.layers, undersides, strict=True)
            if under >= THINNEST
        )
        return replace(self, layers=layers) if layers else self.deep_material

    def material_at(self, z: float, *, side: Literal["above", "below"] = "below") -> Material:
        """Material of the layer at the depth z; see `LayeredMedium.material_at`."""
        return self._materials[int(self._places(np.array([z], dtype=float), side)[0][0])]

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
        depths = np.array([z], dtype=float)
        return self.response_at_depths(quantity, components, traction, kx, ky, depths, side=side)[:, 0]

    def response_at_depths(
        self,
        quantity: str,
        components: Sequence[str],
        traction: str,
        kx: FloatArray,
        ky: FloatArray,
        depths: FloatArray,
        *,
        side: Literal["above", "below"] = "below",
    ) -> ComplexArray:
        """Amplitudes at many depths at once; see `HasResponseAtDepths`."""
        self._check_request(quantity, components, traction, depths, side)
        kx, ky = np.broadcast_arrays(np.asarray(kx, dtype=float), np.asarray(ky, dtype=float))
        length = np.hypot(kx, ky)
        zero = length == 0
        k = np.where(zero, 1.0, length)
        m, n = kx / k, ky / k
        # The recursion depends on k alone: on the lattice of an FFT most wavevectors share k with seven others.
        distinct, place = np.unique(k, return_inverse=True)
        place = place.reshape(k.shape)
        slabs = [Slab(layer.thickness, layer.material) for layer in self.layers]
        waves = Waves(distinct, slabs, self.deep_material, "p" if traction == "p" else "q")
        unit, nil = np.ones(1), np.zeros(1)
        loads = {"p": (unit, nil), "q_x": (m, -n), "q_y": (n, m)}[traction]
        out = np.zeros((len(components), depths.size, *k.shape), dtype=complex)
        index, interface, offset = self._places(depths, side)
        for layer, level in sorted(set(zip(index.tolist(), interface.tolist(), strict=True))):
            numbers = np.flatnonzero((index == layer) & (interface == level))
            state = waves.on_interface(level) if level >= 0 else waves.inside(layer, offset[numbers])
            amplitudes = state.displacement() if quantity == "displacement" else state.stress(self._materials[layer])
            shares = {name: values[:, place] * loads[name in ACROSS] for name, values in amplitudes.items()}
            for row, name in enumerate(components):
                values = _turned(name, shares, m, n)
                values[:, zero] = 0.0 if quantity == "displacement" else UNIFORM.get((traction, name), 0.0)
                phase = PHASES[traction == "p"][len(name.replace("z", "")) % 2]
                out[row, numbers] = values * (phase if name[0] == name[-1] else phase * SQRT2)
        return out

    def _check_request(
        self, quantity: str, components: Sequence[str], traction: str, depths: FloatArray, side: str
    ) -> None:
        choices = {"displacement": ("x", "y", "z"), "stress": COMPONENTS}
        require(quantity in choices, self.key, "quantity", quantity, "'displacement' or 'stress'")
        for name in components:
            require(name in choices[quantity], self.key, "components", name, f"of {', '.join(choices[quantity])}")
        require(traction in ("p", "q_x", "q_y"), self.key, "traction", traction, "'p', 'q_x' or 'q_y'")
        for z in depths:
            require(0 <= z < np.inf, self.key, "z", z, "zero or positive, and finite [m]")
        require(side in ("above", "below"), self.key, "side", side, "'above' or 'below'")

    @cached_property
    def _undersides(self) -> FloatArray:
        return np.cumsum([layer.thickness for layer in self.layers])

    @cached_property
    def _materials(self) -> tuple[Material, ...]:
        """Materials from the top layer to the substrate."""
        return (*(layer.material for layer in self.layers), self.deep_material)

    def _places(self, depths: FloatArray, side: str) -> tuple[NDArray[np.intp], NDArray[np.intp], FloatArray]:
        """Number of the layer at each depth; of its interface, or -1; depth below the top of the layer [m].

        Interface 0 is the surface; the substrate follows the last layer.
        """
        bottoms = self._undersides
        nearest = bottoms[np.argmin(np.abs(bottoms - depths[:, None]), axis=1)]
        z = np.where(np.abs(nearest - depths) <= SAME_DEPTH * nearest, nearest, depths)
        index = np.searchsorted(bottoms, z, side="right" if side == "below" else "left")
        offset = z - np.append(0.0, bottoms)[index]
        under = z == np.append(bottoms, np.inf)[index]
        return index, np.where(offset == 0, index, np.where(under, index + 1, -1)), offset


def _turned(name: str, components: Mapping[str, FloatArray], m: FloatArray, n: FloatArray) -> FloatArray:
    """Plain component along x, y, z from components along the wavevector (s), across it (t) and z."""
    component = components.__getitem__
    match name:
        case "x":
            return m * component("s") - n * component("t")
        case "y":
            return n * component("s") + m * component("t")
        case "xx":
            return m * m * component("ss") + n * n * component("tt") - 2 * m * n * component("st")
        case "yy":
            return n * n * component("ss") + m * m * component("tt") + 2 * m * n * component("st")
        case "xy":
            return m * n * (component("ss") - component("tt")) + (m * m - n * n) * component("st")
        case "xz":
            return m * component("sz") - n * component("tz")
        case "yz":
            return n * component("sz") + m * component("tz")
        case _:  # z and zz
            return component(name)


eigencontact_register = hook_for(BondedLayers)
