"""The law j2: against closed forms in tension, its tangent, its cell answer, cycles, what it refuses."""

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact.errors import NotConverged, SceneError
from eigencontact.plugin import LawStep, Surroundings, isotropic_stiffness
from law_paths import pulled

E, NU = 210e9, 0.3
PERFECT = {"type": "perfect", "yield-stress": "1 GPa"}
CHABOCHE = [
    PERFECT,
    {"type": "armstrong-frederick", "modulus": "100 GPa", "recovery": 500},
    {"type": "armstrong-frederick", "modulus": "10 GPa", "recovery": 20},
]
HARDENING = {
    "perfect": PERFECT,
    "swift": {"type": "swift", "B": "1240 MPa", "C": 30, "n": 0.085},
    "soft": {"type": "linear", "yield-stress": "1 GPa", "modulus": "-20 GPa"},
    "ludwik": {"type": "ludwik", "yield-stress": "1 GPa", "strength": "2 GPa", "n": 0.4},
    "table": {"type": "tabulated", "strain": [0, 0.001, 0.01], "stress": [1e9, 1.2e9, 1.5e9]},
    "chaboche": CHABOCHE,
}
DAMAGE = {"type": "exponential", "saturation": 0.6, "strain": 0.01}
VARIANTS = [(name, how) for name in HARDENING for how in (None, "nominal", "effective")]
UNIT = np.array([1.0, 1, 1, 0, 0, 0])


def law(hardening, how=None):
    damaged = {} if how is None else {"damage": DAMAGE, "yield_on": how}
    return ec.make("j2", young_modulus=E, poisson_ratio=NU, hardening=hardening, **damaged)


def step(n):
    return LawStep(x=np.zeros(n), y=np.zeros(n), z=np.ones(n), time=1.0, duration=1.0)


def at_rest(found, n=1):
    return {name: np.zeros((variable.components, n)) for name, variable in found.variables.items()}


def random_path(found, n=6, seed=0):
    """Strain, variables before, response: three random increments of each of n points."""
    rng, before = np.random.default_rng(seed), at_rest(found, n)
    strain = 0.006 * rng.normal(size=(6, n))
    for _ in range(3):
        strain = strain + 0.003 * rng.normal(size=(6, n))
        response = found.update(strain, before, step(n))
        yield strain, before, response
        before = response.variables


@pytest.mark.parametrize("variant", VARIANTS)
def test_tangent_is_the_derivative_of_the_stress(variant):
    found = law(HARDENING[variant[0]], variant[1])
    for strain, before, response in random_path(found):
        for j in range(6):
            change = np.zeros((6, 1))
            change[j] = 2e-8
            up, down = (found.update(strain + sign * change, before, step(6)).stress for sign in (1, -1))
            difference = np.abs((up - down) / 4e-8 - response.tangent[:, j]).max()
            assert difference < 1e-6 * E


@pytest.mark.parametrize("variant", VARIANTS)
def test_cell_answer_obeys_update(variant):
    """In any body: the eigenstrain with which the stress of a cell is that of the law for its strain."""
    found, around = law(HARDENING[variant[0]], variant[1]), Surroundings(young_modulus=70e9, poisson_ratio=0.2)
    compliance = np.linalg.inv(isotropic_stiffness(70e9, 0.2))
    prestrain = 1e-3 * np.random.default_rng(1).normal(size=(6, 6))
    for strain, before, response in random_path(found):
        e = strain + prestrain - compliance @ response.stress
        mean = UNIT @ e / 3.0 * UNIT[:, None]
        foreign = response.stress + around.shear_stiffness * (e - mean) + around.bulk_stiffness * mean
        answer, after = found.cell_answer(foreign, prestrain, around, before, step(6))
        np.testing.assert_allclose(answer, e, atol=1e-11 * np.abs(e).max())
        for name, values in after.items():
            np.testing.assert_allclose(values, response.variables[name], atol=1e-10 * np.abs(values).max())


