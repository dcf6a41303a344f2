"""Smooth borders of regions of cells, for maps with large cells."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.core.grid import Box

if TYPE_CHECKING:
    from matplotlib.path import Path
    from numpy.typing import NDArray

__all__ = ["extended", "smooth_border"]

#: Width of the smoothing in cells: the root of this part of the shorter side of the region. A circle then shrinks by
#: a tenth of a cell, whatever its size.
SHARE = 0.1
#: Smallest width of the smoothing [cells].
NARROWEST = 0.8
#: Largest width of the smoothing [cells].
WIDEST = 3.0
#: A smooth border may move the middles of this part of the cells along the border to its other side.
MOVED = 0.2
#: Points across a region at which its border is looked for, at least.
POINTS = 64
#: Regions narrower than this many cells keep the edges of their cells.
FEWEST = 6


def smooth_border(region: NDArray[np.bool_], x: NDArray[Any], y: NDArray[Any]) -> Path | None:
    """Closed smooth lines around a region of cells; None if it has too few cells or smoothing changes the region.

    `x` and `y`, (nx + 1,) and (ny + 1,), are the edges of the cells. There is one line around each part and each hole;
    lines around holes run the other way.
    """
    from contourpy import contour_generator
    from matplotlib.path import Path
    from scipy.interpolate import RectBivariateSpline
    from scipy.ndimage import gaussian_filter

    box = Box.around(region)
    if box is None or min(box.shape) < FEWEST:
        return None
    width = float(np.clip(np.sqrt(SHARE * min(box.shape)), NARROWEST, WIDEST))
    share = gaussian_filter(region.astype(float), width, mode="nearest")
    border = sum(int(np.count_nonzero(np.diff(region, axis=axis))) for axis in (0, 1))  # edges of cells along it
    moved = np.count_nonzero((share > 0.5) != region)
    if moved > MOVED * border or _pieces(share > 0.5) != _pieces(region):
        return None
    # One more cell on each side, of zeros at the outer edge: lines close along the edge of the picture.
    share = np.pad(share, 1, mode="edge")
    middles = [0.5 * (edges[1:] + edges[:-1]) for edges in (x, y)]
    cells = [at[1] - at[0] for at in middles]
    middles = [np.concatenate([[at[0] - cell], at, [at[-1] + cell]]) for at, cell in zip(middles, cells, strict=True)]
    finer = -(-POINTS // min(box.shape))
    if finer > 1:
        coarse = middles
        middles = [np.linspace(at[0], at[-1], finer * (at.size - 1) + 1) for at in coarse]
        share = RectBivariateSpline(*coarse[::-1], share)(*middles[::-1])
    middles = [np.concatenate([[2 * at[0] - at[1]], at, [2 * at[-1] - at[-2]]]) for at in middles]
    lines = contour_generator(x=middles[0], y=middles[1], z=np.pad(share, 1)).lines(0.5)
    return Path.make_compound_path(*(Path(np.asarray(line), closed=True) for line in lines))


def extended(field: NDArray[Any], region: NDArray[np.bool_]) -> NDArray[Any]:
    """Field with the values of the nearest cell inside a region in all cells outside, to interpolate at its border."""
    from scipy.ndimage import distance_transform_edt

    index = distance_transform_edt(~region, return_distances=False, return_indices=True)
    return np.asarray(field[tuple(index)])


def _pieces(region: NDArray[np.bool_]) -> tuple[int, int]:
    """Number of connected parts of a region, and of the cells around it."""
    from scipy.ndimage import label

    return int(label(region)[1]), int(label(~region)[1])
