"""Elastic constants: bounded factors, rotation of crystals against full tensors, limits, refusals."""

import numpy as np
import pytest

from close import close
from eigencontact.core.elasticity import mandel_rotation
from eigencontact.core.tensors import to_mandel
from eigencontact.errors import SceneError
from eigencontact_plugins.laws.cubic import Cubic
from eigencontact_plugins.laws.isotropic import Isotropic
from eigencontact_plugins.laws.map import IsotropicPoints
from eigencontact_plugins.laws.orthotropic import Orthotropic
from eigencontact_plugins.laws.rigid import Rigid
from eigencontact_plugins.laws.stiffness import GivenStiffness
from eigencontact_plugins.laws.transversely_isotropic import TransverselyIsotropic
from eigencontact_plugins.laws.void import Void

G = 80e9
PAIRS = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))
NICKEL = {"c11": 246.5e9, "c12": 147.3e9, "c44": 124.7e9}
FIBRE = {
    "axial_modulus": 230e9,
    "transverse_modulus": 15e9,
    "axial_poisson_ratio": 0.2,
    "transverse_poisson_ratio": 0.4,
    "axial_shear_modulus": 24e9,
}
SKEW = ((1.0, 2.0, 2.0), (2.0, 1.0, -2.0))  # two directions at right angles


def stiffness_of(material):
    soft, stiff = material.factors(G)
    return stiff @ np.linalg.inv(soft)


def tensor_of(mandel):
    """Fourth-order tensor of a Mandel matrix, by its definition."""
    out = np.zeros((3, 3, 3, 3))
    weight = np.array([1, 1, 1, 2, 2, 2]) ** 0.5
    for a, (i, j) in enumerate(PAIRS):
        for b, (k, l) in enumerate(PAIRS):
            value = mandel[a, b] / (weight[a] * weight[b])
            for p, q in ((i, j), (j, i)):
                for r, s in ((k, l), (l, k)):
                    out[p, q, r, s] = value
    return out


def random_rotation(seed=0):
    q, _ = np.linalg.qr(np.random.default_rng(seed).standard_normal((3, 3)))
    return q * np.sign(np.linalg.det(q))


PLY = {"moduli": (130e9, 10e9, 8e9), "poisson_ratios": (0.3, 0.25, 0.4), "shear_moduli": (5e9, 4e9, 3e9)}
EVERY = [
    Void(),
    Rigid(),
    Orthotropic(**PLY, x_axis=SKEW[0], y_axis=SKEW[1]),
    Isotropic(young_modulus=1e9, poisson_ratio=0.5),
    Isotropic(young_modulus=1e25, poisson_ratio=-0.9),
    Cubic(**NICKEL, x_axis=SKEW[0], y_axis=SKEW[1]),
    TransverselyIsotropic(**FIBRE, axis=(1.0, 2.0, -3.0)),
    TransverselyIsotropic(**FIBRE | {"axial_poisson_ratio": float(np.sqrt(0.3 * 230 / 15))}),
    GivenStiffness(stiffness=np.zeros((6, 6))),
]


@pytest.mark.parametrize("material", EVERY, ids=lambda m: type(m).__name__)
def test_factors_are_bounded_symmetric_and_complete(material):
    soft, stiff = material.factors(G)
    for part, least in ((2 * G * soft, 0.0), (stiff, 0.0)):
        values = np.linalg.eigvalsh(part)
        assert values[0] > least - 1e-12
        assert values[-1] < 1 + 1e-12
        np.testing.assert_allclose(part, part.T, atol=1e-15)
    np.testing.assert_allclose(stiff + 2 * G * soft, np.eye(6), atol=1e-14)


def test_isotropy_said_in_five_ways():
    E, nu = 150e9, 0.27
    shear = E / (2 * (1 + nu))
    lame = E * nu / ((1 + nu) * (1 - 2 * nu))
    given = 2 * shear * np.eye(6)
    given[:3, :3] += lame
    expected = Isotropic(young_modulus=E, poisson_ratio=nu).factors(G)
    for material in (
        GivenStiffness(stiffness=given),
        Cubic(c11=lame + 2 * shear, c12=lame, c44=shear, x_axis=SKEW[0], y_axis=SKEW[1]),
        TransverselyIsotropic(
            axial_modulus=E, transverse_modulus=E, axial_poisson_ratio=nu, transverse_poisson_ratio=nu,
            axial_shear_modulus=shear, axis=(3.0, -1.0, 2.0),
        ),
        Orthotropic(
            moduli=(E,) * 3, poisson_ratios=(nu,) * 3, shear_moduli=(shear,) * 3, x_axis=SKEW[1], y_axis=SKEW[0]
        ),
    ):  # fmt: skip
        for found, part in zip(material.factors(G), expected, strict=True):
            np.testing.assert_allclose(found, part, rtol=0, atol=1e-13 * np.abs(part).max())


