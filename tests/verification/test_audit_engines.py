"""What elements are asked in an audit, and by which meshes."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from eigencontact_verification.audit.engines import asked, ratio_for
from eigencontact_verification.fem.loaded_body import Cells, LoadedBody
from eigencontact_verification.fem.loaded_solid import solve_loaded
from eigencontact_verification.fem.loaded_symmetry import centred
from eigencontact_verification.fem.model import Region

STRAIN = 1e-3 * np.array([[1.0, 0.4, 0.3], [0.4, -0.5, 0.2], [0.3, 0.2, 0.7]])
POINTS = np.array([(0.3, 0.2, 0.0), (-0.6, 0.4, 0.9), (1.6, -0.3, 1.2)])


def inside(x: Any, y: Any, z: Any) -> Any:
    """Whether points lie in a box about x = 0.2."""
    return (np.abs(x - 0.2) <= 1.0) & (np.abs(y) <= 1.0) & (np.abs(z - 1.0) <= 0.5)


def box(strain: Any) -> LoadedBody:
    """A half-space with an eigenstrain in that box."""
    region = Region(contains=inside, bounds=((-0.8, -1.0, 0.5), (1.2, 1.0, 1.5)), eigenstrain=strain)
    return LoadedBody(young_modulus=2.6, poisson_ratio=0.3, regions=(region,))


def test_components_of_an_eigenstrain_are_asked_one_by_one_where_each_has_planes_of_symmetry() -> None:
    parts = asked(box(STRAIN))
    assert [sign for sign, _ in parts] == [1.0] * 4
    assert all("none" not in centred(part).symmetry for _, part in parts)
    np.testing.assert_allclose(sum(part.regions[0].eigenstrain for _, part in parts), STRAIN, rtol=1e-15)
    assert len(asked(box(np.diag(np.diag(STRAIN))))) == 1
    beside = replace(
        box(STRAIN), regions=(*box(STRAIN).regions, replace(box(STRAIN).regions[0], bounds=((3, 3, 1), (4, 5, 2)),
        contains=lambda x, y, z: (x > 3) & (x < 4) & (y > 3) & (y < 5) & (z > 1) & (z < 2)))
    )  # fmt: skip
    assert len(asked(beside)) == 1


@pytest.mark.slow
def test_what_the_parts_do_adds_up_to_what_the_whole_does() -> None:
    settings: dict[str, Any] = {"level": 0, "outer": "fixed", "watched": POINTS, "budget": 600_000}
    whole = solve_loaded(box(STRAIN), **settings)
    parts = [solve_loaded(part, **settings) for _, part in asked(box(STRAIN))]
    for ask in ("displacement", "stress"):
        found, wanted = (sum(getattr(one, ask)(POINTS) for one in some) for some in (parts, [whole]))
        assert np.abs(found - wanted).max() < 0.02 * np.abs(wanted).max()


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
