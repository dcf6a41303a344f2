"""Whole line contacts, solved by finite elements along the loads of a run, against the stored results.

Both take the same load steps, by backward Euler: what they share of its error is not judged.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.audit.bodies import NotJudged
from eigencontact_verification.audit.cases import RunCase
from eigencontact_verification.audit.contact_model import junctions
from eigencontact_verification.audit.line_grids import run_coarser, with_coarser
from eigencontact_verification.audit.line_model import line_model
from eigencontact_verification.audit.line_profiles import line_profiles
from eigencontact_verification.audit.line_scene import StoredLine, read_line
from eigencontact_verification.audit.stored import run_name
from eigencontact_verification.audit.stored_profile import StoredProfile, fields_of
from eigencontact_verification.crosscheck.case import HALVED, Fields, Gap, Level, Outer
from eigencontact_verification.fem.line_contact import LineStep, solve_line_contact

if TYPE_CHECKING:
    from eigencontact_verification.fem.line_contact import LineSolution

__all__ = ["LineCase", "line_cases_of", "line_steps"]

FloatArray = NDArray[np.float64]

#: Divisions of the undivided mesh by level.
_DIVISIONS = (1, 2, 4)
#: Elements to a half width in the undivided mesh, and in that of the quick audit.
_PARTS, _QUICK = 4, 2


@dataclass(frozen=True, kw_only=True, eq=False)
class LineCase(RunCase):
    """Stored values of a run of a line contact against finite elements with a contact algorithm of their own.

    `parameters` are those of `line_scene`, with ``steps`` (`line_steps`), ``half_width``, ``edges``
    (`StoredLine.edges` of the steps that are compared, and where the profile changes its form), ``parts`` of a half
    width, and ``divisions`` by level. A component below a twentieth of the field counts as if it were a twentieth.
    """

    small: ClassVar[float] = 0.05

    lines: tuple[StoredProfile, ...]

    code: ClassVar[tuple[str, ...]] = (
        "eigencontact_verification.audit.line_model",
        f"{__name__}:LineCase.reference",
        f"{__name__}:line_steps",
        f"{__name__}:_read",
        "eigencontact_verification.audit.contact_model",
        "eigencontact_verification.crosscheck.plasticity:point_law",
        "eigencontact_verification.crosscheck.plasticity:_curve",
    )
    method: ClassVar[str] = "finite elements with contact and friction of their own"

    def reference(self, level: Level, outer: Outer) -> Fields:
        """Values of the elements at the points of every line, and the number of halved increments."""
        model = line_model(self.parameters, self.parameters["divisions"][level], outer)
        solution = solve_line_contact(model, line_steps(self.parameters))
        fields = {line.profile.name: _read(solution, line, self.parameters["half_width"]) for line in self.lines}
        return {**fields, HALVED: np.array([sum(moment.increments - 1 for moment in solution.moments)])}

    def judged(self) -> Fields:
        """Stored values, with their own error."""
        return fields_of(self.lines)

    @property
    def words(self) -> str:
        """Title of the figures: scene and methods."""
        return f"{self.subject}: stored (semi-analytical) and finite elements of the whole line contact"


def line_steps(parameters: Mapping[str, Any]) -> list[LineStep]:
    """Increments of the parameters of a case: normal, shear, bulk stress of both bodies, place."""
    return [LineStep(normal=p, shear=q, bulk=(b1, b2), place=place) for p, q, b1, b2, place in parameters["steps"]]


def _read(solution: LineSolution, line: StoredProfile, widest: float) -> FloatArray:
    """Values (n, components) of a line; half widths in the widest of the run."""
    if line.kind == "half width":
        ends = np.array([solution.contact(k) for k in line.moments])
        return np.asarray(np.diff(ends, axis=1) / (2 * widest))
    if line.kind == "history of stress":
        pairs = zip(line.profile.points[:, None, [0, 2]], line.moments, strict=True)
        return np.concatenate([solution.stress(point, k, line.body).T for point, k in pairs])
    (k,) = line.moments
    x, moment = line.profile.points[:, 0], solution.moments[k]
    if line.kind == "pressure":
        return -np.sqrt(np.interp(x, solution.x, moment.pressure**2))[:, None]  # p² is smooth to the edge
    if line.kind == "shear":
        return np.interp(x, solution.x, moment.shear)[:, None]
    if line.kind == "slip":
        before = solution.moments[k - 1].slip if k else 0 * moment.slip
        return -np.interp(x, solution.x, moment.slip - before)[:, None]
    points = line.profile.points[:, [0, 2]]
    if line.kind == "plastic strain":
        return solution.plastic_strain(points, k, line.body)[:, None]
    return solution.stress(points, k, line.body).T


def _edges(stored: StoredLine, lines: Iterable[StoredProfile]) -> list[float]:
    """Places x where the elements are small [m]."""
    steps = {k for line in lines for k in line.moments if line.kind not in ("half width", "history of stress")}
    a, ends = float(stored.half_width.max()), stored.edges(steps)
    for radius in junctions(stored.scene["profile"]):
        for end in np.unique([stored.place[k] + sign * radius for k in steps for sign in (-1, 1)]):
            if radius < a and all(abs(place - end) > stored.cell for place in ends):
                ends.append(float(end))
    return sorted(ends)


def line_cases_of(
    folder: str | Path, *, quick: bool = True, coarser: str | Path | None = None
) -> tuple[tuple[LineCase, ...], tuple[Gap, ...]]:
    """The case of a run of a line contact; or no case, and why.

    Parameters
    ----------
    folder : str or Path
        Folder of the run, or its ``results.nc``.
    quick : bool
        Lighter meshes.
    coarser : str or Path, optional
        A run of the same scene with coarser cells; both together give the error of the cells (`line_grids`).
        Without it, if a body yields, the scene is run with cells of twice the size.
    """
    gaps: list[Gap] = []
    try:
        stored = read_line(folder)
    except NotJudged as problem:
        return (), (Gap(subject=run_name(folder), what="whole line contact", reason=str(problem)),)
    lines = tuple(line_profiles(stored))
    try:
        lines = _with_error_of_cells(lines, stored, coarser)
    except NotJudged as problem:
        gaps.append(Gap(subject=stored.name, what="whole contact: error of the cells", reason=str(problem)))
    case = LineCase(
        subject=stored.name,
        name="line-contact",
        parameters={
            **stored.scene,
            "steps": np.stack((stored.load, stored.force, *stored.bulk, stored.place), axis=1).tolist(),
            "half_width": float(stored.half_width.max()),
            "edges": _edges(stored, lines),
            "parts": _QUICK if quick else _PARTS,
            "divisions": list(_DIVISIONS),
            "lines": [[line.profile.name, line.kind, list(line.moments), line.body] for line in lines],
        },
        quick=quick,
        profiles=tuple(line.profile for line in lines),
        lines=lines,
    )
    return (case,), tuple(gaps)


def _with_error_of_cells(
    lines: tuple[StoredProfile, ...], stored: StoredLine, coarser: str | Path | None
) -> tuple[StoredProfile, ...]:
    """Lines with the error from a coarser run; results with cut cells stay, because they cannot be interpolated."""
    if any(body["cut"] for body in stored.scene["bodies"]):
        return lines
    if coarser is not None:
        return with_coarser(lines, stored, read_line(coarser))
    if not stored.yields:
        return lines
    with TemporaryDirectory() as folder:
        return with_coarser(lines, stored, read_line(run_coarser(stored.text, stored, Path(folder) / "run")))
