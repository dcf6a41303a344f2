"""Cells without end along y, the cross-sections of line contacts in plane strain."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.halfspace.potentials import HasCornerPotentials, Order

__all__ = ["EndlessCell"]


@dataclass(frozen=True, slots=True)
class EndlessCell:
    """Cell of infinite length along y.

    A lattice of one row of such cells then gives fields of plane strain: kernels differ along x and z alone, and those
    with a derivative along y vanish.
    """

    cell: HasCornerPotentials

    @property
    def key(self) -> str:
        """Name of the plugin of the cell."""
        return str(getattr(self.cell, "key", "cell"))

    def corner(self, potential: str, orders: Sequence[Order], x: Any, y: Any, z: Any) -> FloatArray:
        """See `HasCornerPotentials.corner`."""
        return self.cell.corner(potential, orders, x, np.copysign(np.inf, y), z)
