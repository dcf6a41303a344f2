"""Fretting map: regime, energy, wear, fatigue and arrest of cracks over normal load and amplitude of one scene."""

from __future__ import annotations

from collections.abc import Mapping
from copy import deepcopy
from dataclasses import dataclass, field, replace
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.core.units import parse_quantity, per_length
from eigencontact.errors import EigencontactError, SceneError, shown
from eigencontact.results.cycles import last_cycle
from eigencontact.sweeps.axes import Axis, axes_of
from eigencontact.sweeps.gather import gathered
from eigencontact.sweeps.runner import outcomes
from eigencontact.sweeps.sweep import ProgressReport
from eigencontact.sweeps.variants import Variant

if TYPE_CHECKING:
    import xarray

    from eigencontact.planning.plan import Plan
    from eigencontact.results.run_result import RunResult
    from eigencontact.scene.schema import Scene

__all__ = ["FrettingMap", "fretting_map"]

#: Keys of steps that drive a fretting motion, and their units.
_DRIVEN = {"shift-x": "m", "shift-y": "m", "tangential-load-x": "N", "tangential-load-y": "N"}
#: Energy ratio below which a loop counts as closed (stick), and from which on it counts as gross slip if the run does
#: not say which cells slip: Fouvry, Kapsa, Vincent, Wear 185 (1995) 35.
_STICK, _GROSS = 0.02, 0.2
_REGIMES = ("stick", "partial slip", "gross slip")


@dataclass(frozen=True, eq=False)
class FrettingMap:
    """Numbers of the last cycle over load and amplitude.

    Attributes
    ----------
    dataset : xarray.Dataset
        By ``load`` [N] and ``amplitude`` [m, or N of a driven load], per metre in a line contact: ``regime`` (0 stick,
        1 partial slip, 2 gross slip), ``cycle_energy`` [J], ``energy_ratio`` [-], and the numbers that a sweep has;
        ``utilisation`` and ``arrest_length`` where they were asked for; ``failed``.
    files : dict
        Files that were stored, and what they show.
    """

    dataset: xarray.Dataset
    files: dict[Path, str] = field(default_factory=dict)

    def lines(self) -> list[str]:
        """Words for the terminal."""
        regime = self.dataset["regime"].values
        counts = ", ".join(f"{int(np.sum(regime == k))} {name}" for k, name in enumerate(_REGIMES))
        out = [f"{regime.size} variants: {counts}"]
        reasons = [str(reason) for reason in self.dataset["failed"].values.ravel() if reason]
        return out + ([f"{len(reasons)} failed; the first: {reasons[0]}"] if reasons else [])


