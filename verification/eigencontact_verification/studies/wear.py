"""What the studies of wear share: the sphere of 20 µm of contact, its coatings, courses, profiles, loops."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.viz.worn import ends_of_cycles
from eigencontact_verification.studies.common import STEEL, colour
from eigencontact_verification.studies.plastic import BIG, line_of
from eigencontact_verification.studies.study import Finished, Row

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

    from eigencontact.scene.schema import Scene

__all__ = [
    "COATINGS",
    "SECTION",
    "coated",
    "draw_course",
    "draw_profile",
    "draw_sections",
    "label",
    "legend_below",
    "numbers",
    "scene_of",
]

FloatArray = NDArray[np.float64]

#: Young's modulus of the coating over that of the steel below it.
COATINGS = (0.5, 1.0, 2.0)
SECTION = {"name": "section", "shape": "plane", "normal": "y", "depth_max": 2.0 * BIG.radius, "depth_cells": 16}
#: Volume that a flat end of the contact radius a0 leaves off the sphere, π a⁴/(4R) [m³].
REFERENCE = np.pi * BIG.radius**4 / (4.0 * BIG.sphere_radius)

label = "E₁/E₂ = {E₁/E₂:g}".format_map


def coated(ratio: float) -> dict[str, Any]:
    """Steel under a coating as thick as the contact radius on bare steel."""
    layer = {**STEEL, "young_modulus": ratio * STEEL["young_modulus"], "thickness": BIG.radius}
    return {"medium": {"type": "bonded-layers", "layers": [layer], "substrate": dict(STEEL)}}


def scene_of(name: str, values: Mapping[str, float], changes: Sequence[str], **tables: Any) -> Scene:
    """Bundled scene with a coating, with changes as on the command line, and with tables replaced."""
    import eigencontact as ec
    from eigencontact.scene.schema import Scene

    table = ec.load_scene(name, [*changes, "output.pictures=false"]).resolved()
    return Scene(**{**table, "body1": coated(values["E₁/E₂"]), **tables})


def numbers(dataset: xr.Dataset) -> Row:
    """Worn volume, its estimated error, largest depth; largest pressure at first and in the end; contact radius."""
    last = dataset.isel(step=-1)
    return {
        "V [um^3]": 1e18 * float(last["worn_volume"]),
        "error of V [%]": 100.0 * float(last["wear_error"]),
        "depth [um]": 1e6 * float(last["max_worn_depth"]),
        "first p/p0": float(dataset["max_pressure"][0]) / BIG.peak,
        "p/p0": float(last["max_pressure"]) / BIG.peak,
        "a/a0": float(last["contact_radius"]) / BIG.radius,
    }


#: Courses over the cycles: scalar, factor, words.
_COURSES = {
    "volume": ("worn_volume", 1.0 / REFERENCE, r"worn volume $4RV/\pi a_0^4$"),
    "depth": ("max_worn_depth", 1e6, "largest depth [µm]"),
    "pressure": ("max_pressure", 1.0 / BIG.peak, "largest pressure $/p_0$"),
    "area": ("contact_area", 1.0 / (np.pi * BIG.radius**2), r"contact area $/\pi a_0^2$"),
}


def draw_course(axes: Axes, found: Sequence[Finished], what: str) -> None:
    """Curve over the cycles for every coating, through the ends of those that were solved."""
    name, factor, words = _COURSES[what]
    for n, item in enumerate(found):
        data = item.dataset.isel(step=ends_of_cycles(item.dataset))
        axes.plot(data["cycles"], factor * data[name], "o-", markersize=2.5, color=colour(n), label=item.variant.label)
    axes.set(xlabel="cycles", title=words, ylim=(0.0, None))
    axes.margins(x=0.0)


def draw_profile(axes: Axes, item: Finished, step: int, name: str, factor: float, n: int, dash: str = "-") -> None:
    """Surface field of a step along y = 0."""
    x, values = line_of(item.dataset.isel(step=step), name)
    axes.plot(x, factor * values, dash, color=colour(n))
    axes.set(xlabel="$x/a_0$")


def draw_sections(
    panels: Sequence[Axes], datasets: Sequence[xr.Dataset], titles: Sequence[str], beside: Axes | None = None
) -> None:
    """Maps of the von Mises stress over p0 at y = 0, each of the last step of its dataset, with one scale.

    The scale stands at the left of an empty panel `beside`, where there is one.
    """
    fields = [data["section_von_mises"].isel(step=-1).values / BIG.peak for data in datasets]
    highest = max(float(field.max()) for field in fields)
    for axes, data, field, title in zip(panels, datasets, fields, titles, strict=True):
        x, z = (data[f"section_{axis}"].values / BIG.radius for axis in "xz")
        sunk = np.concatenate([field[:1], field])
        image = axes.pcolormesh(
            x, np.concatenate([[0.0], z]), sunk, vmin=0.0, vmax=highest, cmap="viridis", shading="gouraud"
        )
        axes.axhline(1.0, color="white", linewidth=0.8)
        axes.set(xlim=(-2.0, 2.0), ylim=(2.0, 0.0), aspect="equal", title=title, xlabel="$x/a_0$")
        axes.set_xlim(max(-2.0, float(x[0])), min(2.0, float(x[-1])))
    figure = panels[0].figure
    assert figure is not None
    words = "von Mises stress $/p_0$"
    if beside is None:
        figure.colorbar(image, ax=list(panels), shrink=0.9, label=words)
    else:
        beside.set_axis_off()
        figure.colorbar(image, cax=beside.inset_axes((0.0, 0.05, 0.06, 0.9)), label=words)


def legend_below(axes: Axes) -> None:
    """Legend of a panel of courses under the figure."""
    figure = axes.get_figure(root=True)
    assert figure is not None
    figure.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=4)
