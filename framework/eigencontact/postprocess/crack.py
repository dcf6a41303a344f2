"""Whether a crack stops: stress intensity factors of an edge crack over a stored cycle, against a threshold."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.cautions import Caution
from eigencontact.core.units import parse_quantity, readable
from eigencontact.errors import SceneError, shown
from eigencontact.postprocess.crack_path import CrackPath, stress_on_path
from eigencontact.postprocess.crack_threshold import Threshold
from eigencontact.postprocess.fatigue import Fatigue
from eigencontact.postprocess.plot import opened
from eigencontact.postprocess.stress_cycle import cycle_of_region
from eigencontact.solvers.edge_crack import EdgeCrack

if TYPE_CHECKING:
    import xarray

    from eigencontact.results.stored import Results

__all__ = ["Crack", "crack"]

#: Lengths of a crack, evenly spaced in their logarithm.
_LENGTHS = 60
#: The shortest crack, in spacings of the points of the region: nearer to its mouth the stress is not resolved.
_SHORTEST = 2.0
#: Ranges that may be compared with a threshold.
_COMPARED = {"effective": "effective_range", "opening": "mode_1_range"}


@dataclass(frozen=True, eq=False)
class Crack:
    """Answer of `crack`.

    Attributes
    ----------
    dataset : xarray.Dataset
        Over ``length`` [m]: ``mode_1_range``, ``mode_2_range``, ``effective_range`` and ``threshold`` [Pa sqrt(m)],
        ``load_ratio``; ``mode_1`` and ``mode_2`` over ``step`` and ``length``.
    summary : dict
        ``fate`` ("does not start", "stops" or "grows"), ``arrest_length`` [m], place, angle, cycle, ``warnings``.
    files : dict
        Files that were stored, and what they show.
    """

    dataset: xarray.Dataset
    summary: dict[str, Any]
    files: dict[Path, str] = field(default_factory=dict)

    def lines(self) -> list[str]:
        """Words for the terminal."""
        summary = self.summary
        place, angle = readable(summary["place"], "m"), np.degrees(summary["angle"])
        fate = {
            "does not start": f"does not start: the range is below the threshold at {readable(summary['first'], 'm')}",
            "stops": "stops at a length of " + readable(summary["arrest_length"] or 0.0, "m"),
            "grows": f"grows up to {readable(summary['last'], 'm')}, the longest that was looked at",
            "unknown": "has no threshold to compare with",
        }[summary["fate"]]
        where = f"{summary['axis']} = {place}, {angle:.3g} degrees from the normal, in {summary['region']!r}"
        span, length = summary["largest_range"] / 1e6, readable(summary["worst_length"], "m")
        largest = f"largest range {span:.4g} MPa m^0.5 at a length of {length}"
        return [
            f"crack at {where}: {fate}",
            largest,
            *(f"warning: {caution['words']}" for caution in summary["warnings"]),
        ]

    def __repr__(self) -> str:
        return f"Crack({'; '.join(self.lines())})"


def crack(
    results: Any,
    *,
    at: float | str | None = None,
    angle: float | str | None = None,
    start: Fatigue | Mapping[str, Any] | None = None,
    threshold: Threshold | Mapping[str, Any] | Callable[[FloatArray], FloatArray] | None = None,
    compare: Literal["effective", "opening"] = "effective",
    lengths: Sequence[float | str] | None = None,
    region: str | None = None,
    cycle: Any = None,
    folder: str | Path | None = None,
) -> Crack:
    """Stress intensity factors of a straight crack from the surface over one cycle, and whether the crack stops.

    Parameters
    ----------
    results : str, Path, xarray.Dataset or RunResult
        A folder of results or its ``results.nc``, or what a run returned.
    at : float or str
        Place of the mouth along the section [m]; by default above the hot spot of `start`.
    angle : float or str
        Between the crack and the inward normal, positive towards the axis of the section [rad or text with a unit],
        within 65 degrees; by default that of the plane of `start`, else 0.
    start : Fatigue or mapping
        What `eigencontact.fatigue` returned, or its summary: gives place, angle, region and cycle.
    threshold : Threshold, mapping or callable
        ``{"long-crack-range": "5 MPa*m^0.5", "limit-range": "400 MPa", "curve": "el-haddad"}``, or a function of the
        length [m] that returns the threshold of the range [Pa sqrt(m)].
    compare : {"effective", "opening"}
        The range that is compared with the threshold: of both modes, or of mode I alone.
    lengths : sequence, optional
        Lengths of the crack [m], growing; by default 60 from two points of the region to its end.
    region : str, optional
        Name of a stored section in x and z, or y and z, with stress; by default the only one.
    cycle : {"last", "all"} or (int, int)
        The last closed cycle of the history (default), all steps, or the numbers of the first and last step.
    folder : str or Path, optional
        Where ``crack-<region>`` (``.nc``, ``.json``, ``.png``) is stored; by default nothing is stored.

    Returns
    -------
    Crack

    Raises
    ------
    SceneError, ResultsError
        What is refused names the argument, the rule and the nearest valid choice.

    Notes
    -----
    The range of mode I counts while the crack is open (negative K_I as 0), that of mode II as if faces had no friction;
    the effective range is the root of the sum of their squares (the rate of energy release). The crack lies in plane
    strain in a homogeneous half-plane and does not change the pressure of the contact. Stress is interpolated linearly
    between the points of the region.

    Examples
    --------
    >>> import eigencontact as ec
    >>> scene = ec.load_scene("hertz", ["grid.cells-per-contact-radius=8", "stress.0.depth-cells=10"])
    >>> crack = ec.crack(ec.run(scene), at="5 um", angle="20 deg", region="section", cycle="all")
    >>> sorted(crack.dataset)[:3], crack.summary["fate"]
    (['effective_range', 'load_ratio', 'mode_1'], 'unknown')
    """
    given = _from_start(start)
    region, cycle = region or given.get("region"), cycle or given.get("cycle") or "last"
    rule = _threshold(threshold)
    if compare not in _COMPARED:
        raise SceneError(f"compare must be {' or '.join(map(repr, _COMPARED))} (got {shown(compare)})")
    with opened(results) as dataset:
        found = cycle_of_region(dataset, region, cycle, strain=False, source=None)
        path = CrackPath.in_section(found)
        mouth = path.mouth(_quantity(at, "m", "at") if at is not None else given.get("place"))
        tilt = _quantity(angle, "rad", "angle") if angle is not None else path.angle_of(given.get("normal"))
        model = EdgeCrack(tilt)
        sizes = _lengths(lengths, path, mouth, model)
        normal, shear = stress_on_path(path, model, mouth, sizes)
        factors = model.intensity(normal, shear, sizes)
        answer = _dataset(dataset, found.steps, sizes, factors, rule)
        summary = _summary(answer, path, mouth, tilt, compare)
        summary["warnings"] = [caution.to_dict() for caution in _cautions(dataset, path, sizes, len(found.steps))]
        if folder is None:
            return Crack(answer, summary)
        return Crack(answer, summary, _store(Path(folder), answer, summary))


def _from_start(start: Any) -> dict[str, Any]:
    if start is None:
        return {}
    summary = start.summary if isinstance(start, Fatigue) else start
    keys = ("place", "normal", "region", "steps")
    if not isinstance(summary, Mapping) or any(key not in summary for key in keys):
        raise SceneError(
            f"start must be what fatigue returned, or its summary, with {', '.join(keys)} (got {shown(start)})"
        )
    return {key: summary[key] for key in keys} | {"cycle": tuple(summary["steps"])}


def _quantity(value: Any, unit: str, name: str) -> float:
    words = {"m": "a length", "rad": "an angle"}[unit]
    try:
        number = float(parse_quantity(value, unit, words))
    except (TypeError, ValueError) as problem:
        raise SceneError(f"{name} must be {problem} (got {shown(value)})") from None
    if not np.isfinite(number):
        raise SceneError(f"{name} must be finite [{unit}] (got {shown(value)})")
    return number


def _threshold(threshold: Any) -> Callable[[FloatArray], FloatArray] | None:
    if threshold is None or callable(threshold):
        rule: Callable[[FloatArray], FloatArray] | None = threshold
        return rule
    if not isinstance(threshold, Mapping):
        raise SceneError(f"threshold must be a table, a Threshold or a function of the length (got {shown(threshold)})")
    return Threshold.from_table(threshold)


def _lengths(lengths: Any, path: CrackPath, mouth: float, model: EdgeCrack) -> FloatArray:
    longest, shortest = path.reach(mouth, model), _SHORTEST * path.spacing
    if lengths is None:
        if longest <= shortest:
            raise SceneError(
                f"region {path.region!r} must hold a crack longer than {readable(shortest, 'm')} from the place (got "
                f"{readable(longest, 'm')}); enlarge the region or choose another place"
            )
        return np.geomspace(shortest, longest, _LENGTHS)
    sizes = np.array([_quantity(length, "m", "lengths") for length in lengths], dtype=float)
    if sizes.size == 0 or sizes[0] <= 0 or np.any(np.diff(sizes) <= 0):
        raise SceneError(f"lengths must be positive and growing [m] (got {shown(lengths)})")
    if sizes[-1] > longest * (1 + 1e-12):
        raise SceneError(
            f"lengths must end within the region, at {readable(longest, 'm')} along this crack (got "
            f"{readable(float(sizes[-1]), 'm')}); enlarge the region"
        )
    return sizes


def _dataset(
    dataset: Results, steps: Sequence[int], sizes: FloatArray, factors: FloatArray,
    rule: Callable[[FloatArray], FloatArray] | None,
) -> xarray.Dataset:  # fmt: skip
    import xarray

    from eigencontact import __version__

    opened_part = np.maximum(factors[0], 0.0)
    low, high = factors[0].min(axis=0), factors[0].max(axis=0)
    ranges = np.array([np.ptp(opened_part, axis=0), np.ptp(factors[1], axis=0)])
    unit = "Pa m^0.5"

    def over_length(values: FloatArray, words: str, units: str = unit) -> tuple[Any, ...]:
        return ("length",), values, {"units": units, "long_name": words}

    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.where(high > 0, low / high, np.nan)
    fields = {
        "mode_1": (("step", "length"), factors[0], {"units": unit, "long_name": "K_I (negative: closed)"}),
        "mode_2": (("step", "length"), factors[1], {"units": unit, "long_name": "K_II"}),
        "mode_1_range": over_length(ranges[0], "range of K_I while open"),
        "mode_2_range": over_length(ranges[1], "range of K_II"),
        "effective_range": over_length(np.hypot(*ranges), "effective range of K"),
        "load_ratio": over_length(ratio, "smallest K_I over largest", "1"),
    }
    if rule is not None:
        limit = np.asarray(rule(sizes), dtype=float)
        if limit.shape != sizes.shape or not np.all(np.isfinite(limit) & (limit >= 0)):
            raise SceneError(
                f"threshold must return a finite value >= 0 for each length [Pa m^0.5] (got {shown(limit)})"
            )
        fields["threshold"] = over_length(limit, "threshold of the range")
    coordinates = {"length": ("length", sizes, {"units": "m"}), "step": ("step", list(steps))}
    described = {"source": f"eigencontact {__version__}", "scene_hash": str(dataset.attrs["scene_hash"])}
    return xarray.Dataset(fields, coordinates, described)


def _summary(answer: xarray.Dataset, path: CrackPath, mouth: float, angle: float, compare: str) -> dict[str, Any]:
    from eigencontact import __version__

    sizes, span, steps = answer["length"].values, answer[_COMPARED[compare]].values, answer["step"].values
    worst = int(span.argmax())
    fate, arrest = _fate(sizes, span, answer["threshold"].values if "threshold" in answer else None)
    return {
        "generator": f"eigencontact {__version__}", "region": path.region, "axis": path.axis, "place": float(mouth),
        "angle": float(angle), "steps": [int(steps[0]), int(steps[-1])], "compare": compare,
        "first": float(sizes[0]), "last": float(sizes[-1]),
        "largest_range": float(span[worst]), "worst_length": float(sizes[worst]), "fate": fate, "arrest_length": arrest,
    }  # fmt: skip


def _fate(sizes: FloatArray, span: FloatArray, limit: FloatArray | None) -> tuple[str, float | None]:
    """What becomes of the crack, and the length at which its range falls to the threshold."""
    if limit is None:
        return "unknown", None
    excess = span - limit
    if excess[0] <= 0:
        return "does not start", None
    below = np.flatnonzero(excess <= 0)
    if below.size == 0:
        return "grows", None
    first = int(below[0])
    return "stops", float(np.interp(0.0, -excess[first - 1 : first + 1], sizes[first - 1 : first + 1]))


def _cautions(dataset: Results, path: CrackPath, sizes: FloatArray, steps: int) -> list[Caution]:
    out = []
    if steps == 1:
        words = "the cycle has one step: K has no range; store more load steps, as of loading and unloading"
        out.append(Caution("crack-cycle", words))
    if not path.begins_at_surface:
        words = (
            f"region {path.region!r} begins at a depth of {readable(path.first_depth, 'm')}: its stress was taken to "
            "reach the surface; begin the region there"
        )
        out.append(Caution("crack-depth", words))
    others = [name for name in ("inclusions", "layers") if name in dataset.attrs]
    if others:
        words = (
            f"K is that of a homogeneous half-plane, but the body has {' and '.join(others)}: a crack near them differs"
        )
        out.append(Caution("crack-homogeneous", words))
    extent = path.contact_extent(dataset)
    if extent is not None and sizes[-1] > 0.5 * extent:
        words = (
            f"K is that of plane strain, but the contact extends {readable(extent, 'm')} across the section: a crack "
            f"of {readable(float(sizes[-1]), 'm')} sees a stress that changes along its front, which gives a smaller K"
        )
        out.append(Caution("crack-plane", words))
    if sizes[0] < 0.999 * _SHORTEST * path.spacing:
        words = (
            f"the shortest crack is shorter than {_SHORTEST:g} spacings of the points of {path.region!r} "
            f"({readable(path.spacing, 'm')}): the stress beside its mouth is not resolved"
        )
        out.append(Caution("crack-points", words))
    return out


def _store(folder: Path, answer: xarray.Dataset, summary: Mapping[str, Any]) -> dict[Path, str]:
    from eigencontact.results.atomic import replacing, writable_folder
    from eigencontact.results.ownership import refuse_foreign_file
    from eigencontact.viz.crack import draw_crack

    paths = {ending: folder / f"crack-{summary['region']}.{ending}" for ending in ("nc", "json", "png")}
    for path in paths.values():
        refuse_foreign_file(path)
    writable_folder(folder)
    data = BytesIO()
    answer.to_netcdf(data, engine="h5netcdf")
    text = json.dumps(summary, indent=2, default=str) + "\n"
    for ending, content in (("nc", data.getvalue()), ("json", text.encode())):
        with replacing(paths[ending], f"crack in region {summary['region']}") as sink:
            sink.write(content)
    return {
        paths["nc"]: "stress intensity factors, ranges and threshold over the length",
        paths["json"]: "what becomes of the crack, and warnings",
        paths["png"]: draw_crack(answer, summary, paths["png"]),
    }
