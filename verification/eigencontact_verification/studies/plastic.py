"""What the studies of yielding bodies share: the sphere on perfectly plastic steel, readings of prints, sections."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.viz.remembered import STRAIN
from eigencontact_verification.studies.common import STEEL, Reference

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

    from eigencontact.scene.schema import Scene

__all__ = ["BETA", "BIG", "SECTION", "draw_field", "line_of", "loading", "plastic_scene", "strain_section"]

FloatArray = NDArray[np.float64]

#: The sphere of 200 um under 12.307 N: a = 20 um, p0 = 14.69 GPa.
BIG = Reference(sphere_radius=200e-6, radius=20e-6)
#: Dundurs' second constant of steel under a rigid body.
BETA = (1.0 - 2.0 * STEEL["poisson_ratio"]) / (2.0 - 2.0 * STEEL["poisson_ratio"])


def loading(count: int, reference: Reference = BIG) -> list[dict[str, Any]]:
    """Steps up to the load of a reference, in each of which the elastic contact radius grows by as much."""
    return [{"normal_load": reference.load * (k / count) ** 3} for k in range(1, count + 1)]


def plastic_scene(values: Mapping[str, float], steps: Sequence[dict[str, Any]], *, cells: int, **others: Any) -> Scene:
    """Rigid sphere on steel that yields at p0 over ``values["p0/Sy"]`` (elastic where that is 0) with friction.

    Parameters
    ----------
    values : mapping of str to float
        ``"μ"`` and ``"p0/Sy"``.
    steps : sequence of tables
        Load history.
    cells : int
        To an elastic contact radius.
    others : tables
        Further tables of the scene.
    """
    from eigencontact.scene.schema import Scene

    body: dict[str, Any] = dict(STEEL)
    observers: list[dict[str, Any]] = list(others.pop("observers", ()))
    if values["p0/Sy"]:
        hardening = {"type": "perfect", "yield_stress": BIG.peak / values["p0/Sy"]}
        body["law"] = {"type": "j2", "hardening": hardening}
        observers.append({"type": "plastic-zone"})
    tables: dict[str, Any] = {}
    if values["μ"]:
        tables["friction"] = {"type": "coulomb", "coefficient": values["μ"]}
        observers.append({"type": "stick-radius"})
    edge = BIG.radius / cells
    return Scene(
        title="Rigid sphere on perfectly plastic steel",
        body1=body,
        geometry={"type": "sphere", "radius": BIG.sphere_radius},
        grid={"cells": 2 * round(1.5 * cells) + 1, "spacing": [edge, edge]},
        steps=list(steps),
        observers=observers,
        numerics={"tolerance": 1e-5},
        output={"pictures": False, **others.pop("output", {})},
        **tables,
        **others,
    )


#: Plane y = 0 down to 1.8 contact radii; its points lie in the middles of cells where the body yields.
SECTION = {"name": "section", "shape": "plane", "normal": "y", "depth_max": 1.8 * BIG.radius}


def line_of(data: xr.Dataset, name: str) -> tuple[FloatArray, FloatArray]:
    """Return x / a and a surface field of one step along y = 0."""
    row = data[name].isel(y=int(np.abs(data["y"].values).argmin()))
    return np.asarray(data["x"].values / BIG.radius), np.asarray(row.values)


def strain_section(
    data: xr.Dataset, number: int, radius: float = BIG.radius
) -> tuple[FloatArray, FloatArray, FloatArray] | None:
    """Return x / a, z / a and the equivalent plastic strain in the plane y = 0 after a step, by its number; or None."""
    name = f"{STRAIN}_1"
    if name not in data or number not in data["history_step"].values:
        return None
    at = int(np.flatnonzero(data["history_step"].values == number)[0])
    middle = int(np.abs(data["cells_1_y"].values).argmin())
    x, z = (np.asarray(data[f"cells_1_{axis}"].values / radius) for axis in "xz")
    return x, z, np.asarray(data[name].values[at][:, middle])


def draw_field(axes: Axes, field: tuple[Any, Any, Any] | None, levels: FloatArray, title: str, colours: str) -> Any:
    """Filled contours of a section, z downwards, both over the contact radius; nothing where there is no field."""
    from matplotlib import colormaps

    axes.set_aspect("equal")
    axes.set(
        xlim=(-1.5, 1.5), ylim=(1.8, 0.0), title=title, facecolor=colormaps[colours](0.5 if levels[0] < 0 else 0.0)
    )
    if field is None:
        axes.text(0.0, 0.9, "elastic", ha="center", color="white")
        return None
    x, z, values = field
    values, z = np.concatenate([values[:1], values]), np.concatenate([[0.0], z])  # the uppermost cells begin at z = 0
    return axes.contourf(x, z, values, levels=levels, cmap=colours, extend="both")
