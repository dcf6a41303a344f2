"""Checks of geometries: finite separations that broadcast, the same ones each time."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.arrays import real_answer
from eigencontact.plugin import HasNativeGrid
from eigencontact_verification.conformance.report import check, ensure, ensure_pure
from eigencontact_verification.conformance.sampling import evenly

FloatArray = NDArray[np.float64]


def _places(geometry: Any) -> tuple[FloatArray, FloatArray]:
    """Points within a hundredth of the smallest length among the fields, or on the grid the geometry brings."""
    if isinstance(geometry, HasNativeGrid):
        grid = geometry.native_grid()
        return np.asarray(grid.x[:5], float), np.asarray(grid.y[:5], float)
    lengths = [float(np.min(np.abs(value))) for value in vars(geometry).values() if isinstance(value, float) and value]
    x, y, _ = 0.01 * min(lengths, default=1e-3) * evenly(5).T
    return x, y


@check
def check_separation_arrays(geometry: Any) -> None:
    """Answers broadcast to the shape of the points and are finite, each point for itself."""
    x, y = _places(geometry)
    for case, (a, b) in {"(1, nx), (ny, 1)": (x[None, :], y[:, None]), "(n,)": (x, y), "(1,)": (x[:1], y[:1])}.items():
        shape = np.broadcast_shapes(a.shape, b.shape)
        answer = real_answer(geometry.separation(a, b), f"separation of geometry {geometry.key!r}", shape)
        ensure(
            np.all(np.isfinite(answer)), f"separation at points of shape {case}", "finite near the origin",
            f"{int(np.sum(~np.isfinite(answer)))} of {answer.size} that are not", "take the limit there",
        )  # fmt: skip
    grid = np.broadcast_to(geometry.separation(x[None, :], y[:, None]), (y.size, x.size))
    full = np.broadcast_to(geometry.separation(*np.broadcast_arrays(x[None, :], y[:, None])), (y.size, x.size))
    ensure(np.array_equal(grid, full), "separation of axes that broadcast", "that of full arrays", "something else", "")


@check
def check_separation_pure(geometry: Any) -> None:
    """Same answer twice; inputs stay as they were, and may be read-only."""
    x, y = (coordinate.copy() for coordinate in _places(geometry))
    ensure_pure("separation", lambda: geometry.separation(x, y), (x, y))
