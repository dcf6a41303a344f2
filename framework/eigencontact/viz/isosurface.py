"""Picture of surfaces of equal plastic strain in a body; it needs VTK, so it is drawn where VTK files are wanted."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.viz.style import heading, new_figure, paper_style, scale_for

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from eigencontact.results.stored import Results
    from eigencontact.viz.remembered import CellField

__all__ = ["plastic_surfaces", "surface_of"]

#: Shares of the largest strain whose surfaces are drawn, and how well one sees through them.
SHARES = ((0.02, 0.16), (0.25, 0.35), (0.75, 0.9))
PERCENT = 100.0


def plastic_surfaces(dataset: Results, field: CellField, step: int = -1) -> Figure:
    """Surfaces of equal equivalent plastic strain, cut open at the plane through the largest strain.

    The half behind that plane, normal to y, z downwards, equal scales.

    Parameters
    ----------
    field : CellField
        The strain of one body.
    """
    from matplotlib import colormaps
    from matplotlib.colors import LightSource
    from matplotlib.patches import Patch
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    top, at = field.largest
    length = scale_for([float(np.abs(places).max()) for places in field.axes.values()], "m")
    with paper_style():
        figure = new_figure(5.0, 3.8)
        axes: Any = figure.add_subplot(projection="3d")
        corners, legend = [], []
        for share, opacity in SHARES:
            triangles = surface_of(field, share * top, at["y"])
            if not triangles.size:
                continue
            colour = colormaps["viridis"](0.1 + 0.85 * share)
            light = LightSource(azdeg=225, altdeg=50)
            faces = Poly3DCollection(
                length(triangles),
                facecolors=colour,
                edgecolors=colour,
                linewidths=0,
                alpha=opacity,
                shade=True,
                lightsource=light,
            )
            axes.add_collection3d(faces)
            corners.append(triangles.reshape(-1, 3))
            legend.append(Patch(facecolor=colour, label=f"{PERCENT * share * top:.2g} %"))
        ends = np.concatenate(corners)
        low, high = length(ends.min(axis=0)), length(ends.max(axis=0))
        low[2] = 0.0
        axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(high[2], low[2]))
        axes.set_box_aspect(high - low, zoom=0.85)
        axes.view_init(elev=24, azim=-68)
        for axis in "xyz":
            getattr(axes, f"set_{axis}label")(f"{axis} [{length.unit}]")
            getattr(axes, f"{axis}axis").get_major_locator().set_params(nbins=4 if axis == "y" else 5)
        axes.set_title(heading(dataset, step, f"Equal plastic strain in body {field.body}"))
        figure.legend(handles=legend, loc="outside right upper", title="equivalent\nplastic strain", title_fontsize=8)
    return figure


def surface_of(field: CellField, value: float, y: float) -> NDArray[Any]:
    """Triangles ``(n, 3, 3)`` [m] of the surface of a value, behind a plane normal to y."""
    import pyvista as pv

    values = np.pad(field.values, 1)
    if field.axes["z"][0] < 0.75 * field.edge("z"):  # up to the surface
        values[0] = values[1]
    axes = {axis: np.pad(places, 1) for axis, places in field.axes.items()}
    for axis, places in axes.items():
        places[0], places[-1] = places[1] - field.edge(axis), places[-2] + field.edge(axis)
    axes["z"][0] = max(axes["z"][0], 0.0)
    edge = max(field.edge(axis) for axis in "xyz")  # lengths of micrometres are too small for the filters
    grid: Any = pv.RectilinearGrid(*(axes[axis] / edge for axis in "xyz"))
    grid.point_data["strain"] = values.ravel()
    mesh = grid.contour([value], scalars="strain")
    if mesh.n_points:
        mesh = mesh.clip("-y", origin=(0.0, y / edge, 0.0)).triangulate()
    if not mesh.n_points:
        return np.empty((0, 3, 3))
    faces = np.asarray(mesh.faces).reshape(-1, 4)[:, 1:]
    return np.asarray(np.asarray(mesh.points, dtype=float)[faces] * edge)
