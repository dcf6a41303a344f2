"""What the studies of inhomogeneities and coatings share: reference contacts, inhomogeneities, readings, axes."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.viz.style import COLOURS, new_figure
from eigencontact_verification.studies.study import Finished, Row, Variant

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from eigencontact.scene.schema import Scene

__all__ = [
    "COATED",
    "STEEL",
    "UNDER_BALL",
    "Curve",
    "Reference",
    "Trend",
    "at_origin",
    "colour",
    "coloured",
    "cut_depths",
    "draw_hertz",
    "draw_trends",
    "legend_beside",
    "pressure_profile",
    "read_largest",
    "sphere_scene",
    "stiff",
    "von_mises",
]

FloatArray = NDArray[np.float64]

STEEL = {"young_modulus": 210e9, "poisson_ratio": 0.3}


@dataclass(frozen=True, kw_only=True)
class Reference:
    """Frictionless contact of a rigid sphere on homogeneous steel, which the figures are normalised by.

    Attributes
    ----------
    sphere_radius : float
        R [m].
    radius : float
        Contact radius a [m] by Hertz.
    """

    sphere_radius: float
    radius: float

    @property
    def contact_modulus(self) -> float:
        """E* of steel under a rigid body [Pa]."""
        return STEEL["young_modulus"] / (1.0 - STEEL["poisson_ratio"] ** 2)

    @property
    def load(self) -> float:
        """Load [N] that gives the contact radius."""
        return 4.0 * self.contact_modulus * self.radius**3 / (3.0 * self.sphere_radius)

    @property
    def peak(self) -> float:
        """Largest pressure p0 [Pa]."""
        return 2.0 * self.contact_modulus * self.radius / (np.pi * self.sphere_radius)

    @property
    def approach(self) -> float:
        """Approach [m]."""
        return self.radius**2 / self.sphere_radius


#: The ball of 105 um under 0.65 N, over inhomogeneities: a = 6.0533 um, p0 = 8.47 GPa.
UNDER_BALL = Reference(sphere_radius=105e-6, radius=6.0533e-6)
#: The sphere over coatings: a on the bare substrate is the thickness, and a tenth of its radius.
COATED = Reference(sphere_radius=20e-6, radius=2e-6)


def stiff(ratio: float, poisson_ratio: float = 0.3) -> dict[str, Any]:
    """Material of an inhomogeneity whose Young's modulus is `ratio` times that of steel; 0 is a void."""
    if ratio == 0.0:
        return {"void": True}
    return {"young_modulus": ratio * STEEL["young_modulus"], "poisson_ratio": poisson_ratio}


def cut_depths(pitch: float, depth: float) -> list[float]:
    """Middles of the layers of cells down to a depth [m]: on their faces the stress of cells has corners."""
    return [float((k + 0.5) * pitch) for k in range(round(depth / pitch))]


def sphere_scene(
    title: str,
    inclusions: Sequence[dict[str, Any]],
    *,
    cell: float,
    cells: int,
    stress: Sequence[dict[str, Any]] | None = None,
) -> Scene:
    """Scene of the ball on steel with inhomogeneities of cubic cells.

    Parameters
    ----------
    title : str
        One line.
    inclusions : sequence of tables
        The inhomogeneities.
    cell : float
        Edge of the cells [m].
    cells : int
        Of the window, each way.
    stress : sequence of tables, optional
        Regions; by default the plane y = 0 down to the contact radius.
    """
    from eigencontact.scene.schema import Scene

    section = {"name": "section", "shape": "plane", "normal": "y", "depths": cut_depths(cell, UNDER_BALL.radius)}
    return Scene(
        title=title,
        body1=STEEL,
        geometry={"type": "sphere", "radius": UNDER_BALL.sphere_radius},
        grid={"cells": cells, "spacing": [cell, cell]},
        inclusions=list(inclusions),
        steps=[{"normal_load": UNDER_BALL.load}],
        stress=[section] if stress is None else list(stress),
        numerics={"tolerance": 1e-4, "inclusion_pitch": cell},
        output={"pictures": False},
    )