def test_rotation_of_vectors_and_of_stiffness():
    R = random_rotation()
    Q = mandel_rotation(R)
    np.testing.assert_allclose(Q @ Q.T, np.eye(6), atol=1e-15)
    e = np.random.default_rng(1).standard_normal((3, 3))
    e = e + e.T

    def mandel(t):
        return to_mandel([t[p] for p in PAIRS])

    np.testing.assert_allclose(Q @ mandel(e), mandel(R @ e @ R.T), atol=1e-14)
    C = stiffness_of(Cubic(**NICKEL))
    turned = np.einsum("ip,jq,kr,ls,pqrs->ijkl", R, R, R, R, tensor_of(C))
    crystal = Cubic(**NICKEL, x_axis=tuple(5.0 * R[:, 0]), y_axis=tuple(R[:, 1]))
    np.testing.assert_allclose(tensor_of(stiffness_of(crystal)), turned, atol=1e-12 * 250e9)


def test_cubic_constants_in_voigt_notation():
    C = tensor_of(stiffness_of(Cubic(**NICKEL)))
    assert C[0, 0, 0, 0] == close(NICKEL["c11"])
    assert C[1, 1, 2, 2] == close(NICKEL["c12"])
    assert C[0, 2, 0, 2] == close(NICKEL["c44"])


def test_engineering_constants_along_any_axis():
    axis = np.array([2.0, -1.0, 2.0]) / 3.0
    across, other = np.array([1.0, 2.0, 0.0]) / np.sqrt(5.0), None
    other = np.cross(axis, across)
    soft, stiff = TransverselyIsotropic(**FIBRE, axis=tuple(axis)).factors(G)
    compliance = tensor_of(soft @ np.linalg.inv(stiff))

    def strain(stress):
        return np.einsum("ijkl,kl->ij", compliance, stress)

    pulled = strain(np.outer(axis, axis))
    assert axis @ pulled @ axis == close(1 / 230e9)
    assert across @ pulled @ across == close(-0.2 / 230e9)
    pulled = strain(np.outer(across, across))
    assert across @ pulled @ across == close(1 / 15e9)
    assert other @ pulled @ other == close(-0.4 / 15e9)
    sheared = strain(np.outer(axis, across) + np.outer(across, axis))
    assert axis @ sheared @ across == close(0.5 / 24e9)


def test_incompressible_is_the_limit():
    exact = Isotropic(young_modulus=1e11, poisson_ratio=0.5).factors(G)
    near = Isotropic(young_modulus=1e11, poisson_ratio=0.5 - 1e-9).factors(G)
    pressure = np.array([1.0, 1, 1, 0, 0, 0])
    np.testing.assert_allclose(2 * G * exact[0] @ pressure, 0, atol=1e-15)
    for a, b in zip(exact, near, strict=True):
        np.testing.assert_allclose(a, b, atol=1e-7 * np.abs(a).max())


def test_points_of_a_map_are_isotropic_each():
    E, nu = np.array([0.0, 1e9, 2e11, 3e12]), np.array([0.5, 0.2, 0.5, 0.2])
    soft, stiff = IsotropicPoints(young_modulus=E, poisson_ratio=nu).factors(G)
    for n in range(4):
        one = Isotropic(young_modulus=E[n], poisson_ratio=nu[n]).factors(G)
        np.testing.assert_array_equal((soft[n], stiff[n]), one)


