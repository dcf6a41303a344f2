"""The return mapping of the finite elements: closed forms of one axis, its derivative, and the laws that it judges."""

from __future__ import annotations

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact.plugin import LawStep
from eigencontact_verification.fem.yielding_law import (
    YieldingLaw,
    fading_damage,
    linear,
    ludwik,
    perfect,
    swift,
    voce,
)

E, NU = 200e3, 0.3
STEEL = {"young_modulus": E, "poisson_ratio": NU}
LOST = fading_damage(0.6, 0.02)
CURVES = {
    "perfect": perfect(500.0),
    "linear": linear(500.0, 2e4),
    "swift": swift(124.0, 30.0, 0.085),
    "ludwik": ludwik(400.0, 900.0, 0.4),
    "voce": voce(400.0, 300.0, 40.0),
}
LAWS = {
    **{name: YieldingLaw(**STEEL, hardening=curve) for name, curve in CURVES.items()},
    "prager": YieldingLaw(**STEEL, hardening=CURVES["perfect"], back_stresses=((1e4, 0.0),)),
    "chaboche": YieldingLaw(**STEEL, hardening=CURVES["voce"], back_stresses=((3e4, 200.0), (5e3, 10.0))),
    "nominal": YieldingLaw(**STEEL, hardening=CURVES["voce"], damage=LOST),
    "effective": YieldingLaw(**STEEL, hardening=CURVES["voce"], damage=LOST, effective=True),
    "all": YieldingLaw(**STEEL, hardening=CURVES["voce"], back_stresses=((3e4, 200.0),), damage=LOST),
}
#: The same as scenes write them.
SCENES = {
    "perfect": {"hardening": {"type": "perfect", "yield-stress": 500.0}},
    "linear": {"hardening": {"type": "linear", "yield-stress": 500.0, "modulus": 2e4}},
    "swift": {"hardening": {"type": "swift", "B": 124.0, "C": 30.0, "n": 0.085}},
    "prager": {"hardening": [{"type": "perfect", "yield-stress": 500.0}, {"type": "prager", "modulus": 1e4}]},
}


def stretched(law, path, before=None):
    """Axial stress, state and strain under axial strains while the other normal stresses are zero."""
    state = before or law.state_at_rest(4, 1)
    strain, stresses = np.zeros((4, 1)), []
    for axial in path:
        strain[2] = axial
        for _ in range(60):
            stress, tangent, after = law.answer(strain, state)
            if np.abs(stress[:2]).max() < 1e-10:
                break
            strain[:2] -= np.linalg.solve(tangent[:2, :2, 0], stress[:2])
        else:
            raise AssertionError("the tangent does not lead to a free side")
        state = after
        stresses.append(stress[2, 0])
    return np.array(stresses), state, strain


@pytest.mark.parametrize("name", CURVES)
def test_one_pull_ends_on_the_curve(name):
    """Uniaxial: the stress is the yield stress at the plastic strain that is the axial strain less its elastic part."""
    stress, state, strain = stretched(LAWS[name], [0.02])
    p = state["p"][0]
    assert p == close(0.02 - stress[0] / E, rel=1e-12)
    assert stress[0] == close(CURVES[name](np.array([p]))[0][0], rel=1e-10)
    assert strain[0, 0] == close(-NU * stress[0] / E - p / 2, rel=1e-12)


def test_back_stress_of_one_step_and_of_many():
    """Armstrong and Frederick: C Δp / (1 + γ Δp) in one step, (C/γ)(1 - exp(-γ p)) in the limit, with first order."""
    law = YieldingLaw(**STEEL, hardening=perfect(500.0), back_stresses=((3e4, 200.0),))
    stress, state, _ = stretched(law, [0.02])
    p = state["p"][0]
    assert stress[0] == close(500 + 3e4 * p / (1 + 200 * p), rel=1e-10)
    errors = []
    for steps in (40, 80, 160):
        found, after, _ = stretched(law, np.linspace(0, 0.02, steps + 1)[1:])
        errors.append(found[-1] - 500 - 150 * (1 - np.exp(-200 * after["p"][0])))
    orders = np.log2(np.abs(errors[:-1]) / np.abs(errors[1:]))
    np.testing.assert_allclose(orders, 1.0, atol=0.1)


