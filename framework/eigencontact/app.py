"""The public calls: load a scene, plan it, run it, open results; components and point kernels by themselves."""

from __future__ import annotations

import contextlib
import hashlib
import json
import platform
import tempfile
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigencontact.errors import PluginError, ResultsError, SceneError, require
from eigencontact.hooks.manager import load_plugins
from eigencontact.hooks.registry import Entry, Registry
from eigencontact.plugin import KINDS

if TYPE_CHECKING:
    import xarray

    from eigencontact.execution.driver import Watcher
    from eigencontact.planning.plan import Plan
    from eigencontact.results.records import RunInfo, StepRecord
    from eigencontact.scene.schema import Scene

__all__ = [
    "RunResult",
    "explain",
    "installed_plugins",
    "load_scene",
    "make",
    "open_results",
    "plan",
    "rectangle_field",
    "run",
]

FloatArray = NDArray[np.float64]


@cache
def installed_plugins() -> Registry:
    """Return the registry of every installed plugin; what failed to load is in its ``broken``."""
    return load_plugins(KINDS)


def load_scene(source: Scene | str | Path | Mapping[str, Any], changes: Iterable[str] = ()) -> Scene:
    """Load a scene.

    Parameters
    ----------
    source : str, Path, mapping or Scene
        TOML file, name of a bundled scene, or its tables.
    changes : iterable of str
        ``"key=value"`` with dotted keys: ``"body1.poisson-ratio=0.4"``, ``"steps.normal-load=1 N"``.

    Raises
    ------
    SceneError
        One line that names the field, the rule, the value and the nearest valid choice.

    Examples
    --------
    >>> load_scene("hertz", ["steps.normal-load=1 N"]).steps[0].normal_load
    1.0
    """
    from eigencontact.scene.loader import apply_changes, load_scene_file
    from eigencontact.scene.schema import Scene

    changes = list(changes)
    if isinstance(source, Scene):
        return Scene(**apply_changes(source.resolved(), changes)) if changes else source
    if isinstance(source, Mapping):
        return Scene(**apply_changes(source, changes))
    return load_scene_file(source, changes)


def plan(scene: Scene | str | Path | Mapping[str, Any], *, registry: Registry | None = None) -> Plan:
    """Decide what a scene needs, before anything is computed.

    Returns
    -------
    Plan
        ``plan.explain()`` says it in words; ``plan.kernels``, ``plan.blocks``, ``plan.cost`` and ``plan.grid`` in data.

    Raises
    ------
    SceneError, PluginError, PlanError
        See `eigencontact.errors`.
    """
    from eigencontact.planning.contact import make_plan

    return make_plan(load_scene(scene), registry or installed_plugins())


def explain(scene: Scene | str | Path | Mapping[str, Any]) -> str:
    """Say what a scene will model, with which kernels, memory and time, and what is left out and why."""
    return plan(scene).explain()


@dataclass(frozen=True, kw_only=True)
class RunResult:
    """What a run produced.

    Attributes
    ----------
    summary : dict
        The contents of ``summary.json``.
    dataset : xarray.Dataset
        Everything stored, with coordinates, units and provenance.
    folder : Path or None
        Where it is stored; None for a run in memory.
    files : dict of str to str
        Name of each file written and what it shows.
    problems : tuple of str
        Stored steps that a resumed run found damaged and computed again.
    seconds : float
        Wall time of it all [s].
    """

    summary: dict[str, Any]
    dataset: xarray.Dataset
    folder: Path | None
    files: dict[str, str] = field(default_factory=dict)
    problems: tuple[str, ...] = ()
    seconds: float = 0.0