def test_engineering_constants_of_a_ply():
    """Pulled along an axis it strains by the modulus, and across by Poisson's ratio, as the table says."""
    turn = random_rotation(3)
    ply = Orthotropic(**PLY, x_axis=tuple(turn[:, 0]), y_axis=tuple(turn[:, 1]))
    compliance = tensor_of(np.linalg.inv(ply.stiffness_matrix()))
    for first, across, nu in ((0, 1, 0.3), (0, 2, 0.25), (1, 2, 0.4)):
        strain = turn.T @ np.einsum("ijkl,kl->ij", compliance, np.outer(turn[:, first], turn[:, first])) @ turn
        modulus = PLY["moduli"][first]
        assert strain[first, first] * modulus == close(1.0, rel=1e-12, abs=0)
        assert strain[across, across] * modulus == close(-nu, rel=1e-11, abs=0)
    for shear, (i, j) in zip(PLY["shear_moduli"], ((0, 1), (0, 2), (1, 2)), strict=True):
        stress = np.outer(turn[:, i], turn[:, j]) + np.outer(turn[:, j], turn[:, i])
        strain = turn.T @ np.einsum("ijkl,kl->ij", compliance, stress) @ turn
        assert 2 * shear * strain[i, j] == close(1.0, rel=1e-12, abs=0)


INCOMPRESSIBLE = {
    "isotropic": Isotropic(young_modulus=1e9, poisson_ratio=0.5),
    "fibre": TransverselyIsotropic(**FIBRE | {"axial_poisson_ratio": 0.5, "transverse_poisson_ratio": 1 - 7.5 / 230}),
    "ply": Orthotropic(moduli=(1e9,) * 3, poisson_ratios=(0.5,) * 3, shear_moduli=(1e9 / 3,) * 3),
    "rigid": Rigid(),
}


@pytest.mark.parametrize("case", INCOMPRESSIBLE)
def test_a_stiffness_that_is_infinite_is_refused_and_its_factors_are_not(case):
    law = INCOMPRESSIBLE[case]
    with pytest.raises(SceneError, match=r"finite stiffness|infinite"):
        law.stiffness_matrix()
    soft, stiff = law.factors(G)
    np.testing.assert_allclose(soft @ [1.0, 1, 1, 0, 0, 0], 0, atol=1e-9 / G)
    assert np.isfinite(stiff).all()


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Isotropic(young_modulus=-1.0, poisson_ratio=0.3), r"young_modulus must be zero .* \(got -1.0\)"),
        (lambda: Isotropic(young_modulus=np.inf, poisson_ratio=0.3), "young_modulus must be"),
        (lambda: Isotropic(young_modulus=1.0, poisson_ratio=-1.0), r"poisson_ratio must be in \(-1, 0.5\]"),
        (lambda: Isotropic(young_modulus=1.0, poisson_ratio=0.51), r"poisson_ratio .* \(got 0.51\)"),
        (lambda: Orthotropic(**PLY | {"moduli": (1e9, 0.0, 1e9)}), "moduli must be positive"),
        (lambda: Orthotropic(**PLY | {"poisson_ratios": (0.3, 0.3, 1.2)}), "no strain has negative energy"),
        (lambda: Orthotropic(**PLY, y_axis=(1.0, 1.0, 0.0)), "at right angles"),
        (lambda: Cubic(c11=1.0, c12=1.1, c44=1.0), "c12 must be between"),
        (lambda: Cubic(c11=1.0, c12=-0.6, c44=1.0), "c12 must be between"),
        (lambda: Cubic(c11=1.0, c12=0.5, c44=-1.0), "c44 must be zero or positive"),
        (lambda: Cubic(**NICKEL, y_axis=(1.0, 1.0, 0.0)), "at right angles"),
        (lambda: Cubic(**NICKEL, x_axis=(0.0, 0.0, 0.0)), "not all zero"),
        (lambda: TransverselyIsotropic(**FIBRE | {"axial_poisson_ratio": 2.2}), "axial_poisson_ratio must be in"),
        (lambda: TransverselyIsotropic(**FIBRE | {"transverse_poisson_ratio": 1.0}), "transverse_poisson_ratio"),
        (lambda: TransverselyIsotropic(**FIBRE | {"axial_modulus": 0.0}), "axial_modulus must be positive"),
        (lambda: GivenStiffness(stiffness=np.eye(5).tolist()), "6 x 6"),
        (lambda: GivenStiffness(stiffness=np.triu(np.ones((6, 6)))), "symmetric"),
        (lambda: GivenStiffness(stiffness=-np.eye(6)), "without negative eigenvalues"),
    ],
)
def test_refusals(make, message):
    with pytest.raises(SceneError, match=message):
        make()