def test_a_cycle_with_prager_closes_and_one_with_isotropic_hardening_grows():
    """Kinematic: the range of elastic stress stays 2 Y, so that a second cycle repeats the first."""
    path = [0.01, -0.01, 0.01, -0.01, 0.01]
    stress, _, _ = stretched(LAWS["prager"], path)
    np.testing.assert_allclose(stress[2:4], [stress[0], stress[1]], rtol=1e-10)
    limit = 500 + 1e4 * (0.01 - stress[0] / E)
    assert stress[0] == close(limit, rel=1e-12)
    assert stress[1] == close(-limit, rel=1e-12)
    grown, _, _ = stretched(LAWS["linear"], path)
    assert np.all(np.diff(np.abs(grown)) > 100)


def test_damage_by_both_readings():
    """Nominal: the stress is Y and the stiffness falls. Effective: the stress is (1 - D) Y."""
    for name in ("nominal", "effective"):
        stress, state, strain = stretched(LAWS[name], [0.03])
        p, sound = state["p"][0], 1 - LOST(state["p"])[0][0]
        limit = CURVES["voce"](state["p"])[0][0] * (sound if name == "effective" else 1.0)
        assert stress[0] == close(limit, rel=1e-10)
        assert strain[2, 0] == close(p + limit / (sound * E), rel=1e-10)


@pytest.mark.parametrize("name", LAWS)
def test_tangent_is_the_derivative_and_flow_keeps_the_volume(name):
    law, rng = LAWS[name], np.random.default_rng(4)
    strain = rng.normal(size=(6, 40)) * np.geomspace(1e-3, 2e-2, 40)
    _, _, before = law.answer(rng.normal(size=(6, 40)) * 4e-3, law.state_at_rest(6, 40))
    stress, tangent, after = law.answer(strain, before)
    assert (after["p"] > before["p"]).sum() > 30
    np.testing.assert_allclose(after["plastic"][:3].sum(axis=0), 0.0, atol=1e-15)
    step = 1e-8
    for k in range(6):
        up, down = (law.answer(strain + sign * step * np.eye(6)[:, [k]], before)[0] for sign in (1, -1))
        np.testing.assert_allclose(tangent[:, k], (up - down) / (2 * step), atol=2e-5 * E)
    work = (stress * (after["plastic"] - before["plastic"])).sum(axis=0)
    if not law.back_stresses:
        assert np.all(work >= 0)


@pytest.mark.parametrize("name", SCENES)
def test_the_law_of_scenes_gives_the_same_stress_on_a_random_path(name):
    """Two programs without a common line."""
    law, rng = LAWS[name], np.random.default_rng(7)
    other = ec.make("j2", young_modulus=E, poisson_ratio=NU, **SCENES[name])
    zero = np.zeros(20)
    mine = law.state_at_rest(6, 20)
    theirs = {key: np.zeros((entry.components, 20)) for key, entry in other.variables.items()}
    strain = np.zeros((6, 20))
    for _ in range(6):
        strain = strain + rng.normal(size=strain.shape) * 3e-3
        stress, tangent, mine = law.answer(strain, mine)
        found = other.update(strain, theirs, LawStep(x=zero, y=zero, z=zero, time=1.0, duration=1.0))
        theirs = found.variables
        np.testing.assert_allclose(found.stress, stress, atol=1e-8 * 500)
        np.testing.assert_allclose(np.broadcast_to(found.tangent.T, tangent.T.shape).T, tangent, atol=1e-6 * E)


def test_a_point_that_softens_too_fast_has_no_answer():
    law = YieldingLaw(**STEEL, hardening=linear(500.0, -5 * E))
    with pytest.raises(ArithmeticError, match="must have an answer"):
        law.answer(np.diag([0.01] * 6)[:, :1], law.state_at_rest(6, 1))
