"""Checks of the arrays of constitutive laws: shapes, declared variables, points that do not see each other."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.units import parse_quantity
from eigencontact.plugin import LawStep, Response, Variable
from eigencontact_verification.conformance.law_questions import (
    Question,
    answered,
    history,
    law_check,
    pairs,
    parts,
    some_strains,
    state_at_rest,
    step_at,
    stress_check,
)
from eigencontact_verification.conformance.report import ensure

FloatArray = NDArray[np.float64]

#: Differences that rounding, and iterations that stop at their own time, may leave; in parts of the size.
_ROUNDING = 1e-9
#: Names that results use beside those of variables.
_RESERVED = ("equivalent_eigenstrain",)


@law_check
def check_variables(law: Any) -> None:
    """What a point remembers is declared: a name, components, a unit, a meaning."""
    ensure(isinstance(law.variables, Mapping), "variables", "a mapping of names to Variable", repr(law.variables), "")
    for name, item in law.variables.items():
        where = f"variables[{name!r}]"
        good = isinstance(name, str) and name.isidentifier() and name == name.lower() and name not in _RESERVED
        advice = f"it names the stored values; {', '.join(_RESERVED)} is taken"
        ensure(good, where, "a name in lower case with underscores", repr(name), advice)
        ensure(isinstance(item, Variable), where, "a Variable", repr(item), "Variable(unit=..., meaning=...)")
        count = item.components
        ensure(type(count) is int and count >= 1, f"{where}.components", "1 or more", repr(count), "6: a Mandel vector")
        ensure(str(item.meaning).strip(), f"{where}.meaning", "said in words", repr(item.meaning), "")
        ensure(_is_unit(item.unit), f"{where}.unit", 'an SI unit, "1" of a number', repr(item.unit), "write J/m^3")


def _is_unit(unit: Any) -> bool:
    if not isinstance(unit, str):
        return False
    if unit == "1":
        return True
    try:
        return bool(parse_quantity(f"1 {unit}", unit, "a number") == 1.0)
    except ValueError:
        return False


@stress_check
def check_response_shapes(law: Any) -> None:
    """Stress (6, n), tangent (6, 6) or (6, 6, n), the declared variables; finite, also at no point and in no time."""
    for count in (0, 1, 2, 24):
        for duration in (1.0, 0.0):
            question = Question(
                some_strains(count), state_at_rest(law, count), step_at(count, time=duration, duration=duration)
            )  # fmt: skip
            _complete(law, question, f"{count} points, duration {duration:g}")
    for question, _ in history(law):
        _complete(law, question, "points with a history")


def _complete(law: Any, question: Question, case: str) -> None:
    answer, count = law.update(question.strain, question.before, question.step), question.count
    ensure(isinstance(answer, Response), "the answer", "a Response", type(answer).__name__, "see eigencontact.plugin")
    _formed(answer.stress, [(6, count)], f"stress of {case}")
    _formed(answer.tangent, [(6, 6, count), (6, 6)], f"tangent of {case}")
    ensure(
        set(answer.variables) == set(law.variables), f"variables after, of {case}",
        f"those declared, {set(law.variables)}", set(answer.variables),
        "declare each in the class attribute variables, and return each",
    )  # fmt: skip
    for name, item in law.variables.items():
        _formed(answer.variables[name], [(item.components, count)], f"variable {name!r} of {case}")


def _formed(values: Any, shapes: list[tuple[int, ...]], subject: str) -> None:
    good = isinstance(values, np.ndarray) and values.shape in shapes and values.dtype == np.float64
    got = f"{values.dtype} of shape {values.shape}" if isinstance(values, np.ndarray) else type(values).__name__
    ensure(good, subject, f"float64 of shape {' or '.join(map(str, shapes))}", got, "points are the last axis")
    ensure(np.all(np.isfinite(values)), subject, "finite", f"{int(np.sum(~np.isfinite(values)))} numbers not", "")


@stress_check
def check_rest(law: Any) -> None:
    """At rest, without strain, there is no stress, the tangent is finite, and what is remembered stays zero."""
    for duration in (1.0, 0.0):
        question = Question(np.zeros((6, 8)), state_at_rest(law, 8), step_at(8, time=1.0, duration=duration))
        answer = answered(law, question)
        ensure(
            np.all(answer.stress == 0.0), f"stress without strain at rest, duration {duration:g}", "zero",
            np.abs(answer.stress).max(),
            "stress counts from a stress-free state; NaN: take limits where a norm is zero",
        )  # fmt: skip
        ensure(np.all(np.isfinite(answer.tangent)), "tangent without strain at rest", "finite", "not", "take the limit")
        for name, values in answer.variables.items():
            ensure(
                np.all(values == 0.0), f"variable {name!r} without strain at rest", "zero, as it was",
                np.abs(values).max(), "store what has been added since the state at rest",
            )  # fmt: skip


@stress_check
def check_update_pure(law: Any) -> None:
    """Same answer twice, another question in between; arrays stay as they were, and may be read-only."""
    (second, _), *_, (question, _) = history(law)
    step = question.step
    arrays = (question.strain, *question.before.values(), step.x, step.y, step.z)
    copies_of_arrays = [array.copy() for array in arrays]
    first = law.update(question.strain, question.before, step)
    copies = [np.array(tensor) for tensor in parts(first)]
    unchanged = all(np.array_equal(array, copy) for array, copy in zip(arrays, copies_of_arrays, strict=True))
    ensure(unchanged, "the arrays of the question", "unchanged", "changed", "write to copies only")
    law.update(second.strain, second.before, second.step)
    handed = [np.array(tensor) for tensor in parts(first)]
    for array in arrays:
        array.flags.writeable = False
    for again in (handed, parts(law.update(question.strain, question.before, step))):
        ensure(
            all(map(np.array_equal, again, copies)), "the answer to the same question",
            "the same", "different", "keep no memory of what was asked, hand out new arrays: `before` is the history",
        )  # fmt: skip


@stress_check
def check_points_alone(law: Any) -> None:
    """The answer at many points is that at each of them alone, whatever the others are."""
    for question, _ in history(law):
        whole = answered(law, question)
        for point in range(0, question.count, 5):
            single = answered(law, _at_point(question, point))
            for quantity, array, value in pairs(whole, single):
                size = float(np.abs(array).max(initial=0.0))
                ensure(
                    np.allclose(array[..., point : point + 1], value, rtol=0.0, atol=_ROUNDING * size),
                    f"{quantity} of point {point} among {question.count}", "what it is of that point alone",
                    "something else", "treat every point alike: no `if` on arrays, no maximum over all points",
                )  # fmt: skip


def _at_point(question: Question, point: int) -> Question:
    """One point of a question."""
    columns, step = slice(point, point + 1), question.step
    place = LawStep(x=step.x[columns], y=step.y[columns], z=step.z[columns], time=step.time, duration=step.duration)
    return Question(question.strain[:, columns], {n: v[:, columns] for n, v in question.before.items()}, place)
