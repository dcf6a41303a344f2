"""Stored points that are compared: lines on the surface, and through the stored regions of stress."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.audit.bodies import AuditedBody
from eigencontact_verification.audit.stored import StoredRegion, StoredStep
from eigencontact_verification.crosscheck.case import Gap, Profile
from eigencontact_verification.crosscheck.lines import STRESSES

__all__ = ["Line", "Middle", "judged_points", "middle_of", "spread", "stress_lines", "surface_lines"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.intp]
Base = Callable[[FloatArray], FloatArray]

#: Most points of a line inside what is loaded, outside, and on a line below the surface.
_INSIDE, _OUTSIDE, _BELOW = 20, 16, 24
#: Fewest points of a line that is compared.
_FEWEST = 3
#: Depth in cells of the surface above which the steps of the tractions are felt.
_SHALLOW = 1.5
#: Distance from a face, in cells, across which what cells remember jumps.
_FACE = 0.1
#: Cells from an interface that cells cut, within which their steps are felt: in the ball of 'inclusion-under-contact'
#: the stored stress is off by 0.7 % of its largest value at 1.5 cells, 0.3 % at 2.3, 0.1 % at 3.4.
_CUT = 3
#: Distance from the boundary of a region in closed form, in its size.
_RIM = 0.05


@dataclass(frozen=True, kw_only=True, eq=False)
class Line:
    """Stored values along a line.

    Attributes
    ----------
    profile : Profile
        Where.
    body : int
        1 or 2; 0 on the surface, where both bodies add up.
    values : (n, components) float64
        As stored.
    slopes : (3, n, components) float64
        Size of their derivatives along x, y and z where these are axes of what is stored; of stress less that of a
        homogeneous half-space.
    indices : tuple of IntArray
        Places in the stored array.
    """

    profile: Profile
    body: int
    values: FloatArray
    slopes: FloatArray
    indices: tuple[IntArray, ...]


@dataclass(frozen=True, kw_only=True)
class Middle:
    """Centre of the lines: middle of the load, or of the largest displacement; and its half widths [m]."""

    x: float
    y: float
    half: tuple[float, float]
    loaded: bool


def middle_of(stored: StoredStep) -> Middle:
    """Centre of pressure with the half widths of what is loaded; without load, of what sinks or rises most."""
    x, y = stored.window.x, stored.window.y
    field = np.zeros((y.size, x.size))
    for name in ("pressure", "shear_x", "shear_y"):
        if name in stored.surface:
            field = field + np.abs(np.nan_to_num(stored.surface[name]))
    loaded = bool(np.any(field))
    if not loaded:
        names = [name for name in stored.surface if "displacement" in name]
        field = sum((np.abs(np.nan_to_num(stored.surface[name])) for name in names), field)
        field = np.where(field > 0.7 * field.max(), field, 0.0)
    if not np.any(field):
        field = np.ones_like(field)
    rows, columns = np.nonzero(field)
    at = [float(np.average(line[index], weights=field[rows, columns])) for line, index in ((x, columns), (y, rows))]
    spans = ((x, columns, stored.window.cell[0]), (y, rows, stored.window.cell[1]))
    half = [0.5 * float(np.ptp(line[index]) + size) for line, index, size in spans]
    return Middle(x=at[0], y=at[1], half=(half[0], half[1]), loaded=loaded)


def spread(indices: IntArray, most: int) -> IntArray:
    """At most so many of ascending indices, evenly."""
    if indices.size <= most:
        return indices
    return np.asarray(indices[np.unique(np.linspace(0, indices.size - 1, most).round().astype(int))])


def surface_lines(stored: StoredStep, middle: Middle) -> list[Line]:
    """Displacement of the surface on lines along x and y through the middle, inside and outside of what is loaded."""
    contact = "displacement_z" in stored.surface
    names = [f"{'' if contact else 'residual_'}displacement_{axis}" for axis in "xyz"]
    names = [name for name in names if name in stored.surface]
    if not names:
        return []
    x, y = stored.window.x, stored.window.y
    lines = []
    for axis, (line, centre, half) in enumerate(((x, middle.x, middle.half[0]), (y, middle.y, middle.half[1]))):
        across, through = ((y, middle.y), (x, middle.x))[axis]
        fixed = int(np.argmin(np.abs(across - through)))
        near = np.abs(line - centre) <= half
        along = np.sort(
            np.concatenate([spread(np.flatnonzero(near), _INSIDE), spread(np.flatnonzero(~near), _OUTSIDE)])
        )
        at = (np.full(along.size, fixed), along) if axis == 0 else (along, np.full(along.size, fixed))
        values = np.stack([_whole(stored, name)[at] for name in names], axis=-1)
        slopes = np.zeros((3, *values.shape))
        for k, name in enumerate(names):
            residual = stored.surface.get(f"residual_{name.removeprefix('residual_')}")
            if residual is not None:
                for way, size in enumerate(stored.window.cell):
                    slopes[way, :, k] = np.abs(np.gradient(residual, size, axis=-1 - way))[at]
        points = np.stack([x[at[1]], y[at[0]], np.zeros(along.size)], axis=-1)
        profile = Profile(
            name=f"surface along {'xy'[axis]}", quantity="displacement", points=points, along=line[along],
            label=f"{'xy'[axis]} [m]", components=tuple(f"u_{name[-1]}" for name in names), unit="m",
        )  # fmt: skip
        lines.append(Line(profile=profile, body=0, values=values, slopes=slopes, indices=at))
    return lines


def _whole(stored: StoredStep, name: str) -> FloatArray:
    """Displacement by tractions and by eigenstrain together, which a contact stores apart."""
    residual = stored.surface.get(f"residual_{name}", 0.0)
    return np.asarray(stored.surface[name] + residual)


# --- stress -----------------------------------------------------------------------------------------------------------


def stress_lines(
    stored: StoredStep, bodies: Sequence[AuditedBody], middle: Middle, bases: Mapping[int, Base]
) -> tuple[list[Line], list[Gap]]:
    """Stress on lines through the stored regions, and what of it cannot be judged.

    `bases` gives, for bodies whose cells are an approximation, the stress ``(n, 6)`` without what they change.
    """
    lines, gaps = [], []
    numbers = {body.number: body for body in bodies}
    if not stored.regions:
        gaps.append(Gap(subject=stored.name, what="stress", reason="the scene requests no stress region"))
    for region in stored.regions:
        if region.body not in numbers:
            continue  # a gap says why there is no such body
        body = numbers[region.body]
        fit, reasons = judged_points(stored, region, body, middle)
        gaps += [Gap(subject=stored.name, what=f"stress in '{region.name}'", reason=text) for text in reasons]
        strained = _strained(body, region.points)
        ways = [(way, yielded) for way in _through(region, body, middle) for yielded in (False, True)]
        for (words, indices, abscissa, label), yielded in ways:
            judged = fit[indices] & (strained[indices] == yielded)
            if np.count_nonzero(judged) < _FEWEST:
                continue
            at, along = _thinned(tuple(index[judged] for index in indices), abscissa[judged])
            name = f"{region.name}, {words}" + (", in what has yielded" if yielded else "")
            profile = Profile(
                name=name, quantity="stress", points=_off_interfaces(region.points[at], body),
                along=along, label=label, components=STRESSES, unit="Pa",
            )  # fmt: skip
            slopes = _slopes(region, at, bases.get(region.body))
            lines.append(Line(profile=profile, body=region.body, values=region.stress[at], slopes=slopes, indices=at))
    return lines, gaps


def _thinned(at: tuple[IntArray, ...], along: FloatArray) -> tuple[tuple[IntArray, ...], FloatArray]:
    chosen = spread(np.arange(along.size), _BELOW)
    return tuple(index[chosen] for index in at), along[chosen]


def _off_interfaces(points: FloatArray, body: AuditedBody) -> FloatArray:
    """Points off the interfaces of layers, to the side that is meant: at their depth that is the deeper layer's."""
    depth, out = 0.0, points.copy()
    for layer in body.loaded.layers:
        depth += layer.thickness
        off = points[:, 2] - depth
        near = np.abs(off) < 1e-6 * layer.thickness
        out[near, 2] = np.where(off[near] < -1e-12 * depth, depth * (1 - 1e-6), depth * (1 + 1e-6))
    return out


