"""Errors of one solution against the reference; all relative [-], over every load step that both have solved."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["FIELDS", "HEADLINES", "bars", "errors", "field_error"]

FloatArray = NDArray[np.float64]

#: Scalars of a step by the error they enter; a group is measured by its largest value of the reference.
_SCALARS: dict[str, tuple[str, ...]] = {
    "max pressure": ("max_pressure",),
    "contact radius": ("contact_radius",),
    "contact area": ("contact_area",),
    "approach": ("approach",),
    "loads": ("normal_load", "tangential_load_x", "tangential_load_y"),
    "motions": ("shift_x", "shift_y"),
    "max von Mises": ("max_von_mises",),
    "plastic strain": ("max_plastic_strain",),
    "worn volume": ("worn_volume",),
}
_FIELDS: dict[str, tuple[str, ...]] = {
    "pressure field": ("pressure",),
    "shear field": ("shear_x", "shear_y"),
    "traction field": ("pressure", "shear_x", "shear_y"),
    "displacement field": ("residual_displacement_x", "residual_displacement_y", "residual_displacement_z"),
    "worn depth": ("worn_depth",),
}
#: Fields of the surface that are compared.
FIELDS = tuple(dict.fromkeys(name for components in _FIELDS.values() for name in components))
#: Error bars below this part of a number are round-off, as those of prescribed loads.
_ROUND_OFF = 1e-9
#: The error that stands for all, in the table and in the picture: the first of these that a scene has.
HEADLINES = ("traction field", "pressure field", "displacement field", "max von Mises")


def errors(
    summary: Mapping[str, Any], fields: Mapping[str, FloatArray], reference: Mapping[str, Any],
    reference_fields: Mapping[str, FloatArray],
) -> dict[str, float]:  # fmt: skip
    """Errors by name.

    Parameters
    ----------
    summary, reference : mapping
        Numbers of the two solutions; ``history`` holds the scalars of each step, and its ``time``.
    fields, reference_fields : mapping
        Their fields, ``(step, y, x)``, with ``time``, ``y`` and ``x``.

    Notes
    -----
    A scalar: the largest deviation over the steps, by the largest magnitude in the reference. A field: see
    `field_error`. What the reference does not have, or has as zero throughout, has no error.
    """
    out = {}
    for name, scalars in _SCALARS.items():
        value = _scalar_error(summary["history"], reference["history"], scalars)
        if value is not None:
            out[name] = value
    for name, components in _FIELDS.items():
        value = field_error(fields, reference_fields, components)
        if value is not None:
            out[name] = value
    if "shear field" not in out:  # pressure is then all the traction there is
        out.pop("traction field", None)
    return out


def bars(summary: Mapping[str, Any], fields: Mapping[Any, Any]) -> dict[str, float]:
    """Error bars of a run by the names of `errors`, in their measure; empty without bars.

    That of a number is relative to its value at the end, that of a field the norm of its stored errors over its own.
    """
    numbers = summary.get("errors", {})
    out = {}
    for name, members in _SCALARS.items():
        pairs = [(numbers[member]["error"], abs(numbers[member]["value"])) for member in members if member in numbers]
        out[name] = tuple(max((pair[n] for pair in pairs), default=0.0) for n in (0, 1))
    for name, members in _FIELDS.items():
        members_with_error = [member for member in members if f"{member}_error" in fields]
        out[name] = tuple(
            float(
                np.sqrt(
                    sum(np.nansum(np.square(fields[f"{member}{kind}"], dtype=float)) for member in members_with_error)
                )
            )
            for kind in ("_error", "")
        )
    if not out["shear field"][1]:  # pressure is then all the traction there is
        del out["traction field"]
    return {name: error / scale for name, (error, scale) in out.items() if error > _ROUND_OFF * scale > 0.0}


def field_error(
    fields: Mapping[str, FloatArray], reference_fields: Mapping[str, FloatArray], components: Sequence[str]
) -> float | None:
    """L2 norm of the difference over that of the reference, on the cells of the reference and over all steps.

    The coarser field is interpolated linearly between the middles of its cells; cells of the reference outside its
    window do not count. None where the reference has no such field or it is zero.
    """
    from eigencontact.accuracy.carry import interpolated

    x, y = fields["x"], fields["y"]
    edge = [0.5 * (axis[1] - axis[0]) if axis.size > 1 else np.inf for axis in (y, x)]
    rows, columns = (
        (axis > have[0] - half) & (axis < have[-1] + half)
        for axis, have, half in ((reference_fields["y"], y, edge[0]), (reference_fields["x"], x, edge[1]))
    )
    places = (reference_fields["y"][rows], reference_fields["x"][columns])
    difference = size = 0.0
    steps = _common(fields["time"], reference_fields["time"])
    for name in components:
        if name not in reference_fields:
            continue
        for mine, theirs in steps:
            target = reference_fields[name][theirs][np.ix_(rows, columns)]
            # a displacement or shear that a fidelity leaves out is zero
            value: FloatArray = np.zeros_like(target)
            if name in fields:
                value = interpolated(fields[name][mine], (y, x), places, smooth=False)
            difference += float(((value - target) ** 2).sum())
            size += float((target**2).sum())
    return float(np.sqrt(difference / size)) if size > 0.0 else None


def _common(run_times: ArrayLike, reference: ArrayLike) -> list[tuple[int, int]]:
    """Steps of both at the same time: cycles that wear are not solved one by one, and not the same ones."""
    times = np.round(np.asarray(run_times, dtype=float), 9), np.round(np.asarray(reference, dtype=float), 9)
    _, mine, theirs = np.intersect1d(*times, return_indices=True)
    return list(zip(mine.tolist(), theirs.tolist(), strict=True))


def _scalar_error(
    history: Sequence[Mapping[str, Any]], reference: Sequence[Mapping[str, Any]], names: Sequence[str]
) -> float | None:
    scale = deviation = 0.0
    common = False
    for name in names:
        for k, n in _common([step["time"] for step in history], [step["time"] for step in reference]):
            mine, theirs = history[k], reference[n]
            if theirs.get(name) is None or mine.get(name) is None:
                continue
            common = True
            scale = max(scale, abs(theirs[name]))
            deviation = max(deviation, abs(mine[name] - theirs[name]))
    return deviation / scale if common and scale > 0.0 else None
