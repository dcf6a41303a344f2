"""Study of a sphere pressed into bone: plasticity with and without damage."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.viz.style import COLOURS, new_figure
from eigencontact_verification.studies.plastic import draw_field, strain_section
from eigencontact_verification.studies.study import Finished, Row, Study, Variant, every

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    from eigencontact.scene.schema import Scene

__all__ = ["STUDIES"]

#: Sphere [m], load [N] and contact radius [m] on elastic bone.
_SPHERE, _LOAD, _RADIUS = 2e-6, 10e-6, 90.2e-9


def _scene(values: Mapping[str, float], *, coarse: bool) -> Scene:
    from eigencontact.scene.schema import Scene

    law: dict[str, Any] = {"type": "j2", "hardening": {"type": "perfect", "yield_stress": 100e6}}
    if values["lost at most"]:
        law |= {"damage": {"type": "exponential", "saturation": values["lost at most"], "strain": 0.02}}
        law["yield_on"] = "nominal"
    edge = _RADIUS / (3 if coarse else 8)
    return Scene(
        title="Rigid sphere on bone",
        body1={"young_modulus": 18.6e9, "poisson_ratio": 0.3, "law": law},
        geometry={"type": "sphere", "radius": _SPHERE},
        grid={"cells": 2 * round(1.6 * _RADIUS / edge) + 1, "spacing": [edge, edge]},
        steps=[
            {"normal_load": _LOAD, "increments": 4 if coarse else 12},
            {"normal_load": 0.0, "increments": 4 if coarse else 10},
        ],
        observers=[{"type": "plastic-zone"}],
        numerics={"tolerance": 1e-4 if coarse else 1e-5},
        output={"pictures": False},
    )


def _read(_variant: Variant, dataset: xr.Dataset) -> Row:
    load, depth = dataset["normal_load"].values, dataset["approach"].values
    back = load[load.argmax() :]
    at_fifth = float(np.interp(0.2 * _LOAD, back[::-1], depth[load.argmax() :][::-1]))
    return {
        "depth [m]": float(depth.max()),
        "print [m]": float(depth[-1]),
        "recovered in the last fifth [m]": at_fifth - float(depth[-1]),
        "largest plastic strain": float(dataset["plastic_zone_max_strain"][-1]),
        "largest damage": float(dataset["plastic_zone_max_damage"][-1]),
    }


def _draw(found: Sequence[Finished]) -> Figure:
    figure = new_figure(3.6 + 2.6 * len(found), 2.9)
    panels = figure.subplots(1, 1 + len(found), squeeze=False, gridspec_kw={"width_ratios": [1.2] + [1] * len(found)})[
        0
    ]
    for n, item in enumerate(found):
        depth, load = item.dataset["approach"].values, item.dataset["normal_load"].values
        style: dict[str, Any] = {"color": COLOURS[n], "linestyle": ("-", "--")[n % 2]}
        panels[0].plot(1e9 * np.append(0.0, depth), 1e6 * np.append(0.0, load), label=item.variant.label, **style)
    panels[0].set(xlabel="depth [nm]", ylabel="load [µN]", title="Loading and unloading")
    panels[0].set_ylim(bottom=0)
    panels[0].set_xlim(left=0)
    panels[0].legend()
    top = 100.0 * max(item["largest plastic strain"] for item in found)
    for axes, item in zip(panels[1:], found, strict=True):
        field = strain_section(item.dataset, int(item.dataset["step"][-1]), _RADIUS)
        assert field is not None
        shown = (*field[:2], 100.0 * field[2])
        image = draw_field(axes, shown, np.linspace(0.0, top, 13), item.variant.label, "viridis")
        axes.set(xlabel="$x/a$ (elastic)", xlim=(-2.5, 2.5), ylim=(3.5, 0.0))
    panels[1].set_ylabel("$z/a$")
    figure.colorbar(image, ax=panels[1:], shrink=0.9).set_label("plastic strain [%]")
    return figure


STUDIES = (
    Study(
        name="bone",
        title="Sphere pressed into bone and lifted, with and without damage: load and depth, plastic strain",
        repeats="thesis figures 4.60 and 4.61 (case EP-7)",
        scene=_scene,
        label=lambda values: f"damage up to {values['lost at most']:g}" if values["lost at most"] else "no damage",
        rows=every({"lost at most": (0.0, 0.6)}),
        coarse=every({"lost at most": (0.0, 0.6)}),
        read=_read,
        draw=_draw,
        remark="Yield on the nominal stress: depth hardly changes, the print is smaller, the end of unloading softer.",
    ),
)
