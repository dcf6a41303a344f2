"""Data of an elastic-plastic indentation: a half-space with regions that yield, below a body of revolution."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.fem.axisymmetric_mesh import Fit, Grid, build, graded_lines
from eigencontact_verification.fem.axisymmetric_model import AxisymmetricRegion
from eigencontact_verification.fem.yielding_body import YieldingBody
from eigencontact_verification.fem.yielding_law import PointLaw, YieldingLaw

__all__ = ["Indentation", "YieldingRegion"]

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class YieldingRegion(AxisymmetricRegion):
    """Region with a law of its own; without one it is elastic with its moduli, or made of what is around it.

    Attributes
    ----------
    law : PointLaw or None
        Material.
    """

    law: PointLaw | None = None


@dataclass(frozen=True, kw_only=True)
class Indentation:
    """A half-space of one material, with regions, below a rigid body of revolution.

    Attributes
    ----------
    young_modulus, poisson_ratio : float
        Moduli of the body, those of its law.
    law : PointLaw or None
        Material of the body; None: elastic.
    radius : float
        Of the sphere; of another profile that of a sphere which is as wide where contact may end.
    profile : callable or None
        Height ``h(r)`` of the rigid body above its lowest point, 0 at r = 0; None: the parabola r²/2R.
    fine, extent : float
        Element size, and the radius and depth within which it is kept; contact is looked for there and no farther.
    inner, deep : float
        The size is kept from the radius `inner` on only, and to this depth; None: to `extent`.
    reach : float
        Radius and depth of the mesh.
    regions : tuple of YieldingRegion
        Where they overlap, eigenstrains add up and the last material counts. One whose boundary is not fitted takes
        the integration points that lie in it; layers and cylinders are exact in that.
    outer, growth, divisions
        See `AxisymmetricModel`.
    friction : float
        Friction coefficient between the body and the sphere, Coulomb's law.
    lines : tuple of float
        More radii at which the mesh has lines: where the profile changes its form.
    """

    young_modulus: float
    poisson_ratio: float
    radius: float
    fine: float
    extent: float
    reach: float
    law: PointLaw | None = None
    regions: tuple[YieldingRegion, ...] = ()
    profile: Callable[[FloatArray], FloatArray] | None = None
    outer: str = "fixed"
    growth: float = 1.3
    divisions: int = 1
    lines: tuple[float, ...] = ()
    inner: float = 0.0
    deep: float | None = None
    friction: float = 0.0

    def __post_init__(self) -> None:
        if not 0 < self.fine < self.extent < self.reach:
            lengths = (self.fine, self.extent, self.reach)
            raise ValueError(f"indentation fine, extent, reach must rise from 0 (got {lengths}); raise the later ones")
        if not 0 <= self.inner < self.extent:
            raise ValueError(f"indentation inner must be in [0, extent) (got {self.inner}); lower it")
        if self.friction < 0:
            raise ValueError(f"indentation friction must not be negative (got {self.friction}); 0 is none")
        if self.outer not in {"fixed", "free"}:
            raise ValueError(f"indentation outer must be 'fixed' or 'free' (got {self.outer!r}); choose one")

    @property
    def contact_modulus(self) -> float:
        """E / (1 - nu²)."""
        return self.young_modulus / (1 - self.poisson_ratio**2)

    def height(self, r: FloatArray) -> FloatArray:
        """Of the rigid body above its lowest point, at radii (n,)."""
        return r**2 / (2 * self.radius) if self.profile is None else self.profile(r)

    def hertz_depth(self, load: float) -> float:
        """Depth in an elastic body."""
        return float((9 * load**2 / (16 * self.contact_modulus**2 * self.radius)) ** (1 / 3))

    def grid(self) -> Grid:
        """Mesh of the model."""
        numbered = enumerate(self.regions)
        fits = [Fit(contains=x.contains, low=x.bounds[0], high=x.bounds[1], mark=k) for k, x in numbered if x.fitted]
        lines = []
        for k in (0, 1):
            fixed = [
                0.0,
                self.extent,
                self.reach,
                *(x.bounds[i][k] for x in self.regions if not x.fitted for i in (0, 1)),
            ]
            fixed += [fit.box[i][k] for fit in fits for i in (0, 1)]
            fixed += self.lines if k == 0 else ()
            uniform = (self.inner, self.extent) if k == 0 else (0.0, self.extent if self.deep is None else self.deep)
            fine = [uniform, *((fit.box[0][k], fit.box[1][k]) for fit in fits)]
            lines.append(graded_lines(fixed, fine, self.fine, self.growth))
        return build(lines[0], lines[1], fits, self.fine, self.divisions)

    def body(self) -> YieldingBody:
        """Mesh with the materials in it."""
        grid = self.grid()
        r, z = YieldingBody.points_of(grid)
        around = YieldingLaw(young_modulus=self.young_modulus, poisson_ratio=self.poisson_ratio)
        laws: list[PointLaw] = [self.law or around]
        material, prestrain = np.zeros(r.shape, dtype=np.int64), np.zeros((4, *r.shape))
        for k, region in enumerate(self.regions):
            marked = (grid.marks == k)[:, None]
            inside = np.broadcast_to(marked, r.shape) if region.fitted else np.asarray(region.contains(r, z))
            e_r, e_z = region.eigenstrain
            prestrain[:3, inside] += np.array([e_r, e_r, e_z])[:, None]
            law = region.law
            if law is None and (region.young_modulus is not None or region.poisson_ratio is not None):
                young = self.young_modulus if region.young_modulus is None else region.young_modulus
                nu = self.poisson_ratio if region.poisson_ratio is None else region.poisson_ratio
                law = YieldingLaw(young_modulus=young, poisson_ratio=nu)
            if law is not None:
                material[inside] = len(laws)
                laws.append(law)
        return YieldingBody(grid=grid, laws=laws, material=material, prestrain=prestrain)
