"""Which checks a component must pass, and how to give them to pytest."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from types import ModuleType
from typing import Any

from eigencontact.errors import nearest
from eigencontact.plugin import (
    HasFarField,
    HasMirrorPotential,
    HasMomentIntegrals,
    HasMomentPotentials,
    HasMomentSums,
    HasPotentials,
    HasVolumeFractions,
)
from eigencontact_verification.conformance import (
    arrays,
    boundary,
    common,
    densities,
    eigenstrain,
    fatigue,
    finite_elements,
    friction,
    geometry,
    hardening,
    identities,
    integrals,
    law_abilities,
    law_arrays,
    law_elastic,
    law_mechanics,
    layered,
    moment_integrals,
    moment_sums,
    moments,
    region,
    surface,
    wear,
)
from eigencontact_verification.conformance.report import Check

__all__ = ["checks_for", "parametrize_with_checks"]


def _functions(*modules: ModuleType) -> tuple[Check, ...]:
    """Functions ``check_...`` of modules in the order of their definition."""
    return tuple(
        function
        for module in modules
        for name, function in vars(module).items()
        if name.startswith("check_") and function.__module__ == module.__name__
    )


#: Checks of shapes with an ability, which follow those of every shape.
_OF_ABILITY: dict[Check, type] = {
    integrals.check_chi: HasMirrorPotential,
    integrals.check_far_field: HasFarField,
    region.check_volume_fractions: HasVolumeFractions,
    **dict.fromkeys(_functions(densities, moments), HasMomentPotentials),
    **dict.fromkeys(_functions(moment_sums), HasMomentSums),
    moment_integrals.check_moment_integrals: HasMomentIntegrals,
}


def _checks(*modules: ModuleType) -> tuple[Check, ...]:
    """Checks of modules without those of an ability."""
    return tuple(function for function in _functions(*modules) if function not in _OF_ABILITY)


_BY_KIND: dict[str, tuple[Check, ...]] = {
    "hardening-law": _checks(hardening),
    "damage-law": _checks(hardening),
    "inclusion-shape": (*_checks(region), surface.check_surface_traction),
    "eigenstrain-field": _checks(eigenstrain),
    "geometry": _checks(geometry),
    "friction-law": _checks(friction),
    "wear-law": _checks(wear),
    "fatigue-criterion": _checks(fatigue),
    "constitutive-law": _checks(law_arrays, law_abilities, law_elastic, law_mechanics),
    "layered-medium": _checks(layered),
}
_OF_POTENTIALS = (*_checks(arrays, identities, boundary, integrals), surface.check_equilibrium)
#: Minutes a shape; only where asked for.
_SLOW: dict[str, tuple[Check, ...]] = {"inclusion-shape": (finite_elements.check_against_finite_elements,)}


def checks_for(component: Any, *, finite_elements: bool = False, installed: bool = True) -> tuple[Check, ...]:
    """Checks that apply to a component: those of every kind, of its kind, and of each ability it offers.

    Parameters
    ----------
    component : Component
        An instance of a plugin class.
    finite_elements : bool
        Also the slow check of a shape, against finite elements: ten seconds to two minutes.
    installed : bool
        Whether the class should be installed: False leaves `check_registered` out.

    Returns
    -------
    tuple of callables
        Each takes the component, returns nothing, and raises `ConformanceError` with its name, what was expected, what
        was found and what to do.

    Examples
    --------
    In a notebook, without pytest:

    >>> import eigencontact
    >>> ball = eigencontact.make("sphere", center=(0.0, 0.0, 2.0), radius=1.0)
    >>> for check in checks_for(ball):
    ...     check(ball)
    """
    checks = [*_checks(common), *_BY_KIND.get(component.kind, ())]
    if component.kind == "inclusion-shape":
        checks += _OF_POTENTIALS if isinstance(component, HasPotentials) else ()
        checks += [function for function, ability in _OF_ABILITY.items() if isinstance(component, ability)]
    if finite_elements:
        checks += _SLOW.get(component.kind, ())
    return tuple(function for function in checks if installed or function is not common.check_registered)


def parametrize_with_checks(
    components: Iterable[Any],
    *,
    waive: Mapping[str, str] | None = None,
    finite_elements: bool = False,
    installed: bool = True,
    slow_marks: Iterable[Any] = (),
) -> Any:
    """Decorate a test of (component, check): one test for every component and every check that applies to it.

    Parameters
    ----------
    components : iterable of Component
        Instances; for a shape, several: deep, off the axes, elongated, touching the surface if it can.
    waive : mapping of str to str, optional
        Names of checks that these components are known to fail, and why. A waived check must fail: when it passes, the
        test fails until the waiver is taken away.
    finite_elements : bool
        Also `check_against_finite_elements`, ten seconds to two minutes a shape; ``pytest -k "not finite_elements"``
        leaves it out of a run.
    installed : bool
        As of `checks_for`.
    slow_marks : iterable of pytest marks
        Put on that check: ``[pytest.mark.slow]`` where the suite has such a marker.

    Returns
    -------
    pytest mark
        The only use of pytest in the kit.

    Raises
    ------
    ValueError
        A waiver without a reason, or of a check that does not apply.

    Examples
    --------
    A whole ``tests/test_conformance.py``:

    >>> import eigencontact
    >>> from eigencontact_verification.conformance import parametrize_with_checks
    >>> @parametrize_with_checks([eigencontact.make("sphere", center=(0.0, 0.0, 2.0), radius=1.0)])
    ... def test_conformance(component, check):
    ...     check(component)
    """
    import pytest

    waive, components, slow_marks = dict(waive or {}), list(components), list(slow_marks)
    applicable = {
        check.__name__
        for component in components
        for check in checks_for(component, finite_elements=finite_elements, installed=installed)
    }
    for name, reason in waive.items():
        if name not in applicable:
            raise ValueError(f"waive must name a check that applies (got {name!r}){nearest(name, applicable)}")
        if not (isinstance(reason, str) and reason.strip()):
            raise ValueError(f"waive[{name!r}] must be the reason (got {reason!r})")
    cases = []
    for number, component in enumerate(components):
        for check in checks_for(component, finite_elements=finite_elements, installed=installed):
            waived = waive.get(check.__name__)
            marks = [pytest.mark.xfail(reason=waived, strict=True)] if waived else []
            if check in _SLOW.get(component.kind, ()):
                marks += slow_marks
            cases.append(pytest.param(component, check, id=f"{component.key}{number}-{check.__name__}", marks=marks))
    return pytest.mark.parametrize(("component", "check"), cases)
