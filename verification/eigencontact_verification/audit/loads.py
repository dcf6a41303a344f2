"""What of the stored tractions the elements get: smoothed ones of a homogeneous body, each kind by what it displaces.

No mesh knows the field beside a jump of the tractions to what its three sizes promise, unless one of its lines lies
there; rough surfaces and worn edges are full of jumps. Under a homogeneous body the elements get tractions that they
can carry, means over a part of what is loaded; the field of what is left is known in closed form (`homogeneous`).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.fem.loaded_body import LoadedBody, Tractions

__all__ = ["CAUSES", "Effect", "alone", "effects", "less", "smoothed"]

FloatArray = NDArray[np.float64]
#: Tractions, and the components of displacement that they cause.
Effect = tuple[str, tuple[str, ...]]

#: Tractions that displace along x, y and z in the bodies of a contact with friction, by numerics.coupling.
CAUSES = {
    "none": ("x", "y", "z"), "partial": ("xy", "xy", "z"), "one-way": ("xyz", "xyz", "z"), "full": ("xyz",) * 3
}  # fmt: skip
#: Reach of the weights of a mean to either side, in half widths of what is loaded.
_REACH = 0.5


def effects(causes: tuple[str, ...]) -> tuple[Effect, ...]:
    """Kinds of tractions with the components that they displace.

    Examples
    --------
    >>> effects(CAUSES["partial"])
    (('xy', ('u_x', 'u_y')), ('z', ('u_z',)))
    >>> effects(CAUSES["full"])
    (('xyz', ('u_x', 'u_y', 'u_z')),)
    """
    found: dict[tuple[str, ...], str] = {}
    for kind in "xyz":
        moved = tuple(f"u_{axis}" for axis, by in zip("xyz", causes, strict=True) if kind in by)
        found[moved] = found.get(moved, "") + kind
    return tuple((kinds, moved) for moved, kinds in found.items())


def alone(body: LoadedBody, kinds: str) -> LoadedBody:
    """A body under some kinds of its tractions."""
    if body.tractions is None:
        return body
    kept = np.isin(list("xyz"), list(kinds))[:, None, None] * body.tractions.values
    return replace(body, tractions=replace(body.tractions, values=kept) if np.any(kept) else None)


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
        reach = int(_REACH * 0.5 * (edges.size - 1))
        lines.append(edges[0] + size * np.arange(-reach, edges.size + reach))
        weights = 1.0 + np.cos(np.pi * np.arange(-reach, reach + 1) / (reach + 1))
        weights /= weights.sum()
        values = np.apply_along_axis(np.convolve, axis, values, weights)
    return Tractions(x=lines[0], y=lines[1], values=values)


def less(tractions: Tractions, other: Tractions) -> Tractions:
    """Tractions less others, on the cells of the others, which are those of the first and some around."""
    values = -other.values
    rows, columns = ((whole.size - part.size) // 2 for whole, part in ((other.y, tractions.y), (other.x, tractions.x)))
    values[:, rows : values.shape[1] - rows, columns : values.shape[2] - columns] += tractions.values
    return replace(other, values=values)
