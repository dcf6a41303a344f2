"""Parity of influence coefficients by mirror symmetry.

A body that is its own mirror image in x answers a mirrored load with the mirrored field. A vector component flips
under the mirror in its own direction, so the coefficient that links load j to component i (or to stress ik) is even
or odd in x as the number of its x-indices is even or odd; the same for y.
"""

from __future__ import annotations

__all__ = ["parity"]


def parity(response: str, load: str) -> tuple[int, int]:
    """Parity ``(in y, in x)`` of an influence coefficient: +1 even, -1 odd.

    Parameters
    ----------
    response : str
        Indices of the response: ``"z"`` for a displacement, ``"xz"`` for a stress.
    load : str
        Direction of the load: ``"x"``, ``"y"`` or ``"z"``.

    Examples
    --------
    >>> parity("z", "z"), parity("x", "z"), parity("xy", "z")
    ((1, 1), (1, -1), (-1, -1))
    """
    indices = response + load
    return (-1) ** indices.count("y"), (-1) ** indices.count("x")
