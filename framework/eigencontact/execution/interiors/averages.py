"""Means of internal variables over a neighbourhood, for nonlocal laws."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.array_types import FloatArray
from eigencontact.plugin import ConstitutiveLaw, LawStep
from eigencontact.solvers.neighbourhood import Neighbourhood, reach_of

__all__ = ["Averages"]


class Averages:
    """Variables that the laws of a box average over a neighbourhood, as fields of the box.

    Parameters
    ----------
    laws : sequence of (law, cells)
        Flat indices of the cells of each law.
    shape : (int, int, int)
        Shape of the box.
    edges : (float, float, float)
        Edges of a cell along z, y, x [m].

    Attributes
    ----------
    width : (int, int, int)
        Width of the outermost neighbourhoods in cells along z, y, x; 1 without neighbourhoods.
    """

    def __init__(
        self,
        laws: Sequence[tuple[ConstitutiveLaw, NDArray[np.intp]]],
        shape: tuple[int, int, int],
        edges: tuple[float, float, float],
    ) -> None:
        self._shape, self._laws = shape, laws
        # Law, variable, rows of the fields, neighbourhood.
        self._parts: list[tuple[int, str, slice, Neighbourhood]] = []
        reach, rows = [(0, 0, 0)], 0
        for number, (law, cells) in enumerate(laws):
            inside = np.zeros(shape, dtype=bool)
            inside.reshape(-1)[cells] = True
            for name, radius in law.averaged.items():
                count = law.variables[name].components
                about = Neighbourhood(inside, edges, radius)
                self._parts.append((number, name, slice(rows, rows + count), about))
                reach.append(reach_of(radius, edges))
                rows += count
        self._rows = rows
        k, j, i = (int(most) + 1 for most in np.max(reach, axis=0))
        self.width = k, j, i

    def of(self, variables: Sequence[Mapping[str, FloatArray]]) -> FloatArray:
        """Fields ``(rows, nz, ny, nx)`` of the means of the variables of each law; zero in other cells."""
        out = np.zeros((self._rows, *self._shape))
        for number, name, rows, about in self._parts:
            out[rows].reshape(rows.stop - rows.start, -1)[:, self._laws[number][1]] = about.means(
                variables[number][name]
            )
        return out

    def with_means(self, steps: Sequence[LawStep], fields: FloatArray) -> list[LawStep]:
        """Law steps with the means of these fields."""
        means: list[dict[str, FloatArray]] = [{} for _ in steps]
        for number, name, rows, _ in self._parts:
            flat = fields[rows].reshape(rows.stop - rows.start, -1)
            means[number][name] = flat[:, self._laws[number][1]]
        return [replace(step, means=values) for step, values in zip(steps, means, strict=True)]
