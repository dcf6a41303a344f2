"""Even and odd parts of tractions: they add up, each has two planes of symmetry, and their sum answers as the whole."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from eigencontact_verification.audit.homogeneous import homogeneous_displacement
from eigencontact_verification.fem.loaded_body import Cells, LoadedBody, Tractions
from eigencontact_verification.fem.loaded_parity import parities
from eigencontact_verification.fem.loaded_solid import solve_loaded
from eigencontact_verification.fem.loaded_symmetry import centred

NU = 0.3


@pytest.fixture
def crooked() -> LoadedBody:
    """Tractions of all three components that no plane reflects, away from the origin."""
    edges = np.linspace(-1.0, 1.0, 13)
    middle = (edges[1:] + edges[:-1]) / 2
    values = np.zeros((3, 12, 12))
    values[0] = middle[:, None] > middle
    values[1, :4, :5] = 0.5
    values[2, 7:, 2:4] = 1.0
    return LoadedBody(
        young_modulus=1.0, poisson_ratio=NU, tractions=Tractions(x=edges + 0.4, y=edges - 3.0, values=values)
    )


def test_parts_add_up_and_each_has_two_planes_of_symmetry(crooked: LoadedBody) -> None:
    parts = parities(crooked)
    assert len(parts) == 4
    total: NDArray[np.float64] = sum((part.tractions.values for part in parts if part.tractions), np.zeros((3, 12, 12)))
    assert crooked.tractions is not None
    np.testing.assert_allclose(total, crooked.tractions.values, atol=1e-15)
    assert {centred(part).symmetry for part in parts} == {(a, b) for a in ("even", "odd") for b in ("even", "odd")}
    assert centred(crooked).symmetry == ("none", "none")


def test_a_plane_that_is_there_is_not_split(crooked: LoadedBody) -> None:
    assert crooked.tractions is not None
    loads = crooked.tractions
    pressed = np.zeros_like(loads.values)
    pressed[2] = np.maximum(0.0, 1.0 - (loads.x[:-1] - loads.x[:-1].mean()) ** 2)
    pressed[2, :3] = 0.0
    body = LoadedBody(young_modulus=1.0, poisson_ratio=NU, tractions=Tractions(x=loads.x, y=loads.y, values=pressed))
    assert [centred(part).symmetry for part in parities(body)] == [("even", "even")]  # symmetric about its own middle


def test_a_body_with_cells_is_left_as_it_is(crooked: LoadedBody) -> None:
    edges = np.array([0.0, 1.0])
    cells = Cells(x=edges, y=edges, z=edges, eigenstrain=np.ones((3, 3, 1, 1, 1)))
    body = LoadedBody(young_modulus=1.0, poisson_ratio=NU, tractions=crooked.tractions, cells=(cells,))
    assert parities(body) == (body,)


@pytest.mark.slow
def test_the_sum_of_the_responses_is_nearer_to_point_forces_than_one_mesh_of_the_same_size(crooked: LoadedBody) -> None:
    x = np.linspace(-0.9, 1.7, 12)
    points = np.stack([x, np.full(12, -2.9), np.zeros(12)], axis=-1)
    known = homogeneous_displacement(crooked.tractions, points, 1.0, NU)

    def error(*bodies: LoadedBody) -> float:
        found = [
            solve_loaded(one, level=1, outer="fixed", watched=points, budget=40_000).displacement(points)
            for one in bodies
        ]
        return float(np.abs(np.sum(found, axis=0) - known).max() / np.abs(known).max())

    assert error(*parities(crooked)) < 0.6 * error(crooked)
    assert error(*parities(crooked)) < 0.04
