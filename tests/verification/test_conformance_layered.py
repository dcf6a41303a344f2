"""The conformance kit of layered media can fail: each planted fault is caught by the checks that are meant for it."""

from dataclasses import replace

import numpy as np
import pytest

from eigencontact.plugin import Material
from eigencontact_plugins.layered.stack import BondedLayers, Layer, Substrate
from eigencontact_verification.conformance import ConformanceError, checks_for
from planted import Faults

LAYERS = (
    Layer(thickness=1e-6, young_modulus=400e9, poisson_ratio=0.2),
    Layer(thickness=3e-6, young_modulus=100e9, poisson_ratio=0.4),
)
SUBSTRATE = Substrate(young_modulus=210e9, poisson_ratio=0.3)
FAULTS = Faults(layers=LAYERS, substrate=SUBSTRATE)
plant = FAULTS.plant


class Spoilt(BondedLayers):
    """Bonded layers whose answer goes through `spoil`."""

    def response(self, quantity, components, traction, kx, ky, z, *, side="below"):
        values = super().response(quantity, components, traction, kx, ky, z, side=side)
        for row, name in enumerate(components):
            values[row] = self.spoil(values[row], (quantity, name, traction), np.hypot(kx, ky), z)
        return values

    def spoil(self, values, which, k, z):  # noqa: ARG002
        return values


@plant("check_load_on_surface", "check_reciprocity", "check_short_waves", "check_long_waves", "check_response_arrays")
class PushesUpwards(Spoilt):
    def spoil(self, values, which, k, z):  # noqa: ARG002
        return -values if which[2] == "p" else values


@plant("check_load_on_surface", "check_hooke", "check_response_arrays", "check_balance_below_the_surface")
class ShearNotMandel(Spoilt):
    def spoil(self, values, which, k, z):  # noqa: ARG002
        return values / np.sqrt(2) if which[1] in ("xz", "yz") else values


@plant("check_balance_below_the_surface", "check_hooke")
class StressALittleOff(Spoilt):
    def spoil(self, values, which, k, z):  # noqa: ARG002
        return 1.0001 * values if which[1] == "xx" else values


@plant("check_hooke")
class DisplacementFadesTooSoon(Spoilt):
    def spoil(self, values, which, k, z):
        return values * np.exp(-1e-3 * k * z) if which[0] == "displacement" else values


@plant("check_reciprocity", "check_short_waves", "check_hooke")
class CrossTermSign(Spoilt):
    def spoil(self, values, which, k, z):  # noqa: ARG002
        return -values if which == ("displacement", "z", "q_x") else values


@plant("check_directions", "check_long_waves", "check_hooke")
class StifferAlongY(Spoilt):
    def spoil(self, values, which, k, z):  # noqa: ARG002
        return 0.999 * values if which == ("displacement", "y", "q_y") else values


@plant("check_response_arrays")
class MeanDisplacement(Spoilt):
    def spoil(self, values, which, k, z):  # noqa: ARG002
        return np.where(k == 0, 1e-12, values) if which[0] == "displacement" else values


@plant("check_decay", "check_hooke")
class NeverDies(Spoilt):
    def spoil(self, values, which, k, z):  # noqa: ARG002
        return values + 1e-4 * (z > 0) if which[:2] == ("stress", "zz") else values


@plant("check_extreme_waves")
class GrowingExponential(Spoilt):
    def spoil(self, values, which, k, z):  # noqa: ARG002
        return values * np.exp(k * z) / np.exp(k * z)


@plant("check_interfaces")
class SlidingInterface(BondedLayers):
    def response(self, quantity, components, traction, kx, ky, z, *, side="below"):
        values = super().response(quantity, components, traction, kx, ky, z, side=side)
        return values * (1.01 if quantity == "displacement" and side == "above" else 1.0)


@plant("check_interfaces")
class SidesExchanged(BondedLayers):
    def response(self, quantity, components, traction, kx, ky, z, *, side="below"):
        other = {"above": "below", "below": "above"}[side]
        return super().response(quantity, components, traction, kx, ky, z, side=other)


