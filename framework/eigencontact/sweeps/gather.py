"""Dataset of all numbers of a sweep, with the varied parameters as coordinates; and a table of text."""

from __future__ import annotations

import csv
import io
import math
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.core.field_error import error_name
from eigencontact.core.numbers import Number
from eigencontact.core.quantities import QUANTITIES, unit_of
from eigencontact.core.units import parse_quantity, readable
from eigencontact.errors import ResultsError, shown
from eigencontact.reference.places import key_at

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    import xarray

    from eigencontact.sweeps.axes import Axis
    from eigencontact.sweeps.runner import Outcome
    from eigencontact.sweeps.variants import Variant

__all__ = ["FIELD", "as_csv", "codes_of", "gathered", "values_in_words", "warnings_in_words"]

#: Before the name of a field that is the name of a number as well.
FIELD = "field_"
#: Values of an axis that a line lists.
_LISTED = 12


def gathered(
    axes: Sequence[Axis], variants: Sequence[Variant], results: Sequence[Outcome], title: str, *, pairs: bool
) -> xarray.Dataset:
    """Dataset of all numbers at the last load step, by the dimensions of the axes; of axes in step by ``variant``.

    Numbers are NaN where a variant failed or has none, and ``failed`` says why. Chosen fields have ``y`` and ``x`` as
    well. The results may come in any order.
    """
    import xarray as xr

    shape = (len(axes[0].values),) if pairs else tuple(len(axis.values) for axis in axes)
    dims = ("variant",) if pairs else tuple(axis.name for axis in axes)
    data: dict[str, Any] = {}
    numbers = {outcome.place: _numbers(outcome.summary) for outcome in results}
    tables = {name: table for outcome in results for name, table in outcome.summary.get("numbers", {}).items()}
    declared = {name: Number(**table) for name, table in tables.items()}
    declared |= {error_name(name): number.own_error(error_name(name)) for name, number in declared.items()}
    for name in dict.fromkeys(name for row in numbers.values() for name in row):
        values = np.full(shape, np.nan)
        for place, row in numbers.items():
            values[place] = row.get(name, np.nan)
        data[name] = (dims, values, declared[name].attributes() if name in declared else {"units": "1"})
    failed, seconds = np.full(shape, "", dtype=object), np.zeros(shape)
    warned = failed.copy()
    for outcome in results:
        failed[outcome.place], seconds[outcome.place] = outcome.failed, outcome.seconds
        warned[outcome.place] = codes_of(outcome.summary)
    data["failed"] = (dims, failed.astype(str), {"long_name": "why a variant failed"})
    data["warnings"] = (dims, warned.astype(str), {"long_name": "codes of the warnings of a variant"})
    data["variant_seconds"] = (dims, seconds, {"units": "s", "long_name": "wall time of a variant"})
    coordinates = {axis.name: (dims if pairs else (axis.name,), *_coordinate(axis, variants, k))
                   for k, axis in enumerate(axes)}  # fmt: skip
    dataset = xr.Dataset(data, coordinates, {"title": title, "source": "eigencontact sweep"})
    return _with_fields(dataset, dims, shape, results)


def _numbers(summary: Mapping[str, Any]) -> dict[str, float]:
    """Numbers of a summary: those of the last step, sums, those of observers, and error estimates if any."""
    errors = {error_name(name): bar["error"] for name, bar in summary.get("errors", {}).items()}
    plain = {**summary, **summary.get("observed", {}), **errors}
    return {name: float(value) for name, value in plain.items()
            if isinstance(value, int | float) and not isinstance(value, bool)}  # fmt: skip


def _coordinate(axis: Axis, variants: Sequence[Variant], k: int) -> tuple[Any, dict[str, str]]:
    """Values of an axis in SI units, as in the scenes; texts if they are not numbers."""
    values, unit = _in_si(axis, variants, k)
    attrs = {"long_name": axis.key, **({"units": unit} if unit else {})}
    if all(isinstance(value, int | float) and not isinstance(value, bool) for value in values):
        return np.array(values, dtype=float), attrs
    return np.array([str(value) for value in axis.values]), {"long_name": axis.key}


def _in_si(axis: Axis, variants: Sequence[Variant], k: int) -> tuple[list[Any], str]:
    """Values of the axis number `k`, quantities as numbers in SI units; and this unit, or nothing."""
    values_of_scenes: dict[int, Any] = {}
    key = None
    for variant in variants:
        at = variant.place[min(k, len(variant.place) - 1)]
        if at not in values_of_scenes and variant.scene is not None:
            tables = variant.scene.resolved()
            values_of_scenes[at] = _value_at(tables, axis.key)
            key = key or key_at(variant.scene.known_plugins(), tables, axis.key)
    unit = (key.unit if key is not None else "") or ""
    in_si = []
    for value in [values_of_scenes.get(at, value) for at, value in enumerate(axis.values)]:
        try:
            in_si.append(parse_quantity(value, unit, axis.key) if unit else value)
        except ValueError:  # text that is no quantity: its variant is refused
            in_si.append(value)
    return in_si, unit


