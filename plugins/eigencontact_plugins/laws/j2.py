"""Metal plasticity: von Mises yield condition, with hardening and damage."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar, Literal, cast

import numpy as np
from numpy.typing import NDArray

from eigencontact.plugin import (
    FloatArray,
    HardeningLaw,
    IsotropicHardening,
    KinematicHardening,
    LawStep,
    PlasticDamage,
    Response,
    Surroundings,
    Variable,
    hook_for,
    require,
)
from eigencontact_plugins.laws.constants import BodyConstants
from eigencontact_plugins.laws.radial_return import Drive, RadialReturn, Returned

__all__ = ["J2"]


_ROOT = float(np.sqrt(1.5))
_UNIT = np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
_DEVIATOR = np.eye(6) - np.outer(_UNIT, _UNIT) / 3.0


@dataclass(frozen=True, kw_only=True)
class J2(BodyConstants):
    """Von Mises plasticity: isotropic elasticity up to the yield stress, and plastic flow along the deviator beyond it.

    The integration is implicit (backward Euler), and stable for large increments, reversals and cycles.

    Parameters
    ----------
    hardening : HardeningLaw, or several
        One isotropic hardening law for the yield stress, and any number of back-stresses; several of
        ``armstrong-frederick`` are Chaboche's law.
    damage : PlasticDamage, optional
        Loss of stiffness by plastic strain; with a length, by its mean over a neighbourhood.
    yield_on : str
        Stress in the yield condition of a material with damage: ``"nominal"``, the stress, or ``"effective"``, the
        stress ``σ / (1 - D)`` of the undamaged part; the nominal strength then decreases with damage.
    """

    key: ClassVar[str] = "j2"
    example: ClassVar[dict[str, Any]] = {
        "young_modulus": "210 GPa",
        "poisson_ratio": 0.3,
        "hardening": {"type": "linear", "yield_stress": "1 GPa", "modulus": "20 GPa"},
    }
    references: ClassVar[tuple[str, ...]] = (
        "R. von Mises 1913, Nachr. Ges. Wiss. Goettingen, 582",
        "J. C. Simo, T. J. R. Hughes 1998, Computational Inelasticity, chapter 3",
        "J. Lemaitre 1985, J. Eng. Mater. Technol. 107, 83 (effective stress)",
    )

    hardening: tuple[HardeningLaw, ...]
    damage: PlasticDamage | None = None
    yield_on: Literal["nominal", "effective"] = "nominal"

    def __post_init__(self) -> None:
        super().__post_init__()
        sizes = [law.key for law in self.hardening if isinstance(law, IsotropicHardening)]
        rule = "one that gives a yield stress (perfect, linear, swift ...), and any number of back-stresses"
        require(len(sizes) == 1, self.key, "hardening", [law.key for law in self.hardening], rule)
        good = self.damage is None or isinstance(self.damage, PlasticDamage)
        require(good, self.key, "damage", getattr(self.damage, "key", None), "a law of plastic strain")
        if self.young_modulus is not None:
            for law in self.hardening:
                law.of_material(self.young_modulus)
        if self.damage is not None:
            self.damage.averaged("equivalent_plastic_strain")

    @property
    def variables(self) -> Mapping[str, Variable]:  # type: ignore[override]
        """See `ConstitutiveLaw.variables`; one back-stress of each kinematic law."""
        declared = {
            "equivalent_plastic_strain": Variable(
                "1", "equivalent plastic strain", largest="max_plastic_strain", extent="plastic_volume"
            ),
            "plastic_strain": Variable("1", "plastic strain", 6),
            "plastic_work_density": Variable("J/m^3", "plastic work", total=("plastic_work", "J")),
        }
        for number in range(1, len(self._kinematic) + 1):
            declared[f"back_stress_{number}"] = Variable("Pa", "centre of the yield surface", 6)
        if self.damage is not None:
            declared["damage"] = Variable(
                "1", "lost fraction of the stiffness", largest="max_damage", extent="damaged_volume"
            )
        return declared

    @property
    def averaged(self) -> Mapping[str, float]:
        """See `ConstitutiveLaw.averaged`."""
        return {} if self.damage is None else self.damage.averaged("equivalent_plastic_strain")

    @property
    def advice(self) -> str:  # type: ignore[override]
        """See `ConstitutiveLaw.advice`."""
        remedies = ["hardening that falls less steeply"]
        if self.damage is not None and self.yield_on == "effective":
            remedies += [f"a {'larger ' if self.damage.length else ''}length in damage", 'yield-on = "nominal"']
        return f"give it {' or '.join(remedies)}"

    @property
    def symmetric(self) -> bool:  # type: ignore[override]
        """See `ConstitutiveLaw`: False with damage or with a back-stress that saturates."""
        return self.damage is None and all(law.recall(np.ones(1))[0][0] == 1.0 for law in self._kinematic)

    @property
    def words(self) -> str:
        """See `ConstitutiveLaw.words`."""
        damage = "" if self.damage is None else f" and is damaged ({self.damage.key})"
        return f"material that yields ({', '.join(law.key for law in self.hardening)}){damage}"

    @cached_property
    def _kinematic(self) -> list[KinematicHardening]:
        return [law for law in self._hardening if isinstance(law, KinematicHardening)]

    @cached_property
    def _hardening(self) -> list[HardeningLaw]:
        E = self.young_modulus
        return list(self.hardening) if E is None else [law.of_material(E) for law in self.hardening]

    @cached_property
    def _constants(self) -> tuple[float, float]:
        """Shear and bulk modulus [Pa]."""
        E, nu = self._young_and_poisson
        return E / (2.0 * (1.0 + nu)), E / (3.0 * (1.0 - 2.0 * nu))

    @cached_property
    def _return(self) -> RadialReturn:
        return RadialReturn(
            shear_modulus=self._constants[0],
            isotropic=next(law for law in self._hardening if isinstance(law, IsotropicHardening)),
            kinematic=self._kinematic,
            damage=self.damage,
            effective=self.yield_on == "effective",
        )

    def update(self, strain: FloatArray, before: Mapping[str, FloatArray], step: LawStep) -> Response:
        """See `ConstitutiveLaw.update`; the tangent is that of the implicit step, not symmetric with damage.

        Raises
        ------
        NotUnique
            Points soften faster than -3G.
        """
        bulk, volume = self._constants[1], strain[:3].sum(axis=0)
        drive = self._drive(strain.copy(), 0.0, before, step)
        flowed = self._increment_end(drive, before)
        stress = flowed.deviator(drive)
        stress[:3] += flowed.sound * bulk * volume
        return Response(stress=stress, tangent=self._tangent(flowed, volume), variables=flowed.after)

    def cell_answer(
        self,
        foreign: FloatArray,
        prestrain: FloatArray,
        around: Surroundings,
        before: Mapping[str, FloatArray],
        step: LawStep,
    ) -> tuple[FloatArray, dict[str, FloatArray]]:
        """See `HasCellAnswer.cell_answer`."""
        driving = foreign / around.shear_stiffness
        driving -= prestrain
        drive = self._drive(driving, around.shear_give, before, step)
        flowed = self._increment_end(drive, before)
        eigenstrain = flowed.after["plastic_strain"] + prestrain
        # Strain by the difference of constants between this material and the surrounding one: zero for equal constants.
        shear, bulk = self._constants
        compliances = 0.5 / shear, 1.0 / (3.0 * bulk)
        if self.damage is not None or compliances != (around.shear_compliance, around.bulk_compliance):
            further, soft = 0.5 / (shear * flowed.sound) - around.shear_compliance, 1.0 / (3.0 * bulk * flowed.sound)
            mean = (foreign[:3].sum(axis=0) / around.bulk_stiffness - prestrain[:3].sum(axis=0)) / 3.0
            pressed = mean / (soft + around.bulk_give)
            eigenstrain += further * flowed.deviator(drive)
            eigenstrain[:3] += (soft - around.bulk_compliance) * pressed
        return eigenstrain, flowed.after

    def _drive(self, strain: FloatArray, give: float, before: Mapping[str, FloatArray], step: LawStep) -> Drive:
        """Trial state from the deviator of a strain, whose memory it overwrites."""
        strain[:3] -= strain[:3].sum(axis=0) / 3.0
        strain -= before["plastic_strain"]
        back_stresses = [before[f"back_stress_{number}"] for number in range(1, len(self._kinematic) + 1)]
        about = step.means.get("equivalent_plastic_strain")
        mean = None if about is None else np.maximum(about[0], 0.0)
        stacked = np.stack(back_stresses) if back_stresses else np.zeros((0, *strain.shape))
        return Drive(strain, give, before["equivalent_plastic_strain"][0], stacked, mean)

    def _increment_end(self, drive: Drive, before: Mapping[str, FloatArray]) -> _IncrementEnd:
        """State at the end of the increment; most points of a box do not yield, and take little time."""
        w, sound, points = self._return.elastic(drive)
        if not points.size and self.damage is None:
            return _IncrementEnd(w, sound, points, after=dict(before))
        after = {name: values.copy() for name, values in before.items()}
        out = _IncrementEnd(w * sound if self._return.effective else w, sound, points, after)
        if self.damage is not None:
            after["damage"] = (1.0 - sound)[None]
        if points.size:
            flowing = drive.of(points)
            end = self._return.returned(flowing, points)
            sound[points] = end.sound
            start = {name: values[:, points] for name, values in before.items()}
            stress, changed = self._end_state(flowing, end, start)
            for name, values in changed.items():
                after[name][:, points] = values
            out.drive, out.end, out.stress = flowing, end, stress
        return out

    def _end_state(
        self, drive: Drive, end: Returned, before: Mapping[str, FloatArray]
    ) -> tuple[FloatArray, dict[str, FloatArray]]:
        """Deviatoric stress, and internal variables."""
        flowed = _ROOT * end.dp * end.flow
        stress = end.w * (drive.tau - flowed)
        after = {
            "equivalent_plastic_strain": (drive.p + end.dp)[None],
            "plastic_strain": before["plastic_strain"] + flowed,
        }
        for number, law in enumerate(self._kinematic):
            turned = drive.back[number] + law.modulus / 1.5 * flowed
            after[f"back_stress_{number + 1}"] = end.theta[number] * turned
        if self.damage is not None:
            after["damage"] = (1.0 - end.sound)[None]
        after["plastic_work_density"] = before["plastic_work_density"] + self._work(drive, end, flowed, before, after)
        return (end.sound if self._return.effective else 1.0) * stress, after

    def _work(
        self,
        drive: Drive,
        end: Returned,
        flowed: FloatArray,
        before: Mapping[str, FloatArray],
        after: Mapping[str, FloatArray],
    ) -> FloatArray:
        """Plastic work of the increment [J/m^3], by the mean of the yield-condition stresses at its ends."""
        work: FloatArray = np.zeros((1, end.dp.size))
        if not end.dp.any():
            return work
        for p, state, recalled in ((drive.p, before, drive.back), (drive.p + end.dp, after, None)):
            strength, _ = self._return.isotropic.flow_stress(p)
            back_stresses = (
                recalled if recalled is not None else [after[name] for name in after if name.startswith("back")]
            )
            density = strength * end.dp + sum(np.sum(stress * flowed, axis=0) for stress in back_stresses)
            effective = self._return.effective and self.damage is not None
            work += 0.5 * density * (1.0 - state["damage"] if effective else 1.0)
        return work

    def _tangent(self, flowed: _IncrementEnd, volume: FloatArray) -> FloatArray:
        """Derivative of the stress by the strain, ``(6, 6, n)``, or ``(6, 6)`` without damage and plastic flow."""
        pressed = self._constants[1] * np.outer(_UNIT, _UNIT)
        if self.damage is None:
            elastic = 2.0 * self._constants[0] * _DEVIATOR + pressed
            if not flowed.points.size:
                return elastic
            out = np.repeat(elastic[:, :, None], volume.size, axis=2)
        else:
            out = flowed.w * _DEVIATOR[:, :, None] + flowed.sound * pressed[:, :, None]
        if flowed.drive is not None and flowed.end is not None and flowed.stress is not None:
            state = flowed.drive, flowed.end, flowed.stress
            out[:, :, flowed.points] = self._tangent_of_flow(*state, volume[flowed.points])
        return out

    def _tangent_of_flow(self, drive: Drive, end: Returned, deviator: FloatArray, volume: FloatArray) -> FloatArray:
        """Derivative of the stress by the strain at yielding points."""
        bulk, effective = self._constants[1], self._return.effective
        unit, m = np.eye(6)[:, :, None], end.flow
        grown = (-_ROOT * end.w / end.slope) * m  # derivative of dp by τ
        size = np.sqrt(np.sum(end.reached**2, axis=0))
        moved = end.w * unit + _outer(end.dw * drive.tau - end.drecalled, grown)
        across = (moved - _outer(m, np.einsum("in,ijn->jn", m, moved))) / np.where(size > 0.0, size, 1.0)
        flowing = end.dw * drive.tau - _ROOT * (end.w + end.dw * end.dp) * m
        out = end.w * unit + _outer(flowing, grown) - _ROOT * end.w * end.dp * across
        if effective:
            undamaged = deviator / end.sound
            out = end.sound * out + _outer(end.dsound * undamaged, grown)
        out = out + _outer(end.dsound * bulk * volume * _UNIT[:, None], grown)
        out = np.einsum("ijn,jk->ikn", out, _DEVIATOR)
        return cast("FloatArray", out + end.sound * bulk * np.outer(_UNIT, _UNIT)[:, :, None])


@dataclass(slots=True, eq=False)
class _IncrementEnd:
    """State of n points after an increment with few yielding points.

    Attributes
    ----------
    w : (n,)
        Deviatoric stress per driving strain of points without plastic flow [Pa].
    sound : (n,)
        1 - D.
    points : (m,) of int
        Points with plastic flow.
    after : mapping
        Internal variables after the increment.
    drive, now, stress
        Drive, state and deviatoric stress [Pa] of the points with plastic flow, if there are any.
    """

    w: FloatArray
    sound: FloatArray
    points: NDArray[np.intp]
    after: dict[str, FloatArray]
    drive: Drive | None = None
    end: Returned | None = None
    stress: FloatArray | None = None

    def deviator(self, drive: Drive) -> FloatArray:
        """Deviatoric stress of all points [Pa]."""
        out = self.w * drive.tau
        if self.stress is not None:
            out[:, self.points] = self.stress
        return out


def _outer(left: FloatArray, right: FloatArray) -> FloatArray:
    return left[:, None, :] * right[None, :, :]


eigencontact_register = hook_for(J2)
