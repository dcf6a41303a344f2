"""Laws of cut cells: layers in closed form, linear cut cells, tangents, memories of both parts, what is refused."""

# ruff: noqa: ARG002 - the interface of a law

from dataclasses import replace
from typing import ClassVar

import numpy as np
import pytest
from scipy.optimize import minimize

from close import close
from eigencontact.core.material import Material
from eigencontact.errors import NotConverged, PluginError
from eigencontact.execution.interiors.cut_cells import CutStep
from eigencontact.plugin import LinearLaw, Response
from eigencontact.solvers.cell_conditions import compliance, condition_of, constraint_of_cut, mixed
from eigencontact.solvers.laminate import BESIDE, Laminate, resistance
from eigencontact_plugins.hardening.perfect import Perfect
from eigencontact_plugins.laws.isotropic import Isotropic
from eigencontact_plugins.laws.j2 import J2
from eigencontact_plugins.laws.map import IsotropicPoints
from eigencontact_plugins.laws.void import Void
from toy_laws import Stiffening, Yielding

MATRIX = Material(young_modulus=2e11, poisson_ratio=0.3)
COUNT = 5
STEEL = Yielding(young_modulus=2e11, poisson_ratio=0.3, yield_stress=2e8, hardening_modulus=1e10)
IDEAL = J2(young_modulus=2e11, poisson_ratio=0.3, hardening=(Perfect(yield_stress=3e8),))
RUBBER = Stiffening(shear_modulus=1e9, growth=1e5)
HARD = Isotropic(young_modulus=5e11, poisson_ratio=0.2)
NORMALS = np.random.default_rng(3).standard_normal((3, COUNT))
SHARES = np.array([0.05, 0.3, 0.5, 0.7, 0.95])


def step_of(resisted=None, difference=None):
    x = np.arange(COUNT) * 1e-6
    return CutStep(
        x=x, y=2 * x, z=x + 1e-6, time=1.0, duration=0.5, fraction=SHARES,
        resistance=resistance(MATRIX, NORMALS / np.linalg.norm(NORMALS, axis=0)) if resisted is None else resisted,
        difference=np.zeros((6, COUNT)) if difference is None else difference,
    )  # fmt: skip


def at_rest(law):
    return {name: np.zeros((item.components, COUNT)) for name, item in law.variables.items()}


def strains(size=2e-3, seed=0):
    return size * np.random.default_rng(seed).standard_normal((6, COUNT))


@pytest.mark.parametrize("second", [HARD, Void(), Isotropic(young_modulus=2e9, poisson_ratio=0.4)])
def test_linear_laws_have_the_condition_of_linear_cut_cells(second):
    """P σ + Q e = R e_p with the strain M σ + e: eliminated there, iterated here, with a prestrain of the first."""
    first, prestrain = Isotropic(young_modulus=1e11, poisson_ratio=0.1), strains(1e-3, seed=1)
    normals = NORMALS / np.linalg.norm(NORMALS, axis=0)
    conditions = [
        type(condition)(*(np.broadcast_to(matrix, (COUNT, 6, 6)) for matrix in condition))
        for condition in (condition_of(law, MATRIX) for law in (first, second))
    ]
    P, Q, R = mixed(*conditions, SHARES, constraint_of_cut(MATRIX, normals.T))
    strain, mean = strains(), SHARES * prestrain
    # Q (ε - M σ) + P σ = R f e_p
    right = np.einsum("nij,jn->ni", R, mean) - np.einsum("nij,jn->ni", Q, strain)
    expected = np.linalg.solve(P - Q @ compliance(MATRIX), right[..., None])[..., 0].T
    found = Laminate(first, second).update(strain - mean, {}, step_of(difference=prestrain)).stress
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9 * np.abs(expected).max())


