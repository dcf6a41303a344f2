"""Whether a crack that starts at the surface grows or stops: stored stress of a cycle against a threshold."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.cautions import Caution
from eigencontact.core.crack_growth import (
    FactorRanges,
    arrest_length,
    factor_ranges,
)
from eigencontact.core.units import readable
from eigencontact.errors import SceneError, shown
from eigencontact.halfspace.edge_crack import edge_crack
from eigencontact.postprocess.answer import Answer
from eigencontact.postprocess.crack_path import CrackPath, PathStress, path_stress
from eigencontact.postprocess.crack_threshold import CrackThreshold, Threshold, positive_quantity, quantity
from eigencontact.postprocess.fatigue import fatigue
from eigencontact.postprocess.plot import opened

if TYPE_CHECKING:
    import xarray

    from eigencontact.results.stored import Results

__all__ = ["Crack", "crack"]

#: Crack lengths of a table, of equal ratio.
_LENGTHS = 81
#: Shortest crack as a part of the longest; never shorter than a cell, whose stress is one value.
_SHORTEST = 0.01


@dataclass(frozen=True, eq=False, repr=False)
class Crack(Answer):
    """Ranges of the stress intensity factors of a crack over its length, with growth or arrest.

    Attributes
    ----------
    dataset : xarray.Dataset
        Over ``length`` [m]: ``mode_1_range``, ``mode_2_range``, ``effective_range``, ``threshold`` [Pa sqrt(m)] and
        ``ratio`` [-]; by step ``mode_1`` and ``mode_2``, of faces that do not touch.
    summary : dict
        ``outcome`` (``"does not grow"``, ``"stops"`` or ``"grows"``), ``arrest_length`` [m] (None if none stops it),
        ``place`` [m], ``angle`` [rad], ``warnings``.
    files : dict
        Files that were stored, and what they show.
    """

    def lines(self) -> list[str]:
        """Words for the terminal."""
        content = self.summary
        place = ", ".join(readable(at, "m") for at in content["place"])
        lengths = self.dataset["length"].values
        ends = {
            "does not grow": f"does not grow: its range is below the threshold from {readable(lengths[0], 'm')} on",
            "stops": f"stops at a length of {readable(content['arrest_length'] or 0.0, 'm')}",
            "grows": f"grows beyond {readable(lengths[-1], 'm')}: its range exceeds the threshold at all lengths",
        }
        head = (
            f"a crack from ({place}) at {np.degrees(content['angle']):.3g} deg to the normal, over steps "
            f"{content['steps'][0]} to {content['steps'][-1]}, {ends[content['outcome']]}"
        )
        return [head, *(f"warning: {caution['words']}" for caution in content["warnings"])]

    def table(self) -> str:
        """Ranges at some lengths as text."""
        rows = ["     length    dK_I   dK_II  dK_eff  threshold  [MPa sqrt(m)]      R"]
        for k in np.linspace(0, self.dataset.sizes["length"] - 1, 9).astype(int):
            row = self.dataset.isel(length=int(k))
            names = ("mode_1_range", "mode_2_range", "effective_range", "threshold")
            values = [float(row[name]) / 1e6 for name in names]
            length = readable(float(row["length"]), "m")
            rows.append("{:>11}{:8.3g}{:8.3g}{:8.3g}{:11.3g}{:22.3g}".format(length, *values, float(row["ratio"])))
        return "\n".join(rows)


def crack(
    results: Any,
    *,
    length: float | str,
    threshold: float | str | Threshold,
    limit_amplitude: float | str | None = None,
    at: Sequence[float | str] | None = None,
    criterion: Any = None,
    angle: float | str | None = None,
    rule: Literal["el-haddad", "kitagawa-takahashi"] = "el-haddad",
    mode: Literal["both", "opening"] = "both",
    region: str | None = None,
    cycle: Literal["last", "all"] | tuple[int, int] = "last",
    body: Literal[1, 2] = 1,
    folder: str | Path | None = None,
) -> Crack:
    """Growth or arrest of a straight crack from the surface, over one cycle of stored stress.

    Parameters
    ----------
    results : str, Path, xarray.Dataset or RunResult
        A folder of results or its ``results.nc``, or what a run returned.
    length : float or str
        Longest crack [m].
    threshold : float, str or callable
        Range of stress intensity below which long cracks do not grow [Pa sqrt(m)], ``"5 MPa sqrt(m)"``; or a threshold
        of your own, ``f(lengths, ratios)`` in these units.
    limit_amplitude : float or str, optional
        Stress amplitude of a smooth specimen, fully reversed [Pa]: short cracks have a lower threshold. Without it the
        threshold is the same at all lengths.
    at : (x, y), optional
        Place on the surface where the crack starts [m].
    criterion : FatigueCriterion, mapping or str, optional
        Fatigue criterion in place of `at`: the crack starts at its hot spot in `region`, along its plane unless
        `angle` is given.
    angle : float or str, optional
        Between the crack and the inward normal of the surface [rad], positive towards +x, ``"20 deg"``.
    rule : {"el-haddad", "kitagawa-takahashi"}
        Threshold of short cracks.
    mode : {"both", "opening"}
        Range that is compared with the threshold: both modes together, or opening only.
    region : str, optional
        Stored plane normal to y that contains the path. By default the stress is computed at the points of the path
        if the results are stored; else it is read from the only region with stress.
    cycle : {"last", "all"} or (int, int)
        The last closed cycle of the history, all steps, or the numbers of the first and last step.
    body : {1, 2}
        Body of the crack, if there is no region.
    folder : str or Path, optional
        Folder for ``crack.nc``, ``crack.json`` and ``crack.png``; by default nothing is stored.

    Returns
    -------
    Crack
        Ranges over the length, outcome and warnings.

    Raises
    ------
    SceneError, ResultsError
        An invalid argument, with the rule and the nearest valid choice.

    Notes
    -----
    The stress intensity factors are those of an edge crack in a plane-strain half-plane of one elastic material
    (`eigencontact.halfspace.edge_crack`) under the stress of the body without the crack; the crack does not
    change the contact. See `eigencontact.core.crack_growth` for closed faces, ranges and thresholds. The model omits
    tearing (mode III).

    Examples
    --------
    >>> import eigencontact as ec
    >>> changes = ["grid.cells-per-contact-radius=8", "stress.0.depth-cells=20"]
    >>> result = ec.run(ec.load_scene("cattaneo-mindlin", changes))
    >>> answer = ec.crack(
    ...     result,
    ...     at=("-20 um", 0),
    ...     angle=0,
    ...     length="30 um",
    ...     threshold="2 MPa sqrt(m)",
    ...     limit_amplitude="400 MPa",
    ...     mode="opening",
    ...     region="section",
    ...     cycle="all",
    ... )
    >>> answer.summary["outcome"]
    'stops'
    """
    limits = CrackThreshold.of(threshold, limit_amplitude, rule)
    if mode not in ("both", "opening"):
        raise SceneError(f"mode must be 'both' or 'opening' (got {shown(mode)})")
    longest = positive_quantity(length, "m", "length", "a length")
    slope = None if angle is None else quantity(angle, "rad", "angle", "an angle")
    if (at is None) == (criterion is None):
        raise SceneError("crack must start at a place (at) or at the hot spot of a criterion, one of both")
    source = Path(results) if isinstance(results, str | Path) else None
    with opened(results) as dataset:
        if at is not None:
            x, y = _place(at)
        else:
            x, y, slope = _hot_spot(source or dataset, criterion, region, cycle, slope, _cell(dataset))
        if slope is None:
            raise SceneError("angle must be given with at: between the crack and the inward normal (got none)")
        edge_crack(slope)  # refuses thin wedges before stress is found
        path = CrackPath(x, y, slope, longest)
        afresh = source is not None and (region is None or criterion is not None)
        stress = path_stress(dataset, path, None if afresh else region, cycle, source if afresh else None, body)
        lengths = np.geomspace(min(max(_SHORTEST * longest, _cell(dataset)), 0.5 * longest), longest, _LENGTHS)
        factors = _factors(stress, slope, lengths)
        ranges = factor_ranges(factors)
        limit = limits.at(lengths, ranges.ratio)
        stop = arrest_length(lengths, ranges.effective if mode == "both" else ranges.mode_1, limit)
        summary = _summary(path, stress, limits, stop) | {"mode": mode}
        summary["warnings"] = [item.to_dict() for item in _cautions(dataset, path, stress, ranges, stop, mode)]
        answer = Crack(_dataset(dataset, stress, lengths, factors, ranges, limit), summary)
    if folder is None:
        return answer
    from eigencontact.viz.crack import draw_crack

    return answer.stored(
        folder, "crack", "the stress intensity of a crack",
        ("ranges of stress intensity and threshold over the length", "outcome, arrest length and warnings"),
        lambda path: draw_crack(answer.dataset, summary, path),
    )  # fmt: skip


def _place(at: Any) -> tuple[float, float]:
    if isinstance(at, str) or not isinstance(at, Sequence) or not 2 <= len(at) <= 3:
        raise SceneError(f"at must be a place of the surface, (x, y) [m] (got {shown(at)})")
    x, y, *depth = (quantity(value, "m", "at", "a length") for value in at)
    if any(depth):
        raise SceneError(f"at must lie on the surface, at depth 0 (got {readable(depth[0], 'm')}); give (x, y)")
    return x, y


def _hot_spot(
    results: Any, criterion: Any, region: str | None, cycle: Any, angle: float | None, cell: float
) -> tuple[float, float, float]:
    """Place on the surface and angle of the plane of a criterion."""
    answer = fatigue(results, criterion, region=region, cycle=cycle).summary
    x, y, z = answer["place"]
    if z > cell:
        raise SceneError(
            f"the hot spot of {answer['criterion']['type']!r} must lie on the surface (got a depth of "
            f"{readable(z, 'm')}); a crack from within is not modelled, give a place with at"
        )
    normal = answer["normal"]
    if angle is None and normal is None:
        raise SceneError(f"angle must be given with {answer['criterion']['type']!r}, which chooses no plane (got none)")
    return x, y, _angle_of_plane(normal) if angle is None else angle


def _angle_of_plane(normal: Sequence[float]) -> float:
    """Angle of the trace of a plane in y = const to the inward normal of the surface, in -pi/2 to pi/2 [rad]."""
    across, _, down = normal
    return float(np.arctan2(-np.sign(across) * down, abs(across)))


def _cell(dataset: Results) -> float:
    return float(np.min(np.asarray(dataset.attrs["cell_size"], dtype=float)))


def _factors(stress: PathStress, angle: float, lengths: FloatArray) -> FloatArray:
    """K_I and K_II, ``(2, steps, lengths)``."""
    weights = edge_crack(angle)
    read = [
        [np.stack([np.interp(length * weights.places, stress.distances, row) for row in rows])
         for rows in (stress.normal, stress.shear)]
        for length in lengths
    ]  # fmt: skip
    return np.stack([weights.factors(length, *rows) for length, rows in zip(lengths, read, strict=True)], axis=-1)


def _summary(path: CrackPath, stress: PathStress, limits: CrackThreshold, stop: float) -> dict[str, Any]:
    from eigencontact import __version__

    outcome = "does not grow" if stop == 0 else "stops" if np.isfinite(stop) else "grows"
    is_function = callable(limits.long_crack)
    return {
        "generator": f"eigencontact {__version__}",
        "outcome": outcome,
        "arrest_length": stop if np.isfinite(stop) else None,
        "place": [path.x, path.y],
        "angle": path.angle,
        "length": path.length,
        "region": stress.region,
        "body": stress.body,
        "steps": [stress.steps[0], stress.steps[-1]],
        "threshold": "function of the caller" if is_function else limits.long_crack,
        "limit_amplitude": limits.limit_amplitude,
        "rule": None if limits.short_length is None else limits.rule,
        "short_crack_length": limits.short_length,
    }


def _cautions(
    dataset: Results, path: CrackPath, stress: PathStress, ranges: FactorRanges, stop: float, mode: str
) -> list[Caution]:
    """Warnings about effects that the plane-strain crack in one elastic material omits."""
    out = []
    reach = stop if 0 < stop < np.inf else path.length
    if dataset.sizes.get("y", 1) > 1 and "pressure" in dataset:
        numbers = [int(number) for number in dataset["step"].values]
        rows = [numbers.index(step) for step in stress.steps]
        loaded = np.asarray(dataset["pressure"].values[rows]) > 0
        width = float(np.count_nonzero(loaded.any(axis=(0, 2)))) * float(np.diff(dataset["y"].values[:2])[0])
        words = (
            f"the contact is {readable(width, 'm')} wide along y, {width / reach:.2g} times the crack of "
            f"{readable(reach, 'm')}: the model assumes a crack of infinite length along y (plane strain), which "
            "overestimates the ranges where the stress falls along y"
        )
        out.append(Caution("crack-plane-strain", words))
    if mode == "both" and np.any(np.isnan(ranges.ratio)):
        words = (
            "the tip is closed at some lengths during the whole cycle; the model omits friction between the faces, so "
            "that the range of K_II is too large there: compare mode = 'opening'"
        )
        out.append(Caution("crack-closed", words))
    yielded = _yielded(dataset, path, stress)
    if yielded > 0:
        words = f"the path crosses cells with plastic strain up to {yielded:.2g}; the factors assume an elastic body"
        out.append(Caution("crack-yielded", words))
    materials = [item for item in json.loads(dataset.attrs.get("inclusions", "[]")) if item["body"] == stress.body]
    if "layers" in dataset.attrs or any(item["name"] != f"body {stress.body}" for item in materials):
        words = "the body has layers or inclusions; the factors assume one elastic material"
        out.append(Caution("crack-material", words))
    return out


def _yielded(dataset: Results, path: CrackPath, stress: PathStress) -> float:
    """Largest stored equivalent plastic strain in cells on the path."""
    name = f"equivalent_plastic_strain_{stress.body}"
    if name not in dataset:
        return 0.0
    values = dataset[name]
    axes = [np.asarray(dataset[str(dim)].values) for dim in values.dims[1:]]
    x, z = path.at(stress.distances)
    inside = np.ones(x.shape, dtype=bool)
    numbers = []
    for axis, places in zip(axes, (z, np.full(x.shape, path.y), x), strict=True):
        reach = 0.5 * (axis[1] - axis[0]) if axis.size > 1 else np.inf
        inside &= (places >= axis[0] - reach) & (places <= axis[-1] + reach)
        numbers.append(np.abs(axis[:, None] - places).argmin(axis=0))
    cells = np.asarray(values.values)[(slice(None), *numbers)][:, inside]
    return float(cells.max(initial=0.0))


def _dataset(
    dataset: Results,
    stress: PathStress,
    lengths: FloatArray,
    factors: FloatArray,
    ranges: FactorRanges,
    limit: FloatArray,
) -> xarray.Dataset:
    import xarray

    from eigencontact import __version__

    unit = {"units": "Pa m^0.5"}
    words = {
        "mode_1_range": (ranges.mode_1, "range of the open part of K_I"),
        "mode_2_range": (ranges.mode_2, "range of K_II"),
        "effective_range": (ranges.effective, "effective range of the stress intensity"),
        "threshold": (limit, "threshold of the effective range"),
    }
    fields: dict[str, Any] = {
        name: ("length", values, unit | {"long_name": text}) for name, (values, text) in words.items()
    }
    fields["ratio"] = ("length", ranges.ratio, {"units": "1", "long_name": "smallest over largest K_I"})
    for name, values, mode in (("mode_1", factors[0], "K_I"), ("mode_2", factors[1], "K_II")):
        fields[name] = (("step", "length"), values, unit | {"long_name": f"{mode} of faces that do not touch"})
    coordinates = {
        "length": ("length", lengths, {"units": "m", "long_name": "length of the crack"}),
        "step": ("step", list(stress.steps)),
    }
    described = {"source": f"eigencontact {__version__}", "scene_hash": str(dataset.attrs["scene_hash"])}
    return xarray.Dataset(fields, coordinates, described)
