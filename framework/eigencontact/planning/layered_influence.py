"""Influence coefficients of a layered medium, from the wavenumber response of the medium and the homogeneous kernels.

It is a `SurfaceInfluence`, hence stands above the plugin interface; its numerics are in `halfspace.layered_*`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.material import Material
from eigencontact.core.symmetry import parity
from eigencontact.core.tensors import COMPONENTS
from eigencontact.errors import NotConverged, PlanError
from eigencontact.halfspace.layered_cells import StretchedNodes
from eigencontact.halfspace.layered_remainder import SmoothField
from eigencontact.halfspace.layered_waves import DIRECTIONS
from eigencontact.plugin import HasWavenumberResponse, LayeredMedium, SurfaceInfluence

__all__ = ["LayeredInfluence"]

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
HalfWidths = tuple[float, float]

HANKEL = (
    "A. J. S. Hamilton 2000, Mon. Not. R. Astron. Soc. 312, 257-284, doi:10.1046/j.1365-8711.2000.03071.x "
    "(Hankel transform on a logarithmic grid)"
)
NAMES = {"displacement": ("x", "y", "z"), "stress": COMPONENTS}
# Resolutions of the smooth part are raised by this factor until two agree to TARGET, in parts of the largest value.
RESOLUTIONS = (1.0, 1.4, 2.0, 2.8, 4.0)
TARGET = 1e-9
ACCEPTED = 1e-5
# Depths of more than this many half-widths are deep, see `_closed`; largest spacing and least number of nodes there.
DEEP = 20.0
DEEP_STEP = 0.05
DEEP_NODES = 12
EPSILON = 1e-15
# The component that a traction moves most, or that balances it: it measures all others.
OWN = {
    "p": {"displacement": "z", "stress": "zz"},
    "q_x": {"displacement": "x", "stress": "xz"},
    "q_y": {"displacement": "y", "stress": "yz"},
}
# Offsets in each direction where two resolutions are compared.
PROBES = 10


@dataclass(frozen=True)
class _Split:
    """Closed half-space kernels (weight, material, depth) taken out of a response, and the lengths of what is left."""

    kernels: tuple[tuple[float, Material, float], ...]
    scale: float
    slowest: float


class LayeredInfluence(SurfaceInfluence):
    """The installed influence of one traction, extended to layered media.

    Every method takes a `Material` (the installed influence answers) or a `LayeredMedium` as `material`.

    Parameters
    ----------
    base : SurfaceInfluence
        Influence of the same traction on a homogeneous half-space; it must offer `wavenumber_response`.
    side : "above" or "below"
        Material that counts where a depth is that of an interface: the one nearer to the surface, or the deeper. Only
        the in-plane stresses ``xx, yy, xy`` differ. A caller who wants both builds two objects, or asks for a depth
        a little less than that of the interface (by more than the 1e-12 within which a medium takes depths as equal).

    Notes
    -----
    The closed kernels of half-spaces made of the top layer and of the substrate are taken out of the response of the
    medium; the rest is smooth and goes to space without periodic images (`halfspace.layered_remainder`). Cells may be
    of any size against the layers. Every table is computed at two resolutions or more; `NotConverged` is raised where
    they differ by 1e-5 or more. The medium must be isotropic about z and have an interface: from the first one down it
    may be anything, above it is homogeneous.
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
        self.references = (*base.references, HANKEL)  # type: ignore[misc]
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
        """Displacement at points; see `SurfaceInfluence.displacement`. Each depth costs about as much as a `sample`."""
        if isinstance(material, Material):
            return self.base.displacement(components, x, y, z, half_widths, material)
        return self._at_points("displacement", components, (x, y, z), half_widths, material)

    def stress(
        self,
        components: Sequence[str],
        x: FloatArray,
        y: FloatArray,
        z: FloatArray | float,
        half_widths: HalfWidths,
        material: Material | LayeredMedium,
    ) -> FloatArray:
        """Mandel stress at points; see `SurfaceInfluence.stress` and `displacement`."""
        if isinstance(material, Material):
            return self.base.stress(components, x, y, z, half_widths, material)
        return self._at_points("stress", components, (x, y, z), half_widths, material)

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
        return self.sample_with_bound(quantity, components, x, y, z, half_widths, material)[0]

    def sample_with_bound(
        self,
        quantity: str,
        components: Sequence[str],
        x: FloatArray,
        y: FloatArray,
        z: float,
        half_widths: HalfWidths,
        medium: LayeredMedium,
    ) -> tuple[FloatArray, float]:
        """Influence coefficients of layers as `sample` gives them, and a bound of their error.

        Returns
        -------
        values : (len(components), ny, nx) float64
        bound : float
            In parts of the largest value on the lattice, of these components and of the one that the traction moves
            most: twice the change from the resolution before the one that was taken, at up to 11 x 11 offsets that
            lie densest at the rectangle, plus an estimate of rounding. Typically 50 times the error.
        """
        split = self._split(quantity, float(z), medium)
        smooth, bound = self._smooth(quantity, components, (x, y, float(z)), half_widths, medium, split)
        total = smooth.on_lattice(x, y, half_widths)[: len(components)]
        for weight, solid, depth in split.kernels:
            total += weight * self._closed(quantity, components, (x, y, depth), half_widths, solid)
        return total, bound

    def _closed(
        self,
        quantity: str,
        components: Sequence[str],
        lattice: tuple[FloatArray, FloatArray, float],
        half_widths: HalfWidths,
        solid: Material,
    ) -> FloatArray:
        """Coefficients of a homogeneous half-space on a lattice, to all digits at depths of many cells too.

        Deep down the differences of corner functions lose digits like the square of the depth in cells. The field is
        smooth there: it is evaluated point by point on a few nodes.
        """
        x, y, depth = lattice
        if depth <= DEEP * max(half_widths):
            return self.base.sample(quantity, components, x, y, depth, half_widths, solid)
        reach = max(float(np.abs(x).max()), float(np.abs(y).max()), *half_widths)
        # A window much narrower than the depth sees only the first terms of a series: nodes of its own size keep them.
        nodes = StretchedNodes(depth, reach, min(DEEP_STEP, float(np.arcsinh(reach / depth)) / DEEP_NODES))
        evaluate = self.base.displacement if quantity == "displacement" else self.base.stress
        values = evaluate(components, nodes.x[None, :], nodes.x[:, None], depth, half_widths, solid)
        across, along = nodes.values(x), nodes.values(y)
        signs = [parity(name, DIRECTIONS[self.traction]) for name in components]
        return np.array([along[in_y] @ G @ across[in_x].T for G, (in_y, in_x) in zip(values, signs, strict=True)])

    def _at_points(
        self,
        quantity: str,
        components: Sequence[str],
        points: tuple[FloatArray, FloatArray, FloatArray | float],
        half_widths: HalfWidths,
        medium: LayeredMedium,
    ) -> FloatArray:
        """Field at scattered points, one depth after the other."""
        x, y, z = np.broadcast_arrays(*(np.asarray(coordinate, dtype=float) for coordinate in points))
        total = np.empty((len(components), *x.shape))
        for depth in np.unique(z):
            chosen = z == depth
            px, py = x[chosen], y[chosen]
            split = self._split(quantity, float(depth), medium)
            smooth, _ = self._smooth(quantity, components, (px, py, float(depth)), half_widths, medium, split)
            values = smooth.at_points(px, py, half_widths)[: len(components)]
            evaluate = self.base.displacement if quantity == "displacement" else self.base.stress
            for weight, solid, at in split.kernels:
                values += weight * evaluate(components, px, py, at, half_widths, solid)
            total[:, chosen] = values
        return total

    def _split(self, quantity: str, z: float, medium: LayeredMedium) -> _Split:
        """Choose the closed kernels to take out at depth z.

        In the top layer, of thickness h, the rest is what the first interface sends back: it decays with k (2h - z).
        For displacements the kernels of top layer and substrate at the depth of that image give it the right limit at
        k = 0 too, and cancel the long reach of the top layer's kernel. Deeper down the field itself decays with k z.
        Under stiff layers the substrate is felt only by long waves: its kernel is taken at their depth, or it would
        have to be cancelled again.
        """
        top, deep = medium.surface_material, medium.deep_material
        thickness = medium.interfaces[0] if medium.interfaces else np.inf
        if not np.isfinite(thickness):
            raise PlanError(
                f"medium {medium.key!r} must have an interface for contact that is not periodic (got none); give its "
                "top a first layer of constant moduli, or set numerics.boundary = 'periodic'"
            )
        image = z if z >= thickness else 2 * thickness - z
        slowest = self._depth_of_substrate(quantity, z, image, medium)
        far = (1.0, deep, slowest)
        if z >= thickness:
            return _Split((far,), image, slowest)
        if quantity == "displacement":
            return _Split(((1.0, top, z), (-1.0, top, image), far), image, slowest)
        return _Split(((1.0, top, z),), image, slowest)

    def _depth_of_substrate(self, quantity: str, z: float, least: float, medium: LayeredMedium) -> float:
        """Depth [m], at least `least`, at which the kernel of the substrate nowhere exceeds twice the response."""
        k = np.geomspace(1e-12, 1.0, 97) / least
        nil = np.zeros_like(k)
        own = [OWN[self.traction][quantity]]
        depth = least
        for kx, ky in ((k, nil), (nil, k)):
            field = self.wavenumber_response(quantity, own, kx, ky, z, medium)
            alone = self.wavenumber_response(quantity, own, kx, ky, least, medium.deep_material)
            small = np.flatnonzero(np.abs(field[0]) < 0.5 * np.abs(alone[0]))
            if small.size:
                depth = max(depth, 1.0 / float(k[small[0]]))
        return depth

    def _smooth(
        self,
        quantity: str,
        components: Sequence[str],
        points: tuple[FloatArray, FloatArray, float],
        half_widths: HalfWidths,
        medium: LayeredMedium,
        split: _Split,
    ) -> tuple[SmoothField, float]:
        """Return the rest of the field, resolved until two resolutions agree, and the bound of its relative error."""
        names = NAMES[quantity]
        x, y, z = points
        reach = max(float(np.abs(x).max()) + half_widths[0], float(np.abs(y).max()) + half_widths[1])

        def response(kx: FloatArray, ky: FloatArray) -> ComplexArray:
            values = self.wavenumber_response(quantity, names, kx, ky, z, medium)
            for weight, solid, depth in split.kernels:
                values -= weight * self.wavenumber_response(quantity, names, kx, ky, depth, solid)
            return values

        own = OWN[self.traction][quantity]
        watched = [*components, *(() if own in components else (own,))]
        probe_x, probe_y = _probes(x), _probes(y)
        evaluate = self.base.displacement if quantity == "displacement" else self.base.stress
        closed = np.zeros((len(watched), probe_y.size, probe_x.size))
        for weight, solid, depth in split.kernels:
            closed += weight * evaluate(watched, probe_x[None, :], probe_y[:, None], depth, half_widths, solid)
        rounding = self._rounding(quantity, half_widths, split) * reach / min(half_widths)
        coarse: FloatArray | None = None
        bound = np.inf
        for resolution in RESOLUTIONS:
            smooth = SmoothField(response, self.traction, names, watched, split.scale, split.slowest, reach, resolution)
            fine = smooth.on_lattice(probe_x, probe_y, half_widths)
            if coarse is not None:
                largest = float(np.abs(fine + closed).max())
                change = float(np.abs(fine - coarse).max()) / largest
                bound = 2 * change + rounding / largest
                if change < TARGET:
                    break
            coarse = fine
        if not bound < ACCEPTED:
            raise NotConverged(
                f"influence coefficients of medium {medium.key!r} ({quantity} at z = {z:.3g} m) must agree to "
                f"{ACCEPTED:.0e} between two resolutions (got {bound:.1e}); join layers that are much thinner than the "
                "others, or bring the moduli nearer together"
            )
        return smooth, bound

    def _rounding(self, quantity: str, half_widths: HalfWidths, split: _Split) -> float:
        """Rounding of the corner sums of displacements, for a lattice of one cell; those of stress are of order 1."""
        if quantity == "stress":
            return 0.0
        own, origin = [OWN[self.traction][quantity]], np.zeros(1)
        shallow = [solid for _, solid, depth in split.kernels if depth <= DEEP * max(half_widths)]
        kernels = (self.base.displacement(own, origin, origin, 0.0, half_widths, solid) for solid in shallow)
        return EPSILON * sum(float(np.abs(kernel).max()) for kernel in kernels)

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


def _probes(coordinate: FloatArray) -> FloatArray:
    """Offsets at which two resolutions are compared: 0 and some of those asked for, near and far."""
    known = np.unique(np.abs(coordinate))
    ranks = np.unique(np.geomspace(1, known.size, PROBES).astype(int)) - 1
    return np.unique(np.append(known[ranks], 0.0))
