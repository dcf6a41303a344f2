"""The cases of an audit: a stored step against finite elements that carry its tractions."""

from __future__ import annotations

import hashlib
import inspect
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.audit import engines
from eigencontact_verification.audit.bodies import AuditedBody, bodies_of_step, tractions_on
from eigencontact_verification.audit.bulk import bulk_stress_at
from eigencontact_verification.audit.engines import CAUSES, effects, single_effect
from eigencontact_verification.audit.homogeneous import homogeneous_displacement, homogeneous_stress
from eigencontact_verification.audit.lines import Line, middle_of, stress_lines, surface_lines
from eigencontact_verification.audit.sections import Section, draw_section, sections_of
from eigencontact_verification.audit.stored import StoredStep, read_step
from eigencontact_verification.crosscheck.case import UNKNOWNS, Case, Fields, Gap, Level, Outer, error_key
from eigencontact_verification.crosscheck.cell_errors import widened
from eigencontact_verification.crosscheck.lines import STRESSES, chosen, columns
from eigencontact_verification.fem.loaded_body import LoadedBody

__all__ = ["AuditCase", "RunCase", "cases_of", "cases_of_step"]

FloatArray = NDArray[np.float64]

#: Part of a cell by which the boundary of what is cut into cells may be off.
_HALF = 0.5


@dataclass(frozen=True, kw_only=True, eq=False)
class RunCase(Case):
    """Stored values of a run against finite elements."""

    def remedy(self, source: str, excess: float) -> str:  # noqa: ARG002
        """The finer meshes of a full audit, or finer cells of the run; see `Case.remedy`."""
        if source == "judged":
            return "run the scene with finer cells"
        return "repeat without --quick, on finer meshes" if self.quick and source == "discretisation" else ""


