"""Audit of line contacts with layers, inclusions and eigenstrain: verdicts, convergence of cells, planted faults."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import eigencontact as ec
from eigencontact_verification.audit import contact_cases_of
from verdicts import rows_of

P, NU = np.pi / 4, 0.3
E = 1 - NU**2  # contact modulus 1, Hertz's half width 1


def case_of(folder, scene):
    ec.run(scene, folder).dataset.close()
    (case,), gaps = contact_cases_of(folder)
    assert not gaps
    return case


def largest(rows, kind):
    """Largest difference of a kind of profile by the largest value of its field."""
    return max(row.difference for (name, _), row in rows.items() if name.startswith(kind))


def with_region(case, number, **changes):
    """The case with the elements of a faulty scene: numbers of a region of the first body by which they differ."""
    body, *others = case.parameters["bodies"]
    regions = list(body["regions"])
    regions[number] = regions[number] | changes
    return replace(case, parameters=case.parameters | {"bodies": [body | {"regions": regions}, *others]})


@pytest.mark.slow
def test_coated_cylinder(tmp_path):
    """The bundled scene agrees; a coating of another modulus or thickness by a tenth is caught."""
    case = case_of(tmp_path / "run", ec.load_scene("coated-cylinder", ["output.pictures=false"]))
    rows = rows_of(case)
    assert {row.word for row in rows.values()} == {"agrees"}
    for kind, bound in (("half width", 1e-3), ("pressure", 2e-3), ("stress", 1e-3)):
        assert largest(rows, kind) < bound
    for fault in ({"young_modulus": 440e9}, {"bottom": 55e-6}):
        wrong = rows_of(with_region(case, 0, **fault))
        assert wrong["pressure, step 1", "s_zz"].word == "disagrees"
        assert sum(row.word == "disagrees" for (name, _), row in wrong.items() if name.startswith("stress")) >= 2


def pressed(strips, **tables):
    """A rigid cylinder of radius 1 on a body with something in it; cells as wide and high as the strips."""
    pitch = 3.0 / strips
    section = {"shape": "plane", "name": "section", "normal": "y", "depth-max": 1.5, "depth-cells": strips}
    base = {
        "name": "line",
        "body1": {"young-modulus": E, "poisson-ratio": NU},
        "body2": {"rigid": True},
        "geometry": {"type": "cylinder", "radius": 1.0, "length": "infinite"},
        "grid": {"length": "infinite", "cells": strips, "size": 3.0},
        "steps": [{"normal-load": P}],
        "numerics": {"inclusion-pitch": pitch},
        "stress": [section],  # twice as many points as cells along z, so that every second one is a cell's middle
        "output": {"pictures": False},
    }
    return base | tables


def bar(radius=0.4, depth=0.7, **material):
    """Circular cylinder along the line."""
    place = {"type": "cylinder", "center": [0.0, 0.0, depth], "radius": radius, "length": 2.0, "axis": "y"}
    return [{**place, "material": material}]


def root_mean_square(case, reference, name):
    """Difference along a line by the largest stress of the reference."""
    scale = max(
        np.abs(reference[line.profile.name]).max() for line in case.lines if line.kind in ("stress", "pressure")
    )
    return float(np.sqrt(np.mean((case.judged()[name] - reference[name]) ** 2)) / scale)


@pytest.mark.slow
def test_cells_of_a_void_converge_towards_the_elements(tmp_path):
    """With order 1, as the boundary cuts cells: to .11 % of the largest stress; a radius wrong by a tenth is caught."""
    cases = [case_of(tmp_path / str(n), pressed(n, inclusions=bar(void=True))) for n in (31, 61, 121)]
    edge, pressure = "stress near the edge, step 1, section", "pressure, step 1"
    references = [case.reference(2, "fixed") for case in cases]
    pairs = list(zip(cases, references, strict=True))
    errors = [root_mean_square(*pair, edge) for pair in pairs]
    order = np.polyfit(np.log([1.0, 2.0, 4.0]), -np.log(errors), 1)[0]
    assert 0.8 < order < 1.3
    assert errors[-1] < 1.5e-3
    pressures = [root_mean_square(*pair, pressure) for pair in pairs]
    assert pressures[2] < pressures[1] < pressures[0]
    assert pressures[2] < 4e-3
    wrong = with_region(cases[-1], 0, half_width=0.44, half_height=0.44).reference(2, "fixed")
    assert root_mean_square(cases[-1], wrong, edge) > 5 * errors[-1]
    assert root_mean_square(cases[-1], wrong, pressure) > 5 * pressures[-1]


@pytest.mark.slow
def test_a_stiff_bar_agrees(tmp_path):
    """Of four times the modulus, with cells of a fortieth of the half width; half as stiff is caught."""
    stiff = {"young-modulus": 4 * E, "poisson-ratio": 0.2}
    case = case_of(tmp_path / "run", pressed(121, inclusions=bar(**stiff)))
    rows = rows_of(case)
    assert {row.word for row in rows.values()} == {"agrees"}
    assert largest(rows, "pressure") < 3e-3
    assert largest(rows, "stress") < 6e-3
    wrong = rows_of(with_region(case, 0, young_modulus=2 * E))
    assert wrong["stress in the middle, step 1, section", "s_xx"].word == "disagrees"
    assert wrong["pressure, step 1", "s_zz"].word == "disagrees"


@pytest.mark.slow
def test_strained_rectangles_agree(tmp_path):
    """A box and a patch of the surface with eigenstrain of their own; a tenth more, and another sign, are caught."""
    box = {"type": "cuboid", "center": [0.25, 0.0, 0.5], "edges": [0.6, 1.0, 0.4], "eigenstrain": [0.04, 0.01, -0.02]}
    patch = {"type": "uniform", "value": 0.02, "depth": 0.15, "size": [1.0, 1.0], "center": [-0.5, 0.0]}
    case = case_of(tmp_path / "run", pressed(120, inclusions=[box], eigenstrain=[patch]))
    rows = rows_of(case)
    assert {row.word for row in rows.values()} == {"agrees"}
    assert largest(rows, "pressure") < 5e-3
    assert largest(rows, "stress") < 3e-3
    for number, eigenstrain in ((0, [0.044, 0.011, -0.022, 0.0]), (1, [0.02, 0.02, -0.02, 0.0])):
        wrong = rows_of(with_region(case, number, eigenstrain=eigenstrain))
        assert any(row.word == "disagrees" for (name, _), row in wrong.items() if name.startswith("stress"))


@pytest.mark.slow
@pytest.mark.parametrize(("strips", "ratio"), [(30, 20.0), (31, 4.0)])
def test_the_error_of_ten_cells_that_cut_a_bar_is_estimated(strips, ratio, tmp_path):
    """Half of a cell in depth alone is 1.2 times too small; a bar a quarter as stiff is still caught."""
    stiff = {"young-modulus": ratio * E, "poisson-ratio": 0.3}
    case = case_of(tmp_path / "run", pressed(strips, inclusions=bar(depth=0.6, **stiff)))
    assert all(row.word != "disagrees" for row in rows_of(case).values())
    wrong = rows_of(with_region(case, 0, young_modulus=ratio * E / 4))
    assert any(row.word == "disagrees" for (name, _), row in wrong.items() if name.startswith("stress"))


def without_bulk(case):
    """The case with the elements of a scene without bulk stress."""
    steps = [[p, q, 0.0, 0.0, place] for p, q, _, _, place in case.parameters["steps"]]
    return replace(case, parameters=case.parameters | {"steps": steps})


@pytest.mark.slow
def test_a_layer_under_bulk_stress(tmp_path):
    """With friction, on the medium mesh of the quick audit; elements without the bulk stress are wrong by 30 times."""
    layers = [{"thickness": 0.3, "young-modulus": 2 * E, "poisson-ratio": 0.25}]
    substrate = {"young-modulus": E, "poisson-ratio": NU}
    steps = [{"normal-load": P}, {"normal-load": P, "bulk-stress-xx": 0.1}, {"tangential-load-x": 0.2 * P}]
    scene = pressed(
        60, body1={"medium": {"type": "bonded-layers", "substrate": substrate, "layers": layers}}, steps=steps,
        friction={"type": "coulomb", "coefficient": 0.5},
    )  # fmt: skip
    case = case_of(tmp_path / "run", scene)
    reference = case.reference(1, "fixed")
    name = "stress in the middle, step 3, section"
    error = root_mean_square(case, reference, name)
    assert error < 3e-3
    assert root_mean_square(case, without_bulk(case).reference(1, "fixed"), name) > 30 * error


@pytest.mark.slow
def test_an_inclusion_under_bulk_stress(tmp_path):
    stiff = {"young-modulus": 4 * E, "poisson-ratio": 0.2}
    steps = [{"normal-load": P}, {"normal-load": P, "bulk-stress-xx": 0.3}]
    case = case_of(tmp_path / "run", pressed(121, inclusions=bar(**stiff), steps=steps))
    name = "stress in the middle, step 2, section"
    error = root_mean_square(case, case.reference(1, "fixed"), name)
    assert error < 5e-3
    assert root_mean_square(case, without_bulk(case).reference(1, "fixed"), name) > 20 * error


@pytest.mark.parametrize(
    ("tables", "reason"),
    [
        ({"inclusions": bar(void=True) + bar(radius=0.2, depth=0.5, void=True)}, "boxes around two inclusions overlap"),
        pytest.param(
            {"inclusions": [{**bar()[0], "axis": "z", "length": 0.4, "material": {"void": True}}]}, "no cross-section",
            marks=pytest.mark.slow,
        ),
        ({"eigenstrain": [{"type": "uniform", "value": 0.01, "depth": 0.2}]}, "fills the window"),
    ],
)  # fmt: skip
def test_what_is_not_covered_is_said(tables, reason, tmp_path):
    ec.run(pressed(15, stress=[], **tables), tmp_path / "run").dataset.close()
    cases, (gap,) = contact_cases_of(tmp_path / "run")
    assert not cases
    assert reason in gap.reason
