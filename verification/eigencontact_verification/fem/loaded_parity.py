"""Tractions without planes of symmetry as a sum of even and odd ones, each of which a quarter of a mesh carries.

A body of layers has every vertical plane of symmetry; only its tractions may lack them. Its response is linear, so that
the sum of the responses to the parts is that to the whole. A quarter of the block has elements half as long along x
and y for the same number of unknowns.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.fem.loaded_body import LoadedBody
from eigencontact_verification.fem.loaded_symmetry import TOLERANCE, centred, reflected

__all__ = ["parities"]

FloatArray = NDArray[np.float64]


def parities(body: LoadedBody) -> tuple[LoadedBody, ...]:
    """Bodies whose tractions add up to those of a body, each even or odd about planes across x and y.

    Parameters
    ----------
    body : LoadedBody
        With tractions; with regions or cells, or with cells of the surface that no plane reflects onto each other, it
        is returned as it is.

    Examples
    --------
    >>> from eigencontact_verification.fem.loaded_body import Tractions
    >>> edges = np.arange(4.0)
    >>> push = np.zeros((3, 3, 3))
    >>> push[2, 0, 0] = 1.0
    >>> body = LoadedBody(young_modulus=1.0, poisson_ratio=0.3, tractions=Tractions(x=edges, y=edges, values=push))
    >>> parts = parities(replace(body, tractions=Tractions(x=edges, y=edges, values=push + push[:, ::-1, ::-1])))
    >>> [part.tractions.values[2, 0].tolist() for part in parts]
    [[0.5, 0.0, 0.5], [0.5, 0.0, -0.5]]
    """
    if body.tractions is None or body.regions or body.cells or not body.tractions.values.any():
        return (body,)
    centre = centred(body)
    loads = centre.body.tractions
    assert loads is not None
    parts, least = [loads.values], TOLERANCE * float(np.abs(loads.values).max())
    for plane, kind in enumerate(centre.symmetry):
        if kind != "none":
            continue
        edges = (loads.x, loads.y)[plane]
        middle = 0.5 * float(edges[0] + edges[-1])
        turn = np.where(np.arange(3) == plane, -1.0, 1.0)[:, None, None]
        halves: list[FloatArray] = []
        for values in parts:
            mirror = reflected(values, edges, middle, 2 - plane)
            if mirror is None:
                return (body,)
            halves += [0.5 * (values + turn * mirror), 0.5 * (values - turn * mirror)]
        parts = halves
    x, y = loads.x + centre.origin[0], loads.y + centre.origin[1]
    kept = [values for values in parts if np.abs(values).max() > least]
    return tuple(replace(body, tractions=replace(loads, x=x, y=y, values=values)) for values in kept)