def fretting_map(
    scene: Scene | str | Path | Mapping[str, Any],
    *,
    load: Any,
    amplitude: Any,
    criterion: Any = None,
    crack: Mapping[str, Any] | None = None,
    region: str | None = None,
    workers: int = 1,
    folder: str | Path | None = None,
    report_progress: ProgressReport | None = None,
) -> FrettingMap:
    """Map of running regimes of a fretting scene: all normal loads with all amplitudes.

    Parameters
    ----------
    scene : Scene, str, Path or mapping
        Its steps have a normal load and a closed cycle of one shift or tangential load.
    load, amplitude : str, mapping or sequence
        Values as in a sweep: ``"5 N:50 N:20"``, ``["5 N", "10 N"]``. The map scales all normal loads of the steps so
        that the largest is the load, and all values of the motion so that the largest magnitude is the amplitude
        (half of the range of a symmetric cycle).
    criterion : mapping or str, optional
        Fatigue criterion: ``utilisation`` is its largest value over the limit in `region`, or with ``distance`` (and
        ``method``) in the table its value at this critical distance, as of ``[[fatigue]]``.
    crack : mapping, optional
        Arguments of `eigencontact.crack`: ``arrest_length`` [m], 0 where no crack grows, infinite where none stops.
    region : str, optional
        Region of the scene with stress, for criterion and crack.
    workers : int
        Processes that share the variants; more than one needs a guard as for `eigencontact.sweep`.
    folder : str or Path, optional
        Folder for ``map.nc`` and ``map.png``; by default nothing is stored.
    report_progress : callable, optional
        Receives each outcome, its number and the number of variants.

    Raises
    ------
    SceneError
        A scene without a normal load or with more than one motion; values that break a rule.
    EigencontactError
        Every variant failed.

    Notes
    -----
    A cycle is gross slip if the whole contact slips in at least one step, stick if the energy ratio
    ``E / (4 Q* delta*)`` is below 0.02, and else partial slip. The runs remain in memory.

    Examples
    --------
    >>> import eigencontact as ec
    >>> small = ["grid.cells-per-contact-radius=4", "observers=[]", "steps.1.increments=2"]
    >>> scene = ec.load_scene("fretting-mode-1", [*small, "steps.2.increments=3", "steps.3.increments=3"])
    >>> answer = ec.fretting_map(scene, load=["6 N"], amplitude=["0.05 um", "0.5 um", "1.1 um"])
    >>> answer.dataset["regime"].values.tolist()
    [[0.0, 1.0, 2.0]]
    """
    from eigencontact.app import load_scene

    loaded = load_scene(scene)
    tables = loaded.resolved()
    if criterion is None and crack is None and not tables["fatigue"]:
        tables = {**tables, "stress": []}  # nothing reads it
    driven = _driven(tables)
    line = loaded.grid.line
    units = [per_length(unit, line=line) for unit in ("N", _DRIVEN[driven])]
    axes = [
        _in_si(axes_of({name: values} if not isinstance(values, str) else [f"{name}={values}"])[0], unit)
        for name, values, unit in (("load", load, units[0]), ("amplitude", amplitude, units[1]))
    ]
    variants = [
        _variant(loaded, tables, driven, (i, j), (p, d))
        for i, p in enumerate(axes[0].values)
        for j, d in enumerate(axes[1].values)
    ]
    measure = _Numbers(criterion, crack, region, threads=None if workers == 1 else 1)
    finished = []
    for outcome in outcomes(variants, None, workers=workers, measure=measure):
        finished.append(outcome)
        if report_progress is not None:
            report_progress(outcome, len(finished), len(variants))
    failed = [outcome.failed for outcome in finished if outcome.failed]
    if len(failed) == len(variants):
        raise EigencontactError(f"map must have a variant that can be solved (got {len(failed)} failed; {failed[0]})")
    dataset = gathered(axes, variants, finished, loaded.title or loaded.label, pairs=False)
    names = {"load": "normal load", "amplitude": f"amplitude of {driven}"}
    dataset = dataset.assign_coords(
        {
            axis.name: (axis.name, list(axis.values), {"units": unit, "long_name": names[axis.name]})
            for axis, unit in zip(axes, units, strict=True)
        }
    )
    for name, (unit, words) in _MEASURED.items():
        if name in dataset:
            dataset[name].attrs.update(units=per_length(unit, line=line), long_name=words)
    dataset.attrs["source"] = "eigencontact map"
    return FrettingMap(dataset, {} if folder is None else _store(Path(folder), dataset))


_MEASURED = {
    "regime": ("1", "running regime: 0 stick, 1 partial slip, 2 gross slip"),
    "cycle_energy": ("J", "work of friction in the last cycle"),
    "energy_ratio": ("1", "work of friction over the rectangle around the loop"),
    "utilisation": ("1", "damage parameter over limit, largest or at the critical distance"),
    "arrest_length": ("m", "length at which a crack stops"),
}


def _driven(tables: Mapping[str, Any]) -> str:
    """Key of the motion; the steps must have one, and a normal load."""
    keys = [key for step in _steps(tables["steps"]) for key in step if step[key]]
    if "normal-load" not in keys:
        raise SceneError("steps of a map must prescribe normal-load, which is varied (got none)")
    motions = sorted(set(keys) & set(_DRIVEN))
    if len(motions) != 1:
        raise SceneError(
            f"steps of a map must have one motion of {', '.join(_DRIVEN)} (got {', '.join(motions) or 'none'})"
        )
    return motions[0]