def test_flat_layers_have_the_constants_of_a_laminate():
    """Normal z, other jumps resisted without bounds: G. E. Backus 1962, J. Geophys. Res. 67, 4427."""
    laws = Isotropic(young_modulus=1e11, poisson_ratio=0.1), HARD
    stiff = np.diag([1.0, 1.0, 0.0, 0.0, 0.0, 1.0]) * 1e18
    step = step_of(np.repeat(stiff[..., None], COUNT, axis=2))
    f = SHARES
    moduli = [(law.young_modulus, law.poisson_ratio) for law in laws]
    shear = [E / (2 * (1 + nu)) for E, nu in moduli]
    lame = [E * nu / ((1 + nu) * (1 - 2 * nu)) for E, nu in moduli]

    def mean(values):
        return f * values[0] + (1 - f) * values[1]

    along = [bulk + 2 * G for bulk, G in zip(lame, shear, strict=True)]
    across = 1 / mean([1 / value for value in along])
    ratio = mean([bulk / value for bulk, value in zip(lame, along, strict=True)])
    plane = mean([4 * G * (bulk + G) / value for G, bulk, value in zip(shear, lame, along, strict=True)])
    tangent = Laminate(*laws).update(strains(), {}, step).tangent
    np.testing.assert_allclose(tangent[2, 2], across, rtol=1e-5)
    np.testing.assert_allclose(tangent[0, 2], ratio * across, rtol=1e-5)
    np.testing.assert_allclose(tangent[0, 0], plane + ratio**2 * across, rtol=1e-5)
    np.testing.assert_allclose(tangent[3, 3], 2 / mean([1 / G for G in shear]), rtol=1e-5)
    np.testing.assert_allclose(tangent[5, 5], 2 * mean(shear), rtol=1e-5)


@pytest.mark.parametrize("pair", [(STEEL, HARD), (HARD, IDEAL), (IDEAL, Void()), (STEEL, IDEAL), (RUBBER, STEEL)])
def test_the_tangent_is_the_derivative_of_the_stress(pair):
    law, strain, step = Laminate(*pair), strains(), step_of(difference=strains(2e-4, seed=4))
    before = law.update(strains(seed=2), at_rest(law), step).variables
    tangent = law.update(strain, before, step).tangent
    for component in range(6):
        small = np.zeros((6, COUNT))
        small[component] = 1e-8
        up, down = (
            law.update(strain + sign * small, before, step_of(difference=step.difference)).stress for sign in (1, -1)
        )
        np.testing.assert_allclose((up - down) / 2e-8, tangent[:, component], rtol=0, atol=1e-4 * np.abs(tangent).max())


def test_the_strain_of_two_elastic_materials_has_the_least_energy():
    """Stress is the derivative of min f W1 + (1-f) W2 + f (1-f) d K d / 2; another program finds the minimum."""
    strain, step, parts = strains(3e-3), step_of(), np.linspace(0.0, 1.0, 201)
    stress, stiffness = Laminate(RUBBER, HARD).update(strain, {}, step).stress, HARD.stiffness_matrix()

    def rubber(values):
        along = RUBBER.update(values[:, None] * parts, {}, step).stress
        return np.trapezoid(values @ along, parts)

    def least(values, cell):
        f, one = SHARES[cell], 1.0 - SHARES[cell]

        def energy(jump):
            d = 1e-3 * jump
            second = values - f * d
            linear = 0.5 * second @ stiffness @ second + 0.5 * f * d @ step.resistance[:, :, cell] @ d
            return (f * rubber(values + one * d) + one * linear) / 1e3

        return 1e3 * minimize(energy, np.zeros(6), method="BFGS", options={"gtol": 1e-9}).fun

    for cell in (1, 3):
        along = strain[:, cell] / np.linalg.norm(strain[:, cell])
        slope = (least(strain[:, cell] + 1e-5 * along, cell) - least(strain[:, cell] - 1e-5 * along, cell)) / 2e-5
        assert along @ stress[:, cell] == close(slope, rel=1e-3)


