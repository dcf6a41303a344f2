"""The checks of moment potentials can fail: each planted fault is caught by the check that is meant for it."""

import numpy as np
import pytest

from eigencontact.plugin import HasMomentIntegrals, HasMomentPotentials, HasMomentSums
from eigencontact_plugins.shapes.cuboid import Cuboid
from eigencontact_plugins.shapes.ellipsoid import Ellipsoid
from eigencontact_verification.conformance import checks_for
from eigencontact_verification.conformance.kit import _OF_ABILITY
from planted import Faults, assert_noticed

GRAIN = {"center": (0.1, 0.2, 2.0), "semi_axes": (1.0, 0.7, 1.3), "rotation": (0.3, 0.4, 0.1)}
STRAIGHT = GRAIN | {"rotation": None}
ABILITIES = {HasMomentIntegrals, HasMomentPotentials, HasMomentSums}
CHECKS = {check.__name__: check for check, of in _OF_ABILITY.items() if of in ABILITIES}
FAULTS = Faults(**GRAIN)
plant = FAULTS.plant


def row_factor(orders, chosen, factor):
    return np.array([factor if order in chosen else 1.0 for order in orders])


@plant("check_densities", "check_moment_laplacian", "check_moment_quadrature")
class LowestDegreesLast(Ellipsoid):
    def densities(self, degree, x, y, z):
        return super().densities(degree, x, y, z)[::-1]


@plant("check_densities")
class OneDensityTwice(Ellipsoid):
    def densities(self, degree, x, y, z):
        values = super().densities(degree, x, y, z)
        values[1 if len(values) > 1 else 0] = values[2 if len(values) > 2 else 0]
        return values


@plant("check_densities")
class NothingOutside(Ellipsoid):
    def densities(self, degree, x, y, z):
        return super().densities(degree, x, y, z) * self.contains(x, y, z)


@plant("check_densities")
class OtherDensitiesByDegree(Ellipsoid):
    def densities(self, degree, x, y, z):
        return super().densities(degree, x, y, z) / (1 + degree)


@plant("check_densities_arrays")
class DensitiesInARow(Ellipsoid):
    def densities(self, degree, x, y, z):
        values = super().densities(degree, x, y, z)
        return values.reshape(len(values), int(np.prod(np.shape(x))))


@plant("check_densities_arrays")
class DensitiesThatWrite(Ellipsoid):
    def densities(self, degree, x, y, z):
        values = super().densities(degree, x, y, z)
        if np.ndim(x):
            x += 1.0
        return values


@plant("check_density_rule")
class WeightsTooLarge(Ellipsoid):
    def density_rule(self, counts):
        points, weights = super().density_rule(counts)
        return points, 1.002 * weights


@plant("check_density_rule")
class PointsOfAnUnturnedEllipsoid(Ellipsoid):
    def density_rule(self, counts):
        return Ellipsoid(center=self.center, semi_axes=self.semi_axes).density_rule(counts)


