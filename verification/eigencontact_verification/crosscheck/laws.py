"""Cases of a law that somebody else wrote: the finite elements ask the law itself in their integration points.

What is judged is then the semi-analytical structure around the law: cells, contact, history. The law by itself is
judged by its kit. A law is known by its key alone; its class says with which parameters it is to be checked, by a class
attribute ``example``, a mapping of its fields. Laws of hardening and of damage are checked within metal plasticity.
"""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from eigencontact.errors import EigencontactError
from eigencontact.library.components import make
from eigencontact.plugin import IsotropicHardening, LawStep, LinearLaw, PlasticDamage
from eigencontact.scene.installed import installed_plugins
from eigencontact_verification.crosscheck.case import Profile
from eigencontact_verification.crosscheck.indentation import VARIABLES
from eigencontact_verification.crosscheck.plasticity import PlasticCase, plastic_case
from eigencontact_verification.crosscheck.strangers import text_digest
from eigencontact_verification.fem.yielding_law import Answer, PointLaw, State

__all__ = ["LawCase", "LawOfPlugin", "law_cases"]

FloatArray = NDArray[np.float64]

#: Body of laws that lack constants, sphere, and the load in that which first leaves elasticity, cubed: in pressures.
_YOUNG, _POISSON, _RADIUS, _PAST = 210e9, 0.3, 105e-6, 1.7
#: Hertz's stress .48 a deep over p0 for ν = 0.3, from Johnson 1985: rr and tt, zz.
_ACROSS, _DOWN = -0.182, -0.802
#: Departure from elasticity that is seen, and the strains between which it is looked for.
_TOLERANCE, _LEAST, _MOST = 1e-6, 1e-7, 0.2
#: Meshes and cells of these cases. With growth 2.5 and meshes of 3, 6, 12 the residual stress at the end of the plastic
#: zone is uncertain by 2.5 % of the pressure, with these by 0.3 %, in the same time. By 12 cells to a radius plastic
#: strain is uncertain by 1.6 % of its largest value, by 16 by 0.9 %.
_GROWTH, _DIVISIONS = 4.0, (4, 8, 16)
_CELLS, _COARSER = 16, (6, 8)
_MANDEL = np.array([0, 1, 2, 4])
_FIELDS = ("hardening-law", "damage-law")


@dataclass(frozen=True, kw_only=True, eq=False)
class LawOfPlugin:
    """A plugin's law for the integration points of a body of revolution: x is r, y goes round.

    Parameters
    ----------
    law : ConstitutiveLaw
        Isotropic, and the same everywhere and always: it is told neither place nor time.
    """

    law: Any

    def state_at_rest(self, components: int, points: int) -> State:  # noqa: ARG002
        """See `PointLaw.state_at_rest`."""
        return {name: np.zeros((variable.components, points)) for name, variable in self.law.variables.items()}

    def answer(self, strain: FloatArray, before: State) -> Answer:
        """See `PointLaw.answer`.

        Raises
        ------
        ArithmeticError
            The law has no answer, or one that is not finite.
        """
        count = strain.shape[1]
        full_strain, nowhere = np.zeros((6, count)), np.full(count, np.nan)
        full_strain[_MANDEL] = strain
        step = LawStep(x=nowhere, y=nowhere, z=nowhere, time=np.nan, duration=1.0)
        try:
            response = self.law.update(full_strain, before, step)
        except EigencontactError as problem:
            raise ArithmeticError(str(problem)) from None
        stress, tangent = np.asarray(response.stress)[_MANDEL], np.asarray(response.tangent)[np.ix_(_MANDEL, _MANDEL)]
        if not np.all(np.isfinite(stress)):
            raise ArithmeticError("the law must answer finite stress where it is told neither place nor time")
        if tangent.ndim == 2:
            tangent = np.repeat(tangent[:, :, None], count, axis=2)
        return stress, tangent, dict(response.variables)


@dataclass(frozen=True, kw_only=True, eq=False)
class LawCase(PlasticCase):
    """A sphere pressed into a body that obeys a plugin's law, in both methods."""

    code: ClassVar[tuple[str, ...]] = (*PlasticCase.code, f"{__name__}:LawOfPlugin", f"{__name__}:LawCase.law_of")

    states: ClassVar[Mapping[str, str]] = VARIABLES

    def law_of(self, table: Mapping[str, Any], young_modulus: float, poisson_ratio: float) -> PointLaw:
        """The plugin's law itself."""
        return LawOfPlugin(law=_built(table, young_modulus, poisson_ratio))


def law_cases(key: str) -> tuple[PlasticCase, ...]:
    """Cases of one law: loaded and unloaded, and cycled.

    Parameters
    ----------
    key : str
        Of an installed law: constitutive, of hardening, or of damage.

    Raises
    ------
    ValueError
        No such law, one without an example, or one that this comparison cannot judge; says why.
    """
    component = _component(key)
    table = _table(key, component)
    young, nu = _constants(table)
    law = _built(table, young, nu)
    refusal = _refusal(law)
    if refusal:
        raise ValueError(f"law {key!r} must be {refusal}")
    pressure = _PAST * _onset(law, young, nu)
    modulus = young / (1.0 - nu**2)
    a = np.pi * pressure * _RADIUS / (2.0 * modulus)
    load = float(2.0 / 3.0 * np.pi * a**2 * pressure)
    body = {"young_modulus": young, "poisson_ratio": nu, "radius": _RADIUS, "load": load}
    numbers = [name for name, variable in law.variables.items() if variable.components == 1 and variable.unit == "1"]
    cases = []
    for name, path in (("loaded", (0.4, 0.7, 1.0, 0.0)), ("cycled", (0.5, 1.0, 0.0, 0.5, 1.0, 0.0))):
        case = plastic_case(
            name, f"the law asked by both, {name}", law=table, path=path, body=body, quick=name == "loaded",
            kind=LawCase,
        )  # fmt: skip
        changed = {"growth": _GROWTH, "divisions": list(_DIVISIONS), "text": text_digest(component)}
        cases.append(
            replace(
                case, subject=f"law-{key}", parameters=case.parameters | changed, cells=_CELLS, coarser=_COARSER,
                profiles=_with_variables(case.profiles, numbers),
            )
        )  # fmt: skip
    return tuple(cases)


