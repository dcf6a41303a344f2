"""Two isotropic solids in thin layers, as one elastic solid."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from eigencontact.plugin import Direction, LinearLaw, Stress, hookimpl, mandel_rotation, require, unit_vector


@dataclass(frozen=True, kw_only=True)
class Laminate(LinearLaw):
    """Thin layers of two isotropic solids in turn, seen from afar.

    Parameters
    ----------
    moduli, poisson_ratios : (float, float)
        Young's moduli [Pa] and Poisson's ratios [-] of the two.
    share : float
        Of the first in the volume [-].
    normal : (float, float, float)
        Direction across the layers, in scene axes, of any length.
    """

    key: ClassVar[str] = "laminate"
    references: ClassVar[tuple[str, ...]] = ("G. E. Backus 1962, J. Geophys. Res. 67, 4427, eq. (13)",)

    moduli: tuple[Stress, Stress]
    poisson_ratios: tuple[float, float]
    share: float
    normal: Direction = (0.0, 0.0, 1.0)

    def __post_init__(self):
        good = all(0 < value < np.inf for value in self.moduli)
        require(good, self.key, "moduli", self.moduli, "positive and finite [Pa]")
        good = all(-1 < value < 0.5 for value in self.poisson_ratios)
        require(good, self.key, "poisson_ratios", self.poisson_ratios, "in (-1, 0.5) [-]")
        require(0 <= self.share <= 1, self.key, "share", self.share, "in [0, 1] [-]")
        unit_vector(self.key, "normal", self.normal)

    def stiffness_matrix(self):
        """Mandel stiffness ``(6, 6)`` [Pa]: strains along the layers are shared, tractions across them too."""
        E, nu = np.array(self.moduli), np.array(self.poisson_ratios)
        shear = 0.5 * E / (1 + nu)
        lame = 2 * shear * nu / (1 - 2 * nu)
        across = lame + 2 * shear

        def mean(values):
            return float(values @ [self.share, 1 - self.share])

        c33 = 1 / mean(1 / across)
        c13 = c33 * mean(lame / across)
        c12 = mean(2 * shear * lame / across) + c13 * c13 / c33
        c66 = mean(shear)
        own = np.diag([c12 + 2 * c66, c12 + 2 * c66, c33, 2 / mean(1 / shear), 2 / mean(1 / shear), 2 * c66])
        own[0, 1] = own[1, 0] = c12
        own[2, :2] = own[:2, 2] = c13
        turn = mandel_rotation(self._frame())
        return turn @ own @ turn.T

    def _frame(self):
        """Rotation whose third column is the normal; which way the others point makes no difference."""
        normal = unit_vector(self.key, "normal", self.normal)
        first = np.cross(np.eye(3)[np.argmin(np.abs(normal))], normal)
        first /= np.linalg.norm(first)
        return np.column_stack([first, np.cross(normal, first), normal])


@hookimpl
def eigencontact_register():
    """Register the law."""
    return [Laminate]
