"""Studies of many spheres under a ball: stiffness, Poisson's ratio, depth of a layer of them, tangent ones."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact_verification.studies.common import (
    UNDER_BALL,
    coloured,
    draw_hertz,
    legend_beside,
    pressure_profile,
    read_largest,
    sphere_scene,
    stiff,
)
from eigencontact_verification.studies.study import Finished, Row, Study, Variant

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

__all__ = ["STUDIES"]

_A = UNDER_BALL.radius
#: Edge of the cells [m], of a coarse study too, where a cluster has spheres of three cells across.
_CELL, _COARSE = 0.2e-6, 0.4e-6


def _cluster(columns: int, spacing: float, depths: Sequence[float], radius: float, material: Any) -> dict[str, Any]:
    """`columns` x `columns` spheres in each of some depths."""
    places = (np.arange(columns) - 0.5 * (columns - 1)) * spacing
    centers = [[float(x), float(y), float(z)] for z in depths for y in places for x in places]
    return {"name": "cluster", "type": "sphere", "radius": radius, "centers": centers, "material": material}


def _case_1(title: str, material: Any, *, coarse: bool) -> Any:
    """Scene of 11 x 11 x 4 spheres of 0.1 a, 1.6 um apart.

    With one layer of cells above the upper spheres they fill the published 31 layers of 0.2 um.
    """
    cell = _COARSE if coarse else _CELL
    depths = [0.8e-6 + 1.6e-6 * k for k in range(2 if coarse else 4)]
    cluster = _cluster(11, 1.6e-6, depths, 0.6e-6, material)
    return sphere_scene(title, [cluster], cell=cell, cells=48 if coarse else 90)


def _stiffness_variants(*, coarse: bool) -> Sequence[Variant]:
    ratios = (0.5, 2.0) if coarse else (0.0, 0.25, 0.5, 1.0, 1.5, 2.0)
    return [
        Variant(f"γ = {ratio:g}", _case_1("Cluster of spheres", stiff(ratio), coarse=coarse), {"γ": ratio})
        for ratio in ratios
    ]


def _poisson_variants(*, coarse: bool) -> Sequence[Variant]:
    return [
        Variant(
            f"γ = {ratio:g}, ν = {nu:g}",
            _case_1("Cluster of spheres", stiff(ratio, nu), coarse=coarse),
            {"γ": ratio, "ν": nu},
        )
        for ratio in ((2.0,) if coarse else (0.5, 2.0))
        for nu in ((0.15, 0.45) if coarse else (0.0, 0.15, 0.3, 0.4, 0.45))
    ]


def _depth_variants(*, coarse: bool) -> Sequence[Variant]:
    """7 x 7 spheres of four cells in radius, eleven cells apart; depths are whole cells."""
    found = []
    for layer in (4, 8) if coarse else (4, 5, 6, 7, 9, 12, 15, 20):
        depth = layer * _CELL
        # spheres of as many cells across, but fewer and further apart: a first look
        columns, spacing = (3, 22 * _CELL) if coarse else (7, 11 * _CELL)
        cluster = _cluster(columns, spacing, [depth], 0.8e-6, stiff(2.0))
        scene = sphere_scene("Layer of spheres", [cluster], cell=_CELL, cells=72 if coarse else 84)
        found.append(Variant(f"h = {depth / _A:.2f} a", scene, {"h / a": depth / _A}))
    return found


def _tangent_variants(*, coarse: bool) -> Sequence[Variant]:
    found = []
    for columns in (1, 3) if coarse else (1, 3, 5, 7):
        cluster = _cluster(columns, 12 * _CELL, [1.0e-6], 1.0e-6, stiff(2.0))
        scene = sphere_scene("Tangent spheres", [cluster], cell=_CELL, cells=72 if coarse else 84)
        label = "one sphere" if columns == 1 else f"{columns} x {columns} spheres"
        found.append(Variant(label, scene, {"spheres": float(columns**2)}))
    return found


def _read(_variant: Variant, dataset: xr.Dataset) -> Row:
    return read_largest(dataset, UNDER_BALL)


def _draw_profiles(found: Sequence[Finished], abscissa: str, xlabel: str) -> Figure:
    """Pressure along y = 0 on the right, largest pressure and stress against what is varied on the left."""
    from eigencontact.viz.style import new_figure, paper_style

    with paper_style():
        figure = new_figure(8.4, 3.1)
        trends, profiles = figure.subplots(1, 2, gridspec_kw={"width_ratios": (1.0, 1.3)})
        draw_hertz(profiles)
        for n, (item, colour) in enumerate(coloured(found)):
            dash = "-" if n < 6 else ":"
            profiles.plot(*pressure_profile(item.dataset, UNDER_BALL), dash, color=colour, label=item.variant.label)
        profiles.set(xlabel="$x/a$", ylabel="pressure $p/p_0$", title="Pressure along $y = 0$")
        profiles.set_ylim(bottom=0)
        profiles.margins(x=0)
        x = [item.variant.values[abscissa] for item in found]
        for name, mark, tint in (
            ("largest pressure / p0", "o-", "#0072B2"),
            ("largest von Mises / p0", "s--", "#D55E00"),
        ):
            trends.plot(x, [item.row[name] for item in found], mark, color=tint, label=name.split(" /")[0])
        trends.set(xlabel=xlabel, ylabel="stress $/p_0$", title="Largest values")
        trends.set_ylim(bottom=0)
        trends.legend(loc="lower right")
        legend_beside(figure, profiles)
    return figure


def _draw_poisson(found: Sequence[Finished]) -> Figure:
    from eigencontact.viz.style import new_figure, paper_style

    with paper_style():
        figure = new_figure(8.4, 3.1)
        trends, profiles = figure.subplots(1, 2, gridspec_kw={"width_ratios": (1.0, 1.3)})
        draw_hertz(profiles)
        ratios = sorted({item.variant.values["γ"] for item in found}, reverse=True)
        nus = sorted({item.variant.values["ν"] for item in found})
        for item in found:
            values = item.variant.values
            tint = coloured(found)[nus.index(values["ν"])][1]
            dash = ("-", ":")[ratios.index(values["γ"])]
            profiles.plot(*pressure_profile(item.dataset, UNDER_BALL), dash, color=tint, label=item.variant.label)
        profiles.set(xlabel="$x/a$", ylabel="pressure $p/p_0$", title="Pressure along $y = 0$")
        profiles.set_ylim(bottom=0)
        profiles.margins(x=0)
        for ratio, tint in zip(ratios, ("#0072B2", "#D55E00"), strict=False):
            group = [item for item in found if item.variant.values["γ"] == ratio]
            for name, mark in (("largest pressure / p0", "o-"), ("largest von Mises / p0", "s--")):
                label = f"{name.split(' /')[0]}, γ = {ratio:g}"
                trends.plot(
                    [item.variant.values["ν"] for item in group],
                    [item.row[name] for item in group],
                    mark,
                    color=tint,
                    label=label,
                )
        trends.set(xlabel="Poisson's ratio of the spheres", ylabel="stress $/p_0$", title="Largest values")
        trends.set_ylim(bottom=0)
        trends.legend(loc="lower left", fontsize=7)
        legend_beside(figure, profiles)
    return figure


_TANGENT = (
    "The upper spheres touch the surface. Under a tangent point pressure and stress grow with finer cells, as they do "
    "with finer finite elements: of the peaks only the order counts."
)

_CLUSTER = (
    "The published depth of the spheres is not known: here the upper ones lie 0.2 um below the surface. The peaks "
    "depend on that: tangent ones give 1.56 instead of 1.31 p0 for γ = 2."
)

STUDIES = (
    Study(
        name="cluster-stiffness",
        title="484 spheres under a ball: pressure and largest stresses against their stiffness",
        repeats="thesis figures 3.20 to 3.22 (case IC-1)",
        variants=_stiffness_variants,
        read=_read,
        draw=lambda found: _draw_profiles(found, "γ", "stiffness ratio $\\gamma = E_i/E_m$"),
        remark=_CLUSTER,
    ),
    Study(
        name="cluster-poisson",
        title="484 spheres under a ball: pressure and largest stresses against their Poisson's ratio",
        repeats="thesis figures 3.28 and 3.29 (case IC-9)",
        variants=_poisson_variants,
        read=_read,
        draw=_draw_poisson,
        remark=_CLUSTER,
    ),
    Study(
        name="layer-of-spheres-depth",
        title="49 stiff spheres in a plane below a ball: pressure and largest stresses against their depth",
        repeats="thesis figures 3.30 and 3.31 (case IC-7)",
        variants=_depth_variants,
        read=_read,
        draw=lambda found: _draw_profiles(found, "h / a", "depth of the centres $h/a$"),
        remark="The smallest depth is that of tangent spheres, where the peak grows with finer cells.",
    ),
    Study(
        name="tangent-cluster",
        title="Stiff spheres that touch the surface: one of them, and with neighbours",
        repeats="thesis figure 3.27 (case IC-8)",
        variants=_tangent_variants,
        read=_read,
        draw=lambda found: _draw_profiles(found, "spheres", "number of spheres"),
        remark=_TANGENT,
    ),
)
