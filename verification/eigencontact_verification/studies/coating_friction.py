"""Studies of a rigid sphere on a coated body with friction that sticks and slips: pressed, and moved to and fro."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.viz.style import new_figure
from eigencontact_verification.studies.coatings import coated_body, coated_scene, draw_section
from eigencontact_verification.studies.common import (
    COATED,
    STEEL,
    colour,
    coloured,
    cut_depths,
    legend_beside,
    pressure_profile,
    von_mises,
)
from eigencontact_verification.studies.study import Finished, Row, Study, Variant, every, having, levels

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    from eigencontact.scene.schema import Scene

__all__ = ["STUDIES"]

_A = COATED.radius
_SECTION = {"name": "section", "shape": "plane", "normal": "y", "depths": [0.01 * _A, *cut_depths(_A / 16, 2.0 * _A)]}
_NAMES = {0.5: "soft", 1.0: "none", 2.0: "hard"}
#: Dundurs' second constant of steel under a rigid body.
_BETA = (1.0 - 2.0 * STEEL["poisson_ratio"]) / (2.0 - 2.0 * STEEL["poisson_ratio"])


def _body(ratio: float) -> dict[str, Any]:
    """Without a coating there is no layer to compute."""
    return dict(STEEL) if ratio == 1.0 else coated_body(ratio)


def _pressed(values: Mapping[str, float], *, coarse: bool, **others: Any) -> Scene:
    """Sphere pressed in many steps, in each of which the contact radius grows by as much.

    What comes into contact within one step sticks where it is.
    """
    count = 6 if coarse else 24
    steps = [{"normal_load": COATED.load * (k / count) ** 3} for k in range(1, count + 1)]
    tables: dict[str, Any] = {"steps": steps, **others}
    if values["μ"]:
        tables["friction"] = {"type": "coulomb", "coefficient": values["μ"]}
        tables["observers"] = {"type": "stick-radius"}
    return coated_scene(_body(values["E₁/E₂"]), cells=28 if coarse else 72, width=2.8, **tables)


def _label(values: Mapping[str, float]) -> str:
    return f"{_NAMES[values['E₁/E₂']]}, μ = {values['μ']:g}"


def _read_stick(_variant: Variant, dataset: xr.Dataset) -> Row:
    last = dataset.isel(step=-1)
    return {
        "stick radius / contact radius": float(last["stick_radius_ratio"]),
        "largest pressure / p0": float(last["max_pressure"]) / COATED.peak,
    }


def _draw_stick(found: Sequence[Finished]) -> Figure:
    from eigencontact_verification.oracles.spence import stick_ratio

    figure = new_figure(5.4, 3.2)
    axes = figure.add_subplot()
    for n, (ratio, name) in enumerate(_NAMES.items()):
        group = having(found, "E₁/E₂", ratio)
        values = [item["stick radius / contact radius"] for item in group]
        label = f"{name}, $E_1/E_2$ = {ratio:g}" if ratio != 1.0 else "no coating"
        axes.plot([item["μ"] for item in group], values, "o-", color=colour(n), label=label)
    line = np.linspace(0.03, 0.42, 60)
    spence = [stick_ratio(mu / _BETA) for mu in line]
    axes.plot(line, spence, "--", color="black", linewidth=0.8, label="no coating (Spence)")
    axes.set(xlabel="friction coefficient $\\mu$", ylabel="stick radius over contact radius $c/a$", ylim=(0, 1))
    axes.set(xlim=(0, 0.42), title="Sphere pressed on a coating with friction")
    legend_beside(figure, axes)
    return figure


def _read_stress(_variant: Variant, dataset: xr.Dataset) -> Row:
    section, depth = von_mises(dataset, COATED), dataset["section_z"].values
    return {
        "largest von Mises / p0": float(section.max()),
        "at z / h": float(depth[section.max(axis=1).argmax()] / _A),
        "largest von Mises below 0.1 h": float(section[depth > 0.1 * _A].max()),
        "largest pressure / p0": float(dataset["max_pressure"].isel(step=-1)) / COATED.peak,
    }


def _draw_stress(found: Sequence[Finished]) -> Figure:
    ratios = levels(found, "E₁/E₂")
    highest = max(float(von_mises(item.dataset, COATED).max()) for item in found)
    figure = new_figure(9.4, 1.75 * len(ratios) + 0.4)
    panels = figure.subplots(len(ratios), 3, squeeze=False)
    for item in found:
        row, column = ratios.index(item["E₁/E₂"]), int(item["μ"] > 0)
        image = draw_section(panels[row, column], item.dataset, highest, item.variant.label)
        axes = panels[row, 2]
        axes.plot(*pressure_profile(item.dataset, COATED), ("--", "-")[column], color=colour(0), label="pressure")
        if column:
            x, shear = pressure_profile(item.dataset, COATED, name="shear_x")
            axes.plot(x, shear, "-", color=colour(1), label="shear")
    for row, ratio in enumerate(ratios):
        panels[row, 2].set(xlim=(-1.4, 1.4), xlabel="$x/a$", title=f"{_NAMES[ratio]}: tractions $/p_0$")
        panels[row, 2].axhline(0.0, color="grey", linewidth=0.6)
    figure.colorbar(image, ax=panels[:, :2], shrink=0.9, aspect=30, location="left", label="von Mises stress $/p_0$")
    axes = panels[0, 2]
    axes.lines[0].set_label("pressure, μ = 0")
    legend_beside(figure, axes)
    return figure


def _fretted(values: Mapping[str, float], *, coarse: bool) -> Scene:
    """Two cycles to and fro under constant load."""
    count, shift = 4 if coarse else 12, values["δ / a"] * _A
    steps = [
        {"normal_load": COATED.load},
        {"shift_x": shift, "increments": count // 2},
        *({"shift_x": end, "increments": count} for end in (-shift, shift) * 2),
    ]
    friction = {"type": "coulomb", "coefficient": 0.5}
    body, cells = _body(values["E₁/E₂"]), 28 if coarse else 64
    return coated_scene(body, cells=cells, width=2.8, steps=steps, friction=friction)


def _read_loop(_variant: Variant, dataset: xr.Dataset) -> Row:
    shift, force = _loop(dataset)
    cycle = shift.size - 4 * (shift.size - 1) // 9 - 1
    x, y = shift[cycle:], force[cycle:]
    area = float(abs(np.sum(0.5 * (y[1:] + y[:-1]) * np.diff(x))))
    last = dataset.isel(step=-1)
    contact = float((last["contact_zone"] > 0).sum())
    stick = float((last["contact_zone"] > 1.5).sum())
    return {
        "largest force / μP": float(np.abs(force).max()),
        "energy of the last cycle / μPa": area,
        "stick radius / contact radius at the end": float(np.sqrt(stick / contact)),
    }


def _loop(dataset: xr.Dataset) -> tuple[Any, Any]:
    """Shift over a and force over μP, from the first step on, where the sphere has only been pressed."""
    return dataset["shift_x"].values / _A, dataset["tangential_load_x"].values / (0.5 * COATED.load)


def _draw_loop(found: Sequence[Finished]) -> Figure:
    amplitudes = levels(found, "δ / a")
    figure = new_figure(4.0 * len(amplitudes) + 1.2, 3.1)
    panels = figure.subplots(1, len(amplitudes), squeeze=False)[0]
    for panel, amplitude in zip(panels, amplitudes, strict=True):
        group = having(found, "δ / a", amplitude)
        for item, tint in coloured(group):
            panel.plot(*_loop(item.dataset), "-", color=tint, label=_NAMES[item["E₁/E₂"]])
        panel.set(xlabel="shift $\\delta/a$", title=f"Amplitude {amplitude:g} $a$")
    panels[0].set_ylabel("force $Q/\\mu P$")
    legend_beside(figure, panels[-1], title="coating")
    return figure


STUDIES = (
    Study(
        name="coating-friction",
        title="Sphere pressed on soft and hard coatings with friction: stick radius against the friction coefficient",
        repeats="thesis figure 4.17 (case SP-6)",
        scene=_pressed,
        label=_label,
        rows=every({"E₁/E₂": list(_NAMES), "μ": (0.1, 0.15, 0.2, 0.3, 0.4)}),
        coarse=every({"E₁/E₂": (0.5, 2.0), "μ": (0.2,)}),
        read=_read_stick,
        draw=_draw_stick,
        remark=(
            "Soft coatings stick more, hard ones slip more. Spence's curve is for a pressure that ignores the shear; "
            "here it feels it, which makes the stick disk smaller."
        ),
    ),
    Study(
        name="coating-friction-stress",
        title="Sphere pressed on soft and hard coatings with and without friction: von Mises stress and tractions",
        repeats="thesis figure 4.16 (case SP-5)",
        scene=partial(_pressed, stress=[_SECTION]),
        label=_label,
        rows=every({"E₁/E₂": list(_NAMES), "μ": (0.0, 0.5)}),
        coarse=every({"E₁/E₂": (2.0,), "μ": (0.0, 0.5)}),
        read=_read_stress,
        draw=_draw_stress,
        remark="The published rise of the stress by 22, 17 and 15 % for soft, none and hard is not reproduced: below "
        "the skin it is a few per cent. With a hard coating the largest stress "
        "comes to lie at the surface, where it still changes with the number of steps.",
    ),
    Study(
        name="coating-fretting",
        title="Sphere moved to and fro on soft and hard coatings: fretting loops",
        repeats="thesis figures 4.20 and 4.24 (case CMC-2)",
        scene=_fretted,
        label=lambda values: f"{_NAMES[values['E₁/E₂']]}, δ = {values['δ / a']:g} a",
        rows=[{"E₁/E₂": ratio, "δ / a": amplitude} for amplitude in (0.025, 0.125) for ratio in _NAMES],
        coarse=[{"E₁/E₂": ratio, "δ / a": 0.025} for ratio in (0.5, 2.0)],
        read=_read_loop,
        draw=_draw_loop,
    ),
)
