"""The numbers of a run in one small JSON file."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from eigencontact.core.numbers import ErrorBar, Number, headline_numbers
from eigencontact.results.atomic import replacing
from eigencontact.results.ownership import SUMMARY

if TYPE_CHECKING:
    from eigencontact.results.records import RunInfo, StepRecord

__all__ = ["headlines", "summary_of", "write_summary"]


def summary_of(
    info: RunInfo, record: StepRecord, history: Sequence[Mapping[str, Any]], extra: Mapping[str, Any]
) -> dict[str, Any]:
    """Content of ``summary.json``, from the last accepted step and the numbers of all steps by name, in order.

    Parameters
    ----------
    extra : mapping
        More entries, which also replace those here: ``peak_memory_bytes``, ``converged``, ``warnings`` (limits of the
        accuracy: code, words, error), ``files`` (names relative to the folder; what ``--overwrite`` later may remove).

    Returns
    -------
    dict
        SI units, plain values; None where a step lacks a number, or has one that is not finite. The numbers of
        `RunInfo.numbers` stand at the top level, each for the run by its rule `Number.over`; ``numbers`` repeats their
        declarations, ``units`` the units alone.
    """
    summary: dict[str, Any] = {
        "title": info.title,
        "name": info.name,
        "scene_hash": info.scene_hash,
        "converged": True,  # a step is only accepted, and stored, with its certificate
        "steps": len(history),
        "load_steps": len(history),
    }
    for name, number in info.numbers.items():
        value = number.of_run(row.get(name) for row in history) if number.over != "last" else record.scalars.get(name)
        counts = number.over == "sum" and number.unit == "1" and value is not None and math.isfinite(value)
        summary[name] = int(value) if counts and value is not None else value
    declared = info.numbers | {name: number for name, number in info.observed.items() if name in record.observed}
    summary |= {
        "peak_memory_bytes": None,
        "contact_modulus": info.contact_modulus,
        "warnings": [],
        "observed": dict(record.observed),
        "history": history,
        "units": {name: number.unit for name, number in declared.items()} | {"peak_memory_bytes": "byte"},
        "numbers": {name: asdict(number) for name, number in declared.items()},
        **({"precisions": info.precisions} if info.precisions else {}),
        "versions": dict(info.versions),
        "references": list(info.references),
        "files": [],
        **extra,
    }
    return dict(_plain(summary))


def headlines(summary: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Labels and values of the main results of a summary, with unit and error, without those that are always zero.

    Examples
    --------
    >>> radius = {"name": "contact_radius", "unit": "m", "meaning": "radius of the contact", "headline": True}
    >>> headlines({"numbers": {"contact_radius": radius}, "contact_radius": 6e-6, "observed": {}, "history": []})
    [('contact radius', '6 um')]
    """
    declared = {name: Number(**table) for name, table in summary["numbers"].items()}
    values: dict[str, Any] = {}
    for name in declared:
        value = summary.get(name, summary["observed"].get(name))
        if value or any(row.get(name) for row in summary["history"]):
            values[name] = value
    bars = {name: ErrorBar.of_dict(table) for name, table in summary.get("errors", {}).items()}
    lines = []
    for number in headline_numbers(declared.values(), values):
        text, bar = number.text(values[number.name]), bars.get(number.name)
        lines.append((number.words, f"{text} {bar.words(number)}" if bar is not None and bar.counts else text))
    return lines


def write_summary(folder: Path, summary: Mapping[str, Any]) -> Path:
    """Write ``summary.json`` into the folder of a run, atomically.

    Raises
    ------
    ResultsError
        When it cannot be stored.
    """
    path = folder / SUMMARY
    with replacing(path, "the summary") as sink:
        sink.write((json.dumps(summary, indent=2, allow_nan=False) + "\n").encode())
    return path


def _plain(value: Any) -> Any:
    """Plain JSON values: numpy scalars as numbers, infinite values and NaN as None, paths as text."""
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if hasattr(value, "item") and getattr(value, "ndim", None) == 0:
        value = value.item()
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return str(value) if isinstance(value, Path) else value
