"""Errors that the numbers of a run may have, and the reasons why a number can have no target."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from eigencontact.accuracy.sources import SOURCES
from eigencontact.core.numbers import ErrorBar, Number
from eigencontact.core.quantities import QUANTITIES, unit_of
from eigencontact.core.units import parse_quantity, readable
from eigencontact.errors import SceneError, nearest
from eigencontact.scene.accuracy import part_of

if TYPE_CHECKING:
    from eigencontact.accuracy.bars import Accuracy
    from eigencontact.planning.plan import Plan
    from eigencontact.scene.accuracy import Accuracy as Table

__all__ = ["ZERO", "Targets", "is_field", "scales_of", "targets_of", "variable_of"]

#: Numbers below this part of the largest of their unit are zero by symmetry: the tolerance of the solvers is 1e-6.
ZERO = 1e-5
#: A small number whose error is below this part of it is no zero: worn depths are small beside the contact.
_NOISE = 0.3


@dataclass(frozen=True, kw_only=True)
class Targets:
    """Allowed errors of the numbers of one run.

    Attributes
    ----------
    allowed : dict of str to float
        Largest error of each number that has a target, in its unit.
    texts : dict of str to str
        The same as the scene writes it.
    left_out : dict of str to str
        Main results without a target, and why.
    """

    allowed: dict[str, float]
    texts: dict[str, str] = field(default_factory=dict)
    left_out: dict[str, str] = field(default_factory=dict)

    def excess(self, errors: Mapping[str, float]) -> float:
        """Sum over all targets of the error beyond the allowed error, relative to the allowed error.

        Examples
        --------
        >>> Targets(allowed={"approach": 2.0}).excess({"approach": 3.0})
        0.5
        """
        return sum(max(0.0, errors[name] / limit - 1.0) for name, limit in self.allowed.items())

    def only(self, names: Iterable[str]) -> Targets:
        """Targets of some of the numbers."""
        return replace(self, allowed={name: self.allowed[name] for name in names})

    def hold(self, bars: Mapping[str, ErrorBar]) -> bool:
        """Whether every error bar is within its target."""
        return all(bars[name].error <= limit for name, limit in self.allowed.items())

    def to_dict(self, bars: Mapping[str, ErrorBar]) -> dict[str, Any]:
        """Plain data: each target with the error that was reached."""
        return {
            name: {
                "target": self.texts[name],
                "allowed": limit,
                "value": bars[name].value,
                "error": bars[name].error,
                "holds": bars[name].error <= limit,
            }
            for name, limit in self.allowed.items()
        }


def is_field(name: str) -> bool:
    """Whether a target is that of a field of a region: ``"von_mises.section"``."""
    return "." in name


def variable_of(name: str) -> str:
    """Variable of the results that a target of a field is about.

    Examples
    --------
    >>> variable_of("von_mises.section")
    'section_von_mises'
    """
    quantity, _, region = name.partition(".")
    return f"{region}_{quantity}"


def _key(name: str) -> str:
    """Name of a number or field in a scene.

    Examples
    --------
    >>> _key("max_pressure"), _key("von_mises.upper_half")
    ('max-pressure', 'von-mises.upper_half')
    """
    quantity, *region = name.split(".")
    return ".".join([quantity.replace("_", "-"), *region])


def check_names(table: Table, plan: Plan) -> None:
    """Refuse targets of numbers and fields that a run does not have, before anything is computed."""
    declared = _declared(plan)
    for name, target in table.targets.items():
        key, number = _key(name), declared.get(name)
        if number is None or number.role != "result":
            keys = [_key(result) for result, declaration in declared.items() if declaration.role == "result"]
            got = f"no {'field' if is_field(name) else 'number'} of this name"
            if number is not None:
                got = _KINDS[number.role]
            raise SceneError(
                f"accuracy.{key} must be a result of the scene (got {got}); ask for one of {', '.join(keys)}"
                f"{nearest(key, keys)}"
            )
        if part_of(target) is None:
            _in_unit(target, number)


def targets_of(table: Table, summary: Mapping[str, Any], accuracy: Accuracy, bars: Mapping[str, ErrorBar]) -> Targets:
    """Allowed errors of a run with its error bars; `bars` also has the fields with a target.

    Raises
    ------
    SceneError
        A number that the scene names cannot reach its target on any cells, or no main result can. The message gives the
        reason and possible targets.
    """
    declared = {name: Number(**number) for name, number in summary["numbers"].items()}
    declared |= {name: _of_field(name) for name in table.targets if is_field(name)}
    scales = scales_of(summary)
    allowed, texts, left_out = dict[str, float](), dict[str, str](), dict[str, str]()
    main = [name for name, number in declared.items() if number.headline and number.role == "result"]
    eligible = [name for name in main if not _reason(declared[name], accuracy, bars, scales)]
    target_of = {name: table.numbers for name in main if table.numbers is not None} | table.targets
    for name, target in target_of.items():
        number, key = declared.get(name), _key(name)
        absolute = part_of(target) is None
        reason = "the run has no such number" if number is None else _reason(number, accuracy, bars, scales)
        if absolute and reason == _AT_ZERO:
            reason = ""
        if reason and name in table.targets:
            raise SceneError(
                f"accuracy.{key} must be a number that can reach a target "
                f"(got {key}: {reason}); {_remedy(eligible, reason)}"
            )
        if absolute and name not in table.targets and number is not None:
            raise SceneError(
                f'accuracy.numbers must be a relative error, like "1 %" (got {target!r}); write {key} = {target!r}'
            )
        if reason or number is None:
            left_out[name] = reason
            continue
        relative, bar = part_of(target), bars[name]
        limit = _in_unit(target, number) if relative is None else relative * abs(bar.value)
        fixed = sum(error for source, error in bar.parts.items() if source in _FIXED)
        if fixed > limit:
            reason = f"the points of its region give it to {readable(fixed, number.unit)} only, on any cells"
            if name in table.targets:
                raise SceneError(
                    f"accuracy.{key} must be at least the error by points of [[stress]] (got {target!r}: {reason}); "
                    "use more points, or a larger error"
                )
            left_out[name] = reason
            continue
        allowed[name] = limit
        texts[name] = target if isinstance(target, str) else f"{100 * target:g} %"
    if not allowed:
        reasons = "; ".join(f"{name}: {reason}" for name, reason in left_out.items())
        raise SceneError(
            f"accuracy.numbers must apply to results that can reach a target (got {reasons}); name a number"
        )
    return Targets(allowed=allowed, texts=texts, left_out=left_out)


#: Errors that no setting of the run makes smaller.
_FIXED = frozenset(source.name for source in SOURCES if source.finer is None and not source.is_least_error)
#: Numbers that are no results, by their role.
_KINDS = {"certificate": "a certificate of the solvers", "error": "an estimated error", "effort": "an effort"}
_AT_ZERO = "zero by symmetry, and a part of zero is nothing"


def _reason(number: Number, accuracy: Accuracy, bars: Mapping[str, ErrorBar], scales: Mapping[str, float]) -> str:
    """Reason why a number can have no target; empty if it can."""
    if number.role != "result":
        return f"it is {_KINDS[number.role]}"
    if number.name in accuracy.left_out:
        return f"it does not converge: {accuracy.left_out[number.name]}"
    bar = bars.get(number.name)
    if bar is None:
        lacking = "; ".join(f"{source}: {words}" for source, words in accuracy.left_out.items())
        return f"it has no error bar{lacking and f' ({lacking})'}"
    small = abs(bar.value) < ZERO * scales.get(number.unit, 0.0)
    if bar.value == 0.0 or (small and bar.error > _NOISE * abs(bar.value)):
        return _AT_ZERO
    return (
        "" if bar.counts else "no setting of the run changes it: the scene prescribes it, or the points of a region do"
    )


def _remedy(eligible: Iterable[str], reason: str) -> str:
    """Targets that a scene can have instead."""
    names = ", ".join(name.replace("_", "-") for name in eligible)
    if reason == _AT_ZERO:
        return 'give an error with a unit, like "1 nm"'
    return f"ask for {names}" if names else "no main result of this scene can reach a target"


def _in_unit(target: float | str, number: Number) -> float:
    """Error with a unit in that of its number."""
    key = _key(number.name)
    if number.unit in ("1", "unknown"):
        raise SceneError(f'accuracy.{key} must be a relative error, like "1 %", as it has no unit (got {target!r})')
    unit = number.unit.replace("m2", "m^2").replace("m3", "m^3").replace(" ", "*")
    try:
        return float(parse_quantity(target, unit, "an error"))
    except ValueError as problem:
        raise SceneError(f"accuracy.{key} must be {problem} (got {target!r})") from None


def _declared(plan: Plan) -> dict[str, Number]:
    """All numbers of a run and of its observers, and the fields of its regions."""
    fields = [
        f"{quantity}.{request.label}"
        for request in plan.scene.stress
        for quantity in (*request.fields, *request.quantities)
    ]
    return {**plan.numbers, **plan.observed, **{name: _of_field(name) for name in fields}}


def _of_field(name: str) -> Number:
    """Declaration of a field of a region, like that of a number: its largest value has the error of the field."""
    quantity, _, region = name.partition(".")
    return Number(name=name, unit=unit_of(quantity), meaning=f"{QUANTITIES[quantity].long_name}, region {region}")


def scales_of(summary: Mapping[str, Any]) -> dict[str, float]:
    """Largest number of each unit, as a scale for numbers that are zero by symmetry."""
    scales: dict[str, float] = {}
    for name, number in summary["numbers"].items():
        value = summary.get(name, summary["observed"].get(name))
        if isinstance(value, int | float):
            scales[number["unit"]] = max(scales.get(number["unit"], 0.0), abs(value))
    arm = (summary.get("normal_load") or 0.0) * (summary.get("contact_radius") or 0.0)
    return {**scales, "N m": max(scales.get("N m", 0.0), arm)}
