"""What cells make of the pressure above a void or a ball: estimated, told where it is much, and true."""

import pytest

import eigencontact as ec
from close import close
from eigencontact.model.resolution import cells_above, error_above
from hz_1 import LOAD, NU, P0, RADIUS, A, E

R = 0.25 * A
VOID, STIFF = {"void": True}, {"young-modulus": 10 * E, "poisson-ratio": NU}


def scene(cells, roof, material, **more):
    """A ball of so many cells a radius, its top so many radii deep; one cell lies on the axis."""
    edge = R / cells
    count = 2 * int(1.3 * A / edge) + 1
    return {
        "body1": {"young-modulus": E, "poisson-ratio": NU},
        "geometry": {"type": "sphere", "radius": RADIUS},
        "grid": {"cells": count, "size": [count * edge] * 2},
        "steps": {"normal-load": LOAD},
        "inclusions": {"type": "sphere", "center": [0, 0, (1 + roof) * R], "radius": R, "material": material},
        "output": {"pictures": False},
        **more,
    }


@pytest.mark.parametrize(("roof", "cells", "told"), [(0.25, 8, True), (0.6, 8, False), (0.5, 4, True), (1.0, 5, False)])
def test_cells_that_miss_the_promise_below_a_thin_roof_are_told(roof, cells, told):
    planned = ec.plan(scene(cells, roof, VOID))
    estimate = 0.4 / (roof * cells) ** 2
    assert "; pressure above them within some " in planned.explain()
    found = [(one.code, one.error) for one in planned.cautions]
    assert found == ([("inclusion-cells", close(estimate, rel=0.02))] if told else [])
    assert not told or f"has {roof * cells:.2g} cells between its top and the surface" in planned.cautions[0].words


def test_softer_and_stiffer_than_the_body_differ():
    assert error_above(2, 0.0, 1.0) == close(0.1, rel=1e-12)
    assert error_above(2, 1.0, 10.0) == close(0.014625, rel=1e-12)
    assert error_above(2, 1.0, 1.0) == 0.0
    assert error_above(0.1, 0.0, 1.0) == close(0.625, rel=1e-12)
    assert error_above(cells_above(0.02, 0.1, 1.0), 0.1, 1.0) == close(0.02, rel=1e-12)
    assert [one.code for one in ec.plan(scene(8, 0.25, STIFF)).cautions] == []


def test_a_region_of_few_cells_is_told_and_a_layer_on_the_surface_is_not():
    pin = {"type": "cylinder", "axis": "x", "center": [0, 0, 2 * R], "radius": R, "length": 8 * R, "eigenstrain": 1e-3}
    (caution,) = ec.plan(scene(1, 1.0, VOID, inclusions=pin, numerics={"allow-coarse": True})).cautions[1:]
    assert caution.code == "inclusion-cells"
    assert "has 2 cells across its narrowest extent, fewer than 4" in caution.words
    coat = {"type": "cuboid", "center": [0, 0, 0.5 * R], "edges": [6 * R, 6 * R, R], "material": STIFF}
    assert ec.plan(scene(8, 1.0, VOID, inclusions=coat)).cautions == ()


@pytest.mark.slow
@pytest.mark.parametrize(("roof", "material", "least"), [(0.5, VOID, 0.0), (0.25, STIFF, 1.0)], ids=["void", "stiff"])
def test_the_estimate_bounds_the_error_and_is_of_its_size(roof, material, least):
    """Coarse cells against three times finer ones, whose own error is a ninth."""

    def middle(cells):
        pressure = ec.run(scene(cells, roof, material)).dataset["pressure"][-1].values
        return float(pressure[len(pressure) // 2, len(pressure) // 2]) / P0

    fine = middle(12)
    error = abs(middle(4) - fine) / max(1.0, fine)
    estimate = error_above(4 * roof, least, 1.0 if least == 0.0 else 10.0)
    assert error < estimate < 4.0 * error
