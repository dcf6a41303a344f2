"""Studies of a sphere pressed with friction on a body that yields (fretting mode II)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.viz.style import COLOURS, new_figure
from eigencontact_verification.studies.common import legend_beside
from eigencontact_verification.studies.plastic import (
    BETA,
    BIG,
    SECTION,
    draw_field,
    line_of,
    loading,
    plastic_scene,
    strain_section,
)
from eigencontact_verification.studies.study import Finished, Row, Study, Variant, every, having, levels

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    from eigencontact.scene.schema import Scene

__all__ = ["STUDIES"]

_MU = (0.0, 0.05, 0.1, 0.2, 0.3, 0.5)
_MARKS = ("o", "s", "^", "d")


def _pressed(values: Mapping[str, float], *, coarse: bool, **others: Any) -> Scene:
    """Pressed in steps of equal contact radius, then unloaded."""
    steps = [*loading(4 if coarse else 16), {"normal_load": 0.0, "increments": 1 if coarse else 2}]
    return plastic_scene(values, steps, cells=4 if coarse else 12, **others)


def _label(values: Mapping[str, float]) -> str:
    return f"p₀/Sy = {values['p0/Sy']:g}, μ = {values['μ']:g}"


def _peak(dataset: xr.Dataset) -> xr.Dataset:
    """Step of the largest load."""
    return dataset.isel(step=int(dataset["normal_load"].values.argmax()))


def _read(_variant: Variant, dataset: xr.Dataset) -> Row:
    peak, last = _peak(dataset), dataset.isel(step=-1)
    row = {
        "depth / elastic depth": float(peak["approach"]) / BIG.approach,
        "largest pressure / p0": float(peak["max_pressure"]) / BIG.peak,
        "stick radius / contact radius": float(peak["stick_radius_ratio"]) if "stick_radius_ratio" in peak else 0.0,
        "largest plastic strain": 0.0,
        "print [m]": 0.0,
        "wall [m]": 0.0,
    }
    if "plastic_zone_max_strain" in dataset:
        row["largest plastic strain"] = float(peak["plastic_zone_max_strain"])
        row["top of the zone / a"] = float(peak["plastic_zone_shallowest"]) / BIG.radius
        row["print [m]"], row["wall [m]"] = float(last["max_sink"]), float(last["max_uplift"])
    return row


def _draw(found: Sequence[Finished]) -> Figure:
    rates, mus = levels(found, "p0/Sy"), levels(found, "μ")
    figure = new_figure(2.45 * max(4, len(mus)) + 1.2, 5.4)
    halves: Any = figure.subfigures(2, 1)
    above, below = halves
    strain, stick, depth, across = above.subplots(1, 4)
    for n, rate in enumerate(rates):
        group, style = having(found, "p0/Sy", rate), {"color": COLOURS[n], "marker": _MARKS[n % 4]}
        name = f"$p_0/S_y$ = {rate:g}" if rate else "elastic"
        x = [item["μ"] / BETA for item in group]
        stick.plot(x, [item["stick radius / contact radius"] for item in group], label=name, **style)
        if rate:
            strain.plot(x, [100 * item["largest plastic strain"] for item in group], label=name, **style)
    for n, item in enumerate(having(found, "p0/Sy", rates[-1])):
        last, tint = item.dataset.isel(step=-1), COLOURS[n % len(COLOURS)]
        for axes, name in ((depth, "residual_displacement_z"), (across, "residual_displacement_x")):
            if name in last:
                place, u = line_of(last, name)
                axes.plot(place, 1e9 * u, color=tint, label=rf"$\mu$ = {item['μ']:g}")
    strain.set(xlabel=r"$\mu/\beta$", ylabel="[%]", title="Largest plastic strain")
    stick.set(xlabel=r"$\mu/\beta$", ylabel="$c/a$", title="Stick radius over contact radius", ylim=(0, 1))
    depth.set(xlabel="$x/a$", ylabel="$u_z$ [nm]", title=f"Print, $p_0/S_y$ = {rates[-1]:g}")
    depth.invert_yaxis()
    across.set(xlabel="$x/a$", ylabel="$u_x$ [nm]", title="Along the surface")
    strain.set_ylim(bottom=0)
    stick.legend()
    across.legend(fontsize=7)
    panels = below.subplots(1, len(mus), sharey=True, squeeze=False)[0]
    for axes, mu in zip(panels, mus, strict=True):
        for item in having(found, "μ", mu):
            peak, tint = _peak(item.dataset), COLOURS[rates.index(item["p0/Sy"])]
            for name, dash in (("pressure", "-"), ("shear_x", "--")):
                if name in peak:
                    place, values = line_of(peak, name)
                    axes.plot(place, values / BIG.peak, dash, color=tint)
        axes.set(xlabel="$x/a$", title=rf"$\mu$ = {mu:g}", xlim=(-1.3, 1.3))
        axes.axhline(0.0, color="0.6", linewidth=0.6, zorder=0)
    panels[0].set_ylabel("pressure (solid), shear (dashed) $/p_0$")
    return figure


#: Fields of the second study: title, colours, and whether it has a sign.
_FIELDS = (
    ("plastic strain [%]", "viridis", False),
    ("von Mises, loaded $/p_0$", "viridis", False),
    ("von Mises, residual $/p_0$", "viridis", False),
    ("mean normal stress, residual $/p_0$", "RdBu_r", True),
)


def _fields(item: Finished) -> list[tuple[Any, Any, Any] | None]:
    data = item.dataset
    last = int(data["step"][-1])
    strain = strain_section(data, last)
    x, z = data["section_x"].values / BIG.radius, data["section_z"].values / BIG.radius
    top = int(data["normal_load"].values.argmax())
    pairs = (("von_mises", top), ("von_mises", -1), ("hydrostatic", -1))
    stresses = [(x, z, data[f"section_{name}"][step].values / BIG.peak) for name, step in pairs]
    return [None if strain is None else (*strain[:2], 100 * strain[2]), *stresses]


def _draw_fields(found: Sequence[Finished]) -> Figure:
    fields = [_fields(item) for item in found]
    figure = new_figure(2.5 * len(found) + 1.3, 6.6)
    panels = figure.subplots(len(_FIELDS), len(found), sharex=True, sharey=True, squeeze=False)
    for row, (name, colours, signed) in enumerate(_FIELDS):
        drawn = [field[row][2] for field in fields if field[row] is not None]  # type: ignore[index]
        high = max(float(np.abs(values).max()) for values in drawn)
        steps = np.linspace(-high if signed else 0.0, high, 15)
        for column, item in enumerate(found):
            title = rf"$\mu$ = {item['μ']:g}" if row == 0 else ""
            image = draw_field(panels[row, column], fields[column][row], steps, title, colours)
        bar = figure.colorbar(image, ax=panels[row], shrink=0.9, aspect=14, format="%.2g")
        bar.set_label(name, fontsize=7)
        panels[row, 0].set_ylabel("$z/a$")
    for axes in panels[-1]:
        axes.set_xlabel("$x/a$")
    return figure


def _elastic(values: Mapping[str, float], *, coarse: bool) -> Scene:
    """Without yield: the stress when the load is on says when yield would begin, as the contact grows like itself."""
    depths = [float(z) for z in BIG.radius * np.linspace(0.02, 0.8, 14 if coarse else 40)]
    region = {"name": "section", "shape": "plane", "normal": "y", "depths": depths}
    given = {"μ": values["μ"], "p0/Sy": 0.0}
    return plastic_scene(given, loading(5 if coarse else 20), cells=8 if coarse else 24, stress=[region])


def _read_onset(_variant: Variant, dataset: xr.Dataset) -> Row:
    mises = dataset["section_von_mises"].isel(step=-1).values / BIG.peak
    depth = dataset["section_z"].values[int(mises.max(axis=1).argmax())]
    contact = float(dataset["stick_radius_ratio"][-1]) if "stick_radius_ratio" in dataset else 0.0
    return {
        "largest von Mises / p0": float(mises.max()),
        "depth / a": float(depth / BIG.radius),
        "stick radius / contact radius": contact,
    }


def _draw_onset(found: Sequence[Finished]) -> Figure:
    figure = new_figure(7.2, 2.9)
    left, right = figure.subplots(1, 2)
    smooth = next(item for item in found if item["μ"] == 0.0)["largest von Mises / p0"]
    x = [item["μ"] / BETA for item in found]
    left.plot(x, [(smooth / item["largest von Mises / p0"]) ** 3 for item in found], "o-", color=COLOURS[0])
    right.plot(x, [item["depth / a"] for item in found], "s-", color=COLOURS[1])
    left.set(ylabel="load / that without friction", title="Load at the onset of yield", ylim=(0, 1.1))
    right.set(ylabel="$z/a$", title="Depth at which yield begins")
    right.set_ylim(bottom=0)
    for axes in (left, right):
        axes.set_xlabel(r"$\mu/\beta$")
    return figure


def _spence(values: Mapping[str, float], *, coarse: bool) -> Scene:
    given, numerics = {"μ": values["μ"], "p0/Sy": 0.0}, {"coupling": "one-way"}
    scene = plastic_scene(given, loading(8 if coarse else 40), cells=10 if coarse else 32)
    return scene.model_copy(update={"numerics": scene.numerics.model_copy(update=numerics)})


def _read_spence(variant: Variant, dataset: xr.Dataset) -> Row:
    from eigencontact_verification.oracles.spence import stick_ratio

    row = {"stick radius / contact radius": float(dataset["stick_radius_ratio"][-1])}
    return row | {"Spence": float(stick_ratio(variant.values["μ"] / BETA))}


def _draw_spence(found: Sequence[Finished]) -> Figure:
    from eigencontact_verification.oracles.spence import stick_ratio

    figure = new_figure(4.6, 2.9)
    axes = figure.add_subplot()
    line = np.linspace(0.03, 0.55, 80)
    axes.plot(line / BETA, [stick_ratio(mu / BETA) for mu in line], "-", color="0.3", linewidth=1.0, label="Spence")
    x, y = [item["μ"] / BETA for item in found], [item["stick radius / contact radius"] for item in found]
    axes.plot(x, y, "o", color=COLOURS[1], label="computed")
    axes.set(xlabel=r"$\mu/\beta$", ylabel="$c/a$", title="Stick radius of an elastic body", ylim=(0, 1))
    legend_beside(figure, axes)
    return figure


STUDIES = (
    Study(
        name="plastic-friction",
        title="Sphere pressed with friction beyond yield: plastic strain, stick radius, print, tractions",
        repeats="thesis figures 2.35, 2.36, 2.37 and 2.39 (case EP-3)",
        scene=_pressed,
        label=_label,
        rows=every({"μ": _MU, "p0/Sy": (0.0, 1.5, 1.75, 2.0)}),
        coarse=every({"μ": (0.0, 0.2), "p0/Sy": (0.0, 2.0)}),
        read=_read,
        draw=_draw,
        remark=(
            "Depth falls with friction, print and wall grow; plastic strain shrinks the stick disk below μ/β = 0.5 and "
            "widens it above. The published second ring of slip on loading (μ = 0.2) is not found by finite elements."
        ),
    ),
    Study(
        name="plastic-friction-fields",
        title="Sphere pressed with friction beyond yield: plastic strain, stress when loaded, residual stress",
        repeats="thesis figures 2.33, 2.34, 2.40 and 2.41 (case EP-3)",
        scene=partial(_pressed, stress=[{**SECTION, "quantities": ["von_mises", "hydrostatic"]}]),
        label=_label,
        rows=every({"μ": _MU, "p0/Sy": (2.0,)}),
        coarse=every({"μ": (0.0, 0.2), "p0/Sy": (2.0,)}),
        read=_read,
        draw=_draw_fields,
        remark="The zone reaches the surface between μ/β = 0.35 and 0.525, not at the published 0.7.",
    ),
    Study(
        name="yield-onset-friction",
        title="Load and depth at which yield begins under a sphere pressed with friction",
        repeats="thesis figure 2.32",
        scene=_elastic,
        label="μ = {μ:g}".format_map,
        rows=every({"μ": (0.0, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.4, 0.5, 1.0)}),
        coarse=every({"μ": (0.0, 0.2)}),
        read=_read_onset,
        draw=_draw_onset,
        remark="The contact grows like itself, so one load is enough: yield begins where its stress has grown to Sy.",
    ),
    Study(
        name="spence-radius",
        title="Stick radius of a sphere pressed on an elastic body with friction, beside the closed form",
        repeats="thesis figure 2.31; Spence 1975 (case SP-1)",
        scene=_spence,
        label="μ = {μ:g}".format_map,
        rows=every({"μ": (0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.4, 0.5)}),
        coarse=every({"μ": (0.1, 0.2)}),
        read=_read_spence,
        draw=_draw_spence,
    ),
)
