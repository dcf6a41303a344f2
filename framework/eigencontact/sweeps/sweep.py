"""A sweep from its description to its dataset, table and figures."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from eigencontact.engines.cluster import Cluster
from eigencontact.engines.engine import Processes
from eigencontact.errors import EigencontactError, ResultsError, SceneError, nearest, shown
from eigencontact.results.atomic import reason, replacing
from eigencontact.sweeps.axes import Axis, axes_of
from eigencontact.sweeps.folder import AGAIN, DATASET, DESCRIPTION, PROFILES, TABLE, open_folder, sweep_digest
from eigencontact.sweeps.gather import FIELD, as_csv, gathered, values_in_words
from eigencontact.sweeps.runner import Outcome, outcomes
from eigencontact.sweeps.variants import Variant, variants_of

if TYPE_CHECKING:
    import xarray

    from eigencontact.scene.schema import Scene

__all__ = ["SweepResult", "read_sweep_file", "sweep"]

#: Part of a number within which its values are the same: what a load is but for its residual.
_RESIDUAL = 1e-9
_KEYS = ("scene", "vary", "pairs", "fields", "grid", "scalars")

ProgressReport = Callable[[Outcome, int, int], None]


@dataclass(frozen=True, kw_only=True)
class SweepResult:
    """Result of a sweep.

    Attributes
    ----------
    dataset : xarray.Dataset
        All numbers at the last load step of each variant, by what was varied; ``failed`` says why a variant has none.
    files : dict of str to str
        Name of each file in `folder` and what it holds.
    failed : dict of str to str
        Variants that failed, by label, and why.
    warnings : dict of str to list of dict
        Warnings about the accuracy, by label of the variant, as in ``summary.json``: ``code``,
        ``words``, ``error``. Variants without any are left out.
    problems : dict of str to str
        Variants whose stored results were damaged and are computed again, by label.
    folder : Path or None
        Where it is stored; None for a sweep in memory.
    """

    dataset: xarray.Dataset
    files: dict[str, str] = field(default_factory=dict)
    failed: dict[str, str] = field(default_factory=dict)
    warnings: dict[str, list[dict[str, Any]]] = field(default_factory=dict)
    problems: dict[str, str] = field(default_factory=dict)
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
    overwrite: bool = False,
    report_progress: ProgressReport | None = None,
    say: Callable[[str], None] | None = None,
) -> SweepResult:
    """Run every variant of a scene and collect all numbers.

    Parameters
    ----------
    scene : Scene, str, Path or mapping
        Scene with the unvaried keys.
    vary : mapping or sequence of str
        Values by dotted key, ``{"steps.normal-load": ["1 N", "2 N"]}`` or
        ``{"geometry.radius": {"from": 1e-4, "to": 1e-2, "count": 5, "log": True}}``; or texts as of ``--vary``.
    folder : str or Path, optional
        Folder for ``sweep.nc``, ``sweep.csv``, figures, and a folder of each variant. The sweep reuses finished
        variants and computes damaged ones again. Without a folder all results remain in memory.
    pairs : bool
        Vary the keys together, not in all combinations.
    fields : sequence of str
        Surface fields at the last step to store of all variants, which must have the same cells; with a folder,
        also a figure of each with the profiles of all variants along x.
    scalars : sequence of str
        Numbers to draw; by default the main results.
    grid : {"own", "shared"}
        Window of each variant: its own window, or a shared window that contains all windows.
    workers : int
        Processes that share the variants. A script with more than one process needs ``if __name__ == "__main__":``
        around the call, because each process imports the script.
    cluster : str, optional
        Workers of dask.distributed that run them instead: ``"local:4"`` for four processes of this machine, the
        scheduler's address (``"tcp://host:8786"``) or file. The folder must be one that all machines share. For
        ``local:N`` the same guard is needed as for `workers`.
    pictures : bool
        Whether each variant draws its own pictures.
    overwrite : bool
        Replace the results of another sweep in `folder`, and run finished variants again. Files that this package did
        not write are never replaced.
    report_progress : callable, optional
        Receives each outcome, its number and the number of variants.
    say : callable, optional
        Receives one line for each varied key: its values with their unit.

    Raises
    ------
    SceneError, PlanError
        Invalid arguments, or fields on different cells, before the first run.
    ResultsError
        A folder that cannot be written, that holds the sweep of another scene, or files of others under the names of
        ours.
    EigencontactError
        Every variant failed, or a script has no guard for its processes.
    ClusterError
        A cluster without connection, or whose workers cannot perform the runs.

    Examples
    --------
    >>> result = sweep("hertz", {"steps.normal-load": ["0.1 N", "0.8 N"], "stress": [[]]})
    >>> ratio = result.dataset.max_pressure[1] / result.dataset.max_pressure[0]
    >>> f"{float(ratio.squeeze()):.2f}"
    '2.00'
    """
    from eigencontact.app import load_scene

    if isinstance(workers, bool) or not isinstance(workers, int) or not 1 <= workers <= 1024:
        raise SceneError(f"workers must be a whole number from 1 to 1024 (got {shown(workers)})")
    if cluster is not None and workers != 1:
        raise SceneError(f"workers must be without cluster, which has its own (got {shown(workers)})")
    if not (folder is None or isinstance(folder, str | Path)):
        raise ResultsError(f"folder must be a path, or None for a sweep in memory (got {shown(folder)})")
    for name, names in (("fields", fields), ("scalars", scalars)):
        if isinstance(names, str) or not isinstance(names, Sequence) or not all(isinstance(n, str) for n in names):
            raise SceneError(f"{name} must be an array of names (got {shown(names)})")
    for name, flag in (("pairs", pairs), ("pictures", pictures), ("overwrite", overwrite)):
        if not isinstance(flag, bool):
            raise SceneError(f"{name} must be true or false (got {shown(flag)})")
    if grid not in ("own", "shared"):
        raise SceneError(f"grid of a sweep must be 'own' or 'shared' (got {shown(grid)})")
    if not (cluster is None or isinstance(cluster, str | Cluster)):
        raise SceneError(
            f"cluster must be an address as text, or local:N (got {shown(cluster)}); a cluster of dask has it as its "
            "scheduler_address"
        )
    engine = Cluster(cluster) if isinstance(cluster, str) else cluster or (Processes(workers) if workers > 1 else None)
    loaded = load_scene(scene)
    axes = axes_of(vary)
    place = None if folder is None else Path(folder)
    variants = variants_of(loaded, axes, pairs=pairs, pictures=pictures and place is not None)
    if grid == "shared":
        from eigencontact.sweeps.variants import on_one_grid

        variants = on_one_grid(variants)
    elif fields:
        from eigencontact.sweeps.variants import refuse_different_cells

        refuse_different_cells(variants)
    digest = ""
    if place is not None:
        from eigencontact.reference.numbers import known_numbers

        digest = sweep_digest(loaded, axes, grid=grid)
        headlines = [number.name for number in known_numbers().values() if number.headline]
        numbers_to_draw = [*(scalars or headlines), *(f"{name}{PROFILES}" for name in fields)]
        open_folder(place, digest, axes, variants, numbers_to_draw, overwrite=overwrite)
    if say is not None:
        for line in values_in_words(axes, variants):
            say(line)
    finished: list[Outcome] = []
    for outcome in outcomes(variants, place, fields=fields, engine=engine, overwrite=overwrite):
        finished.append(outcome)
        if report_progress is not None:
            report_progress(outcome, len(finished), len(variants))
    finished.sort(key=lambda outcome: outcome.place)
    dataset = gathered(axes, variants, finished, loaded.title or loaded.label, pairs=pairs)
    labels = {variant.place: variant.label for variant in variants}
    failed = {labels[outcome.place]: outcome.failed for outcome in finished if outcome.failed}
    if digest:
        dataset.attrs["scene_hash"] = digest
    files = {} if place is None else _write(place, axes, variants, finished, dataset, scalars)
    if len(failed) == len(variants):
        label, first = next(iter(failed.items()))
        raise EigencontactError(
            f"sweep must have a variant that can be solved (got {len(failed)} failed; {label}: {first})"
        )
    return SweepResult(
        dataset=dataset,
        files=files,
        failed=failed,
        warnings={
            labels[outcome.place]: list(cautions)
            for outcome in finished
            if (cautions := outcome.summary.get("warnings"))
        },
        problems={labels[outcome.place]: outcome.problem for outcome in finished if outcome.problem},
        folder=place,
    )


def _as_netcdf(dataset: xarray.Dataset) -> bytes:
    """Bytes of the dataset's file, written by a temporary file for older versions of xarray."""
    from tempfile import TemporaryDirectory

    try:
        with TemporaryDirectory() as folder:
            path = Path(folder) / DATASET
            dataset.to_netcdf(path, engine="h5netcdf", format="NETCDF4")
            return path.read_bytes()
    except (OSError, RuntimeError) as problem:  # how HDF5 says that the disk of temporary files is full
        raise ResultsError(
            f"{DATASET} must be written to the folder of temporary files first (got: {reason(problem)}); free space "
            f"there; {AGAIN}"
        ) from problem


