"""Checks of optional abilities of constitutive laws: the law of a place, of a body, and the answer of a cell."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.plugin import HasCellAnswer, Surroundings
from eigencontact_verification.conformance.law_questions import (
    Question,
    answered,
    finite,
    history,
    law_check,
    law_of_points,
    pairs,
    some_strains,
    state_at_rest,
    stress_check,
)
from eigencontact_verification.conformance.report import check, ensure

FloatArray = NDArray[np.float64]

#: Differences that rounding, and iterations that stop at their own time, may leave; in parts of the size.
_ROUNDING, _ITERATED = 1e-9, 1e-7
#: Bodies that a law is put into.
_BODIES = ((7e10, 0.3), (2e11, 0.2))
_AROUND = Surroundings(young_modulus=7e10, poisson_ratio=0.2)


@stress_check
def check_law_at_places(law: Any) -> None:
    """The law that `at` gives of some points answers as the law itself does at those points."""
    if not law.varies:
        return
    for question, answer in history(law):
        local = answered(law_of_points(law, question.step), question)
        for quantity, itself, local_values in pairs(answer, local):
            size = float(np.abs(itself).max(initial=0.0))
            ensure(
                np.allclose(itself, local_values, rtol=0.0, atol=_ROUNDING * size),
                f"{quantity} of the law of the points", "that of the law itself", "something else",
                "let update ask self.at(step.x, step.y, step.z)",
            )  # fmt: skip


@stress_check
def check_parts_of_law(law: Any) -> None:
    """Every point has one of the laws that a law is made of, and that answers as the law itself does there."""
    if not law.varies:
        return
    for question, answer in history(law):
        step = question.step
        laws = law.laws_at(step.x, step.y, step.z)
        ensure(
            np.array_equal(np.sum([where for _, where in laws], axis=0), np.ones(question.count)),
            "laws_at", "one law for every point", "none, or several", "",
        )  # fmt: skip
        for sublaw, where in laws:
            place = replace(step, x=step.x[where], y=step.y[where], z=step.z[where])
            before = {name: question.before[name][:, where] for name in sublaw.variables}
            local = answered(sublaw, Question(question.strain[:, where], before, place))
            size = float(np.abs(answer.stress).max(initial=0.0))
            ensure(
                np.allclose(answer.stress[:, where], local.stress, rtol=0.0, atol=_ROUNDING * size),
                f"stress of the part {sublaw.key!r}", "that of the law itself", "something else",
                "let update ask the laws of laws_at",
            )  # fmt: skip
            for name, values in local.variables.items():
                equal = np.array_equal(answer.variables[name][:, where], values)
                ensure(equal, f"variable {name!r} of the part {sublaw.key!r}", "that of the law itself", "another", "")


@check
def check_law_of_body(law: Any) -> None:
    """What a law takes from the body it keeps in another, and what it was given it keeps in any."""
    first = law.of_body(*_BODIES[0])
    again = first.of_body(*_BODIES[1])
    ensure(
        again == first, "the law of a body, put into another", "as it was in the first", repr(again),
        "fill in what is None, and nothing else",
    )  # fmt: skip


@law_check
def check_cell_answer(law: Any) -> None:
    """A cell's own answer is the eigenstrain at which `update` gives the stress of the cell, and remembers the same."""
    ready: Any = law if isinstance(law, HasCellAnswer) and finite(law) else None
    if ready is None:
        return
    prestrain = 0.3 * some_strains(seed=11)
    for question, _ in history(law):
        foreign = _AROUND.young_modulus * some_strains(seed=12)
        for array in (foreign, prestrain, *question.before.values()):
            array.flags.writeable = False
        strain, after = ready.cell_answer(foreign, prestrain, _AROUND, question.before, question.step)
        ensure(
            isinstance(strain, np.ndarray) and strain.shape == foreign.shape and bool(np.isfinite(strain).all()),
            "cell_answer", f"finite, of shape {foreign.shape}", getattr(strain, "shape", type(strain).__name__), "",
        )  # fmt: skip
        stress = foreign - _stress_of(strain)
        law_answer = answered(law, Question(_strain(stress) + strain - prestrain, question.before, question.step))
        stiffness = np.abs(law_answer.tangent).max(axis=(0, 1))
        size = np.linalg.norm(foreign, axis=0) + stiffness * np.linalg.norm(prestrain, axis=0)
        error = float((np.abs(law_answer.stress - stress) / size).max())
        ensure(
            error <= _ITERATED, "stress of a cell by cell_answer", "that of update for its strain",
            f"off by {error:.1e}", "the eigenstrain holds the prestrain; see Surroundings for what it takes away",
        )  # fmt: skip
        ensure(set(after) == set(law.variables), "variables of cell_answer", "those declared", set(after), "")
        for name, values in law_answer.variables.items():
            near = np.allclose(after[name], values, rtol=0.0, atol=_ITERATED * float(np.abs(values).max()))
            ensure(near, f"variable {name!r} of cell_answer", "that of update", "something else", "")


@law_check
def check_means(law: Any) -> None:
    """Where the means about the points are their own values, the answer is that without means; else it is another."""
    averaged = dict(law.averaged)
    if not averaged:
        return
    declared: Any = state_at_rest(law, 0)
    unknown = sorted(set(averaged) - set(declared))
    ensure(not unknown, "averaged", f"names of variables, {sorted(declared)}", unknown, "declare them")
    for name, radius in averaged.items():
        ensure(0 < radius < np.inf, f"radius of {name!r}", "positive and finite [m]", radius, "")
    differs = False
    for question, answer in history(law):
        means = {name: np.array(answer.variables[name]) for name in averaged}
        at_means = answered(law, Question(question.strain, question.before, replace(question.step, means=means)))
        twice = {name: 2.0 * values for name, values in means.items()}
        at_double_means = answered(law, Question(question.strain, question.before, replace(question.step, means=twice)))
        for quantity, without, expected in pairs(answer, at_means):
            size = float(np.abs(without).max(initial=0.0))
            ensure(
                quantity == "tangent" or np.allclose(without, expected, rtol=0.0, atol=_ITERATED * size),
                f"{quantity} where means are the points' own", "that without means", "something else",
                "take step.means[name] where it is there, the value after the increment elsewhere",
            )  # fmt: skip
        differs |= not np.allclose(answer.stress, at_double_means.stress, rtol=1e-6, atol=0.0)
    ensure(differs, "stress at twice the means", "another one", "the same", "let what is averaged act by step.means")


def _stress_of(eigenstrain: FloatArray) -> FloatArray:
    """Stress of a cell that its own eigenstrain takes away."""
    mean = eigenstrain[:3].mean(axis=0)
    out = _AROUND.shear_stiffness * eigenstrain
    out[:3] += (_AROUND.bulk_stiffness - _AROUND.shear_stiffness) * mean
    return out


def _strain(stress: FloatArray) -> FloatArray:
    """Strain of the material around under a stress."""
    out = (1.0 + _AROUND.poisson_ratio) / _AROUND.young_modulus * stress
    out[:3] -= _AROUND.poisson_ratio / _AROUND.young_modulus * stress[:3].sum(axis=0)
    return out