@dataclass(frozen=True, kw_only=True, eq=False)
class AuditCase(RunCase):
    """Stored values of a step against finite elements under its tractions.

    The run's own error (`error_key`) counts only where the run cuts into cells what has no cells: inclusions of other
    constants, and damage. Their boundary may be off by half a cell, so that the field which they cause is uncertain by
    what it changes over half a cell. That field is the stored displacement by eigenstrain, and the stored stress less
    that of a homogeneous half-space under the same tractions. Plastic strain is uniform in cells for both methods, and
    closed forms are exact: there the run has no error of its own.

    Parameters
    ----------
    bodies : tuple of AuditedBody
        With tractions.
    engine : {"revolution", "solid"}
    lines : tuple of Line
        Their profiles are `profiles`.
    closed_form : dict
        What is known in closed form, of a homogeneous body under tractions, by body and profile.
    causes : tuple of str
        Tractions that displace along x, y and z; all cause stress.
    budget : int
        Unknowns that the fine mesh may have; 0 where the elements are of revolution.
    window : (float, float)
        Edges of a cell of the surface along x and y.
    sections : tuple of Section
        Planes of stress for pictures.
    """

    #: A whole scene is judged by its field, a kernel by each component: a displacement across the motion of two
    #: hundredths of that along it need not be known to a quarter of itself, but of a twentieth of the field.
    small: ClassVar[float] = 0.05
    code: ClassVar[tuple[str, ...]] = (
        *(f"eigencontact_verification.audit.{name}" for name in ("bulk", "engines", "homogeneous")),
        *(
            f"{__name__}:{name}"
            for name in (
                "AuditCase.reference",
                "_solved_bodies",
                "_read",
                "_read_at",
                "_as_stored",
                "_closed_form",
                "_watched",
            )
        ),
    )

    bodies: tuple[AuditedBody, ...]
    engine: engines.Engine
    lines: tuple[Line, ...]
    closed_form: Fields = field(default_factory=dict)
    causes: tuple[str, ...] = CAUSES["full"]
    budget: int = 0
    window: tuple[float, float] = (0.0, 0.0)
    sections: tuple[Section, ...] = ()

    def reference(self, level: Level, outer: Outer) -> Fields:
        """Fields of the finite elements of all bodies, with what is known of them in closed form."""
        fields = {line.profile.name: np.zeros(line.values.shape) for line in self.lines}
        unknowns = 0
        for body in self.bodies:
            lines = _lines_of(self.lines, body.number)
            for line in lines:
                fields[line.profile.name] += self.closed_form.get(f"{body.number} {line.profile.name}", 0.0)
            for moved, sign, loaded in _solved_bodies(body, self.causes) if lines else ():
                solution = engines.solve_body(
                    self.engine, loaded, level=level, outer=outer, watched=_watched(lines), budget=self.budget,
                    ratio=self.ratio, read=_read_at(lines),
                )  # fmt: skip
                for line in lines:
                    counts = [bool(line.body) or name in moved for name in line.profile.components]
                    if any(counts):
                        fields[line.profile.name] += sign * np.where(
                            counts, _read(solution, line, body, self.window), 0.0
                        )
                unknowns = max(unknowns, int(getattr(solution, "unknowns", 0)))
        return {**fields, UNKNOWNS: np.array([unknowns])}

    def judged(self) -> Fields:
        """Stored values, with the error that cells have where they are an approximation."""
        fields: Fields = {}
        cells = [body.cell for body in self.bodies if body.different or body.damaged]
        edges = np.max(cells, axis=0) if cells else np.zeros(3)
        for line in self.lines:
            name = line.profile.name
            fields[name] = line.values
            error = widened(_HALF * np.max(edges[:, None, None] * line.slopes, axis=0))
            if line.body:
                error = error + _of_blocks(self.bodies, line)
            if np.any(error):
                fields[error_key(name)] = error
        return fields

    @property
    def words(self) -> str:
        """Title of the figures: scene and methods."""
        way = "of revolution" if self.engine == "revolution" else "of three dimensions"
        return f"{self.subject}, {self.name}: stored (semi-analytical) and finite elements {way} under its tractions"

    def pictures(self, folder: Path) -> tuple[Path, ...]:
        """Every stored plane of stress beside that of the medium mesh."""
        return tuple(
            draw_section(section, self._stress(section), self.words, folder / f"{section.name}.png")
            for section in self.sections
        )

    def _stress(self, section: Section) -> FloatArray:
        """Stress ``(m, n, 6)`` of the medium mesh in a plane; nan where none is judged."""
        body = next(body for body in self.bodies if body.number == section.body)
        judged = np.isfinite(section.values).all(axis=-1)
        points, stress = section.points[judged], np.full(section.values.shape, np.nan)
        total = np.zeros((len(points), len(STRESSES)))
        total += homogeneous_stress(engines.known_tractions(body.loaded), points, engines.base_of(body.loaded)[1])
        total += bulk_stress_at(body.bulk, body.loaded, points)
        for sign, loaded in engines.solved_bodies(body.loaded):
            solved = engines.solve_body(
                self.engine, loaded, level=1, outer="fixed", watched=_watched(self.lines), budget=self.budget,
                ratio=self.ratio, read=_read_at(_lines_of(self.lines, body.number)),
            )  # fmt: skip
            total += sign * columns(solved.stress(points), STRESSES)
        stress[judged] = total
        return stress


def _solved_bodies(body: AuditedBody, causes: tuple[str, ...]) -> Iterator[tuple[tuple[str, ...], float, LoadedBody]]:
    """Bodies that the elements solve, with the components of displacement that count and the sign in the sum.

    Inclusions answer all tractions at every level: the elements are asked for what they change under all.
    """
    loaded = body.loaded
    for kinds, moved in effects(CAUSES["full"] if loaded.regions or loaded.cells else causes):
        for sign, solved in engines.solved_bodies(single_effect(loaded, kinds)):
            yield moved, sign, solved


def _of_blocks(bodies: Sequence[AuditedBody], line: Line) -> FloatArray:
    """Error of the stress along a line by the blocks that stand for the smooth strain of cells, see `AuditedBody`."""
    points = np.asarray(line.profile.points)
    error = np.zeros(line.values.shape)
    for body in bodies:
        for x, y, z, size in body.stress_errors if body.number == line.body else ():
            index = [np.searchsorted(edges, points[:, axis], side="right") for axis, edges in enumerate((x, y, z))]
            error += np.pad(size, 1)[index[2], index[1], index[0]][:, None]
    return error


def _lines_of(lines: Sequence[Line], number: int) -> list[Line]:
    return [line for line in lines if line.body in (0, number)]


def _watched(lines: Sequence[Line]) -> FloatArray:
    return np.concatenate([np.empty((0, 3)), *(line.profile.points for line in lines)])


