"""What a case looks like: its semi-analytical line drawn closely, its coarse mesh in space, its field in a section.

Nothing here decides a verdict, so that the text of this module is no part of the hash of stored solutions.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from eigencontact_verification.campaign.case import Case, Curve, Profile, Quantity
    from eigencontact_verification.campaign.inclusions import InclusionCase
    from eigencontact_verification.campaign.lines import Contains
    from eigencontact_verification.campaign.tractions import RectangleCase

__all__ = ["curve", "inclusion_pictures", "rectangle_pictures"]

FloatArray = NDArray[np.float64]
Field = Callable[[FloatArray, "Quantity"], FloatArray]

#: Points of a drawn line for each point that is compared.
_CLOSER = 8
#: How much of the body is shown on each side of the source, and largest drawn displacement, in its longest extent.
_AROUND, _WARP = 1.0, 0.1
#: Samples across the shown part: of the outline, and of the section by closed forms or by so many cells.
_OUTLINE, _SAMPLES, _SAMPLES_CUT, _CELLS = 400, 120, 40, 8
#: Colours end where this part of the section is below: stress is infinite at edges.
_BRIGHTEST = 0.995
_MAP, _MAP_ERROR = "viridis", "cividis"
#: Vermilion stands out of both maps.
_OUTLINE_COLOUR = "#D55E00"
_PIXELS = (1800, 1500)


def curve(profile: Profile, field: Field, contains: Contains | None = None) -> Curve:
    """Values closely along the straight line of a profile, through what its points leave out.

    Parameters
    ----------
    profile : Profile
        A straight line.
    field : callable
        ``field(points, quantity)``.
    contains : callable, optional
        The source; a line of stress breaks at its boundary.

    Returns
    -------
    (n,), (n, components) arrays
    """
    from eigencontact_verification.campaign.lines import chosen

    order = np.argsort(profile.along, kind="stable")
    along = np.linspace(profile.along[order[0]], profile.along[order[-1]], _CLOSER * max(len(order), 25) + 1)
    points = np.stack(
        [np.interp(along, profile.along[order], profile.points[order, axis]) for axis in range(3)], axis=1
    )
    with np.errstate(all="ignore"):
        values = chosen(field(points, profile.quantity), profile)
    if contains is not None and profile.quantity == "stress":
        state = np.asarray(contains(*points.T))
        jumps = np.flatnonzero(state[1:] != state[:-1]) + 1
        along = np.insert(along, jumps, (along[jumps] + along[jumps - 1]) / 2)
        values = np.insert(values, jumps, np.nan, axis=0)
    return along, values


@dataclass(frozen=True, kw_only=True)
class _Subject:
    """What the pictures of a case need.

    Attributes
    ----------
    contains : callable
        The source; of a traction a thin slab at the surface.
    low, high : (3,) arrays
        Its bounds.
    length, displacement, stress : str
        Units.
    field : callable
        Semi-analytical field.
    samples : int
        Samples of the section across the shown part.
    """

    case: Case
    contains: Contains
    low: FloatArray
    high: FloatArray
    length: str
    displacement: str
    stress: str
    field: Field
    samples: int

    @property
    def size(self) -> float:
        """Longest extent of the source."""
        return float(np.max(self.high - self.low))

    @property
    def window(self) -> tuple[FloatArray, FloatArray]:
        """Corners of the part of the body that is shown; it begins at the surface."""
        low, high = self.low - _AROUND * self.size, self.high + _AROUND * self.size
        low[2] = 0.0
        return low, high


def _subject(case: Case, contains: Contains, bounds: Sequence[Sequence[float]], field: Field, samples: int) -> _Subject:
    units = {profile.quantity: profile.unit for profile in case.profiles}
    return _Subject(
        case=case,
        contains=contains,
        low=np.asarray(bounds[0], dtype=float),
        high=np.asarray(bounds[1], dtype=float),
        length=case.profiles[0].label.rpartition("[")[2].rstrip("]"),
        displacement=units["displacement"],
        stress=units["stress"],
        field=field,
        samples=samples,
    )


def inclusion_pictures(case: InclusionCase, folder: Path) -> tuple[Path, ...]:
    """Write mesh.vtu, mesh.png and section.png of an inclusion's coarse model."""
    from eigencontact_verification.campaign.inclusions import shape_of

    shape = shape_of(case.parameters["shape"])
    field, samples = case.field, _SAMPLES
    if case.parameters["cut"]:  # a picture needs fewer cells than a verdict
        field, samples = partial(case.field, cells=_CELLS), _SAMPLES_CUT
    subject = _subject(case, shape.contains, shape.bounds, field, samples)
    if case.parameters["elements"] == "axisymmetric":
        from eigencontact_verification.fem.axisymmetric import solve_axisymmetric

        return _pictures(subject, solve_axisymmetric(case.axisymmetric_model(0, "fixed")), _revolved, folder)
    from eigencontact_verification.fem.solve import solve

    return _pictures(subject, solve(case.solid_model(0, "fixed")), _block, folder)


