"""Effects that this package could model and a scene leaves out, with the reason."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from eigencontact.core.cautions import LeftOut
from eigencontact.execution.blocks.block import Block
from eigencontact.model.bodies import layered_bodies
from eigencontact.model.coupling import Coupling
from eigencontact.model.interface import Interface
from eigencontact.model.model import Model
from eigencontact.model.sources import Inhomogeneity

__all__ = ["left_out"]

_SNAP = 1e-6

#: What a choice of ``numerics.half-space`` costs in accuracy.
_PRICE = {
    "image-pressure": "the surface is free of traction only at the centres of the window's cells: the error of stress "
    "within two cells of the surface is up to one half, elsewhere and in the surface displacement some per cent",
    "periodic": "the eigenstrain is periodic in the window, without mean strain in the plane: for a single region, the "
    "error is some per cent if the window is ten times as wide as the region is wide and deep, except for the mean "
    "displacement",
}


def left_out(model: Model, blocks: Iterable[Block]) -> list[LeftOut]:
    """Omitted effects, each with the reason."""
    scene, contact = model.scene, model.interface
    out = _of_the_contact(contact) if contact else [LeftOut("contact", "the scene has no [geometry]")]
    if not scene.stress:
        fields = "sub-surface stress" if contact else "fields below the surface"
        out.append(LeftOut(fields, "the scene has no [[stress]] region"))
    if contact and contact.friction is None and not scene.output.tangential_displacement:
        out.append(LeftOut("displacement along x and y", "output.tangential-displacement is false"))
    if contact and not model.periodic:
        along = " along x" if model.grid.repeats_y else ""
        reason = f'numerics.boundary = "{scene.numerics.boundary}": the half-space is exact'
        out.append(LeftOut(f"periodic images{along}", reason))
    out += [effect for block in blocks for effect in block.left_out(model)]
    if model.sources:
        out += _of_the_eigenstrain(model)
    if scene.numerics.inclusion_refinement == "auto":
        out.append(LeftOut("finer cells at inclusions", "the run chooses them from two runs on coarse cells before it"))
    layer = _layer_that_fills(model)
    if layer is not None:
        reason = (
            f"{layer.name!r}, a flat layer of one material over the whole window, is divided into cells and ends "
            f'with the window; body{layer.body}.medium = {{ type = "bonded-layers", ... }} is exact, and faster'
        )
        out.append(LeftOut("the exact response of a layered body", reason))
    return out


def _of_the_contact(contact: Interface) -> list[LeftOut]:
    """Effects that a contact leaves out."""
    solids = contact.solids
    if contact.friction is not None:
        out = _of_the_coupling(contact.coupling)
    else:
        reason = "the scene prescribes no tangential load and has no friction"
        out = [LeftOut("shear tractions q_x, q_y and their kernels", reason)]
    elastic = [body for body in solids if body is not None]
    if len(elastic) == 2 and elastic[0] == elastic[1]:
        out.append(
            LeftOut("a second kernel for body 2", "both bodies have the same constants: one kernel, counted twice")
        )
    if layered_bodies(solids):
        out.append(
            LeftOut("closed form of the pressure", "a body is layered: only the bare substrate has a closed form")
        )
    if None in solids:
        number = solids.index(None) + 1
        out.append(LeftOut(f"deflection and stress of body {number}", "it is rigid"))
    return out


def _of_the_coupling(coupling: Coupling) -> list[LeftOut]:
    """Effects that the coupling of normal and tangential contact leaves out."""
    reason = f'numerics.coupling = "{coupling.level}"'
    unused = f"{reason}, and no step prescribes a load or shift along it"
    out = [LeftOut(f"shear and displacement along {c}", unused) for c in "xy" if c not in coupling.components]
    if coupling.level == "none" and len(coupling.components) > 1:
        out.append(LeftOut("displacement along y by shear along x, and along x by shear along y", reason))
    if coupling.alike:
        out.append(
            LeftOut(
                "displacement along the surface by pressure, and along its normal by shear",
                "Dundurs' constant is 0: both bodies have equal displacements, the relative displacements vanish, and "
                'coupling "full" and "one-way" are "partial"',
            )
        )
        return out
    if coupling.level in ("none", "partial"):
        out.append(LeftOut("displacement along the surface by pressure", f"{reason}: loads along z cause no slip"))
    if coupling.level != "full":
        goodman = ": the pressure ignores the shear (Goodman's approximation)" if coupling.level == "one-way" else ""
        out.append(LeftOut("displacement along the normal by shear", reason + goodman))
    return out


def _of_the_eigenstrain(model: Model) -> list[LeftOut]:
    """Effects that eigenstrain leaves out."""
    half_space, out = model.numerics.half_space, []
    if model.interface and model.cells.prescribed:
        out.append(
            LeftOut(
                "eigenstrain that follows from the contact",
                "the eigenstrain is prescribed: its field adds to that of the pressure, without feedback",
            )
        )
    if all(source.lattice is None for source in model.sources):
        whole = "numerics.inclusion-resolution is whole" if model.cells.inhomogeneities else ""
        out.append(LeftOut("cells inside the bodies", whole or "every inclusion has a closed form"))
    if half_space == "full-space":
        out.append(
            LeftOut("the free surface in the fields of eigenstrain", 'numerics.half-space = "full-space": no images')
        )
    if half_space in _PRICE:
        out.append(LeftOut("the exact half-space", f'numerics.half-space = "{half_space}": {_PRICE[half_space]}'))
    return out


def _layer_that_fills(model: Model) -> Inhomogeneity | None:
    """Uniform flat layer of one material from the surface over the whole window, if there is one."""
    grid = model.grid
    x0, y0 = (center - 0.5 * size for center, size in zip(grid.center, grid.size, strict=True))
    x1, y1 = x0 + grid.size[0], y0 + grid.size[1]
    for source in model.cells.inhomogeneities:
        if source.material != "isotropic":
            continue
        low, high = source.shape.bounds
        slack = _SNAP * max(grid.sides)
        fills = low[0] <= x0 + slack and low[1] <= y0 + slack and high[0] >= x1 - slack and high[1] >= y1 - slack
        z = (np.arange(8) + 0.5) / 8 * high[2]
        y, x = grid.axes()
        if fills and low[2] <= slack and bool(source.shape.contains(x[..., None], y[..., None], z).all()):
            return source
    return None
