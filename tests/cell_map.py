"""Materials of the cells of a box."""

import numpy as np

from eigencontact_plugins.laws.map import IsotropicPoints


class CellMap:
    """Isotropic constants of every cell of a box."""

    def __init__(self, young_modulus, poisson_ratio):
        self.constants = [np.ravel(values) for values in (young_modulus, poisson_ratio)]

    def of_cells(self, index):
        E, nu = (values[index] for values in self.constants)
        return IsotropicPoints(young_modulus=E, poisson_ratio=nu)
