"""The coarse mesh in space, cut open, with its field."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.crosscheck.pictures.subject import (
    MAP,
    OUTLINE_COLOUR,
    OUTLINE_SAMPLES,
    Subject,
    elements_in_words,
    outline,
)

__all__ = ["Body", "block", "draw_space", "revolved"]

FloatArray = NDArray[np.float64]

#: Largest drawn displacement in the longest extent of the source.
_WARP = 0.1
_PIXELS = (1800, 1500)


@dataclass(frozen=True, kw_only=True)
class Body:
    """Faces of the shown part of the body with the displacement at their corners, and the edges of elements on them.

    Attributes
    ----------
    faces, edges : pyvista.PolyData
        With point data ``u``.
    cuts : tuple of (int, int)
        Open cuts: axis that is normal to it, and the sign of the part of the plane that can be seen (0: both).
    low, high : (3,) arrays
        Corners.
    """

    faces: Any
    edges: Any
    cuts: tuple[tuple[int, int], ...]
    low: FloatArray
    high: FloatArray


def block(subject: Subject, solution: Any) -> Body:
    """Hexahedra near the source; of a model of both sides, without the quarter at negative x and y."""
    import pyvista as pv

    grid, (low, high) = solution.grid, subject.window
    spans = []
    for line, a, b in zip(grid.lines, low, high, strict=True):
        first, last = (int(np.argmin(np.abs(line - end))) for end in (a, b))
        spans.append(slice(first, last + 1))
    x, y, z = (line[span] for line, span in zip(grid.lines, spans, strict=True))
    block = pv.RectilinearGrid(x, y, z)
    counts = [axis.size for axis in grid.axes[::-1]]
    step = slice(None, None, grid.order)
    nodal = solution.nodal.reshape(*counts, 3)[step, step, step]
    block.point_data["u"] = nodal[spans[2], spans[1], spans[0]].reshape(-1, 3)
    cuts = ((1, 1), (0, 1)) if x[0] == 0 and y[0] == 0 else ((1, 0),) if y[0] == 0 else ((0, 0),)
    shown = block.cast_to_unstructured_grid()
    if x[0] < 0 and y[0] < 0:
        centres = shown.cell_centers().points
        shown, cuts = shown.extract_cells(~((centres[:, 0] < 0) & (centres[:, 1] < 0))), ((1, -1), (0, -1))
    faces = shown.extract_surface(algorithm="dataset_surface", pass_pointid=False, pass_cellid=False)
    corners = np.array([[x[0], y[0], z[0]], [x[-1], y[-1], z[-1]]])
    return Body(faces=faces, edges=faces.extract_all_edges(), cuts=cuts, low=corners[0], high=corners[1])


def revolved(subject: Subject, solution: Any) -> Body:
    """Half section turned about the axis, without the quarter at negative x and y."""
    import pyvista as pv

    _, high = subject.window
    scalar = solution.basis.mesh.dofs.element_dofs
    places = solution.basis.mesh.doflocs.T
    u = np.zeros_like(places)
    for axis in (0, 1):
        u[scalar, axis] = solution.vector[solution.basis.dofs.element_dofs[axis::2]]
    low = places[scalar].min(axis=0)  # a row of elements that only begins in the window is shown whole
    cells = scalar[:, np.all(low < high[[0, 2]] * (1 - 1e-9), axis=1)].T
    # edges of the shown part that do not meet a second element are its top, its rim, its bottom and the axis
    quads = cells[:, [[0, 4, 8, 7], [4, 1, 5, 8], [8, 5, 2, 6], [7, 8, 6, 3]]].reshape(-1, 4)
    borders = cells[:, [[0, 4, 1], [1, 5, 2], [2, 6, 3], [3, 7, 0]]].reshape(-1, 3)
    names, counts = np.unique(borders[:, 1], return_counts=True)
    rim = borders[np.isin(borders[:, 1], names[counts == 1])]
    rim = rim[np.any(places[rim, 0] > 0, axis=1)]

    def turned(points: FloatArray, angle: float) -> FloatArray:
        return np.stack([points[:, 0] * np.cos(angle), points[:, 0] * np.sin(angle), points[:, 1]], axis=1)

    def poly(nodes: NDArray[np.int64], angle: float, *, lines: bool = False) -> Any:
        used, flat = np.unique(nodes, return_inverse=True)
        flat = flat.reshape(nodes.shape)
        entries = np.insert(flat, 0, nodes.shape[1], axis=1).ravel()
        surface = pv.PolyData(turned(places[used], angle), **{"lines" if lines else "faces": entries})
        surface.point_data["u"] = turned(u[used], angle)
        return surface

    angles = np.linspace(-np.pi / 2, np.pi, 109)
    surfaces = [poly(quads, angles[0]), poly(quads, angles[-1])]
    strips = np.concatenate([rim[:, :2], rim[:, 1:]])
    used, flat = np.unique(strips, return_inverse=True)
    flat = flat.reshape(strips.shape)
    count = used.size
    rings = [flat + k * count for k in range(angles.size)]
    entries = np.concatenate([np.column_stack([a, b[:, ::-1]]) for a, b in pairwise(rings)])
    skin = pv.PolyData(
        np.concatenate([turned(places[used], angle) for angle in angles]),
        faces=np.insert(entries, 0, 4, axis=1).ravel(),
    )
    skin.point_data["u"] = np.concatenate([turned(u[used], angle) for angle in angles])
    edges = pv.merge([poly(borders, angle, lines=True) for angle in (angles[0], angles[-1])], merge_points=False)
    reach = places[cells].reshape(-1, 2).max(axis=0)
    return Body(
        faces=pv.merge([*surfaces, skin], merge_points=False),
        edges=edges,
        cuts=((1, -1), (0, -1)),
        low=np.array([-reach[0], -reach[0], 0.0]),
        high=np.array([reach[0], reach[0], reach[1]]),
    )


def _outlines(subject: Subject, body: Body) -> Iterator[FloatArray]:
    """Outlines of the source on the cuts and, where it touches it, on the surface."""
    margin = 0.06 * subject.size
    low, high = np.maximum(subject.low - margin, body.low), np.minimum(subject.high + margin, body.high)
    quarter_gone = body.cuts[0][1] < 0
    for normal, sign in (*body.cuts, (2, 0)):
        sides = [np.linspace(low[axis], high[axis], OUTLINE_SAMPLES) for axis in range(3) if axis != normal]
        if normal != 2 and sign:
            sides[0] = sides[0][sides[0] * sign >= 0]
        for line in outline(subject.contains, normal, 1e-6 * subject.size if normal == 2 else 0.0, sides):
            gone = (line[:, 0] < 0) & (line[:, 1] < 0) if normal == 2 and quarter_gone else np.zeros(len(line), bool)
            curves = np.split(line, np.flatnonzero(gone[1:] != gone[:-1]) + 1)
            yield from (curve for curve in curves if len(curve) > 1 and not (quarter_gone and (curve[0, :2] < 0).all()))


def draw_space(subject: Subject, solution: Any, body: Body, file: Path) -> None:
    """The cut body in space, coloured by the magnitude of displacement, moved along with it."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    from eigencontact.viz.style import new_figure, paper_style

    largest = float(np.linalg.norm(body.faces.point_data["u"], axis=1).max())
    warp = float(f"{_WARP * subject.size / largest:.0e}")
    image, labels = _rendered(subject, solution, body, largest, warp)
    rows, columns = (np.flatnonzero((image.min(axis=2) < 250).any(axis=side)) for side in (1, 0))
    pad = 0.07 * len(rows)
    width, height = columns[-1] - columns[0] + 8 * pad, rows[-1] - rows[0] + 3 * pad
    middle = np.array([columns.mean(), rows.mean()])
    with paper_style():
        figure = new_figure(max(5.0, 3.9 * width / height + 0.9), 4.6)
        axes = figure.subplots()
        axes.imshow(image, interpolation="antialiased")
        axes.set_xlim(columns[0] - 4 * pad, columns[-1] + 4 * pad)
        axes.set_ylim(rows[-1] + 2 * pad, rows[0] - pad)
        axes.set_axis_off()
        for text, at in labels.items():
            below, left = text.startswith("z"), at[0] < middle[0]
            beside = columns[0] - 0.5 * pad if left else columns[-1] + 0.5 * pad
            place = (float(at[0]), rows[-1] + 0.5 * pad) if below else (float(beside), float(at[1]))
            axes.annotate(
                text, (float(at[0]), float(at[1])), xytext=place, fontsize=8.5, annotation_clip=False,
                ha="center" if below else "right" if left else "left", va="top" if below else "center",
                arrowprops={"arrowstyle": "-", "color": "0.6", "linewidth": 0.7, "shrinkA": 1, "shrinkB": 1},
            )  # fmt: skip
        bar = figure.colorbar(ScalarMappable(Normalize(0.0, largest), MAP), ax=axes, shrink=0.6, aspect=22, pad=0.02)
        bar.set_label(f"displacement |u| [{subject.displacement}]")
        notes = f"displacement drawn × {warp:g}; unit of length: {subject.length}"
        figure.suptitle(f"{subject.case.words}\n{elements_in_words(solution)}, cut open\n{notes}", fontsize=8.5)
        figure.savefig(file, dpi=200)


