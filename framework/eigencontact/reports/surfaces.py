"""Surface fields as height maps that the page can turn: chosen steps, few enough cells, heights in 16 bits."""

from __future__ import annotations

from base64 import b64encode
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.core.grid import Box
from eigencontact.core.quantities import unit_of
from eigencontact.viz.style import scale_for

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from eigencontact.results.stored import Results

__all__ = ["surfaces"]

#: Cells along a side at most, and steps: one field takes some 20 kB a step.
CELLS, STEPS = 80, 6
_LEVELS = 65535
#: A part of a field below the tolerance of its solver: a gap of nothing may be negative.
_SLACK = 1e-6
#: Stored fields whose unit those have that are shown otherwise than they are stored.
_OF = {"shear": "shear_x", "uplift": "residual_displacement_z"}
#: Fields in words, whether they are drawn upwards (1) or into the body (-1), and whether only where they are not zero.
_FIELDS: dict[str, tuple[str, int, bool]] = {
    "pressure": ("contact pressure", 1, True),
    "shear": ("shear traction, magnitude", 1, True),
    "worn_depth": ("worn depth, drawn downwards", -1, True),
    "uplift": ("uplift of the surface by eigenstrain", 1, False),
    "gap": ("gap between the deformed surfaces", 1, False),
    "displacement_z": ("normal displacement of the surfaces, drawn into the body", -1, False),
    "dissipated_energy_density": ("work of friction by area in the solved increments", 1, True),
}


def surfaces(dataset: Results) -> list[dict[str, Any]]:
    """Fields of chosen steps for the script ``surface.js``, as plain data.

    Returns
    -------
    list of dict
        One for each field that is not zero throughout: ``name``, ``words``, ``unit``, ``factor`` from SI to it,
        ``sign``; ``low`` and ``high``, the range in SI units over its steps; ``x`` and ``y``, the first and last cell
        in the unit ``length``; ``shape`` (rows, columns); ``every``, the distance of cells that are shown; ``steps``
        with their number and ``heights``: rows of little-endian 16-bit numbers in base64, from ``low`` to ``high``.
    """
    if "x" not in dataset or "y" not in dataset:
        return []
    places = _places(dataset)
    fields = []
    for name, (words, sign, cropped) in _FIELDS.items():
        values = _values(dataset, name, places)
        if values is None or not np.any(values):
            continue
        field = _field(dataset, values, places, cropped=cropped)
        scale = scale_for(values, unit_of(_OF.get(name, name)))
        about = {"name": name, "words": words, "sign": sign, "unit": scale.unit, "factor": scale.factor}
        if min(field["shape"]) > 1:
            fields.append({**about, **field})
    return fields


def _places(dataset: Results) -> list[int]:
    """Indices of the displayed steps: evenly spaced, with the last step and the step of the largest pressure."""
    count = dataset.sizes["step"]
    if count <= STEPS:
        return list(range(count))
    largest = int(np.nanargmax(dataset["max_pressure"].values)) if "max_pressure" in dataset else 0
    spread = np.linspace(0, count - 1, STEPS - 1).round().astype(int)
    return sorted({*spread.tolist(), largest})


def _values(dataset: Results, name: str, places: list[int]) -> NDArray[Any] | None:
    """Field at these steps, (n, ny, nx), in SI units, zero where missing; None without the field."""
    if name == "shear":
        fields = [_values(dataset, f"shear_{axis}", places) for axis in "xy"]
        components = [field for field in fields if field is not None]
        return np.asarray(np.sqrt(np.sum(np.square(components), axis=0))) if components else None
    if name == "uplift":
        sunk = _values(dataset, _OF[name], places)
        return None if sunk is None else -sunk
    if name not in dataset or dataset[name].dims != ("step", "y", "x"):
        return None
    return np.asarray(np.nan_to_num([np.asarray(dataset[name][at].values, dtype=float) for at in places]))


def _field(dataset: Results, values: NDArray[Any], places: list[int], *, cropped: bool) -> dict[str, Any]:
    rows, columns = values.shape[1:]
    box = Box.around(np.any(values != 0, axis=0)) if cropped else None
    view = Box(0, rows, 0, columns)
    if box is not None:
        view = box.grown(2 + box.shape[0] // 8, 2 + box.shape[1] // 8, (rows, columns))
    shown = values[(slice(None), *view.slices)]
    stride = max(1, -(-max(view.shape) // CELLS))
    shown = shown[:, ::stride, ::stride]
    low, high = _range(values)
    x, y = (dataset[axis].values[cells][::stride] for axis, cells in zip("xy", view.slices[::-1], strict=True))
    length = scale_for([*x, *y], "m")
    levels = np.rint((np.clip(shown, low, high) - low) / (high - low) * _LEVELS).astype("<u2")
    return {
        "low": low,
        "high": high,
        "x": [float(length(x[0])), float(length(x[-1]))],
        "y": [float(length(y[0])), float(length(y[-1]))],
        "length": length.unit,
        "shape": list(shown.shape[1:]),
        "every": stride,
        "steps": [
            {"step": int(dataset["step"].values[at]), "heights": b64encode(heights.tobytes()).decode()}
            for at, heights in zip(places, levels, strict=True)
        ],
    }


def _range(values: NDArray[Any]) -> tuple[float, float]:
    """Range of the values and zero; values of the opposite sign within the tolerance do not extend it."""
    low, high = min(0.0, float(values.min())), max(0.0, float(values.max()))
    slack = _SLACK * max(-low, high)
    return (low if low < -slack else 0.0), (high if high > slack else 0.0)