def run(
    scene: Scene | Plan | str | Path | Mapping[str, Any],
    folder: str | Path | None = None,
    *,
    resume: bool = False,
    overwrite: bool = False,
    watcher: Watcher | None = None,
    registry: Registry | None = None,
) -> RunResult:
    """Solve a scene.

    Parameters
    ----------
    scene : Scene, Plan, str, Path or mapping
        What to solve.
    folder : str or Path, optional
        Where results, summary and pictures go; without it nothing is left on disk and no pictures are drawn.
    resume : bool
        Continue an interrupted run of the same scene in `folder`.
    overwrite : bool
        Replace results of another scene in `folder`.
    watcher : Watcher, optional
        Told of the course, for progress bars.
    registry : Registry, optional
        Plugins to use; by default all that are installed.

    Raises
    ------
    EigencontactError
        `SceneError`, `PluginError`, `PlanError` before anything is computed or written; `NotConverged`,
        `DomainTooSmall` or `ResultsError` on the way, with accepted steps kept.

    Examples
    --------
    >>> result = run(load_scene("hertz", ["stress=[]", "grid.cells-per-contact-radius=20"]))
    >>> f"{1e-9 * result.summary['max_pressure']:.2f} GPa"
    '8.46 GPa'
    """
    from eigencontact.planning.plan import Plan

    began = perf_counter()
    planned = scene if isinstance(scene, Plan) else plan(scene, registry=registry)
    if folder is not None:
        return _run_in(planned, Path(folder), began, resume=resume, overwrite=overwrite, watcher=watcher, keep=True)
    if resume:
        raise ResultsError(
            "resume must be given with a folder (got folder=None); a run in memory leaves nothing behind"
        )
    with tempfile.TemporaryDirectory(prefix="eigencontact-") as scratch:
        return _run_in(planned, Path(scratch), began, resume=False, overwrite=False, watcher=watcher, keep=False)


def _run_in(
    planned: Plan,
    folder: Path,
    began: float,
    *,
    resume: bool,
    overwrite: bool,
    watcher: Watcher | None,
    keep: bool,
) -> RunResult:
    from eigencontact.execution.driver import drive
    from eigencontact.planning.cost import peak_bytes, resident_bytes
    from eigencontact.results.reader import open_results as open_stored
    from eigencontact.results.store import ResultStore
    from eigencontact.results.summary import write_summary

    info = _run_info(planned)
    # A finished run of the very same scene may be made again; anything else in the folder is protected.
    store = ResultStore.create(folder, info, resume=resume, overwrite=overwrite)
    accepted = store.accepted() if resume else []
    done = {index: _reader(store, index) for index in accepted}
    last: StepRecord | None = store.load_step(accepted[-1]) if accepted else None
    predicted = resident_bytes() + planned.cost.memory
    solving, resumed = 0.0, perf_counter()
    try:
        for record in drive(planned, watcher=watcher, done=done):
            solving += perf_counter() - resumed
            store.write_step(record)
            last, resumed = record, perf_counter()
    except BaseException:
        store.abandon()
        raise
    peak = peak_bytes()
    assert last is not None
    results = store.folder / "results.nc" if store.finished else store.finish()
    files = {results.name: "all fields of all steps, with coordinates, units and provenance (opens in xarray)"}
    if keep:
        files |= _draw(planned, results, folder)
    extra = {
        "peak_memory_bytes": peak,
        "predicted_memory_bytes": int(predicted),
        "compute_seconds": solving,
        "predicted_seconds": planned.seconds,
        "files": {**files, "summary.json": "the numbers of this run"},
        "versions": info.versions,
        "references": list(info.references),
        "kernels": [str(kernel) for kernel in planned.kernels],
        "total_seconds": perf_counter() - began,
    }
    summary_path = write_summary(folder, info, last, extra)
    summary = json.loads(summary_path.read_text(encoding="utf-8"))
    dataset = open_stored(results)
    if not keep:
        dataset = dataset.load()
        dataset.close()
    files["summary.json"] = "the numbers of this run, in SI units"
    return RunResult(
        summary=summary,
        dataset=dataset,
        folder=folder if keep else None,
        files=files if keep else {},
        problems=tuple(store.problems),
        seconds=perf_counter() - began,
    )


def _reader(store: Any, index: int) -> Any:
    return lambda: store.load_step(index)


