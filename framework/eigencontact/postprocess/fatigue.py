"""Fatigue of stored results: a criterion over a cycle in a region, hot spot, map."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.cautions import Caution
from eigencontact.core.units import parse_quantity, readable
from eigencontact.errors import SceneError, shown
from eigencontact.plugin.fatigue import FatigueCriterion, StressCycle, checked_damage
from eigencontact.postprocess.plot import opened
from eigencontact.postprocess.stress_cycle import CycleOfRegion, cycle_of_region
from eigencontact.scene.components import build_component
from eigencontact.scene.installed import installed_plugins

if TYPE_CHECKING:
    import xarray

    from eigencontact.results.stored import Results

__all__ = ["Fatigue", "fatigue"]

#: Points that a criterion is asked for at once.
_PART = 20_000
#: A hot spot is at the edge of the contact within so many cells of it, and less deep than one.
_EDGE = 2


@dataclass(frozen=True, eq=False)
class Fatigue:
    """Answer of a criterion in a region.

    Attributes
    ----------
    dataset : xarray.Dataset
        ``damage``, ``utilisation`` (damage over limit) and, of criteria that know a plane, ``normal`` at the points.
    summary : dict
        Hot spot: ``utilisation``, ``damage``, ``place`` [m], ``normal``; criterion, cycle, ``warnings``.
    files : dict
        Files that were stored, and what they show.
    """

    dataset: xarray.Dataset
    summary: dict[str, Any]
    files: dict[Path, str] = field(default_factory=dict)

    def lines(self) -> list[str]:
        """Words for the terminal."""
        found = self.summary
        unit = found["unit"]
        value = f"{found['damage']:.6g}" if unit == "1" else readable(found["damage"], unit)
        limit = f"{found['limit']:.6g}" if unit == "1" else readable(found["limit"], unit)
        place = ", ".join(readable(at, "m") for at in found["place"])
        head = (
            f"{found['criterion']['type']} over steps {found['steps'][0]} to {found['steps'][-1]} in "
            f"{found['region']!r}: {found['utilisation']:.4g} of the limit ({value} of {limit}) at ({place})"
        )
        out = [head]
        if found["normal"] is not None:
            out.append("normal of the plane ({:.3f}, {:.3f}, {:.3f})".format(*found["normal"]))
        if found["distance"] is not None:
            at = found["at_distance"]
            out.append(f"{found['method']} method, distance {readable(found['distance'], 'm')}: {at:.4g} of the limit")
        return out + [f"warning: {caution['words']}" for caution in found["warnings"]]

    def __repr__(self) -> str:
        return f"Fatigue({'; '.join(self.lines())})"


def fatigue(
    results: Any,
    criterion: Any,
    *,
    region: str | Mapping[str, Any] | None = None,
    cycle: Literal["last", "all"] | tuple[int, int] = "last",
    distance: float | str | None = None,
    method: Literal["point", "line"] = "point",
    folder: str | Path | None = None,
) -> Fatigue:
    """Where a crack starts: a fatigue criterion over one cycle at the points of a region.

    Parameters
    ----------
    results : str, Path, xarray.Dataset or RunResult
        A folder of results or its ``results.nc``, or what a run returned.
    criterion : FatigueCriterion, mapping or str
        A component, the table of one (``{"type": "crossland", "slope": 0.3, "limit-amplitude": "250 MPa"}``).
    region : str or mapping, optional
        Name of a region with stress, by default the only one; or the table of a new one as of ``[[stress]]``, found
        at each step of the cycle without solving again.
    cycle : {"last", "all"} or (int, int)
        The last closed cycle of the history, all steps, or the numbers of the first and last step.
    distance : float or str, optional
        Critical distance L [m]. The value below the hot spot is found too, `at_distance` in the summary.
    method : {"point", "line"}
        At L/2 below the hot spot, or the mean of the damage parameter down to 2 L.
    folder : str or Path, optional
        Where ``fatigue-<criterion>-<region>`` is stored: ``.nc``, ``.json``, and ``.png`` of planes and volumes; by
        default nothing is stored.

    Returns
    -------
    Fatigue
        Map, hot spot and warnings.

    Raises
    ------
    SceneError, PluginError, ResultsError
        What is refused names the argument, the rule and the nearest valid choice.

    Notes
    -----
    Strain, where a criterion needs it, is that of the region if it stores it (``fields = ["stress", "strain"]``: total
    strain, plastic strain included), else the elastic one of the stress, for bodies of one elastic material only.

    Examples
    --------
    >>> import eigencontact as ec
    >>> changes = ["grid.cells-per-contact-radius=8", "stress.0.depth-cells=10"]
    >>> found = ec.fatigue(
    ...     ec.run(ec.load_scene("hertz", changes)),
    ...     {"type": "crossland", "slope": 0.3, "limit-amplitude": "250 MPa"},
    ...     region="section",
    ...     cycle="all",
    ... )
    >>> sorted(found.dataset)
    ['damage', 'utilisation']
    """
    component = _component(criterion)
    length = _distance(distance, method)
    source = Path(results) if isinstance(results, str | Path) else None
    with opened(results) as dataset:
        found = cycle_of_region(dataset, region, cycle, strain=component.needs_strain, source=source)
        value, normal = _in_parts(component, found.cycle)
        summary = _summary(component, found, value, normal)
        summary["warnings"] = [caution.to_dict() for caution in _cautions(dataset, found, value)]
        summary |= {"distance": length, "method": method if length else None, "at_distance": None}
        if length:
            summary["at_distance"] = _at_distance(found, value, length, method) / component.limit
        answer = Fatigue(_dataset(dataset, component, found, value, normal), summary)
        if folder is None:
            return answer
        return Fatigue(answer.dataset, summary, _store(Path(folder), dataset, found, answer))


def _component(criterion: Any) -> FatigueCriterion:
    if isinstance(criterion, FatigueCriterion):
        return criterion
    table = {"type": criterion} if isinstance(criterion, str) else criterion
    if not isinstance(table, Mapping):
        raise SceneError(f"criterion must be a component, a table or a key (got {shown(criterion)})")
    component: FatigueCriterion = build_component(installed_plugins(), FatigueCriterion.kind, table, "criterion")
    return component


def _distance(distance: float | str | None, method: str) -> float | None:
    if method not in ("point", "line"):
        raise SceneError(f"method must be 'point' or 'line' (got {shown(method)})")
    if distance is None:
        return None
    try:
        length = float(parse_quantity(distance, "m", "a length"))
    except (TypeError, ValueError) as problem:
        raise SceneError(f"distance must be {problem} (got {shown(distance)})") from None
    if not 0 < length < np.inf:
        raise SceneError(f"distance must be positive and finite [m] (got {shown(distance)})")
    return length


def _in_parts(criterion: FatigueCriterion, cycle: StressCycle) -> tuple[FloatArray, FloatArray | None]:
    values, normals = [], []
    for start in range(0, cycle.points, _PART):
        part = slice(start, start + _PART)
        strain = None if cycle.strain is None else cycle.strain[..., part]
        answer = checked_damage(criterion, StressCycle(stress=cycle.stress[..., part], strain=strain))
        values.append(answer.value)
        normals.append(answer.normal)
    normal = None if any(item is None for item in normals) else np.concatenate([n for n in normals if n is not None])
    return np.concatenate(values), normal


def _summary(
    criterion: FatigueCriterion, found: CycleOfRegion, value: FloatArray, normal: FloatArray | None
) -> dict[str, Any]:
    from dataclasses import asdict

    from eigencontact import __version__

    hot = int(value.argmax())
    return {
        "generator": f"eigencontact {__version__}",
        "criterion": {"type": criterion.key, **asdict(criterion)},  # type: ignore[call-overload]
        "region": found.region,
        "body": found.body,
        "steps": [found.steps[0], found.steps[-1]],
        "unit": criterion.unit,
        "limit": float(criterion.limit),
        "damage": float(value[hot]),
        "utilisation": float(value[hot] / criterion.limit),
        "place": [float(at) for at in found.places[:, hot]],
        "normal": None if normal is None else [float(part) for part in normal[hot]],
        "references": list(criterion.references),
    }


def _cautions(dataset: Results, found: CycleOfRegion, value: FloatArray) -> list[Caution]:
    """Whether the hot spot is a number that finer cells or a larger region raise."""
    hot = int(value.argmax())
    x, y, z = (float(at) for at in found.places[:, hot])
    place = ", ".join(readable(at, "m") for at in (x, y, z))
    out = []
    if len(found.steps) == 1:
        words = "the cycle has one step: no stress has an amplitude; store more load steps, as of loading and unloading"
        out.append(Caution("fatigue-cycle", words))
    edge = max(float(size) for size in np.atleast_1d(dataset.attrs["cell_size"]))
    if z < edge and _near_edge(dataset, found, x, y):
        words = (
            f"the largest value, at ({place}), lies at the edge of the contact, where stress grows as cells and points "
            "come closer: compare values at a critical distance, not this one"
        )
        out.append(Caution("fatigue-edge", words, number="utilisation"))
    index = np.unravel_index(hot, found.shape) if found.shape else ()
    for dim, row, size in zip(found.dims, index, found.shape, strict=True):
        if size > 2 and (row == size - 1 or (row == 0 and not dim.endswith("_z"))):
            out.append(
                Caution(
                    "fatigue-border", f"the largest value, at ({place}), lies at the border of the region; enlarge it"
                )
            )
            break
    return out


def _near_edge(dataset: Results, found: CycleOfRegion, x: float, y: float) -> bool:
    """Whether cells near a place are in contact, and others not, at one step of the cycle."""
    if "pressure" not in dataset:
        return False
    numbers = [int(number) for number in dataset["step"].values]
    columns = [
        slice(max(at - _EDGE, 0), at + _EDGE + 1)
        for at in (
            int(np.abs(np.asarray(dataset[axis].values) - place).argmin()) for axis, place in (("y", y), ("x", x))
        )
    ]
    for step in found.steps:
        loaded = np.asarray(dataset["pressure"][numbers.index(step)].values)[columns[0], columns[1]] > 0
        if loaded.any() and not loaded.all():
            return True
    return False


def _at_distance(found: CycleOfRegion, value: FloatArray, length: float, method: str) -> float:
    """Damage parameter below the hot spot: at half of the distance, or its mean down to twice the distance."""
    dim = f"{found.region}_z"
    if dim not in found.dims:
        raise SceneError(f"distance must be given with a region along z (got {found.region!r}, which has one depth)")
    axis = found.dims.index(dim)
    hot = list(np.unravel_index(int(value.argmax()), found.shape))
    column: Any = tuple(slice(None) if number == axis else int(row) for number, row in enumerate(hot))
    below = found.places[2].reshape(found.shape)[column] - found.places[2][int(value.argmax())]
    values, reach = value.reshape(found.shape)[column], (0.5 if method == "point" else 2.0) * length
    if below[-1] < reach:
        raise SceneError(
            f"distance must be such that the region holds {readable(reach, 'm')} below the hot spot (got "
            f"{readable(float(below[-1]), 'm')}); enlarge the region"
        )
    if method == "point":
        return float(np.interp(reach, below, values))
    depths = np.union1d(below[(below > 0) & (below < reach)], [0.0, reach])
    return float(np.trapezoid(np.interp(depths, below, values), depths) / reach)


def _dataset(
    dataset: Results, criterion: FatigueCriterion, found: CycleOfRegion, value: FloatArray, normal: FloatArray | None
) -> xarray.Dataset:
    import xarray

    from eigencontact import __version__

    dims = tuple(dim.removeprefix(f"{found.region}_") for dim in found.dims)
    coordinates: dict[str, Any] = {}
    for axis, places in zip("xyz", found.places, strict=True):
        grid = places.reshape(found.shape)
        if axis in dims:
            rows: Any = tuple(slice(None) if dim == axis else 0 for dim in dims)
            coordinates[axis] = (axis, grid[rows], {"units": "m"})
        elif places.size and np.all(places == places[0]):
            coordinates[axis] = ((), places[0], {"units": "m"})
        else:
            coordinates[axis] = (dims, grid, {"units": "m"})
    attrs = {"units": criterion.unit, "long_name": f"damage parameter of {criterion.key}"}
    fields: dict[str, Any] = {
        "damage": (dims, value.reshape(found.shape), attrs),
        "utilisation": (
            dims,
            value.reshape(found.shape) / criterion.limit,
            {"units": "1", "long_name": "damage parameter over limit"},
        ),
    }
    if normal is not None:
        words = "unit normal of the plane of the criterion"
        fields["normal"] = (("axis", *dims), normal.T.reshape(3, *found.shape), {"units": "1", "long_name": words})
        coordinates["axis"] = ("axis", ["x", "y", "z"])
    described = {"source": f"eigencontact {__version__}", "region": found.region, "body": found.body}
    described |= {"criterion": criterion.key, "first_step": found.steps[0], "last_step": found.steps[-1]}
    return xarray.Dataset(fields, coordinates, described | {"scene_hash": str(dataset.attrs["scene_hash"])})


def _store(folder: Path, dataset: Results, found: CycleOfRegion, answer: Fatigue) -> dict[Path, str]:
    from eigencontact.results.atomic import replacing, writable_folder
    from eigencontact.results.ownership import refuse_foreign_file
    from eigencontact.viz.fatigue import draw_fatigue

    stem = f"fatigue-{answer.summary['criterion']['type']}-{found.region}"
    paths = {ending: folder / f"{stem}.{ending}" for ending in ("nc", "json", "png")}
    for path in paths.values():
        refuse_foreign_file(path)
    writable_folder(folder)
    data = BytesIO()
    answer.dataset.to_netcdf(data, engine="h5netcdf")
    text = json.dumps(answer.summary, indent=2, default=str) + "\n"
    for ending, content in (("nc", data.getvalue()), ("json", text.encode())):
        with replacing(paths[ending], f"fatigue of region {found.region}") as sink:
            sink.write(content)
    files = {
        paths["nc"]: "damage parameter, utilisation and planes, with coordinates and units",
        paths["json"]: "hot spot and warnings",
    }
    sentence = draw_fatigue(dataset, answer.dataset, answer.summary, paths["png"])
    return files | ({paths["png"]: sentence} if sentence else {})
