"""Studies of two spheres side by side below a ball, one of them on its axis: stiffness and gap."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from eigencontact.viz.style import new_figure
from eigencontact_verification.studies.common import (
    UNDER_BALL,
    at_origin,
    colour,
    draw_hertz,
    legend_beside,
    pressure_profile,
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
_RADIUS = 0.13 * _A
#: Cells of a radius.
_ACROSS = 4


def _row(first: float, depth: float, second: float | None = None, gap: float = 0.25) -> dict[str, float]:
    """Stiffness ratios of the sphere on the axis and of the second, if there is one; depth [a], gap [radii]."""
    return {"γ₁": first, "h / a": depth} | ({} if second is None else {"γ₂": second, "β": gap})


_PAIRS = [_row(first, 0.23, second) for first in (2.0, 0.5) for second in (2.0, 0.5, 0.0)]
#: Gaps are whole cells, so that the second sphere is cut like the first.
_GAPS = [
    row
    for depth in (0.23, 0.5)
    for row in (
        *(_row(first, depth) for first in (2.0, 0.5)),
        *(
            _row(first, depth, second, gap)
            for first, second in ((2.0, 2.0), (2.0, 0.0), (0.5, 2.0), (0.5, 0.5))
            for gap in (0.25, 0.5, 1.0, 2.0, 4.0)
        ),
    )
]
_FEW_GAPS = [_row(2.0, 0.23), *(_row(2.0, 0.23, 0.0, gap) for gap in (0.25, 2.0))]


def _scene(values: Mapping[str, float], *, coarse: bool) -> Scene:  # noqa: ARG001 - a coarse study has fewer rows
    """Two spheres, or without a second stiffness one."""
    cell, depth = _RADIUS / _ACROSS, values["h / a"] * _A
    spheres = [(values["γ₁"], 0.0)] + ([(values["γ₂"], 2.0 + values["β"])] if "γ₂" in values else [])
    inclusions: list[dict[str, Any]] = [
        {
            "name": f"sphere {n + 1}",
            "type": "sphere",
            "center": [place * _RADIUS, 0.0, depth],
            "radius": _RADIUS,
            "material": stiff(ratio),
        }
        for n, (ratio, place) in enumerate(spheres)
    ]
    # just outside of the first sphere, on the side of the second: on its very surface cells have steps
    beside = [_RADIUS + 0.5 * cell, 0.0, depth]
    points = {"name": "beside", "shape": "points", "points": [beside], "quantities": ["tresca"]}
    width = 2 * round(1.25 * _A / cell)
    return sphere_scene("Two spheres", inclusions, cell=cell, cells=width, stress=[points])


def _label(values: Mapping[str, float]) -> str:
    text = "γ = {γ₁:g}, {γ₂:g}; β = {β:g}; h = {h / a:g} a" if "γ₂" in values else "γ = {γ₁:g} alone, h = {h / a:g} a"
    return text.format_map(values)


def _read(_variant: Variant, dataset: xr.Dataset) -> Row:
    return {
        "largest pressure / p0": float(dataset["max_pressure"].isel(step=-1)) / UNDER_BALL.peak,
        "pressure above the first sphere / p0": at_origin(dataset, UNDER_BALL),
        "largest shear beside it / p0": 0.5 * float(dataset["beside_tresca"].isel(step=-1).values[0]) / UNDER_BALL.peak,
    }


def _draw_pairs(found: Sequence[Finished]) -> Figure:
    firsts = levels(found, "γ₁", falling=True)
    seconds = levels(found, "γ₂", falling=True)
    figure = new_figure(3.6 * len(firsts) + 1.4, 3.1)
    panels = figure.subplots(1, len(firsts), squeeze=False, sharey=True)[0]
    for panel, first in zip(panels, firsts, strict=True):
        draw_hertz(panel)
        panel.set(xlabel="$x/a$", title=f"First sphere: γ₁ = {first:g}", xlim=(-1.1, 1.1))
    for item in found:
        tint, panel = colour(seconds.index(item["γ₂"])), panels[firsts.index(item["γ₁"])]
        panel.plot(*pressure_profile(item.dataset, UNDER_BALL), "-", color=tint, label=f"γ₂ = {item['γ₂']:g}")
    panels[0].set_ylabel("pressure $p/p_0$")
    panels[0].set_ylim(bottom=0)
    legend_beside(figure, panels[-1], title="second sphere")
    return figure


def _draw_gaps(found: Sequence[Finished]) -> Figure:
    depths = levels(found, "h / a")
    pairs = dict.fromkeys((item["γ₁"], item["γ₂"]) for item in found if "γ₂" in item.variant.values)
    name = "largest shear beside it / p0"
    figure = new_figure(3.6 * len(depths) + 1.6, 3.1)
    panels = figure.subplots(1, len(depths), squeeze=False, sharey=True)[0]
    for panel, depth in zip(panels, depths, strict=True):
        group = having(found, "h / a", depth)
        for n, pair in enumerate(pairs):
            of_pair = having(having(group, "γ₁", pair[0]), "γ₂", pair[1])
            x, y = [item["β"] for item in of_pair], [item[name] for item in of_pair]
            panel.plot(x, y, "o-", color=colour(n), label=f"γ₁ = {pair[0]:g}, γ₂ = {pair[1]:g}")
        for item, dash in zip((item for item in group if "γ₂" not in item.variant.values), ("--", ":"), strict=False):
            label = f"γ = {item['γ₁']:g} alone"
            panel.axhline(item[name], color="black", linewidth=0.8, linestyle=dash, label=label)
        panel.set(xlabel="gap over radius $\\beta$", title=f"Depth {depth:g} $a$", xlim=(0, None))
    panels[0].set_ylabel("largest shear stress $\\tau/p_0$")
    legend_beside(figure, panels[-1])
    return figure


STUDIES = (
    Study(
        name="two-spheres-pressure",
        title="Two spheres side by side, a quarter of a radius apart: pressure above them",
        repeats="thesis figure 3.33 (case IC-10)",
        scene=_scene,
        label=_label,
        rows=_PAIRS,
        coarse=_PAIRS[:2],
        read=_read,
        draw=_draw_pairs,
        remark="The pressure above the first sphere hardly depends on the second.",
    ),
    Study(
        name="two-spheres-spacing",
        title="Two spheres side by side: largest shear stress beside the first against the gap, at two depths",
        repeats="thesis figures 3.34 and 3.35 (case IC-10)",
        scene=_scene,
        label=_label,
        rows=_GAPS,
        coarse=_FEW_GAPS,
        read=_read,
        draw=_draw_gaps,
        remark=(
            "Read half a cell outside of the first sphere. The published stresses come from one uniform eigenstrain "
            "for each sphere, which is inaccurate at small gaps: only the range of the interaction is to be compared. "
            "It ends near a gap of two radii, four between the centres."
        ),
    ),
)
