"""Studies of a rigid sphere on a coated body without friction: pressure, indentation, stress."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.viz.style import new_figure
from eigencontact_verification.studies.common import (
    COATED,
    STEEL,
    colour,
    coloured,
    cut_depths,
    legend_beside,
    pressure_profile,
    stiff,
    von_mises,
)
from eigencontact_verification.studies.study import Finished, Row, Study, Variant, every, levels

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.collections import QuadMesh
    from matplotlib.figure import Figure

    from eigencontact.scene.schema import Scene
    from eigencontact_verification.oracles.coated_contact import CoatedContact

__all__ = [
    "COMPARED",
    "STUDIES",
    "below_the_middle",
    "coated_body",
    "coated_scene",
    "draw_section",
    "oracle",
    "read_contact",
    "split",
]

FloatArray = NDArray[np.float64]

_A = COATED.radius
_SECTION = {"name": "section", "shape": "plane", "normal": "y", "depths": cut_depths(_A / 16, 2.5 * _A)}
#: Thousandth of the thickness: as close to the interface as points on its two sides lie.
_CLOSE = 1e-3
#: Depths over the thickness at which numbers are compared with the independent solution.
COMPARED = (0.4, 1.4)


def below_the_middle(*, coarse: bool) -> dict[str, Any]:
    """Region of points on the axis, also on both sides of the interface and where the oracle is asked."""
    even = np.linspace(0.01, 2.5, 12 if coarse else 60)
    depths = _A * np.sort([*even, *COMPARED, 1.0 - _CLOSE, 1.0 + _CLOSE])
    return {"name": "axis", "shape": "points", "points": [[0.0, 0.0, float(depth)] for depth in depths]}


def coated_body(ratio: float, thickness: float = _A) -> dict[str, Any]:
    """Steel under a coating whose Young's modulus is `ratio` times its own; exact layers."""
    layer = {**stiff(ratio), "thickness": thickness}
    return {"medium": {"type": "bonded-layers", "layers": [layer], "substrate": STEEL}}


def coated_scene(body: dict[str, Any], *, cells: int, width: float, **others: Any) -> Scene:
    """Scene of the sphere under the load that gives bare steel the contact radius a, or with other steps.

    Parameters
    ----------
    body : table
        Of the coated body.
    cells : int
        Each way.
    width : float
        Of the window [a].
    others
        Further tables of the scene.
    """
    from eigencontact.scene.schema import Scene

    tables: dict[str, Any] = {
        "title": "Sphere on a coating",
        "body1": body,
        "geometry": {"type": "sphere", "radius": COATED.sphere_radius},
        "grid": {"cells": cells, "size": [width * _A, width * _A]},
        "steps": [{"normal_load": COATED.load}],
        "output": {"pictures": False},
    }
    return Scene(**{**tables, **others})


@cache
def oracle(ratio: float, thickness: float = _A, load: float = COATED.load) -> CoatedContact:
    """Independent solution of the frictionless contact."""
    from eigencontact_verification.oracles.coated_contact import coated_contact

    young, nu = STEEL["young_modulus"], STEEL["poisson_ratio"]
    return coated_contact(load, COATED.sphere_radius, [(thickness, ratio * young, nu)], (young, nu))


def draw_section(axes: Axes, dataset: xr.Dataset, highest: float, title: str) -> QuadMesh:
    """Map of the von Mises stress over p0 in the plane y = 0, colours from 0 to `highest`; a line at the interface.

    The uppermost row of points is drawn up to the surface.
    """
    x, z = (dataset[f"section_{axis}"].values / _A for axis in ("x", "z"))
    values = von_mises(dataset, COATED)
    values, z = np.concatenate([values[:1], values]), np.concatenate([[0.0], z])
    image = axes.pcolormesh(x, z, values, vmin=0.0, vmax=highest, cmap="viridis", shading="gouraud")
    axes.axhline(1.0, color="white", linewidth=0.8)
    axes.set(xlim=(max(-1.7, x[0]), min(1.7, x[-1])), ylim=(float(z[-1]), 0.0), aspect="equal", title=title)
    axes.set(xlabel="$x/a_0$", ylabel="$z/h$")
    return image


