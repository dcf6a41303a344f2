"""Whole line contacts, solved by finite elements along the loads of a run, against the stored results.

Both take the same load steps, by backward Euler: what they share of its error is not judged. The run's own error:
values stand for means over strips, and may differ from the middle by an eighth of the second difference between
neighbours (`contact_lines`); the half width is known to half a strip.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.audit.bodies import NotJudged
from eigencontact_verification.audit.cases import RunCase
from eigencontact_verification.audit.contact_model import Heights
from eigencontact_verification.audit.line_scene import StoredLine, read_line
from eigencontact_verification.audit.lines import spread
from eigencontact_verification.crosscheck.case import Fields, Gap, Level, Outer, Profile, Quantity, own_error
from eigencontact_verification.crosscheck.plasticity import point_law
from eigencontact_verification.fem.line_contact import LineBody, LineContact, LineStep, solve_line_contact

if TYPE_CHECKING:
    from eigencontact_verification.fem.line_contact import LineSolution

__all__ = ["LineCase", "LineProfile", "line_cases_of", "line_model"]

FloatArray = NDArray[np.float64]

#: Divisions of the undivided mesh by level.
_DIVISIONS = (1, 2, 4)
#: Elements to a half width in the undivided mesh, and in that of the quick audit.
_PARTS, _QUICK = 4, 2
#: Elements at the edges of contact and stick are smaller by this factor. The finest mesh of the quick audit (3136
#: elements) then has Cattaneo's shear within .29 % and slip within .07 % of the largest; 4160 elements of a/16 had
#: 6.4 % and .4 % (`test_line_elements`).
_SHARPER = 32
#: Growth from element to element of a mesh with one element to a half width.
_GROWTH = 16.0
#: Window, depth of the elements of a half width's part, and reach of the mesh, in half widths.
_WINDOW, _DEEP, _REACH = 1.25, 0.5, 60.0
#: That depth where a body yields.
_DEEP_YIELDING = 2.0
#: Surface within this part of the half width is compared, and stress at these depths, in it.
_INNER, _SHALLOW, _FARTHEST = 0.8, 0.2, 2.4
_POINTS = 40
#: Part by which loads of steps may differ and count as one.
_SAME = 1e-4
_MEAN = 1 / 8
_KINDS: dict[str, tuple[Quantity, str, tuple[str, ...], str]] = {
    "half width": ("strain", "step [1]", ("a",), "largest a"),
    "pressure": ("stress", "x [m]", ("s_zz",), "Pa"),
    "shear": ("stress", "x [m]", ("s_xz",), "Pa"),
    "slip": ("displacement", "x [m]", ("u_x",), "m"),
    "stress": ("stress", "z [m]", ("s_xx", "s_yy", "s_zz", "s_xz"), "Pa"),
    "plastic strain": ("strain", "z [m]", ("e_p",), "1"),
}


@dataclass(frozen=True, kw_only=True, eq=False)
class LineProfile:
    """Stored values along one line.

    Attributes
    ----------
    profile : Profile
    kind : str
        Key of what is compared: ``"half width"``, ``"pressure"``, ``"shear"``, ``"slip"``, ``"stress"`` or
        ``"plastic strain"``, the equivalent one.
    moments : tuple of int
        Load steps, from 0: of every point, or one for all.
    body : int
        Of stress and plastic strain, from 1 among those that deform.
    values, own : (n, components) float64
        Stored values and their numerical error.
    """

    profile: Profile
    kind: str
    moments: tuple[int, ...]
    body: int
    values: FloatArray
    own: FloatArray


@dataclass(frozen=True, kw_only=True, eq=False)
class LineCase(RunCase):
    """Stored values of a run of a line contact against finite elements with a contact algorithm of their own.

    `parameters` are those of `line_scene`, with ``steps`` (normal, shear, bulk of both), ``half_width``, ``edges``
    (`StoredLine.edges` of the steps that are compared), ``parts`` of a half width, and ``divisions`` by level.
    """

    lines: tuple[LineProfile, ...]

    code: ClassVar[tuple[str, ...]] = (
        f"{__name__}:line_model",
        f"{__name__}:LineCase.reference",
        f"{__name__}:_read",
        "eigencontact_verification.audit.contact_model",
        "eigencontact_verification.crosscheck.plasticity:point_law",
        "eigencontact_verification.crosscheck.plasticity:_curve",
    )
    method: ClassVar[str] = "finite elements with contact and friction of their own"

    def reference(self, level: Level, outer: Outer) -> Fields:
        """Values of the elements at the points of every line."""
        model = line_model(self.parameters, self.parameters["divisions"][level], outer)
        steps = [LineStep(normal=p, shear=q, bulk=(one, two)) for p, q, one, two in self.parameters["steps"]]
        solution = solve_line_contact(model, steps)
        return {line.profile.name: _read(solution, line, self.parameters["half_width"]) for line in self.lines}

    def judged(self) -> Fields:
        """Stored values, with their own error."""
        fields: Fields = {line.profile.name: line.values for line in self.lines}
        return fields | {own_error(line.profile.name): line.own for line in self.lines}

    @property
    def words(self) -> str:
        """Title of the figures: scene and methods."""
        return f"{self.subject}: stored (semi-analytical) and finite elements of the whole line contact"


def line_model(parameters: dict[str, Any], divisions: int, outer: Outer) -> LineContact:
    """Model of the parameters of a case."""
    heights, a = Heights(bodies=tuple(parameters["profile"])), parameters["half_width"]
    parts = parameters["parts"]
    bodies = []
    for table in parameters["bodies"]:
        moduli = table["young_modulus"], table["poisson_ratio"]
        law = None if table["law"] is None else point_law(table["law"], *moduli)
        bodies.append(LineBody(young_modulus=moduli[0], poisson_ratio=moduli[1], law=law))
    return LineContact(
        bodies=tuple(bodies),
        gap=lambda x: heights(np.abs(x)),
        friction=parameters["friction"],
        window=(-_WINDOW * a, _WINDOW * a),
        fine=a / parts,
        deep=(_DEEP_YIELDING if any(body.law for body in bodies) else _DEEP) * a,
        edges=tuple(parameters["edges"]),
        sharp=a / (_SHARPER * parts),
        reach=_REACH * a,
        growth=_GROWTH ** (1 / parts),
        divisions=divisions,
        outer=outer,
    )


def _read(solution: LineSolution, line: LineProfile, widest: float) -> FloatArray:
    """Values (n, components) of a line; half widths in the widest of the run."""
    if line.kind == "half width":
        ends = np.array([solution.contact(k) for k in line.moments])
        return np.asarray(np.diff(ends, axis=1) / (2 * widest))
    (k,) = line.moments
    x, now = line.profile.points[:, 0], solution.moments[k]
    if line.kind == "pressure":
        return -np.sqrt(np.interp(x, solution.x, now.pressure**2))[:, None]  # p² is smooth to the edge
    if line.kind == "shear":
        return np.interp(x, solution.x, now.shear)[:, None]
    if line.kind == "slip":
        before = solution.moments[k - 1].slip if k else 0 * now.slip
        return -np.interp(x, solution.x, now.slip - before)[:, None]
    points = line.profile.points[:, [0, 2]]
    if line.kind == "plastic strain":
        return solution.plastic_strain(points, k, line.body)[:, None]
    return solution.stress(points, k, line.body).T


def line_cases_of(folder: str | Path, *, quick: bool = True) -> tuple[tuple[LineCase, ...], tuple[Gap, ...]]:
    """The case of a run of a line contact; or no case, and why.

    Parameters
    ----------
    folder : str or Path
        Folder of the run, or its ``results.nc``.
    quick : bool
        Lighter meshes.
    """
    try:
        stored = read_line(folder)
    except NotJudged as problem:
        name = Path(folder).parent.name if Path(folder).suffix == ".nc" else Path(folder).name
        return (), (Gap(subject=name, what="whole line contact", reason=str(problem)),)
    lines = tuple(_lines(stored))
    case = LineCase(
        subject=stored.name,
        name="line-contact",
        parameters={
            **stored.scene,
            "steps": np.stack((stored.load, stored.force, *stored.bulk), axis=1).tolist(),
            "half_width": float(stored.half_width.max()),
            "edges": stored.edges({k for line in lines for k in line.moments if line.kind != "half width"}),
            "parts": _QUICK if quick else _PARTS,
            "divisions": list(_DIVISIONS),
            "lines": [[line.profile.name, line.kind, list(line.moments), line.body] for line in lines],
        },
        quick=quick,
        profiles=tuple(line.profile for line in lines),
        lines=lines,
    )
    return (case,), ()


def _lines(stored: StoredLine) -> list[LineProfile]:
    a, last = stored.half_width, len(stored.load) - 1
    peak, pulled = _first_largest(stored.load), _first_largest(np.abs(stored.force))
    wide = np.flatnonzero(a > 0.6 * a.max())
    widths = np.stack((wide + 1.0, 0 * wide, 0 * wide), axis=1)
    scale = float(a.max())
    half = np.full((wide.size, 1), stored.cell / 2 / scale)
    lines = [_line("half width", "", widths, 0, a[wide, None] / scale, half, tuple(int(k) for k in wide))]
    for kind, name, sign in (("pressure", "pressure", -1.0), ("shear", "shear_x", 1.0), ("slip", "slip_x", 1.0)):
        steps = (peak,) if kind == "pressure" else (pulled, last)
        for k in dict.fromkeys(steps):
            values = stored.fields.get(name, 0 * stored.load[:, None] * stored.x)[k]
            here = spread(np.flatnonzero(np.abs(stored.x) < _INNER * a[k]), _POINTS)
            if np.any(values[here]):
                points = np.stack((stored.x[here], 0 * stored.x[here], 0 * stored.x[here]), axis=1)
                error = np.maximum(_bend(values)[here], _bend(values)[here].mean())
                lines.append(_line(kind, f", step {k + 1}", points, 0, sign * values[here, None], error[:, None], (k,)))
    for k in dict.fromkeys((peak, pulled, last)):
        lines += _stress(stored, k)
    return lines + _strains(stored)


def _first_largest(values: FloatArray) -> int:
    """First step whose value is the largest but for the tolerance of a load."""
    return int(np.flatnonzero(values >= (1 - _SAME) * values.max())[0])


def _stress(stored: StoredLine, k: int) -> list[LineProfile]:
    """Columns of a section in the middle and near the left edge of the contact, where tension is largest."""
    numbers = [body["number"] for body in stored.scene["bodies"]]
    a = float(stored.half_width.max())
    lines = []
    for region in stored.regions[k]:
        if region.axes != ("z", "x") or region.body not in numbers:
            continue
        for place, where in ((0.0, "in the middle"), (-0.9 * a, "near the edge")):
            column = int(np.abs(region.points[0, :, 0] - place).argmin())
            points, stress = region.points[:, column], region.stress[:, column][:, [0, 1, 2, 4]]
            good = (points[:, 2] > max(_SHALLOW * a, 2 * stored.cell)) & (points[:, 2] < _FARTHEST * a)
            chosen = spread(np.flatnonzero(good), _POINTS)
            if chosen.size < 5:
                continue
            bend = np.stack([_bend(column) for column in stress.T], axis=1)[chosen]
            error = np.maximum(bend, bend.max(axis=0) / 2)
            body = numbers.index(region.body) + 1
            name = f" {where}, step {k + 1}, {region.name}"
            lines.append(_line("stress", name, points[chosen], 2, stress[chosen], error, (k,), body))
    return lines


def _strains(stored: StoredLine) -> list[LineProfile]:
    """Columns of cells in the middle and near the left edge of the contact, after the last step."""
    numbers = [body["number"] for body in stored.scene["bodies"]]
    a, last = float(stored.half_width.max()), len(stored.load) - 1
    lines = []
    for strain in stored.strains:
        deep = np.flatnonzero((strain.z > _SHALLOW * a) & (strain.z < _FARTHEST * a))
        for place, where in ((0.0, "in the middle"), (-0.9 * a, "near the edge")):
            column = int(np.abs(strain.x - place).argmin())
            chosen = spread(deep, _POINTS)
            values = strain.values[chosen, column]
            if chosen.size < 5 or not values.any():
                continue
            z = strain.z[chosen]
            points = np.stack((np.full_like(z, strain.x[column]), 0 * z, z), axis=1)
            error = np.maximum(_bend(strain.values[:, column]), _bend(strain.values[:, column]).max() / 2)[chosen]
            body = numbers.index(strain.body) + 1
            name = f" {where}, step {last + 1}, body {strain.body}"
            lines.append(_line("plastic strain", name, points, 2, values[:, None], error[:, None], (last,), body))
    return lines


def _bend(values: FloatArray) -> FloatArray:
    """An eighth of the second difference, the largest of three neighbours."""
    second = _MEAN * np.abs(np.diff(np.pad(values, 1, mode="edge"), 2))
    return np.asarray(np.maximum.reduce([second, np.roll(second, 1), np.roll(second, -1)]))


def _line(
    kind: str, name: str, points: FloatArray, axis: int, values: FloatArray, own: FloatArray,
    moments: tuple[int, ...], body: int = 1,
) -> LineProfile:  # fmt: skip
    quantity, label, components, unit = _KINDS[kind]
    profile = Profile(
        name=kind + name, quantity=quantity, points=points, along=points[:, axis], label=label, components=components,
        unit=unit,
    )  # fmt: skip
    return LineProfile(profile=profile, kind=kind, moments=moments, body=body, values=values, own=own)
