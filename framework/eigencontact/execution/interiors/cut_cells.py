"""Cells cut by a boundary with a nonlinear law: one law combined from two."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from eigencontact.core.array_types import FloatArray, IntArray
from eigencontact.core.material import Material
from eigencontact.execution.interiors.material_cells import MaterialCells
from eigencontact.plugin import ConstitutiveLaw, LawStep
from eigencontact.solvers.laminate import Laminate, resistance

__all__ = ["CutCells"]


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class CutStep(LawStep):
    """Points and time of an evaluation in cut cells; see `eigencontact.solvers.laminate.Cut`."""

    fraction: FloatArray
    resistance: FloatArray
    difference: FloatArray
    last_response: dict[str, FloatArray] = field(default_factory=dict)

    def of(self, points: slice | IntArray) -> CutStep:
        """Evaluation at some of the points."""
        names = "x", "y", "z", "fraction", "resistance", "difference"
        return replace(self, means={}, last_response={}, **{name: getattr(self, name)[..., points] for name in names})


@dataclass(frozen=True, eq=False)
class CutCells:
    """Cut cells of one pair of laws, as flat indices."""

    law: Any
    cells: IntArray
    fraction: FloatArray
    resistance: FloatArray

    @classmethod
    def all_of(cls, content: MaterialCells, matrix: Material) -> list[CutCells]:
        """Cut cells of the content of a box."""
        pairs = []
        for first, second, cells in content.cuts():
            # A degrading law may lose its stiffness across a layer; the equation then has no solution. The stiffness of
            # a ball stays positive.
            layered = first.symmetric and second.symmetric
            normals = content.across(cells) if layered else np.zeros((3, cells.size))
            share = content.fraction.ravel()[cells]
            pairs.append(cls(Laminate(first, second), cells, share, resistance(matrix, normals)))
        return pairs

    def step(self, step: LawStep, content: MaterialCells) -> CutStep:
        """Evaluation of these cells as laminates."""
        return CutStep(
            x=step.x, y=step.y, z=step.z, time=step.time, duration=step.duration, fraction=self.fraction,
            resistance=self.resistance, difference=content.difference(self.cells, step.time),
        )  # fmt: skip

    def parts(
        self, variables: Mapping[str, FloatArray]
    ) -> Iterator[tuple[ConstitutiveLaw, FloatArray, Mapping[str, FloatArray]]]:
        """Each law, its fractions of the cells, and its internal variables."""
        shares = self.fraction, 1.0 - self.fraction
        yield from zip((self.law.first, self.law.second), shares, self.law.parts(variables), strict=True)