def rectangle_pictures(case: RectangleCase, folder: Path) -> tuple[Path, ...]:
    """Write mesh.vtu, mesh.png and section.png of a traction's coarse model."""
    from eigencontact_verification.fem.solve import solve

    a, b = case.parameters["half_widths"]
    thin = 1e-3 * min(a, b)

    def loaded(x: FloatArray, y: FloatArray, z: FloatArray) -> NDArray[np.bool_]:
        return np.asarray((np.abs(x) <= a) & (np.abs(y) <= b) & (np.abs(z) <= thin))

    subject = _subject(case, loaded, ((-a, -b, 0.0), (a, b, thin)), case.field, _SAMPLES)
    return _pictures(subject, solve(case.model(0, reach=case.parameters["reach"])), _block, folder)


def _pictures(subject: _Subject, solution: Any, body: Callable[..., _Body], folder: Path) -> tuple[Path, ...]:
    folder.mkdir(parents=True, exist_ok=True)
    files = folder / "mesh.vtu", folder / "section.png", folder / "mesh.png"
    solution.write_vtu(files[0])
    _section(subject, solution, files[1])
    try:
        _space(subject, solution, body(subject, solution), files[2])
    except Exception as problem:  # not every machine can render
        raise RuntimeError(f"mesh.png could not be drawn ({problem}); mesh.vtu and section.png were") from problem
    return files


@dataclass(frozen=True, kw_only=True)
class _Body:
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


def _block(subject: _Subject, solution: Any) -> _Body:
    """Hexahedra near the source; of a model of both sides, without the quarter at negative x and y."""
    import pyvista as pv

    grid, (low, high) = solution.grid, subject.window
    kept = []
    for line, a, b in zip(grid.lines, low, high, strict=True):
        first, last = (int(np.argmin(np.abs(line - end))) for end in (a, b))
        kept.append(slice(first, last + 1))
    x, y, z = (line[part] for line, part in zip(grid.lines, kept, strict=True))
    block = pv.RectilinearGrid(x, y, z)
    counts = [axis.size for axis in grid.axes[::-1]]
    step = slice(None, None, grid.order)
    nodal = solution.nodal.reshape(*counts, 3)[step, step, step]
    block.point_data["u"] = nodal[kept[2], kept[1], kept[0]].reshape(-1, 3)
    cuts = ((1, 1), (0, 1)) if x[0] == 0 and y[0] == 0 else ((1, 0),) if y[0] == 0 else ((0, 0),)
    shown = block.cast_to_unstructured_grid()
    if x[0] < 0 and y[0] < 0:
        centres = shown.cell_centers().points
        shown, cuts = shown.extract_cells(~((centres[:, 0] < 0) & (centres[:, 1] < 0))), ((1, -1), (0, -1))
    faces = shown.extract_surface(algorithm="dataset_surface", pass_pointid=False, pass_cellid=False)
    corners = np.array([[x[0], y[0], z[0]], [x[-1], y[-1], z[-1]]])
    return _Body(faces=faces, edges=faces.extract_all_edges(), cuts=cuts, low=corners[0], high=corners[1])


def _revolved(subject: _Subject, solution: Any) -> _Body:
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
        made = pv.PolyData(turned(places[used], angle), **{"lines" if lines else "faces": entries})
        made.point_data["u"] = turned(u[used], angle)
        return made

    angles = np.linspace(-np.pi / 2, np.pi, 109)
    parts = [poly(quads, angles[0]), poly(quads, angles[-1])]
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
    return _Body(
        faces=pv.merge([*parts, skin], merge_points=False),
        edges=edges,
        cuts=((1, -1), (0, -1)),
        low=np.array([-reach[0], -reach[0], 0.0]),
        high=np.array([reach[0], reach[0], reach[1]]),
    )