def _read_at(lines: Sequence[Line]) -> FloatArray:
    """Points at which stress is read."""
    return _watched([line for line in lines if line.body])


def _read(solution: Any, line: Line, body: AuditedBody, window: tuple[float, float]) -> FloatArray:
    """Values of a solution as a line stores them."""
    points = line.profile.points
    if line.body:
        return chosen(solution.stress(points), line.profile)
    values = _as_stored(solution.displacement(points), line, body.number)
    columns = [k for k, name in enumerate(line.profile.components) if name in body.means]
    if columns:
        offsets = (
            np.array([(a, b, 0.0) for a in (-1.0, 1.0) for b in (-1.0, 1.0)]) * (*window, 0.0) * 0.5 / np.sqrt(3.0)
        )
        around = [_as_stored(solution.displacement(points + offset), line, body.number) for offset in offsets]
        values[:, columns] = np.mean(around, axis=0)[:, columns]
    return values


def _as_stored(displacement: FloatArray, line: Line, number: int) -> FloatArray:
    """Share of a body in what the surfaces do to each other: along the surface body 1 less body 2, both along z."""
    side = np.array([1.0, 1.0, 1.0] if number == 1 else [-1.0, -1.0, 1.0])
    return chosen(displacement * side, line.profile)


def _closed_form(body: AuditedBody, lines: Sequence[Line], causes: tuple[str, ...]) -> Fields:
    """Field of the body along the lines under bulk stress, and the tractions that the elements do not carry."""
    carried = replace(body.loaded, tractions=engines.known_tractions(body.loaded))
    if carried.tractions is None and not np.any(body.bulk):
        return {}
    fields = {}
    young, nu = engines.base_of(carried)
    for line in _lines_of(lines, body.number):
        points = line.profile.points
        if line.body:
            values = homogeneous_stress(carried.tractions, points, nu)
            values += bulk_stress_at(body.bulk, body.loaded, points)
        else:
            values = np.zeros(line.values.shape)
            for kinds, moved in effects(causes):
                by = homogeneous_displacement(single_effect(carried, kinds).tractions, points, young, nu)
                values += np.isin(line.profile.components, moved) * _as_stored(by, line, body.number)
        fields[f"{body.number} {line.profile.name}"] = values
    return fields


def cases_of(
    path: str | Path, step: int | None = None, *, quick: bool = True
) -> tuple[tuple[AuditCase, ...], tuple[Gap, ...]]:
    """Cases of a step of a run, and what cannot be judged of it, with the reasons.

    Parameters
    ----------
    path : str or Path
        Folder of the run, or its ``results.nc``.
    step : int, optional
        From 1; by default the last.
    quick : bool
        Lighter meshes.
    """
    return cases_of_step(read_step(path, step), quick=quick)


def cases_of_step(stored: StoredStep, *, quick: bool = True) -> tuple[tuple[AuditCase, ...], tuple[Gap, ...]]:
    """`cases_of` a step that is read."""
    if stored.scene.grid.line:
        reason = "the elements under tractions cannot represent a line contact; use --contact"
        return (), (Gap(subject=stored.name, what=f"step {stored.step}", reason=reason),)
    bodies, gaps = bodies_of_step(stored)
    deformable = sum(not body.rigid for body in (stored.scene.body1, stored.scene.body2))
    middle = middle_of(stored)
    bases = {
        body.number: partial(
            homogeneous_stress, tractions_on(stored, body.number), poisson_ratio=engines.base_of(body.loaded)[1]
        )
        for body in bodies
        if body.different or body.damaged
    }
    below, missing = stress_lines(stored, bodies, middle, bases)
    gaps += missing
    above = surface_lines(stored, middle) if len(bodies) == deformable else []
    if len(bodies) < deformable and bodies:
        gaps.append(
            Gap(
                subject=stored.name,
                what="displacement of the surface",
                reason="the elements cannot represent one of the bodies",
            )
        )
    causes = _causes(stored, gaps)
    mixed = any(body.loaded.layers and (body.loaded.regions or body.loaded.cells) for body in bodies)
    if mixed and causes != CAUSES["full"]:
        reason = "inclusions respond to all tractions and layers do not, and the elements compute the sum only"
        gaps.append(Gap(subject=stored.name, what="displacement of the surface", reason=reason))
        above = []
    lines = (*above, *below)
    if not (lines and bodies):
        return (), tuple(gaps)
    try:
        case = _case(stored, bodies, lines, causes=causes, quick=quick)
    except ValueError as problem:
        gaps.append(Gap(subject=stored.name, what=f"step {stored.step}", reason=f"not solved: {problem}"))
        return (), tuple(gaps)
    return (replace(case, sections=sections_of(stored, bodies, middle)),), tuple(gaps)