@plant("check_materials", "check_hooke")
class OneMaterial(BondedLayers):
    def material_at(self, z, *, side="below"):  # noqa: ARG002
        return self.surface_material


@plant("check_long_waves")
class AnotherSubstrate(BondedLayers):
    @property
    def deep_material(self):
        return Material(young_modulus=200e9, poisson_ratio=0.3)

    def response(self, *arguments, **options):
        return BondedLayers(layers=self.layers, substrate=self.substrate).response(*arguments, **options)


@plant("check_materials", "check_short_waves")
class AnotherSurface(BondedLayers):
    @property
    def surface_material(self):
        return Material(young_modulus=400e9, poisson_ratio=0.25)


@plant("check_materials")
class ThicknessesForDepths(BondedLayers):
    @property
    def interfaces(self):
        return (3e-6, 1e-6)


@plant("check_response_arrays")
class RealNumbers(BondedLayers):
    def response(self, *arguments, **options):
        return np.abs(super().response(*arguments, **options))


@plant("check_response_at_depths")
class ForgetsTheOrder(BondedLayers):
    def response_at_depths(self, quantity, components, traction, kx, ky, depths, *, side="below"):
        depths = np.sort(depths)
        return super().response_at_depths(quantity, components, traction, kx, ky, depths, side=side)


@plant("check_response_at_depths")
class DepthsFirst(BondedLayers):
    def response_at_depths(self, *arguments, **options):
        return np.swapaxes(super().response_at_depths(*arguments, **options), 0, 1)

    def response(self, quantity, components, traction, kx, ky, z, *, side="below"):
        depths = np.array([z])
        return super().response_at_depths(quantity, components, traction, kx, ky, depths, side=side)[:, 0]


@plant("check_response_pure")
class Remembers(BondedLayers):
    asked = 0

    def response(self, *arguments, **options):
        type(self).asked += 1
        return super().response(*arguments, **options) * (1 + 1e-12 * self.asked)


@plant("check_response_pure")
class WritesToItsInput(BondedLayers):
    def response(self, quantity, components, traction, kx, ky, z, *, side="below"):
        kx *= 1.0
        return super().response(quantity, components, traction, kx, ky, z, side=side)


CASES = [(name, check) for name, (_, noticed) in FAULTS.items() for check in noticed]


@pytest.mark.parametrize(("name", "check"), CASES, ids=[f"{name}-{check}" for name, check in CASES])
def test_a_planted_fault_is_found(name, check):
    medium, _ = FAULTS[name]
    (run,) = [item for item in checks_for(medium) if item.__name__ == check]
    with pytest.raises(ConformanceError, match=f"{check} of layered-medium 'bonded-layers': "):
        run(medium)


def test_every_check_of_the_kind_finds_a_fault():
    medium = BondedLayers(layers=LAYERS, substrate=SUBSTRATE)
    own = {check.__name__ for check in checks_for(medium) if check.__module__.endswith("layered")}
    assert own == {check for _, check in CASES}


def test_the_medium_without_faults_passes_and_so_does_one_without_interfaces():
    """Like layers that hide their interfaces: the kit finds the lengths of a graded medium by its waves."""

    class Hidden(BondedLayers):
        @property
        def interfaces(self):
            return ()

        def material_at(self, z, *, side="below"):  # noqa: ARG002
            return self.deep_material

        def response(self, *arguments, **options):
            return BondedLayers(layers=self.layers, substrate=self.substrate).response(*arguments, **options)

    like = tuple(replace(layer, young_modulus=210e9, poisson_ratio=0.3) for layer in LAYERS)
    for medium in (BondedLayers(layers=LAYERS, substrate=SUBSTRATE), Hidden(layers=like, substrate=SUBSTRATE)):
        for check in checks_for(medium):
            if check.__module__.endswith("layered"):
                check(medium)
