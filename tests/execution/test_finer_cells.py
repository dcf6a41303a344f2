"""Finer cells at inclusions in bodies that yield: nearer to wholes and to finer grids, reciprocal, stored, refused."""

from types import SimpleNamespace

import numpy as np
import pytest

import eigencontact as ec
from bodies import STEEL_TABLE as STEEL
from close import close
from eigencontact.errors import SceneError
from eigencontact.execution.interiors.finer_cells import CoarseCells, FinerCells, join_levels
from eigencontact.execution.mechanics.coupled import _by_body
from hz_1 import LOAD, NU, P0, RADIUS, A, E

KEY = "numerics.inclusion-refinement"


def ball(**more):
    material = {"young-modulus": 2.0 * E, "poisson-ratio": NU}
    return {"type": "sphere", "center": [0.0, 0.0, 0.75 * A], "radius": 0.33 * A, "material": material, **more}


def scene(refinement=2, per_radius=4, yield_stress=0.55 * P0, steps=None, **numerics):
    cells = 2 * round(1.3 * per_radius) + 1
    hardening = {"type": "perfect", "yield-stress": yield_stress}
    return {
        "body1": {**STEEL, "law": {"type": "j2", "hardening": hardening}},
        "geometry": {"type": "sphere", "radius": RADIUS},
        "grid": {"cells": cells, "size": [cells * A / per_radius] * 2},
        "steps": steps or [{"normal-load": LOAD}, {"normal-load": 0.0}],
        "inclusions": [ball()],
        "numerics": {
            "inclusion-pitch": A / per_radius, "inclusion-refinement": refinement, "tolerance": 1e-6, **numerics
        },
        "output": {"pictures": False},
    }  # fmt: skip


REGION = {"shape": "points", "points": [[0, 0, 0.3 * A], [0.1 * A, 0, 1.2 * A]], "name": "before"}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("refined")


@pytest.fixture(scope="module")
def refined(folder):
    return ec.run({**scene(), "stress": [REGION]}, folder)


@pytest.mark.slow
def test_the_print_over_a_stiff_ball():
    """Case EP-12 (finite elements: 109.4 nm): 93.3 nm on 8 cells a radius, and 104.6 here."""
    from eigencontact.app import load_scene

    changes = [f"{KEY}=3", "grid.cells-per-contact-radius=8", 'numerics.inclusion-pitch="2.25 um"']
    found = ec.run(load_scene("hard-inclusion-in-plastic-matrix", changes)).summary["print_depth"]
    assert found == close(104.6e-9, rel=5e-3)


@pytest.mark.slow
def test_auto_brings_the_print_over_a_stiff_ball_within_two_per_cent():
    """Case EP-12 with a whole ball, on 12 cells a radius elsewhere: about five minutes and 3 GB."""
    from eigencontact.app import load_scene

    changes = [f"{KEY}=auto", "numerics.inclusion-resolution={whole=4}"]
    found = ec.run(load_scene("hard-inclusion-in-plastic-matrix", changes))
    assert found.summary["print_depth"] == close(109.4e-9, rel=0.02)
    assert "inclusion-refinement = 4" in found.dataset.attrs["scene"]


@pytest.mark.slow
def test_the_print_comes_near_to_that_of_a_finer_grid(refined):
    """One level of 4 and of 8 cells a radius: two levels leave a quarter of their difference at most."""
    coarse, fine = (ec.run(scene(1, n)).summary["print_depth"] for n in (4, 8))
    found = refined.summary["print_depth"]
    assert coarse < found
    assert abs(found - fine) < abs(coarse - fine) / 4
    assert refined.summary["coupling_residual"] < 1e-6


def test_a_body_of_two_planes_of_symmetry_stays_symmetric(refined):
    for name in ("equivalent_plastic_strain_1", "equivalent_plastic_strain_finer_1"):
        strain = refined.dataset[name][-1].values
        assert strain.max() > 0.0
        for turned in (strain[:, ::-1], strain[:, :, ::-1], strain.transpose(0, 2, 1)):
            np.testing.assert_allclose(turned, strain, rtol=0, atol=1e-5 * strain.max())


