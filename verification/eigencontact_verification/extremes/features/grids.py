"""Grids that transforms dislike: odd, prime, of one row, of one cell; and windows that are too large."""

from __future__ import annotations

from functools import partial

import numpy as np

from eigencontact_verification.extremes.common import apart, ball, dense_error, run
from eigencontact_verification.extremes.feature import Corner, Feature, refusal

__all__ = ["FEATURE"]

CELL = 1e-6


def window(cells: tuple[int, int]) -> float:
    """Pressure on a window of so many cells beside that on 32 x 32 of the same ones; both parities of each axis."""
    fields = []
    for nx, ny in (cells, tuple(32 + n % 2 for n in cells)):
        numerics = {"tolerance": 1e-10}
        scene = ball(grid={"cells": [nx, ny], "size": [nx * CELL, ny * CELL]}, numerics=numerics)
        fields.append(run(scene).dataset["pressure"].values[-1])
    found, right = fields
    wide = np.zeros_like(right) if found.shape[0] <= right.shape[0] else None
    if wide is None:
        found, right = right, found
        wide = np.zeros_like(right)
    rows, columns = ((a - b) // 2 for a, b in zip(right.shape, found.shape, strict=True))
    wide[rows : rows + found.shape[0], columns : columns + found.shape[1]] = found
    return apart(wide, right)


WINDOW = "the window is no part of the answer: the tolerance 1e-10, times the condition of the contact"
DENSE = "the same cells by dense linear algebra: the tolerance 1e-9, times their condition"

FEATURE = Feature(
    key="grids",
    title="Odd, prime and one-cell grids",
    reference="a window of 32 x 32 of the same cells; dense linear algebra",
    corners=(
        *(
            Corner(
                name=f"window of {nx} x {ny}",
                error=partial(window, (nx, ny)),
                bound=1e-7,
                reason=WINDOW,
                quick=nx == 23,
            )
            for nx, ny in ((23, 23), (29, 31), (53, 59), (127, 127), (251, 257))
        ),
        *(
            Corner(
                name=f"{nx} x {ny} cells",
                error=partial(dense_error, (nx, ny), (CELL, CELL), 1e-8),
                bound=1e-7,
                reason=DENSE,
                quick=True,
            )
            for nx, ny in ((1, 1), (2, 1), (1, 13), (13, 1), (2, 2), (3, 2), (7, 13))
        ),
        refusal("1e6 x 1e6 cells", lambda: run(ball(cells=10**6)), "memory", quick=True),
        refusal("no cell", lambda: run(ball(cells=0)), "cells", quick=True),
    ),
)