def split(depth: FloatArray, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Values and depths over the thickness, parted by a gap at the interface, where a stress may jump."""
    place = int(np.searchsorted(depth, 1.0))
    return np.insert(values, place, np.nan), np.insert(depth, place, 1.0)


def read_contact(dataset: xr.Dataset) -> Row:
    """Largest pressure and contact radius over those of bare steel."""
    last = dataset.isel(step=-1)
    return {
        "largest pressure / p0": float(last["max_pressure"]) / COATED.peak,
        "contact radius / a": float(np.sqrt(last["contact_area"] / np.pi)) / _A,
    }


_LABEL = "E₁/E₂ = {E₁/E₂:g}".format_map
_TWO = every({"E₁/E₂": (0.5, 2.0)})
_FIVE = every({"E₁/E₂": (0.25, 0.5, 1.0, 2.0, 4.0)})


def _pressed(values: Mapping[str, float], *, coarse: bool) -> Scene:
    """Exact layers, or the coating as an inhomogeneity of a window so wide that its end does not matter."""
    if "cells" not in values:
        return coated_scene(coated_body(values["E₁/E₂"]), cells=48 if coarse else 128, width=6.0)
    coating = {"name": "coating", "type": "layer", "size": [8.0 * _A, 8.0 * _A], "thickness": _A}
    return coated_scene(
        dict(STEEL),
        cells=40 if coarse else 96,
        width=8.0,
        inclusions={**coating, "material": stiff(values["E₁/E₂"])},
        numerics={"tolerance": 1e-4, "inclusion_pitch": _A / 8},
    )


def _read_pressure(variant: Variant, dataset: xr.Dataset) -> Row:
    known = oracle(variant.values["E₁/E₂"])
    return {
        **read_contact(dataset),
        "integral equation: pressure / p0": known.max_pressure / COATED.peak,
        "integral equation: radius / a": known.radius / _A,
    }


def _draw_pressure(found: Sequence[Finished]) -> Figure:
    ratios = levels(found, "E₁/E₂")
    figure = new_figure(6.0, 3.4)
    axes = figure.add_subplot()
    for item in found:
        tint = colour(ratios.index(item["E₁/E₂"]))
        x, pressure = pressure_profile(item.dataset, COATED)
        if "cells" in item.variant.values:
            inside = pressure > 0.0
            axes.plot(x[inside], pressure[inside], "o", color=tint, fillstyle="none", markersize=3.4)
        else:
            axes.plot(x, pressure, "-", color=tint, label=item.variant.label)
    for ratio in ratios:
        known = oracle(ratio)
        r = np.linspace(0.0, known.radius, 8)
        axes.plot(r / _A, known.pressure(r) / COATED.peak, "x", color="black", markersize=4, zorder=3)
    axes.plot([], [], "o", color="grey", fillstyle="none", label="coating cut into cells")
    axes.plot([], [], "x", color="black", markersize=4, label="integral equation")
    axes.set(xlabel="$x/a_0$", ylabel="pressure $p/p_0$", title="Sphere on a coating of thickness $a_0$")
    axes.set(xlim=(-1.8, 1.8), ylim=(0, None))
    legend_beside(figure, axes)
    return figure


def _indented(values: Mapping[str, float], *, coarse: bool) -> Scene:
    loads = np.geomspace(0.02, 20.0, 4 if coarse else 13) * COATED.load
    steps = [{"normal_load": float(load)} for load in loads]
    return coated_scene(coated_body(values["E₁/E₂"]), cells=72 if coarse else 160, width=9.0, steps=steps)


def _read_indentation(variant: Variant, dataset: xr.Dataset) -> Row:
    depth = dataset["approach"].values / COATED.approach
    load = dataset["normal_load"].values / COATED.load
    bare, coat = depth / load ** (2 / 3), depth * (variant.values["E₁/E₂"] / load) ** (2 / 3)
    return {"least load: indentation over the coating's": float(coat[0]), "largest load: over steel's": float(bare[-1])}


def _draw_indentation(found: Sequence[Finished]) -> Figure:
    figure = new_figure(8.4, 3.1)
    left, right = figure.subplots(1, 2)
    for item, tint in coloured(found):
        ratio = item["E₁/E₂"]
        load = item.dataset["normal_load"].values / COATED.load
        depth = item.dataset["approach"].values / COATED.approach
        left.plot(depth, load, "-o", color=tint)
        right.semilogx(load, depth / load ** (2 / 3), "-", color=tint, label=item.variant.label)
        right.plot([load[0], 6 * load[0]], [ratio ** (-2 / 3)] * 2, ":", color=tint, linewidth=1.6)
        some = load[:: max(1, load.size // 6)]
        known = np.array([oracle(ratio, load=float(f) * COATED.load).approach for f in some]) / COATED.approach
        right.plot(some, known / some ** (2 / 3), "x", color="black", markersize=4, zorder=3)
    right.plot([], [], ":", color="grey", linewidth=1.6, label="Hertz on the coating alone")
    right.axhline(1.0, color="black", linewidth=0.7, linestyle="--", label="Hertz on bare steel")
    right.plot([], [], "x", color="black", markersize=4, label="integral equation")
    left.set(xlabel="indentation $D/D_0$", ylabel="load $L/L_0$", title="Indentation", xlim=(0, 4), ylim=(0, 6))
    right.set(xlabel="load $L/L_0$", ylabel="indentation over that of bare steel", title="From coating to substrate")
    legend_beside(figure, right)
    return figure


def _cut(values: Mapping[str, float], *, coarse: bool) -> Scene:
    regions = [_SECTION, below_the_middle(coarse=coarse)]
    return coated_scene(coated_body(values["E₁/E₂"]), cells=32 if coarse else 96, width=4.0, stress=regions)


def _read_stress(_variant: Variant, dataset: xr.Dataset) -> Row:
    section, depth = von_mises(dataset, COATED), dataset["section_z"].values / _A
    return {
        "largest von Mises / p0": float(section.max()),
        "at z / h": float(depth[section.max(axis=1).argmax()]),
        "in the substrate": float(section[depth > 1.0].max()),
    }


def _axis_of_oracle(ratio: float, depths: Sequence[float]) -> list[float]:
    """Von Mises stress over p0 on the axis: there it is the difference of two principal stresses."""
    from eigencontact_verification.oracles.coated_stress import sliding_stress

    found = []
    for depth in depths:
        stress = sliding_stress(oracle(ratio), 0.0, 0.0, depth * _A)
        found.append(float(abs(stress[0] - stress[2])) / COATED.peak)
    return found


def _draw_stress(found: Sequence[Finished]) -> Figure:
    highest = max(float(von_mises(item.dataset, COATED).max()) for item in found)
    figure = new_figure(3.0 * len(found) + 3.4, 3.2)
    grid = figure.add_gridspec(1, len(found) + 1, width_ratios=[1.0] * len(found) + [0.9])
    panels = [figure.add_subplot(grid[n]) for n in range(len(found))]
    for panel, item in zip(panels, found, strict=True):
        image = draw_section(panel, item.dataset, highest, item.variant.label)
    figure.colorbar(image, ax=panels, shrink=0.85, label="von Mises stress $/p_0$")
    axes = figure.add_subplot(grid[-1])
    for item, tint in coloured(found):
        depth = item.dataset["axis_z"].values / _A
        axes.plot(*split(depth, von_mises(item.dataset, COATED, "axis")), "-", color=tint, label=item.variant.label)
        some = (0.1, 0.3, 0.5, 0.75, 0.95, 1.05, 1.5, 2.0)
        axes.plot(_axis_of_oracle(item["E₁/E₂"], some), some, "x", color="black", markersize=4)
    axes.plot([], [], "x", color="black", markersize=4, label="Hankel integrals")
    axes.axhline(1.0, color="grey", linewidth=0.6)
    axes.set(xlabel="von Mises stress $/p_0$", ylabel="$z/h$", title="On the axis", ylim=(2.5, 0), xlim=(0, None))
    axes.legend(loc="lower right")
    return figure


STUDIES = (
    Study(
        name="coating-pressure",
        title="Sphere on soft and hard coatings: pressure, by exact layers and by cells",
        repeats="thesis figure 4.6 (case CO-1)",
        scene=_pressed,
        label=lambda values: _LABEL(values) + ", by cells" * ("cells" in values),
        rows=[*_FIVE, *every({"E₁/E₂": (0.25, 0.5, 2.0, 4.0), "cells": (1.0,)})],
        coarse=[*_TWO, *every({"E₁/E₂": (2.0,), "cells": (1.0,)})],
        read=_read_pressure,
        draw=_draw_pressure,
        remark="Published as 0.56 p0 for a coating a quarter as stiff, from a window too small; the value is near 0.5.",
    ),
    Study(
        name="coating-indentation",
        title="Sphere on soft and hard coatings: indentation against load, from the coating's law to the substrate's",
        repeats="thesis figure 4.7",
        scene=_indented,
        label=_LABEL,
        rows=_FIVE,
        coarse=_TWO,
        read=_read_indentation,
        draw=_draw_indentation,
    ),
    Study(
        name="coating-stress",
        title="Sphere on soft and hard coatings: von Mises stress in section and on the axis",
        repeats="thesis figure 4.8 (case CO)",
        scene=_cut,
        label=_LABEL,
        rows=every({"E₁/E₂": (0.5, 1.0, 2.0)}),
        coarse=_TWO,
        read=_read_stress,
        draw=_draw_stress,
    ),
)
