"""Which checks a component must pass, and how to give them to pytest."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from eigencontact.errors import nearest
from eigencontact.plugin import HasFarField, HasMirrorPotential, HasPotentials, HasVolumeFractions
from eigencontact_verification.conformance import (
    arrays,
    boundary,
    common,
    eigenstrain,
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
    region,
    surface,
    wear,
)
from eigencontact_verification.conformance.report import Check

__all__ = ["checks_for", "parametrize_with_checks"]

_EVERY: tuple[Check, ...] = (
    common.check_registered,
    common.check_references,
    common.check_frozen,
    common.check_fields_are_the_table,
    common.check_files_are_marked,
    common.check_bad_numbers_refused,
    common.check_bad_lengths_refused,
)
_CURVE: tuple[Check, ...] = (
    hardening.check_curve_arrays,
    hardening.check_curve_range,
    hardening.check_curve_slope,
    hardening.check_curve_pure,
)
_BY_KIND: dict[str, tuple[Check, ...]] = {
    "hardening-law": _CURVE,
    "damage-law": _CURVE,
    "inclusion-shape": (
        region.check_bounds,
        region.check_in_body,
        region.check_place,
        region.check_contains_arrays,
        region.check_contains_pure,
        surface.check_surface_traction,
    ),
    "eigenstrain-field": (
        eigenstrain.check_eigenstrain_arrays,
        eigenstrain.check_eigenstrain_pure,
        eigenstrain.check_declarations,
    ),
    "geometry": (geometry.check_separation_arrays, geometry.check_separation_pure),
    "friction-law": (friction.check_shear_bound, friction.check_shear_bound_pure),
    "wear-law": (
        wear.check_worn_depth,
        wear.check_worn_depth_pure,
        wear.check_no_slip_no_wear,
        wear.check_pressed_in_proportion,
        wear.check_volume_by_energy,
        wear.check_says_what_it_needs,
        wear.check_cut_increments,
        wear.check_reversed_cells,
    ),
    "constitutive-law": (
        law_arrays.check_variables,
        law_arrays.check_response_shapes,
        law_arrays.check_rest,
        law_arrays.check_update_pure,
        law_arrays.check_points_alone,
        law_abilities.check_law_at_places,
        law_abilities.check_parts_of_law,
        law_abilities.check_law_of_body,
        law_abilities.check_cell_answer,
        law_abilities.check_means,
        law_elastic.check_stiffness,
        law_elastic.check_factors,
        law_mechanics.check_tangent,
        law_mechanics.check_tangent_symmetry,
        law_mechanics.check_objectivity,
        law_mechanics.check_energy,
    ),
    "layered-medium": (
        layered.check_materials,
        layered.check_response_arrays,
        layered.check_response_pure,
        layered.check_response_at_depths,
        layered.check_load_on_surface,
        layered.check_balance_below_the_surface,
        layered.check_hooke,
        layered.check_interfaces,
        layered.check_short_waves,
        layered.check_long_waves,
        layered.check_reciprocity,
        layered.check_directions,
        layered.check_decay,
        layered.check_extreme_waves,
    ),
}
_BY_ABILITY: tuple[tuple[type, tuple[Check, ...]], ...] = (
    (
        HasPotentials,
        (
            arrays.check_potential_arrays,
            arrays.check_potentials_pure,
            arrays.check_potentials_finite,
            identities.check_phi_laplacian,
            identities.check_psi_laplacian,
            identities.check_phi_derivatives,
            identities.check_psi_derivatives,
            identities.check_parity,
            boundary.check_continuity,
            boundary.check_face_means,
            boundary.check_flush_face,
            integrals.check_quadrature,
            integrals.check_volume,
            integrals.check_decay,
            surface.check_equilibrium,
        ),
    ),
    (HasMirrorPotential, (integrals.check_chi,)),
    (HasFarField, (integrals.check_far_field,)),
    (HasVolumeFractions, (region.check_volume_fractions,)),
)
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
    checks = [*_EVERY, *_BY_KIND.get(component.kind, ())]
    if component.kind == "inclusion-shape":
        for ability, more in _BY_ABILITY:
            if isinstance(component, ability):
                checks += more
    if finite_elements:
        checks += _SLOW.get(component.kind, ())
    return tuple(one for one in checks if installed or one is not common.check_registered)


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
            known = waive.get(check.__name__)
            marks = [pytest.mark.xfail(reason=known, strict=True)] if known else []
            if check in _SLOW.get(component.kind, ()):
                marks += slow_marks
            cases.append(pytest.param(component, check, id=f"{component.key}{number}-{check.__name__}", marks=marks))
    return pytest.mark.parametrize(("component", "check"), cases)