def _causes(stored: StoredStep, gaps: list[Gap]) -> tuple[str, ...]:
    """Tractions that displace along x, y and z: a contact with friction may leave some out (numerics.coupling)."""
    sheared = any(np.any(stored.surface.get(name, 0.0)) for name in ("shear_x", "shear_y"))
    coupling = stored.scene.numerics.coupling
    if stored.scene.friction is None or coupling == "full" or not sheared:
        return CAUSES["full"]
    missing = "u_z by shear" if coupling == "one-way" else "u_x, u_y by pressure and u_z by shear"
    missing = f"u_x by shear along y, u_y by shear along x, {missing}" if coupling == "none" else missing
    reason = f'the run omits it with numerics.coupling = "{coupling}"'
    gaps.append(Gap(subject=stored.name, what=missing, reason=reason))
    return CAUSES[coupling]


def _case(
    stored: StoredStep, bodies: Sequence[AuditedBody], lines: tuple[Line, ...], *, causes: tuple[str, ...], quick: bool
) -> AuditCase:
    loaded = tuple(
        replace(body, loaded=replace(body.loaded, tractions=tractions_on(stored, body.number))) for body in bodies
    )
    engine = engines.engine_for([body.loaded for body in loaded])
    ratio = engines.ratio_for(engine, [body.loaded for body in loaded])
    visible_bodies = [body for body in loaded if _lines_of(lines, body.number)]
    watched = [_watched(_lines_of(lines, body.number)) for body in visible_bodies]
    read = [_read_at(_lines_of(lines, body.number)) for body in visible_bodies]
    solved = [[solved_body for _, _, solved_body in _solved_bodies(body, causes)] for body in visible_bodies]
    budget = engines.budget_for(engine, solved, watched, read, ratio=ratio, quick=quick)
    closed_form: Fields = {}
    for body in loaded:
        closed_form |= _closed_form(body, lines, causes)
    return AuditCase(
        subject=stored.name,
        name=f"step-{stored.step}",
        parameters={
            "step": stored.step,
            "engine": engine,
            "unknowns allowed": budget,
            "window": list(stored.window.cell),
            "means": [list(body.means) for body in loaded],
            "causes": list(causes),
            "bodies": [digest(body.loaded) for body in loaded],
            "bulk": [body.bulk.tolist() for body in loaded],
        },
        quick=quick,
        profiles=tuple(line.profile for line in lines),
        ratio=ratio,
        bodies=loaded,
        engine=engine,
        lines=lines,
        closed_form=closed_form,
        causes=causes,
        budget=budget,
        window=stored.window.cell,
    )


def digest(body: LoadedBody) -> str:
    """Digest of all numbers of a body; of a region, which is code, its text and what it says on points in its box."""
    sha = hashlib.sha256(f"{body.young_modulus!r} {body.poisson_ratio!r} {body.layers!r}".encode())
    for region in body.regions:
        low, high = np.asarray(region.bounds)
        margin = 0.1 * (high - low)
        x, y, z = np.meshgrid(*(np.linspace(a, b, 41) for a, b in zip(low - margin, high + margin, strict=True)))
        inside = np.asarray(region.contains(x, y, np.maximum(z, 0.0)), dtype=bool)
        sha.update(f"{region.bounds!r} {region.young_modulus!r} {region.poisson_ratio!r}".encode())
        sha.update(region.eigenstrain.tobytes() + np.packbits(inside).tobytes())
        sha.update(inspect.getsource(type(region.contains)).encode())
    for arrays in (*([body.tractions] if body.tractions else []), *body.cells):
        for name, value in vars(arrays).items():
            sha.update(name.encode() + (b"" if value is None else np.ascontiguousarray(value).tobytes()))
    return sha.hexdigest()
