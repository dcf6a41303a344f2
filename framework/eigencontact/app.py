"""Public functions that load, plan and run a scene, and make components and point kernels."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import partial
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any

from eigencontact.core.stopwatch import Stopwatch
from eigencontact.errors import SceneError, shown
from eigencontact.hooks.registry import Registry
from eigencontact.results.run_result import RunResult
from eigencontact.solving import Solved, numbers_and_warnings, solve_stored, solver_in_memory

if TYPE_CHECKING:
    from eigencontact.core.cautions import Caution
    from eigencontact.execution.run.driver import Watcher
    from eigencontact.planning.plan import Plan
    from eigencontact.results.memory import MemoryStore
    from eigencontact.results.store import ResultStore
    from eigencontact.scene.schema import Scene
    from eigencontact.viz.painter import Painter

    Store = ResultStore | MemoryStore

__all__ = [
    "RunResult",
    "explain",
    "load_scene",
    "plan",
    "run",
]


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

    if isinstance(changes, str) or not isinstance(changes, Iterable):
        raise SceneError(f'changes must be an array of texts "key=value" (got {shown(changes)})')
    changes = list(changes)
    if isinstance(source, Scene):
        return Scene(**apply_changes(source.resolved(), changes)).within(source.folder) if changes else source
    if isinstance(source, Mapping):
        return Scene(**apply_changes(source, changes))
    return load_scene_file(source, changes)


def plan(scene: Scene | str | Path | Mapping[str, Any], *, registry: Registry | None = None) -> Plan:
    """Plan the blocks of a scene, before any solution.

    Returns
    -------
    Plan
        ``plan.explain()`` is its description; ``plan.kernels``, ``plan.blocks``, ``plan.cost`` and ``plan.grid`` are
        its data.

    Raises
    ------
    SceneError, PluginError, PlanError
        See `eigencontact.errors`.

    Examples
    --------
    >>> planned = plan("hertz")
    >>> planned.grid.shape, planned.steps
    ((224, 224), 1)
    """
    from eigencontact.planning.planner import make_plan

    loaded = load_scene(scene)
    return make_plan(loaded, loaded.known_plugins(registry))


def explain(
    scene: Scene | str | Path | Mapping[str, Any],
    *,
    accuracy: str | float | Mapping[str, Any] | None = None,
    errors: bool = False,
) -> str:
    """Describe a scene before the run: model, kernels, memory, time, and omitted effects with reasons.

    With an accuracy, as an argument like that of `run` or in the scene, it also predicts the necessary runs, and with
    errors their coarser runs.

    Examples
    --------
    >>> print(explain("hertz").splitlines()[0])
    hertz: Hertz contact: rigid sphere on steel
    """
    planned = plan(scene)
    predictions = foretold(planned, accuracy, errors=errors)
    if not predictions:
        return planned.explain()
    from eigencontact.accuracy.forecast import bars_text, forecast_text

    text = (
        forecast_text(predictions["accuracy"])
        if "accuracy" in predictions
        else bars_text(predictions["errors"], planned)
    )
    return f"{planned.explain()}\n\n{text}"


def foretold(
    planned: Plan, accuracy: str | float | Mapping[str, Any] | None = None, *, errors: bool = False
) -> dict[str, dict[str, Any]]:
    """Predicted runs to an ``accuracy``, or those for ``errors``, from the arguments of `run` or the scene.

    Empty without either; like `run` it needs no errors where an accuracy is prescribed.
    """
    if accuracy is None and planned.scene.accuracy is None:
        if not (errors or planned.scene.output.errors):
            return {}
        from eigencontact.accuracy.forecast import cost_of_bars

        return {"errors": cost_of_bars(planned, _maker(planned, None))}
    from eigencontact.accuracy.forecast import forecast
    from eigencontact.scene.accuracy import with_accuracy

    scene = planned.scene if accuracy is None else with_accuracy(planned.scene, accuracy)
    assert scene.accuracy is not None
    return {"accuracy": forecast(planned, scene.accuracy, _maker(planned, None))}


def run(
    scene: Scene | Plan | str | Path | Mapping[str, Any],
    folder: str | Path | None = None,
    *,
    resume: bool = False,
    overwrite: bool = False,
    errors: bool = False,
    accuracy: str | float | Mapping[str, Any] | None = None,
    watcher: Watcher | None = None,
    registry: Registry | None = None,
    painter: Painter | None = None,
) -> RunResult:
    """Solve a scene.

    Parameters
    ----------
    scene : Scene, Plan, str, Path or mapping
        Scene to solve.
    folder : str or Path, optional
        Folder of results, summary and pictures; without it the run stores nothing and draws no pictures.
    resume : bool
        Continue an interrupted run of the same scene in `folder`.
    overwrite : bool
        Replace results of another scene in `folder`, or damaged ones. The package never replaces a file that it did
        not write: see `eigencontact.results.ownership`.
    errors : bool
        Estimate the error of every number and field from coarser runs (`eigencontact.accuracy`); ``errors`` and
        ``field_errors`` of the summary, and variables ``<field>_error`` of the results, hold them. The key
        ``output.errors`` of a scene does the same.
    accuracy : str, float or mapping, optional
        Largest error of the main results, ``"1 %"``, or a table ``accuracy`` of a scene: ``{"max-pressure": "0.5 %",
        "time": "10 min"}``. The run then chooses cells, increments and tolerances (`eigencontact.accuracy`);
        ``accuracy`` of the summary describes the sequence of runs.
    watcher : Watcher, optional
        Receives the progress of the run, for progress bars.
    registry : Registry, optional
        Available plugins; by default all installed ones.
    painter : Painter, optional
        Process that draws the pictures (`eigencontact.viz.painter`); by default this process.

    Raises
    ------
    EigencontactError
        `SceneError`, `PluginError`, `PlanError` before the run computes or writes; `NotConverged`,
        `DomainTooSmall` or `ResultsError` during the run, which keeps the accepted steps.

    Examples
    --------
    >>> result = run(load_scene("hertz", ["stress=[]", "grid.cells-per-contact-radius=20"]))
    >>> f"{1e-9 * result.summary['max_pressure']:.2f} GPa"
    '8.47 GPa'
    """
    from eigencontact.planning.plan import Plan

    began = perf_counter()
    if not (folder is None or isinstance(folder, str | Path)):
        raise SceneError(f"folder must be a path, or None for a run in memory (got {shown(folder)})")
    target = None if folder is None else Path(folder).absolute()  # before a plugin can change the working directory
    if accuracy is not None:
        from eigencontact.scene.accuracy import with_accuracy

        scene = with_accuracy(scene.scene if isinstance(scene, Plan) else load_scene(scene), accuracy)
    if isinstance(scene, Plan):
        planned, began = scene, began - scene.seconds_planned
    else:
        planned = plan(scene, registry=registry)
    if resume and planned.scene.accuracy is not None:
        raise SceneError("resume must be without accuracy (got both); a run to an accuracy stores its answer alone")
    if resume and target is None:
        raise SceneError("resume must be given with a folder (got folder=None); a run in memory leaves nothing behind")
    stopwatch = Stopwatch()
    stopwatch.add("set-up", perf_counter() - began)
    from eigencontact.planning.memory import run_bytes
    from eigencontact.planning.provenance import run_info
    from eigencontact.results.memory import MemoryStore

    caution: Caution | None = None
    if planned.scene.numerics.inclusion_refinement == "auto":
        from eigencontact.accuracy.refinement import with_refinement

        if target is not None:
            _refuse_folder(planned, target)
        with stopwatch.on("choice of inclusion-refinement"):
            planned, caution = with_refinement(planned, _maker(planned, registry), solver_in_memory(watcher))
    store: Store
    stored: ResultStore | None = None
    answer = None
    if planned.scene.accuracy is not None:
        if target is not None:
            from eigencontact.results.ownership import refuse_results

            _refuse_folder(planned, target)
            refuse_results(target, overwrite=overwrite)
        with stopwatch.on("runs of growing fineness"):
            from eigencontact.accuracy.pursuit import pursue
            from eigencontact.accuracy.runs import Runs

            runs = Runs(make=_maker(planned, registry), solve=solver_in_memory(watcher))
            answer = pursue(planned, planned.scene.accuracy, runs)
        planned = answer.last.run.plan
    if target is None:
        predicted = run_bytes(planned, stored=False)
        store = MemoryStore(run_info(planned)) if answer is None else answer.last.run.storage.store
    else:
        from eigencontact.results.store import ResultStore

        _refuse_folder(planned, target)
        predicted = run_bytes(planned, painter=painter is not None)
        store = stored = ResultStore.create(target, run_info(planned), resume=resume, overwrite=overwrite)
    accepted = {n: partial(stored.load_step, n) for n in stored.accepted()} if resume and stored is not None else {}
    try:
        if answer is None:
            solved = solve_stored(planned, store, watcher, stopwatch, accepted)
        else:
            solved = answer.last.run.storage.solved
            if stored is not None:
                stored.adopt(answer.last.run.storage.store)
    except BaseException:
        if stored is not None:
            stored.abandon()
        raise
    files: dict[str, str] = {}
    if stored is not None:
        with stopwatch.on("storing"):
            results = stored.finish()
        files[results.name] = "all fields of all steps, with coordinates, units and provenance (opens in xarray)"
    noted = numbers_and_warnings(planned, store, solved.last)
    if caution is not None:
        noted["warnings"] = [*noted["warnings"], caution.to_dict()]
    if answer is not None:
        noted |= answer.to_dict()
        if (fields := answer.last.fields) is not None:
            with stopwatch.on("error bars"):
                store.append(fields.variables(answer.last.accuracy.bars))
            noted |= fields.to_dict()
        _warn_of_targets(store, solved, noted)
    elif errors or planned.scene.output.errors:
        from eigencontact.accuracy.stored import stored_errors
        from eigencontact.results.summary import summary_of

        with stopwatch.on("error bars"):
            whole = summary_of(store.info, solved.last, noted["history"], noted)
            noted |= stored_errors(planned, whole, store, _maker(planned, registry), solver_in_memory(watcher))
    if stored is not None and target is not None:
        solved = solved._replace(last=solved.last.without_arrays())  # pictures have the memory for themselves
        output = planned.scene.output
        if output.pictures or output.vtk or output.animation:
            from eigencontact.viz.finished_run import draw_run

            files |= draw_run(
                results, target, stopwatch, painter,
                pictures=output.pictures, vtk=output.vtk, animation=output.animation,
            )  # fmt: skip
        files["summary.json"] = "the numbers of this run, in SI units"
    summary = _summary(planned, store, solved, noted, files, stopwatch, began, predicted, painter)
    if target is not None:
        from eigencontact.results.summary import write_summary

        write_summary(target, summary)
    problems, seconds = () if stored is None else tuple(stored.problems), perf_counter() - began
    return RunResult(summary=summary, folder=target, files=files, problems=problems, seconds=seconds, _store=store)


def _refuse_folder(planned: Plan, folder: Path) -> None:
    """Refuse an animation without steps, and a folder with files of others.

    A finished run of the very same scene may be made again; anything else in the folder is protected.
    """
    from eigencontact.results.ownership import refuse_foreign

    output, requests = planned.scene.output, planned.scene.stress
    if output.animation:
        from eigencontact.viz.movie import refuse_animation

        planes = any(request.shape == "plane" for request in requests)
        refuse_animation(output.animation, planned.steps, shows=bool(planned.scene.geometry) or planes)
    labels = [request.label for request in requests] + [f"fatigue-{item.label}" for item in planned.scene.fatigue]
    animated = bool(output.animation)
    refuse_foreign(folder, labels, summary=True, pictures=output.pictures, vtk=output.vtk, animation=animated)


def _warn_of_targets(store: Store, solved: Solved, noted: dict[str, Any]) -> None:
    """Add a warning for each target that is not met."""
    if noted["accuracy"]["reached"]:
        return
    from eigencontact.accuracy.words import missed_targets
    from eigencontact.core.cautions import Caution
    from eigencontact.results.summary import summary_of

    words = missed_targets(summary_of(store.info, solved.last, noted["history"], noted))
    noted["warnings"] = [*noted["warnings"], Caution("accuracy", words).to_dict()]


def _maker(planned: Plan, registry: Registry | None) -> Callable[[Mapping[str, Any]], Plan]:
    """Plans of other tables of a scene."""
    from eigencontact.scene.schema import Scene

    return lambda tables: plan(Scene(**tables).within(planned.scene.folder), registry=registry)


def _summary(
    planned: Plan,
    store: Store,
    solved: Solved,
    noted: dict[str, Any],
    files: Mapping[str, str],
    stopwatch: Stopwatch,
    began: float,
    predicted: float,
    painter: Painter | None,
) -> dict[str, Any]:
    from eigencontact.core.memory import peak_bytes
    from eigencontact.results.summary import summary_of

    extra = {
        **noted,
        "peak_memory_bytes": peak_bytes() + (0 if painter is None else painter.peak_bytes),
        "predicted_memory_bytes": int(predicted),
        "compute_seconds": solved.seconds,
        "predicted_seconds": planned.seconds,
        "files": files,
        "kernels": [str(kernel) for kernel in planned.kernels],
        "total_seconds": (total := perf_counter() - began),
        "seconds_by_block": stopwatch.seconds | {"rest": total - sum(stopwatch.seconds.values())},
    }
    return summary_of(store.info, solved.last, noted["history"], extra)
