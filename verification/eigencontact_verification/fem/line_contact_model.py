"""Data of a contact along a line, in plain numbers: half planes, a gap, friction, loads per length."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.fem.axisymmetric_mesh import Fit, Grid, build, graded_lines
from eigencontact_verification.fem.plane_strain import PlaneBody
from eigencontact_verification.fem.yielding_law import PointLaw, YieldingLaw

__all__ = ["LineBody", "LineContact", "LineStep", "PlaneRegion"]

FloatArray = NDArray[np.float64]
Pair = tuple[float, float]

#: Elements of the undivided mesh to the thickness of a layer, and to the width and height of another region.
_LAYER, _ACROSS = 2, 4
#: Young's modulus of a void, in units of the body's.
_VOID = 1e-10


@dataclass(frozen=True, kw_only=True)
class PlaneRegion:
    """Part of a half plane that has moduli, a law or an eigenstrain of its own; endless along y.

    Attributes
    ----------
    low, high : (x, z)
        Corners of the box around it; x is infinite for a layer.
    contains : callable or None
        ``contains(x, z)`` of a region that the mesh follows: below the surface, star-shaped about the middle of its
        box. None: it fills its box.
    young_modulus, poisson_ratio : float or None
        Moduli; None: those of the body. Young's modulus 0 makes a void (1e-10 of the body's).
    law : PointLaw or None
        None: elastic with these moduli, or made of what is around it if it gives none.
    eigenstrain : (xx, yy, zz, xz)
        Strain without stress, tensor components.
    """

    low: Pair
    high: Pair
    contains: Callable[[FloatArray, FloatArray], NDArray[np.bool_]] | None = None
    young_modulus: float | None = None
    poisson_ratio: float | None = None
    law: PointLaw | None = None
    eigenstrain: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        if not (self.low[0] < self.high[0] and 0 <= self.low[1] < self.high[1]):
            raise ValueError(f"region low, high must rise, with z >= 0 (got {self.low}, {self.high}); give (x, z)")
        if self.contains is not None and self.low[1] <= 0:
            raise ValueError(f"region with contains must lie below z = 0 (got z from {self.low[1]}); move it down")

    @property
    def sizes(self) -> Pair:
        """Largest elements along x and z in the undivided mesh."""
        width, height = self.high[0] - self.low[0], self.high[1] - self.low[1]
        return width / _ACROSS, height / (_LAYER if np.isinf(width) else _ACROSS)

    def inside(self, x: FloatArray, z: FloatArray) -> NDArray[np.bool_]:
        """Whether points lie in it."""
        if self.contains is not None:
            return np.asarray(self.contains(x, z), dtype=bool)
        (left, top), (right, bottom) = self.low, self.high
        return np.asarray((x > left) & (x < right) & (z > top) & (z < bottom))

    def own_law(self, body: LineBody) -> PointLaw | None:
        """Its material; None: that of what is around it."""
        if self.law is not None or (self.young_modulus is None and self.poisson_ratio is None):
            return self.law
        young = body.young_modulus if self.young_modulus is None else self.young_modulus
        nu = body.poisson_ratio if self.poisson_ratio is None else self.poisson_ratio
        return YieldingLaw(young_modulus=young or _VOID * body.young_modulus, poisson_ratio=nu)


@dataclass(frozen=True, kw_only=True)
class LineBody:
    """Half plane of one material, with regions.

    Attributes
    ----------
    young_modulus, poisson_ratio : float
        Moduli [Pa, 1], those of its law; below layers.
    law : PointLaw or None
        None: elastic.
    regions : tuple of PlaneRegion
        Where they overlap, eigenstrains add up and the last material counts.
    """

    young_modulus: float
    poisson_ratio: float
    law: PointLaw | None = None
    regions: tuple[PlaneRegion, ...] = ()

    @property
    def compliance(self) -> float:
        """(1 - nu²) / E [1/Pa]."""
        return (1 - self.poisson_ratio**2) / self.young_modulus

    @property
    def elastic(self) -> bool:
        """Whether no part of it has a law."""
        return self.law is None and all(region.law is None for region in self.regions)

    def stretched(self, z: FloatArray) -> FloatArray:
        """Remote stress xx at depths, in that of the substrate: layers share its strain, without strain yy."""
        stress = np.ones_like(z)
        for layer in self.regions:
            if np.isinf(layer.low[0]):
                young = self.young_modulus if layer.young_modulus is None else layer.young_modulus
                nu = self.poisson_ratio if layer.poisson_ratio is None else layer.poisson_ratio
                stress[(z > layer.low[1]) & (z < layer.high[1])] = young / (1 - nu**2) * self.compliance
        return stress

    def fits(self) -> list[Fit]:
        """Regions that the mesh follows."""
        return [
            Fit(contains=region.contains, low=region.low, high=region.high, mark=k, plane=True)
            for k, region in enumerate(self.regions)
            if region.contains is not None
        ]

    def boxes(self, axis: int) -> list[tuple[Pair, float]]:
        """Ends along x (0) or z (1) of the boxes that are meshed for its regions, and elements' size there."""
        fits = {fit.mark: fit.box for fit in self.fits()}
        boxes = []
        for k, region in enumerate(self.regions):
            low, high = fits.get(k, (region.low, region.high))
            if np.isfinite(low[axis]):
                boxes.append(((low[axis], high[axis]), region.sizes[axis]))
        return boxes

    def breaks(self) -> tuple[FloatArray, FloatArray]:
        """Places along x and z of the sides of regions that fill their boxes."""
        filled = [region for region in self.regions if region.contains is None]
        ends = [np.array([end[k] for region in filled for end in (region.low, region.high)]) for k in (0, 1)]
        along_x, along_z = (np.unique(end[np.isfinite(end)]) for end in ends)
        return along_x, along_z

    def on(self, grid: Grid) -> PlaneBody:
        """The body on a mesh of its own."""
        x, z = PlaneBody.points_of(grid)
        laws: list[PointLaw] = [
            self.law or YieldingLaw(young_modulus=self.young_modulus, poisson_ratio=self.poisson_ratio)
        ]
        material, prestrain = np.zeros(x.shape, dtype=np.int64), np.zeros((4, *x.shape))
        for k, region in enumerate(self.regions):
            fitted = np.broadcast_to((grid.marks == k)[:, None], x.shape)
            inside = region.inside(x, z) if region.contains is None else fitted
            prestrain[:, inside] += np.multiply(region.eigenstrain, (1, 1, 1, np.sqrt(2.0)))[:, None]
            law = region.own_law(self)
            if law is not None:
                material[inside] = len(laws)
                laws.append(law)
        return PlaneBody(grid=grid, laws=laws, material=material, prestrain=prestrain)

    def side(self, x: FloatArray, z: FloatArray) -> NDArray[np.int64]:
        """A bit for each region that holds the point."""
        bits = np.zeros(np.shape(x), dtype=np.int64)
        for k, region in enumerate(self.regions):
            bits += region.inside(x, z).astype(np.int64) << k
        return bits


