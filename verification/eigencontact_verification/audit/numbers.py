"""Numbers of a run with error bars beside those of the finite elements of its audit, after ASME V&V 20.

The elements give fields, so that a number is compared at the place that decides it: E is the difference of the fields
there, and D the number of the run less E. A number whose place no compared line comes near is left out with the reason.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.audit.cases import AuditCase
from eigencontact_verification.audit.checks import WithoutElements
from eigencontact_verification.audit.contact_cases import ContactCase
from eigencontact_verification.crosscheck.case import Gap
from eigencontact_verification.crosscheck.comparison import Comparison, compared
from eigencontact_verification.crosscheck.judge import JudgedCase
from eigencontact_verification.crosscheck.lines import STRESSES

if TYPE_CHECKING:
    from eigencontact.core.numbers import ErrorBar, Number
    from eigencontact_verification.audit.stored import StoredStep

__all__ = ["Bars", "compared_numbers"]

FloatArray = NDArray[np.float64]
Bars = dict[str, "tuple[Number, ErrorBar]"]

#: A line has a number if its value there is so near to it.
_PLACE = 0.01
#: Kinds of lines of a whole contact, with their numbers.
_OF_LINES = {"approach": "approach", "radius": "contact_radius", "pressure": "max_pressure", "print": "print_depth"}
_COMPARED = (*_OF_LINES.values(), "contact_area", "max_von_mises")
#: Sources of error of both sides alike: the elements take the load steps of the run, or its state after them.
_SHARED = ("load steps",)
_SHEAR_TWICE = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])


class _Reading(NamedTuple):
    """Number of a run and of the elements at one place, and the uncertainty of the elements."""

    name: str
    stored: float
    reference: float
    uncertainty: float


def compared_numbers(
    stored: StoredStep, bars: Bars, judged: Iterable[JudgedCase]
) -> tuple[list[JudgedCase], list[Gap]]:
    """Comparisons of the numbers of a step, a case for each audited case; and numbers that no line has.

    Parameters
    ----------
    stored : StoredStep
        Last step of the run.
    bars : dict
        See `eigencontact_verification.audit.stored.bars_of`.
    judged : iterable of JudgedCase
        Cases of this run and of others.
    """
    barred = {name: bars[name] for name in _COMPARED if name in bars and _is_free(stored, name)}
    fresh = {
        name: pair
        for name, pair in barred.items()
        if np.isclose(stored.scalars[name], pair[1].value, rtol=1e-9, atol=0.0)
    }
    cases, read, far = [], set[str](), set[str]()
    for case in judged:
        if case.case.subject != stored.name or not case.estimates:
            continue
        readings: dict[str, _Reading] = {}
        for reading in _readings(case, stored):
            if reading.name not in fresh:
                continue
            value = fresh[reading.name][1].value
            off = abs(reading.stored - value)
            if off > _PLACE * abs(value):
                far.add(reading.name)
            elif reading.name not in readings or off < abs(readings[reading.name].stored - value):
                readings[reading.name] = reading
        read |= readings.keys()
        if readings:
            cases.append(_case(case, [_compared(case, *fresh[name], readings[name]) for name in readings]))
    gaps = [_gap(stored, name, "no compared line passes near its point") for name in sorted(far - read)]
    gaps += [
        _gap(stored, name, "the error bar belongs to another value") for name in sorted(barred.keys() - fresh.keys())
    ]
    return cases, gaps


def _is_free(stored: StoredStep, name: str) -> bool:
    """Whether a step has a value of a number that its scene does not prescribe."""
    return bool(stored.scalars.get(name)) and getattr(stored.scene.steps[-1], name, None) is None


def _gap(stored: StoredStep, name: str, reason: str) -> Gap:
    return Gap(subject=stored.name, what=f"comparison error of {name.replace('_', ' ')}", reason=reason)


def _compared(case: JudgedCase, number: Number, bar: ErrorBar, reading: _Reading) -> Comparison:
    u_sa, source = _of_run(bar)
    return compared(
        case.case.subject, f"{case.case.name}-numbers", number.name, number.words, simulation=bar.value,
        reference=bar.value - (reading.stored - reading.reference), u_sa=u_sa, u_fe=reading.uncertainty,
        unit=number.unit, source=source, remedy=case.case.remedy("discretisation", 1.0) or "repeat on finer meshes",
    )  # fmt: skip


def _of_run(bar: ErrorBar) -> tuple[float, str]:
    """Error of a run that the elements do not share, and its main source."""
    run_parts = {source: error for source, error in bar.parts.items() if source not in _SHARED}
    if len(run_parts) in (0, len(bar.parts)):
        return bar.error, bar.source
    source = max(run_parts, key=lambda name: run_parts[name])
    return max(run_parts[source], bar.error - sum(bar.parts[name] for name in _SHARED)), source


def _case(judged: JudgedCase, rows: Sequence[Comparison]) -> JudgedCase:
    case = WithoutElements(
        subject=judged.case.subject,
        name=f"{judged.case.name}-numbers",
        parameters={},
        quick=judged.case.quick,
        profiles=(),
    )
    return JudgedCase(case=case, rows=tuple(rows), outcomes=(), judged={}, estimates={})


def _readings(case: JudgedCase, stored: StoredStep) -> Iterator[_Reading]:
    """Numbers of all lines of a case; the estimates of a run's own error are no part of the elements' uncertainty."""
    for line in getattr(case.case, "lines", ()):
        name = line.profile.name
        estimate = case.estimates[name]
        band = estimate.uncertainty - estimate.parts.get("judged", 0.0)
        fields = line.values, estimate.value, band
        if isinstance(case.case, AuditCase):
            yield from _under_tractions(fields, line.profile.components, stored, line.indices)
        elif isinstance(case.case, ContactCase) and line.kind in _OF_LINES:
            scale = case.case.parameters["mesh"]["radius"] if line.kind == "radius" else 1.0
            yield from _of_contact(line.kind, *(scale * np.asarray(values)[:, 0] for values in fields))


def _of_contact(kind: str, values: FloatArray, reference: FloatArray, band: FloatArray) -> Iterator[_Reading]:
    """Numbers of a line of a whole contact: of the last step, or at the largest value."""
    if not values.size:
        return
    k = int(np.argmax(np.abs(values))) if kind in ("pressure", "print") else -1
    sign = float(np.sign(values[k])) or 1.0
    yield _Reading(_OF_LINES[kind], sign * values[k], sign * reference[k], band[k])
    if kind == "radius":
        area, reference_area = np.pi * values[k] ** 2, np.pi * reference[k] ** 2
        yield _Reading("contact_area", area, reference_area, 2.0 * np.pi * abs(reference[k]) * band[k])


def _under_tractions(
    fields: tuple[FloatArray, FloatArray, FloatArray], components: tuple[str, ...], stored: StoredStep,
    at: tuple[NDArray[np.intp], ...],
) -> Iterator[_Reading]:  # fmt: skip
    """Numbers of a line under stored tractions: displacement where the pressure is largest, largest von Mises stress.

    The gap is closed where there is pressure, so that the approach changes by what the displacement changes.
    """
    values, reference, band = fields
    pressure = stored.surface.get("pressure")
    if components == STRESSES:
        mises, _ = _von_mises(values)
        k = int(np.argmax(mises))
        reference_mises, slope = _von_mises(reference[k : k + 1])
        yield _Reading(
            "max_von_mises", float(mises[k]), float(reference_mises[0]), float((np.abs(slope) * band[k]).sum())
        )
    elif "u_z" in components and pressure is not None and np.any(pressure[at] > 0.0):
        column, k = components.index("u_z"), int(np.argmax(pressure[at]))
        depth = stored.scalars.get("approach", np.nan)
        change = values[k, column] - reference[k, column]
        yield _Reading("approach", depth, float(depth - change), float(band[k, column]))


def _von_mises(stress: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Von Mises stress (n,) of stress (n, 6), and its derivatives by the components."""
    deviator = stress - np.mean(stress[:, :3], axis=1, keepdims=True) * np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
    size = np.sqrt(1.5 * (_SHEAR_TWICE * deviator**2).sum(axis=1))
    return size, 1.5 * _SHEAR_TWICE * deviator / np.maximum(size, 1e-300)[:, None]