def _steps(steps: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Steps, and those of their cycles."""
    return [inner for step in steps for inner in (step, *_steps(step.get("cycle") or []))]


def _in_si(axis: Axis, unit: str) -> Axis:
    values = []
    for value in axis.values:
        try:
            values.append(float(parse_quantity(value, unit, "a number")))
        except (TypeError, ValueError) as problem:
            raise SceneError(f"{axis.key} of a map must be {problem} (got {shown(value)})") from None
    if not all(0 < value < np.inf for value in values) or sorted(values) != values:
        raise SceneError(f"{axis.key} of a map must be positive values that ascend [{unit}] (got {shown(axis.values)})")
    return Axis(axis.key, tuple(values))


def _variant(
    scene: Scene, tables: Mapping[str, Any], driven: str, place: tuple[int, int], values: tuple[float, float]
) -> Variant:
    from eigencontact.scene.schema import Scene as Made

    changed = deepcopy(dict(tables))
    changed["output"] = {**changed.get("output", {}), "pictures": False, "vtk": False, "animation": False}
    steps = _steps(changed["steps"])
    for key, value in zip(("normal-load", driven), values, strict=True):
        largest = max(abs(step[key]) for step in steps if step.get(key))
        for step in steps:
            if step.get(key):
                step[key] *= value / largest
    label, named = (
        f"load={values[0]:.6g}_amplitude={values[1]:.6g}",
        dict(zip(("load", "amplitude"), values, strict=True)),
    )
    try:
        return Variant(label, place, named, Made(**changed).within(scene.folder))
    except EigencontactError as problem:
        return Variant(label, place, named, None, str(problem))


@dataclass(frozen=True)
class _Numbers:
    """Numbers of one run, in the process that ran it; see `eigencontact.sweeps.runner.Measure`."""

    criterion: Any
    crack: Mapping[str, Any] | None
    region: str | None
    threads: int | None

    def planned(self, plan: Plan) -> Plan:
        """Plan whose regions have the stress of the last step alone; a criterion has that of its cycle computed."""
        from eigencontact.execution.fields.regions import Region

        if self.criterion is None or self.crack is not None or plan.conclusions or plan.model.wear is not None:
            return plan
        return replace(
            plan,
            blocks=[
                block.of_step(plan.steps) if isinstance(block, Region) and block.stored and block.by_depths else block
                for block in plan.blocks
            ],
        )

    def numbers(self, plan: Plan, result: RunResult) -> dict[str, float]:
        """Regime, energies, and the requested utilisation and arrest length."""
        rows = result.summary["history"]
        history = {name: np.array([row[name] for row in rows], dtype=float) for name in rows[0]}
        cycle = last_cycle(history)
        if cycle is None:
            raise SceneError("steps of a map must end with a closed cycle of the motion (got none)")
        energy = cycle.dissipated if np.isfinite(cycle.dissipated) else cycle.area
        ratio = cycle.energy_ratio
        slips = history.get("slip_fraction")
        gross = ratio > _GROSS if slips is None else slips[cycle.first + 1 : cycle.last + 1].max() >= 1.0
        out = {"regime": 2.0 if gross else float(ratio >= _STICK), "cycle_energy": energy, "energy_ratio": ratio}
        with result.stored() as results:
            if self.criterion is not None:
                from eigencontact.execution.fields.regions import Region
                from eigencontact.postprocess.fatigue import utilisation

                regions = [block for block in plan.blocks if isinstance(block, Region) and block.only_step is not None]
                out["utilisation"] = utilisation(
                    results, self.criterion, region=self.region, threads=self.threads, regions=regions
                )
            if self.crack is not None:
                from eigencontact.postprocess.crack import crack as evaluate

                stop = evaluate(results, region=self.region, **self.crack).summary["arrest_length"]
                out["arrest_length"] = float("inf") if stop is None else stop
        return out


def _store(folder: Path, dataset: xarray.Dataset) -> dict[Path, str]:
    from eigencontact.results.atomic import replacing, writable_folder
    from eigencontact.results.ownership import refuse_foreign_file
    from eigencontact.viz.fretting_map import draw_fretting_map

    data, picture = folder / "map.nc", folder / "map.png"
    for path in (data, picture):
        refuse_foreign_file(path)
    writable_folder(folder)
    content = BytesIO()
    dataset.to_netcdf(content, engine="h5netcdf")
    with replacing(data, "the fretting map") as sink:
        sink.write(content.getvalue())
    return {data: "all numbers by load and amplitude", picture: draw_fretting_map(dataset, picture)}
