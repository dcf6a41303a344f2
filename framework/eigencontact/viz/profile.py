"""Pictures of what lies along a line below the surface, and of means over each depth of a volume."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from eigencontact.core.tensors import COMPONENTS
from eigencontact.viz.section import EQUIVALENT
from eigencontact.viz.style import COLOURS, heading, new_figure, paper_style, scale_for

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from eigencontact.results.stored import Results

__all__ = ["mean_profile", "stress_profile"]


def stress_profile(dataset: Results, region: str, step: int = -1) -> Figure:
    """Stresses of one step along a line: depth downwards, or distance along it where the depth is constant.

    Parameters
    ----------
    dataset : Results
        Results of a run.
    region : str
        A region of shape line.
    step : int
        Position along ``step``.

    Returns
    -------
    matplotlib.figure.Figure
        Equivalent stresses that were stored, and the normal and shear components that do not vanish.
    """
    points = {
        axis: np.asarray(dataset[f"{region}_{axis}"].values, dtype=float) * np.ones(dataset.sizes[f"{region}_point"])
        for axis in "xyz"
    }
    deep = bool(np.ptp(points["z"]) > 0)
    moved = np.sqrt(sum(np.diff(values) ** 2 for values in points.values()))
    at = points["z"] if deep else np.concatenate([[0.0], np.cumsum(moved)])
    curves = {
        EQUIVALENT[field]: np.asarray(dataset[f"{region}_{field}"][step].values, dtype=float)
        for field in EQUIVALENT
        if f"{region}_{field}" in dataset
    }
    if f"{region}_stress" in dataset:
        components = np.asarray(dataset[f"{region}_stress"][step].values, dtype=float)
        largest = float(np.nanmax(np.abs(components)))
        for name, values in zip(COMPONENTS, components, strict=True):
            if float(np.nanmax(np.abs(values))) > 1e-6 * largest:
                curves[rf"$\sigma_{{{name}}}$"] = values
    stress = scale_for(np.stack(list(curves.values())), "Pa")
    length = scale_for(at, "m")
    styles = ("-", "--", "-.", ":")
    with paper_style():
        figure = new_figure(4.6, 3.4) if deep else new_figure(5.2, 3.0)
        axes = figure.add_subplot()
        for n, (name, values) in enumerate(curves.items()):
            pair = (stress(values), length(at)) if deep else (length(at), stress(values))
            style = styles[(n // len(COLOURS)) % len(styles)] if name in EQUIVALENT.values() else styles[1 + n % 3]
            # On an axis of symmetry von Mises and Tresca coincide: the wider line shows beneath the narrower.
            width = 2.6 if n == 0 and len(curves) > 1 else 1.2
            axes.plot(*pair, style, color=COLOURS[n % len(COLOURS)], label=name, linewidth=width)
        (axes.axvline if deep else axes.axhline)(0, color="0.6", linewidth=0.6, zorder=0)
        if deep:
            axes.set(xlabel=f"Stress [{stress.unit}]", ylabel=f"z [{length.unit}]")
            axes.set_ylim(float(length(at.max())), float(length(at.min())))
        else:
            axes.set(xlabel=f"distance along {region} [{length.unit}]", ylabel=f"Stress [{stress.unit}]")
            axes.margins(x=0)
        unloaded = "normal_load" in dataset and float(dataset["normal_load"][step]) == 0.0
        title = heading(dataset, step, f"{'Residual stresses' if unloaded else 'Stresses'} along {region}")
        axes.set_title(title.replace(f"{region} at", f"{region}\nat"))  # the legend lies beside
        figure.legend(loc="outside right upper")
    return figure


def mean_profile(dataset: Results, region: str, step: int = -1) -> Figure:
    """Means over each depth of a volume of the stresses along the surface, with the range of nine tenths of the points.

    Parameters
    ----------
    dataset : Results
        Results of a run.
    region : str
        A region of shape volume with its stress.
    step : int
        Position along ``step``.
    """
    stress = np.asarray(dataset[f"{region}_stress"][step].values, dtype=float)
    z = np.asarray(dataset[f"{region}_z"].values, dtype=float)
    flat = {name: stress[COMPONENTS.index(name)].reshape(z.size, -1) for name in ("xx", "yy")}
    bounds = np.stack([np.quantile(values, (0.05, 0.95), axis=1) for values in flat.values()])
    scale, length = scale_for(bounds, "Pa"), scale_for(z, "m")
    with paper_style():
        figure = new_figure(4.6, 3.4)
        axes = figure.add_subplot()
        for n, (name, values) in enumerate(flat.items()):
            axes.fill_betweenx(length(z), *scale(bounds[n]), color=COLOURS[n], alpha=0.15, linewidth=0)
            label = rf"mean $\sigma_{{{name}}}$"
            axes.plot(scale(values.mean(axis=1)), length(z), ("o-", "s--")[n], color=COLOURS[n], label=label)
        axes.axvline(0, color="0.6", linewidth=0.6, zorder=0)
        axes.set(xlabel=f"Stress [{scale.unit}]", ylabel=f"z [{length.unit}]")
        axes.set_ylim(float(length(z.max())), 0.0)
        unloaded = "normal_load" in dataset and float(dataset["normal_load"][step]) == 0.0
        what = f"{'Residual stress' if unloaded else 'Stress'} over depth, {region}"
        axes.set_title(heading(dataset, step, what) + "\nbands hold nine tenths of the points")
        axes.legend(loc="best")
    return figure
