"""Inhomogeneities made of cells against Eshelby's sphere, and against identities that hold for any shape."""

from functools import cache

import numpy as np
import pytest

from eigencontact.core.material import Material
from eigencontact.errors import NotConverged, SceneError
from eigencontact.solvers.cells import Cells
from eigencontact.solvers.equivalent_inclusions import InhomogeneousCells, solve_equivalent_inclusions
from eigencontact.solvers.mean_stress import MeanVolumeField
from eigencontact_plugins.shapes.cuboid import Cuboid

CELL = Cuboid(center=(0.0, 0.0, 1.0), edges=(1.0, 1.0, 1.0))
STEEL = Material(young_modulus=210e9, poisson_ratio=0.3)
LOADS = {"uniaxial": (1.0, 0, 0, 0, 0, 0), "hydrostatic": (1.0, 1, 1, 0, 0, 0), "shear": (0, 0.0, 0, 1, -2, 3)}

# Eshelby's sphere, ν = 0.3: stress along the load, across it (uniaxial), and under unit hydrostatic stress.
SPHERE = {
    0.5: (0.6789, 0.0226, 0.7241),
    2.0: (1.3150, -0.0398, 1.2353),
    4.0: (1.5647, -0.0824, 1.4000),
    1e6: (1.9385, -0.1615, 1.6154),  # rigid
}


def isotropic(material, ratio=1.0):
    """Mandel stiffness."""
    young, nu = ratio * material.young_modulus, material.poisson_ratio
    out = young / (1 + nu) * np.eye(6)
    out[:3, :3] += young * nu / ((1 + nu) * (1 - 2 * nu))
    return out


def transversely_isotropic(along, across, poisson_along, poisson_across, shear):
    """Mandel stiffness with the axis z from its five engineering constants."""
    out = np.diag([1 / across, 1 / across, 1 / along, 1 / (2 * shear), 1 / (2 * shear), (1 + poisson_across) / across])
    out[0, 1] = out[1, 0] = -poisson_across / across
    out[2, :2] = out[:2, 2] = -poisson_along / along
    return np.linalg.inv(out)


@cache
def sphere(across, margin=0, depth=7.0, matrix=STEEL):
    """Operator on the cells around a sphere of unit radius, with a margin of cells, and which of them lie in it."""
    pitch = 2.0 / across
    low, count = -1.0 - (margin - 0.5) * pitch, across + 2 * margin
    box = Cells(first=(low, low, depth + low), pitch=(pitch,) * 3, shape=(count,) * 3)
    z, y, x = np.meshgrid(box.centres(2) - depth, box.centres(1), box.centres(0), indexing="ij")
    operator = MeanVolumeField(
        CELL, box, box, poisson_ratio=matrix.poisson_ratio, shear_modulus=matrix.shear_modulus, threads=1
    )
    return operator, (x * x + y * y + z * z < 1.0).astype(int)


def uniform(values, operator):
    return np.broadcast_to(np.reshape(values, (6, 1, 1, 1)), (6, *operator.source.shape))


def solved(ratio, load, across=8, **options):
    operator, inside = sphere(across)
    stiffness = [isotropic(STEEL, ratio)]
    return solve_equivalent_inclusions(operator, STEEL, stiffness, inside, uniform(load, operator), **options)


@pytest.mark.parametrize("load", LOADS.values(), ids=LOADS)
def test_the_same_constants_change_nothing(load):
    answer = solved(1.0, load)
    assert np.abs(answer.eigenstrain).max() * STEEL.young_modulus < 1e-10
    assert np.abs(answer.stress - np.reshape(load, (6, 1, 1, 1))).max() < 1e-10


def mean_stress_errors(ratio, across):
    """Along and across a uniaxial load, and under a hydrostatic one, as fractions of the load."""
    inside = sphere(across)[1] == 1
    along, sideways, hydrostatic = SPHERE[ratio]
    one, all_round = (
        solved(ratio, LOADS[k], across).stress[:, inside].mean(axis=1) for k in ("uniaxial", "hydrostatic")
    )
    return np.array([one[0] - along, one[1] - sideways, one[2] - sideways, *(all_round[:3] - hydrostatic)])