@dataclass(frozen=True, kw_only=True)
class LineStep:
    """Loads at the end of an increment.

    Attributes
    ----------
    normal, shear : float
        Forces per length on body 1, along z into it and along x [N/m].
    bulk : (float, float)
        Remote stress xx of body 1 and body 2, of the substrate below layers [Pa].
    place : float
        Place x of the origin of the gap, and of the forces [m].
    """

    normal: float
    shear: float = 0.0
    bulk: tuple[float, float] = (0.0, 0.0)
    place: float = 0.0


@dataclass(frozen=True, kw_only=True)
class LineContact:
    """A half plane below another one, or below a rigid body.

    Attributes
    ----------
    bodies : (LineBody,) or (LineBody, LineBody)
        With one, the other is rigid.
    gap : callable
        Distance ``g(x)`` of the surfaces before any load, x from the place of the step, up to a constant [m]; takes and
        returns (n,).
    friction : float
        Coulomb's coefficient.
    window : (low, high)
        Interval of x where elements keep the size `fine` and contact is looked for [m]; the origin lies within.
    fine, deep : float
        That size, and the depth to which it is kept [m].
    edges : tuple of float
        Places x in the window where contact or stick ends, and tractions fall as a root [m].
    sharp : float
        Size of elements there and at the surface [m]; less than `fine`.
    reach : float
        Half width and depth of the mesh [m].
    growth : float
        Ratio of neighbouring elements beyond.
    divisions : int
        Parts of every element each way.
    outer : str
        What sides and base do: "fixed", move as in a half plane under the forces of the step and the remote stress;
        "free", have the traction of that field.

    Raises
    ------
    ValueError
        A number out of its range.
    """

    bodies: tuple[LineBody, ...]
    gap: Callable[[FloatArray], FloatArray]
    window: tuple[float, float]
    fine: float
    reach: float
    friction: float = 0.0
    deep: float = 0.0
    edges: tuple[float, ...] = ()
    sharp: float = 0.0
    growth: float = 1.5
    divisions: int = 1
    outer: str = "fixed"

    def __post_init__(self) -> None:
        low, high = self.window
        if len(self.bodies) not in {1, 2}:
            raise ValueError(f"line contact bodies must be one or two (got {len(self.bodies)}); leave out a rigid one")
        if not -self.reach < low < 0 < high < self.reach:
            numbers = (-self.reach, low, 0.0, high, self.reach)
            raise ValueError(f"line contact -reach, window, reach must rise around 0 (got {numbers}); raise reach")
        if not 0 < self.fine <= high - low:
            raise ValueError(f"line contact fine must be in (0, {high - low:g}] (got {self.fine}); lower it")
        if not self.friction >= 0:
            raise ValueError(f"line contact friction must not be negative (got {self.friction}); use 0 for none")
        if self.outer not in {"fixed", "free"}:
            raise ValueError(f"line contact outer must be 'fixed' or 'free' (got {self.outer!r}); choose one")

    @property
    def contact_modulus(self) -> float:
        """1 / Σ (1 - nu²)/E [Pa]."""
        return 1 / sum(body.compliance for body in self.bodies)

    def grid(self, body: LineBody) -> Grid:
        """Mesh of a body, (x, z), z into it; the lines along z are those of both bodies, so that their nodes face."""
        low, high = self.window
        sharp = [(edge, edge) for edge in self.edges]
        lines = []
        for axis, fixed, uniform, bodies in (
            (0, [-self.reach, low, 0.0, high, self.reach], (low, high), self.bodies),
            (1, [0.0, self.reach], (0.0, self.deep), (body,)),
        ):
            boxes = [box for solid in bodies for box in solid.boxes(axis)]
            fine = [uniform, *(sharp if axis == 0 else [(0.0, 0.0)] * len(sharp)), *(ends for ends, _ in boxes)]
            sizes = [self.fine, *[self.sharp] * len(sharp), *(min(size, self.fine) for _, size in boxes)]
            lines.append(graded_lines([*fixed, *(end for ends, _ in boxes for end in ends)], fine, sizes, self.growth))
        fitted = [min(*region.sizes, self.fine) for region in body.regions if region.contains is not None]
        return build(lines[0], lines[1], body.fits(), min(fitted, default=self.fine), self.divisions)

    def meshed(self) -> tuple[PlaneBody, ...]:
        """The bodies with their materials; body 2 is mirrored, its z too points into it."""
        return tuple(body.on(self.grid(body)) for body in self.bodies)

    def check(self, steps: tuple[LineStep, ...]) -> None:
        """Refuse loads that no equilibrium carries.

        Raises
        ------
        ValueError
            A negative normal force, a shear that is not below friction times it, a stress of a rigid body, or a gap
            that travels out of the window or under friction.
        """
        for number, step in enumerate(steps, start=1):
            if not step.normal >= 0:
                raise ValueError(f"line step {number} normal must not be negative (got {step.normal}); use 0 to part")
            if step.place and self.friction:
                raise ValueError(f"line step {number} place must be 0 with friction (got {step.place}); leave out one")
            if not self.window[0] < step.place < self.window[1]:
                raise ValueError(f"line step {number} place must be in {self.window} (got {step.place}); widen it")
            most = self.friction * step.normal
            if step.shear and not abs(step.shear) < most:
                raise ValueError(f"line step {number} |shear| must be below {most:g} (got {step.shear}); lower it")
            if len(self.bodies) == 1 and step.bulk[1]:
                raise ValueError(f"line step {number} bulk[1] must be 0, body 2 is rigid (got {step.bulk[1]}); drop it")
