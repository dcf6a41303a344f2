"""The numbers of a run in one small JSON file."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from eigencontact.results.atomic import replacing
from eigencontact.results.layout import SCALARS
from eigencontact.results.ownership import SUMMARY

if TYPE_CHECKING:
    from eigencontact.results.records import RunInfo, StepRecord

__all__ = ["summary_of", "write_summary"]

#: Scalars of the last step that stand at the top level; null where a run has none.
_LAST = (
    "normal_load",
    "approach",
    "contact_area",
    "contact_area_counted",
    "contact_radius",
    "max_pressure",
    "max_von_mises",
    "max_von_mises_depth",
    "max_uplift",
    "max_sink",
    "tangential_load_x",
    "tangential_load_y",
    "tangential_load",
    "shift_x",
    "shift_y",
    "shift_magnitude",
    "torsion_moment",
    "twist",
    "stick_radius",
    "slip_fraction",
    "dissipated_energy",
    "gap_residual",
    "penetration_residual",
    "load_residual",
    "bound_residual",
    "stick_residual",
    "alignment_residual",
    "coupling_residual",
    "inclusion_residual",
    "law_residual",
)
#: The same of scenes that wear.
_WORN = (
    "worn_volume",
    "max_worn_depth",
    "cycles",
    "wear_energy",
    "wear_error",
    "energy_volume_residual",
    "layer_error",
)
#: Scalars that are summed over all steps.
_SUMMED = (
    "iterations",
    "convolutions",
    "tangential_convolutions",
    "coupling_iterations",
    "inclusion_iterations",
    "substeps",
    "solve_seconds",
)


def summary_of(
    info: RunInfo, record: StepRecord, history: Sequence[Mapping[str, Any]], extra: Mapping[str, Any]
) -> dict[str, Any]:
    """Contents of ``summary.json``.

    Parameters
    ----------
    info : RunInfo
        What holds for all steps.
    record : StepRecord
        The last accepted step: loads, contact and residuals at the top level are those of this step;
        ``iterations``, ``convolutions``, ``tangential_convolutions``, ``substeps`` and ``solve_seconds`` are sums over
        all steps.
    history : sequence of mapping
        Numbers of every step by name, in order.
    extra : mapping
        More entries, which also replace those here: ``peak_memory_bytes``, ``converged``, ``warnings`` (what
        makes the numbers worth less than they look: code, words, error), ``files`` (names relative
        to the folder; what ``--overwrite`` later may remove).

    Returns
    -------
    dict
        SI units (``units`` in it names them), plain values; what does not exist or is not finite is None.
    """
    summary: dict[str, Any] = {
        "title": info.title,
        "name": info.name,
        "scene_hash": info.scene_hash,
        "converged": True,  # a step is only accepted, and stored, with its certificate
        "steps": len(history),
        "load_steps": len(history),
    }
    worn = tuple(name for name in _WORN if name in record.scalars)
    last = (*_LAST, *worn, *(("print_depth", "pile_up", *info.numbers) if info.numbers else ()))
    summary |= {name: record.scalars.get(name) for name in last}
    for name in _SUMMED:
        spent = [value for row in history if (value := row.get(name)) is not None]
        summary[name] = math.fsum(spent) if spent else None
    summary |= {name: int(summary[name]) for name in _SUMMED[:-1] if _finite(summary[name])}
    summary |= {
        "peak_memory_bytes": None,
        "contact_modulus": info.contact_modulus,
        "warnings": [],
        "observed": dict(record.observed),
        "history": history,
        "units": {name: (SCALARS | info.numbers)[name].unit for name in (*last, *_SUMMED)}
        | {"peak_memory_bytes": "byte"}
        | {name: unit for name, unit in info.observed_units.items() if name in record.observed},
        **({"precisions": info.precisions} if info.precisions else {}),
        "versions": dict(info.versions),
        "references": list(info.references),
        "files": [],
        **extra,
    }
    return dict(_plain(summary))


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


def _finite(value: Any) -> bool:
    return value is not None and math.isfinite(value)


def _plain(value: Any) -> Any:
    """Plain JSON values: numpy scalars become numbers, what is not finite becomes None, paths become text."""
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if hasattr(value, "item") and getattr(value, "ndim", None) == 0:
        value = value.item()
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return str(value) if isinstance(value, Path) else value