def _draw(planned: Plan, results: Path, folder: Path) -> dict[str, str]:
    """Pictures and VTK files of a finished run, as far as the scene wants them."""
    files: dict[str, str] = {}
    if not (planned.scene.output.pictures or planned.scene.output.vtk):
        return files
    with open_results(results) as dataset:
        if planned.scene.output.pictures:
            from eigencontact.viz.figures import draw_all

            files |= draw_all(dataset, folder)
        if planned.scene.output.vtk:
            from eigencontact.viz.vtk import write_vtk

            files |= {path.name: "fields for ParaView" for path in write_vtk(dataset, folder)}
    return files


def _run_info(planned: Plan) -> RunInfo:
    import scipy
    import tomli_w

    from eigencontact import __version__
    from eigencontact.core.material import contact_modulus
    from eigencontact.planning.explain import references
    from eigencontact.results.records import RunInfo

    resolved = planned.scene.resolved()
    digest = hashlib.sha256(json.dumps(resolved, sort_keys=True).encode())
    digest.update(planned.separation().tobytes())  # a changed topography file is a changed scene
    versions = {
        "python": platform.python_version(),
        "numpy": np.__version__,
        "scipy": scipy.__version__,
        "eigencontact": __version__,
    }
    with contextlib.suppress(PackageNotFoundError):
        versions["pyfftw"] = version("pyfftw")
    used = [*planned.influences.values(), *planned.geometries, *(o for _, o in planned.observers)]
    for component in used:
        entry = planned.registry.get(component.kind, component.key)
        versions[f"plugin {entry.kind} {entry.key}"] = entry.origin
    return RunInfo(
        title=planned.scene.title,
        name=planned.name,
        grid=planned.grid,
        scene_toml=tomli_w.dumps(resolved),
        scene_hash=digest.hexdigest(),
        versions=versions,
        references=references(planned),
        contact_modulus=contact_modulus(*planned.bodies),
        steps=planned.steps,
    )


def draw(results: str | Path, folder: str | Path | None = None, *, vtk: bool = False) -> dict[Path, str]:
    """Pictures, and VTK files if wanted, of stored results; returns each file and what it shows.

    Parameters
    ----------
    results : str or Path
        A folder of results or its ``results.nc``.
    folder : str or Path, optional
        Where the files go; by default beside the results.
    """
    from eigencontact.viz.figures import draw_all

    source = Path(results)
    target = Path(folder) if folder is not None else (source if source.is_dir() else source.parent)
    with open_results(source) as dataset:
        try:
            target.mkdir(parents=True, exist_ok=True)
            files = {target / name: text for name, text in draw_all(dataset, target).items()}
            if vtk:
                from eigencontact.viz.vtk import write_vtk

                files |= dict.fromkeys(write_vtk(dataset, target), "fields for ParaView")
        except OSError as problem:
            raise ResultsError(
                f"output folder {target} must be writable (got {problem}); choose another with -o"
            ) from None
    return files


def open_results(path: str | Path) -> xarray.Dataset:
    """Open stored results, a folder or its ``results.nc``, with coordinates, units and provenance.

    Raises
    ------
    ResultsError
        Missing, unfinished or foreign files.
    """
    from eigencontact.results.reader import open_results as open_stored

    return open_stored(path)


def make(key: str, /, *, kind: str | None = None, **parameters: Any) -> Any:
    """Component of an installed plugin by its key.

    Parameters
    ----------
    key : str
        Name of the plugin: ``"sphere"``.
    kind : str, optional
        Kind of plugin, where several kinds know the key and the parameters do not tell them apart.
    **parameters
        Fields of the component; text with units is accepted.

    Raises
    ------
    PluginError, SceneError
        Unknown or ambiguous key, refused parameters.

    Examples
    --------
    >>> make("sphere", radius="105 um").radius
    0.000105
    """
    from eigencontact.scene.components import instantiate

    registry = installed_plugins()
    if kind is not None:
        require(kind in KINDS, "make", "kind", kind, f"one of {', '.join(KINDS)}")
        return instantiate(registry.get(kind, key), parameters, key)
    entries = registry.named(key)
    if len(entries) > 1:
        fitting = [entry for entry in entries if set(parameters) <= set(registry.parameters(entry.component))]
        entries = fitting or entries
    if len(entries) > 1:
        kinds = ", ".join(repr(entry.kind) for entry in entries)
        raise PluginError(f"{key!r} must be told apart by kind (it is one of {kinds}); give kind=")
    if not entries:
        from eigencontact.errors import nearest

        keys = sorted({entry.key for entry in registry})
        broken = "".join(f"; {item}" for item in registry.broken)
        raise PluginError(f"unknown plugin {key!r}; installed: {', '.join(keys)}{nearest(key, keys)}{broken}")
    return instantiate(entries[0], parameters, key)


