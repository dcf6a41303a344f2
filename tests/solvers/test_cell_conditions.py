"""What cells demand of stress and eigenstrain: Hooke's law, voids, rigid and incompressible bodies, cut cells."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from close import close
from eigencontact.core.elasticity import isotropic_factors, mandel_rotation
from eigencontact.core.material import Material
from eigencontact.errors import SceneError
from eigencontact.solvers.cell_conditions import (
    Condition,
    Conditions,
    Shares,
    compliance,
    condition_of,
    constraint_of_ball,
    constraint_of_layer,
    mixed,
)
from eigencontact_plugins.laws.cubic import Cubic
from eigencontact_plugins.laws.isotropic import Isotropic
from eigencontact_plugins.laws.void import Void

VOID = Void()
MATRIX = Material(young_modulus=2.0, poisson_ratio=0.3)
VOLUME = np.zeros((6, 6))
VOLUME[:3, :3] = 1 / 3
DEVIATOR = np.eye(6) - VOLUME


def isotropic(E, nu):
    """Mandel stiffness and compliance, written by bulk and shear modulus."""
    K3, G2 = E / (1 - 2 * nu), E / (1 + nu)
    return K3 * VOLUME + G2 * DEVIATOR, VOLUME / K3 + DEVIATOR / G2


def random_stiffness(seed, size=3.0):
    root = np.random.default_rng(seed).normal(size=(6, 6))
    return size * (root @ root.T + 0.3 * np.eye(6))


def many(condition, count):
    return Condition(*(np.broadcast_to(part, (count, 6, 6)) for part in condition))


def effective_compliance(condition, matrix=MATRIX):
    """Of a cell without prestrain: total strain for a stress."""
    return compliance(matrix) - np.linalg.solve(condition.strain, condition.stress)


MATERIALS = {
    "isotropic": isotropic(1.3, 0.2)[0],
    "auxetic": isotropic(5.0, -0.7)[0],
    "cubic": Cubic(c11=3.0, c12=1.0, c44=2.0),
    "any": random_stiffness(1),
    "stiff": isotropic(2e8, 0.3)[0],
    "soft": isotropic(2e-8, 0.3)[0],
}


def stiffness_of(material):
    if isinstance(material, np.ndarray):
        return material
    soft, stiff = material.factors(1.0)
    return np.linalg.solve(soft, stiff)


@pytest.mark.parametrize("nu", [-0.5, 0.0, 0.3, 0.5])
@pytest.mark.parametrize("name", MATERIALS)
def test_the_condition_is_hookes_law(name, nu):
    """σ = C (e - ε_p) with the total strain e = M_m σ + ε*, for any stress and prestrain."""
    matrix = Material(young_modulus=2.0, poisson_ratio=nu)
    C = stiffness_of(MATERIALS[name])
    P, Q, R = condition_of(MATERIALS[name], matrix)
    rng = np.random.default_rng(2)
    stress, prestrain = rng.normal(size=(6, 5)), rng.normal(size=(6, 5))
    eigenstrain = np.linalg.solve(C, stress) + prestrain - compliance(matrix) @ stress
    sizes = [np.abs(factor @ values).max() for factor, values in ((P, stress), (Q, eigenstrain), (R, prestrain))]
    assert np.abs(P @ stress + Q @ eigenstrain - R @ prestrain).max() < 1e-12 * max(sizes)


def test_compliance_is_that_of_the_matrix():
    assert compliance(MATRIX) == close(isotropic(2.0, 0.3)[1], abs=1e-15)
    incompressible = compliance(Material(young_modulus=3.0, poisson_ratio=0.5))
    assert incompressible == close(DEVIATOR / 2.0, abs=1e-15)  # 2 G is 2, no change of volume


def test_a_void_carries_no_stress_whatever_its_eigenstrain():
    P, Q, R = condition_of(VOID, MATRIX)
    assert not Q.any()
    assert not R.any()
    assert np.linalg.matrix_rank(P) == 6  # P σ = 0 leaves σ = 0


def test_a_rigid_cell_keeps_its_prestrain():
    """In the limit P is the compliance of the matrix and Q = R = 1: the total strain is the prestrain."""
    P, Q, R = condition_of(Isotropic(young_modulus=1e18, poisson_ratio=0.2), MATRIX)
    assert close(compliance(MATRIX), abs=1e-15) == P
    assert close(np.eye(6), abs=1e-15) == Q
    assert np.array_equal(Q, R)


@pytest.mark.parametrize("matrix_nu", [0.3, 0.5])
@pytest.mark.parametrize(("E", "nu"), [(0.0, 0.0), (1e-12, 0.3), (3.0, 0.5), (1e300, 0.5), (1e300, -0.99)])
def test_factors_stay_of_order_one_for_every_material(E, nu, matrix_nu):
    matrix = Material(young_modulus=2.0, poisson_ratio=matrix_nu)
    for factor in condition_of(Isotropic(young_modulus=E, poisson_ratio=nu), matrix):
        assert np.isfinite(factor).all()
        assert np.abs(factor).max() <= 2.0


@pytest.mark.parametrize("nu", [-0.5, 0.0, 0.3])
def test_a_ball_is_constrained_as_eshelby_says(nu):
    """T = C (1 - S), S from its volumetric and deviatoric parts."""
    alpha, beta = (1 + nu) / (3 * (1 - nu)), 2 * (4 - 5 * nu) / (15 * (1 - nu))
    expected = isotropic(2.0, nu)[0] @ (np.eye(6) - alpha * VOLUME - beta * DEVIATOR)
    assert constraint_of_ball(Material(young_modulus=2.0, poisson_ratio=nu)) == close(expected, abs=1e-14)


def test_an_incompressible_ball_is_the_limit():
    at, near = (constraint_of_ball(Material(young_modulus=2.0, poisson_ratio=nu)) for nu in (0.5, 0.5 - 1e-9))
    assert at == close(near, abs=1e-7)


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.5])
def test_layers_pass_no_traction_and_turn_as_tensors(nu):
    matrix = Material(young_modulus=2.0, poisson_ratio=nu)
    turns = Rotation.random(6, rng=3).as_matrix()
    flat = constraint_of_layer(matrix, np.array([[0.0, 0.0, 1.0]]))[0]
    assert not flat[[2, 3, 4]].any()
    assert not flat[:, [2, 3, 4]].any()
    plane_stress = 2.0 / (1 - nu**2) * np.array([[1, nu], [nu, 1]])
    assert flat[:2, :2] == close(plane_stress, abs=1e-14)
    assert flat[5, 5] == close(2.0 / (1 + nu))
    for length in (1.0, 1e-9, 1e9):
        found = constraint_of_layer(matrix, length * turns[:, :, 2])
        for T, turn in zip(found, turns, strict=True):
            Q = mandel_rotation(turn)
            assert close(Q @ flat @ Q.T, abs=1e-13) == T


PAIRS = {
    "two isotropic": (isotropic(7.0, 0.2)[0], isotropic(0.4, 0.4)[0]),
    "two of any kind": (random_stiffness(4), random_stiffness(5, 0.2)),
    "inclusion and matrix": (random_stiffness(6), isotropic(2.0, 0.3)[0]),
}


@pytest.mark.parametrize("pair", PAIRS)
@pytest.mark.parametrize("f", [1e-6, 0.3, 0.8, 1 - 1e-6])
def test_a_laminate_is_exact(pair, f):
    """Against its own equations: one traction and one strain in the plane, prestrain in both layers."""
    first, second = PAIRS[pair]
    turn = Rotation.from_euler("ZYX", (0.3, 0.4, 0.5)).as_matrix()
    Q = mandel_rotation(turn)
    conditions = [many(condition_of(C, MATRIX), 1) for C in (first, second)]
    mean = mixed(*conditions, np.array([f]), constraint_of_layer(MATRIX, turn[None, :, 2]))
    # in axes with the normal along z: unknown strains of both layers; mean stress is given
    local = [Q.T @ C @ Q for C in (first, second)]
    across, along = [2, 3, 4], [0, 1, 5]
    stress = np.random.default_rng(7).normal(size=6)
    system, right = np.zeros((12, 12)), np.zeros(12)
    system[:3, :6], system[:3, 6:] = local[0][across], -local[1][across]  # equal tractions
    system[3:6, :6], system[3:6, 6:] = np.eye(6)[along], -np.eye(6)[along]  # equal strains in the plane
    system[6:, :6], system[6:, 6:] = f * local[0], (1 - f) * local[1]
    right[6:] = Q.T @ stress
    strains = np.linalg.solve(system, right)
    expected = Q @ (f * strains[:6] + (1 - f) * strains[6:])
    found = effective_compliance(Condition(*(part[0] for part in mean))) @ stress
    assert found == close(expected, rel=1e-7, abs=1e-9 * np.abs(expected).max())


@pytest.mark.parametrize("f", [0.01, 0.25, 0.7])
def test_the_ball_gives_the_bound_of_hashin_and_shtrikman(f):
    """Of an isotropic inclusion in the matrix itself; the modulus of coated spheres."""
    K1, G1, K2, G2 = 9.0, 1.5, 2.0 / (3 * 0.4), 2.0 / 2.6
    inclusion = 3 * K1 * VOLUME + 2 * G1 * DEVIATOR
    constraint = constraint_of_ball(MATRIX)[None]
    cut = mixed(
        many(condition_of(inclusion, MATRIX), 1), many(condition_of(isotropic(2.0, 0.3)[0], MATRIX), 1),
        np.array([f]), constraint,
    )  # fmt: skip
    stiff = np.linalg.inv(effective_compliance(Condition(*(part[0] for part in cut))))
    bulk = K2 + f * (K1 - K2) / (1 + (1 - f) * (K1 - K2) * 3 / (3 * K2 + 4 * G2))
    ratio = 6 * (K2 + 2 * G2) / (5 * G2 * (3 * K2 + 4 * G2))
    shear = G2 + f * (G1 - G2) / (1 + (1 - f) * (G1 - G2) * ratio)
    assert stiff == close(3 * bulk * VOLUME + 2 * shear * DEVIATOR, abs=1e-12)


def test_no_constraint_is_one_stress():
    """Reuss: compliances of the parts are averaged; the prestrain given is the mean over the cell."""
    first, second = random_stiffness(8), random_stiffness(9)
    conditions = [many(condition_of(C, MATRIX), 1) for C in (first, second)]
    cut = Condition(*(part[0] for part in mixed(*conditions, np.array([0.3]), np.zeros((1, 6, 6)))))
    expected = 0.3 * np.linalg.inv(first) + 0.7 * np.linalg.inv(second)
    assert effective_compliance(cut) == close(expected, abs=1e-12)
    assert np.linalg.solve(cut.strain, cut.prestrain) == close(np.eye(6), abs=1e-12)


EXTREME = {"void": VOID, "rigid": Isotropic(young_modulus=1e15, poisson_ratio=0.3), "any": random_stiffness(3)}


@pytest.mark.parametrize("one", EXTREME)
@pytest.mark.parametrize("other", EXTREME)
@pytest.mark.parametrize("nu", [0.3, 0.5])
@pytest.mark.parametrize("f", [1e-9, 0.5, 1.0])
def test_cut_cells_of_extreme_materials_are_finite_and_end_in_their_parts(one, other, nu, f):
    matrix = Material(young_modulus=2.0, poisson_ratio=nu)
    conditions = [many(condition_of(EXTREME[name], matrix), 1) for name in (one, other)]
    constraint = 0.1 * constraint_of_ball(matrix) + 0.9 * constraint_of_layer(matrix, np.array([[1.0, 2.0, 3.0]]))
    cut = mixed(*conditions, np.array([f]), constraint)
    for factor in cut:
        assert np.isfinite(factor).all()
        assert np.abs(factor).max() < 100.0
    if f in (1e-9, 1.0) or one == other:
        part = conditions[f < 0.5]
        assert cut.stress == close(part.stress, abs=1e-7)
        assert cut.strain == close(part.strain, abs=1e-7)


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 10**6), f=st.floats(0.001, 0.999), contrast=st.floats(-3, 3))
def test_a_cut_cell_lies_between_one_stress_and_one_strain(seed, f, contrast):
    """Energy under any stress: Reuss' mixture is softest, Voigt's stiffest; compliances stay symmetric."""
    first, second = random_stiffness(seed), 10.0**contrast * random_stiffness(seed + 1)
    conditions = [many(condition_of(C, MATRIX), 1) for C in (first, second)]
    constraint = constraint_of_ball(MATRIX)[None]
    M = effective_compliance(Condition(*(part[0] for part in mixed(*conditions, np.array([f]), constraint))))
    assert close(M.T, abs=1e-9 * np.abs(M).max()) == M
    soft = f * np.linalg.inv(first) + (1 - f) * np.linalg.inv(second)
    stiff = np.linalg.inv(f * first + (1 - f) * second)
    size = 1e-9 * np.abs(soft).max()
    assert np.linalg.eigvalsh(soft - 0.5 * (M + M.T)).min() > -size
    assert np.linalg.eigvalsh(0.5 * (M + M.T) - stiff).min() > -size


# boxes --------------------------------------------------------------------------------------------------------------

INDEX = np.array([[[1, 1, 2, 0]]])


class Chosen:
    """Isotropic constants of the cells that were asked for."""

    def __init__(self, E, nu):
        self.E, self.nu = E, nu

    def factors(self, shear_modulus):
        return isotropic_factors(self.E, self.nu, shear_modulus)


class ByCell:
    """Isotropic constants that differ from cell to cell, asked for by flat index."""

    def __init__(self, E, nu):
        self.E, self.nu = E, nu

    def of_cells(self, index):
        return Chosen(self.E.ravel()[index], self.nu.ravel()[index])


def box(index=INDEX, fraction=None, beside=None, normal=None, materials=2):
    return Shares.of(index, fraction, beside, normal, materials)


def test_every_cell_gets_its_condition():
    """Whole cells by material, the matrix among them, then the cut ones."""
    shape = INDEX.shape
    E, nu = np.array([[[1.0, 2.0, 3.0, 4.0]]]), np.full(shape, 0.25)
    conditions = Conditions(MATRIX, [isotropic(5.0, 0.1)[0], ByCell(E, nu)])
    shares = box(fraction=np.array([[[1.0, 0.5, 1.0, 1.0]]]))
    cells = np.array([3, 0, 2, 1])
    found = list(conditions.of(cells, INDEX.ravel(), shares))
    assert [(part.start, part.stop) for part, _ in found] == [(0, 1), (1, 2), (2, 3), (3, 4)]
    matrix, whole, field, cut = (condition for _, condition in found)
    assert not matrix.stress.any()
    assert np.array_equal(whole.stress, condition_of(isotropic(5.0, 0.1)[0], MATRIX).stress)
    assert field.stress[0] == close(condition_of(isotropic(3.0, 0.25)[0], MATRIX).stress, abs=1e-14)
    parts = [many(part, 1) for part in (whole, matrix)]
    expected = mixed(*parts, np.array([0.5]), constraint_of_ball(MATRIX)[None])
    assert cut.stress == close(expected.stress, abs=1e-14)


def test_the_normal_counts_where_the_second_part_is_the_matrix():
    shares = box(np.array([[[1, 1, 1]]]), np.full((1, 1, 3), 0.4), np.array([[[0, 0, 2]]]),
                 np.array([[[[0.0, 0.0, 0.0]]], [[[0.0, 0.0, 0.0]]], [[[0.0, 2.0, 2.0]]]]))  # fmt: skip
    conditions = Conditions(MATRIX, [random_stiffness(1), random_stiffness(2)])
    ((_, found),) = conditions.of(np.arange(3), np.ones(3, dtype=int), shares)
    first = condition_of(random_stiffness(1), MATRIX)
    second = [Condition(np.zeros((6, 6)), *(condition_of(isotropic(2.0, 0.3)[0], MATRIX).strain,) * 2)] * 2
    second.append(condition_of(random_stiffness(2), MATRIX))
    ball, layer = constraint_of_ball(MATRIX), constraint_of_layer(MATRIX, np.array([[0.0, 0.0, 1.0]]))[0]
    for k, constraint in enumerate((ball, 0.1 * ball + 0.9 * layer, ball)):
        expected = mixed(many(first, 1), many(second[k], 1), np.array([0.4]), constraint[None])
        assert found.stress[k] == close(expected.stress[0], abs=1e-13)
        assert found.prestrain[k] == close(expected.prestrain[0], abs=1e-13)


def test_cells_of_one_material_on_both_sides_are_whole():
    shares = box(fraction=np.full((1, 1, 4), 0.5), beside=np.array([[[1, 2, 2, 0]]]))
    assert shares.mixed.tolist() == [False, True, False, False]


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"fraction": np.ones((1, 4))}, r"inclusions.fraction must be of shape \(1, 1, 4\)"),
        ({"fraction": np.array([[[1.0, 0.0, 1.0, 1.0]]])}, "above 0 and up to 1 in every cell"),
        ({"fraction": np.array([[[1.0, np.nan, 1.0, 1.0]]])}, "above 0 and up to 1 in every cell"),
        ({"beside": np.zeros((1, 1, 4))}, "inclusions.beside must be of integers"),
        ({"beside": np.zeros((4,), dtype=int)}, r"inclusions.beside must be of shape"),
        ({"beside": np.full((1, 1, 4), 3)}, r"from 0 \(the matrix\) to 2, the number of materials given \(got 3\)"),
        ({"normal": np.zeros((1, 1, 4))}, r"inclusions.normal must be of shape \(3, 1, 1, 4\)"),
        ({"normal": np.full((3, 1, 1, 4), np.inf)}, "inclusions.normal must be finite"),
    ],
)
def test_refused_shares(given, message):
    with pytest.raises(SceneError, match=message):
        box(**given)
