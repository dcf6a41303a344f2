"""The slow part of the kit: fields of a shape against finite elements that know it by `contains` and `bounds` alone."""

from __future__ import annotations

from dataclasses import replace
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

from eigencontact.core.places import place_field
from eigencontact_verification.conformance.report import check, ensure

if TYPE_CHECKING:
    from eigencontact_verification.crosscheck.judge import Row

_MODULES = {"skfem": "scikit-fem", "pyamg": "pyamg"}
#: Least depth of the top over the longest extent: fitted elements need room above the shape.
_CLEARANCE = 0.25


@check
def check_against_finite_elements(component: Any) -> None:
    """Displacement of the surface and stress below it are those of a finite-element model, within its own error.

    The eigenstrain is an expansion, and one along z where the shape is of revolution about z: then the elements are
    axisymmetric and it takes some ten seconds, otherwise solid and one or two minutes. The shape is first put on the
    axis, and its top a quarter of its extent below the surface, if it says where it is (`Place`). Nothing may disagree,
    and at least the displacement must agree; stress on which the elements are inconclusive is no failure, and no
    agreement either: ``eigencontact verify`` lists it.
    """
    missing = [package for module, package in _MODULES.items() if find_spec(module) is None]
    ensure(
        not missing,
        "the environment",
        "one with the libraries of the finite elements",
        f"no {', '.join(missing)}",
        f"pip install {' '.join(missing) or 'eigencontact'}; eigencontact itself requires them",
    )
    for row in _rows(component):
        where = f"{row.component} of {row.case}, {row.profile}"
        got = f"{row.word}: {row.reason.partition('; level')[0]}"
        ensure(
            row.word != "failed",
            where,
            "comparable",
            got,
            "try a shape that is less slender and further from the surface",
        )
        if row.difference is not None and row.uncertainty is not None:
            got += f"; |SA - FE| {100 * row.difference:.2g} %, u_FE {100 * row.uncertainty:.2g} % of the field"
        ensure(
            row.word != "disagrees",
            where,
            "that of the finite elements within their uncertainty",
            got,
            "compare contains with phi and psi; install the package and see the profiles of `eigencontact verify "
            f"--kernel {component.key}`",
        )
        ensure(
            row.quantity != "displacement" or row.word == "agrees",
            where,
            "known to the finite elements",
            got,
            "try a shape that is less slender and further from the surface",
        )


def _rows(component: Any) -> list[Row]:
    """Verdicts on all components of all profiles."""
    from eigencontact_verification.crosscheck.inclusions import inclusion_case
    from eigencontact_verification.crosscheck.judge import judge
    from eigencontact_verification.crosscheck.run import Solved, tasks_of
    from eigencontact_verification.crosscheck.strangers import symmetries_of
    from eigencontact_verification.crosscheck.worker import perform

    shape = _placed(component)
    symmetries = symmetries_of(shape)
    rows: list[Row] = []
    for eigenstrain in ("uniform", "zz") if symmetries["revolved"] else ("uniform",):
        case = inclusion_case({"key": component.key}, eigenstrain, 0.3, name="check", component=shape, **symmetries)
        outcomes = tuple((task, perform(task)) for task in tasks_of(case))
        rows += judge(Solved(case=case, outcomes=outcomes)).rows
    return rows


def _placed(component: Any) -> Any:
    """The shape with its middle on the axis z and its top off the surface, where a field `Place` allows that."""
    name = place_field(type(component))
    if name is None:
        return component
    low, high = component.bounds
    x, y, z = getattr(component, name)
    lowered = max(0.0, _CLEARANCE * max(b - a for a, b in zip(low, high, strict=True)) - low[2])
    return replace(component, **{name: (x - (low[0] + high[0]) / 2, y - (low[1] + high[1]) / 2, z + lowered)})
