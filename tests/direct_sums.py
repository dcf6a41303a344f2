"""Fields of the cells of a lattice as sums of the closed form of a cuboid, for tests of faster sums."""

import numpy as np

from eigencontact.halfspace.points import unit_fields_at_points
from eigencontact_plugins.shapes.cuboid import Cuboid


def sum_of_cells(source, points, strain, **options):
    """Sum over the cells that have eigenstrain ``(6, *shape)``, at points (x, y, z).

    Cells of one layer have one closed form, at points moved by the place of each cell.
    """
    x, y, z = (np.asarray(values, dtype=float) for values in points)
    total = 0.0
    for layer, depth in enumerate(source.centres(2)):
        rows, columns = np.nonzero(strain[:, layer].any(axis=0))
        if not rows.size:
            continue
        cell = Cuboid(center=(0.0, 0.0, depth), edges=source.pitch)
        at_x = (x - source.centres(0)[columns][:, None]).ravel()
        at_y = (y - source.centres(1)[rows][:, None]).ravel()
        units = unit_fields_at_points(cell, (at_x, at_y, np.tile(z, rows.size)), **options)
        units = units.reshape(*units.shape[:2], rows.size, x.size)
        total = total + np.einsum("uc,uncp->np", strain[:, layer, rows, columns], units)
    return total