def test_coarse_cells_store_means_over_finer_ones(refined):
    data = refined.dataset
    coarse, fine = (data[f"equivalent_plastic_strain{mark}_1"][-1] for mark in ("", "_finer"))
    means = fine.values.reshape(*(m for n in fine.shape for m in (n // 2, 2))).mean(axis=(1, 3, 5))
    first = [
        int(np.argmin(np.abs(data[f"cells_1_{axis}"].values - data[f"finer_cells_1_{axis}"].values[:2].mean())))
        for axis in "zyx"
    ]
    place = tuple(slice(k, k + n) for k, n in zip(first, means.shape, strict=True))
    inner = tuple(slice(1, -1) for _ in means.shape)
    np.testing.assert_allclose(coarse.values[place][inner], means[inner], rtol=1e-12)
    assert fine.values.max() > coarse.values.max()


@pytest.mark.slow
def test_an_elastic_ball_comes_nearer_to_a_whole_one():
    """A law that never yields: approach over a stiff ball against that by a polynomial eigenstrain of the ball."""
    body = {"type": "cuboid", "center": [0.0, 0.0, 0.75 * A], "edges": [0.9 * A] * 3}
    law = {"type": "j2", **STEEL, "hardening": {"type": "perfect", "yield-stress": 1e3 * P0}}

    def approach(refinement, **numerics):
        written = scene(refinement, 6, steps={"normal-load": LOAD}, **numerics)
        written |= {"body1": STEEL, "inclusions": [{**body, "material": law}, ball()]}
        return ec.run(written).summary["approach"]

    whole = approach(1, **{"inclusion-resolution": {"whole": 5}})
    errors = [abs(approach(refinement) / whole - 1.0) for refinement in (1, 2)]
    assert errors[1] < 0.2 * errors[0]


@pytest.mark.slow
def test_wholes_stand_beside_both_levels():
    """The print over a ball as a whole rises with finer cells in the matrix, as it does with a finer grid."""
    whole = {"inclusion-resolution": {"whole": 3}}
    coarse, fine = (ec.run(scene(n, **whole)).summary for n in (1, 2))
    assert coarse["print_depth"] < fine["print_depth"] < 1.4 * coarse["print_depth"]
    assert fine["coupling_residual"] < 1e-6


def test_traction_and_eigenstrain_of_finer_cells_are_reciprocal():
    friction = {"friction": {"type": "coulomb", "coefficient": 0.3}}
    written = {**scene(), **friction, "steps": {"normal-load": LOAD, "tangential-load-x": 0.1}}
    parts = ec.plan(written).parts
    (coarse,), (fine,) = ([part for part in parts if type(part) is kind] for kind in (CoarseCells, FinerCells))
    coarse.start()
    fine.start()
    join_levels([coarse, fine])
    assert fine._faces is not None
    grid, random = coarse.grid, np.random.default_rng(5)
    strain = random.standard_normal((6, *fine.box.lattice.shape))
    fields = {item.field: random.standard_normal(grid.shape) for item in coarse._tractions}
    fine.eigenstrain, fine._time = strain, 0.0
    moved = fine.displacement("xyz")
    stress = fine.applied(fields)
    outer = grid.cell_area * sum(float((fields[i.field] * moved[i.direction]).sum()) for i in coarse._tractions)
    inner = float(np.prod(fine.box.lattice.edges)) * float((stress * strain).sum())
    assert outer == close(inner, rel=1e-10)


def test_what_is_stored_gives_more_regions(folder, refined):
    """As the run would have; from means over the finer cells."""
    found = ec.region(folder, {**REGION, "name": "again"})["again_von_mises"][-1]
    np.testing.assert_array_equal(found, refined.dataset["before_von_mises"][-1])


def test_explain_foretells_the_finer_cells():
    text = ec.explain(scene(3))
    assert "3 times finer at inclusions" in text
    assert "27 x 27 x 24 cells" in text


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"inclusions": []}, "without inclusions of another material"),
        ({"body1": STEEL, "inclusions": [ball(material={"young-modulus": 0.0, "poisson-ratio": NU})]}, "are linear"),
        ({"eigenstrain": [{"type": "uniform", "value": 1e-4, "depth": 0.3 * A}]}, "prescribed eigenstrain"),
    ],
    ids=["no inclusion", "linear", "prescribed"],
)
def test_scenes_without_a_use_for_it_are_refused(change, words):
    with pytest.raises(SceneError, match=KEY) as caught:
        ec.plan({**scene(), **change})
    assert words in str(caught.value)


def test_both_levels_of_a_body_are_measured_by_the_same_strain():
    """One that begins to flow is not measured by its own first, tiny strain: the combination would see nothing else."""
    interiors = [SimpleNamespace(body=body) for body in (1, 1, 2)]
    unknowns = [np.array([0.0, -2e-3]), np.array([1e-18]), np.array([3e-4])]
    assert _by_body(interiors, unknowns) == [2e-3, 2e-3, 3e-4]