def _write(
    folder: Path,
    axes: Sequence[Axis],
    variants: Sequence[Variant],
    results: Sequence[Outcome],
    dataset: xarray.Dataset,
    scalars: Sequence[str],
) -> dict[str, str]:
    """Write dataset, table and figures."""
    from eigencontact.viz.style import save
    from eigencontact.viz.sweep import draw_profiles, draw_sweep

    with replacing(folder / DATASET, "the dataset of the sweep", consequence=AGAIN) as sink:
        sink.write(_as_netcdf(dataset))
    with replacing(folder / TABLE, "the table of the sweep", consequence=AGAIN) as sink:
        sink.write(as_csv(axes, variants, results).encode())
    files = {
        DATASET: "all numbers by what was varied (opens in xarray)",
        TABLE: "the same as a table, one line for each variant",
        DESCRIPTION: "what was varied, and the folder of each variant",
    }
    for name in _scalars_to_draw(dataset, scalars):
        save(draw_sweep(dataset, name), folder / f"{name}.png")
        files[f"{name}.png"] = f"{dataset[name].attrs.get('long_name', name)} against what was varied"
    for name in (str(name) for name, values in dataset.data_vars.items() if "x" in values.dims):
        file = f"{name.removeprefix(FIELD)}{PROFILES}.png"
        save(draw_profiles(dataset, name), folder / file)
        files[file] = f"{dataset[name].attrs.get('long_name', name)} along x, all variants in one figure"
    return files


