"""Influence coefficients of a layered medium, from the wavenumber response of the medium and the homogeneous kernels.

`LayeredInfluence` has the methods of `eigencontact.plugin.SurfaceInfluence`, which take media as well as materials.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Sequence
from threading import Lock
from typing import Any

import numpy as np

from eigencontact.core.array_types import ComplexArray, FloatArray
from eigencontact.core.material import Material
from eigencontact.errors import PlanError, require
from eigencontact.halfspace.layered_depths import LayeredDepths
from eigencontact.halfspace.layered_remainder import SmoothField
from eigencontact.halfspace.layered_split import Band, bands
from eigencontact.halfspace.layered_waves import AxisResponse
from eigencontact.halfspace.media import HomogeneousInfluence, Medium, Side, response_at_depths

__all__ = ["LayeredInfluence"]

HalfWidths = tuple[float, float]

HANKEL = (
    "A. J. S. Hamilton 2000, Mon. Not. R. Astron. Soc. 312, 257-284, doi:10.1046/j.1365-8711.2000.03071.x "
    "(Hankel transform on a logarithmic grid)"
)
# Stretched reaches are rounded up to powers of the eighth root of 2, so that windows of about one size share fields.
OCTAVE = 8.0
# Layers thinner than this part of the reach are refused: the logarithmic grid that joins both grows by decades.
THIN = 1e9
# Half length of a strip in the smooth part, in parts of the longest length that counts. That part decays along the
# strip; what is beyond falls with the inverse of the length, and three lengths extrapolate it: see
# `StretchedNodes.strips`.
LONG = 1e3
# Memory of the smooth fields that are kept for further cells, components and steps [bytes]; a depth takes some 100 kB.
FIELD_MEMORY = 1e8


class LayeredInfluence:
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
    Closed kernels of half-spaces made of the top layer and of the substrate are taken out of the response of the
    medium where that is needed (`halfspace.layered_split`); the rest is smooth and goes to space without periodic
    images (`halfspace.layered_remainder`), many depths at once. Cells may be of any size against the layers. Every
    table is computed at two resolutions or more; `NotConverged` is raised where they differ by 1e-5 or more. The medium
    must be isotropic about z and have an interface: from the first one down it may be anything, above it is
    homogeneous.
    """

    kind = "surface-influence"

    def __init__(self, base: Any, *, side: Side = "below") -> None:
        if not hasattr(base, "wavenumber_response"):
            raise PlanError(
                f"surface influence {base.key!r} must offer wavenumber_response for a body of layers (got none); use a "
                "homogeneous body, or an influence that offers it"
            )
        self.base: HomogeneousInfluence = base
        self.side: Side = side
        self.key, self.traction = self.base.key, self.base.traction
        self.references = (*self.base.references, HANKEL)
        self.mirror_symmetric, self.has_strips = self.base.mirror_symmetric, getattr(self.base, "has_strips", False)
        self._fields: OrderedDict[tuple[str, Medium, Band, float], SmoothField] = OrderedDict()
        self._lock = Lock()

    def displacement(
        self,
        components: Sequence[str],
        x: FloatArray,
        y: FloatArray,
        z: FloatArray | float,
        half_widths: HalfWidths,
        material: Material | Medium,
    ) -> FloatArray:
        """Displacement at points; see `SurfaceInfluence.displacement`."""
        return self._at_points("displacement", components, (x, y, z), half_widths, material)

    def stress(
        self,
        components: Sequence[str],
        x: FloatArray,
        y: FloatArray,
        z: FloatArray | float,
        half_widths: HalfWidths,
        material: Material | Medium,
    ) -> FloatArray:
        """Mandel stress at points; see `SurfaceInfluence.stress`."""
        return self._at_points("stress", components, (x, y, z), half_widths, material)

    def sample(
        self,
        quantity: str,
        components: Sequence[str],
        x: FloatArray,
        y: FloatArray,
        z: float,
        half_widths: HalfWidths,
        material: Material | Medium,
    ) -> FloatArray:
        """Influence coefficients on a lattice; see `SurfaceInfluence.sample`."""
        if isinstance(material, Material):
            return self.base.sample(quantity, components, x, y, z, half_widths, material)
        reach = max(float(np.abs(x).max()), float(np.abs(y).max()))
        return self.at_depths(quantity, components, np.array([float(z)]), half_widths, reach, material).on_lattice(
            0, x, y
        )

    def at_depths(
        self,
        quantity: str,
        components: Sequence[str],
        depths: FloatArray,
        half_widths: HalfWidths,
        reach: float,
        medium: Medium,
    ) -> LayeredDepths:
        """Influence coefficients at many depths, ready for any lattice.

        Parameters
        ----------
        quantity, components
            See `sample`.
        depths : (nz,) float64
            [m]
        half_widths : (float, float)
            Of the rectangle [m]; infinite along y for a strip.
        reach : float
            Largest coordinate of an offset that will be asked for [m].
        medium : LayeredMedium

        Raises
        ------
        SceneError
            A layer so thin against the reach that no resolution sees both.
        NotConverged
            Two resolutions differ by 1e-5 or more.
        """
        thinnest = float(np.diff((0.0, *medium.interfaces)).min(initial=np.inf))
        rule = f"of layers that are thicker than {reach / THIN:.2g} [m], a part in {THIN:g} of the window"
        require(thinnest * THIN >= reach, medium.key, "thickness", thinnest, rule)
        fields: list[tuple[Band, SmoothField]] = []
        longest = max(half for half in half_widths if half < np.inf)
        split = list(bands(self.base, quantity, np.asarray(depths, dtype=float), longest, medium, self.side))
        if half_widths[1] == np.inf:
            longest = LONG * max(reach, longest, *(band.longest for band in split))
        edge = reach + longest
        for band in split:
            extent = 2.0 ** (float(np.ceil(OCTAVE * np.log2(np.arcsinh(edge / band.scale)))) / OCTAVE)
            fields.append((band, self._field(quantity, band, medium, extent)))
        coefficients = LayeredDepths(
            self.base, quantity, tuple(components), half_widths, reach, medium, self.side, tuple(fields)
        )
        with self._lock:
            while sum(smooth.nbytes for smooth in self._fields.values()) > FIELD_MEMORY:
                self._fields.popitem(last=False)
        return coefficients

    def _field(self, quantity: str, band: Band, medium: Medium, extent: float) -> SmoothField:
        """Smooth field of a band; the most recent ones are cached with their results."""
        key = (quantity, medium, band, extent)
        with self._lock:
            field = self._fields.get(key)
            if field is None:
                response = self._remainder(quantity, band, medium)
                field = SmoothField(response, self.traction, quantity, band.scale, band.longest, extent)
                self._fields[key] = field
            self._fields.move_to_end(key)
        return field

    def _remainder(self, quantity: str, band: Band, medium: Medium) -> AxisResponse:
        """Response at the depths of a band less that of its closed kernels."""
        depths = np.array(band.depths)

        def response(names: Sequence[str], kx: FloatArray, ky: FloatArray) -> ComplexArray:
            values = response_at_depths(medium, quantity, names, self.traction, (kx, ky), depths, self.side)
            for number, kernels in enumerate(band.kernels):
                for weight, solid, depth in kernels:
                    closed = self.base.wavenumber_response(quantity, names, kx, ky, depth, solid)
                    values[:, number] -= weight * closed
            return values

        return response

    def _at_points(
        self,
        quantity: str,
        components: Sequence[str],
        points: tuple[FloatArray, FloatArray, FloatArray | float],
        half_widths: HalfWidths,
        medium: Material | Medium,
    ) -> FloatArray:
        """Field at scattered points, one depth after the other; of a material by the installed influence."""
        if isinstance(medium, Material):
            evaluate = self.base.displacement if quantity == "displacement" else self.base.stress
            return evaluate(components, *points, half_widths, medium)
        x, y, z = np.broadcast_arrays(*(np.asarray(coordinate, dtype=float) for coordinate in points))
        depths, place = np.unique(z, return_inverse=True)
        place = place.reshape(z.shape)
        reach = max(float(np.abs(x).max()), float(np.abs(y).max()))
        at = self.at_depths(quantity, components, depths, half_widths, reach, medium)
        total = np.empty((len(components), *x.shape))
        for number in range(depths.size):
            at_depth = place == number
            total[:, at_depth] = at.about_points(number, x[at_depth], y[at_depth])
        return total

    def wavenumber_response(
        self,
        quantity: str,
        components: Sequence[str],
        kx: FloatArray,
        ky: FloatArray,
        z: float,
        material: Material | Medium,
    ) -> ComplexArray:
        """Amplitudes for a traction wave; see `HasWavenumberResponse`."""
        if isinstance(material, Material):
            return self.base.wavenumber_response(quantity, components, kx, ky, z, material)
        return material.response(quantity, components, self.traction, kx, ky, z, side=self.side)

    def wavenumber_responses(
        self,
        quantity: str,
        components: Sequence[str],
        kx: FloatArray,
        ky: FloatArray,
        depths: FloatArray,
        medium: Medium,
    ) -> ComplexArray:
        """Amplitudes for a traction wave at depths ``(nz,)`` [m], ``(len(components), nz, ...)``."""
        return response_at_depths(medium, quantity, components, self.traction, (kx, ky), depths, self.side)