def _component(key: str) -> Any:
    """Class of an installed law."""
    from eigencontact.errors import nearest

    registry = installed_plugins()
    kinds = ("constitutive-law", *_FIELDS)
    entries = [entry for entry in registry.named(key) if entry.kind in kinds]
    if not entries:
        keys = [entry.key for kind in kinds for entry in registry.of_kind(kind)]
        raise ValueError(f"law must be one of {', '.join(keys)} (got {key!r}){nearest(key, keys)}")
    return entries[0].component


def _table(key: str, component: Any) -> dict[str, Any]:
    """Fields of the body's law: the example of a constitutive law, or metal plasticity with that of a part of it."""
    example = getattr(component, "example", None)
    if not isinstance(example, Mapping):
        needed = [
            name
            for name, parameter in inspect.signature(component).parameters.items()
            if parameter.default is parameter.empty
        ]
        if needed:
            raise ValueError(
                f"law {key!r} must say with which parameters it is to be checked (got none); give its class an "
                f"attribute example, a mapping with {', '.join(needed)}"
            )
    fields = {"type": key, **(example or {})}
    perfect = {"type": "perfect", "yield_stress": 3e9}
    if component.kind == "constitutive-law":
        return fields
    if component.kind == "damage-law":
        if not issubclass(component, PlasticDamage):
            raise ValueError(
                f"law {key!r} must be a law of plastic strain; what softens by stretch has no one answer here"
            )
        return {"type": "j2", "hardening": [perfect], "damage": fields}
    isotropic = issubclass(component, IsotropicHardening)
    return {"type": "j2", "hardening": [fields] if isotropic else [{**perfect, "yield_stress": 1.8e9}, fields]}


def _built(table: Mapping[str, Any], young_modulus: float, poisson_ratio: float) -> Any:
    """Law of a table in a body."""
    law = make(table["type"], kind="constitutive-law", **{k: v for k, v in table.items() if k != "type"})
    return law.of_body(young_modulus, poisson_ratio)


def _refusal(law: Any) -> str:
    """Property that the law lacks for this comparison; empty if it can be judged."""
    if isinstance(law, LinearLaw):
        return "more than elastic; one that is linear is verified as an inhomogeneity"
    if law.averaged:
        return "local; the finite elements take no means over a neighbourhood"
    if law.varies:
        return "the same everywhere; the finite elements tell it no place"
    return "" if law.isotropic else "isotropic; the finite elements are of revolution"


def _constants(table: Mapping[str, Any]) -> tuple[float, float]:
    """Young's modulus and Poisson's ratio of the law at rest, for it is that of a whole body."""
    law = _built(table, _YOUNG, _POISSON)
    tangent = LawOfPlugin(law=law).answer(np.zeros((4, 1)), LawOfPlugin(law=law).state_at_rest(4, 1))[1][:, :, 0]
    shear = 0.5 * tangent[3, 3]
    lame = tangent[0, 1]
    return float(shear * (3 * lame + 2 * shear) / (lame + shear)), float(0.5 * lame / (lame + shear))


def _onset(law: Any, young: float, nu: float) -> float:
    """Pressure p0 of Hertz at which the law leaves elasticity."""
    stress = np.array([_ACROSS, _ACROSS, _DOWN, 0.0])
    strain = ((1 + nu) * stress - nu * stress[:3].sum() * np.array([1.0, 1.0, 1.0, 0.0]))[:, None]
    point = LawOfPlugin(law=law)

    def elastic(size: float) -> bool:
        answer = point.answer(size * strain, point.state_at_rest(4, 1))[0][:, 0]
        return bool(np.abs(answer - size * young * stress).max() <= _TOLERANCE * size * young)

    if not elastic(_LEAST):
        raise ValueError(f"law {law.key!r} must be elastic under small strains, with the constants of its body")
    low, high = _LEAST, _MOST
    if elastic(high):
        raise ValueError(f"law {law.key!r} must leave elasticity within a strain of {_MOST:g}; give a weaker example")
    while high > 1.001 * low:
        middle = float(np.sqrt(low * high))
        low, high = (middle, high) if elastic(middle) else (low, middle)
    return high * young


def _with_variables(profiles: tuple[Profile, ...], names: list[str]) -> tuple[Profile, ...]:
    """Profiles with one for every scalar history variable of the law, in place of plastic strain."""
    short = {name: name for name in names} | {long: brief for brief, long in VARIABLES.items()}
    unchanged = [profile for profile in profiles if profile.quantity != "strain"]
    (model,) = (profile for profile in profiles if profile.quantity == "strain")
    return (*unchanged, *(replace(model, name=f"axis-{name}", components=(short[name],)) for name in names))
