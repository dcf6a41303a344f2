"""Studies of one stiff sphere on the axis of a ball: its radius, away from the surface and tangent to it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from eigencontact_verification.studies.common import (
    UNDER_BALL,
    at_origin,
    colour,
    coloured,
    draw_trends,
    read_largest,
    sphere_scene,
    stiff,
)
from eigencontact_verification.studies.study import Finished, Row, Study, Variant, having, levels

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    from eigencontact.scene.schema import Scene

__all__ = ["STUDIES"]

_A = UNDER_BALL.radius
#: Axisymmetric finite elements, fine enough not to change any more: r / a and p(0) / p0 for a depth of 0.5 a.
_ELEMENTS = ((0.13, 1.024), (0.17, 1.054))


#: Radii [a] away from the surface and tangent to it, each with its depth [a] and cells per a.
_FIXED = [{"r / a": r, "depth / a": 0.5, "cells per a": 40.0} for r in (0.08, 0.13, 0.17, 0.25, 0.33, 0.42)]
_TANGENT = [
    {"r / a": r, "depth / a": r, "cells per a": cells}
    for cells in (12.0, 24.0)
    for r in (0.08, 0.17, 0.33, 0.5, 0.67, 1.0)
]


def _scene(values: Mapping[str, float], *, coarse: bool) -> Scene:  # noqa: ARG001 - the rows say how coarse
    """Sphere whose depth is rounded to whole cells where it is not tangent."""
    per_radius, depth = values["cells per a"], values["depth / a"]
    sphere = {"name": "sphere", "type": "sphere", "center": [0.0, 0.0, depth * _A], "radius": values["r / a"] * _A}
    width = 2 * round(1.35 * per_radius)
    return sphere_scene("One sphere", [{**sphere, "material": stiff(2.0)}], cell=_A / per_radius, cells=width)


def _read(variant: Variant, dataset: xr.Dataset) -> Row:
    return {**read_largest(variant, dataset), "pressure on the axis / p0": at_origin(dataset, UNDER_BALL)}


def _draw(found: Sequence[Finished], *, elements: bool) -> Figure:
    """Profiles of the finest cells; largest values for each size of cells."""
    sizes = levels(found, "cells per a", falling=True)
    finest = having(found, "cells per a", sizes[0])
    curves = [(item, "-", tint, f"$r$ = {item['r / a']:g} $a$") for item, tint in coloured(finest)]
    trends = [
        (having(found, "cells per a", size), f"largest {name} / p0", mark + dash, colour(n), f"{name}{suffix}")
        for size, dash in zip(sizes, ("-", "--"), strict=False)
        for suffix in [f", $a$/{size:g}" if len(sizes) > 1 else ""]
        for n, (name, mark) in enumerate((("pressure", "o"), ("von Mises", "s")))
    ]
    figure, axes = draw_trends("r / a", trends, curves, wide=1.2)
    if elements:
        axes.plot(
            *zip(*_ELEMENTS, strict=True),
            "x",
            color="black",
            markersize=6,
            label="pressure, finite elements",
        )
    axes.set(xlabel="radius of the sphere $r/a$", xlim=(0, None))
    if len(sizes) > 1:
        axes.set_title("Largest values for two sizes of cells")
    axes.set_ylim(0, None if elements else 1.3 * axes.get_ylim()[1])
    axes.legend(loc="lower right" if elements else "upper center", fontsize=7, ncols=1 if elements else 2)
    return figure


STUDIES = (
    Study(
        name="sphere-radius",
        title="A stiff sphere half a contact radius deep: pressure and largest stresses against its radius",
        repeats="thesis figures 3.25 and 3.26 (case IC-3)",
        scene=_scene,
        label="r = {r / a:g} a".format_map,
        rows=_FIXED,
        coarse=[{**row, "cells per a": 16.0} for row in _FIXED if row["r / a"] in {0.17, 0.33}],
        read=_read,
        draw=lambda found: _draw(found, elements=True),
        remark="Finite elements: 1.024 and 1.054 p0 on the axis for r = 0.13 a and 0.17 a.",
    ),
    Study(
        name="tangent-sphere-radius",
        title="A stiff sphere that touches the surface: largest stresses against its radius, for two sizes of cells",
        repeats="thesis figures 3.24 and 3.26 (case IC-2)",
        scene=_scene,
        label="r = {r / a:g} a, cells a/{cells per a:g}".format_map,
        rows=_TANGENT,
        coarse=_TANGENT[1:3],
        read=_read,
        draw=lambda found: _draw(found, elements=False),
        remark=(
            "Not converged, and it cannot be: between the tangent point and the surface no matrix is left, and the "
            "pressure there grows with finer cells. So it does with finite elements: 1.92 and 1.99 p0 for r = 0.17 a "
            "with elements of r/20 and r/40; 2.04 and 2.11 for 0.5 a. "
            "The largest is that of a radius of 0.5 a to 0.7 a; a published maximum at 0.17 a is not reproduced."
        ),
    ),
)