def _outline(contains: Contains, normal: int, at: float, sides: Sequence[FloatArray]) -> list[FloatArray]:
    """Where the boundary of the source meets a plane, as lines ``(n, 3)``; `sides` are samples along the other axes."""
    from contourpy import contour_generator
    from scipy.ndimage import gaussian_filter

    s, t = np.meshgrid(*sides)
    place: list[FloatArray] = [s, t]
    place.insert(normal, np.full_like(s, at))
    inside = np.asarray(contains(*place), dtype=float)
    if inside.max() == inside.min():
        return []
    smooth = gaussian_filter(inside, 1.5, mode="nearest")  # a line without the steps of the samples
    lines = contour_generator(x=sides[0], y=sides[1], z=smooth).lines(0.5)
    return [np.insert(np.asarray(line), normal, at, axis=1) for line in lines if len(np.asarray(line)) > 1]


def _outlines(subject: _Subject, body: _Body) -> Iterator[FloatArray]:
    """Outlines of the source on the cuts and, where it touches it, on the surface."""
    margin = 0.06 * subject.size
    low, high = np.maximum(subject.low - margin, body.low), np.minimum(subject.high + margin, body.high)
    quarter_gone = body.cuts[0][1] < 0
    for normal, sign in (*body.cuts, (2, 0)):
        sides = [np.linspace(low[axis], high[axis], _OUTLINE) for axis in range(3) if axis != normal]
        if normal != 2 and sign:
            sides[0] = sides[0][sides[0] * sign >= 0]
        for line in _outline(subject.contains, normal, 1e-6 * subject.size if normal == 2 else 0.0, sides):
            gone = (line[:, 0] < 0) & (line[:, 1] < 0) if normal == 2 and quarter_gone else np.zeros(len(line), bool)
            parts = np.split(line, np.flatnonzero(gone[1:] != gone[:-1]) + 1)
            yield from (part for part in parts if len(part) > 1 and not (quarter_gone and (part[0, :2] < 0).all()))


def _space(subject: _Subject, solution: Any, body: _Body, file: Path) -> None:
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
        bar = figure.colorbar(ScalarMappable(Normalize(0.0, largest), _MAP), ax=axes, shrink=0.6, aspect=22, pad=0.02)
        bar.set_label(f"displacement |u| [{subject.displacement}]")
        notes = f"displacement drawn × {warp:g}; unit of length: {subject.length}"
        figure.suptitle(f"{subject.case.words}\n{_elements(solution)}, cut open\n{notes}", fontsize=8.5)
        figure.savefig(file, dpi=200)


def _rendered(
    subject: _Subject, solution: Any, body: _Body, largest: float, warp: float
) -> tuple[NDArray[np.uint8], dict[str, FloatArray]]:
    """Picture without any text, and where (column, row) the labels of three of its corners belong."""
    import pyvista as pv

    for part in (body.faces, body.edges):
        part.point_data["size"] = np.linalg.norm(part.point_data["u"], axis=1)
        part.points = part.points + warp * part.point_data["u"]
    towards = np.array([-0.62, -1.0, -0.72])
    lift = 4e-3 * subject.size * towards  # lines lie on faces; a little in front of them they are seen
    middle, span = (body.low + body.high) / 2, float(np.linalg.norm(body.high - body.low))
    plotter = pv.Plotter(off_screen=True, window_size=list(_PIXELS))
    try:
        plotter.set_background("white")
        plotter.add_mesh(
            body.faces, scalars="size", cmap=_MAP, clim=(0.0, largest), show_scalar_bar=False, ambient=0.7,
            diffuse=0.35, specular=0.0,
        )  # fmt: skip
        plotter.add_mesh(body.edges.translate(lift), color="white", line_width=1.8, opacity=0.45, lighting=False)
        for line in _outlines(subject, body):
            moved = line + warp * solution.displacement(line) + 3 * lift
            plotter.add_mesh(pv.lines_from_points(moved), color=_OUTLINE_COLOUR, line_width=7, lighting=False)
        plotter.camera_position = [tuple(middle + 3 * span * towards), tuple(middle), (0.0, 0.0, -1.0)]
        plotter.enable_parallel_projection()
        plotter.camera.parallel_scale = 0.5 * span
        plotter.enable_anti_aliasing("ssaa")
        image = np.asarray(plotter.screenshot(return_img=True))
        labels = {text: _projected(plotter, at, len(image)) for text, at in _ends(body).items()}
    finally:
        plotter.close()
    return image, labels