def judged_points(
    stored: StoredStep, region: StoredRegion, body: AuditedBody, middle: Middle
) -> tuple[NDArray[np.bool_], list[str]]:
    """Which points of a region can be judged, and why others cannot."""
    points, reasons = region.points, []
    x, y, z = (points[..., axis] for axis in range(3))
    shallow = max(region.mean_above, _SHALLOW * max(stored.window.cell)) if middle.loaded else 0.0
    deep = z >= shallow
    if not deep.all():
        reasons.append(f"above a depth of {shallow:.3g} m the tractions of single cells disturb the field")
    finite = np.isfinite(region.stress).all(axis=-1)
    smooth = np.ones(z.shape, dtype=bool)
    for interface in body.different:
        for cells in range(1, _CUT + 1):
            smooth &= ~_near_boundary(interface, x, y, z, tuple(cells * edge for edge in body.cell))
    if not smooth.all():
        reasons.append(f"within {_CUT} cells of an interface, where the steps of its cells disturb the field")
    for inclusion in (candidate for candidate in body.loaded.regions if candidate.contains not in body.different):
        size = max(high - low for low, high in zip(*inclusion.bounds, strict=True))
        clear = ~_near_boundary(inclusion.contains, x, y, z, (_RIM * size,) * 3)
        if not clear.all():
            reasons.append("beside the boundary of an inclusion, where stress jumps")
        smooth &= clear
    faces = _on_faces(body, points)
    if faces.any():
        reasons.append("on faces of cells whose eigenstrain differs, where stress jumps")
    return deep & finite & smooth & ~faces, list(dict.fromkeys(reasons))


