"""Influence coefficients of layers at many depths: the smooth field at a sufficient resolution, and closed kernels."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.material import Material
from eigencontact.core.products import product
from eigencontact.core.symmetry import parity
from eigencontact.core.table_cache import address, table_cache
from eigencontact.errors import NotConverged, require
from eigencontact.halfspace.layered_remainder import RESOLUTIONS, NodalField, SmoothField
from eigencontact.halfspace.layered_split import DEEP, DIRECT_COMPONENTS, Band, Kernel
from eigencontact.halfspace.layered_waves import DIRECTIONS, NAMES
from eigencontact.halfspace.media import HomogeneousInfluence, Medium, Side

__all__ = ["LayeredDepths"]

# Resolutions of the smooth part are raised until two agree to TARGET, in parts of the largest value.
TARGET = 1e-9
ACCEPTED = 1e-5
EPSILON = 1e-15
# Offsets in each direction where two resolutions are compared, besides 0.
PROBES = 10
# Points at which closed kernels are evaluated together: enough that calls cost little, few enough to be small.
TOGETHER = 16384


@dataclass(frozen=True)
class _Resolved:
    """Field of one band at a sufficient resolution, with the closed kernels of deep half-spaces on its nodes."""

    band: Band
    smooth: NodalField
    #: Values of the deep closed kernels on the nodes, ``(len(components), nz, n, n)``; none where there are none.
    deep: FloatArray | None
    #: For each depth: kernels (weight, material, depth) that are not deep.
    shallow: list[list[Kernel]]


@dataclass(frozen=True)
class LayeredDepths:
    """Influence coefficients of one rectangle at depths; see `LayeredInfluence.at_depths`.

    Attributes
    ----------
    bounds : (nz,) float64
        For each depth a bound of the error, in parts of the largest value of these components and of the one that the
        traction moves most: twice the change from the resolution before the one that was taken, at up to 11 x 11
        offsets that lie densest at the rectangle, plus an estimate of rounding.
    """

    base: HomogeneousInfluence
    quantity: str
    components: tuple[str, ...]
    half_widths: tuple[float, float]
    reach: float
    medium: Medium
    side: Side
    fields: tuple[tuple[Band, SmoothField], ...]
    bounds: FloatArray = field(init=False)
    _places: dict[int, tuple[_Resolved, int]] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "bounds", np.empty(sum(len(band.numbers) for band, _ in self.fields)))
        object.__setattr__(self, "_places", {})
        for band, smooth in self.fields:
            resolved = self._resolve(band, smooth)
            self._places.update({number: (resolved, row) for row, number in enumerate(band.numbers)})

    def on_lattice(self, number: int, x: FloatArray, y: FloatArray) -> FloatArray:
        """Coefficients at depth `number` on offsets ``x (nx,)``, ``y (ny,)`` [m], ``(len(components), ny, nx)``.

        The lattice has the spacing of the cells, see `SurfaceInfluence.sample`.
        """
        self._check(x, y)
        resolved, row = self._places[number]
        total = resolved.smooth.on_cells(self._rows, row, x, y, self.half_widths)
        for weight, solid, depth in resolved.shallow[row]:
            closed = self.base.sample(self.quantity, self.components, x, y, depth, self.half_widths, solid)
            total += weight * closed
        if resolved.deep is not None:
            across, along = resolved.smooth.nodes.values(x), resolved.smooth.nodes.values(y)
            for n, name in enumerate(self.components):
                in_y, in_x = parity(name, DIRECTIONS[self.base.traction])
                total[n] += product(product(along[in_y], resolved.deep[n, row]), across[in_x].T)
        return total

    def superposing(self, load: FloatArray) -> Callable[[int, FloatArray, FloatArray], FloatArray]:
        """Sums of a load over a lattice, ``f(number, x, y) -> (len(components),)``: of the products with `on_lattice`.

        No table of the smooth part is made: its load is brought to the nodes, once for all depths that see it alike.

        Parameters
        ----------
        load : (ny, nx) float64
            On the lattices that will be asked for.
        """
        moments: dict[tuple[int, bytes, bytes], dict[tuple[int, int], FloatArray]] = {}

        def superposed(number: int, x: FloatArray, y: FloatArray) -> FloatArray:
            resolved, row = self._places[number]
            if resolved.deep is not None:
                return _sum(self.on_lattice(number, x, y), load)
            self._check(x, y)
            key = id(resolved), x.tobytes(), y.tobytes()
            if key not in moments:
                moments[key] = resolved.smooth.moments(x, y, self.half_widths, load)
            smooth = resolved.smooth
            total = np.array(
                [np.vdot(smooth.values[name, row], moments[key][smooth.parities[name]]) for name in self._rows]
            )
            for weight, solid, depth in resolved.shallow[row]:
                closed = self.base.sample(self.quantity, self.components, x, y, depth, self.half_widths, solid)
                total += weight * _sum(closed, load)
            return total

        return superposed

    def about_points(self, number: int, x: FloatArray, y: FloatArray) -> FloatArray:
        """Coefficients at depth `number` and offsets x, y ``(m,)`` [m] of any place, ``(len(components), m)``."""
        self._check(x, y)
        resolved, row = self._places[number]
        total = resolved.smooth.about_points(self._rows, row, x, y, self.half_widths)
        for weight, solid, depth in resolved.band.kernels[row]:
            total += weight * self._closed(self.components, x, y, depth, solid)
        return total

    def _check(self, x: FloatArray, y: FloatArray) -> None:
        far = max(float(np.abs(x).max(initial=0.0)), float(np.abs(y).max(initial=0.0)))
        require(far <= self.reach * (1 + 1e-9), "layers", "offset", far, f"at most the reach, {self.reach:.6g} [m]")

    @property
    def _rows(self) -> list[int]:
        return [NAMES[self.quantity].index(name) for name in self.components]

    def _closed(
        self, components: tuple[str, ...], x: FloatArray, y: FloatArray, depth: FloatArray | float, solid: Material
    ) -> FloatArray:
        evaluate = self.base.displacement if self.quantity == "displacement" else self.base.stress
        return evaluate(components, x, y, depth, self.half_widths, solid)

    def _resolve(self, band: Band, smooth: SmoothField) -> _Resolved:
        """Field of a band, from disk or computed."""
        settings = (self.quantity, self.components, self.half_widths, self.reach, self.side, band, smooth.extent)
        tables, code = table_cache(), ("eigencontact.core.products", __name__, self.base, self.medium)
        key = address(self.base, self.medium, *settings, code=code) if tables else None
        arrays = tables.find(key, "resolution", "bounds", "radial") if tables and key else None
        if arrays is None:
            resolution, bounds = self._resolution(band, smooth)
            field = smooth.at(resolution)
            arrays = {"resolution": np.array(resolution), "bounds": bounds, "radial": smooth.radial(resolution)}
            deep = self._deep(band, field.nodes.x)
            arrays |= {"deep": deep} if deep is not None else {}
            if tables and key:
                tables.keep(key, arrays)
        else:
            field = smooth.of(arrays["radial"], float(arrays["resolution"]))
        self.bounds[list(band.numbers)] = arrays["bounds"]
        limit = DEEP * max(self.half_widths)
        shallow = [[kernel for kernel in kernels if kernel[2] <= limit] for kernels in band.kernels]
        return _Resolved(band, field, arrays.get("deep"), shallow)

    def _resolution(self, band: Band, smooth: SmoothField) -> tuple[float, FloatArray]:
        """Raise the resolution of a band until all its depths agree; that resolution, and bounds of their errors."""
        direct = DIRECT_COMPONENTS[self.base.traction][self.quantity]
        watched = (*self.components, *(() if direct in self.components else (direct,)))
        rows = [NAMES[self.quantity].index(name) for name in watched]
        x, y = (self._probes(half_width) for half_width in self.half_widths)
        closed = self._kernels(watched, band.kernels, x, y)
        coarse: FloatArray | None = None
        for resolution in RESOLUTIONS:
            nodal = smooth.at(resolution)
            fields = [nodal.on_cells(rows, number, x, y, self.half_widths) for number in range(len(band.depths))]
            fine = np.stack(fields, axis=1)
            if coarse is not None:
                largest = np.abs(fine + closed).max(axis=(0, 2, 3))
                change = np.abs(fine - coarse).max(axis=(0, 2, 3)) / largest
                if change.max() < TARGET:
                    break
            coarse = fine
        bound = 2 * change + self._rounding(band) / largest
        if not bound.max() < ACCEPTED:
            raise NotConverged(
                f"influence coefficients of medium {self.medium.key!r} ({self.quantity} at z = "
                f"{band.depths[int(bound.argmax())]:.3g} m) must agree to {ACCEPTED:.0e} between two resolutions (got "
                f"{bound.max():.1e}); join layers that are much thinner than the others, or bring the moduli nearer "
                "together"
            )
        return resolution, bound

    def _deep(self, band: Band, x: FloatArray) -> FloatArray | None:
        """Closed kernels of deep half-spaces on nodes, ``(len(components), nz, n, n)``, if any."""
        limit = DEEP * max(self.half_widths)
        deep = [[kernel for kernel in kernels if kernel[2] > limit] for kernels in band.kernels]
        return self._kernels(self.components, deep, x, x) if any(deep) else None

    def _kernels(
        self, components: tuple[str, ...], kernels: Sequence[Sequence[Kernel]], x: FloatArray, y: FloatArray
    ) -> FloatArray:
        """Sums of closed kernels, some for each depth, at all x and y, ``(len(components), nz, ny, nx)``."""
        out = np.zeros((len(components), len(kernels), y.size, x.size))
        rows_of: dict[Material, dict[float, list[tuple[int, float]]]] = {}
        for row, weight, solid, depth in (
            (row, *kernel) for row, row_kernels in enumerate(kernels) for kernel in row_kernels
        ):
            rows_of.setdefault(solid, {}).setdefault(depth, []).append((row, weight))
        for solid, places in rows_of.items():
            depths = list(places)
            step = max(1, TOGETHER // (x.size * y.size))
            for begin in range(0, len(depths), step):
                chunk = depths[begin : begin + step]
                fields = self._closed(components, x, y[:, None], np.array(chunk)[:, None, None], solid)
                for number, depth in enumerate(chunk):
                    for row, weight in places[depth]:
                        out[:, row] += weight * fields[:, number]
        return out

    def _probes(self, half_width: float) -> FloatArray:
        """Offsets at which two resolutions are compared: 0 and whole cells, near and far; 0 along a strip."""
        if half_width == np.inf:
            return np.zeros(1)
        cells = np.geomspace(1.0, max(self.reach / (2 * half_width), 1.0), PROBES)
        return np.append(0.0, 2 * half_width * np.unique(np.floor(cells)))

    def _rounding(self, band: Band) -> float:
        """Round-off of the corner sums of displacements on the lattice; that of stress is of order 1."""
        if self.quantity == "stress":
            return 0.0
        direct, origin = (DIRECT_COMPONENTS[self.base.traction][self.quantity],), np.zeros(1)
        limit = DEEP * max(self.half_widths)
        shallow = [solid for _, solid, depth in band.kernels[0] if depth <= limit]
        sums = sum(float(np.abs(self._closed(direct, origin, origin, 0.0, solid)).max()) for solid in shallow)
        finite = [half for half in self.half_widths if half < np.inf]
        return EPSILON * sums * (self.reach + max(finite)) / min(finite)


def _sum(table: FloatArray, load: FloatArray) -> FloatArray:
    return np.asarray(np.einsum("kij,ij->k", table, load))
