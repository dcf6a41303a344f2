"""Finite elements of a body: of revolution where it is of revolution, else of three dimensions; and their loads.

The field of tractions on a homogeneous half-space is known in closed form (`homogeneous`). Elements compute the change
of this field by layers, inclusions, damage and eigenstrain: the field with them less the field without them on the same
mesh. The error of the load and the kink beside a jump of the tractions then cancel. For eigenstrain alone the elements
have no load. Below layers the half-space is of the material of the uppermost layer.

A homogeneous body has no such change; its elements carry the tractions. No mesh knows the field beside a jump of the
tractions to the accuracy of its three sizes, unless one of its lines lies there; rough surfaces and worn edges are full
of jumps. So the elements carry smoothed tractions, means over a part of the loaded area. The field of the difference is
known in closed form.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.crosscheck.case import Level, Outer
from eigencontact_verification.fem.loaded_body import LoadedBody, Tractions
from eigencontact_verification.fem.loaded_parity import parities

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = [
    "CAUSES",
    "Effect",
    "Engine",
    "base_of",
    "budget_for",
    "effects",
    "engine_for",
    "known_tractions",
    "less",
    "ratio_for",
    "single_effect",
    "smoothed",
    "solve_body",
    "solved_bodies",
    "without_load",
]  # fmt: skip

FloatArray = NDArray[np.float64]
Engine = Literal["revolution", "solid"]
#: Tractions, and the components of displacement that they cause.
Effect = tuple[str, tuple[str, ...]]

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
#: Tractions that displace along x, y and z in the bodies of a contact with friction, by numerics.coupling.
CAUSES = {
    "none": ("x", "y", "z"), "partial": ("xy", "xy", "z"), "one-way": ("xyz", "xyz", "z"), "full": ("xyz",) * 3
}  # fmt: skip
#: Reach of the weights of a mean to either side, in half widths of what is loaded.
_SPREAD = 0.5


def engine_for(bodies: Sequence[LoadedBody]) -> Engine:
    """One engine for all bodies of a case, because its three meshes have one ratio.

    Of revolution are inclusions on an axis, whose boundary the mesh then follows. Tractions and what cells remember are
    of revolution within the steps of their square cells at best, which the elements would have to leave out: where they
    are all there is, and where a layer keeps them from being split off, they take three dimensions.
    """
    if any(body.cells or not body.regions or (body.tractions and body.layers) for body in bodies):
        return "solid"
    from eigencontact_verification.fem.revolution import of_revolution

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
    """Whether the elements compute only the change of the field of the tractions."""
    return bool(body.tractions is not None and (body.regions or body.cells or body.layers))


def base_of(body: LoadedBody) -> tuple[float, float]:
    """Young's modulus and Poisson's ratio of the half-space whose field is known: what the tractions act on."""
    top = body.layers[0] if body.layers else body
    return top.young_modulus, top.poisson_ratio


def solved_bodies(body: LoadedBody) -> list[tuple[float, LoadedBody]]:
    """Bodies that the elements solve, each with its sign in the sum."""
    if without_load(body):
        return []
    if not _is_split(body):
        carried = None if body.tractions is None else smoothed(body.tractions)
        return [(1.0, parity) for parity in parities(replace(body, tractions=carried))]
    stiff = any(region.young_modulus is not None or region.poisson_ratio is not None for region in body.regions)
    if not stiff and not body.layers and all(cells.stiffness_factor is None for cells in body.cells):
        unloaded = replace(body, tractions=None)
        return [] if without_load(unloaded) else [(1.0, parity) for parity in parities(unloaded)]
    return [signed for parity in parities(body) for signed in ((1.0, parity), (-1.0, _matrix(parity)))]


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
            block,
            eigenstrain=_TRACE * block.eigenstrain,
            stiffness_factor=None if block.stiffness_factor is None else 1.0 - _TRACE * (1.0 - block.stiffness_factor),
        )
        for block in body.cells
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
        What solves what: of each body all bodies of `solved_bodies`.
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
    for solved, points, inner in zip(bodies, watched, read, strict=True):
        for body in solved:
            centre = centred(body)
            far = float(np.abs(points - centre.origin).max(initial=0.0))
            reach = max(reach_of(centre.body, _reaches(body)), 1.25 * far)
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
    if engine == "revolution":
        from eigencontact_verification.fem import loaded_revolution

        return loaded_revolution.solve_loaded(body, **settings)
    from eigencontact_verification.fem import loaded_solid

    return loaded_solid.solve_loaded(body, **settings, budget=budget, reaches=_reaches(body), ratio=ratio, read=read)


def without_load(body: LoadedBody) -> bool:
    """Whether nothing deforms the body."""
    strained = any(np.any(region.eigenstrain) for region in body.regions)
    remembered = any(np.any(cells.eigenstrain) for cells in body.cells)
    return not (strained or remembered or (body.tractions is not None and np.any(body.tractions.values)))


# --- loads ------------------------------------------------------------------------------------------------------------


def effects(causes: tuple[str, ...]) -> tuple[Effect, ...]:
    """Kinds of tractions with the components that they displace.

    Examples
    --------
    >>> effects(CAUSES["partial"])
    (('xy', ('u_x', 'u_y')), ('z', ('u_z',)))
    >>> effects(CAUSES["full"])
    (('xyz', ('u_x', 'u_y', 'u_z')),)
    """
    components: dict[tuple[str, ...], str] = {}
    for kind in "xyz":
        moved = tuple(f"u_{axis}" for axis, by in zip("xyz", causes, strict=True) if kind in by)
        components[moved] = components.get(moved, "") + kind
    return tuple((kinds, moved) for moved, kinds in components.items())


def single_effect(body: LoadedBody, kinds: str) -> LoadedBody:
    """A body under some kinds of its tractions."""
    if body.tractions is None:
        return body
    values = np.isin(list("xyz"), list(kinds))[:, None, None] * body.tractions.values
    return replace(body, tractions=replace(body.tractions, values=values) if np.any(values) else None)


def smoothed(tractions: Tractions) -> Tractions:
    """Means of tractions over half of what is loaded, along x and along y, weighted as a raised cosine.

    The force stays. Cells, which have one size, are added around: the means reach beyond what is loaded.

    Examples
    --------
    >>> edges = np.arange(17.0)
    >>> push = np.ones((3, 16, 16))
    >>> found = smoothed(Tractions(x=edges, y=edges, values=push))
    >>> found.values.shape, found.force.round(9).tolist()
    ((3, 24, 24), [256.0, 256.0, 256.0])
    """
    values, lines = tractions.values, []
    for axis, edges in ((2, tractions.x), (1, tractions.y)):
        size = (edges[-1] - edges[0]) / (edges.size - 1)
        reach = int(_SPREAD * 0.5 * (edges.size - 1))
        lines.append(edges[0] + size * np.arange(-reach, edges.size + reach))
        weights = 1.0 + np.cos(np.pi * np.arange(-reach, reach + 1) / (reach + 1))
        weights /= weights.sum()
        values = np.apply_along_axis(np.convolve, axis, values, weights)
    return Tractions(x=lines[0], y=lines[1], values=values)


def less(tractions: Tractions, smooth: Tractions) -> Tractions:
    """Tractions less others, on the cells of the others, which are those of the first and some around."""
    values = -smooth.values
    rows, columns = (
        (wide.size - narrow.size) // 2 for wide, narrow in ((smooth.y, tractions.y), (smooth.x, tractions.x))
    )
    values[:, rows : values.shape[1] - rows, columns : values.shape[2] - columns] += tractions.values
    return replace(smooth, values=values)