def test_each_part_keeps_its_own_memory():
    law = Laminate(STEEL, replace(STEEL, yield_stress=4e8))
    assert set(law.variables) == {"plastic_strain", "hardening", "plastic_strain" + BESIDE, "hardening" + BESIDE}
    answer = law.update(strains(), at_rest(law), step_of())
    first, second = law.parts(answer.variables)
    assert set(first) == set(second) == set(STEEL.variables)
    assert not np.array_equal(first["hardening"], second["hardening"])
    back = law.update(0.9 * strains(), answer.variables, step_of())
    for name, values in answer.variables.items():  # unloading is elastic
        np.testing.assert_array_equal(back.variables[name], values)
    one = Laminate(HARD, STEEL)
    assert set(one.variables) == set(STEEL.variables)
    assert set(Laminate(IDEAL, RUBBER).variables) == set(IDEAL.variables)


def test_two_parts_of_one_law_are_that_law():
    law = Laminate(STEEL, replace(STEEL))
    answer, plain = law.update(strains(), at_rest(law), step_of()), STEEL.update(strains(), at_rest(STEEL), step_of())
    np.testing.assert_allclose(answer.stress, plain.stress, rtol=1e-12)
    np.testing.assert_allclose(answer.tangent, plain.tangent, rtol=0, atol=1e-12 * plain.tangent.max())


def test_where_the_jump_is_expected_it_is_found_again():
    law, step = Laminate(IDEAL, HARD), step_of()
    law.update(strains(), at_rest(law), step)
    again, anew = law.update(1.1 * strains(), at_rest(law), step), law.update(1.1 * strains(), at_rest(law), step_of())
    np.testing.assert_allclose(again.stress, anew.stress, rtol=0, atol=1e-9 * np.abs(anew.stress).max())


def test_constants_of_each_place():
    class Map(LinearLaw):
        key: ClassVar[str] = "map"

        def at(self, x, y, z):
            return IsotropicPoints(young_modulus=1e11 * (1.0 + 1e6 * x), poisson_ratio=np.full(x.size, 0.2))

        def stiffness_matrix(self):
            raise AssertionError

    found = Laminate(Map(), STEEL).update(strains(1e-5), at_rest(STEEL), step_of()).stress
    for cell in range(COUNT):
        law = Isotropic(young_modulus=1e11 * (1.0 + cell), poisson_ratio=0.2)
        one = Laminate(law, STEEL).update(strains(1e-5), at_rest(STEEL), step_of()).stress
        np.testing.assert_allclose(found[:, cell], one[:, cell], rtol=0, atol=1e-9 * np.abs(one).max())


def test_some_of_the_points_are_asked_alone():
    law, some = Laminate(STEEL, HARD), slice(1, 3)
    whole = law.update(strains(), at_rest(law), step_of())
    before = {name: values[:, some] for name, values in at_rest(law).items()}
    part = law.update(strains()[:, some], before, step_of().of(some))
    np.testing.assert_allclose(part.stress, whole.stress[:, some], rtol=0, atol=1e-9 * np.abs(whole.stress).max())


def test_a_part_without_an_answer_is_named():
    class Broken(Stiffening):
        key: ClassVar[str] = "broken"

        def update(self, strain, before, step):
            return Response(stress=np.nan * strain, tangent=np.eye(6))

    broken = Broken(shear_modulus=1e9, growth=1e5)
    with pytest.raises(PluginError, match="'broken' must answer with finite numbers"):
        Laminate(STEEL, broken).update(strains(), at_rest(STEEL), step_of())

    class Jumping(Stiffening):
        key: ClassVar[str] = "jumping"

        def update(self, strain, before, step):
            return Response(stress=np.where(strain > 0, 1e9, -1e9) * np.ones_like(strain), tangent=np.eye(6))

    jumping = Jumping(shear_modulus=1e9, growth=1e5)
    with pytest.raises(
        NotConverged, match=r"'jumping beside isotropic' found no strains of its parts at x = .* in 40 st"
    ):
        Laminate(jumping, HARD).update(strains(), {}, step_of())