@pytest.mark.parametrize(("ratio", "bound"), [(0.5, 0.004), (2.0, 0.012), (4.0, 0.035), (1e6, 0.14)])
def test_mean_stress_of_a_sphere(ratio, bound):
    assert np.abs(mean_stress_errors(ratio, 8)).max() < bound


@pytest.mark.slow
@pytest.mark.parametrize(("ratio", "bound"), [(2.0, 0.006), (4.0, 0.015), (1e6, 0.06)])
def test_mean_stress_of_a_sphere_converges(ratio, bound):
    """Of order one or a little less, as a boundary of steps allows."""
    coarse, fine = (np.linalg.norm(mean_stress_errors(ratio, across)) for across in (8, 24))
    assert 0.6 < np.log(coarse / fine) / np.log(3.0) < 1.2
    assert np.abs(mean_stress_errors(ratio, 24)).max() < bound


def test_stress_beside_a_cavity():
    """On the equator of a hollow sphere, Goodier's 1 + (4-5ν)/(2(7-5ν)) r^-3 + 9/(2(7-5ν)) r^-5 of the load."""
    operator, inside = sphere(8, margin=3)
    load = uniform(LOADS["uniaxial"], operator)
    stress = solve_equivalent_inclusions(operator, STEEL, [np.zeros((6, 6))], inside, load).stress
    assert np.abs(stress[:, inside == 1]).max() < 1e-4
    box = operator.source
    y, z = np.meshgrid(box.centres(1), box.centres(2) - 7.0, indexing="xy")
    middle = [k for k, x in enumerate(box.centres(0)) if abs(x) < box.pitch[0]]
    distance = np.sqrt(y**2 + z**2 + 0.25 * box.pitch[0] ** 2)
    found = stress[0][:, :, middle].mean(axis=2)
    expected = 1 + 0.5 * (4 - 1.5) / (7 - 1.5) * distance**-3 + 4.5 / (7 - 1.5) * distance**-5
    far = distance > 1.25
    assert np.abs(found / expected - 1)[far].max() < 0.06
    near = (distance > 1.0) & (distance < 1.2)
    assert np.abs(found[near].mean() / expected[near].mean() - 1) < 0.1


def test_linear_in_load_and_prestrain():
    operator, inside = sphere(8)
    cells = InhomogeneousCells(operator, STEEL, [isotropic(STEEL, 4.0)], inside)
    misfit = np.zeros((6, *inside.shape))
    misfit[:3, inside == 1] = 1e-3
    one = cells.solve(uniform(LOADS["uniaxial"], operator), tolerance=1e-11)
    two = cells.solve(uniform([0.0] * 6, operator), misfit, tolerance=1e-11)
    both = cells.solve(uniform(np.multiply(1e8, LOADS["uniaxial"]), operator), -2 * misfit, tolerance=1e-11)
    expected = 1e8 * one.stress - 2 * two.stress
    assert np.abs(both.stress - expected).max() < 1e-9 * np.abs(expected).max()


def test_prestrain_of_equal_constants_is_an_eigenstrain():
    operator, inside = sphere(8)
    misfit = np.random.default_rng(0).standard_normal((6, *inside.shape))
    answer = solved(1.0, LOADS["uniaxial"], prestrain=misfit)
    assert np.abs(answer.eigenstrain - misfit).max() < 1e-12
    expected = uniform(LOADS["uniaxial"], operator) + operator.apply(misfit)
    assert np.abs(answer.stress - expected).max() < 1e-12 * np.abs(expected).max()


def test_transverse_isotropy_with_isotropic_constants_is_isotropy():
    operator, inside = sphere(8)
    young, nu = 3.0 * STEEL.young_modulus, STEEL.poisson_ratio
    stiffness = [transversely_isotropic(young, young, nu, nu, young / (2 * (1 + nu)))]
    load = uniform(LOADS["shear"], operator)
    answer = solve_equivalent_inclusions(operator, STEEL, stiffness, inside, load, tolerance=1e-9)
    expected = solved(3.0, LOADS["shear"], tolerance=1e-9)
    assert np.abs(answer.stress - expected.stress).max() < 1e-7