def pressure_profile(
    dataset: xr.Dataset, reference: Reference, name: str = "pressure"
) -> tuple[FloatArray, FloatArray]:
    """Return x / a and p / p0, or another traction over p0, of the row of cells next to y = 0 after the last step."""
    last = dataset.isel(step=-1)
    row = last[name].isel(y=int(np.abs(last["y"].values).argmin()))
    return np.asarray(last["x"].values / reference.radius), np.asarray(row.values / reference.peak)


def at_origin(dataset: xr.Dataset, reference: Reference) -> float:
    """Pressure over p0 at x = y = 0, the mean of the cells that meet there."""
    near = dataset["pressure"].isel(step=-1)
    for axis in ("x", "y"):
        distance = np.abs(near[axis].values)
        near = near.isel({axis: np.flatnonzero(distance <= 1.01 * distance.min())})
    return float(near.mean()) / reference.peak


def von_mises(dataset: xr.Dataset, reference: Reference, region: str = "section") -> FloatArray:
    """Von Mises stress over p0 in a region after the last step."""
    return np.asarray(dataset[f"{region}_von_mises"].isel(step=-1).values / reference.peak)


def read_largest(_: Variant, dataset: xr.Dataset) -> Row:
    """Largest pressure, largest von Mises stress in the plane y = 0, both over p0; contact radius over a."""
    return {
        "largest pressure / p0": float(dataset["max_pressure"].isel(step=-1)) / UNDER_BALL.peak,
        "largest von Mises / p0": float(von_mises(dataset, UNDER_BALL).max()),
        "contact radius / a": float(dataset["contact_radius"].isel(step=-1)) / UNDER_BALL.radius,
    }


def colour(n: int) -> str:
    """Colour of the n-th curve."""
    return COLOURS[n % len(COLOURS)]


def coloured(found: Sequence[Finished]) -> list[tuple[Finished, str]]:
    """Each variant with its colour; the dashes of more than there are colours are for the caller."""
    return [(item, colour(n)) for n, item in enumerate(found)]


def draw_hertz(axes: Axes) -> None:
    """Hertz's pressure over x / a, as a thin black line."""
    x = np.linspace(-1.0, 1.0, 201)
    axes.plot(x, np.sqrt(1.0 - x * x), "--", color="black", linewidth=0.8, label="homogeneous (Hertz)", zorder=1)


#: A curve of pressure: variant, dashes, colour, label.
Curve = tuple[Finished, str, str, str]
#: A line of largest values: variants, the reading, mark and dashes, colour, label.
Trend = tuple[Sequence[Finished], str, str, str, str]


def draw_trends(
    abscissa: str, trends: Iterable[Trend], curves: Iterable[Curve], *, wide: float = 1.3
) -> tuple[Figure, Axes]:
    """Largest values against a parameter on the left, whose axes are returned; pressure along y = 0 on the right."""
    figure = new_figure(8.4, 3.1)
    left, right = figure.subplots(1, 2, gridspec_kw={"width_ratios": (1.0, wide)})
    draw_hertz(right)
    for item, dash, tint, label in curves:
        right.plot(*pressure_profile(item.dataset, UNDER_BALL), dash, color=tint, label=label)
    right.set(xlabel="$x/a$", ylabel="pressure $p/p_0$", title="Pressure along $y = 0$")
    right.set_ylim(bottom=0)
    right.margins(x=0)
    for group, name, mark, tint, label in trends:
        left.plot([item[abscissa] for item in group], [item[name] for item in group], mark, color=tint, label=label)
    left.set(ylabel="stress $/p_0$", title="Largest values")
    legend_beside(figure, right)
    return figure, left


def legend_beside(figure: Figure, axes: Axes, title: str | None = None) -> None:
    """Legend outside of the axes, on the right, where it covers no curve."""
    handles, labels = axes.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside right upper", title=title, title_fontsize=8)
