"""Studies of many spheres under a ball: stiffness, Poisson's ratio, depth of a layer of them, tangent ones."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import isqrt
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact_verification.studies.common import (
    UNDER_BALL,
    colour,
    coloured,
    draw_trends,
    read_largest,
    sphere_scene,
    stiff,
)
from eigencontact_verification.studies.study import Finished, Study, every, having, levels

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from eigencontact.scene.schema import Scene

__all__ = ["STUDIES"]

_A = UNDER_BALL.radius
#: Edge of the cells [m], of a coarse study too, where a cluster has spheres of three cells across.
_CELL, _COARSE = 0.2e-6, 0.4e-6
#: Marks of the largest values.
_MARKS = (("largest pressure / p0", "o-"), ("largest von Mises / p0", "s--"))


def _cluster(columns: int, spacing: float, depths: Sequence[float], radius: float, material: Any) -> dict[str, Any]:
    """`columns` x `columns` spheres in each of some depths."""
    places = (np.arange(columns) - 0.5 * (columns - 1)) * spacing
    centers = [[float(x), float(y), float(z)] for z in depths for y in places for x in places]
    return {"name": "cluster", "type": "sphere", "radius": radius, "centers": centers, "material": material}


def _case_1(values: Mapping[str, float], *, coarse: bool) -> Scene:
    """Scene of 11 x 11 x 4 spheres of 0.1 a, 1.6 um apart.

    With one layer of cells above the upper spheres they fill the published 31 layers of 0.2 um.
    """
    cell = _COARSE if coarse else _CELL
    depths = [0.8e-6 + 1.6e-6 * k for k in range(2 if coarse else 4)]
    cluster = _cluster(11, 1.6e-6, depths, 0.6e-6, stiff(values["γ"], values.get("ν", 0.3)))
    return sphere_scene("Cluster of spheres", [cluster], cell=cell, cells=48 if coarse else 90)


def _layer(values: Mapping[str, float], *, coarse: bool) -> Scene:
    """7 x 7 spheres of four cells in radius, eleven cells apart; depths are whole cells."""
    # spheres of as many cells across, but fewer and further apart: a first look
    columns, spacing = (3, 22 * _CELL) if coarse else (7, 11 * _CELL)
    depth = round(values["h / a"] * _A / _CELL) * _CELL
    cluster = _cluster(columns, spacing, [depth], 0.8e-6, stiff(2.0))
    return sphere_scene("Layer of spheres", [cluster], cell=_CELL, cells=72 if coarse else 84)


def _tangent(values: Mapping[str, float], *, coarse: bool) -> Scene:
    cluster = _cluster(isqrt(round(values["spheres"])), 12 * _CELL, [1.0e-6], 1.0e-6, stiff(2.0))
    return sphere_scene("Tangent spheres", [cluster], cell=_CELL, cells=72 if coarse else 84)


def _columns(values: Mapping[str, float]) -> str:
    columns = isqrt(round(values["spheres"]))
    return "one sphere" if columns == 1 else f"{columns} x {columns} spheres"


def _draw(found: Sequence[Finished], abscissa: str, xlabel: str) -> Figure:
    """Against one parameter."""
    curves = [(item, "-" if n < 6 else ":", tint, item.variant.label) for n, (item, tint) in enumerate(coloured(found))]
    trends = [(found, name, mark, colour(n), name.split(" /")[0]) for n, (name, mark) in enumerate(_MARKS)]
    figure, axes = draw_trends(abscissa, trends, curves)
    axes.set(xlabel=xlabel)
    axes.set_ylim(bottom=0)
    axes.legend(loc="lower right")
    return figure


def _draw_poisson(found: Sequence[Finished]) -> Figure:
    """Against Poisson's ratio, for each stiffness."""
    ratios, nus = levels(found, "γ", falling=True), levels(found, "ν")
    curves = [
        (item, ("-", ":")[ratios.index(item["γ"])], colour(nus.index(item["ν"])), item.variant.label) for item in found
    ]
    trends = [
        (having(found, "γ", ratio), name, mark, colour(n), f"{name.split(' /')[0]}, γ = {ratio:g}")
        for n, ratio in enumerate(ratios)
        for name, mark in _MARKS
    ]
    figure, axes = draw_trends("ν", trends, curves)
    axes.set(xlabel="Poisson's ratio of the spheres")
    axes.set_ylim(bottom=0)
    axes.legend(loc="lower left", fontsize=7)
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
        scene=_case_1,
        label="γ = {γ:g}".format_map,
        rows=every({"γ": (0.0, 0.25, 0.5, 1.0, 1.5, 2.0)}),
        coarse=every({"γ": (0.5, 2.0)}),
        read=read_largest,
        draw=lambda found: _draw(found, "γ", "stiffness ratio $\\gamma = E_i/E_m$"),
        remark=_CLUSTER,
    ),
    Study(
        name="cluster-poisson",
        title="484 spheres under a ball: pressure and largest stresses against their Poisson's ratio",
        repeats="thesis figures 3.28 and 3.29 (case IC-9)",
        scene=_case_1,
        label="γ = {γ:g}, ν = {ν:g}".format_map,
        rows=every({"γ": (0.5, 2.0), "ν": (0.0, 0.15, 0.3, 0.4, 0.45)}),
        coarse=every({"γ": (2.0,), "ν": (0.15, 0.45)}),
        read=read_largest,
        draw=_draw_poisson,
        remark=_CLUSTER,
    ),
    Study(
        name="layer-of-spheres-depth",
        title="49 stiff spheres in a plane below a ball: pressure and largest stresses against their depth",
        repeats="thesis figures 3.30 and 3.31 (case IC-7)",
        scene=_layer,
        label="h = {h / a:.2f} a".format_map,
        rows=every({"h / a": [n * _CELL / _A for n in (4, 5, 6, 7, 9, 12, 15, 20)]}),
        coarse=every({"h / a": [n * _CELL / _A for n in (4, 8)]}),
        read=read_largest,
        draw=lambda found: _draw(found, "h / a", "depth of the centres $h/a$"),
        remark="The smallest depth is that of tangent spheres, where the peak grows with finer cells.",
    ),
    Study(
        name="tangent-cluster",
        title="Stiff spheres that touch the surface: one of them, and with neighbours",
        repeats="thesis figure 3.27 (case IC-8)",
        scene=_tangent,
        label=_columns,
        rows=every({"spheres": (1.0, 9.0, 25.0, 49.0)}),
        coarse=every({"spheres": (1.0, 9.0)}),
        read=read_largest,
        draw=lambda found: _draw(found, "spheres", "number of spheres"),
        remark=_TANGENT,
    ),
)
