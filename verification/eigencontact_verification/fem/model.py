"""Data of a finite-element model: a body with eigenstrained regions, loaded patches and layers.

Conventions: z into the body, the body is z >= 0 and its surface z = 0; stress positive in tension; eigenstrain positive
in expansion, ``stress = C : (strain - eigenstrain)``, which is what anisotropic thermal expansion does. Any consistent
units.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

__all__ = ["OUTER", "SYMMETRIES", "Layer", "Model", "Patch", "Region", "lame", "von_mises"]

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]
Contains = Callable[[FloatArray, FloatArray, FloatArray], BoolArray]
Triple = tuple[float, float, float]

#: A number or an array of them.
Modulus = TypeVar("Modulus", float, FloatArray)

SYMMETRIES = ("none", "even", "odd")
OUTER = ("fixed", "free")


def lame(young_modulus: Modulus, poisson_ratio: Modulus) -> tuple[Modulus, Modulus]:
    """Lamé's parameters (lambda, mu) [Pa], of numbers or of arrays.

    Examples
    --------
    >>> lame(2.5, 0.25)
    (1.0, 1.0)
    """
    mu = young_modulus / (2 * (1 + poisson_ratio))
    return 2 * mu * poisson_ratio / (1 - 2 * poisson_ratio), mu


def von_mises(stress: FloatArray) -> FloatArray:
    """Von Mises stress ``(...)`` of tensors ``(..., 3, 3)``."""
    deviator = stress - np.trace(stress, axis1=-2, axis2=-1)[..., None, None] / 3 * np.eye(3)
    return np.asarray(np.sqrt(1.5 * np.einsum("...ij,...ij->...", deviator, deviator)))


def _check_material(where: str, young_modulus: float, poisson_ratio: float) -> None:
    if not young_modulus > 0:
        raise ValueError(f"{where} young_modulus must be positive (got {young_modulus}); give the modulus [Pa]")
    if not -1 < poisson_ratio < 0.5:
        raise ValueError(
            f"{where} poisson_ratio must be in (-1, 0.5) (got {poisson_ratio}); displacement elements lock at 0.5"
        )


def _check_tensor(where: str, tensor: FloatArray) -> FloatArray:
    value = np.array(tensor, dtype=float)
    if value.shape != (3, 3) or not np.allclose(value, value.T, rtol=1e-12, atol=0):
        raise ValueError(f"{where} must be a symmetric (3, 3) tensor (got {value.tolist()}); give both shear entries")
    value.setflags(write=False)
    return value


@dataclass(frozen=True, kw_only=True)
class Region:
    """Part of the body with a uniform eigenstrain, its own moduli, or both.

    Attributes
    ----------
    contains : callable
        ``contains(x, y, z)`` with arrays of one shape gives a bool array of that shape.
    bounds : ((x, y, z), (x, y, z))
        Lowest and highest corner of a box around the region; mesh planes fall on it. Of the whole region, also where a
        symmetry plane leaves only a part of it in the mesh.
    eigenstrain : (3, 3) array
        Symmetric tensor, expansion positive.
    young_modulus, poisson_ratio : float or None
        Moduli of the region; None = those of the body around it.
    """

    contains: Contains
    bounds: tuple[Triple, Triple]
    eigenstrain: FloatArray = field(default_factory=lambda: np.zeros((3, 3)))
    young_modulus: float | None = None
    poisson_ratio: float | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "eigenstrain", _check_tensor("Region.eigenstrain", self.eigenstrain))
        low, high = self.bounds
        if not all(a < b for a, b in zip(low, high, strict=True)):
            raise ValueError(f"Region.bounds must be (low, high) with low < high (got {self.bounds}); swap the corners")


@dataclass(frozen=True, kw_only=True)
class Patch:
    """Rectangle of the surface under a uniform traction.

    Attributes
    ----------
    low, high : (x, y)
        Corners, of the whole patch also where a symmetry plane cuts it.
    traction : (t_x, t_y, t_z)
        Force per area [Pa] that acts on the body; a pressure p is ``(0, 0, p)``.
    """

    low: tuple[float, float]
    high: tuple[float, float]
    traction: Triple

    def __post_init__(self) -> None:
        if not all(a < b for a, b in zip(self.low, self.high, strict=True)):
            raise ValueError(f"Patch.low must be below Patch.high (got {self.low}, {self.high}); swap the corners")


@dataclass(frozen=True, kw_only=True)
class Layer:
    """Layer of another material, from the surface (or the layer above) downwards.

    Attributes
    ----------
    thickness, young_modulus, poisson_ratio : float
        Thickness and moduli of the layer.
    """

    thickness: float
    young_modulus: float
    poisson_ratio: float

    def __post_init__(self) -> None:
        if not self.thickness > 0:
            raise ValueError(f"Layer.thickness must be positive (got {self.thickness}); leave an empty layer out")
        _check_material("Layer", self.young_modulus, self.poisson_ratio)


@dataclass(frozen=True, kw_only=True)
class Model:
    """Block ``|x|, |y| <= reach, 0 <= z <= reach`` that stands for a half-space, and its mesh.

    Attributes
    ----------
    young_modulus, poisson_ratio : float
        Material of the body; under `layers`, of the substrate. Poisson's ratio below 0.5.
    regions, patches, layers : tuple
        Sources and materials. Where regions overlap, their eigenstrains add and the last one's moduli hold.
    reach : float
        Half width and depth of the block.
    symmetry : (str, str)
        Planes x = 0 and y = 0: ``"none"`` (both sides are meshed), ``"even"`` (normal displacement zero) or ``"odd"``
        (tangential displacement zero). Sources are given whole and must have the symmetry that is claimed.
    outer : str
        Sides and bottom: ``"fixed"`` (no displacement) or ``"free"`` (no traction; rigid motions that the symmetry
        leaves are removed).
    fine : float
        Edge of the elements near sources and at the surface.
    growth : float
        Largest ratio of neighbouring element edges away from there.
    order : int
        1 (trilinear) or 2 (triquadratic, 27 nodes) hexahedra.
    refine : int
        Parts that every edge of the mesh of `fine` and `growth` is split into, along the same grading: meshes of one
        family, with exact ratios (4, 6, 9 or 1, 2, 4 for Richardson's extrapolation).
    remote_stress : (3, 3) array or None
        Uniform stress far away that regions of other moduli disturb; only without layers. The solution's displacement
        is the disturbance alone (the uniform part is linear in x), its stress is the whole stress.
    """

    young_modulus: float
    poisson_ratio: float
    regions: tuple[Region, ...] = ()
    patches: tuple[Patch, ...] = ()
    layers: tuple[Layer, ...] = ()
    reach: float
    symmetry: tuple[str, str] = ("none", "none")
    outer: str = "fixed"
    fine: float
    growth: float = 1.3
    order: int = 2
    refine: int = 1
    remote_stress: FloatArray | None = None

    def __post_init__(self) -> None:
        _check_material("Model", self.young_modulus, self.poisson_ratio)
        for where, value, allowed in (
            ("symmetry[0]", self.symmetry[0], SYMMETRIES),
            ("symmetry[1]", self.symmetry[1], SYMMETRIES),
            ("outer", self.outer, OUTER),
            ("order", self.order, (1, 2)),
        ):
            if value not in allowed:
                raise ValueError(f"Model.{where} must be one of {allowed} (got {value!r}); choose one of them")
        if not 0 < self.fine < self.reach:
            raise ValueError(f"Model.fine must be in (0, reach) (got {self.fine}); reach is {self.reach}")
        if self.refine < 1:
            raise ValueError(f"Model.refine must be at least 1 (got {self.refine}); choose a larger `fine` instead")
        if not self.growth >= 1:
            raise ValueError(f"Model.growth must be at least 1 (got {self.growth}); 1 is a uniform mesh")
        for region in self.regions:
            young, nu = self.material_of(region)
            _check_material("Region", young, nu)
            low, high = region.bounds
            if low[2] < 0 or max(-low[0], -low[1], *high) > self.reach:
                raise ValueError(f"Region.bounds must be inside the block (got {region.bounds}); reach is {self.reach}")
        for patch in self.patches:
            if max(-patch.low[0], -patch.low[1], *patch.high) >= self.reach:
                raise ValueError(f"Patch must be inside the block (got {patch.low}, {patch.high}); enlarge reach")
        if sum(layer.thickness for layer in self.layers) >= self.reach:
            raise ValueError(f"Model.layers must be thinner than reach together (got {self.layers}); enlarge reach")
        if self.remote_stress is not None:
            if self.layers:
                raise ValueError(
                    "Model.remote_stress must be None with layers (got both); it is uniform in one material"
                )
            object.__setattr__(self, "remote_stress", _check_tensor("Model.remote_stress", self.remote_stress))

    def material_of(self, region: Region) -> tuple[float, float]:
        """Young's modulus and Poisson's ratio of a region; None is the model's own value, also under layers.

        A region without moduli of its own takes those of the layer that it lies in; this only fills in one that is
        missing.
        """
        young = self.young_modulus if region.young_modulus is None else region.young_modulus
        return young, self.poisson_ratio if region.poisson_ratio is None else region.poisson_ratio
