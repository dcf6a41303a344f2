"""The kind *fatigue criterion*: from the stress of one cycle at points to a damage parameter and its limit."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Protocol, runtime_checkable

import numpy as np

from eigencontact.core.arrays import FloatArray, real_answer
from eigencontact.errors import PluginError
from eigencontact.plugin.component import Component

__all__ = ["DamageParameter", "FatigueCriterion", "HasKnownValues", "HasUpperBound", "StressCycle", "checked_damage"]


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class StressCycle:
    """Stress of one cycle at points of a body. Arrays are read-only.

    Attributes
    ----------
    stress : (steps, 6, points) float64
        Mandel stress [Pa], tension positive, residual stress included. The cycle is closed: the step after the last is
        the first.
    strain : (steps, 6, points) float64, or None
        Mandel strain [-], for criteria with ``needs_strain = True``.

    Examples
    --------
    >>> tension = np.zeros((2, 6, 1))
    >>> tension[:, 0, 0] = 1e8, -1e8
    >>> StressCycle(stress=tension).points
    1
    """

    stress: FloatArray
    strain: FloatArray | None = None

    @property
    def points(self) -> int:
        """Number of points."""
        return int(self.stress.shape[-1])

    def at(self, points: Any) -> StressCycle:
        """Cycle of some points: their indices, a slice or a mask."""
        return StressCycle(
            stress=self.stress[..., points], strain=None if self.strain is None else self.strain[..., points]
        )

    @property
    def hydrostatic(self) -> FloatArray:
        """Mean normal stress ``(steps, points)`` [Pa], tension positive."""
        return np.asarray((self.stress[:, 0] + self.stress[:, 1] + self.stress[:, 2]) / 3.0)

    @property
    def deviator(self) -> FloatArray:
        """Deviatoric stress ``(steps, 6, points)`` [Pa]."""
        out = np.array(self.stress)
        out[:, :3] -= self.hydrostatic[:, None]
        return out


@dataclass(frozen=True, slots=True, eq=False)
class DamageParameter:
    """Damage parameter of a criterion at points, with the critical plane.

    Attributes
    ----------
    value : (points,) float64
        Damage parameter, in the unit of the criterion.
    normal : (points, 3) float64, or None
        Unit normal of the critical plane, z positive; None for criteria without a plane.

    Examples
    --------
    >>> DamageParameter(np.array([2.5e8])).normal is None
    True
    """

    value: FloatArray
    normal: FloatArray | None = None


class FatigueCriterion(Component, ABC):
    """Damage parameter of a cycle at points, and its limit.

    Attributes
    ----------
    unit : str
        Unit of the damage parameter and of `limit`.
    needs_strain : bool
        Whether the criterion reads `StressCycle.strain`.
    amplitude_power : float
        Power with which the damage parameter grows with the amplitude, for Wöhler curves: 2 for a product of stress and
        strain.

    Examples
    --------
    >>> from eigencontact.plugin import smallest_balls
    >>> @dataclass(frozen=True, kw_only=True)
    ... class MisesAmplitude(FatigueCriterion):
    ...     key = "mises-amplitude"
    ...     limit_amplitude: float
    ...     @property
    ...     def limit(self):
    ...         return self.limit_amplitude
    ...     def damage(self, cycle):
    ...         return DamageParameter(np.sqrt(1.5) * smallest_balls(cycle.deviator)[1])
    >>> tension = np.zeros((2, 6, 1))
    >>> tension[:, 0, 0] = 1e8, -1e8
    >>> MisesAmplitude(limit_amplitude=2e8).damage(StressCycle(stress=tension)).value.round(3).tolist()
    [100000000.0]
    """

    kind: ClassVar[str] = "fatigue-criterion"
    unit: ClassVar[str] = "Pa"
    needs_strain: ClassVar[bool] = False
    amplitude_power: ClassVar[float] = 1.0

    @property
    @abstractmethod
    def limit(self) -> float:
        """Largest damage parameter without a crack, positive."""

    @abstractmethod
    def damage(self, cycle: StressCycle) -> DamageParameter:
        """Damage parameter at every point: finite; more tension must not reduce it."""


@runtime_checkable
class HasKnownValues(Protocol):
    """Ability: values in closed form for the conformance checks."""

    def known_values(self, amplitude: float, young_modulus: float, poisson_ratio: float) -> Mapping[str, float]:
        """Damage parameters of cycles of a stress amplitude [Pa], by name.

        ``"tension"``: uniaxial, mean zero; ``"pulsating-tension"``: from zero to twice the amplitude; ``"torsion"``:
        shear, mean zero; ``"tension-and-torsion"``: both of the amplitude, 90 degrees apart; ``"three-shears"``: shear
        on a plane to three corners of a regular triangle, the amplitude is the radius of the circle around them.
        Strain is the elastic one.
        """


@runtime_checkable
class HasUpperBound(Protocol):
    """Ability: a bound that costs less than the damage parameter, for the search of the largest value of a region.

    A fretting map evaluates `FatigueCriterion.damage` only at points whose bound reaches the largest value.
    """

    def upper_bound(self, cycle: StressCycle) -> FloatArray:
        """At least the damage parameter ``(points,)`` of `FatigueCriterion.damage`, finite."""


def checked_damage(criterion: FatigueCriterion, cycle: StressCycle) -> DamageParameter:
    """Result of a criterion for a read-only cycle, checked.

    Raises
    ------
    PluginError
        Another shape; values that are not finite; normals that are no unit vectors.
    """
    where = f"damage of fatigue criterion {criterion.key!r}"
    arrays = {name: _locked(getattr(cycle, name)) for name in ("stress", "strain")}
    answer = criterion.damage(StressCycle(stress=arrays["stress"], strain=arrays["strain"]))  # type: ignore[arg-type]
    value = real_answer(answer.value, where)
    if value.shape != (cycle.points,) or not np.all(np.isfinite(value)):
        got = f"shape {value.shape}" if value.shape != (cycle.points,) else "NaN or infinity"
        raise PluginError(f"{where} must be finite, of shape {(cycle.points,)} (got {got})")
    if answer.normal is None:
        return DamageParameter(value)
    normal = real_answer(answer.normal, f"normal of {where}")
    if normal.shape != (cycle.points, 3) or not np.allclose(np.linalg.norm(normal, axis=1), 1.0, atol=1e-6):
        raise PluginError(f"normal of {where} must be unit vectors {(cycle.points, 3)} (got shape {normal.shape})")
    return DamageParameter(value, normal)


def _locked(array: FloatArray | None) -> FloatArray | None:
    if array is None:
        return None
    view = array.view()
    view.flags.writeable = False
    return view
