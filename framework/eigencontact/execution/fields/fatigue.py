"""Evaluation of fatigue criteria in regions: damage parameter, hot spot, critical distance, life."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from functools import partial
from math import isfinite
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.cautions import Caution
from eigencontact.core.numbers import Number
from eigencontact.core.parallel import available_threads, in_parallel
from eigencontact.core.units import readable
from eigencontact.execution.blocks.block import Cost
from eigencontact.execution.blocks.conclusion import Conclusion, Findings
from eigencontact.execution.fields.critical_distance import value_near
from eigencontact.execution.fields.stress_cycle import CycleOfRegion, cycle_of_region
from eigencontact.model.model import Model
from eigencontact.model.regions import region_lattice
from eigencontact.plugin.fatigue import DamageParameter, FatigueCriterion, StressCycle, checked_damage
from eigencontact.results.borders import Variable
from eigencontact.results.stored import widest_edge
from eigencontact.scene.fatigue import CriticalDistance

if TYPE_CHECKING:
    from eigencontact.model.fatigue import FatigueModel
    from eigencontact.results.stored import Results

__all__ = ["ROLE", "Damage", "EvaluateFatigue", "damage_in_parts", "damage_of", "fatigue_conclusions"]

#: Role of the variables of results that hold the utilisation of a criterion.
ROLE = "fatigue"
#: Points per call of a criterion: 20 000 take 4 % longer, and leave some threads without work.
_CHUNK = 5_000
#: A hot spot counts as being at the edge of the contact if the edge is within this many cells and the depth is below
#: one cell.
_EDGE = 2
#: Time of a criterion with planes per point and step [s]: 30 000 points and 24 steps took 3.9 s of processor time.
_SECONDS = 5.5e-6


@dataclass(frozen=True, eq=False)
class Damage:
    """Damage parameter over one cycle at the points of a region.

    Attributes
    ----------
    region : CycleOfRegion
        Points and steps.
    value : (points,)
        Damage parameter, in the unit of the criterion.
    normal : (points, 3) or None
        Unit normals of the critical planes; None for a criterion without planes.
    summary : dict
        Hot spot, value near it, life, warnings: plain data.
    """

    region: CycleOfRegion
    value: FloatArray
    normal: FloatArray | None
    summary: dict[str, Any]


def damage_of(
    dataset: Results, criterion: FatigueCriterion, region: CycleOfRegion, settings: CriticalDistance, threads: int = 1
) -> Damage:
    """Evaluate a criterion over a cycle in a region, with blocks of points in threads.

    Raises
    ------
    SceneError
        The region does not contain the critical distance.
    PluginError
        The criterion returned an invalid damage parameter.
    """
    value, normal = damage_in_parts(criterion, region.cycle, threads)
    hot = int(value.argmax())
    cautions = _cautions(dataset, region, value)
    summary: dict[str, Any] = {
        "criterion": {"type": criterion.key, **asdict(criterion)},  # type: ignore[call-overload]
        "region": region.region,
        "body": region.body,
        "steps": [region.steps[0], region.steps[-1]],
        "unit": criterion.unit,
        "limit": float(criterion.limit),
        "damage": float(value[hot]),
        "utilisation": float(value[hot] / criterion.limit),
        "place": [float(at) for at in region.places[:, hot]],
        "normal": None if normal is None else [float(component) for component in normal[hot]],
        "references": list(criterion.references),
        "warnings": [caution.to_dict() for caution in cautions],
        "distance": settings.distance,
        "method": settings.method if settings.distance else None,
        "at_distance": None,
        "life": None,
    }
    if settings.distance:
        summary["at_distance"] = value_near(region, value, settings.distance, settings.method) / criterion.limit
    if settings.life is not None:
        counts = summary["at_distance"] if settings.distance else summary["utilisation"]
        ratio, curve = max(counts, 0.0) ** (1.0 / criterion.amplitude_power), settings.life.curve
        probability = settings.life.failure_probability
        cycles = curve.cycles(ratio, probability)
        summary["life"] = {
            "amplitude_ratio": ratio,
            "failure_probability": probability,
            "cycles": cycles if isfinite(cycles) else None,
            "failure_probability_without_end": curve.failure_probability(ratio),
        }
    return Damage(region, value, normal, summary)


def damage_in_parts(
    criterion: FatigueCriterion, cycle: StressCycle, threads: int
) -> tuple[FloatArray, FloatArray | None]:
    """Damage parameters (n,) of a criterion and normals (n, 3) of its planes, with blocks of points in threads.

    The normals are None for a criterion without planes.
    """
    starts = range(0, cycle.points, _CHUNK)
    answers: dict[int, DamageParameter] = {}

    def ask(start: int) -> None:
        answers[start] = checked_damage(criterion, cycle.at(slice(start, start + _CHUNK)))

    in_parallel(threads, [partial(ask, start) for start in starts])
    normals = [normal for start in starts if (normal := answers[start].normal) is not None]
    value = np.concatenate([answers[start].value for start in starts])
    return value, np.concatenate(normals) if len(normals) == len(starts) else None


def _cautions(dataset: Results, region: CycleOfRegion, value: FloatArray) -> list[Caution]:
    """Warnings if finer cells or a larger region would increase the value at the hot spot."""
    hot = int(value.argmax())
    x, y, z = (float(at) for at in region.places[:, hot])
    place = ", ".join(readable(at, "m") for at in (x, y, z))
    out = []
    if len(region.steps) == 1:
        words = "the cycle has one step, so that stress amplitudes are zero; store the steps of loading and unloading"
        out.append(Caution("fatigue-cycle", words))
    if z < widest_edge(dataset) and _near_edge(dataset, region, x, y):
        words = (
            f"the largest value, at ({place}), lies at the edge of the contact, where stress grows with finer cells "
            "and closer points: compare values at a critical distance instead"
        )
        out.append(Caution("fatigue-edge", words, number="utilisation"))
    index = np.unravel_index(hot, region.shape) if region.shape else ()
    for dim, row, size in zip(region.dims, index, region.shape, strict=True):
        if size > 2 and (row == size - 1 or (row == 0 and not dim.endswith("_z"))):
            words = f"the largest value, at ({place}), lies at the border of the region; enlarge the region"
            out.append(Caution("fatigue-border", words))
            break
    return out


def _near_edge(dataset: Results, region: CycleOfRegion, x: float, y: float) -> bool:
    """Whether an edge of the contact is near a position: cells with and without contact, in one step of the cycle."""
    if "pressure" not in dataset:
        return False
    numbers = [int(number) for number in dataset["step"].values]
    columns = [
        slice(max(at - _EDGE, 0), at + _EDGE + 1)
        for at in (
            int(np.abs(np.asarray(dataset[axis].values) - place).argmin()) for axis, place in (("y", y), ("x", x))
        )
    ]
    for step in region.steps:
        loaded = np.asarray(dataset["pressure"][numbers.index(step)].values)[columns[0], columns[1]] > 0
        if loaded.any() and not loaded.all():
            return True
    return False


class EvaluateFatigue(Conclusion):
    """A fatigue criterion over a cycle of a run.

    Parameters
    ----------
    model : FatigueModel
        Criterion, region, cycle.
    points, steps : int
        Numbers of points and steps, for the cost.
    threads : int
        Threads for the points.
    """

    def __init__(self, model: FatigueModel, points: int, steps: int, threads: int) -> None:
        self._model, self._threads, label = model, threads, model.request.label
        self.name, self.reason = f"fatigue:{label}", f"[[fatigue]] {model.criterion.key!r} in {model.region.label!r}"
        names = ["utilisation", "x", "y", "depth"]
        names += ["at_distance"] if model.request.distance else []
        names += ["cycles", "failure_probability"] if model.request.life else []
        self.numbers = tuple(_number(label, model.criterion.key, name) for name in names)
        work = 6.0 * 8.0 * steps * points * (2.0 if model.criterion.needs_strain else 1.0)
        self.cost = Cost(transient=3.0 * work, seconds_once=_SECONDS * steps * points)

    def conclude(self, results: Results) -> Findings:
        """See `Conclusion.conclude`."""
        model, request = self._model, self._model.request
        cycle = request.cycle if isinstance(request.cycle, str) else tuple(request.cycle)
        region = cycle_of_region(results, model.region.label, cycle, strain=model.criterion.needs_strain)
        damage = damage_of(results, model.criterion, region, request, self._threads)
        summary = damage.summary
        values = dict(zip(("x", "y", "depth"), summary["place"], strict=True))
        values |= {"utilisation": summary["utilisation"], "at_distance": summary["at_distance"]}
        if summary["life"] is not None:
            values["cycles"] = summary["life"]["cycles"]
            values["failure_probability"] = summary["life"]["failure_probability_without_end"]
        label = request.label
        attrs: dict[str, str | int] = {
            "role": ROLE, "units": "1", "region": region.region, "body": region.body, "fatigue": json.dumps(summary),
            "long_name": f"damage parameter of {model.criterion.key} over its limit",
        }  # fmt: skip
        name = f"{region.region}_fatigue_{label}"
        utilisation = (damage.value / model.criterion.limit).reshape(region.shape)
        return Findings(
            numbers={_name(label, name): value for name, value in values.items() if value is not None},
            variables=[Variable(name=name, dims=region.dims, values=utilisation, attrs=attrs)],
            cautions=list(self._renamed(summary["warnings"])),
        )

    def _renamed(self, warnings: Iterable[dict[str, Any]]) -> Iterator[Caution]:
        """Warnings with the names of the numbers of this run; a life at the hot spot has the warnings of its value."""
        request = self._model.request
        of_hot_spot = ["utilisation"] + ["cycles"] * (request.life is not None and request.distance is None)
        for table in warnings:
            caution = Caution(**table)
            if not caution.number:
                yield replace(caution, words=f"fatigue {request.label!r}: {caution.words}")
                continue
            for name in of_hot_spot:
                number = _name(request.label, name)
                yield replace(caution, words=f"{number}: {caution.words}", number=number)


def _name(label: str, name: str) -> str:
    return f"fatigue_{label}_{name}"


def _number(label: str, key: str, name: str) -> Number:
    """Declaration of a number of a criterion."""
    spot = f"hot spot of {key}"
    unit, meaning, words = {
        "utilisation": ("1", f"largest damage parameter of {key} over its limit", f"{key} over limit"),
        "x": ("m", f"{spot}, along x", ""),
        "y": ("m", f"{spot}, along y", ""),
        "depth": ("m", f"{spot}, depth", "  at depth"),
        "at_distance": ("1", f"damage parameter of {key} at the critical distance, over its limit", "  near hot spot"),
        "cycles": ("1", f"cycles to failure by {key}; none below the limit amplitude", "  cycles to failure"),
        "failure_probability": ("1", f"part that ever fails by {key}", "  failure probability"),
    }[name]
    return Number(
        name=_name(label, name), unit=unit, meaning=meaning, headline=bool(words), label=words,
        of_points=name == "depth",
    )  # fmt: skip


def fatigue_conclusions(model: Model) -> Sequence[Conclusion]:
    """One conclusion for each fatigue table of a scene."""
    conclusions, threads = [], model.numerics.threads or available_threads()
    for item in model.fatigue:
        lattice = region_lattice(item.region, model.grid)
        points = lattice.depths.size * lattice.target[0] * lattice.target[1]
        points = points if lattice.points is None else len(lattice.points)
        conclusions.append(EvaluateFatigue(item, points, model.steps, threads))
    return conclusions
