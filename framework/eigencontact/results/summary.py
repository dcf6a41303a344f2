"""The numbers of a run in one small JSON file."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from eigencontact.results.atomic import open_hdf5, replacing
from eigencontact.results.layout import SCALARS
from eigencontact.results.ownership import SUMMARY
from eigencontact.results.store import RESULTS, STEPS

if TYPE_CHECKING:
    from eigencontact.results.records import RunInfo, StepRecord

__all__ = ["run_history", "write_summary"]

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
    "shift",
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


def write_summary(folder: Path, info: RunInfo, record: StepRecord, extra: Mapping[str, Any]) -> Path:
    """Write ``summary.json`` atomically.

    Parameters
    ----------
    folder : Path
        The folder of the run; its stored steps give ``history``.
    info : RunInfo
        What holds for all steps.
    record : StepRecord
        The last accepted step: loads, contact and residuals at the top level are those of this step;
        ``iterations``, ``convolutions``, ``tangential_convolutions``, ``substeps`` and ``solve_seconds`` are sums over
        all steps.
    extra : mapping
        More entries, which also replace those here: ``peak_memory_bytes``, ``converged``, ``warnings`` (what
        makes the numbers worth less than they look: code, words, error), ``files`` (names relative
        to the folder; what ``--overwrite`` later may remove).

    Returns
    -------
    Path
        Of the file. SI units (``units`` in it names them); what does not exist or is not finite is null.

    Raises
    ------
    ResultsError
        When it cannot be stored.
    """
    history = run_history(folder, record)
    summary: dict[str, Any] = {
        "title": info.title,
        "name": info.name,
        "scene_hash": info.scene_hash,
        "converged": True,  # a step is only accepted, and stored, with its certificate
        "steps": len(history),
        "load_steps": info.steps,
    }
    summary |= {name: record.scalars.get(name) for name in _LAST}
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
        "units": {name: SCALARS[name].unit for name in (*_LAST, *_SUMMED)}
        | {"peak_memory_bytes": "byte"}
        | {name: unit for name, unit in info.observed_units.items() if name in record.observed},
        "versions": dict(info.versions),
        "references": list(info.references),
        "files": [RESULTS],
        **extra,
    }
    path = folder / SUMMARY
    with replacing(path, "the summary") as sink:
        sink.write((json.dumps(_plain(summary), indent=2, allow_nan=False) + "\n").encode())
    return path


def run_history(folder: Path, record: StepRecord) -> list[dict[str, Any]]:
    """Scalars of every stored step of a run in a folder, the last one as it is in memory; in order."""
    own = {"step": record.index, "time": record.time, **record.scalars, **record.observed}
    history = [row for row in _stored_history(folder) if row["step"] != record.index] + [own]
    return sorted(history, key=lambda row: float(row["step"]))


def _stored_history(folder: Path) -> list[dict[str, Any]]:
    """Scalars of every stored step, from the results or from the steps of an unfinished run."""
    results = folder / RESULTS
    rows: list[dict[str, Any]] = []
    for path in [results] if results.exists() else sorted((folder / STEPS).glob("[0-9]*.h5")):
        with open_hdf5(path, "r") as file:
            roles = {name: str(v.attrs.get("role")) for name, v in file.items()}
            names = ["step", "time", *(name for name, role in roles.items() if role in ("scalar", "observed"))]
            columns = [file[name][...] for name in names]
            rows.extend(dict(zip(names, row, strict=True)) for row in zip(*columns, strict=True))
    return rows


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