@pytest.mark.parametrize("name", ["perfect", "swift", "table"])
@pytest.mark.parametrize("how", [None, "nominal", "effective"])
def test_yielded_points_lie_on_the_surface(name, how):
    found = law(HARDENING[name], how)
    for _, before, response in random_path(found):
        p = response.variables["equivalent_plastic_strain"][0]
        deviator = response.stress - UNIT @ response.stress / 3.0 * UNIT[:, None]
        borne = np.sqrt(1.5 * np.sum(deviator**2, axis=0))
        if how == "effective":
            borne = borne / (1.0 - response.variables["damage"][0])
        flow = found._return.isotropic.flow_stress(p)[0]
        yielded = p > before["equivalent_plastic_strain"][0]
        assert yielded.sum() > 2
        np.testing.assert_allclose(borne[yielded], flow[yielded], rtol=1e-10)
        assert np.all(borne[~yielded] <= flow[~yielded])


def test_chaboche_in_monotone_tension_is_the_closed_form():
    """Y + Σ (C/γ)(1 - exp(-γ p)); backward Euler is of first order in the step."""
    errors = []
    for count in (100, 200):
        (stress, _), after = pulled(law(CHABOCHE), np.linspace(0, 0.02, count + 1)[1:])
        p = float(after["equivalent_plastic_strain"][0, 0])
        exact = 1e9 + 200e6 * (1 - np.exp(-500 * p)) + 500e6 * (1 - np.exp(-20 * p))
        errors.append(abs(stress[-1] / exact - 1))
    assert errors[1] < 2e-4
    assert errors[0] / errors[1] == close(2.0, rel=0.1)


def test_prager_yields_on_reversal_at_twice_the_first_stress():
    """Bauschinger: from σ the way back is elastic over 2 Y, whatever the back-stress."""
    prager = [PERFECT, {"type": "prager", "modulus": "20 GPa"}]
    up = np.linspace(0, 0.01, 11)[1:]
    (stress, _), after = pulled(law(prager), up)
    (back, _), later = pulled(law(prager), [*up, up[-1] - 1.9999 * 1e9 / E])
    assert stress[-1] - back[-1] == close(1.9999e9, rel=1e-9)
    np.testing.assert_array_equal(later["plastic_strain"], after["plastic_strain"])
    _, later = pulled(law(prager), [*up, up[-1] - 2.0001 * 1e9 / E])
    assert later["equivalent_plastic_strain"][0, 0] > after["equivalent_plastic_strain"][0, 0]


def test_constants_of_the_body_stand_in_for_missing_ones():
    found = ec.make("j2", hardening=PERFECT)
    with pytest.raises(SceneError, match="young-modulus must be given"):
        found.update(np.zeros((6, 1)), at_rest(found), step(1))
    assert found.of_body(E, NU) == law(PERFECT)


def test_softening_without_unique_answer_is_refused_by_the_number_of_points():
    steep = law({"type": "linear", "yield-stress": "1 GPa", "modulus": -3.01 * E / 2 / (1 + NU)})
    strain = np.zeros((6, 3))
    strain[0, 1:] = 0.01
    with pytest.raises(NotConverged, match=r"2 points soften .* first point 1"):
        steep.update(strain, at_rest(steep, 3), step(3))


def test_nearly_incompressible_and_huge_increments_are_ordinary():
    found = ec.make("j2", young_modulus=E, poisson_ratio=0.4999999, hardening=HARDENING["swift"])
    strain = np.zeros((6, 1))
    strain[5] = 10.0
    response = found.update(strain, at_rest(found), step(1))
    p = response.variables["equivalent_plastic_strain"][0]
    flow = 1240e6 * (30 + 1e6 * p) ** 0.085
    assert np.sqrt(1.5) * np.abs(response.stress[5, 0]) == close(float(flow[0]), rel=1e-10)
