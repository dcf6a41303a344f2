"""Interfaces of a medium and of homogeneous kernels for the coefficients of layered bodies."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Literal, Protocol, runtime_checkable

import numpy as np

from eigencontact.core.array_types import ComplexArray, FloatArray
from eigencontact.core.material import Material

__all__ = ["HasResponseAtDepths", "HomogeneousInfluence", "Medium", "Side", "response_at_depths"]

Side = Literal["above", "below"]


class Medium(Protocol):
    """Half-space with constants that depend on depth; `eigencontact.plugin.LayeredMedium` documents the names."""

    key: str
    surface_material: Material
    deep_material: Material
    interfaces: tuple[float, ...]
    response: Callable[..., ComplexArray]


class HomogeneousInfluence(Protocol):
    """Field of a rectangle on a homogeneous half-space; see `eigencontact.plugin.SurfaceInfluence` for its methods."""

    key: str
    traction: str
    references: tuple[str, ...]
    mirror_symmetric: bool
    displacement: Callable[..., FloatArray]
    stress: Callable[..., FloatArray]
    sample: Callable[..., FloatArray]
    wavenumber_response: Callable[..., ComplexArray]


@runtime_checkable
class HasResponseAtDepths(Protocol):
    """Optional ability of a layered medium: its response at many depths in one call, where these share work.

    A medium without it is asked for one depth after the other. One that has it must give the same numbers both ways.
    """

    def response_at_depths(
        self,
        quantity: str,
        components: Sequence[str],
        traction: str,
        kx: FloatArray,
        ky: FloatArray,
        depths: FloatArray,
        *,
        side: Side = "below",
    ) -> ComplexArray:
        """Amplitudes at depths ``(nz,)`` [m], ``(len(components), nz, ...)``; see `LayeredMedium.response`.

        The depths come in any order, and may come twice.
        """


def response_at_depths(
    medium: Medium,
    quantity: str,
    components: Sequence[str],
    traction: str,
    waves: tuple[FloatArray, FloatArray],
    depths: FloatArray,
    side: Side,
) -> ComplexArray:
    """Response at depths ``(nz,)`` to waves (kx, ky), ``(len(components), nz, ...)``, with the ability or without."""
    if isinstance(medium, HasResponseAtDepths):
        return medium.response_at_depths(quantity, components, traction, *waves, depths, side=side)
    responses = [medium.response(quantity, components, traction, *waves, float(z), side=side) for z in depths]
    return np.stack(responses, axis=1)
