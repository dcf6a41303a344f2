"""Cells of a body as finite elements take them: stored plastic strain and damage, eigenstrain that is not uniform."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.audit.moduli import NotJudged, moduli_of
from eigencontact_verification.fem.loaded_body import Cells

if TYPE_CHECKING:
    from eigencontact.model.sources import Inhomogeneity, Source
    from eigencontact_verification.audit.shape_region import ShapeRegion
    from eigencontact_verification.audit.stored import StoredStep

__all__ = [
    "cell_of_shapes",
    "lattice_of",
    "sampled",
    "smooth_cells",
    "stored_cells",
    "stress_differences",
    "tensor_of",
    "under_bulk",
]

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

#: Layers of cells of a patch that names no number of its own.
_PATCH_LAYERS = 32
#: Cells across a shape that is filled by an eigenstrain that is not uniform.
_ACROSS = 24


def stored_cells(stored: StoredStep, number: int, *, remembers: bool) -> tuple[tuple[Cells, ...], bool]:
    """Plastic strain and damage of the cells of a body, and whether there is damage."""
    if not remembers:
        return (), False
    unloaded = all(stored.scalars.get(name, 0.0) == 0.0 for name in ("max_plastic_strain", "max_damage"))
    if stored.step not in stored.histories:
        if unloaded and "max_plastic_strain" in stored.scalars:
            return (), False
        steps = ", ".join(str(step) for step in stored.histories) or "none"
        raise NotJudged(
            f"the results do not store the state of the body after step {stored.step} (stored steps: {steps}); "
            'run with output.history = "all"'
        )
    strain, damage = stored.history.get(f"plastic_strain_{number}"), stored.history.get(f"damage_{number}")
    if strain is None and damage is None:
        return (), False
    shape = (strain[0] if strain is not None else damage).shape  # type: ignore[union-attr]
    tensor = np.zeros((3, 3, *shape)) if strain is None else tensor_of(np.nan_to_num(strain))
    stiffness = None if damage is None else 1.0 - np.nan_to_num(damage)
    if stiffness is not None and not np.any(stiffness < 1.0):
        stiffness = None
    x, y, z = (_edges(line) for line in stored.lattices[number])
    z[0] = 0.0 if abs(z[0]) < 1e-6 * z[-1] else z[0]
    return (Cells(x=x, y=y, z=z, eigenstrain=tensor, stiffness_factor=stiffness),), stiffness is not None


def smooth_cells(block: Cells, sources: list[Inhomogeneity], material: Any, *, own_law: bool) -> Cells:
    """Cells of uniform strain that act as the smooth field with the stored strain at their centres.

    A law answers at the centre of its cell. A block of the strain of its centre acts as a field that is smoothed over
    the edges of the cell; its second differences undo that to second order. Cells that a boundary cuts keep their
    strain, and so do cells of laws with other elastic constants.
    """
    sides = np.meshgrid(block.z, block.y, block.x, indexing="ij")
    corner_law = np.full(sides[0].shape, int(own_law))
    for number, source in enumerate(sources, 2):
        constants = material.young_modulus, material.poisson_ratio
        uniform = bool(source.law.variables) and not source.law.varies
        alike = uniform and np.allclose(moduli_of(source.law, material), constants, atol=0)
        inside = source.shape.contains(sides[2], sides[1], sides[0])
        corner_law[inside] = number if alike else 0
    windows = np.lib.stride_tricks.sliding_window_view(corner_law, (2, 2, 2)).reshape(
        *(n - 1 for n in corner_law.shape), 8
    )
    law = np.where(windows.min(axis=-1) == windows.max(axis=-1), windows[..., 0], 0)
    strain = block.eigenstrain.copy()
    for axis in range(3):
        first, second = np.moveaxis(law, axis, 0)[:-1], np.moveaxis(law, axis, 0)[1:]
        difference = np.diff(np.moveaxis(block.eigenstrain, axis + 2, 0), axis=0)
        flow = np.where(((first == second) & (first > 0))[:, None, None], difference, 0.0) / 24.0
        moved = np.moveaxis(strain, axis + 2, 0)
        moved[:-1] -= flow
        moved[1:] += flow
    return replace(block, eigenstrain=strain)


def stress_differences(
    block: Cells, smooth: Cells, material: Any
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Edges of cells, and the size of the stress of the difference of two strains in each, if it could not relax."""
    size = np.sqrt(((block.eigenstrain - smooth.eigenstrain) ** 2).sum(axis=(0, 1)))
    return block.x, block.y, block.z, material.young_modulus / (1.0 + material.poisson_ratio) * size


