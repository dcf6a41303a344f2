"""What a contact along a line is made of, in plain numbers: half planes, a gap, friction, loads per length."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.fem.axisymmetric_mesh import Grid, build, graded_lines
from eigencontact_verification.fem.plane_strain import PlaneBody
from eigencontact_verification.fem.yielding_law import PointLaw, YieldingLaw

__all__ = ["LineBody", "LineContact", "LineStep"]

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class LineBody:
    """Half plane of one material.

    Attributes
    ----------
    young_modulus, poisson_ratio : float
        Moduli [Pa, 1], those of its law.
    law : PointLaw or None
        None: elastic.
    """

    young_modulus: float
    poisson_ratio: float
    law: PointLaw | None = None

    @property
    def compliance(self) -> float:
        """(1 - nu²) / E [1/Pa]."""
        return (1 - self.poisson_ratio**2) / self.young_modulus


@dataclass(frozen=True, kw_only=True)
class LineStep:
    """Loads at the end of an increment.

    Attributes
    ----------
    normal, shear : float
        Forces per length on body 1, along z into it and along x [N/m].
    bulk : (float, float)
        Remote stress xx of body 1 and body 2 [Pa].
    """

    normal: float
    shear: float = 0.0
    bulk: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True, kw_only=True)
class LineContact:
    """A half plane below another one, or below a rigid body.

    Attributes
    ----------
    bodies : (LineBody,) or (LineBody, LineBody)
        With one, the other is rigid.
    gap : callable
        Distance ``g(x)`` of the surfaces before any load, up to a constant [m]; takes and returns (n,).
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
        What sides and base do: "fixed", move as in a half plane under the forces at the origin and the remote stress;
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

    def grid(self) -> Grid:
        """Mesh of either body, (x, z)."""
        low, high = self.window
        sharp = [(edge, edge) for edge in self.edges]
        sizes = [self.fine] + [self.sharp] * len(sharp)
        x = graded_lines((-self.reach, low, 0.0, high, self.reach), [(low, high), *sharp], sizes, self.growth)
        z = graded_lines((0.0, self.reach), [(0.0, self.deep), *[(0.0, 0.0)] * len(sharp)], sizes, self.growth)
        return build(x, z, (), self.fine, self.divisions)

    def meshed(self) -> tuple[PlaneBody, ...]:
        """The bodies with their materials; body 2 is mirrored, its z too points into it."""
        grid = self.grid()
        shape = PlaneBody.points_of(grid).shape[1:]
        found = []
        for body in self.bodies:
            law = body.law or YieldingLaw(young_modulus=body.young_modulus, poisson_ratio=body.poisson_ratio)
            material, none = np.zeros(shape, dtype=np.int64), np.zeros((4, *shape))
            found.append(PlaneBody(grid=grid, laws=[law], material=material, prestrain=none))
        return tuple(found)

    def check(self, steps: tuple[LineStep, ...]) -> None:
        """Refuse loads that no equilibrium carries.

        Raises
        ------
        ValueError
            A negative normal force, a shear that is not below friction times it, or a stress of a rigid body.
        """
        for number, step in enumerate(steps, start=1):
            if not step.normal >= 0:
                raise ValueError(f"line step {number} normal must not be negative (got {step.normal}); use 0 to part")
            most = self.friction * step.normal
            if step.shear and not abs(step.shear) < most:
                raise ValueError(f"line step {number} |shear| must be below {most:g} (got {step.shear}); lower it")
            if len(self.bodies) == 1 and step.bulk[1]:
                raise ValueError(f"line step {number} bulk[1] must be 0, body 2 is rigid (got {step.bulk[1]}); drop it")
