"""A sweep from its description to its dataset, table and figures."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from eigencontact.engines.cluster import Cluster
from eigencontact.errors import SceneError, nearest, shown
from eigencontact.sweeps.axes import Axis, axes_of
from eigencontact.sweeps.gather import as_csv, gathered
from eigencontact.sweeps.runner import Outcome, outcomes
from eigencontact.sweeps.variants import Variant, variants_of

if TYPE_CHECKING:
    import xarray

    from eigencontact.scene.schema import Scene

__all__ = ["SweepResult", "read_sweep_file", "sweep"]

#: Part of a number within which its values are the same: what a load is but for its residual.
_SAME = 1e-9
_KEYS = ("scene", "vary", "pairs", "fields", "grid", "scalars")

Told = Callable[[Outcome, int, int], None]


@dataclass(frozen=True, kw_only=True)
class SweepResult:
    """What a sweep produced.

    Attributes
    ----------
    dataset : xarray.Dataset
        All numbers at the last load step of each variant, by what was varied; ``failed`` says why a variant has none.
    files : dict of str to str
        Name of each file in `folder` and what it holds.
    failed : dict of str to str
        Variants that failed, by label, and why.
    warnings : dict of str to list of dict
        What makes numbers worth less than they look, by label of the variant, as in ``summary.json``: ``code``,
        ``words``, ``error``. Variants without any are left out.
    folder : Path or None
        Where it is stored; None for a sweep in memory.
    """

    dataset: xarray.Dataset
    files: dict[str, str] = field(default_factory=dict)
    failed: dict[str, str] = field(default_factory=dict)
    warnings: dict[str, list[dict[str, Any]]] = field(default_factory=dict)
    folder: Path | None = None


def sweep(
    scene: Scene | str | Path | Mapping[str, Any],
    vary: Mapping[str, Any] | Sequence[str],
    folder: str | Path | None = None,
    *,
    pairs: bool = False,
    fields: Sequence[str] = (),
    scalars: Sequence[str] = (),
    grid: Literal["own", "shared"] = "own",
    workers: int = 1,
    cluster: str | Cluster | None = None,
    pictures: bool = False,
    told: Told | None = None,
) -> SweepResult:
    """Run every variant of a scene; bring all numbers together.

    Parameters
    ----------
    scene : Scene, str, Path or mapping
        What is varied.
    vary : mapping or sequence of str
        Values by dotted key, ``{"steps.normal-load": ["1 N", "2 N"]}`` or
        ``{"geometry.radius": {"from": 1e-4, "to": 1e-2, "count": 5, "log": True}}``; or texts as of ``--vary``.
    folder : str or Path, optional
        Each variant has a folder in it, beside ``sweep.nc``, ``sweep.csv`` and figures. Variants that are finished
        there are not run again. Without it everything stays in memory.
    pairs : bool
        Take the values in step with each other, not each with each.
    fields : sequence of str
        Surface fields at the last step to bring together; all variants must have the same cells.
    scalars : sequence of str
        Numbers to draw; by default those that most look at.
    grid : {"own", "shared"}
        Whether each variant has the window that it asks for, or all have one that holds them.
    workers : int
        Processes that share the variants.
    cluster : str, optional
        Workers of dask.distributed that run them instead: ``"local:4"`` for four processes of this machine, the
        scheduler's address (``"tcp://host:8786"``) or file. The folder must be one that all machines share.
    pictures : bool
        Whether each variant draws its own pictures.
    told : callable, optional
        Told of each outcome, its number and how many there will be.

    Raises
    ------
    SceneError, PlanError
        A description that no variant can follow; chosen fields on different cells, before anything is run.
    ResultsError
        A folder that cannot be written.
    ClusterError
        A cluster that is not reachable, that is lost, or whose workers cannot do what is asked.

    Examples
    --------
    >>> found = sweep("hertz", {"steps.normal-load": ["0.1 N", "0.8 N"], "stress": [[]]})
    >>> ratio = found.dataset.max_pressure[1] / found.dataset.max_pressure[0]
    >>> f"{float(ratio.squeeze()):.2f}"
    '2.00'
    """
    from eigencontact.app import load_scene

    if isinstance(workers, bool) or not isinstance(workers, int) or not 1 <= workers <= 1024:
        raise SceneError(f"workers must be a whole number from 1 to 1024 (got {shown(workers)})")
    if cluster is not None and workers != 1:
        raise SceneError(f"workers must be without cluster, which has its own (got {shown(workers)})")
    engine = Cluster(cluster) if isinstance(cluster, str) else cluster
    if grid not in ("own", "shared"):
        raise SceneError(f"grid of a sweep must be 'own' or 'shared' (got {shown(grid)})")
    loaded = load_scene(scene)
    axes = axes_of(vary)
    place = None if folder is None else Path(folder)
    variants = variants_of(loaded, axes, pairs=pairs, pictures=pictures and place is not None)
    if grid == "shared":
        from eigencontact.sweeps.shared import on_one_grid

        variants = on_one_grid(variants)
    elif fields:
        from eigencontact.sweeps.shared import refuse_different_cells

        refuse_different_cells(variants)
    if place is not None:
        place.mkdir(parents=True, exist_ok=True)
    found: list[Outcome] = []
    for outcome in outcomes(variants, place, fields=fields, workers=workers, engine=engine):
        found.append(outcome)
        if told is not None:
            told(outcome, len(found), len(variants))
    dataset = gathered(axes, variants, found, loaded.title or loaded.label, pairs=pairs)
    labels = {variant.place: variant.label for variant in variants}
    failed = {labels[one.place]: one.failed for one in found if one.failed}
    order = sorted(found, key=lambda one: one.place)
    warnings = {labels[one.place]: list(said) for one in order if (said := one.summary.get("warnings"))}
    files = {} if place is None else _write(place, axes, variants, found, dataset, scalars)
    return SweepResult(dataset=dataset, files=files, failed=failed, warnings=warnings, folder=place)


def _as_netcdf(dataset: xarray.Dataset) -> bytes:
    """Bytes of the dataset's file; by way of a file, as older versions of xarray do not write netCDF-4 to memory."""
    from tempfile import TemporaryDirectory

    with TemporaryDirectory() as folder:
        path = Path(folder) / "sweep.nc"
        dataset.to_netcdf(path, engine="h5netcdf", format="NETCDF4")
        return path.read_bytes()