def under_bulk(block: Cells, strain: FloatArray) -> Cells:
    """Cells with the eigenstrain by which damaged cells answer the strain (3, 3) of the bulk stress; see `bulk`."""
    if block.stiffness_factor is None:
        return block
    added = strain[:, :, None, None, None] * (1.0 / block.stiffness_factor - 1.0)
    return replace(block, eigenstrain=block.eigenstrain + added)


def sampled(source: Source, stored: StoredStep) -> Cells:
    """Eigenstrain that is not uniform, by its value in the middle of cells; a patch has the cells of the run."""
    low, high = (np.asarray(corner, dtype=float) for corner in source.shape.bounds)
    if hasattr(source.shape, "key"):
        lines = [np.linspace(low[axis], high[axis], _ACROSS + 1) for axis in range(3)]
    else:
        lines = []
        for axis, edges in enumerate(stored.window.edges):
            first, last = (int(np.argmin(np.abs(edges - corner[axis]))) for corner in (low, high))
            lines.append(edges[first : last + 1])
        lines.append(np.linspace(0.0, high[2], (source.layers or _PATCH_LAYERS) + 1))
    middles = [0.5 * (line[1:] + line[:-1]) for line in lines]
    z, y, x = np.meshgrid(middles[2], middles[1], middles[0], indexing="ij")
    field = source.field.eigenstrain(x.ravel(), y.ravel(), z.ravel(), stored.time)
    mandel = np.asarray(field, dtype=float).reshape(6, *z.shape)
    inside = np.asarray(source.shape.contains(x, y, z), dtype=bool)
    return _merged(lines[0], lines[1], lines[2], tensor_of(np.where(inside, mandel, 0.0)))


def _merged(x: FloatArray, y: FloatArray, z: FloatArray, tensor: FloatArray) -> Cells:
    """Cells in which equal neighbours along x or y are joined."""

    def starts(axis: int) -> BoolArray:
        jumps = np.any(np.diff(tensor, axis=axis) != 0.0, axis=tuple(k for k in range(tensor.ndim) if k != axis))
        return np.concatenate([[True], jumps])

    columns, rows = starts(4), starts(3)
    return Cells(
        x=np.append(x[:-1][columns], x[-1]), y=np.append(y[:-1][rows], y[-1]), z=z,
        eigenstrain=tensor[..., rows, :][..., columns],
    )  # fmt: skip


def lattice_of(stored: StoredStep, number: int) -> tuple[tuple[float, float, float], Any]:
    """Edges of the cells of a body, and their box."""
    if number not in stored.lattices:
        return (0.0, 0.0, 0.0), None
    lines = [_edges(line) for line in stored.lattices[number]]
    sizes = tuple(float(line[1] - line[0]) for line in lines)
    return sizes, (tuple(float(line[0]) for line in lines), tuple(float(line[-1]) for line in lines))  # type: ignore[return-value]


def cell_of_shapes(stored: StoredStep, regions: list[ShapeRegion]) -> tuple[float, float, float]:
    """Edges of the cells of shapes without a closed form: the window's; in depth a share of the thinnest shape."""
    thinnest = min(region.bounds[1][2] - region.bounds[0][2] for region in regions)
    numerics = stored.scene.numerics
    return (*stored.window.cell, numerics.inclusion_pitch or thinnest / numerics.inclusion_cells)


def _edges(middles: FloatArray) -> FloatArray:
    """Edges of cells of one size by their middles."""
    size = (middles[-1] - middles[0]) / (middles.size - 1) if middles.size > 1 else 2.0 * middles[0]
    return np.asarray(middles[0] + (np.arange(middles.size + 1) - 0.5) * size)


def tensor_of(mandel: FloatArray) -> FloatArray:
    """Tensors ``(3, 3, ...)`` of Mandel vectors ``(6, ...)``: shear by the root of 2."""
    xx, yy, zz = mandel[:3]
    yz, xz, xy = mandel[3:] / np.sqrt(2.0)
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
