"""Choice of the interiors that represent the eigenstrain and the inhomogeneities of the bodies."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from eigencontact.execution.interiors.interior import Interior

if TYPE_CHECKING:
    from eigencontact.execution.routes.subsurface import Subsurface

__all__ = ["interiors_of"]


def interiors_of(subsurfaces: Sequence[Subsurface], directions: str) -> list[Interior]:
    """Interiors of both bodies: prescribed eigenstrain first, then inhomogeneities."""
    interiors: list[Interior] = []
    for subsurface in subsurfaces:
        if subsurface.prescribed and not subsurface.beside:
            from eigencontact.execution.interiors.prescribed import PrescribedEigenstrain

            interiors.append(PrescribedEigenstrain(subsurface, directions))
    for subsurface in subsurfaces:
        if subsurface.inhomogeneities and subsurface.refined:
            from eigencontact.execution.interiors.finer_cells import two_levels

            interiors += two_levels(subsurface, directions)
        elif subsurface.inhomogeneities and subsurface.in_cells:
            from eigencontact.execution.interiors.cells import Cells
            from eigencontact.execution.interiors.swept_cells import SweptCells, should_sweep

            interiors.append((SweptCells if should_sweep(subsurface) else Cells)(subsurface, directions))
        elif subsurface.inhomogeneities:
            from eigencontact.execution.interiors.polynomial_wholes import PolynomialWholes

            interiors.append(PolynomialWholes(subsurface, directions))
    return interiors
