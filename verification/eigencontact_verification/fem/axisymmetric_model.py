"""Data of an axisymmetric finite-element model: bodies of revolution about the z axis, in the half plane (r, z).

Conventions: z into the body, the body is z >= 0 and its surface z = 0; stress positive in tension, pressure positive in
compression; eigenstrain positive in expansion, ``stress = C : (strain - eigenstrain)``. Any consistent units.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.fem.axisymmetric_cells import CellField, CellPressure
from eigencontact_verification.fem.axisymmetric_mesh import Fit, Grid, build, graded_lines

__all__ = ["AxisymmetricLayer", "AxisymmetricModel", "AxisymmetricRegion", "Disc"]

FloatArray = NDArray[np.float64]
Contains = Callable[[FloatArray, FloatArray], NDArray[np.bool_]]
Pair = tuple[float, float]

#: Young's modulus of a void, in units of the body's.
_VOID = 1e-10


def _require(holds: bool, where: str, rule: str, value: object, hint: str) -> None:  # noqa: FBT001
    if not holds:
        raise ValueError(f"{where} must be {rule} (got {value}); {hint}")


def _check_moduli(where: str, young_modulus: float, poisson_ratio: float) -> None:
    _require(young_modulus > 0, f"{where} young_modulus", "positive", young_modulus, "give it in units of stress")
    inside = -1 < poisson_ratio < 0.5
    _require(inside, f"{where} poisson_ratio", "above -1 and below 0.5", poisson_ratio, "take 0.499 for near 0.5")


@dataclass(frozen=True, kw_only=True)
class AxisymmetricRegion:
    """Part of the body with a uniform eigenstrain, with moduli of its own, or with both.

    Attributes
    ----------
    contains : callable
        ``contains(r, z)`` -> bool array, for arrays of one shape.
    bounds : ((r, z), (r, z))
        Low and high corner that enclose the region; they become lines of the mesh unless the region is fitted.
    eigenstrain : (e_r, e_z)
        ``e_rr = e_tt`` and ``e_zz``.
    young_modulus, poisson_ratio : float or None
        Moduli; None: those of the body around it. Young's modulus 0 makes a void (1e-10 of the body's).
    fitted : bool
        Whether the mesh follows the boundary. It must lie below the surface and be star-shaped about the centre of
        its bounds (about the axis' point at that depth if it meets the axis); move one that touches the surface down
        by 1e-6 of its size. If not fitted, elements that the boundary cuts are integrated on sub-cells: fair for
        displacement, of first order at best for the stress inside and beside them. A region that fills its bounds (a
        cylinder) cuts no element and needs no fit.
    """

    contains: Contains
    bounds: tuple[Pair, Pair]
    eigenstrain: Pair = (0.0, 0.0)
    young_modulus: float | None = None
    poisson_ratio: float | None = None
    fitted: bool = False

    def __post_init__(self) -> None:
        low, high = self.bounds
        ordered = 0 <= low[0] < high[0] and 0 <= low[1] < high[1]
        _require(ordered, "region bounds", "(low, high) with 0 <= low < high", self.bounds, "give (r, z) of both")
        if self.fitted:
            gap = low[1] > 1e-9 * (high[1] - low[1])
            _require(gap, "fitted region bounds", "below the surface z = 0", self.bounds, "use fitted=False")

    def strain_at(self, r: FloatArray, z: FloatArray) -> FloatArray:  # noqa: ARG002
        """Eigenstrain e_rr, e_tt, e_zz, e_rz at points (n,), as ``(4, n)``; a region may vary it."""
        e_r, e_z = self.eigenstrain
        return np.broadcast_to(np.array([[e_r], [e_r], [e_z], [0.0]]), (4, r.size))


@dataclass(frozen=True, kw_only=True)
class Disc:
    """Pressure on the surface within a circle about the axis.

    Attributes
    ----------
    radius : float
        Radius a of the circle.
    pressure : float
        Pressure p0, positive in compression: everywhere ("uniform") or in the middle ("hertz").
    profile : str
        "uniform", or "hertz" for ``p0 sqrt(1 - r^2/a^2)``.
    """

    radius: float
    pressure: float
    profile: str = "uniform"

    def __post_init__(self) -> None:
        _require(self.radius > 0, "disc radius", "positive", self.radius, "give the radius of the loaded circle")
        valid = self.profile in {"uniform", "hertz"}
        _require(valid, "disc profile", "'uniform' or 'hertz'", repr(self.profile), "superpose discs for others")

    @property
    def load(self) -> float:
        """Resultant force, positive into the body."""
        return float((1.0 if self.profile == "uniform" else 2 / 3) * np.pi * self.radius**2 * self.pressure)


@dataclass(frozen=True, kw_only=True)
class AxisymmetricLayer:
    """Layer on the substrate (or the next layer); the first one is bounded by the surface."""

    thickness: float
    young_modulus: float
    poisson_ratio: float

    def __post_init__(self) -> None:
        _require(self.thickness > 0, "layer thickness", "positive", self.thickness, "leave the layer out")
        _check_moduli("layer", self.young_modulus, self.poisson_ratio)


@dataclass(frozen=True, kw_only=True)
class AxisymmetricModel:
    """A cylinder of radius and height ``reach`` that stands for a half-space.

    Attributes
    ----------
    young_modulus, poisson_ratio : float
        Moduli of the body (of the substrate under layers).
    regions, discs, layers, cells : tuples
        Where regions overlap eigenstrains add up and the last one's moduli hold; the eigenstrains of cells add to
        them, and what cells keep of the stiffness multiplies it.
    reach : float
        Radius and depth of the mesh.
    outer : str
        Side r = reach and base z = reach: "fixed" (no displacement) or "free" (no traction, save a uniform one on the
        base that balances the discs; u_z is zero on the edge between side and base).
    far_field : bool
        The discs' resultant as a point force on a half-space of the body's moduli gives the outer boundary its
        displacement ("fixed") or its traction ("free", with the shift on which that traction does the same work). The
        surface's u_z is then in error like reach^-3, without like 1 / reach. No effect without discs.
    fine : float
        Element size within the regions' bounds and the discs and at ``lines``.
    growth : float
        Ratio of neighbouring sizes away from there.
    divisions : int
        Parts of every element each way: 1, 2, 4 are a family of meshes of ratio 2.
    lines : ((r, ...), (z, ...))
        More lines of the mesh, with fine elements beside them.
    remote_stress : (s_rr = s_tt, s_zz) or None
        Uniform stress far away; the surface then bears the traction that belongs to it. The solution's displacement is
        the disturbance by the regions alone, its stress the whole stress.
    """

    young_modulus: float
    poisson_ratio: float
    reach: float
    fine: float
    regions: tuple[AxisymmetricRegion, ...] = ()
    discs: tuple[Disc | CellPressure, ...] = ()
    layers: tuple[AxisymmetricLayer, ...] = ()
    cells: tuple[CellField, ...] = ()
    outer: str = "fixed"
    far_field: bool = False
    growth: float = 1.3
    divisions: int = 1
    lines: tuple[tuple[float, ...], tuple[float, ...]] = ((), ())
    remote_stress: Pair | None = None

    def __post_init__(self) -> None:
        _check_moduli("model", self.young_modulus, self.poisson_ratio)
        _require(self.outer in {"fixed", "free"}, "model outer", "'fixed' or 'free'", repr(self.outer), "choose one")
        _require(0 < self.fine <= self.reach, "model fine", "positive, at most reach", self.fine, "reduce it")
        _require(1 < self.growth <= 4, "model growth", "above 1, at most 4", self.growth, "1.3 is usual")
        _require(self.divisions >= 1, "model divisions", "at least 1", self.divisions, "1, 2, 4 are a family")
        far = [*(x for region in self.regions for x in region.bounds[1]), *(disc.radius for disc in self.discs)]
        far += [x for cells in self.cells for x in cells.bounds[1]]
        far += [sum(layer.thickness for layer in self.layers), *self.lines[0], *self.lines[1]]
        _require(
            max(far) < self.reach,
            "model reach",
            "beyond all regions, discs, layers, cells, lines",
            self.reach,
            "raise it",
        )
        for k, region in enumerate(self.regions):
            if region.poisson_ratio is not None:
                _check_moduli(f"region {k}", 1.0, region.poisson_ratio)
            if region.young_modulus is not None:
                stiff = region.young_modulus >= 0
                _require(stiff, f"region {k} young_modulus", "not negative", region.young_modulus, "0 is a void")
        allowed = self.remote_stress is None or not self.layers
        _require(allowed, "model remote_stress", "None with layers", self.remote_stress, "superpose it by hand")

    @property
    def load(self) -> float:
        """Resultant force of the discs, positive into the body."""
        return sum(disc.load for disc in self.discs)

    def fits(self) -> list[Fit]:
        """Regions that the mesh follows."""
        numbered = enumerate(self.regions)
        return [Fit(contains=x.contains, low=x.bounds[0], high=x.bounds[1], mark=k) for k, x in numbered if x.fitted]

    def interfaces(self) -> FloatArray:
        """Depths of the lower sides of the layers, (layers,)."""
        return np.cumsum([layer.thickness for layer in self.layers]) if self.layers else np.zeros(0)

    def grid(self) -> Grid:
        """Mesh of the model."""
        fits = self.fits()
        fine: tuple[list[Pair], list[Pair]] = ([], [])
        fixed: tuple[list[float], list[float]] = ([0.0, self.reach], [0.0, self.reach])
        for region in self.regions:
            for k in (0, 1):
                fine[k].append((region.bounds[0][k], region.bounds[1][k]))
                if not region.fitted:
                    fixed[k].extend(fine[k][-1])
        for fit in fits:
            for k in (0, 1):
                fixed[k].extend((fit.box[0][k], fit.box[1][k]))
                fine[k].append((fit.box[0][k], fit.box[1][k]))
        for cells in self.cells:
            fine[0].append((0.0, cells.bounds[1][0]))
            fixed[0].append(cells.bounds[1][0])
            fine[1].append((cells.bounds[0][1], cells.bounds[1][1]))
            fixed[1].extend(cells.lines)
        for disc in self.discs:
            fine[0].append((0.0, disc.radius))
            fixed[0].append(disc.radius)
            fine[1].append((0.0, 0.0))
        for k in (0, 1):
            fine[k].extend((x, x) for x in self.lines[k])
            fixed[k].extend(self.lines[k])
        fixed[1].extend(self.interfaces())
        for fit in fits:
            crossed = [x for x in self.interfaces() if fit.box[0][1] < x < fit.box[1][1]]
            _require(not crossed, "interface beside a fitted region", f"outside {fit.box}", crossed, "use fitted=False")
        r, z = (graded_lines(fixed[k], fine[k] or [(0.0, 0.0)], self.fine, self.growth) for k in (0, 1))
        return build(r, z, fits, self.fine, self.divisions)

    def material(self, r: FloatArray, z: FloatArray, grid: Grid, element: NDArray[np.int64]) -> FloatArray:
        """Young's modulus, Poisson's ratio, eigenstrain e_rr, e_tt, e_zz and e_rz at points, (6, ...).

        Parameters
        ----------
        r, z : (n, ...)
            Points; the first axis is that of ``element``.
        grid : Grid
            Mesh of this model.
        element : (n,)
            Element that each row of points lies in; decides on the side of an interface or of a fitted boundary.
        """
        rows = (slice(None), *(None,) * (r.ndim - 1))
        layer = np.searchsorted(self.interfaces(), grid.centres[1, element])
        young = np.array([*(x.young_modulus for x in self.layers), self.young_modulus])
        nu = np.array([*(x.poisson_ratio for x in self.layers), self.poisson_ratio])
        out = np.zeros((6, *r.shape))
        out[0], out[1] = young[layer][rows], nu[layer][rows]
        for k, region in enumerate(self.regions):
            if region.fitted:
                inside = np.broadcast_to((grid.marks[element] == k)[rows], r.shape)
            else:
                inside = np.asarray(region.contains(r, z), dtype=bool)
            out[2:, inside] += region.strain_at(r[inside], z[inside])
            if region.young_modulus is not None:
                out[0, inside] = region.young_modulus or _VOID * self.young_modulus
            if region.poisson_ratio is not None:
                out[1, inside] = region.poisson_ratio
        for cells in self.cells:
            eigenstrain, stiffness = cells.at(r, z)
            out[2:] += eigenstrain
            out[0] *= stiffness
        return out
