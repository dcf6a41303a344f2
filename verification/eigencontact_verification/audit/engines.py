"""Which finite elements solve a body, and what they are asked: of revolution where it is, else of three dimensions.

Where a homogeneous half-space carries the tractions, its field is known in closed form (`homogeneous`). Elements are
then asked what layers, inclusions, damage and eigenstrain change of it: the field with them less the field without on
the same mesh, so that the error of the load drops out, the kink beside a jump of the tractions with it; of eigenstrain
alone the field without load. Under layers the half-space is all of the material of the uppermost. A homogeneous body
has nothing to change: there elements get the tractions, smoothed (`loads`).
"""

from __future__ import annotations

from dataclasses import replace
from importlib import import_module
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.audit.loads import less, smoothed
from eigencontact_verification.crosscheck.case import Level, Outer
from eigencontact_verification.fem.loaded_body import LoadedBody, Tractions
from eigencontact_verification.fem.loaded_parity import parities

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = [
    "Engine", "asked", "base_of", "budget_for", "engine_for", "known_tractions", "ratio_for", "solve_body",
    "without_load",
]  # fmt: skip

FloatArray = NDArray[np.float64]
Engine = Literal["revolution", "solid"]

_MODULES: dict[Engine, str] = {
    "revolution": "eigencontact_verification.fem.loaded_revolution",
    "solid": "eigencontact_verification.fem.loaded_solid",
}
#: Unknowns of the fine mesh in three dimensions: quick (a quarter has 27 elements each way), and else.
_BUDGETS = (510_000, 1_200_000)
#: Where the mesh follows small cells: quick, and else. A million take 1.9 GB, and the medium mesh has an eighth.
_FOLLOWING = (2_000_000, 2_800_000)
#: Size of the block in sizes of what loads it: of a homogeneous body, with regions or large cells, with small cells,
#: with layers. The outer faces know the point forces of a homogeneous half-space, all there is far from the first.
#: The print of 'plastic-hertz' is off by 0.06 % of its largest value with 16, by 0.015 % with 32, whatever the outer
#: faces are; under layers u_z of 'coated-sphere' by 0.15 to 0.4 % with 8 and 0.01 % with 32, and u_x of
#: 'coated-fretting', whose coating is as thick as the contact is wide, by 0.1 % with 32, where both faces agree.
_REACHES = (8.0, 16.0, 32.0, 64.0)
#: What is left of all contrasts where a body stands for the matrix alone: its symmetry, and so its mesh, stay the same.
_TRACE = 1e-9


def engine_for(bodies: Sequence[LoadedBody]) -> Engine:
    """One engine for all bodies of a case, because its three meshes have one ratio.

    Of revolution are inclusions on an axis, whose boundary the mesh then follows. Tractions and what cells remember are
    of revolution within the steps of their square cells at best, which the elements would have to leave out: where they
    are all there is, and where a layer keeps them from being split off, they take three dimensions.
    """
    if any(body.cells or not body.regions or (body.tractions and body.layers) for body in bodies):
        return "solid"
    of_revolution = import_module(_MODULES["revolution"]).of_revolution
    return "revolution" if all(of_revolution(body) is not None for body in bodies) else "solid"


def ratio_for(engine: Engine, bodies: Sequence[LoadedBody]) -> float:
    """Element size of a level over that of the next finer one: 2 where halved elements meet faces of small cells."""
    from eigencontact_verification.fem.followed_cells import has_small_cells
    from eigencontact_verification.fem.loaded_mesh import RATIO

    return 2.0 if engine == "revolution" or any(map(has_small_cells, bodies)) else RATIO


def known_tractions(body: LoadedBody) -> Tractions | None:
    """Tractions whose field on a homogeneous half-space is taken from the closed form."""
    if body.tractions is None or _is_split(body):
        return body.tractions
    return less(body.tractions, smoothed(body.tractions))


def _is_split(body: LoadedBody) -> bool:
    """Whether the elements are asked for the change of a field that is known."""
    return bool(body.tractions is not None and (body.regions or body.cells or body.layers))


def base_of(body: LoadedBody) -> tuple[float, float]:
    """Young's modulus and Poisson's ratio of the half-space whose field is known: what the tractions act on."""
    top = body.layers[0] if body.layers else body
    return top.young_modulus, top.poisson_ratio