def _write(
    folder: Path,
    axes: Sequence[Axis],
    variants: Sequence[Variant],
    found: Sequence[Outcome],
    dataset: xarray.Dataset,
    scalars: Sequence[str],
) -> dict[str, str]:
    """Write dataset, table and figures."""
    from eigencontact.results.atomic import replacing
    from eigencontact.viz.style import save
    from eigencontact.viz.sweep import draw_sweep

    with replacing(folder / "sweep.nc", "the dataset of the sweep") as sink:
        sink.write(_as_netcdf(dataset))
    with replacing(folder / "sweep.csv", "the table of the sweep") as sink:
        sink.write(as_csv(axes, variants, found).encode())
    content = {
        "vary": {axis.key: list(axis.values) for axis in axes},
        "variants": [{"folder": one.label, "values": one.values} for one in variants],
    }
    with replacing(folder / "sweep.json", "the description of the sweep") as sink:
        sink.write((json.dumps(content, indent=2, default=str) + "\n").encode())
    files = {
        "sweep.nc": "all numbers by what was varied (opens in xarray)",
        "sweep.csv": "the same as a table, one line for each variant",
        "sweep.json": "what was varied, and the folder of each variant",
    }
    for name in _drawn(dataset, scalars):
        save(draw_sweep(dataset, name), folder / f"{name}.png")
        files[f"{name}.png"] = f"{dataset[name].attrs.get('long_name', name)} against what was varied"
    return files


def _drawn(dataset: xarray.Dataset, scalars: Sequence[str]) -> list[str]:
    """Numbers to draw: those named, else headlines that differ between variants."""
    numbers = [str(name) for name, one in dataset.data_vars.items() if one.dtype.kind == "f" and "x" not in one.dims]
    for name in scalars:
        if name not in numbers:
            raise SceneError(f"scalar must be one of {', '.join(numbers)} (got {name!r}){nearest(name, numbers)}")
    if scalars:
        return list(scalars)
    varied = {str(name).rpartition("steps_")[2] for name in dataset.coords}
    wanted = [name for name in numbers if dataset[name].attrs.get("headline") and name not in varied]
    finite = {name: dataset[name].values[dataset[name].notnull().values] for name in wanted}
    return [name for name, values in finite.items() if values.size and np.ptp(values) > _SAME * np.abs(values).max()]


def read_sweep_file(path: Path) -> dict[str, Any]:
    """Arguments of `sweep` from a TOML file: ``scene``, the table ``vary``, and what else it holds.

    Raises
    ------
    SceneError
        A file that is none; names the key.
    """
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as problem:
        raise SceneError(f"sweep file must be readable TOML (got {str(path)!r}): {problem}") from None
    for key in table:
        if key not in _KEYS:
            raise SceneError(f"unknown key {key!r} in the sweep; known: {', '.join(_KEYS)}{nearest(key, _KEYS)}")
    if not isinstance(table.get("scene"), str | dict) or not isinstance(table.get("vary"), dict):
        raise SceneError(f"{path} must have scene (a file, a bundled name, or tables) and a table vary")
    beside = path.parent / table["scene"] if isinstance(table["scene"], str) else None
    if beside is not None and beside.is_file():
        table["scene"] = beside
    return {**table, "vary": _dotted(table["vary"])}


def _dotted(table: Mapping[str, Any], before: str = "") -> dict[str, Any]:
    """Values by dotted key; TOML reads an unquoted dotted key as tables in tables."""
    out: dict[str, Any] = {}
    for key, value in table.items():
        deeper = isinstance(value, Mapping) and not {"from", "to"} & set(value)
        out |= _dotted(value, f"{before}{key}.") if deeper else {f"{before}{key}": value}
    return out
