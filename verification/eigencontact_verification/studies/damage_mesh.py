"""Study of what softens on finer cells: with a length the damage settles, without one it follows the cells."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from eigencontact.viz.style import COLOURS, new_figure
from eigencontact_verification.studies.study import Finished, Row, Study, Variant, every, having, levels

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    from eigencontact.scene.schema import Scene

__all__ = ["STUDIES"]

#: Damage from which a cell counts as damaged.
_DAMAGED = 0.3


def _scene(values: Mapping[str, float], *, coarse: bool) -> Scene:
    from eigencontact.scene.schema import Scene

    edge = values["cells [m]"]
    damage = {"type": "exponential", "saturation": 0.6, "strain": 0.02}
    if values["length [m]"]:
        damage["length"] = values["length [m]"]
    hardening = {"type": "perfect", "yield_stress": 100e6}
    return Scene(
        title="Rigid sphere on bone, yield on the effective stress",
        body1={
            "young_modulus": 18.6e9,
            "poisson_ratio": 0.3,
            "law": {"type": "j2", "hardening": hardening, "damage": damage, "yield_on": "effective"},
        },
        geometry={"type": "sphere", "radius": 2e-6},
        grid={"cells": 2 * round(150e-9 / edge) + 1, "spacing": [edge, edge]},
        steps=[
            {"normal_load": 10e-6, "increments": 2 if coarse else 4},
            {"normal_load": 0.0, "increments": 2},
        ],
        numerics={"tolerance": 1e-4 if coarse else 1e-5},
        output={"pictures": False},
    )


def _read(_variant: Variant, dataset: xr.Dataset) -> Row:
    damage = dataset["damage_1"].values[-1]
    volume = np.prod([float(np.diff(dataset[f"cells_1_{name}"])[0]) for name in "xyz"])
    return {
        "depth [m]": float(dataset["approach"].max()),
        "print [m]": float(dataset["print_depth"][-1]),
        "largest damage": float(damage.max()),
        "damaged volume [m3]": float(volume * np.count_nonzero(damage > _DAMAGED)),
    }


def _draw(found: Sequence[Finished]) -> Figure:
    figure = new_figure(7.6, 2.9)
    panels = figure.subplots(1, 2)
    for n, length in enumerate(levels(found, "length [m]")):
        items = having(found, "length [m]", length)
        edges = [1e9 * item["cells [m]"] for item in items]
        label = f"length {1e9 * length:g} nm" if length else "no length"
        style = {"color": COLOURS[n], "marker": "os"[n % 2], "label": label}
        panels[0].plot(edges, [item["largest damage"] for item in items], **style)
        panels[1].plot(edges, [1e18 * item["damaged volume [m3]"] for item in items], **style)
    panels[0].set(xlabel="edge of the cells [nm]", ylabel="largest damage")
    panels[1].set(xlabel="edge of the cells [nm]", ylabel=f"volume with D > {_DAMAGED:g} [µm³]")
    panels[0].legend()
    return figure


STUDIES = (
    Study(
        name="damage-mesh",
        title="Bone whose strength falls with damage, on finer cells, with and without a length",
        repeats="case EP-18 (yield on the effective stress)",
        scene=_scene,
        label=lambda values: (
            f"{1e9 * values['cells [m]']:g} nm, "
            + (f"length {1e9 * values['length [m]']:g} nm" if values["length [m]"] else "no length")
        ),
        rows=every({"cells [m]": (40e-9, 32e-9, 25e-9, 20e-9), "length [m]": (0.0, 64e-9)}),
        coarse=every({"cells [m]": (45e-9, 36e-9), "length [m]": (0.0, 64e-9)}),
        read=_read,
        draw=_draw,
        remark="Without a length the largest damage grows as the cells shrink; with one it settles.",
    ),
)