def values_in_words(axes: Sequence[Axis], variants: Sequence[Variant]) -> list[str]:
    """One line for each axis: its values with unit, and a hint at a decimal comma."""
    lines = []
    for k, axis in enumerate(axes):
        values, unit = _in_si(axis, variants, k)
        texts = [value if isinstance(value, str) else readable(value, unit) if unit and isinstance(value, int | float)
                 else shown(value) for value in values]  # fmt: skip
        listed = texts if len(texts) <= _LISTED else [*texts[: _LISTED - 2], "...", texts[-1]]
        plain = [isinstance(value, int | float) for value in axis.values]
        mixed = bool(unit) and any(plain) and not all(plain)  # "0,5 N"
        hint = "; a comma separates values: write decimals with a point" if mixed else ""
        lines.append(f"{axis.key}: {len(texts)} {'value' if len(texts) == 1 else 'values'}: {', '.join(listed)}{hint}")
    return lines


def _value_at(table: Any, key: str) -> Any:
    for name_part in key.split("."):
        if isinstance(table, list):
            number = name_part.isdigit()
            table = table[int(name_part)] if number else table[0]
            if number:
                continue
        table = next(
            (value for name, value in table.items() if name.replace("_", "-") == name_part.replace("_", "-")), None
        )
        if table is None:
            return None
    return table


def _with_fields(
    dataset: xarray.Dataset, dims: tuple[str, ...], shape: tuple[int, ...], results: Sequence[Outcome]
) -> xarray.Dataset:
    """Dataset with the chosen fields; their cells must be the same in all variants."""
    holding = [outcome for outcome in results if outcome.fields]
    if not holding:
        return dataset
    first = holding[0].fields
    for outcome in holding:
        for name in ("x", "y"):
            reference, places = first[name], outcome.fields[name]
            if reference.shape != places.shape or not np.allclose(
                reference, places, rtol=1e-9, atol=1e-12 * np.abs(reference).max()
            ):
                raise ResultsError(
                    f"fields must lie on the same cells in all variants (got {reference.size} and {places.size} along "
                    f'{name} or others); give grid = "shared" (--shared-grid), or grid.cells and grid.size'
                )
    dataset = dataset.assign_coords({name: ((name,), first[name], {"units": "m"}) for name in ("x", "y")})
    for name in first:
        if name in ("x", "y"):
            continue
        values = np.full((*shape, *first[name].shape), np.nan)
        for outcome in holding:
            values[outcome.place] = outcome.fields[name]
        attrs = {"units": unit_of(name), "long_name": QUANTITIES[name].long_name} if name in QUANTITIES else {}
        dataset[f"{FIELD}{name}" if name in dataset else name] = ((*dims, "y", "x"), values, attrs)
    return dataset


def as_csv(axes: Sequence[Axis], variants: Sequence[Variant], results: Sequence[Outcome]) -> str:
    """One line per variant: its values, numbers in SI units, reason of failure, codes of warnings."""
    rows = {outcome.place: _numbers(outcome.summary) for outcome in results}
    names = list(dict.fromkeys(name for row in rows.values() for name in row))
    text = io.StringIO()
    sheet = csv.writer(text, lineterminator="\n")
    sheet.writerow([*(axis.key for axis in axes), *names, "failed", "warnings"])
    failed = {outcome.place: outcome.failed for outcome in results}
    warned = {outcome.place: codes_of(outcome.summary) for outcome in results}
    for variant in variants:
        row = rows.get(variant.place, {})
        numbers = [repr(row[name]) if name in row and math.isfinite(row[name]) else "" for name in names]
        remarks = (failed.get(variant.place, ""), warned.get(variant.place, ""))
        sheet.writerow([*variant.values.values(), *numbers, *remarks])
    return text.getvalue()


def codes_of(summary: Mapping[str, Any]) -> str:
    """Codes of the warnings of a variant as one text, each once; empty without any.

    Examples
    --------
    >>> codes_of({"warnings": [{"code": "slow-place", "words": "a place"}]})
    'slow-place'
    """
    return ", ".join(dict.fromkeys(caution["code"] for caution in summary.get("warnings", ())))


def warnings_in_words(warnings: Mapping[str, Sequence[Mapping[str, Any]]], total: int) -> list[str]:
    """One line for each code: how many of `total` variants warn, and the sentence of the first variant that warns.

    `warnings` are those of ``summary.json`` (``code``, ``words``, ``error``) by label of the variant. The line names
    the variant where the sentences of the variants differ, because they contain numbers.

    Examples
    --------
    >>> warnings = {label: [{"code": "slow-place", "words": f"{label} lags", "error": 0.1}] for label in "ab"}
    >>> warnings_in_words(warnings, 3)
    ["2 of 3 variants warn: slow-place: a lags (in 'a')"]
    """
    by_code: dict[str, dict[str, str]] = {}
    for label, cautions in warnings.items():
        for caution in reversed(cautions):
            by_code.setdefault(caution["code"], {})[label] = caution["words"]
    return [_warning_line(code, sentences, total) for code, sentences in by_code.items()]


def _warning_line(code: str, sentences: Mapping[str, str], total: int) -> str:
    """Line of one code, from the sentence of each variant that warns."""
    first, sentence = next(iter(sentences.items()))
    place = f" (in {first!r})" if len(set(sentences.values())) > 1 else ""
    return (
        f"{len(sentences)} of {total} variants {'warns' if len(sentences) == 1 else 'warn'}: {code}: {sentence}{place}"
    )
