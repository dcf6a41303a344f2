"""Picture of a fretting map: regimes over amplitude and load, lines of equal energy, fatigue limit, growing cracks."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from eigencontact.viz.style import new_figure, paper_style, save, scale_for

if TYPE_CHECKING:
    from pathlib import Path

    import xarray
    from matplotlib.axes import Axes

    from eigencontact.core.array_types import FloatArray

__all__ = ["draw_fretting_map"]

_COLOURS = ("#d9e8f2", "#fbe7c8", "#f3cfc1")
_WORN = "max_worn_depth"
_NAMES = ("stick", "partial slip", "gross slip")


def draw_fretting_map(dataset: xarray.Dataset, path: Path) -> str:
    """Store the picture of `eigencontact.fretting_map`; returns its description."""
    from matplotlib.colors import ListedColormap

    table = dataset.transpose("load", "amplitude", ...)
    scales = {name: scale_for(table[name].values, str(table[name].attrs["units"])) for name in ("load", "amplitude")}
    x, y = (scales[name](table[name].values) for name in ("amplitude", "load"))
    regime, energy = table["regime"].values, table["cycle_energy"].values
    with paper_style():
        figure = new_figure(4.8, 3.8)
        axes = figure.add_subplot()
        shade = np.ma.masked_invalid(regime)
        axes.pcolormesh(x, y, shade, cmap=ListedColormap(_COLOURS), vmin=-0.5, vmax=2.5, shading="nearest")
        for number, name in enumerate(_NAMES):
            rows, columns = np.nonzero(regime == number)
            if rows.size:
                middle = np.argmin(np.hypot(rows - rows.mean(), columns - columns.mean()))
                place = x[columns[middle]], y[rows[middle]]
                axes.annotate(name, place, ha="center", va="center", weight="bold", zorder=6)
        sentence = "running regimes over amplitude and normal load"
        if min(energy.shape) > 1 and np.isfinite(energy).all() and np.ptp(energy) > 0:
            unit = scale_for(energy, str(table["cycle_energy"].attrs["units"]))
            lines = axes.contour(x, y, unit(energy), colors="grey", linewidths=0.8)
            axes.clabel(lines, fontsize="x-small", fmt="%g")
            axes.plot([], [], color="grey", linewidth=0.8, label=f"energy per cycle [{unit.unit}]")
            sentence += ", lines of equal work of friction per cycle"
            sentence += _worn(axes, table, x, y) + _limits(axes, table, x, y)
            axes.legend(loc="upper left", bbox_to_anchor=(0, -0.2), ncols=2, frameon=False)
        axes.set_xlabel(f"{table['amplitude'].attrs['long_name']} [{scales['amplitude'].unit}]")
        axes.set_ylabel(f"normal load [{scales['load'].unit}]")
        axes.set_title("Fretting map")
        save(figure, path, caption=sentence)
    return sentence


def _worn(axes: Axes, table: xarray.Dataset, x: FloatArray, y: FloatArray) -> str:
    """Lines of equal worn depth after the history, for a scene with wear; returns their description."""
    if _WORN not in table or not np.isfinite(depth := table[_WORN].values).all() or np.ptp(depth) == 0:
        return ""
    unit = scale_for(depth, "m")
    lines = axes.contour(x, y, unit(depth), colors="tab:brown", linewidths=0.9, linestyles=":")
    axes.clabel(lines, fontsize="x-small", fmt="%g")
    axes.plot([], [], color="tab:brown", linestyle=":", linewidth=0.9, label=f"largest worn depth [{unit.unit}]")
    return ", dotted lines of equal worn depth"


def _limits(axes: Axes, table: xarray.Dataset, x: FloatArray, y: FloatArray) -> str:
    """Line of the fatigue limit, and hatching where a crack does not stop; returns their description."""
    words = ""
    if "utilisation" in table:
        use = table["utilisation"].values
        if np.nanmin(use) < 1 < np.nanmax(use):
            axes.contour(x, y, use, levels=[1.0], colors="black", linewidths=1.6, linestyles="--")
        axes.plot([], [], "k--", linewidth=1.6, label="fatigue limit")
        words += ", line of the fatigue limit"
    if "arrest_length" in table:
        grows = np.isinf(table["arrest_length"].values).astype(float)
        if grows.any():
            axes.contourf(x, y, grows, levels=[0.5, 1.5], colors="none", hatches=["///"])
            axes.fill_between([], [], [], facecolor="none", edgecolor="black", hatch="///", label="crack grows")
            words += ", hatching where a crack grows"
    return words