def test_an_anisotropic_cell_obeys_its_law():
    """Stress is the stiffness of each material times total strain less prestrain, in each cell."""
    operator, inside = sphere(8)
    index = inside * (1 + np.arange(inside.size).reshape(inside.shape) % 2)
    stiffness = [transversely_isotropic(400e9, 100e9, 0.2, 0.35, 50e9), isotropic(STEEL, 0.3)]
    misfit = 1e-11 * np.random.default_rng(0).standard_normal((6, *index.shape))
    load = uniform(LOADS["shear"], operator)
    answer = solve_equivalent_inclusions(operator, STEEL, stiffness, index, load, misfit, tolerance=1e-10)
    elastic = np.tensordot(np.linalg.inv(isotropic(STEEL)), answer.stress, 1) + answer.eigenstrain - misfit
    for number, given in enumerate([isotropic(STEEL), *stiffness]):
        law = given @ elastic[:, index == number]
        assert np.abs(law - answer.stress[:, index == number]).max() < 1e-7


@pytest.mark.parametrize(("ratio", "most"), [(0.0, 60), (0.1, 20), (0.5, 10), (2.0, 10), (10.0, 20), (1e6, 45)])
def test_iterations(ratio, most):
    report = solved(ratio, LOADS["uniaxial"]).report
    assert 0 < report.iterations <= most
    assert report.applications <= report.iterations + 2
    assert report.history[-1] == pytest.approx(report.residual, rel=1e-3)


def test_a_similar_load_is_a_good_start():
    operator, inside = sphere(8)
    cells = InhomogeneousCells(operator, STEEL, [isotropic(STEEL, 4.0)], inside)
    load = uniform(LOADS["uniaxial"], operator)
    first = cells.solve(load)
    again = cells.solve(1.001 * load, start=first.eigenstrain)
    assert again.report.iterations < 0.7 * first.report.iterations
    assert cells.solve(load, start=first.eigenstrain).report.iterations == 0


def test_nothing_to_solve():
    operator, inside = sphere(8)
    load = uniform(LOADS["shear"], operator)
    answer = solve_equivalent_inclusions(operator, STEEL, [], 0 * inside, load)
    assert not answer.eigenstrain.any()
    assert np.array_equal(answer.stress, load)
    assert not solved(5.0, [0.0] * 6).stress.any()


def test_unconverged_comes_with_its_report():
    with pytest.raises(NotConverged, match=r"residual .* after 3 iterations") as caught:
        solved(10.0, LOADS["uniaxial"], max_iterations=3)
    assert len(caught.value.report.history) == 3
    assert caught.value.report.residual > 1e-6


def test_refusals():
    operator, inside = sphere(8)
    load, stiffness = uniform(LOADS["shear"], operator), isotropic(STEEL)
    other = Material(young_modulus=210e9, poisson_ratio=0.2)
    skew = stiffness + np.triu(stiffness, 1)
    for matrix, given, index, message in (
        (other, [stiffness], inside, "matrix must be"),
        (STEEL, [stiffness], 2 * inside, r"from 0 .* to 1"),
        (STEEL, [stiffness], inside[1:], "of shape"),
        (STEEL, [stiffness], 1.0 * inside, "of integers"),
        (STEEL, [-stiffness], inside, "without negative eigenvalues"),
        (STEEL, [skew], inside, "stiffness must be symmetric"),
        (STEEL, [stiffness[:3]], inside, "6 x 6"),
    ):
        with pytest.raises(SceneError, match=message):
            solve_equivalent_inclusions(operator, matrix, given, index, load)
    with pytest.raises(SceneError, match="applied_stress must be of shape"):
        solve_equivalent_inclusions(operator, STEEL, [stiffness], inside, load[:, 1:])