def _ends(body: _Body) -> dict[str, FloatArray]:
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


def _elements(solution: Any) -> str:
    """The mesh in words."""
    if hasattr(solution, "nodal"):
        return f"coarse mesh of {solution.grid.elements} hexahedra"
    return f"coarse mesh of {solution.basis.mesh.nelements} axisymmetric elements"


def _von_mises(stress: FloatArray) -> FloatArray:
    deviator = stress - np.trace(stress, axis1=-2, axis2=-1)[..., None, None] / 3 * np.eye(3)
    return np.asarray(np.sqrt(1.5 * np.einsum("...ij,...ij->...", deviator, deviator)))


def _section(subject: _Subject, solution: Any, file: Path) -> None:
    """Von Mises stress in the plane y = 0: elements at x < 0, closed forms at x > 0; and their difference at x > 0."""
    from eigencontact.viz.style import label_plane, new_figure, paper_style

    _, (wide, _, deep) = subject.window
    cell = wide / subject.samples
    x, z = (np.arange(subject.samples) + 0.5) * cell, (np.arange(int(np.ceil(deep / cell))) + 0.5) * cell
    points = np.stack([np.tile(x, z.size), np.zeros(x.size * z.size), np.repeat(z, x.size)], axis=1)
    with np.errstate(all="ignore"):
        closed = _von_mises(subject.field(points, "stress")).reshape(z.size, x.size)
    left, right = (_von_mises(solution.stress(points * [s, 1, 1])).reshape(closed.shape) for s in (-1.0, 1.0))
    top = float(np.nanquantile(closed, _BRIGHTEST))
    error = 100 * np.abs(right - closed) / top
    worst = max(1.0, float(np.nanquantile(error, 0.98)))
    across, down = cell * np.arange(x.size + 1), cell * np.arange(z.size + 1)
    scale = min(3.0 / deep, 2.2 / wide)  # inch a unit of length
    with paper_style():
        figure = new_figure(3 * wide * scale + 2.9, deep * scale + 1.35)
        whole, half = figure.subplots(1, 2, width_ratios=(2, 1.05))
        looks = {"cmap": _MAP, "vmin": 0.0, "vmax": top, "rasterized": True}
        whole.pcolormesh(-across[::-1], down, left[:, ::-1], **looks)
        stress = whole.pcolormesh(across, down, closed, **looks)
        wrong = half.pcolormesh(across, down, error, cmap=_MAP_ERROR, vmin=0.0, vmax=worst, rasterized=True)
        whole.axvline(0.0, color="white", linewidth=1.0)
        for axes, low in ((whole, -wide), (half, 0.0)):
            sides = [np.linspace(low, wide, 2 * _OUTLINE), np.linspace(0.0, deep, 2 * _OUTLINE)]
            for line in _outline(subject.contains, 1, 0.0, sides):
                axes.plot(line[:, 0], line[:, 2], color=_OUTLINE_COLOUR, linewidth=1.2)
            if subject.high[2] - subject.low[2] < 0.1 * cell:  # a traction
                ends = [max(low, float(subject.low[0])), float(subject.high[0])]
                axes.plot(ends, [0.0, 0.0], color=_OUTLINE_COLOUR, linewidth=4.0, clip_on=False)
            axes.set_aspect("equal")
            axes.set_xlim(low, wide)
            axes.set_ylim(deep, 0.0)
            label_plane(axes, f"x [{subject.length}]", f"z [{subject.length}]")
        cells = f", {_CELLS} cells across" if subject.samples == _SAMPLES_CUT else ""
        whole.set_title(f"finite elements   |   semi-analytical{cells}")
        half.set_title("their difference")
        for axes, shown, inches, words in (
            (whole, stress, 2 * wide * scale, f"von Mises stress [{subject.stress}]"),
            (half, wrong, wide * scale, f"[% of {top:.3g} {subject.stress}]"),
        ):
            beside = axes.inset_axes((1 + 0.1 / inches, 0.0, 0.12 / inches, 1.0))
            figure.colorbar(shown, cax=beside, label=words, extend="max")
        figure.suptitle(f"{subject.case.words}\n{_elements(solution)}, plane y = 0", fontsize=8.5)
        figure.savefig(file, dpi=200)