def asked(body: LoadedBody) -> list[tuple[float, LoadedBody]]:
    """Bodies that the elements solve, each with its sign in the sum."""
    if without_load(body):
        return []
    if not _is_split(body):
        carried = None if body.tractions is None else smoothed(body.tractions)
        return [(1.0, part) for part in parities(replace(body, tractions=carried))]
    stiff = any(region.young_modulus is not None or region.poisson_ratio is not None for region in body.regions)
    if not stiff and not body.layers and all(cells.kept is None for cells in body.cells):
        unloaded = replace(body, tractions=None)
        return [] if without_load(unloaded) else [(1.0, part) for part in parities(unloaded)]
    return [one for part in parities(body) for one in ((1.0, part), (-1.0, _matrix(part)))]


def _matrix(body: LoadedBody) -> LoadedBody:
    """The half-space whose field is known, but for a trace of what regions and cells change."""
    young, nu = base_of(body)
    regions = tuple(
        replace(
            region,
            eigenstrain=_TRACE * region.eigenstrain,
            young_modulus=None if region.young_modulus is None else young * (1.0 + _TRACE),
            poisson_ratio=None if region.poisson_ratio is None else nu,
        )
        for region in body.regions
    )
    cells = tuple(
        replace(
            one,
            eigenstrain=_TRACE * one.eigenstrain,
            kept=None if one.kept is None else 1.0 - _TRACE * (1.0 - one.kept),
        )
        for one in body.cells
    )
    layers = tuple(replace(layer, young_modulus=young, poisson_ratio=nu) for layer in body.layers)
    return replace(body, young_modulus=young, poisson_ratio=nu, layers=layers, regions=regions, cells=cells)


def budget_for(
    engine: Engine, bodies: Sequence[Sequence[LoadedBody]], watched: Sequence[FloatArray],
    read: Sequence[FloatArray], *, ratio: float, quick: bool,
) -> int:  # fmt: skip
    """Unknowns that the fine mesh may have.

    Parameters
    ----------
    engine, bodies
        What solves what: of each body all that `asked` gives.
    watched, read : sequences of (n, 3) arrays
        For each body where fields are read, and where stress is.
    ratio : float
        Of `ratio_for`.
    quick : bool
        Lighter meshes.

    Raises
    ------
    ValueError
        The interfaces of a body ask for more than a solution within 6 GB has.
    """
    if engine == "revolution":
        return 0
    from eigencontact_verification.fem.loaded_mesh import RATIO, family_grid, reach_of
    from eigencontact_verification.fem.loaded_symmetry import centred

    least, most = _BUDGETS if ratio == RATIO else _FOLLOWING
    chosen = least if quick else most
    for parts, points, inner in zip(bodies, watched, read, strict=True):
        for one in parts:
            centre = centred(one)
            far = float(np.abs(points - centre.origin).max(initial=0.0))
            reach = max(reach_of(centre.body, _reaches(one)), 1.25 * far)
            near = inner - centre.origin
            for budget in (chosen, most):
                try:
                    family_grid(centre.body, centre.symmetry, reach, level=0, budget=budget, ratio=ratio, near=near)
                except ValueError:
                    if budget == most:
                        raise
                else:
                    chosen = budget
                    break
    return chosen


def _reaches(body: LoadedBody) -> float:
    from eigencontact_verification.fem.followed_cells import has_small_cells

    if body.layers:
        return _REACHES[3]
    if has_small_cells(body):
        return _REACHES[2]
    return _REACHES[1 if body.regions or body.cells else 0]


def solve_body(
    engine: Engine, body: LoadedBody, *, level: Level, outer: Outer, watched: FloatArray, budget: int, ratio: float,
    read: FloatArray,
) -> Any:  # fmt: skip
    """Solution with ``displacement`` at the points that are watched and ``stress`` at those where it is read."""
    settings: dict[str, Any] = {"level": level, "outer": outer, "watched": watched}
    if engine == "solid":
        settings |= {"budget": budget, "reaches": _reaches(body), "ratio": ratio, "read": read}
    return import_module(_MODULES[engine]).solve_loaded(body, **settings)


def without_load(body: LoadedBody) -> bool:
    """Whether nothing deforms the body."""
    strained = any(np.any(region.eigenstrain) for region in body.regions)
    remembered = any(np.any(cells.eigenstrain) for cells in body.cells)
    return not (strained or remembered or (body.tractions is not None and np.any(body.tractions.values)))