def _scalars_to_draw(dataset: xarray.Dataset, scalars: Sequence[str]) -> list[str]:
    """Numbers to draw: the named ones, else main results that differ between variants."""
    numbers = [
        str(name)
        for name, variable in dataset.data_vars.items()
        if variable.dtype.kind == "f" and "x" not in variable.dims
    ]
    for name in scalars:
        if name not in numbers:
            raise SceneError(f"scalar must be one of {', '.join(numbers)} (got {name!r}){nearest(name, numbers)}")
    if scalars:
        return list(scalars)
    varied = {str(name).rpartition("steps_")[2] for name in dataset.coords}
    headlines = [name for name in numbers if dataset[name].attrs.get("headline") and name not in varied]
    finite = {name: dataset[name].values[dataset[name].notnull().values] for name in headlines}
    return [
        name for name, values in finite.items() if values.size and np.ptp(values) > _RESIDUAL * np.abs(values).max()
    ]


def read_sweep_file(path: Path) -> dict[str, Any]:
    """Arguments of `sweep` from a TOML file: ``scene``, the table ``vary``, and the other keys.

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
    scene_path = path.parent / table["scene"] if isinstance(table["scene"], str) else None
    if scene_path is not None and scene_path.is_file():
        table["scene"] = scene_path
    return {**table, "vary": _dotted(table["vary"])}


def _dotted(table: Mapping[str, Any], before: str = "") -> dict[str, Any]:
    """Values by dotted key; TOML reads an unquoted dotted key as tables in tables."""
    out: dict[str, Any] = {}
    for key, value in table.items():
        deeper = isinstance(value, Mapping) and not {"from", "to"} & set(value)
        out |= _dotted(value, f"{before}{key}.") if deeper else {f"{before}{key}": value}
    return out
