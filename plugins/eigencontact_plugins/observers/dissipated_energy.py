"""Observer of the friction work: total, largest value per area, and distribution."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from eigencontact.plugin import Observer, StepView, hook_for, require
from eigencontact_plugins.observers.friction_fields import friction_field

__all__ = ["DissipatedEnergy"]


@dataclass(frozen=True, kw_only=True)
class DissipatedEnergy(Observer):
    """Friction work from the first step to the present one.

    Parameters
    ----------
    threshold : float
        Fraction of the largest density [-], at least 0 and below 1; cells with less are not counted. The threshold
        separates patches that are connected only by the error of the solver.

    Notes
    -----
    Energies are cumulative; those of one cycle are differences between two steps. Patches are sets of counted cells
    that share an edge or a corner; a patch across the edge of a periodic window counts as two.
    """

    key: ClassVar[str] = "dissipated-energy"
    units: ClassVar[Mapping[str, str]] = {
        "total": "J",
        "patches": "1",
        "largest_patch": "J",
        "max_density": "J/m2",
        "max_x": "m",
        "max_y": "m",
        "mean_density": "J/m2",
        "spread": "m",
    }
    counted: ClassVar[Sequence[str]] = ("patches", "max_x", "max_y")
    summed: ClassVar[Sequence[str]] = ("total", "largest_patch", "max_density", "mean_density")

    threshold: float = 1e-6

    def __post_init__(self) -> None:
        require(0 <= self.threshold < 1, self.key, "threshold", self.threshold, "0 or more and below 1 [-]")

    def observe(self, step: StepView) -> Mapping[str, float]:
        """Numbers of the density of dissipated energy.

        Returns
        -------
        mapping of str to float
            ``total`` [J]; ``patches``, number of patches, and ``largest_patch``, the largest energy of a patch [J];
            ``max_density`` [J/m²] at ``max_x``, ``max_y`` [m]; ``mean_density`` over the counted cells [J/m²];
            ``spread`` [m], root mean square distance from the centre of the dissipated energy, weighted by it. All are
            0 without slip.

        Raises
        ------
        SceneError
            The run has no friction.
        """
        from scipy.ndimage import label
        from scipy.ndimage import sum as sum_by_label

        density = friction_field(self.key, step, "dissipated_energy_density")
        largest = float(density.max())
        if largest <= 0:
            return dict.fromkeys(self.units, 0.0)
        worked = density > self.threshold * largest
        marks, patches = label(worked, structure=np.ones((3, 3)))
        energies = np.asarray(sum_by_label(density, marks, range(1, patches + 1))) * step.grid.cell_area
        y, x = step.grid.axes()
        row, column = np.unravel_index(int(np.argmax(density)), density.shape)
        weight = density / np.sum(density)
        centre_x, centre_y = np.sum(weight * x), np.sum(weight * y)
        spread = np.sqrt(np.sum(weight * ((x - centre_x) ** 2 + (y - centre_y) ** 2)))
        values = (
            np.sum(density) * step.grid.cell_area,
            patches,
            energies.max(),
            largest,
            step.grid.x[column],
            step.grid.y[row],
            np.mean(density[worked]),
            spread,
        )
        return {name: float(value) for name, value in zip(self.units, values, strict=True)}


eigencontact_register = hook_for(DissipatedEnergy)
