"""Cells that yield are of second order: reciprocity with the contact, prints that converge, linear cells left alone."""

from types import SimpleNamespace

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact.execution.interiors.linked_cells import linked_cells
from eigencontact.execution.interiors.swept_cells import SweptCells
from eigencontact.plugin import Material
from eigencontact.solvers.second_order import linked_faces

A = 20e-6
STEEL = {"young_modulus": "210 GPa", "poisson_ratio": 0.3}
PERFECT = {"type": "j2", "hardening": {"type": "perfect", "yield_stress": "7344 MPa"}}


def indentation(count, per_radius, first="6.4 N", steps=10):
    """EP-2: a rigid sphere of 200 um radius on a perfectly plastic body, and its removal."""
    scene = ec.Scene(
        body1={**STEEL, "law": PERFECT},
        body2={"rigid": True},
        geometry={"type": "sphere", "radius": "200 um"},
        grid={"cells": [count, count], "size": [count * A / per_radius] * 2},
        steps=[{"normal_load": first}, {"normal_load": "12.307 N", "increments": steps}, {"normal_load": "0 N"}],
        numerics={"inclusion_pitch": A / per_radius},
        output={"pictures": False},
    )
    return ec.run(scene).dataset


@pytest.fixture(scope="module")
def prints():
    """Depth of the print by cells per contact radius, with a cell on the axis."""
    return {n: indentation(3 * n + 1, n) for n in (4, 8)}


@pytest.mark.slow
def test_prints_come_to_the_limit_of_many_cells(prints):
    """77.53 nm at ten steps from the onset, by extrapolation of runs with up to 24 cells per contact radius.

    Means in place of centre values give 71.0 nm at 8 cells on an even grid and 73.7 nm on this one.
    """
    depth = {n: float(data["print_depth"][-1]) * 1e9 for n, data in prints.items()}
    assert depth[8] == close(77.06, rel=2e-3)
    assert abs(depth[4] - 77.53) > abs(depth[8] - 77.53)


@pytest.mark.slow
@pytest.mark.parametrize(("per_radius", "difference"), [(8, 0.8), (12, 0.3)])
def test_an_even_grid_reads_nearly_the_same_print(per_radius, difference):
    """The axis lies between four cells: the difference is of second order. Known from another program, in nm."""
    depth = [float(indentation(3 * per_radius + more, per_radius)["print_depth"][-1]) * 1e9 for more in (0, 1)]
    assert abs(depth[1] - depth[0]) < difference + 0.05  # to the digit that is known


def test_residuals_hold():
    assert float(indentation(10, 3, steps=3)["law_residual"].max()) < 1e-4


MATRIX = Material(young_modulus=210e9, poisson_ratio=0.3)
SHAPE = (2, 3, 4)
CELLS = np.arange(24)


def faces_of(law, fraction=None, matrix=MATRIX):
    content = SimpleNamespace(fraction=np.ones(SHAPE) if fraction is None else fraction, shape=SHAPE)
    places = tuple(np.zeros(24) for _ in "xyz")
    return linked_cells(content, [(law, CELLS)], places, matrix)


def test_laws_that_begin_as_the_matrix_are_linked_and_others_are_not():
    law = ec.make("j2", **STEEL, hardening={"type": "perfect", "yield_stress": "1 GPa"})
    for found, expected in zip(faces_of(law), linked_faces([CELLS], SHAPE), strict=True):
        np.testing.assert_array_equal(found, expected)
    assert faces_of(law, matrix=Material(young_modulus=200e9, poisson_ratio=0.3)) is None


def test_cut_cells_are_not_linked():
    law = ec.make("j2", **STEEL, hardening={"type": "perfect", "yield_stress": "1 GPa"})
    fraction = np.ones(SHAPE)
    fraction[0, 0, 0] = 0.8
    found = faces_of(law, fraction)
    expected = linked_faces([CELLS[1:]], SHAPE)
    assert all(np.array_equal(one, other) for one, other in zip(found, expected, strict=True))


def test_traction_and_eigenstrain_are_reciprocal():
    """Work of the tractions on the displacement by eigenstrain is that of their stress on the eigenstrain."""
    plan = ec.plan({
        "body1": {**STEEL, "law": {**PERFECT, "hardening": {"type": "perfect", "yield_stress": "2 GPa"}}},
        "geometry": {"type": "sphere", "radius": "105 um"},
        "grid": {"cells": [9, 9], "size": ["18 um", "18 um"]},
        "friction": {"type": "coulomb", "coefficient": 0.3},
        "steps": {"normal_load": "0.65 N", "tangential_load_x": "0.1 N"},
        "numerics": {"coupling": "full"},
    })  # fmt: skip
    (interior,) = [part for part in plan.parts if isinstance(part, SweptCells)]
    grid, tractions = interior._grid, interior._tractions
    interior.start()
    assert interior._faces is not None
    random = np.random.default_rng(5)
    strain = random.standard_normal((6, *interior._content.shape))
    fields = {item.field: random.standard_normal(grid.shape) for item in tractions}
    moved = interior.mean_displacement(strain)
    stress = interior.applied(fields)
    volume = float(np.prod(interior._box.cells(grid).pitch))
    area = grid.dx * grid.dy
    outer = area * sum(float((fields[item.field] * row).sum()) for item, row in zip(tractions, moved, strict=True))
    assert outer == close(volume * float((stress * strain).sum()), rel=1e-10)
