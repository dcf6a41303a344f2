"""Pictures of a case: its semi-analytical line, its coarse mesh in space, its field in a section."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.crosscheck.pictures.section import CELLS, SAMPLES, SAMPLES_CUT, draw_section
from eigencontact_verification.crosscheck.pictures.space import Body, block, draw_space, revolved
from eigencontact_verification.crosscheck.pictures.subject import Field, Subject

if TYPE_CHECKING:
    from eigencontact_verification.crosscheck.case import Case, Curve, Profile
    from eigencontact_verification.crosscheck.inclusions import InclusionCase
    from eigencontact_verification.crosscheck.lines import Contains
    from eigencontact_verification.crosscheck.tractions import RectangleCase

__all__ = ["curve", "inclusion_pictures", "rectangle_pictures"]

FloatArray = NDArray[np.float64]

#: Points of a drawn line for each point that is compared.
_CLOSER = 8


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
    from eigencontact_verification.crosscheck.lines import chosen

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


def _subject(case: Case, contains: Contains, bounds: Sequence[Sequence[float]], field: Field, samples: int) -> Subject:
    units = {profile.quantity: profile.unit for profile in case.profiles}
    return Subject(
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
    from eigencontact_verification.crosscheck.inclusions import shape_of

    shape = shape_of(case.parameters["shape"])
    field, samples = case.field, SAMPLES
    if case.parameters["cut"]:  # a picture needs fewer cells than a verdict
        field, samples = partial(case.field, cells=CELLS), SAMPLES_CUT
    subject = _subject(case, shape.contains, shape.bounds, field, samples)
    if case.parameters["elements"] == "axisymmetric":
        from eigencontact_verification.fem.axisymmetric import solve_axisymmetric

        return _pictures(subject, solve_axisymmetric(case.axisymmetric_model(0, "fixed")), revolved, folder)
    from eigencontact_verification.fem.solve import solve

    return _pictures(subject, solve(case.solid_model(0, "fixed")), block, folder)


def rectangle_pictures(case: RectangleCase, folder: Path) -> tuple[Path, ...]:
    """Write mesh.vtu, mesh.png and section.png of a traction's coarse model."""
    from eigencontact_verification.fem.solve import solve

    a, b = case.parameters["half_widths"]
    thin = 1e-3 * min(a, b)

    def loaded(x: FloatArray, y: FloatArray, z: FloatArray) -> NDArray[np.bool_]:
        return np.asarray((np.abs(x) <= a) & (np.abs(y) <= b) & (np.abs(z) <= thin))

    subject = _subject(case, loaded, ((-a, -b, 0.0), (a, b, thin)), case.field, SAMPLES)
    return _pictures(subject, solve(case.model(0, reach=case.parameters["reach"])), block, folder)


def _pictures(subject: Subject, solution: Any, body: Callable[..., Body], folder: Path) -> tuple[Path, ...]:
    folder.mkdir(parents=True, exist_ok=True)
    files = folder / "mesh.vtu", folder / "section.png", folder / "mesh.png"
    solution.write_vtu(files[0])
    draw_section(subject, solution, files[1])
    try:
        draw_space(subject, solution, body(subject, solution), files[2])
    except Exception as problem:  # not every machine can render
        raise RuntimeError(f"mesh.png could not be drawn ({problem}); mesh.vtu and section.png were") from problem
    return files
