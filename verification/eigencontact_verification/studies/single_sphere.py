"""Studies of one stiff sphere on the axis of a ball: its radius, away from the surface and tangent to it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from eigencontact_verification.studies.common import (
    UNDER_BALL,
    at_origin,
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
#: Axisymmetric finite elements, fine enough not to change any more: r / a and p(0) / p0 for a depth of 0.5 a.
_ELEMENTS = ((0.13, 1.024), (0.17, 1.054))


def _variant(radius: float, depth: float, per_radius: int, *, label: str) -> Variant:
    """Sphere whose depth is rounded to whole cells where it is not tangent."""
    cell = _A / per_radius
    sphere = {"name": "sphere", "type": "sphere", "center": [0.0, 0.0, depth * _A], "radius": radius * _A}
    width = 2 * round(1.35 * per_radius)
    scene = sphere_scene("One sphere", [{**sphere, "material": stiff(2.0)}], cell=cell, cells=width)
    return Variant(label, scene, {"r / a": radius, "depth / a": depth, "cells per a": float(per_radius)})


def _fixed(*, coarse: bool) -> Sequence[Variant]:
    radii = (0.17, 0.33) if coarse else (0.08, 0.13, 0.17, 0.25, 0.33, 0.42)
    return [_variant(radius, 0.5, 16 if coarse else 40, label=f"r = {radius:g} a") for radius in radii]


def _tangent(*, coarse: bool) -> Sequence[Variant]:
    radii = (0.17, 0.33) if coarse else (0.08, 0.17, 0.33, 0.5, 0.67, 1.0)
    return [
        _variant(radius, radius, cells, label=f"r = {radius:g} a, cells a/{cells}")
        for cells in ((12,) if coarse else (12, 24))
        for radius in radii
    ]


def _read(_variant: Variant, dataset: xr.Dataset) -> Row:
    return {**read_largest(dataset, UNDER_BALL), "pressure on the axis / p0": at_origin(dataset, UNDER_BALL)}


def _draw(found: Sequence[Finished], *, elements: bool) -> Figure:
    """Profiles for the finest cells on the right; largest values against the radius on the left, each size of cells."""
    from eigencontact.viz.style import new_figure, paper_style

    with paper_style():
        figure = new_figure(8.4, 3.1)
        trends, profiles = figure.subplots(1, 2, gridspec_kw={"width_ratios": (1.0, 1.2)})
        sizes = sorted({item.variant.values["cells per a"] for item in found}, reverse=True)
        draw_hertz(profiles)
        for item, tint in coloured([item for item in found if item.variant.values["cells per a"] == sizes[0]]):
            label = f"$r$ = {item.variant.values['r / a']:g} $a$"
            profiles.plot(*pressure_profile(item.dataset, UNDER_BALL), "-", color=tint, label=label)
        profiles.set(xlabel="$x/a$", ylabel="pressure $p/p_0$", title="Pressure along $y = 0$")
        profiles.set_ylim(bottom=0)
        profiles.margins(x=0)
        for size, dash in zip(sizes, ("-", "--"), strict=False):
            group = [item for item in found if item.variant.values["cells per a"] == size]
            suffix = f", $a$/{size:g}" if len(sizes) > 1 else ""
            for name, mark, tint in (("pressure", "o", "#0072B2"), ("von Mises", "s", "#D55E00")):
                x = [item.variant.values["r / a"] for item in group]
                values = [item.row[f"largest {name} / p0"] for item in group]
                trends.plot(x, values, mark + dash, color=tint, label=f"{name}{suffix}")
        if elements:
            trends.plot(
                *zip(*_ELEMENTS, strict=True), "x", color="black", markersize=6, label="pressure, finite elements"
            )
        trends.set(xlabel="radius of the sphere $r/a$", ylabel="stress $/p_0$", title="Largest values", xlim=(0, None))
        if len(sizes) > 1:
            trends.set_title("Largest values for two sizes of cells")
        trends.set_ylim(0, None if elements else 1.3 * trends.get_ylim()[1])
        trends.legend(loc="lower right" if elements else "upper center", fontsize=7, ncols=1 if elements else 2)
        legend_beside(figure, profiles)
    return figure


STUDIES = (
    Study(
        name="sphere-radius",
        title="A stiff sphere half a contact radius deep: pressure and largest stresses against its radius",
        repeats="thesis figures 3.25 and 3.26 (case IC-3)",
        variants=_fixed,
        read=_read,
        draw=lambda found: _draw(found, elements=True),
        remark="Finite elements: 1.024 and 1.054 p0 on the axis for r = 0.13 a and 0.17 a.",
    ),
    Study(
        name="tangent-sphere-radius",
        title="A stiff sphere that touches the surface: largest stresses against its radius, for two sizes of cells",
        repeats="thesis figures 3.24 and 3.26 (case IC-2)",
        variants=_tangent,
        read=_read,
        draw=lambda found: _draw(found, elements=False),
        remark=(
            "Not converged, and it cannot be: between the tangent point and the surface no matrix is left, and the "
            "pressure there grows with finer cells. So it does with finite elements: 1.92 and 1.99 p0 for r = 0.17 a "
            "with elements of r/20 and r/40; 2.04 and 2.11 for 0.5 a. A published maximum at r = 0.17 a follows from "
            "cells of the size of the sphere."
        ),
    ),
)
