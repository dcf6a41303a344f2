"""Stored values of a run of revolution along lines: approach, contact radius, pressure, print, stress near the axis.

The run's own error is added to that of the elements:

- *approach*: cells leave open within half a cell h where the contact ends. The approach at a given load is stationary
  in the contact radius a, so that this counts in second order: θ'(a) h² / 8a, θ(a) being the approach of this radius on
  a half-space; (h/2a)² of it below a sphere, and that at least. Without load the first touch is looked for in the
  middles of cells: the height of the rigid body half a diagonal of a cell off its axis. Where something is cut into
  cells, half of a cell's change of the displacement by eigenstrain is added, the largest on the row (as for a print),
  and not less than half of that of any step;
- *contact radius*, from the count of cells: the size of the correction for cells that the edge cuts, which holds for a
  pressure that falls as in Hertz's contact, and what a count of this lattice can miss (`contact_edge.counting_error`);
- *contact radius from the gap*, which is read between the cells: what the pressure says otherwise (`contact_edge`),
  after the largest load not less than under it;
- *pressure*: values stand for means over cells, and the mean of a smooth field over a cell differs from its middle by a
  24th of the second difference along each edge: an eighth, for three edges, of the second difference between
  neighbouring cells; where cells cut a boundary, of an inclusion, also half a cell's change of what differs from the
  homogeneous body. What yields has no boundary that cells cut, and its error was seen to fall in second order
  (`crosscheck.plasticity`): there it is the same eighth of what differs, over a cell of the body. Either is not less
  than half of the largest on the row: on the axis a slope is zero, and no error is;
- *print*: where something is cut into cells, half of a cell's change, and not less than half of the largest on the row;
- *stress*: the same along depth, of what differs from a homogeneous body under the stored pressure, not less than half
  of the largest on the line (of both components, where nothing is cut), and the median of the pressure's under load.

`two_grids` raises some of these where a run on coarser cells says more.

Runs of 'plastic-hertz' with 12 and 24 cells to the contact radius differ nowhere by more than 0.82 of what this says of
the first.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.audit.contact_edge import counting_error, edge_radius
from eigencontact_verification.audit.contact_model import Heights, pliancy
from eigencontact_verification.audit.homogeneous import homogeneous_stress
from eigencontact_verification.audit.lines import spread
from eigencontact_verification.audit.stored import read_step
from eigencontact_verification.audit.stored_profile import Form, StoredProfile, stored_profile
from eigencontact_verification.fem.loaded_body import Tractions

if TYPE_CHECKING:
    from pathlib import Path

    from eigencontact_verification.audit.contact_scene import ContactScene
    from eigencontact_verification.audit.stored import StoredRegion

__all__ = ["StoredContact", "contact_lines", "read_contact"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.intp]

#: Pressure is compared within this part of the contact radius; print and stress to these depths and distances, in it.
_INNER, _AWAY, _SHALLOW, _DEEP = 0.8, 1.4, 0.15, 2.4
#: Distance of points of stress from a boundary, in the contact radius, beside that of the run's cells.
_MARGIN = 0.1
#: Points on a line.
_POINTS = 40
#: Part of the second difference by which a mean over a cell may differ from the value in its middle.
_MEAN = 1 / 8
#: Forms by kind of line. A radius is no displacement of the field.
_FORMS: dict[str, Form] = {
    "approach": ("displacement", "step [1]", ("u_z",), "m"),
    "radius": ("strain", "step [1]", ("a",), "largest a"),
    "edge": ("strain", "step [1]", ("a",), "largest a"),
    "pressure": ("stress", "x [m]", ("s_zz",), "Pa"),
    "print": ("displacement", "x [m]", ("u_z",), "m"),
    "stress": ("stress", "z [m]", ("s_xx", "s_zz"), "Pa"),
}
_line = partial(stored_profile, _FORMS)
#: Contacts are compared in width from this part of the widest: few elements are under smaller ones.
_WIDE = 0.6


@dataclass(frozen=True, kw_only=True, eq=False)
class StoredContact:
    """Scalars and fields of a run over its steps.

    Attributes
    ----------
    name, text : str
        Of the scene; the scene.
    load, approach, radius, correction : (steps,) float64
        Load [N], approach, contact radius and its correction for cut cells [m].
    straight : int
        Steps, from the first, without tilt and shear.
    x, y : (nx,), (ny,) float64
        Middles of the cells of the surface [m].
    pressure, gap, residual, homogeneous : (steps, ny, nx) float64 or None
        Pressure, gap, displacement by eigenstrain, pressure of a homogeneous body.
    cell, pitch : float
        Edge of a cell of the surface, and the longest of a cell inside a body; 0 without.
    errors : dict of str to array
        Stored errors of scalars and fields over the steps, by name; empty for a run without ``--errors``.
    """

    name: str
    text: str
    load: FloatArray
    approach: FloatArray
    radius: FloatArray
    correction: FloatArray
    straight: int
    x: FloatArray
    y: FloatArray
    pressure: FloatArray
    gap: FloatArray
    residual: FloatArray | None
    homogeneous: FloatArray | None
    cell: float
    pitch: float
    middles: FloatArray
    errors: dict[str, FloatArray] = field(default_factory=dict)

    @property
    def peak(self) -> int:
        """Last step, from 0, under the largest load."""
        return int(np.flatnonzero(self.load[: self.straight] == self.load[: self.straight].max())[-1])


def read_contact(path: str | Path) -> StoredContact:
    """Read what a run stores over its steps."""
    from eigencontact.results.reader import open_results
    from eigencontact_verification.audit.bodies import NotJudged

    with open_results(path) as data:
        arrays: dict[str, Any] = {
            str(name): np.asarray(field.values, dtype=float)
            for name, field in data.variables.items()
            if field.attrs.get("role") in ("scalar", "field")
        }
        if "pressure" not in arrays:
            raise NotJudged("the run has no contact")
        x, y = (np.asarray(data[axis].values, dtype=float) for axis in "xy")
        errors = {
            str(field.attrs["estimates"]): np.asarray(field.values, dtype=float)
            for field in data.variables.values()
            if field.attrs.get("role") == "error"
        }
        size = np.asarray(data.attrs["cell_size"], dtype=float)
        pitch, middles = 0.0, np.zeros(0)
        for body in (1, 2):
            if f"cells_{body}_z" in data.variables:
                lines = [np.asarray(data[f"cells_{body}_{axis}"].values, dtype=float) for axis in "xyz"]
                pitch = max([pitch, *(float(np.diff(line).max()) for line in lines if line.size > 1)])
                middles = lines[2]
        text, name = str(data.attrs["scene"]), str(data.attrs["name"])
    count = len(arrays["normal_load"])
    scale = max(float(arrays["normal_load"].max()), 1e-300) * max(float(arrays["contact_radius"].max()), 1e-300)
    bent = np.zeros(count, dtype=bool)
    for key in ("moment_x", "moment_y"):
        bent |= np.abs(arrays.get(key, np.zeros(count))) > 1e-4 * scale
    for key in ("shear_x", "shear_y"):
        if key in arrays:
            bent |= np.abs(arrays[key]).reshape(count, -1).max(axis=1) > 0
    counted = np.sqrt(arrays["contact_area_counted"] / np.pi)
    return StoredContact(
        name=name,
        text=text,
        load=arrays["normal_load"],
        approach=arrays["approach"],
        radius=arrays["contact_radius"],
        correction=np.abs(counted - arrays["contact_radius"]),
        straight=int(np.argmax(bent)) if np.any(bent) else count,
        x=x,
        y=y,
        pressure=arrays["pressure"],
        gap=arrays["gap"],
        residual=arrays.get("residual_displacement_z"),
        homogeneous=arrays.get("homogeneous_pressure"),
        cell=float(size.max()),
        pitch=pitch,
        middles=middles,
        errors=errors,
    )


def contact_lines(path: str | Path, stored: StoredContact, scene: ContactScene) -> tuple[StoredProfile, ...]:
    """Lines of all that is stored and can be compared."""
    steps = range(stored.straight)
    peak, last = stored.peak, stored.straight - 1
    h = stored.pitch if scene.cells else 0.0
    row = int(np.abs(stored.y).argmin())
    r = np.hypot(stored.x, stored.y[row])
    right = stored.x > -0.25 * stored.cell  # the axis too, where a cell lies on it
    moved = np.zeros(len(steps))
    if h and stored.residual is not None:
        slope = np.gradient(stored.residual[:, row], stored.x, axis=1)
        moved = 0.5 * h * np.abs(slope).max(axis=1)[: len(steps)]
        moved = np.maximum(moved, 0.5 * moved.max())
    a, d = stored.radius[: len(steps)], stored.approach[: len(steps)]
    share = np.where(a > 0, stored.cell / np.where(a > 0, 2 * a, 1.0), 0.0) ** 2
    corner = float(Heights(bodies=tuple(scene.profile))(np.array([stored.cell / np.sqrt(2)]))[0])
    open_rim = np.array([pliancy(scene.profile, b) * stored.cell**2 / (8 * b) if b > 0 else corner for b in a])
    number = np.arange(1.0, len(steps) + 1)
    nowhere = np.zeros((len(steps), 3))
    error = np.maximum(share * np.abs(d), open_rim) + moved
    lines = [_line("approach", "approach", nowhere, number, d, error, tuple(steps))]
    wide = np.flatnonzero(a > _WIDE * a.max())
    lines += _radii(stored, a, wide)
    inside = right & (r < _INNER * a[peak])
    p = stored.pressure[peak, row]
    error = _bend(p)
    if h and stored.homogeneous is not None:
        error = error + _change(p - stored.homogeneous[peak, row], stored.x, h, cut=scene.cut)
    error = np.maximum(error, 0.5 * error[inside].max())
    bend = float(np.median(error[inside]))
    lines.append(_surface("pressure", stored, row, inside, -p, error, peak))
    if stored.load[last] == 0.0 and stored.residual is not None:
        u = stored.residual[last, row]
        near = right & (r < _AWAY * a.max())
        error = 0.5 * h * np.abs(np.gradient(u, stored.x))
        error = np.maximum(error, 0.5 * error[near].max())
        lines.append(_surface("print", stored, row, near, u, error, last))
    for step in dict.fromkeys((peak, last)):
        step_data = read_step(path, step + 1)
        region = next(
            (column for stress in step_data.regions if stress.body == scene.number if (column := _column(stress))), None
        )
        if region is not None:
            name = f"stress on the axis, step {step + 1}"
            under = bend if stored.load[step] > 0 else 0.0
            line = _stress(name, *region, stored, scene, float(a.max()), h, under, step)
            lines += [line] if line is not None else []
    return tuple(lines)


def _radii(stored: StoredContact, a: FloatArray, steps: IntArray) -> list[StoredProfile]:
    """Contact radius over steps: as it is stored, and read between the cells."""
    r = np.hypot(*np.meshgrid(stored.x, stored.y)).ravel()
    counted = np.array([counting_error(r, stored.cell**2, a[k]) for k in steps])
    fields = [(stored.gap[k].ravel(), stored.pressure[k].ravel()) for k in steps]
    edges = np.array([edge_radius(r, *values, stored.cell, a[k]) for k, values in zip(steps, fields, strict=True)])
    read = np.isfinite(edges).all(axis=1)
    late = read & (steps > stored.peak)  # beyond the edge lies what was pressed before, and keeps its form
    edges[late, 1] = np.maximum(edges[late, 1], edges[read & (steps == stored.peak), 1].max(initial=0.0))
    lines, scale = [], float(a.max())
    for kind, name, which, radii, error in (
        ("radius", "contact radius", steps, a[steps], stored.correction[steps] + counted),
        ("edge", "contact radius from the gap", steps[read], edges[read, 0], edges[read, 1]),
    ):
        nowhere, number = np.zeros((which.size, 3)), np.asarray(which + 1, dtype=np.float64)
        if which.size:
            moments = tuple(int(k) for k in which)
            lines.append(_line(kind, name, nowhere, number, np.asarray(radii / scale), error / scale, moments))
    return lines


def _homogeneous(stored: StoredContact, scene: ContactScene, points: FloatArray, step: int) -> FloatArray:
    """Stress (n, 6) of a homogeneous half-space under the stored pressure of a step."""
    x, y = (line[0] + (np.arange(line.size + 1) - 0.5) * np.diff(line)[0] for line in (stored.x, stored.y))
    pressure = stored.pressure[step]
    values = np.stack([0 * pressure, 0 * pressure, pressure])
    below = np.where(points[:, 2:] > 0, points, points + np.array([0.0, 0.0, 0.1 * stored.cell]))
    return homogeneous_stress(Tractions(x=x, y=y, values=values), below, scene.poisson_ratio)


def _change(values: FloatArray, along: FloatArray, h: float, *, cut: bool) -> FloatArray:
    """Change over half a cell h where cells cut a boundary, else a part of the second difference over a cell."""
    slope = np.gradient(values, along, axis=0)
    return np.asarray(0.5 * h * np.abs(slope) if cut else _MEAN * h * h * np.abs(np.gradient(slope, along, axis=0)))


def _bend(p: FloatArray) -> FloatArray:
    """Difference between the mean over a cell and the value in its middle, the largest of three neighbours."""
    second = _MEAN * np.abs(np.diff(np.pad(p, 1, mode="edge"), 2))
    return np.asarray(np.maximum.reduce([second, np.roll(second, 1), np.roll(second, -1)]))


def _surface(
    kind: str, stored: StoredContact, row: int, which: NDArray[np.bool_], values: FloatArray, error: FloatArray,
    step: int,
) -> StoredProfile:  # fmt: skip
    """Line along x on the surface."""
    chosen = spread(np.flatnonzero(which), _POINTS)
    x = stored.x[chosen]
    points = np.stack([x, np.full_like(x, stored.y[row]), 0 * x], axis=1)
    return _line(kind, f"{kind}, step {step + 1}", points, x, values[chosen], error[chosen], (step,))


def _column(region: StoredRegion) -> tuple[FloatArray, FloatArray] | None:
    """Points (n, 3) and stress (n, 6) of the line of a region that goes down nearest to the axis."""
    if region.axes == ("point",):
        if np.ptp(region.points[:, :2], axis=0).max() > 0 or np.hypot(*region.points[0, :2]) > 0:
            return None
        return region.points, region.stress
    if region.axes in {("z", "x"), ("z", "y")}:
        k = int(np.hypot(region.points[0, :, 0], region.points[0, :, 1]).argmin())
        return region.points[:, k], region.stress[:, k]
    return None


def _stress(
    name: str, points: FloatArray, stress: FloatArray, stored: StoredContact, scene: ContactScene, a: float, h: float,
    under: float, step: int,
) -> StoredProfile | None:  # fmt: skip
    z = points[:, 2]
    if np.hypot(*points[0, :2]) > 0.25 * a:
        return None
    good = (z > max(_SHALLOW * a, 2 * stored.cell)) & (z < _DEEP * a)
    depths = np.cumsum([layer["thickness"] for layer in scene.layers]).tolist()
    for region in scene.regions:
        if region["kind"] == "ellipsoid":
            depths += [region["depth"] - region["height"], region["depth"] + region["height"]]
        else:
            depths += [region["top"], region["bottom"]]
    for depth in depths:
        good &= np.abs(z - depth) > max(_MARGIN * a, 1.5 * h)
    if h and stored.middles.size:  # in the middle of a cell its uniform strain is what it stands for, nowhere else
        inside = (z > stored.middles[0] - 0.6 * h) & (z < stored.middles[-1] + 0.6 * h)
        nearest = np.abs(z[:, None] - stored.middles).min(axis=1) < 0.1 * h
        good &= nearest | ~inside
    chosen = spread(np.flatnonzero(good), _POINTS)
    if chosen.size < 5:
        return None
    columns = [0, 2]
    values = stress[:, columns]
    error = np.full_like(values, under)
    if h:
        caused = values - _homogeneous(stored, scene, points, step)[:, columns]
        error += _change(caused, z, h, cut=scene.cut)
        error = np.maximum(error, 0.5 * error[chosen].max(axis=0 if scene.cut else None))
    return _line("stress", name, points[chosen], z[chosen], values[chosen], error[chosen], (step,))