@plant("check_density_rule")
class TooFewPoints(Ellipsoid):
    def density_rule(self, counts):
        return super().density_rule(tuple(count // 2 for count in counts))


@plant("check_moment_arrays")
class SortsTheOrders(Ellipsoid):
    def phi_moments(self, degree, orders, x, y, z):
        return super().phi_moments(degree, sorted(orders), x, y, z)


@plant("check_moment_arrays")
class PotentialsInARow(Ellipsoid):
    def phi_moments(self, degree, orders, x, y, z):
        values = super().phi_moments(degree, orders, x, y, z)
        return values.reshape(*values.shape[:2], -1)


@plant("check_moment_arrays")
class KeepsState(Ellipsoid):
    def phi_moments(self, degree, orders, x, y, z):
        calls = self.__dict__.setdefault("calls", [])
        calls.append(1)
        return super().phi_moments(degree, orders, x, y, z) * (1 + 1e-12 * len(calls))


@plant("check_moment_quadrature", "check_moment_laplacian")
class OneSignReversed(Ellipsoid):
    def phi_moments(self, degree, orders, x, y, z):
        values = super().phi_moments(degree, orders, x, y, z)
        values[5] *= -1.0
        return values


@plant("check_moment_quadrature")
class HarmonicEverywhere(Ellipsoid):
    """Phi + x y / 50 of each density: no identity notices."""

    def phi_moments(self, degree, orders, x, y, z):
        more = {(0, 0, 0): x * y, (1, 0, 0): y, (0, 1, 0): x, (1, 1, 0): 1.0 + 0 * x}
        extra = np.array([more.get(order, 0.0 * x) for order in orders])
        return super().phi_moments(degree, orders, x, y, z) + extra / 50


@plant("check_moment_boundary", "check_moment_quadrature")
class HarmonicInside(Ellipsoid):
    """Phi + (x² - y²) / 50 inside: only the boundary and the integral inside notice."""

    def phi_moments(self, degree, orders, x, y, z):
        more = {
            (0, 0, 0): x * x - y * y,
            (1, 0, 0): 2 * x,
            (0, 1, 0): -2 * y,
            (2, 0, 0): 2 + 0 * x,
            (0, 2, 0): -2 + 0 * x,
        }
        extra = np.array([more.get(order, 0.0 * x) for order in orders]) * self.contains(x, y, z)
        return super().phi_moments(degree, orders, x, y, z) + extra / 50


@plant("check_moment_boundary", **STRAIGHT)
class InnerValueOnTheBoundary(Ellipsoid):
    def phi_moments(self, degree, orders, x, y, z):
        inner = (c + (t - c) * (1 - 1e-12) for t, c in zip((x, y, z), self.center, strict=True))
        return super().phi_moments(degree, orders, *inner)


@plant("check_moment_derivatives")
class OneOrderScaled(Ellipsoid):
    def phi_moments(self, degree, orders, x, y, z):
        factor = row_factor(orders, {(2, 1, 2)}, 1 + 3e-6)
        return np.moveaxis(np.moveaxis(super().phi_moments(degree, orders, x, y, z), 1, -1) * factor, -1, 1)


class FaultyWeights(Ellipsoid):
    """Changes the weights of one potential."""

    def changed(self, name, orders, weights, image):
        raise NotImplementedError

    def moment_sums(self, degree, weights, x, y, z, *, image):
        changed = {name: (orders, self.changed(name, orders, of, image)) for name, (orders, of) in weights.items()}
        return super().moment_sums(degree, changed, x, y, z, image=image)


@plant("check_sums_of_phi", "check_sums_of_psi")
class OddOrdersOfTheImageKept(FaultyWeights):
    def changed(self, name, orders, weights, image):
        odd = [order for order in orders if order[2] % 2]
        return weights * row_factor(orders, odd, -1.0) if image and name == "phi" else weights


@plant("check_sums_of_phi")
class OneSumOfPhiScaled(FaultyWeights):
    def changed(self, name, orders, weights, image):  # noqa: ARG002
        return weights * row_factor(orders, {(1, 1, 3)} if name == "phi" else {}, 1.0 + 1e-4)


@plant("check_sums_of_psi")
class OneSumOfPsiScaled(FaultyWeights):
    def changed(self, name, orders, weights, image):  # noqa: ARG002
        return weights * row_factor(orders, {(2, 1, 1)} if name == "psi" else {}, 1.0 + 1e-4)


@plant("check_sums_of_psi")
class OneDensityOfPsiLost(FaultyWeights):
    def changed(self, name, orders, weights, image):  # noqa: ARG002
        kept = np.arange(weights.shape[1]) != weights.shape[1] - 1
        return weights * kept[:, None] if name == "psi" else weights


@plant("check_sums_of_chi")
class OneSumOfChiScaled(FaultyWeights):
    def changed(self, name, orders, weights, image):  # noqa: ARG002
        return weights * row_factor(orders, {(2, 1, 1)} if name == "chi" else {}, 1.0 + 1e-4)


@plant("check_sums_of_chi", **STRAIGHT)
class DensitiesOfChiNotMirrored(FaultyWeights):
    def changed(self, name, orders, weights, image):  # noqa: ARG002
        odd = np.array([1.0, 1.0, 1.0, -1.0] + [1.0] * (weights.shape[1] - 4))
        return weights * odd[:, None] if name == "chi" else weights


@plant("check_moment_integrals")
class PointsInsideForgotten(Ellipsoid):
    def moment_integrals(self, degree, weights, x, y, z, tests, *, image):
        tests = tests if image else tests * ~self.contains(x, y, z)
        return super().moment_integrals(degree, weights, x, y, z, tests, image=image)


@pytest.mark.parametrize("name", FAULTS)
def test_the_check_that_is_meant_for_it_notices(name):
    component, noticed = FAULTS[name]
    for expected in noticed:
        assert_noticed(component, CHECKS[expected])


def test_every_check_is_seen_to_fail():
    assert FAULTS.noticed == set(CHECKS)


@pytest.mark.slow
@pytest.mark.parametrize("parameters", [GRAIN, STRAIGHT], ids=["turned", "straight"])
def test_without_a_fault_all_pass(parameters):
    for check in CHECKS.values():
        check(Ellipsoid(**parameters))


def test_checks_follow_the_ability():
    assert set(CHECKS) <= {check.__name__ for check in checks_for(Ellipsoid(**GRAIN))}
    cube = {check.__name__ for check in checks_for(Cuboid(center=(0.0, 0.0, 2.0), edges=(1.0, 1.0, 1.0)))}
    assert not set(CHECKS) & cube
