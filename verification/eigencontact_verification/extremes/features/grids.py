"""Grids that transforms dislike: odd, prime, of one row, of one cell; and windows that are too large."""

from __future__ import annotations

import numpy as np

from eigencontact_verification.extremes.common import apart, ball, dense_error, run
from eigencontact_verification.extremes.feature import Feature, family, refusal

__all__ = ["FEATURE"]

CELL = 1e-6


def window(*cells: int) -> float:
    """Pressure on a window of so many cells beside that on 32 x 32 of the same ones; both parities of each axis."""
    fields = []
    for nx, ny in (cells, tuple(32 + n % 2 for n in cells)):
        numerics = {"tolerance": 1e-10}
        scene = ball(grid={"cells": [nx, ny], "size": [nx * CELL, ny * CELL]}, numerics=numerics)
        fields.append(run(scene).dataset["pressure"].values[-1])
    pressure, right = fields
    wide = np.zeros_like(right) if pressure.shape[0] <= right.shape[0] else None
    if wide is None:
        pressure, right = right, pressure
        wide = np.zeros_like(right)
    rows, columns = ((a - b) // 2 for a, b in zip(right.shape, pressure.shape, strict=True))
    wide[rows : rows + pressure.shape[0], columns : columns + pressure.shape[1]] = pressure
    return apart(wide, right)


WINDOW = "the window is no part of the answer: the tolerance 1e-10, times the condition of the contact"
DENSE = "the same cells by dense linear algebra: the tolerance 1e-9, times their condition"

WINDOWS = ((23, 23), (29, 31), (53, 59), (127, 127), (251, 257))
SHAPES = ((1, 1), (2, 1), (1, 13), (13, 1), (2, 2), (3, 2), (7, 13))

FEATURE = Feature(
    key="grids",
    title="Odd, prime and one-cell grids",
    reference="a window of 32 x 32 of the same cells; dense linear algebra",
    corners=(
        *family("window of {} x {}", window, WINDOWS, bound=1e-7, reason=WINDOW, quick={(23, 23)}),
        *family(
            "{} x {} cells", dense_error, {cells: (cells, (CELL, CELL), 1e-8) for cells in SHAPES}, bound=1e-7,
            reason=DENSE, quick=True,
        ),
        refusal("1e6 x 1e6 cells", lambda: run(ball(cells=10**6)), "memory", quick=True),
        refusal("no cell", lambda: run(ball(cells=0)), "cells", quick=True),
    ),
)  # fmt: skip
