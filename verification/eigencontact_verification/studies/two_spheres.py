"""Studies of two spheres side by side below a ball, one of them on its axis: stiffness and gap."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from eigencontact_verification.studies.common import (
    UNDER_BALL,
    at_origin,
    coloured,
    draw_hertz,
    legend_beside,
    pressure_profile,
    sphere_scene,
    stiff,
)
from eigencontact_verification.studies.study import Finished, Row, Study, Variant

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

__all__ = ["STUDIES"]

_A = UNDER_BALL.radius
_RADIUS = 0.13 * _A
#: Stiffness ratios of the first sphere, which lies on the axis, and of the second.
_PAIRS = ((2.0, 2.0), (2.0, 0.5), (2.0, 0.0), (0.5, 2.0), (0.5, 0.5), (0.5, 0.0))


def _variant(pair: tuple[float, float | None], depth: float, gap: float, across: int) -> Variant:
    """Two spheres, or without a second stiffness one, `across` cells in radius and `gap` radii apart."""
    first, second = pair
    cell = _RADIUS / across
    spheres = [(first, 0.0)] + ([(second, 2.0 + gap)] if second is not None else [])
    inclusions: list[dict[str, Any]] = [
        {
            "name": f"sphere {n + 1}",
            "type": "sphere",
            "center": [place * _RADIUS, 0.0, depth * _A],
            "radius": _RADIUS,
            "material": stiff(ratio),
        }
        for n, (ratio, place) in enumerate(spheres)
    ]
    # just outside of the first sphere, on the side of the second: on its very surface cells have steps
    beside = [_RADIUS + 0.5 * cell, 0.0, depth * _A]
    points = {"name": "beside", "shape": "points", "points": [beside], "quantities": ["tresca"]}
    width = 2 * round(1.25 * _A / cell)
    scene = sphere_scene("Two spheres", inclusions, cell=cell, cells=width, stress=[points])
    values = {"γ₁": first, "h / a": depth}
    if second is None:
        return Variant(f"γ = {first:g} alone, h = {depth:g} a", scene, values)
    label = f"γ = {first:g}, {second:g}; β = {gap:g}; h = {depth:g} a"
    return Variant(label, scene, {**values, "γ₂": second, "β": gap})


def _pair_variants(*, coarse: bool) -> Sequence[Variant]:
    return [_variant(pair, 0.23, 0.25, 4) for pair in (_PAIRS[:2] if coarse else _PAIRS)]


def _gap_variants(*, coarse: bool) -> Sequence[Variant]:
    """Gaps of whole cells, so that the second sphere is cut like the first."""
    across = 4
    pairs = ((2.0, 0.0),) if coarse else ((2.0, 2.0), (2.0, 0.0), (0.5, 2.0), (0.5, 0.5))
    gaps = (0.25, 2.0) if coarse else (0.25, 0.5, 1.0, 2.0, 4.0)
    found = []
    for depth in (0.23,) if coarse else (0.23, 0.5):
        found += [_variant((first, None), depth, 0.0, across) for first in ((2.0,) if coarse else (2.0, 0.5))]
        found += [_variant(pair, depth, gap, across) for pair in pairs for gap in gaps]
    return found


def _read(_variant: Variant, dataset: xr.Dataset) -> Row:
    return {
        "largest pressure / p0": float(dataset["max_pressure"].isel(step=-1)) / UNDER_BALL.peak,
        "pressure above the first sphere / p0": at_origin(dataset, UNDER_BALL),
        "largest shear beside it / p0": 0.5 * float(dataset["beside_tresca"].isel(step=-1).values[0]) / UNDER_BALL.peak,
    }


def _draw_pairs(found: Sequence[Finished]) -> Figure:
    from eigencontact.viz.style import new_figure, paper_style

    firsts = sorted({item.variant.values["γ₁"] for item in found}, reverse=True)
    seconds = sorted({item.variant.values["γ₂"] for item in found}, reverse=True)
    with paper_style():
        figure = new_figure(3.6 * len(firsts) + 1.4, 3.1)
        panels = figure.subplots(1, len(firsts), squeeze=False, sharey=True)[0]
        for panel, first in zip(panels, firsts, strict=True):
            draw_hertz(panel)
            panel.set(xlabel="$x/a$", title=f"First sphere: γ₁ = {first:g}", xlim=(-1.1, 1.1))
        for item in found:
            values = item.variant.values
            tint = coloured(found)[seconds.index(values["γ₂"])][1]
            x, pressure = pressure_profile(item.dataset, UNDER_BALL)
            panels[firsts.index(values["γ₁"])].plot(x, pressure, "-", color=tint, label=f"γ₂ = {values['γ₂']:g}")
        panels[0].set_ylabel("pressure $p/p_0$")
        panels[0].set_ylim(bottom=0)
        legend_beside(figure, panels[-1], title="second sphere")
    return figure


def _draw_gaps(found: Sequence[Finished]) -> Figure:
    from eigencontact.viz.style import new_figure, paper_style

    depths = sorted({item.variant.values["h / a"] for item in found})
    pairs = [(item.variant.values["γ₁"], item.variant.values["γ₂"]) for item in found if "γ₂" in item.variant.values]
    name = "largest shear beside it / p0"
    with paper_style():
        figure = new_figure(3.6 * len(depths) + 1.6, 3.1)
        panels = figure.subplots(1, len(depths), squeeze=False, sharey=True)[0]
        for panel, depth in zip(panels, depths, strict=True):
            group = [item for item in found if item.variant.values["h / a"] == depth]
            for n, pair in enumerate(dict.fromkeys(pairs)):
                of_pair = [
                    item for item in group if (item.variant.values["γ₁"], item.variant.values.get("γ₂", -1.0)) == pair
                ]
                x, y = [item.variant.values["β"] for item in of_pair], [item.row[name] for item in of_pair]
                panel.plot(x, y, "o-", color=coloured(found)[n][1], label=f"γ₁ = {pair[0]:g}, γ₂ = {pair[1]:g}")
            for item, dash in zip(
                (item for item in group if "γ₂" not in item.variant.values), ("--", ":"), strict=False
            ):
                label = f"γ = {item.variant.values['γ₁']:g} alone"
                panel.axhline(float(item.row[name]), color="black", linewidth=0.8, linestyle=dash, label=label)
            panel.set(xlabel="gap over radius $\\beta$", title=f"Depth {depth:g} $a$", xlim=(0, None))
        panels[0].set_ylabel("largest shear stress $\\tau/p_0$")
        legend_beside(figure, panels[-1])
    return figure


STUDIES = (
    Study(
        name="two-spheres-pressure",
        title="Two spheres side by side, a quarter of a radius apart: pressure above them",
        repeats="thesis figure 3.33 (case IC-10)",
        variants=_pair_variants,
        read=_read,
        draw=_draw_pairs,
        remark="The pressure above the first sphere hardly depends on the second.",
    ),
    Study(
        name="two-spheres-spacing",
        title="Two spheres side by side: largest shear stress beside the first against the gap, at two depths",
        repeats="thesis figures 3.34 and 3.35 (case IC-10)",
        variants=_gap_variants,
        read=_read,
        draw=_draw_gaps,
        remark=(
            "Read half a cell outside of the first sphere. The published stresses come from one uniform eigenstrain "
            "for each sphere, which is inaccurate at small gaps: only the range of the interaction is to be compared. "
            "It ends near a gap of two radii, four between the centres."
        ),
    ),
)