def rectangle_field(
    traction: ArrayLike,
    half_widths: ArrayLike,
    points: ArrayLike,
    *,
    young_modulus: float,
    poisson_ratio: float,
    quantity: Literal["displacement", "stress"] = "displacement",
) -> FloatArray:
    """Field in a half-space loaded uniformly on the rectangle |x| <= a, |y| <= b of its surface z = 0.

    Parameters
    ----------
    traction : (3,) [Pa]
        ``(q_x, q_y, p)``: shears act on the body along +x and +y, the pressure pushes along +z, into the body.
    half_widths : (2,) [m]
        ``(a, b)``.
    points : (n, 3) [m]
        Field points, z >= 0.
    young_modulus, poisson_ratio : float
        E [Pa] and ν in (-1, 0.5].
    quantity : {"displacement", "stress"}
        What to return.

    Returns
    -------
    (n, 3) [m] or (n, 3, 3) [Pa]
        Displacement, or symmetric stress tensors (tension positive). On an edge, stresses that jump take their
        mean; true singularities (logarithms at edges and corners, z = 0) come out large and finite.

    References
    ----------
    Boussinesq 1885, Cerruti 1882, Love 1929; K. L. Johnson, Contact Mechanics (1985), chapter 3.

    Examples
    --------
    >>> u = rectangle_field((0, 0, 1e6), (1e-6, 1e-6), [[0, 0, 0]], young_modulus=210e9, poisson_ratio=0.3)
    >>> f"{u[0, 2]:.6e}"
    '9.725731e-12'
    """
    from eigencontact.core.material import Material
    from eigencontact.core.tensors import to_matrix

    load = np.asarray(traction, dtype=float)
    widths = np.asarray(half_widths, dtype=float)
    at = np.asarray(points, dtype=float)
    require(
        load.shape == (3,) and np.all(np.isfinite(load)),
        "rectangle_field",
        "traction",
        traction,
        "three finite numbers (q_x, q_y, p) [Pa]",
    )
    good = widths.shape == (2,) and np.all(widths > 0) and np.all(np.isfinite(widths))
    require(good, "rectangle_field", "half_widths", half_widths, "two positive numbers (a, b) [m]")
    require(at.ndim == 2 and at.shape[1] == 3, "rectangle_field", "points", at.shape, "of shape (n, 3) [m]")
    if not np.all(np.isfinite(at)):
        raise SceneError("rectangle_field.points must be finite [m] (got NaN or infinity)")
    require(np.all(at[:, 2] >= 0), "rectangle_field", "points", at[:, 2].min(initial=0.0), "at z of 0 or more [m]")
    require(
        quantity in ("displacement", "stress"), "rectangle_field", "quantity", quantity, "'displacement' or 'stress'"
    )
    material = Material(young_modulus=young_modulus, poisson_ratio=poisson_ratio)
    names = ("x", "y", "z") if quantity == "displacement" else ("xx", "yy", "zz", "yz", "xz", "xy")
    total = np.zeros((len(names), len(at)))
    for value, component in zip(load, ("q_x", "q_y", "p"), strict=True):
        if value:
            influence = _influence_entry(component).component()
            evaluate = influence.displacement if quantity == "displacement" else influence.stress
            total += value * evaluate(
                names, at[:, 0], at[:, 1], at[:, 2], (float(widths[0]), float(widths[1])), material
            )
    return total.T if quantity == "displacement" else to_matrix(total)


def _influence_entry(traction: str) -> Entry:
    for entry in installed_plugins().of_kind("surface-influence"):
        if entry.component.traction == traction:  # type: ignore[attr-defined]
            return entry
    raise PluginError(
        f"traction {traction!r} must have an installed surface influence (got none); reinstall eigencontact"
    )