def _rendered(
    subject: Subject, solution: Any, body: Body, largest: float, warp: float
) -> tuple[NDArray[np.uint8], dict[str, FloatArray]]:
    """Picture without any text, and where (column, row) the labels of three of its corners belong."""
    import pyvista as pv

    for mesh in (body.faces, body.edges):
        mesh.point_data["size"] = np.linalg.norm(mesh.point_data["u"], axis=1)
        mesh.points = mesh.points + warp * mesh.point_data["u"]
    towards = np.array([-0.62, -1.0, -0.72])
    lift = 4e-3 * subject.size * towards  # lines lie on faces; a little in front of them they are seen
    middle, span = (body.low + body.high) / 2, float(np.linalg.norm(body.high - body.low))
    plotter = pv.Plotter(off_screen=True, window_size=list(_PIXELS))
    try:
        plotter.set_background("white")
        plotter.add_mesh(
            body.faces, scalars="size", cmap=MAP, clim=(0.0, largest), show_scalar_bar=False, ambient=0.7,
            diffuse=0.35, specular=0.0,
        )  # fmt: skip
        plotter.add_mesh(body.edges.translate(lift), color="white", line_width=1.8, opacity=0.45, lighting=False)
        for line in _outlines(subject, body):
            moved = line + warp * solution.displacement(line) + 3 * lift
            plotter.add_mesh(pv.lines_from_points(moved), color=OUTLINE_COLOUR, line_width=7, lighting=False)
        plotter.camera_position = [tuple(middle + 3 * span * towards), tuple(middle), (0.0, 0.0, -1.0)]
        plotter.enable_parallel_projection()
        plotter.camera.parallel_scale = 0.5 * span
        plotter.enable_anti_aliasing("ssaa")
        image = np.asarray(plotter.screenshot(return_img=True))
        labels = {text: _projected(plotter, at, len(image)) for text, at in _ends(body).items()}
    finally:
        plotter.close()
    return image, labels


def _ends(body: Body) -> dict[str, FloatArray]:
    """Labels of the far ends of the three edges that meet where the camera looks."""
    (x0, y0, _), (x1, y1, z1) = body.low, body.high
    if body.cuts[0][1] < 0:  # the edges of the cuts
        return {
            f"x = −{-x0:.3g}": np.array([x0, 0.0, 0.0]),
            f"y = −{-y0:.3g}": np.array([0.0, y0, 0.0]),
            f"z = {z1:.3g}": np.array([0.0, 0.0, z1]),
        }
    return {
        f"x = {x1:.3g}": np.array([x1, y0, 0.0]),
        f"y = {y1:.3g}": np.array([x0, y1, 0.0]),
        f"z = {z1:.3g}": np.array([x0, y0, z1]),
    }


def _projected(plotter: Any, at: FloatArray, rows: int) -> FloatArray:
    """Pixel (column, row) of a point in space."""
    renderer = plotter.renderer
    renderer.SetWorldPoint(*at, 1.0)
    renderer.WorldToDisplay()
    x, y, _ = renderer.GetDisplayPoint()
    return np.array([x, rows - y])
