"""Checks of the stress of constitutive laws: a true tangent, no preferred axes, no energy out of nothing."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass, replace
from typing import Any, get_type_hints

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.quantities import DirectionMark
from eigencontact.plugin import LinearLaw, Rotation, as_tuple, mandel_rotation, rotation_matrix
from eigencontact_verification.conformance.common import annotations_of
from eigencontact_verification.conformance.law_questions import (
    Question,
    along,
    answered,
    finite,
    history,
    law_check,
    law_of_points,
    some_strains,
    step_at,
    stress_check,
)
from eigencontact_verification.conformance.report import ensure

FloatArray = NDArray[np.float64]

#: Steps of finite differences, in parts of the strain, and what they may differ by from the tangent, in parts of it;
#: forward and backward ones that differ by more are of a kink.
_STEP, _NEAR, _BEND = 1e-4, 1e-5, 1e-2
#: Rounding, and what an iteration inside a law may leave.
_ROUNDING = 1e-8
#: Increments of a closed path of strain, of linear laws (any number does) and of others; energy that may be left by
#: their number, in parts of the work to and fro.
_INCREMENTS_LINEAR, _INCREMENTS, _LEAST_WORK = 12, 64, 1e-3
_TURN = rotation_matrix("turn", (0.7, -0.4, 1.9))


@stress_check
def check_tangent(law: Any) -> None:
    """The tangent is the derivative of the stress by the strain, at rest and within an increment with a history."""
    for number, (question, answer) in enumerate(history(law), 1):
        (wide, _), (near, bend) = (_differences(law, question, answer.stress, fraction) for fraction in (1.0, 0.5))
        size = np.abs(answer.tangent).max(axis=(0, 1)) + np.abs(near).max(axis=(0, 1)) + np.finfo(float).tiny
        smooth = (np.abs(wide - near).max(axis=(0, 1)) <= _NEAR * size) & (bend.max(axis=(0, 1)) <= _BEND * size)
        ensure(
            2 * smooth.sum() >= smooth.size, f"stress in increment {number}", "smooth at most strains",
            f"smooth at {int(smooth.sum())} of {smooth.size}", "iterate to rounding within the law; kinks may be few",
        )  # fmt: skip
        error = np.where(smooth, np.abs(answer.tangent - near).max(axis=(0, 1)) / size, 0.0)
        worst = int(np.argmax(error))
        ensure(
            error[worst] <= _NEAR, f"tangent in increment {number} at a strain of {question.strain[:, worst]}",
            "the derivative of the stress by the strain", f"off by {error[worst]:.1e} of its largest entry",
            "row: stress, column: strain, both Mandel; within an increment the variables before stay as they are",
        )  # fmt: skip


def _differences(law: Any, question: Question, stress: FloatArray, fraction: float) -> tuple[FloatArray, FloatArray]:
    """Central differences ``(6, 6, n)``, and how far forward ones are from backward ones, by part of the step."""
    step = fraction * _STEP * np.linalg.norm(question.strain, axis=0)
    out, bend = np.empty((6, 6, question.count)), np.empty((6, 6, question.count))
    for column in range(6):
        change = np.zeros_like(question.strain)
        change[column] = step
        up, down = (
            answered(law, Question(question.strain + sign * change, question.before, question.step)).stress
            for sign in (1.0, -1.0)
        )
        out[:, column] = (up - down) / (2.0 * step)
        bend[:, column] = np.abs(up - 2.0 * stress + down) / step
    return out, bend


@stress_check
def check_tangent_symmetry(law: Any) -> None:
    """The tangent is symmetric, unless the law says that it is not: ``symmetric = False``."""
    if not law.symmetric:
        return
    for _, answer in history(law):
        size = np.abs(answer.tangent).max(axis=(0, 1)) + np.finfo(float).tiny
        skew = float((np.abs(answer.tangent - answer.tangent.swapaxes(0, 1)).max(axis=(0, 1)) / size).max(initial=0.0))
        ensure(
            skew <= _ROUNDING, "tangent", "symmetric", f"off by {skew:.1e} of its largest entry",
            "say symmetric: ClassVar[bool] = False where the law is so",
        )  # fmt: skip


@law_check
def check_objectivity(law: Any) -> None:
    """Turn the strain, what is remembered and the directions of the material, and the stress is turned."""
    turned, has_directions = _turned(law)
    ensure(
        has_directions or law.isotropic, "the law", "isotropic, or with directions that can be turned", "neither",
        "say isotropic: ClassVar[bool] = True, or annotate fields with Direction or Rotation; a law that is bound to "
        "the axes of the scene waives this check",
    )  # fmt: skip
    Q = mandel_rotation(_TURN)
    if not finite(law):
        stiff, expected = (law_of_points(elastic_law, step_at()).factors(8e10)[1] for elastic_law in (turned, law))
        _alike("stiff", stiff, Q @ expected @ Q.T, 1.0)
        return
    before: Mapping[str, FloatArray] | None = None
    for question, answer in history(law):
        before = _turned_variables(law, question.before, Q) if before is None else before
        turned_answer = answered(turned, Question(Q @ question.strain, before, question.step))
        size = np.abs(answer.tangent).max(axis=(0, 1)) * np.linalg.norm(question.strain, axis=0)
        _alike("stress", turned_answer.stress, Q @ answer.stress, size)
        expected = np.einsum("ai,ijn,bj->abn", Q, answer.tangent, Q)
        _alike("tangent", turned_answer.tangent, expected, np.abs(expected).max(axis=(0, 1)))
        for name, values in _turned_variables(law, answer.variables, Q).items():
            _alike(f"variable {name!r}", turned_answer.variables[name], values, float(np.abs(values).max()))
        before = turned_answer.variables


def _turned(law: Any) -> tuple[Any, bool]:
    """Law with every direction turned, those of parts of it too, and whether there is one."""
    hints, changes = get_type_hints(type(law), include_extras=True), {}
    for item in fields(law):
        value, hint = getattr(law, item.name), hints[item.name]
        if hint in (Rotation, Rotation | None):
            changes[item.name] = as_tuple(_TURN @ rotation_matrix(law.key, value))
        elif value is not None and DirectionMark() in annotations_of(hint):
            changes[item.name] = as_tuple((_TURN @ np.asarray(value, dtype=float).T).T)
        else:
            component, has_directions = _turned_parts(value)
            changes |= {item.name: component} if has_directions else {}
    return (replace(law, **changes), True) if changes else (law, False)


def _turned_parts(value: Any) -> tuple[Any, bool]:
    """Components that a law holds, one or several, turned, and whether there is one to turn."""
    if isinstance(value, tuple):
        pairs = [_turned_parts(component) for component in value]
        return tuple(component for component, _ in pairs), any(has_directions for _, has_directions in pairs)
    return _turned(value) if is_dataclass(value) and not isinstance(value, type) else (value, False)


def _turned_variables(law: Any, variables: Mapping[str, FloatArray], Q: FloatArray) -> dict[str, FloatArray]:
    """Variables of six components turned, as Mandel vectors; all others as they are."""
    return {n: Q @ values if law.variables[n].components == 6 else values for n, values in variables.items()}


def _alike(quantity: str, got: FloatArray, expected: FloatArray, size: FloatArray | float) -> None:
    error = np.abs(got - expected) / (size + np.finfo(float).tiny)
    ensure(
        error.max(initial=0.0) <= _ROUNDING, f"{quantity} of the law turned, under strain turned",
        f"the {quantity}, turned", f"off by {error.max(initial=0.0):.1e}",
        "use invariants; a variable of six components is a Mandel vector",
    )  # fmt: skip


@stress_check
def check_energy(law: Any) -> None:
    """A closed path of strain from rest costs work or none, and never gives any; of a linear law it costs none."""
    linear = isinstance(law_of_points(law, step_at()), LinearLaw)
    count = _INCREMENTS_LINEAR if linear else _INCREMENTS
    first, second = some_strains(), some_strains(seed=5)
    second *= np.linalg.norm(first, axis=0) / np.linalg.norm(second, axis=0)
    angle = 2.0 * np.pi * np.arange(2 * count + 1)[:, None, None] / count
    ways = {"to and fro": 0.0, "round a loop": 1.0, "round a loop the other way": -1.0}
    path = np.concatenate([(1.0 - np.cos(angle)) * first + a * np.sin(angle) * second for a in ways.values()], axis=-1)
    path[count] = path[-1] = 0.0
    stress = np.stack([np.zeros(path[0].shape), *(answer.stress for answer in along(law, path[1:]))])
    work_of_parts = 0.5 * (stress[1:] + stress[:-1]) * np.diff(path, axis=0)
    for way, path_work in zip(ways, np.split(work_of_parts, len(ways), axis=-1), strict=True):
        size = np.abs(path_work).sum(axis=(0, 1)) + np.finfo(float).tiny
        for turns in (1, 2):
            work = path_work[: turns * count].sum(axis=(0, 1)) / size
            ensure(
                work.min() >= -(_ROUNDING if linear else _LEAST_WORK),
                f"work of strain {way}, {turns} times", "zero or positive", f"{work.min():.2e} of all work on the way",
                "stress must not do work on a closed path: a sign, a skew stiffness, energy stored at rest",
            )  # fmt: skip
            ensure(
                not linear or work.max() <= _ROUNDING, f"work of strain {way}, {turns} times", "zero",
                f"{work.max():.2e} of all work on the way", "a linear law stores energy and gives it back",
            )  # fmt: skip
