"""The kind *constitutive law*: the stress that a strain causes in a material, and its history."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import ClassVar, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.arrays import FloatArray
from eigencontact.core.elasticity import factors_of_stiffness
from eigencontact.plugin.component import Component

__all__ = [
    "ConstitutiveLaw",
    "HasCellAnswer",
    "LawStep",
    "LinearLaw",
    "Response",
    "Surroundings",
    "Variable",
]


@dataclass(frozen=True, slots=True)
class Variable:
    """Internal variable of a material point; zero at rest.

    Attributes
    ----------
    unit : str
        SI unit, ``"1"`` for a number.
    meaning : str
        Description, stored with the values.
    components : int
        Numbers per point; 6 is a Mandel vector.
    elastic : bool
        True if the variable also changes in the elastic range. The cells of a body are sufficient as long as no other
        variable has changed in the outermost cells.
    largest, extent : str
        Names of two numbers of every step: the largest value in the bodies, and the volume [m^3] with nonzero values. A
        number without a name is not computed.
    total : (str, str), optional
        Name and SI unit of its integral over the volume.

    Examples
    --------
    >>> Variable(unit="1", meaning="equivalent plastic strain", largest="max_plastic_strain").components
    1
    """

    unit: str
    meaning: str
    components: int = 1
    elastic: bool = False
    largest: str = ""
    extent: str = ""
    total: tuple[str, str] | None = None


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class LawStep:
    """Points and time of an evaluation of a law.

    Attributes
    ----------
    x, y, z : (n,) float64
        Coordinates of the points [m], z into the body.
    time, duration : float
        End of the load increment, in load steps (1 ends the first), and its length.
    means : mapping of str to (components, n) float64
        Means over the neighbourhood of each point, of the variables in `ConstitutiveLaw.averaged`, at the end of the
        increment. Empty without a neighbourhood: the law then uses the value of the point.

    Examples
    --------
    >>> step = LawStep(x=np.zeros(3), y=np.zeros(3), z=np.arange(3.0), time=1.0, duration=0.5)
    >>> step.of(slice(1, None)).z.tolist()
    [1.0, 2.0]
    """

    x: FloatArray
    y: FloatArray
    z: FloatArray
    time: float
    duration: float
    means: Mapping[str, FloatArray] = field(default_factory=dict)

    def of(self, points: slice | NDArray[np.intp]) -> LawStep:
        """The same of some of the points."""
        means = {name: values[:, points] for name, values in self.means.items()}
        return replace(self, x=self.x[points], y=self.y[points], z=self.z[points], means=means)


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Response:
    """Stress, tangent and history of an evaluation of a law.

    Attributes
    ----------
    stress : (6, n) float64
        Mandel stress [Pa], positive in tension.
    tangent : (6, 6, n) or (6, 6) float64
        Derivative of the stress by the strain [Pa]; a single matrix applies to all points.
    variables : mapping of str to (components, n) float64
        Internal variables after the increment, with the names that the law declares.

    Examples
    --------
    >>> stiffness = np.eye(6)
    >>> Response(stress=stiffness @ np.zeros((6, 4)), tangent=stiffness).variables
    {}
    """

    stress: FloatArray
    tangent: FloatArray
    variables: Mapping[str, FloatArray] = field(default_factory=dict)


class ConstitutiveLaw(Component, ABC):
    """Stress of a total strain, at any number of points at once.

    A law is a pure function: equal arguments lead to equal results, and the law does not change its arguments. The
    solver calls it several times within an increment, always with the variables before the increment.

    Attributes
    ----------
    variables : mapping of str to Variable
        Class attribute; internal variables of a point, stored with every accepted step.
    symmetric : bool
        Class attribute; True if the tangent is symmetric.
    isotropic : bool
        Class attribute; True if the material has no preferred directions. Preferred directions are fields with the
        annotation `Direction` or `Rotation`: a rotation of directions, strain and variables rotates the stress.
    advice : str
        Class attribute; remedy in messages about cells without a solution, or with several solutions.

    Examples
    --------
    >>> class Rubber(ConstitutiveLaw):
    ...     key, isotropic = "rubber", True
    ...     def update(self, strain, before, step):
    ...         stiffness = 2e6 * np.eye(6)
    ...         return Response(stress=stiffness @ strain, tangent=stiffness)
    >>> step = LawStep(x=np.zeros(1), y=np.zeros(1), z=np.ones(1), time=1.0, duration=1.0)
    >>> Rubber().update(np.full((6, 1), 1e-3), {}, step).stress[:, 0].tolist()
    [2000.0, 2000.0, 2000.0, 2000.0, 2000.0, 2000.0]
    """

    kind: ClassVar[str] = "constitutive-law"
    variables: ClassVar[Mapping[str, Variable]] = {}
    symmetric: ClassVar[bool] = True
    isotropic: ClassVar[bool] = False
    advice: ClassVar[str] = "give it a law that softens less"

    @abstractmethod
    def update(self, strain: FloatArray, before: Mapping[str, FloatArray], step: LawStep) -> Response:
        """Stress, tangent and variables at the end of an increment.

        Parameters
        ----------
        strain : (6, n)
            Mandel strain at the end of the increment, minus the prestrain of the material [-].
        before : mapping of str to (components, n)
            Variables at the start of the increment.
        step : LawStep
            Coordinates of the points, and time.

        Raises
        ------
        NotUnique
            Points that soften so fast that a strain has several stresses; `NotConverged` for other reasons.
        """

    def of_body(self, young_modulus: float, poisson_ratio: float) -> ConstitutiveLaw:  # noqa: ARG002
        """Law in a body with these constants [Pa], [-]; constants of the law take precedence. By default the law."""
        return self

    def at(self, x: FloatArray, y: FloatArray, z: FloatArray) -> ConstitutiveLaw:  # noqa: ARG002
        """Law of the points x, y, z, each ``(n,)`` [m], whose constants depend on the place; by default the law itself.

        The law that is returned is asked for those points only, in that order.
        """
        return self

    def laws_at(
        self, x: FloatArray, y: FloatArray, z: FloatArray  # noqa: ARG002
    ) -> Sequence[tuple[ConstitutiveLaw, NDArray[np.bool_]]]:  # fmt: skip
        """Laws of a composite, and which of the points ``(n,)`` [m] have each law: every point has one."""
        return [(self, np.ones(np.shape(z), dtype=bool))]

    @property
    def averaged(self) -> Mapping[str, float]:
        """Radius R [m] of the neighbourhood of each nonlocal variable; none by default.

        In a softening material, strain localises in a single layer of cells unless the law has a length. The
        mean over all points q of the same material about a point p is ``sum w(|p - q|) v(q) / sum w(|p - q|)`` with the
        bell ``w(r) = (1 - r²/R²)²`` for r < R: a constant keeps its value up to surfaces and interfaces, and as the
        weights are constant the mean of a variable that never falls never falls.

        The means are unknowns of the step, solved together with the eigenstrain. A law uses `LawStep.means` as
        constants, also in its tangent, and returns the variables from which the next means are computed. At convergence
        both agree to the tolerance of the scene.

        References
        ----------
        G. Pijaudier-Cabot, Z. P. Bazant 1987, J. Eng. Mech. 113, 1512; Z. P. Bazant, M. Jirasek 2002, J. Eng. Mech.
        128, 1119.
        """
        return {}

    @property
    def linear(self) -> bool:
        """Whether the law is elastic, with constants that may depend on the place."""
        origin = np.zeros(1)
        return isinstance(self.at(origin, origin, origin), LinearLaw)

    @property
    def varies(self) -> bool:
        """Whether the constants depend on the place, or differ between the laws of a composite."""
        kind = type(self)
        return kind.at is not ConstitutiveLaw.at or kind.laws_at is not ConstitutiveLaw.laws_at

    @property
    def words(self) -> str:
        """Material of a region in the text of `explain`: "cells of ..."."""
        return f"{self.key} material"


class LinearLaw(ConstitutiveLaw):
    """Linear elasticity: stress is stiffness times strain, without internal variables.

    A subclass defines one method. A law with infinite stiffness (incompressible, rigid) also defines `factors`, the
    only method that the solvers use.

    Examples
    --------
    >>> class Gel(LinearLaw):
    ...     key = "gel"
    ...     def stiffness_matrix(self):
    ...         return np.diag([3e6, 3e6, 3e6, 1e6, 1e6, 1e6])
    >>> soft, stiff = Gel().factors(1e6)
    >>> bool(np.allclose(stiff + 2e6 * soft, np.eye(6)))
    True
    """

    @abstractmethod
    def stiffness_matrix(self) -> FloatArray:
        """Mandel stiffness ``(6, 6)`` [Pa], symmetric, without negative eigenvalues; ``(n, 6, 6)`` of n points.

        Raises
        ------
        SceneError
            A stiffness that is not finite.
        """

    def factors(self, shear_modulus: float) -> tuple[FloatArray, FloatArray]:
        """``soft = (C + 2G)^-1`` [1/Pa] and ``stiff = C soft`` [-], each ``(6, 6)`` or ``(n, 6, 6)``.

        C is the stiffness, G = `shear_modulus` [Pa] the shear modulus of the surrounding material. Both factors are
        bounded and symmetric for every material, from a void to a rigid one, and ``stiff + 2 G soft`` is the unit
        matrix.
        """
        return factors_of_stiffness(self.stiffness_matrix(), shear_modulus)

    def update(self, strain: FloatArray, before: Mapping[str, FloatArray], step: LawStep) -> Response:  # noqa: ARG002
        """See `ConstitutiveLaw.update`."""
        stiffness = self.stiffness_matrix()
        if stiffness.ndim == 2:
            return Response(stress=stiffness @ strain, tangent=stiffness)
        tangent = np.ascontiguousarray(np.moveaxis(stiffness, 0, 2))
        return Response(stress=np.einsum("ijn,jn->in", tangent, strain), tangent=tangent)


@dataclass(frozen=True, kw_only=True, slots=True)
class Surroundings:
    """Elastic material around a cell: its stiffness by the field of a ball with an eigenstrain.

    The deviatoric stress of a cell is ``s = s_f - κ e``, its mean stress ``m = m_f - κ_v e_m``: what the others cause,
    less what its own eigenstrain takes away (J. D. Eshelby 1957). Its strain is that of the stress in the material
    around, and e. A law in its place is driven by the strain ``s_f / κ`` through a further compliance 1/κ - 1/2G.

    Attributes
    ----------
    young_modulus, poisson_ratio : float
        E [Pa] and ν [-] of the material around.

    Examples
    --------
    >>> around = Surroundings(young_modulus=2.6, poisson_ratio=0.3)
    >>> round(around.shear_stiffness, 4), round(around.bulk_stiffness, 4)
    (1.0476, 2.4762)
    """

    young_modulus: float
    poisson_ratio: float

    @property
    def shear_stiffness(self) -> float:
        """κ = 2G (7 - 5ν) / (15 (1 - ν)) [Pa]."""
        nu = self.poisson_ratio
        return self.young_modulus / (1.0 + nu) * (7.0 - 5.0 * nu) / (15.0 * (1.0 - nu))

    @property
    def bulk_stiffness(self) -> float:
        """κ_v = 2E / (3 (1 - ν)) [Pa]: mean stress by mean eigenstrain (a third of the trace)."""
        return 2.0 * self.young_modulus / (3.0 * (1.0 - self.poisson_ratio))

    @property
    def shear_give(self) -> float:
        """1/κ - 1/2G [1/Pa]."""
        return 1.0 / self.shear_stiffness - self.shear_compliance

    @property
    def bulk_give(self) -> float:
        """1/κ_v - 1/3K [1/Pa]."""
        return 1.0 / self.bulk_stiffness - self.bulk_compliance

    @property
    def shear_compliance(self) -> float:
        """1/2G [1/Pa]."""
        return 0.5 / (self.young_modulus / (2.0 * (1.0 + self.poisson_ratio)))

    @property
    def bulk_compliance(self) -> float:
        """1/3K [1/Pa]; zero where the material is incompressible."""
        E, nu = self.young_modulus, self.poisson_ratio
        return 1.0 / (3.0 * (E / (3.0 * (1.0 - 2.0 * nu)))) if nu < 0.5 else 0.0


@runtime_checkable
class HasCellAnswer(Protocol):
    """Optional ability of a law: response of cells in an elastic body, faster than Newton's method on `update`.

    The method is the local step of an iteration. Any response leads to the same result: at convergence the stress is
    that of `update` for the strain.
    """

    def cell_answer(
        self,
        foreign: FloatArray,
        prestrain: FloatArray,
        around: Surroundings,
        before: Mapping[str, FloatArray],
        step: LawStep,
    ) -> tuple[FloatArray, Mapping[str, FloatArray]]:
        """Eigenstrain and history of cells.

        Parameters
        ----------
        foreign : (6, n)
            Mandel stress by all other cells and loads [Pa].
        prestrain : (6, n)
            Strain without stress of the material [-].
        around : Surroundings
        before, step
            See `ConstitutiveLaw.update`.

        Returns
        -------
        eigenstrain : (6, n)
            Strain minus the elastic strain of the stress in the surrounding material, with the prestrain [-].
        variables : mapping of str to (components, n)
            An unchanged variable may be the array of `before`, which is not checked again.
        """
        ...
