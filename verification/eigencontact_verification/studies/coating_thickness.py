"""Study of the thickness of a coating: from the contact of the substrate to that of the coating."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import pi, sqrt
from typing import TYPE_CHECKING

import numpy as np

from eigencontact.viz.style import new_figure
from eigencontact_verification.studies.coatings import coated_body, coated_scene, oracle, read_contact
from eigencontact_verification.studies.common import COATED, colour, legend_beside
from eigencontact_verification.studies.study import Finished, Row, Study, Variant, every, having, levels

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    from eigencontact.scene.schema import Scene

__all__ = ["STUDIES"]

#: Square root of the contact area of bare steel [m].
_SIDE = sqrt(pi) * COATED.radius


def _scene(values: Mapping[str, float], *, coarse: bool) -> Scene:
    body = coated_body(values["E₁/E₂"], values["h/√A₀"] * _SIDE)
    return coated_scene(body, cells=40 if coarse else 128, width=3.2)


def _known(ratio: float, value: float) -> tuple[float, float]:
    """Ratios of pressure and area by the integral equation."""
    known = oracle(ratio, value * _SIDE)
    return known.max_pressure / COATED.peak, (known.radius / COATED.radius) ** 2


def _read(variant: Variant, dataset: xr.Dataset) -> Row:
    found = read_contact(dataset)
    pressure, area = _known(variant.values["E₁/E₂"], variant.values["h/√A₀"])
    return {
        "pressure ratio": found["largest pressure / p0"],
        "area ratio": float(found["contact radius / a"]) ** 2,
        "integral equation: pressure": pressure,
        "integral equation: area": area,
    }


def _draw(found: Sequence[Finished]) -> Figure:
    values = np.array([item["h/√A₀"] for item in found])
    line = np.geomspace(values.min(), values.max(), 25)
    figure = new_figure(8.4, 3.1)
    panels = figure.subplots(1, 2)
    for n, ratio in enumerate(levels(found, "E₁/E₂")):
        group = having(found, "E₁/E₂", ratio)
        x = [item["h/√A₀"] for item in group]
        known = np.array([_known(ratio, float(value)) for value in line])
        limits = ratio ** (2 / 3), ratio ** (-2 / 3)
        for panel, name, curve, limit in zip(panels, ("pressure ratio", "area ratio"), known.T, limits, strict=True):
            panel.semilogx(line, curve, "-", color=colour(n), linewidth=0.9, label=f"$E_1/E_2$ = {ratio:g}")
            panel.plot(x, [item[name] for item in group], "o", color=colour(n), markersize=4)
            panel.axhline(limit, color=colour(n), linestyle=":", linewidth=1.2)
    for panel, title in zip(panels, ("Largest pressure $p_{max}/p_{max,0}$", "Contact area $A/A_0$"), strict=True):
        panel.axhline(1.0, color="black", linewidth=0.7, linestyle="--")
        panel.set(xlabel=r"thickness $h/\sqrt{A_0}$", title=title)
    panels[0].set_ylabel("over that of bare steel")
    panels[1].plot([], [], "o", color="grey", label="this study")
    panels[1].plot([], [], "-", color="grey", linewidth=0.9, label="integral equation")
    panels[1].plot([], [], ":", color="grey", label="Hertz on the coating alone")
    panels[1].plot([], [], "--", color="black", linewidth=0.7, label="Hertz on bare steel")
    legend_beside(figure, panels[1])
    return figure


STUDIES = (
    Study(
        name="coating-thickness",
        title="Sphere on soft and hard coatings: pressure and area against the thickness, with both limits",
        repeats="thesis figures 4.13 and 4.14 (cases PL-1 to PL-3)",
        scene=_scene,
        label="E₁/E₂ = {E₁/E₂:g}, h = {h/√A₀:g} √A₀".format_map,
        rows=every({"E₁/E₂": (0.5, 2.0), "h/√A₀": (0.02, 0.05, 0.1, 0.2, 0.35, 0.5, 1.0, 1.5, 3.0)}),
        coarse=every({"E₁/E₂": (0.5, 2.0), "h/√A₀": (0.05, 1.5)}),
        read=_read,
        draw=_draw,
        remark=(
            "Thick limits by Hertz: pressure 0.630 and area 1.587 for the soft coating, the other way round for "
            "the hard one; published curves end at areas of 1.45 and 1.55. At a thickness of 0.05 the area still "
            "differs from that of bare steel by 7 to 10 %."
        ),
    ),
)
