"""Fatigue of stored results: a criterion over a cycle in a region, hot spot, map."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from eigencontact import __version__
from eigencontact.core.parallel import available_threads
from eigencontact.core.units import readable
from eigencontact.errors import SceneError, shown
from eigencontact.execution.fields.fatigue import Damage, damage_of
from eigencontact.execution.fields.largest_damage import utilisation_of
from eigencontact.execution.fields.stress_cycle import StressAt
from eigencontact.execution.fields.stress_cycle import cycle_of_region as stored_cycle
from eigencontact.execution.fields.stress_of_steps import StressOfSteps
from eigencontact.plugin.fatigue import FatigueCriterion
from eigencontact.postprocess.answer import Answer
from eigencontact.postprocess.plot import opened
from eigencontact.postprocess.stress_cycle import cycle_of_region
from eigencontact.scene.components import build_component
from eigencontact.scene.fatigue import CriticalDistance
from eigencontact.scene.installed import installed_plugins

if TYPE_CHECKING:
    import xarray

    from eigencontact.execution.fields.regions import Region
    from eigencontact.results.stored import Results

__all__ = ["Fatigue", "fatigue", "utilisation"]


@dataclass(frozen=True, eq=False, repr=False)
class Fatigue(Answer):
    """Result of a criterion in a region.

    Attributes
    ----------
    dataset : xarray.Dataset
        ``damage``, ``utilisation`` (damage over limit) and, of criteria that know a plane, ``normal`` at the points.
    summary : dict
        Hot spot: ``utilisation``, ``damage``, ``place`` [m], ``normal``; criterion, cycle, ``warnings``; with a
        critical distance ``at_distance`` over the limit; with a Wöhler curve ``life``: ``cycles`` (None without end),
        ``failure_probability`` to which they belong, ``failure_probability_without_end``.
    files : dict
        Files that were stored, and what they show.
    """

    def lines(self) -> list[str]:
        """Words for the terminal."""
        summary = self.summary
        unit = summary["unit"]
        value = f"{summary['damage']:.6g}" if unit == "1" else readable(summary["damage"], unit)
        limit = f"{summary['limit']:.6g}" if unit == "1" else readable(summary["limit"], unit)
        place = ", ".join(readable(at, "m") for at in summary["place"])
        head = (
            f"{summary['criterion']['type']} over steps {summary['steps'][0]} to {summary['steps'][-1]} in "
            f"{summary['region']!r}: {summary['utilisation']:.4g} of the limit ({value} of {limit}) at ({place})"
        )
        out = [head]
        if summary["normal"] is not None:
            out.append("normal of the plane ({:.3f}, {:.3f}, {:.3f})".format(*summary["normal"]))
        if summary["distance"] is not None:
            at, length = summary["at_distance"], readable(summary["distance"], "m")
            words = f"volume method, radius {length}" if summary["method"] == "volume" else ""
            out.append(f"{words or summary['method'] + ' method, distance ' + length}: {at:.4g} of the limit")
        if (life := summary["life"]) is not None:
            cycles = "no end of life" if life["cycles"] is None else f"{life['cycles']:.3g} cycles"
            out.append(
                f"{cycles} at a failure probability of {life['failure_probability']:g}; at "
                f"{life['amplitude_ratio']:.4g} of the limit amplitude {life['failure_probability_without_end']:.3g} "
                "of all fail in the end"
            )
        return out + [f"warning: {caution['words']}" for caution in summary["warnings"]]


def fatigue(
    results: Any,
    criterion: Any,
    *,
    region: str | Mapping[str, Any] | None = None,
    cycle: Literal["last", "all"] | tuple[int, int] = "last",
    distance: float | str | None = None,
    method: Literal["point", "line", "volume"] = "point",
    life: Mapping[str, float] | None = None,
    folder: str | Path | None = None,
    threads: int | None = None,
) -> Fatigue:
    """Fatigue criterion over one cycle at the points of a region, with the hot spot where a crack starts first.

    Parameters
    ----------
    results : str, Path, xarray.Dataset or RunResult
        A folder of results or its ``results.nc``, or what a run returned.
    criterion : FatigueCriterion, mapping or str
        A component, the table of one (``{"type": "crossland", "slope": 0.3, "limit-amplitude": "250 MPa"}``).
    region : str or mapping, optional
        Name of a region with stress, by default the only one; or the table of a new region as in ``[[stress]]``, whose
        stress is computed at each step of the cycle without a new solution.
    cycle : {"last", "all"} or (int, int)
        The last closed cycle of the history, all steps, or the numbers of the first and last step.
    distance : float or str, optional
        Critical distance L [m] for an additional value near the hot spot, `at_distance` in the summary.
    method : {"point", "line", "volume"}
        At L/2 below the hot spot; mean of the damage parameter down to 2 L; mean over the part of the body within the
        radius L.
    life : mapping, optional
        Wöhler curve relative to the limit amplitude: ``{"slope": 5, "knee_cycles": 1e6, "scatter": 1.5,
        "failure_probability": 0.1}``, see `eigencontact.scene.fatigue.Life`.
    folder : str or Path, optional
        Folder for ``fatigue-<criterion>-<region>``: ``.nc``, ``.json``, and ``.png`` of planes and volumes; by
        default nothing is stored.
    threads : int, optional
        Threads that share the points; by default one for each core.

    Returns
    -------
    Fatigue
        Map, hot spot and warnings.

    Raises
    ------
    SceneError, PluginError, ResultsError
        An invalid argument, with the rule and the nearest valid choice.

    Notes
    -----
    Criteria with strain use the stored strain of the region (``fields = ["stress", "strain"]``: total strain with
    plastic strain), or else the elastic strain of the stress, for bodies of one elastic material only.

    Examples
    --------
    >>> import eigencontact as ec
    >>> changes = ["grid.cells-per-contact-radius=8", "stress.0.depth-cells=10"]
    >>> fatigue = ec.fatigue(
    ...     ec.run(ec.load_scene("hertz", changes)),
    ...     {"type": "crossland", "slope": 0.3, "limit-amplitude": "250 MPa"},
    ...     region="section",
    ...     cycle="all",
    ... )
    >>> sorted(fatigue.dataset)
    ['damage', 'utilisation']
    """
    component = _component(criterion)
    settings = CriticalDistance.of(distance=distance, method=method, life=life)
    source = Path(results) if isinstance(results, str | Path) else None
    with opened(results) as dataset:
        cycle_region = cycle_of_region(dataset, region, cycle, strain=component.needs_strain, source=source)
        damage = damage_of(dataset, component, cycle_region, settings, threads or available_threads())
        summary = {"generator": f"eigencontact {__version__}", **damage.summary}
        answer = Fatigue(_dataset(dataset, component, damage), summary)
        if folder is None:
            return answer
        from eigencontact.viz.fatigue import draw_fatigue

        name, place = summary["criterion"]["type"], summary["region"]
        return answer.stored(
            folder, f"fatigue-{name}-{place}", f"fatigue of region {place}",
            ("damage parameter, utilisation and planes, with coordinates and units", "hot spot and warnings"),
            lambda path: draw_fatigue(dataset, answer.dataset, summary, path),
        )  # fmt: skip


def utilisation(
    results: Any,
    criterion: Any,
    *,
    region: str | None = None,
    threads: int | None = None,
    regions: Iterable[Region] = (),
) -> float:
    """Largest damage parameter over the limit in the last closed cycle, or that at the critical distance.

    The number is that of `fatigue`, which evaluates all points; this evaluates those that can have the largest.

    Parameters
    ----------
    criterion : FatigueCriterion, mapping or str
        As of `fatigue`; ``distance`` and ``method`` may be in the table.
    regions : iterable of Region
        Regions whose stress is not stored in all steps: it is computed from the surface fields.
    """
    table = dict(criterion) if isinstance(criterion, Mapping) else criterion
    near = {key: table.pop(key) for key in ("distance", "method") if isinstance(table, dict) and key in table}
    component, settings = _component(table), CriticalDistance.of(**near)
    with opened(results) as dataset:

        def computed(name: str, steps: list[int]) -> StressAt | None:
            block = next((block for block in regions if block.request.label == name), None)
            return None if block is None else StressOfSteps(block, dataset, steps)

        cycle_region = stored_cycle(dataset, region, "last", strain=component.needs_strain, computed=computed)
        return utilisation_of(component, cycle_region, settings, threads or available_threads())


def _component(criterion: Any) -> FatigueCriterion:
    if isinstance(criterion, FatigueCriterion):
        return criterion
    table = {"type": criterion} if isinstance(criterion, str) else criterion
    if not isinstance(table, Mapping):
        raise SceneError(f"criterion must be a component, a table or a key (got {shown(criterion)})")
    component: FatigueCriterion = build_component(installed_plugins(), FatigueCriterion.kind, table, "criterion")
    return component


def _dataset(dataset: Results, criterion: FatigueCriterion, damage: Damage) -> xarray.Dataset:
    import xarray

    region_cycle, value, normal = damage.region, damage.value, damage.normal
    dims = tuple(dim.removeprefix(f"{region_cycle.region}_") for dim in region_cycle.dims)
    coordinates: dict[str, Any] = {}
    for axis, places in zip("xyz", region_cycle.places, strict=True):
        grid = places.reshape(region_cycle.shape)
        if axis in dims:
            rows: Any = tuple(slice(None) if dim == axis else 0 for dim in dims)
            coordinates[axis] = (axis, grid[rows], {"units": "m"})
        elif places.size and np.all(places == places[0]):
            coordinates[axis] = ((), places[0], {"units": "m"})
        else:
            coordinates[axis] = (dims, grid, {"units": "m"})
    attrs = {"units": criterion.unit, "long_name": f"damage parameter of {criterion.key}"}
    fields: dict[str, Any] = {
        "damage": (dims, value.reshape(region_cycle.shape), attrs),
        "utilisation": (
            dims,
            value.reshape(region_cycle.shape) / criterion.limit,
            {"units": "1", "long_name": "damage parameter over limit"},
        ),
    }
    if normal is not None:
        words = "unit normal of the plane of the criterion"
        fields["normal"] = (
            ("axis", *dims),
            normal.T.reshape(3, *region_cycle.shape),
            {"units": "1", "long_name": words},
        )
        coordinates["axis"] = ("axis", ["x", "y", "z"])
    described = {"source": f"eigencontact {__version__}", "region": region_cycle.region, "body": region_cycle.body}
    described |= {"criterion": criterion.key, "first_step": region_cycle.steps[0], "last_step": region_cycle.steps[-1]}
    return xarray.Dataset(fields, coordinates, described | {"scene_hash": str(dataset.attrs["scene_hash"])})
