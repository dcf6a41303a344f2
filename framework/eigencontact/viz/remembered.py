"""History fields of bodies for pictures: fields in the cells of a box, cut by planes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.viz.contours import contour_lines
from eigencontact.viz.outline import inclusion_segments
from eigencontact.viz.sides import Plane, sides_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from eigencontact.results.stored import Results
    from eigencontact.viz.style import Scale

__all__ = ["DAMAGE", "STRAIN", "CellField", "draw_zone", "plastic_strains", "remembered_fields", "yields", "zone_field"]

#: Name, before the number of the body, of what a material that yields remembers.
STRAIN = "equivalent_plastic_strain"
#: The same of a material that degrades.
DAMAGE = "damage"
#: The plastic zone holds more than this part of the largest plastic strain: pictures show no less.
SHARE = 0.05


@dataclass(frozen=True)
class CellField:
    """A number in each cell of a box in a body.

    Attributes
    ----------
    body : int
        1 or 2.
    values : (nz, ny, nx)
        In the cells.
    axes : dict
        Middles of the cells [m] by axis.
    """

    body: int
    values: NDArray[Any]
    axes: dict[str, NDArray[Any]]

    def edge(self, axis: str) -> float:
        """Edge of the cells along an axis [m]; one layer begins at the surface."""
        places = self.axes[axis]
        return float(places[1] - places[0]) if places.size > 1 else 2.0 * abs(float(places[0]))

    def cut(self, normal: str, at: float) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]] | None:
        """Values, and places along the vertical and horizontal axes, in the plane of cells that holds a place [m].

        Cells at the surface are continued up to z = 0, beyond all other rims of the box there is one more cell of
        zeros. None where the plane passes beside the box.
        """
        index = int(np.abs(self.axes[normal] - at).argmin())
        if abs(float(self.axes[normal][index]) - at) > 0.5001 * self.edge(normal):
            return None
        vertical, horizontal = (axis for axis in "zyx" if axis != normal)
        values = np.take(self.values, index, axis="zyx".index(normal))
        surface = vertical == "z" and self.axes["z"][0] < 0.75 * self.edge("z")
        values = np.pad(values, 1)
        if surface:
            values[0] = values[1]
        v, h = (np.pad(self.axes[axis], 1) for axis in (vertical, horizontal))
        for places, axis in ((v, vertical), (h, horizontal)):
            places[0], places[-1] = places[1] - self.edge(axis), places[-2] + self.edge(axis)
        return values, v, h

    @property
    def largest(self) -> tuple[float, dict[str, float]]:
        """Largest value and its place; of several alike the one nearest to the z axis."""
        top = float(self.values.max())
        k, j, i = np.nonzero(self.values >= (1.0 - 1e-9) * top)
        away = self.axes["x"][i] ** 2 + self.axes["y"][j] ** 2
        n = int(away.argmin())
        where = {"z": k[n], "y": j[n], "x": i[n]}
        return top, {axis: float(self.axes[axis][index]) for axis, index in where.items()}


def yields(dataset: Results) -> bool:
    """Whether a run remembers plastic strain or damage."""
    return any(f"{name}_{body}" in dataset for body in (1, 2) for name in (STRAIN, DAMAGE))


def plastic_strains(dataset: Results, step: int) -> Iterator[CellField]:
    """Equivalent plastic strain of each body; see `remembered_fields`."""
    return remembered_fields(dataset, step, STRAIN)


def remembered_fields(dataset: Results, step: int, quantity: str) -> Iterator[CellField]:
    """History field of each body at a position along ``step``, where it is stored and not zero."""
    for body in (1, 2):
        name = f"{quantity}_{body}"
        if name not in dataset or dataset[name].ndim != 4:
            continue
        positions = np.flatnonzero(dataset["history_step"].values == int(dataset["step"][step]))
        if not positions.size:
            continue
        values = np.asarray(dataset[name][int(positions[0])].values, dtype=float)
        if float(values.max(initial=0.0)) > 0.0:
            axes = {axis: np.asarray(dataset[f"cells_{body}_{axis}"].values, dtype=float) for axis in "zyx"}
            yield CellField(body, values, axes)


def zone_field(dataset: Results, field: CellField, normal: str, at: float, step: int) -> tuple[Any, Any, Any] | None:
    """Places (horizontal, vertical), values and sides of the plane of cells that holds a place; None beside the box."""
    section = field.cut(normal, at)
    if section is None:
        return None
    values, v, h = section
    dims = [axis for axis in "zyx" if axis != normal]
    plane = Plane(field.body, (dims[0], dims[1]), v, h)
    return (h, v), values, sides_of(dataset, plane, inclusion_segments(dataset, field.body, normal, at), step)


def draw_zone(
    axes: Axes, dataset: Results, field: CellField, plane: tuple[str, float], length: Scale, step: int
) -> bool:
    """Draw the border of the plastic zone in a plane of cells; returns whether the plane meets the zone.

    It is the contour of the part `SHARE` of the largest value of the field, and of the values of each side of borders.
    """
    section = zone_field(dataset, field, *plane, step)
    level = SHARE * float(field.values.max())
    if section is None or not (section[1] > level).any():
        return False
    at, values, sides = section
    for width, colour in ((2.2, "1.0"), (1.1, "0.1")):
        line_sides = contour_lines(axes, at, values, sides, length=length, level=level)
        for lines in line_sides:
            lines.set(linewidth=width, edgecolor=colour, zorder=3)
    return True