def _near_boundary(
    contains: object, x: FloatArray, y: FloatArray, z: FloatArray, reach: tuple[float, ...]
) -> NDArray[np.bool_]:
    """Whether a step along an axis or a diagonal leads across the boundary of a region."""
    inside = contains(x, y, z)  # type: ignore[operator]
    near = np.zeros(x.shape, dtype=bool)
    for steps in np.ndindex(3, 3, 3):
        a, b, c = ((step - 1) * length for step, length in zip(steps, reach, strict=True))
        near |= contains(x + a, y + b, np.maximum(z + c, 0.0)) != inside  # type: ignore[operator]
    return np.asarray(near)


def _on_faces(body: AuditedBody, points: FloatArray) -> NDArray[np.bool_]:
    """Whether points lie on faces of cells across which eigenstrain or damage jumps."""
    on_face = np.zeros(points.shape[:-1], dtype=bool)
    for cells in body.loaded.cells:
        content = cells.eigenstrain.reshape(9, *cells.eigenstrain.shape[2:])
        if cells.stiffness_factor is not None:
            content = np.concatenate([content, cells.stiffness_factor[None]])
        size = np.abs(content).reshape(len(content), -1).max(axis=1)
        allowed = 1e-3 * np.array([size[:9].max()] * 9 + list(size[9:]))
        edges = (cells.x, cells.y, cells.z)
        outside = np.pad(content, ((0, 0), (1, 1), (1, 1), (1, 1)))
        if cells.stiffness_factor is not None:
            outside[9] = np.pad(cells.stiffness_factor, 1, constant_values=1.0)
        index = [np.searchsorted(edges[axis], points[..., axis], side="right") for axis in range(3)]
        inner = outside[:, index[2], index[1], index[0]]
        for axis in range(3):
            face = np.argmin(np.abs(points[..., axis, None] - edges[axis]), axis=-1)
            near = np.abs(points[..., axis] - edges[axis][face]) < _FACE * np.diff(edges[axis]).min()
            if axis == 2:
                near &= edges[2][face] > 0.0  # the surface is no face between cells
            neighbour = list(index)
            neighbour[axis] = np.where(index[axis] == face, face + 1, face)
            outer = outside[:, neighbour[2], neighbour[1], neighbour[0]]
            jump = np.any(np.abs(outer - inner) > allowed.reshape(-1, *([1] * near.ndim)), axis=0)
            on_face |= near & jump
    return on_face


def _strained(body: AuditedBody, points: FloatArray) -> NDArray[np.bool_]:
    """Whether points lie in cells with eigenstrain or beside these, where the field steps from cell to cell."""
    strained = np.zeros(points.shape[:-1], dtype=bool)
    for cells in body.loaded.cells:
        size = np.abs(cells.eigenstrain).max(axis=(0, 1))
        if cells.stiffness_factor is not None:
            size = np.maximum(size / max(float(size.max()), 1e-300), 1.0 - cells.stiffness_factor)
        filled = np.pad(size > 1e-9 * max(float(size.max()), 1e-300), 2)
        near = filled.copy()
        for axis in range(3):
            near = near | np.roll(near, 1, axis=axis) | np.roll(near, -1, axis=axis)
        edges = (cells.x, cells.y, cells.z)
        z, y, x = (np.searchsorted(edges[axis], points[..., axis], side="right") + 1 for axis in (2, 1, 0))
        strained |= near[z, y, x]
    return strained


