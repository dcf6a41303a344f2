"""Influence coefficients of a layered medium, from the wavenumber response of the medium and the homogeneous kernels.

It is a `SurfaceInfluence`, hence stands above the plugin interface; its numerics are in `halfspace.layered_*`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.material import Material
from eigencontact.errors import PlanError
from eigencontact.plugin import HasWavenumberResponse, LayeredMedium, SurfaceInfluence

__all__ = ["LayeredInfluence"]

FloatArray = NDArray[np.float64]
HalfWidths = tuple[float, float]


class LayeredInfluence(SurfaceInfluence):
    """The installed influence of one traction, extended to layered media.

    Every method takes a `Material` (the installed influence answers) or a `LayeredMedium` as `material`.

    Parameters
    ----------
    base : SurfaceInfluence
        Influence of the same traction on a homogeneous half-space; it must offer `wavenumber_response`.
    side : "above" or "below"
        Material that counts where a depth is that of an interface: the one nearer to the surface, or the deeper. Only
        the in-plane stresses ``xx, yy, xy`` differ. A caller who wants both builds two objects.
    """

    key: ClassVar[str] = "layered"
    traction: ClassVar[str]

    def __init__(self, base: SurfaceInfluence, *, side: Literal["above", "below"] = "below") -> None:
        if not isinstance(base, HasWavenumberResponse):
            raise PlanError(
                f"surface influence {base.key!r} must offer wavenumber_response for a body of layers (got none); use a "
                "homogeneous body, or an influence that offers it"
            )
        self.base = base
        self.side = side
        self.key = base.key  # type: ignore[misc]
        self.traction = base.traction  # type: ignore[misc]
        self.references = base.references  # type: ignore[misc]
        self.mirror_symmetric = base.mirror_symmetric  # type: ignore[misc]

    def displacement(
        self,
        components: Sequence[str],
        x: FloatArray,
        y: FloatArray,
        z: FloatArray | float,
        half_widths: HalfWidths,
        material: Material | LayeredMedium,
    ) -> FloatArray:
        """Displacement at points; see `SurfaceInfluence.displacement`."""
        if isinstance(material, Material):
            return self.base.displacement(components, x, y, z, half_widths, material)
        raise NotImplementedError

    def stress(
        self,
        components: Sequence[str],
        x: FloatArray,
        y: FloatArray,
        z: FloatArray | float,
        half_widths: HalfWidths,
        material: Material | LayeredMedium,
    ) -> FloatArray:
        """Mandel stress at points; see `SurfaceInfluence.stress`."""
        if isinstance(material, Material):
            return self.base.stress(components, x, y, z, half_widths, material)
        raise NotImplementedError

    def sample(
        self,
        quantity: str,
        components: Sequence[str],
        x: FloatArray,
        y: FloatArray,
        z: float,
        half_widths: HalfWidths,
        material: Material | LayeredMedium,
    ) -> FloatArray:
        """Influence coefficients on a lattice; see `SurfaceInfluence.sample`."""
        if isinstance(material, Material):
            return self.base.sample(quantity, components, x, y, z, half_widths, material)
        raise NotImplementedError

    def wavenumber_response(
        self,
        quantity: str,
        components: Sequence[str],
        kx: FloatArray,
        ky: FloatArray,
        z: float,
        material: Material | LayeredMedium,
    ) -> NDArray[np.complex128]:
        """Amplitudes for a traction wave; see `HasWavenumberResponse`."""
        if isinstance(material, Material):
            assert isinstance(self.base, HasWavenumberResponse)
            return self.base.wavenumber_response(quantity, components, kx, ky, z, material)
        return material.response(quantity, components, self.traction, kx, ky, z, side=self.side)
