"""Studies of a ball that rolls over a body."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from eigencontact.viz.style import COLOURS, new_figure
from eigencontact_verification.studies.study import Finished, Row, Study, Variant, every

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    from eigencontact.scene.schema import Scene

__all__ = ["STUDIES"]

_STEEL = {"young_modulus": "210 GPa", "poisson_ratio": 0.3}
#: Contact radius [m] of a rigid ball of 105 um on steel under 0.65 N.
_RADIUS = 6.0533e-6


def _scene(values: Mapping[str, float], *, coarse: bool) -> Scene:
    from eigencontact.scene.schema import Scene

    points = {"name": "below", "shape": "points", "points": [[0.0, 0.0, values["depth / a"] * _RADIUS]]}
    return Scene(
        name="rolling",
        title="A rigid ball rolls over steel",
        body1=_STEEL,
        geometry={"type": "sphere", "radius": "105 um"},
        grid={"cells": [72, 24] if coarse else [192, 64], "size": ["42 um", "14 um"]},
        steps=[
            {"normal_load": "0.65 N", "travel_x": -2 * _RADIUS},
            {"normal_load": "0.65 N", "travel_x": 2 * _RADIUS, "increments": 4 if coarse else 32},
        ],
        stress=[points],
        output={"pictures": False},
    )


def _read(_variant: Variant, dataset: xr.Dataset) -> Row:
    pressure, mises = dataset["max_pressure"].values, dataset["below_von_mises"].values[:, 0]
    return {"largest pressure [Pa]": float(pressure.max()), "largest von Mises / p0": float(mises.max() / 8469.6e6)}


def _draw(found: Sequence[Finished]) -> Figure:
    figure = new_figure(4.6, 3.0)
    axes = figure.add_subplot()
    for n, item in enumerate(found):
        place = item.dataset["travel_x"].values / _RADIUS
        mises = item.dataset["below_von_mises"].values[:, 0] / 8469.6e6
        axes.plot(place, mises, "-", color=COLOURS[n % len(COLOURS)], label=item.variant.label)
    axes.set(xlabel="place of the ball $x/a$", ylabel="von Mises stress $/p_0$", title="Stress at a point passed")
    axes.margins(x=0)
    axes.set_ylim(bottom=0)
    figure.legend(loc="outside right upper")
    return figure


STUDIES = (
    Study(
        name="rolling-homogeneous",
        title="Stress history at points below a ball that rolls over them",
        repeats="closed form: largest von Mises stress 0.620 p0 at z = 0.48 a",
        scene=_scene,
        label="z = {depth / a:g} a".format_map,
        rows=every({"depth / a": (0.25, 0.48, 1.0)}),
        coarse=every({"depth / a": (0.25, 0.48)}),
        read=_read,
        draw=_draw,
    ),
)
