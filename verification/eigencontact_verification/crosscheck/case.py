"""One case of the cross-check: the same problem solved semi-analytically and by finite elements.

The list of cases is the module `eigencontact_verification.crosscheck.cases`, which offers

- ``kernels() -> tuple[str, ...]``: keys that can be verified, installed plugins included;
- ``cases_of(kernel) -> tuple[Case, ...]``: the cases of one key, the quick ones among them;
- ``gaps() -> tuple[Gap, ...]``: what is known not to be covered;
- ``why_not(kernel) -> str``: why something that is installed cannot be verified.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from math import ceil, gcd
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Self

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from pathlib import Path

__all__ = [
    "HALVED",
    "UNKNOWNS",
    "Case",
    "Curve",
    "Fields",
    "Gap",
    "Level",
    "Outer",
    "Profile",
    "Quantity",
    "error_key",
    "in_name",
    "refine_option",
]

Quantity = Literal["displacement", "stress", "strain"]
#: Mesh of a case: 0 coarse, 1 medium, 2 fine.
Level = Literal[0, 1, 2]
#: Boundary condition on the outer faces of the finite-element model.
Outer = Literal["fixed", "free"]
#: Parameter with the divisions of the undivided mesh, coarse to fine. Meshes of three dimensions have none: twice as
#: many elements along each edge would take eight times the memory.
_MESHES = "divisions"
#: Order of convergence at which a suggested refinement is enough: most fields have 1.5 to 2.
_LIKELY_ORDER = 1.5
#: A product of whole numbers and a factor is taken for the whole number next to it [-].
_ROUNDING = 1e-9
#: Name under which `Case.reference` may tell how many unknowns it solved for, as one number.
UNKNOWNS = "number of unknowns"
#: Name under which `Case.reference` may tell how many increments it halved because they had no solution, as one number.
HALVED = "number of halved increments"
#: Values by name of profile, each (n, components).
Fields = dict[str, NDArray[np.float64]]
#: Abscissa (n,) and values (n, components) of a line to be drawn; it breaks where values are not finite.
Curve = tuple[NDArray[np.float64], NDArray[np.float64]]


@dataclass(frozen=True, kw_only=True, eq=False)
class Profile:
    """Points where both methods are compared, in the order in which they are drawn.

    Keep points away from edges and corners where the exact field is singular: there neither method has a value.

    Parameters
    ----------
    name : str
        Unique within the case.
    quantity : {"displacement", "stress", "strain"}
        What is compared.
    points : (n, 3) float64
        Coordinates, z into the body; neighbours along the profile are neighbours in this array.
    along : (n,) float64
        Abscissa of the figures.
    label : str
        What the abscissa is, with its unit: ``"x / edge"``.
    components : tuple of str
        Name of each column of the values: ``("u_x", "u_y", "u_z")``.
    formal_order : float
        Largest order of convergence to be believed. Default 2.
    unit : str
        Unit of the values, for the figures; empty where they are dimensionless.

    Examples
    --------
    >>> line = np.linspace(0.0, 2.0, 5)
    >>> points = np.stack([line, 0.0 * line, 0.0 * line], axis=-1)
    >>> Profile(name="x axis", quantity="displacement", points=points, along=line, label="x / edge",
    ...         components=("u_x", "u_y", "u_z")).points.shape
    (5, 3)
    """

    name: str
    quantity: Quantity
    points: NDArray[np.float64]
    along: NDArray[np.float64]
    label: str
    components: tuple[str, ...]
    formal_order: float = 2.0
    unit: str = ""

    def __post_init__(self) -> None:
        points, along = np.asarray(self.points, dtype=float), np.asarray(self.along, dtype=float)
        where = f"profile '{self.name}'"
        if points.ndim != 2 or points.shape[1] != 3 or not len(points):
            raise ValueError(f"{where} points must be (n, 3) (got {points.shape}); stack x, y, z on the last axis")
        if along.shape != points.shape[:1]:
            raise ValueError(f"{where} along must be ({len(points)},) (got {along.shape}); give one value a point")
        if not self.components or len(set(self.components)) != len(self.components):
            raise ValueError(f"{where} components must be different names (got {self.components}); name each column")
        object.__setattr__(self, "points", points)
        object.__setattr__(self, "along", along)


def refine_option(excess: float) -> str:
    """Option of `eigencontact verify` with the factor that an uncertainty so many times its limit needs.

    Examples
    --------
    >>> refine_option(1.2), refine_option(3.0)
    ('repeat with --refine 1.5', 'repeat with --refine 2.5')
    """
    return f"repeat with --refine {max(1.5, ceil(2 * excess ** (1 / _LIKELY_ORDER)) / 2):g}"


def in_name(value: float) -> str:
    """Number in the name of a case.

    Examples
    --------
    >>> in_name(1.2), in_name(4.0)
    ('1-2', '4')
    """
    return f"{value:g}".replace(".", "-")


def error_key(profile: str) -> str:
    """Key of the numerical error of a profile among the values of `Case.judged`."""
    return f"{profile}: own error"


@dataclass(frozen=True, kw_only=True, eq=False)
class Case(ABC):
    """A problem that both methods solve; subclasses add `reference` and `judged`.

    An instance is sent to other processes, so it must be picklable and its class must be importable there.

    Parameters
    ----------
    subject : str
        Key of what is verified: ``"cuboid"``, ``"surface-loads"``.
    name : str
        Unique within the subject; part of file names: lower case, digits, hyphens.
    parameters : dict
        All that defines the case, as JSON allows; hashed, so that a stored solution serves no other problem.
    quick : bool
        Whether the case belongs to the quick cross-check.
    profiles : tuple of Profile
        Where the methods are compared.
    ratio : float
        Element size of a level over that of the next finer one. Default 2.
    bracket_level : {0, 1, 2}
        Level at which the outer faces are also left free. Truncation hardly depends on the mesh, so that the medium
        one (default) does at a fraction of the cost.
    """

    subject: str
    name: str
    parameters: dict[str, Any]
    quick: bool
    profiles: tuple[Profile, ...]
    ratio: float = 2.0
    bracket_level: Level = 1

    #: Code outside ``fem`` that decides what `reference` computes, as ``"module"`` or ``"module:object"``; its text is
    #: hashed. By default the whole class; where it is given, nothing else, so that words and pictures do not count.
    code: ClassVar[tuple[str, ...]] = ()
    #: Part of the field below which a component counts as if it had that size (`fem.uncertainty.verdict`).
    small: ClassVar[float] = 0.0
    #: What gives the reference, in the words of the figures.
    method: ClassVar[str] = "finite elements"

    def __post_init__(self) -> None:
        names = [profile.name for profile in self.profiles]
        if not names or len(set(names)) != len(names):
            raise ValueError(f"case '{self.key}' profiles must have different names (got {names}); rename one")
        if not self.ratio > 1.0:
            raise ValueError(f"case '{self.key}' ratio must be > 1 (got {self.ratio}); it is coarse over fine")

    @property
    def key(self) -> str:
        """Kernel and name: unique in a cross-check."""
        return f"{self.subject}/{self.name}"

    @abstractmethod
    def reference(self, level: Level, outer: Outer) -> Fields:
        """Values of the finite-element model: by name of profile, each (n, components)."""

    @abstractmethod
    def judged(self) -> Fields:
        """Values of the semi-analytical code: by name of profile, each (n, components).

        Where the method itself discretises (a shape cut into cells), a second entry with the `error_key` of the profile
        gives the error of the values, of the same shape; it is added to the reference's uncertainty.
        """

    def refined(self, factor: float) -> Self:
        """Case on meshes finer by a factor, or a little more: whole numbers of elements keep their ratio.

        Raises
        ------
        ValueError
            A case whose meshes are not divided.
        """
        if _MESHES not in self.parameters:
            raise ValueError(
                f"--refine must be of laws, plasticity, layers or inhomogeneities (got {self.key}); leave it out"
            )
        meshes = [int(number) for number in self.parameters[_MESHES]]
        shared = gcd(*meshes)
        times = ceil(shared * factor - _ROUNDING)
        return replace(self, parameters={**self.parameters, _MESHES: [number // shared * times for number in meshes]})

    def remedy(self, source: str, excess: float) -> str:
        """Advice about an uncertainty above its limit; empty where there is none.

        Parameters
        ----------
        source : str
            Largest part of the uncertainty: ``"discretisation"``, ``"truncation"``, ``"iteration"``, ``"judged"``.
        excess : float
            Uncertainty over its limit.
        """
        return refine_option(excess) if source == "discretisation" and _MESHES in self.parameters else ""

    @property
    def words(self) -> str:
        """Title of the figures: the problem in words; by default empty."""
        return ""

    def curve(self, profile: Profile) -> Curve | None:  # noqa: ARG002
        """Semi-analytical values closely along the line of a profile, gaps included, for the figures; None if dear."""
        return None

    def pictures(self, folder: Path) -> tuple[Path, ...]:  # noqa: ARG002
        """Write mesh and field of the coarse model into `folder` (VTU, PNG); by default nothing."""
        return ()


@dataclass(frozen=True, kw_only=True)
class Gap:
    """Quantity or situation that no case covers, listed in the report.

    Parameters
    ----------
    subject : str
        Key of the kernel or law, or name of the scene.
    what : str
        Quantity, component or situation.
    reason : str
        Why there is no case.
    """

    subject: str
    what: str
    reason: str
