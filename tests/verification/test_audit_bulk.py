"""Audit of runs under bulk stress: how regions and layers answer it, and faults that finite elements see."""

import numpy as np
import pytest

import eigencontact as ec
from eigencontact_verification.audit import bodies
from eigencontact_verification.audit.bulk import bulk_stress_at, eigenstrain_by_bulk, strain_of
from eigencontact_verification.fem.loaded_body import LoadedBody
from eigencontact_verification.fem.model import Layer
from eigencontact_verification.oracles.eshelby_sphere import isotropic_stiffness, sphere_in_body
from verdicts import words_of_audit

BULK = np.array([[2e8, 8e7, 0.0], [8e7, -5e7, 0.0], [0.0, 0.0, 0.0]])
STEEL = {"young_modulus": "210 GPa", "poisson_ratio": 0.3}


@pytest.mark.parametrize("inside", [(630e9, 0.2), (2.1e5, 0.3)])
def test_the_eigenstrain_of_a_region_stands_for_the_remote_stress(inside):
    stiffness = isotropic_stiffness(*inside)
    expected, _ = sphere_in_body(stiffness, 210e9, 0.3, BULK)
    eigenstrain = eigenstrain_by_bulk(BULK, inside, (210e9, 0.3))
    by_elements, _ = sphere_in_body(stiffness, 210e9, 0.3, np.zeros((3, 3)), eigenstrain)
    np.testing.assert_allclose(by_elements + BULK, expected, rtol=0.0, atol=1e-5 * 2e8)


def test_layers_are_strained_as_the_substrate_and_free_across():
    body = LoadedBody(
        young_modulus=210e9, poisson_ratio=0.3, layers=(Layer(thickness=2e-6, young_modulus=420e9, poisson_ratio=0.2),)
    )
    stress = bulk_stress_at(BULK, body, np.array([[0.0, 0.0, 1e-6], [0.0, 0.0, 2e-6], [0.0, 0.0, 5e-6]]))
    strains = []
    for row, constants in zip(stress, [(420e9, 0.2), (210e9, 0.3), (210e9, 0.3)], strict=True):
        xx, yy, zz, yz, xz, xy = row
        assert (zz, yz, xz) == (0.0, 0.0, 0.0)
        strains.append(strain_of(np.array([[xx, xy, 0.0], [xy, yy, 0.0], [0.0, 0.0, 0.0]]), *constants)[:2, :2])
    np.testing.assert_allclose(strains, [strains[2]] * 3, rtol=1e-12, atol=1e-18)
    np.testing.assert_allclose(stress[2], [2e8, -5e7, 0.0, 0.0, 0.0, 8e7], rtol=1e-12)


# ---------------------------------------------------------------- finite elements


@pytest.fixture(scope="module")
def stiff_block(tmp_path_factory):
    folder = tmp_path_factory.mktemp("block") / "run"
    block = {"type": "cuboid", "center": ["0 um", "0 um", "12 um"], "edges": ["12 um", "12 um", "12 um"]}
    stretched = {"tangential_load_x": "0.6 N", "bulk_stress_xx": "800 MPa", "bulk_stress_xy": "200 MPa"}
    scene = ec.Scene(
        body1=STEEL, geometry={"type": "sphere", "radius": "200 um"}, friction={"type": "coulomb", "coefficient": 0.3},
        inclusions={**block, "material": {"young_modulus": "420 GPa", "poisson_ratio": 0.3}},
        grid={"cells": 32, "size": "60 um"}, steps=[{"normal_load": "4 N"}, stretched],
        stress={"shape": "plane", "normal": "y", "depth_max": "30 um"}, output={"pictures": False},
    )  # fmt: skip
    ec.run(scene, folder).dataset.close()
    return folder


@pytest.mark.slow
def test_elements_agree_with_a_stiff_block_under_contact_and_bulk_stress(stiff_block, tmp_path, monkeypatch):
    assert "disagrees" not in words_of_audit(stiff_block, tmp_path / "true")
    monkeypatch.setattr(bodies, "eigenstrain_by_bulk", lambda *_: np.zeros((3, 3)))
    assert "disagrees" in words_of_audit(stiff_block, tmp_path / "fault")
