"""Whole contacts of revolution, solved by finite elements along the loads of a run, against the stored results."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.audit.bodies import NotJudged
from eigencontact_verification.audit.cases import RunCase
from eigencontact_verification.audit.contact_lines import StoredContact, contact_lines, read_contact
from eigencontact_verification.audit.contact_model import contact_model, junctions
from eigencontact_verification.audit.contact_scene import ContactScene, contact_scene
from eigencontact_verification.audit.line_cases import line_cases_of
from eigencontact_verification.audit.line_scene import is_line
from eigencontact_verification.audit.stored import bars_of, run_name
from eigencontact_verification.audit.stored_profile import StoredProfile, fields_of
from eigencontact_verification.audit.two_grids import with_bars, with_two_grids
from eigencontact_verification.crosscheck.case import Fields, Gap, Level, Outer
from eigencontact_verification.fem.yielding import solve_indentation

if TYPE_CHECKING:
    from eigencontact_verification.fem.yielding import IndentationSolution

__all__ = ["ContactCase", "contact_cases_of"]

FloatArray = NDArray[np.float64]

#: Divisions of the undivided mesh by level; its size in contact radii.
_DIVISIONS, _QUICK, _REACH = (3, 6, 12), (2, 4, 8), 40.0
#: Of the undivided mesh where all is elastic: elements to a contact radius, their growth, radius and depth that keep
#: their size, in contact radii.
_ELASTIC, _GROWTH, _EXTENT = 2.0, 2.5, 1.6
#: The same where something yields, which takes many iterations: small elements along the surface, where the edge of the
#: contact wanders, and larger ones below, divided half as often.
_YIELDING, _SLOWER, _PRESSED, _COARSE_DIVISIONS, _COARSE_QUICK = 8.0, 1.5, 1.25, (2, 4, 8), (1, 2, 4)
#: Elements to the width of the rounded edge of a punch that is under pressure.
_EDGE = 4.0
#: Elements of the undivided mesh to the thickness of a layer or the semi-axis of an inclusion, and least size of all.
_PARTS, _SMALLEST = 1.0, 0.25


@dataclass(frozen=True, kw_only=True, eq=False)
class ContactCase(RunCase):
    """Stored values of a run of revolution against finite elements with a contact algorithm of their own.

    Both take the same load steps, by backward Euler: what they share of its error is not judged. `parameters` are those
    of `contact_scene.ContactScene.numbers`, with ``loads`` [N], ``mesh``, and ``divisions`` of its elements by level.

    Parameters
    ----------
    lines : tuple of StoredProfile
        Their profiles are `profiles`.
    """

    lines: tuple[StoredProfile, ...]

    code: ClassVar[tuple[str, ...]] = (
        "eigencontact_verification.audit.contact_model",
        "eigencontact_verification.crosscheck.plasticity:point_law",
        "eigencontact_verification.crosscheck.plasticity:_curve",
        f"{__name__}:ContactCase.reference",
        f"{__name__}:_read",
    )
    method: ClassVar[str] = "finite elements with a contact of their own"

    def reference(self, level: Level, outer: Outer) -> Fields:
        """Values of the elements at the points of every line."""
        model = contact_model(self.parameters, self.parameters["divisions"][level], outer)
        solution = solve_indentation(model, self.parameters["loads"])
        return {line.profile.name: _read(solution, line, self.parameters["mesh"]["radius"]) for line in self.lines}

    def judged(self) -> Fields:
        """Stored values, with their own error."""
        return fields_of(self.lines)

    @property
    def words(self) -> str:
        """Title of the figures: scene and methods."""
        return f"{self.subject}: stored (semi-analytical) and finite elements of the whole contact"


def _read(solution: IndentationSolution, line: StoredProfile, widest: float) -> FloatArray:
    """Values (n, components) of a line; radii in the widest of the run."""
    if line.kind == "approach":
        return np.array([[solution.moments[k].depth] for k in line.moments])
    if line.kind in ("radius", "edge"):
        return np.array([[solution.moments[k].contact_radius / widest] for k in line.moments])
    (moment,) = line.moments
    x, y, z = line.profile.points.T
    r = np.hypot(x, y)
    if line.kind == "print":
        return np.asarray(solution.surface_displacement(r, moment)[:, None])
    if line.kind == "pressure":
        s, p = solution.surface.r**2, solution.moments[moment].pressure ** 2  # p² is smooth in r² to the edge
        middle = p[0] - s[0] * (p[1] - p[0]) / (s[1] - s[0])
        root = np.sqrt(np.interp(r**2, np.insert(s, 0, 0.0), np.insert(p, 0, max(middle, 0.0))))
        return np.asarray(-root[:, None])
    rr, tt, zz, rz = solution.stress(np.stack((r, z), axis=1), moment)
    c, s = np.where(r > 0, x / np.where(r > 0, r, 1.0), 1.0), np.where(r > 0, y / np.where(r > 0, r, 1.0), 0.0)
    columns = {"s_xx": c * c * rr + s * s * tt, "s_yy": s * s * rr + c * c * tt, "s_zz": zz, "s_xz": c * rz}
    return np.stack([columns[name] for name in line.profile.components], axis=1)


def contact_cases_of(
    folder: str | Path, *, quick: bool = True, coarser: str | Path | None = None
) -> tuple[tuple[RunCase, ...], tuple[Gap, ...]]:
    """The case of a run whose contact is of revolution or a line, and what it leaves out; or no case, and why.

    Parameters
    ----------
    folder : str or Path
        Folder of the run, or its ``results.nc``.
    quick : bool
        Lighter meshes.
    coarser : str or Path, optional
        A run of the same scene with coarser cells: both together tell the error of the cells (`two_grids`).
    """
    if is_line(folder):
        return line_cases_of(folder, quick=quick, coarser=coarser)
    name = run_name(folder)
    try:
        stored = read_contact(folder)
        name = stored.name
        scene = _scene_of(stored)
        second = None if coarser is None else read_contact(coarser)
    except NotJudged as problem:
        return (), (Gap(subject=name, what="whole contact", reason=str(problem)),)
    if not stored.load[: stored.straight].max(initial=0.0) > 0:
        reason = "no step has a pure normal load"
        return (), (Gap(subject=name, what="whole contact", reason=reason),)
    gaps = [Gap(subject=name, what="whole contact: sides", reason=note) for note in scene.notes]
    if stored.straight < len(stored.load):
        later = f"shear or a moment acts from step {stored.straight + 1} on"
        gaps.append(Gap(subject=name, what="whole contact: later steps", reason=later))
    a = float(stored.radius[: stored.straight].max())
    lines = contact_lines(folder, stored, scene)
    if coarser is not None and second is not None:
        try:
            coarser_lines = contact_lines(coarser, second, _scene_of(second))
            lines = with_two_grids(lines, stored, coarser_lines, second, regions=bool(scene.regions))
        except NotJudged as problem:
            gaps.append(Gap(subject=name, what="whole contact: error of the cells", reason=str(problem)))
    lines = with_bars(lines, stored, bars_of(folder), a)
    if scene.cells and not any(line.kind == "stress" for line in lines):
        lacking = "the run stores fewer than five stress points near the axis at centres of cells"
        gaps.append(Gap(subject=name, what="whole contact: stress", reason=lacking))
    case = ContactCase(
        subject=name,
        name="contact",
        parameters={
            **scene.numbers(),
            "loads": [float(load) for load in stored.load[: stored.straight]],
            "mesh": _mesh(scene, a),
            "divisions": list(_divisions(scene, quick=quick)),
            "lines": [[line.profile.name, line.kind, list(line.moments)] for line in lines],
        },
        quick=quick,
        profiles=tuple(line.profile for line in lines),
        lines=lines,
    )
    return (case,), tuple(gaps)


def _scene_of(stored: StoredContact) -> ContactScene:
    return contact_scene(stored.text, float(stored.radius[: stored.straight].max(initial=0.0)))


def _yields(scene: ContactScene) -> bool:
    return any((scene.law, *(region.get("law") for region in scene.regions)))


def _flat(scene: ContactScene) -> float:
    """Radius of the flat part of a punch; 0 without [m]."""
    return max((body.get("flat", 0.0) for body in scene.profile), default=0.0)


def _divisions(scene: ContactScene, *, quick: bool) -> tuple[int, ...]:
    if _yields(scene) or _flat(scene):
        return _COARSE_QUICK if quick else _COARSE_DIVISIONS
    return _QUICK if quick else _DIVISIONS


def _mesh(scene: ContactScene, a: float) -> dict[str, float]:
    """Element size, where it is kept, growth beyond, and reach [m]."""
    yields, flat = _yields(scene), _flat(scene)
    sizes = [a / _ELASTIC, *(layer["thickness"] / _PARTS for layer in scene.layers)]
    for region in scene.regions:
        radii = (region["radius"], region["height"]) if region["kind"] == "ellipsoid" else ()
        sizes += [size / _PARTS for size in radii]
    sizes += [r / _PARTS for r in junctions(scene.profile)]
    fine = max(min(sizes), _SMALLEST * a) if not yields else a / _YIELDING
    mesh = {"radius": a, "fine": fine, "inner": 0.0, "reach": _REACH * a}
    if 0 < flat < a:  # all of the pressure's change is under the rounded edge
        return {
            **mesh, "fine": (a - flat) / _EDGE, "inner": flat, "extent": 2 * a - flat, "deep": 0.0, "growth": _SLOWER
        }  # fmt: skip
    if yields:
        return {**mesh, "extent": _PRESSED * a, "deep": 0.0, "growth": _SLOWER}
    return {**mesh, "extent": _EXTENT * a, "deep": _EXTENT * a, "growth": _GROWTH}
