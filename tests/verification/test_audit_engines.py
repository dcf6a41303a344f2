"""By which meshes elements are asked in an audit."""

from __future__ import annotations

from typing import Any

import numpy as np

from eigencontact_verification.audit.engines import ratio_for
from eigencontact_verification.fem.loaded_body import Cells, LoadedBody
from eigencontact_verification.fem.model import Region

STRAIN = 1e-3 * np.array([[1.0, 0.4, 0.3], [0.4, -0.5, 0.2], [0.3, 0.2, 0.7]])


def inside(x: Any, y: Any, z: Any) -> Any:
    """Whether points lie in a box about x = 0.2."""
    return (np.abs(x - 0.2) <= 1.0) & (np.abs(y) <= 1.0) & (np.abs(z - 1.0) <= 0.5)


def box(strain: Any) -> LoadedBody:
    """A half-space with an eigenstrain in that box."""
    region = Region(contains=inside, bounds=((-0.8, -1.0, 0.5), (1.2, 1.0, 1.5)), eigenstrain=strain)
    return LoadedBody(young_modulus=2.6, poisson_ratio=0.3, regions=(region,))


def test_only_small_cells_ask_for_the_ratio_two() -> None:
    def cells(count: int) -> LoadedBody:
        edges = np.linspace(0.0, 1.0, count + 1)
        strain = np.ones((3, 3, count, count, count))
        return LoadedBody(
            young_modulus=1.0, poisson_ratio=0.3, cells=(Cells(x=edges, y=edges, z=edges, eigenstrain=strain),)
        )

    assert ratio_for("solid", [box(STRAIN), cells(3)]) == 1.5
    assert ratio_for("solid", [box(STRAIN), cells(8)]) == 2.0
    assert ratio_for("revolution", [box(STRAIN)]) == 2.0
