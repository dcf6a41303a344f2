"""Closed half-space kernels that are subtracted from the response of a layered medium to leave a smooth field.

Depths whose remainders decay alike share one `Band`: its nodes and its transform are found once.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from hashlib import sha256

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.array_types import FloatArray
from eigencontact.core.material import Material
from eigencontact.errors import PlanError
from eigencontact.halfspace.layered_waves import DIRECTIONS
from eigencontact.halfspace.media import HomogeneousInfluence, Medium, Side, response_at_depths

__all__ = ["DEEP", "DIRECT_COMPONENTS", "Band", "Kernel", "bands"]

#: Closed kernel of a half-space: weight, material, depth [m].
Kernel = tuple[float, Material, float]

#: Depths of more than this many half-widths are deep: corner sums lose digits there like the square of the depth in
#: half-widths, and the field of a rectangle is smooth. With 20 they lose two or three.
DEEP = 20.0
#: The component that a traction moves most, or that balances it: it measures all others.
DIRECT_COMPONENTS = {
    traction: {"displacement": axis, "stress": "zz" if axis == "z" else f"{axis}z"}
    for traction, axis in DIRECTIONS.items()
}
# Depths of a band differ by no more than this factor in their scales, and are no more than so many. The 43 depths of a
# section through one coating took 80, 66 and 62 ms with factors of 2, 4 and 8; wide bands need more nodes.
SPREAD = 4.0
MOST = 64


@dataclass(frozen=True)
class Band:
    """Depths that share nodes and transforms.

    Parameters
    ----------
    numbers : tuple of int
        Places of these depths among all.
    depths : tuple of float
        [m]
    kernels : tuple, for each depth, of (weight, material, depth)
        Closed kernels that are taken out, and added again.
    scale, longest : float
        Shortest and longest length [m] in what is left, see `SmoothField`.
    answer : bytes
        Hash of the response at some waves: it tells media apart whose fields do not say all, as that of a file.
    """

    numbers: tuple[int, ...] = field(compare=False)
    depths: tuple[float, ...]
    kernels: tuple[tuple[Kernel, ...], ...]
    scale: float
    longest: float
    answer: bytes


def bands(
    base: HomogeneousInfluence, quantity: str, depths: FloatArray, half_width: float, medium: Medium, side: Side
) -> list[Band]:
    """Split depths ``(nz,)`` [m] into bands, for rectangles of this longest half-width.

    Near the rectangle, in the top layer, of thickness h, the closed kernel is that of a half-space of its material. The
    rest is what the first interface sends back, and decays with k (2h - z); elsewhere the field itself decays with k z.
    The response of displacements grows like 1/k: the kernels of top layer (at the depth of that image) and substrate
    give the rest the right limit at k = 0, and cancel the long reach of the top layer's kernel. Under stiff layers the
    substrate is felt only by long waves: its kernel is taken at their depth, or it would have to be cancelled again.
    """
    top = medium.surface_material
    thickness = medium.interfaces[0] if medium.interfaces else np.inf
    if not np.isfinite(thickness):
        raise PlanError(
            f"medium {medium.key!r} must have an interface for contact that is not periodic (got none); give its "
            "top a first layer of constant moduli, or set numerics.boundary = 'periodic'"
        )
    moves = quantity == "displacement"
    near = depths <= min(np.nextafter(thickness, 0.0), DEEP * half_width)
    scale = np.where(near, 2 * thickness - depths, depths)
    split = []
    for numbers in _alike(near, scale):
        band_depths = depths[numbers]
        least = float(scale[numbers].min())
        slowest, digest = _depth_of_substrate(base, quantity, band_depths, float(scale[numbers].max()), medium, side)
        far = ((1.0, medium.deep_material, slowest),) if moves else ()
        kernels = []
        for z, image in zip(band_depths.tolist(), scale[numbers].tolist(), strict=True):
            closed = ((1.0, top, z), (-1.0, top, image)) if moves else ((1.0, top, z),)
            kernels.append((*(closed if near[numbers[0]] else ()), *far))
        longest = max(slowest, medium.interfaces[-1])
        split.append(Band(tuple(numbers.tolist()), tuple(band_depths.tolist()), tuple(kernels), least, longest, digest))
    return split


def _alike(near: NDArray[np.bool_], scale: FloatArray) -> Iterator[NDArray[np.intp]]:
    """Indices of depths, all near or none, whose scales differ by at most `SPREAD`."""
    for where in (near, ~near):
        numbers = np.flatnonzero(where)
        numbers = numbers[np.argsort(scale[numbers], kind="stable")]
        while numbers.size:
            size = min(MOST, int(np.searchsorted(scale[numbers], SPREAD * scale[numbers[0]], side="right")))
            yield numbers[:size]
            numbers = numbers[size:]


def _depth_of_substrate(
    base: HomogeneousInfluence, quantity: str, depths: FloatArray, least: float, medium: Medium, side: Side
) -> tuple[float, bytes]:
    """Depth [m], at least `least`, from which the kernel of the substrate is at most twice the response; a hash."""
    k = np.geomspace(1e-12, 1.0, 97) / least
    nil = np.zeros_like(k)
    direct = [DIRECT_COMPONENTS[base.traction][quantity]]
    waves = np.append(k, nil), np.append(nil, k)  # along x and along y
    fields = response_at_depths(medium, quantity, direct, base.traction, waves, depths, side)[0]
    substrate = base.wavenumber_response(quantity, direct, *waves, least, medium.deep_material)[0]
    small = np.append(k, k)[(np.abs(fields) < 0.5 * np.abs(substrate)).any(axis=0)]
    digest = sha256(fields.tobytes() + substrate.tobytes()).digest()
    return max(least, 1.0 / float(small.min(initial=np.inf))), digest
