"""Stress of several load steps in a region after a run, computed only at the depths where it is needed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.bulk import BULK_NAMES
from eigencontact.execution.blocks.step import Step
from eigencontact.execution.fields.regions import Region

if TYPE_CHECKING:
    from eigencontact.results.stored import Results

__all__ = ["StressOfSteps"]


class StressOfSteps:
    """Stress at points of a region in stored steps, from their surface fields.

    Stress is linear in the tractions: one operator and one transform serve all steps.

    Parameters
    ----------
    region : Region
        With `Region.by_depths`.
    results : Results
        Results with the surface fields of the steps.
    positions : sequence of int
        Positions of the steps along ``step``.
    """

    def __init__(self, region: Region, results: Results, positions: Sequence[int]) -> None:
        steps = [_step(results, at, region.requires) for at in positions]
        self._shape = region.lattice.shape
        self._steps, self._stresses = len(steps), [cause.of_steps(steps) for cause in region.causes(region.interface)]

    def __call__(self, points: Any) -> FloatArray:
        """Mandel stress ``(steps, 6, n)`` [Pa] at points given by their indices, a slice or a mask."""
        count = self._shape[1] * self._shape[2]
        layer, place = np.divmod(np.arange(self._shape[0] * count)[points], count)
        layers, number = np.unique(layer, return_inverse=True)
        first, *contributions = (stress_of(layers) for stress_of in self._stresses)
        shape = (self._steps, 6, layers.size, count)
        stress = first if first.shape == shape else np.broadcast_to(first, shape).copy()
        for contribution in contributions:
            stress += contribution
        stress = stress.reshape(self._steps, 6, -1)
        if isinstance(points, slice) and layer.size == stress.shape[2]:
            return stress
        return stress[:, :, number * count + place]


def _step(results: Results, at: int, names: frozenset[str]) -> Step:
    """Step with the surface fields and the bulk stress of results."""
    bulk = {name: float(results[name][at]) for names in BULK_NAMES.values() for name in names if name in results}
    fields = {name: np.asarray(results[name][at].values) for name in names}
    return Step(index=int(results["step"][at]), time=0.0, bulk=(bulk, bulk), fields=fields)