def _slopes(region: StoredRegion, at: tuple[IntArray, ...], base: Base | None) -> FloatArray:
    """Derivatives of the stored stress less `base` along the axes of a region; zero without a base.

    That along a line that is stored by itself counts along all three.
    """
    steep = np.zeros((3, at[0].size, region.stress.shape[-1]))
    if region.shape == "points" or base is None:
        return steep
    for axis, name in enumerate(region.axes):
        size = region.stress.shape[axis]
        if size < 2:
            continue
        before, after = (list(at) for _ in range(2))
        before[axis], after[axis] = np.maximum(at[axis] - 1, 0), np.minimum(at[axis] + 1, size - 1)
        ends = tuple(before), tuple(after)
        length = np.linalg.norm(region.points[ends[1]] - region.points[ends[0]], axis=-1)
        first, second = (region.stress[end] - base(region.points[end]) for end in ends)
        where = "xyz".index(name) if name in "xyz" else slice(None)
        steep[where] = np.fmax(steep[where], np.abs(second - first) / length[:, None])
    return steep


def _nearest(line: FloatArray, place: float) -> int:
    return int(np.argmin(np.abs(line - place)))


def _through(
    region: StoredRegion, body: AuditedBody, middle: Middle
) -> list[tuple[str, tuple[IntArray, ...], FloatArray, str]]:
    """Lines of a region: words, indices, abscissa and its label."""
    if region.axes == ("point",):
        index = np.arange(len(region.points))
        along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(region.points, axis=0), axis=1))])
        if region.shape == "points":
            return [("points", (index,), index.astype(float), "point")]
        return [("line", (index,), along, "along the line [m]")]
    lines: dict[str, FloatArray] = {}
    for axis, name in enumerate(region.axes):
        first = [0] * len(region.axes)
        picked: list[int | slice] = list(first)
        picked[axis] = slice(None)
        lines[name] = region.points[tuple(picked)][:, "xyz".index(name)]
    places = {name: _places(name, line, body, middle) for name, line in lines.items()}
    if "z" not in region.axes:  # a plane at one depth: a cross
        places = {name: chosen[:1] for name, chosen in places.items()}
    paths: list[tuple[str, tuple[IntArray, ...], FloatArray, str]] = []
    cut_planes = set()
    for name, line in lines.items():
        cut_axes = [cut_axis for cut_axis in region.axes if cut_axis != name]
        for chosen in _combinations([places[cut_axis] for cut_axis in cut_axes]):
            fixed = dict(zip(cut_axes, chosen, strict=True))
            key = (name, *(fixed[cut_axis] for cut_axis in cut_axes))
            if key in cut_planes:
                continue
            cut_planes.add(key)
            at = tuple(
                np.arange(line.size) if axis == name else np.full(line.size, fixed[axis]) for axis in region.axes
            )
            words = ", ".join(f"{cut_axis} = {lines[cut_axis][fixed[cut_axis]]:.4g} m" for cut_axis in cut_axes)
            paths.append((f"along {name} at {words}", at, line, f"{name} [m]"))
    return paths


def _combinations(choices: list[list[int]]) -> list[tuple[int, ...]]:
    """One line through each place where there is one other axis; through the first of both where there are two."""
    if len(choices) == 1:
        return [(place,) for place in choices[0]]
    return [tuple(choice[0] for choice in choices), tuple(choice[-1] for choice in choices)]


def _places(name: str, line: FloatArray, body: AuditedBody, middle: Middle) -> list[int]:
    """Indices along an axis that lines across it go through: the middle, near the edge, inclusions, interfaces."""
    positions: list[float] = []
    radius = max(middle.half)
    bounds = [region.bounds for region in body.loaded.regions][:3]
    if name == "z":
        positions += [0.5 * radius] if middle.loaded or not bounds else []
        positions += [0.5 * (low[2] + high[2]) for low, high in bounds[:2]]
        depth = 0.0
        for layer in body.loaded.layers[:2]:
            positions += [depth + 0.5 * layer.thickness, depth + 1.5 * layer.thickness]
            depth += layer.thickness
        if body.loaded.cells and not middle.loaded:
            cells = body.loaded.cells[0]
            size = np.abs(cells.eigenstrain).sum(axis=(0, 1))
            if size.any():
                deepest = int(np.argmax(size.max(axis=(1, 2))))
                positions.append(0.5 * float(cells.z[deepest] + cells.z[deepest + 1]))
    else:
        axis = "xyz".index(name)
        centre, half = (middle.x, middle.y)[axis], middle.half[axis]
        positions += [centre] + ([centre + 0.8 * half] if middle.loaded else [])
        positions += [0.5 * (low[axis] + high[axis]) for low, high in bounds]
    inside = [place for place in positions if line[0] <= place <= line[-1]] or [float(line[line.size // 2])]
    return list(dict.fromkeys(_nearest(line, place) for place in inside))
