"""Figures of a sweep: a number over the varied parameters, as curves or as a map; profiles of a field."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.core.field_error import error_name
from eigencontact.viz.style import COLOURS, Scale, new_figure, paper_style, place, scale_for

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["draw_profiles", "draw_sweep"]

#: Values of each of two numbers from which on a map shows more than curves.
_MAP = 5
#: Curves that a legend can hold.
_CURVES = len(COLOURS)
#: Values spaced by ratios that are marked one by one.
_MARKED = 8
#: Least range of an axis as a part of the largest value: where values differ by less, it shows that they hardly differ.
_LEAST_RANGE = 0.01
#: Numbers whose relative error is another number, and what that is the error of.
_ERRORS = {"worn_volume": ("wear_error", "worn volume"), "max_worn_depth": ("wear_error", "worn volume")}
#: Marks that tell curves apart in print.
_MARKS = "os^Dv<"


def draw_sweep(dataset: xarray.Dataset, name: str) -> Figure:
    """Figure of one number, with error bars if they were estimated; the title of a map states the largest error.

    Parameters
    ----------
    name : str
        Variable to draw: against the one parameter, as a map over two numbers of five values and more each, else in
        curves against the first parameter.
    """
    values = dataset[name]
    dims = [str(dim) for dim in values.dims]
    errors = dataset.get(error_name(name))
    limits, remark = _limits(dataset, values)
    with paper_style():
        figure = new_figure(4.6, 3.2)
        axes = figure.add_subplot()
        numeric = [dataset[dim].dtype.kind == "f" if dim in dataset else False for dim in dims]
        if len(dims) == 2 and all(numeric) and min(values.shape) >= _MAP:
            _map(axes, values, limits)
            remark = "\n".join(filter(None, (remark, _largest_error(values, errors))))
        else:
            scale = _scale(values)
            x = _axis(axes, "x", _along(dataset, dims[0]))
            order = (*dims[1:], dims[0])
            bars = None if errors is None else errors.transpose(*order)
            _curves(axes, dataset, values.transpose(*order), x, marks=_MARKS, errors=bars)
            axes.set_ylabel(_with_unit(str(values.name), scale.unit))
            if limits is not None:
                axes.set_ylim(*scale(limits))
        axes.set_title("\n".join(filter(None, (_title(values), remark))))
    return figure


def draw_profiles(dataset: xarray.Dataset, name: str) -> Figure:
    """Figure of a surface field of all variants along x, through the middle of the window."""
    middle = int(np.argmin(np.abs(dataset["y"].values - dataset["y"].values.mean())))
    values = dataset[name].isel(y=middle)
    lengths = scale_for(dataset["x"], "m")
    with paper_style():
        figure = new_figure(4.6, 3.2)
        axes = figure.add_subplot()
        _curves(axes, dataset, values, lengths(dataset["x"]))
        axes.set_xlabel(_with_unit("x", lengths.unit))
        axes.set_ylabel(_with_unit(name, _scale(values).unit))
        axes.set_title(f"{_title(values)}, {place('y', float(dataset['y'][middle]))}")
    return figure


def _title(values: xarray.DataArray) -> str:
    """Meaning of a variable, as a title."""
    title = str(values.attrs.get("long_name", values.name)).replace("_", " ")
    return title[:1].upper() + title[1:]


def _scale(values: Any) -> Scale:
    return scale_for(values, str(values.attrs.get("units", "1")))


def _largest_error(values: xarray.DataArray, errors: xarray.DataArray | None) -> str:
    """Largest relative error of the values of a map."""
    if errors is None or not np.isfinite(errors.values).any():
        return ""
    return f"estimated errors up to ± {100 * float(np.nanmax(errors.values / np.abs(values.values))):.2g} %"


def _curves(
    axes: Axes,
    dataset: xarray.Dataset,
    values: xarray.DataArray,
    x: Any,
    marks: str = "",
    errors: xarray.DataArray | None = None,
) -> None:
    """Draw a curve over the last dimension for each variant of the others, as many as the legend permits.

    Without marks variants without values are left out.
    """
    dims, scale = [str(dim) for dim in values.dims[:-1]], _scale(values)
    places = [
        at for at in np.ndindex(*(dataset.sizes[dim] for dim in dims)) if marks or np.isfinite(values.values[at]).any()
    ]
    for k, at in enumerate(places[:_CURVES]):
        label = ", ".join(_value(dataset, dim, n) for dim, n in zip(dims, at, strict=True))
        style: dict[str, Any] = {"marker": marks[k % len(marks)]} if marks else {}
        axes.plot(x, scale(values.values[at]), color=COLOURS[k], label=label or None, **style)
        if errors is not None:
            bars: dict[str, Any] = {"yerr": scale(errors.values[at]), "ecolor": COLOURS[k]}
            axes.errorbar(x, scale(values.values[at]), fmt="none", capsize=2.5, elinewidth=1, **bars)
    if len(places) > 1 or not marks:
        more = f" (of {len(places)}, the first {_CURVES})" if len(places) > _CURVES else ""
        keys = (str(_along(dataset, dim).attrs.get("long_name", dim)) for dim in dims)
        axes.legend(title=", ".join(keys) + more, title_fontsize=8)


def _limits(dataset: xarray.Dataset, values: xarray.DataArray) -> tuple[tuple[float, float] | None, str]:
    """Limits of the axis for values that differ by less than their error or `_LEAST_RANGE`, and a note."""
    finite = values.values[np.isfinite(values.values)]
    largest = float(np.abs(finite).max()) if finite.size else 0.0
    if finite.size < 2 or not largest:
        return None, ""
    spread = float(np.ptp(finite)) / largest
    number, subject = _ERRORS.get(str(values.name), ("", ""))
    errors = dataset[number].values if number in dataset else np.zeros(1)
    if (estimated := error_name(str(values.name))) in dataset:
        errors, subject = dataset[estimated].values / largest, str(values.name).replace("_", " ")
    error = float(np.nanmax(errors, initial=0.0))
    least = max(_LEAST_RANGE, 2.0 * error)
    if spread >= least:
        return None, ""
    middle, half = 0.5 * (finite.max() + finite.min()), 0.5 * least * largest
    half += spread * largest if estimated in dataset else 0.0  # the bars of all values
    remark = f"all values within {100 * spread:.2g} %; "
    remark += f"error of the {subject} {100 * error:.2g} %" if error else f"the scale spans {100 * least:.2g} %"
    return (middle - half, middle + half), remark


def _map(axes: Axes, values: xarray.DataArray, limits: tuple[float, float] | None) -> None:
    across, up = (str(dim) for dim in values.dims)
    scale = _scale(values)
    x, y = _edges(_axis(axes, "x", values[across])), _edges(_axis(axes, "y", values[up]))
    low, high = (None, None) if limits is None else scale(limits)
    mesh = axes.pcolormesh(x, y, scale(values).T, cmap="viridis", rasterized=True, vmin=low, vmax=high)
    axes.figure.colorbar(mesh, ax=axes, label=_with_unit(str(values.name), scale.unit))


def _along(dataset: xarray.Dataset, dim: str) -> Any:
    """Parameter along the axis: that of its dimension, or the first number among paired parameters."""
    if dim in dataset.coords:
        return dataset[dim]
    paired = [field for field in dataset.coords.values() if field.dims == (dim,)]
    return next((field for field in paired if field.dtype.kind == "f"), paired[0])


def _axis(axes: Axes, letter: str, along: Any) -> Any:
    """Label and scale of an axis; returns its positions. Texts have equal spacing."""
    label = str(along.attrs.get("long_name", along.name))
    if along.dtype.kind != "f":
        getattr(axes, f"set_{letter}label")(label)
        getattr(axes, f"set_{letter}ticks")(range(along.size), [str(value) for value in along.values])
        return np.arange(along.size)
    scale = _scale(along)
    getattr(axes, f"set_{letter}label")(_with_unit(label, scale.unit))
    if _by_ratio(along.values):
        getattr(axes, f"set_{letter}scale")("log")
        if along.size <= _MARKED:  # less than a decade leaves powers of ten no room
            getattr(axes, f"set_{letter}ticks")(scale(along.values), [f"{value:.3g}" for value in scale(along.values)])
            getattr(axes, f"set_{letter}ticks")([], minor=True)
    return scale(along.values)


def _by_ratio(values: Any) -> bool:
    """Whether values are spaced by ratios rather than by differences."""
    if values.size < 3 or values.min() <= 0 or values.max() < 8 * values.min():
        return False
    ratios, steps = np.diff(np.log(np.sort(values))), np.diff(np.sort(values))
    return bool(np.ptp(ratios) / ratios.mean() < np.ptp(steps) / steps.mean())


def _edges(order: Any) -> Any:
    """Borders of the cells of a map, at the arithmetic or (logarithmic axis) geometric mean of the values."""
    ratio = _by_ratio(order)
    at = np.log(order) if ratio else order
    middle = 0.5 * (at[1:] + at[:-1])
    edges = np.concatenate(([at[0] - (middle[0] - at[0])], middle, [at[-1] + (at[-1] - middle[-1])]))
    return np.exp(edges) if ratio else edges


def _value(dataset: xarray.Dataset, dim: str, at: int) -> str:
    along = _along(dataset, dim)
    if along.dtype.kind != "f":
        return str(along.values[at])
    return scale_for(along.values[at], str(along.attrs.get("units", "1"))).text(along.values[at])


def _with_unit(name: str, unit: str) -> str:
    label = name.replace("_", " ")
    return f"{label} [{unit}]" if unit else label
