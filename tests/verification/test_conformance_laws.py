"""The conformance kit of constitutive laws can fail: each planted fault is caught by the checks meant for it."""

# ruff: noqa: ARG002 - the interface of a law

from dataclasses import dataclass, replace
from functools import cache
from typing import ClassVar

import numpy as np
import pytest

from eigencontact.errors import SceneError
from eigencontact.plugin import ConstitutiveLaw, LinearLaw, Response, Stress, Variable, isotropic_stiffness
from planted import Faults, failing_checks
from toy_laws import DEVIATOR, Fibred, Stiffening, Waning, Yielding

STEEL = {"young_modulus": 2e11, "poisson_ratio": 0.3, "yield_stress": 2e8, "hardening_modulus": 1e10}
RUBBER = {"shear_modulus": 1e9, "growth": 1e4}
PLY = {"young_modulus": 1e9, "fibre_modulus": 1e11, "direction": (1.0, 2.0, -2.0)}
FADES = {"young_modulus": 2e11, "poisson_ratio": 0.3, "strain": 1e-3, "radius": 1e-6}
GOOD = [
    Yielding(**STEEL),
    Yielding(**STEEL | {"hardening_modulus": 0.0, "poisson_ratio": 0.0}),
    Stiffening(**RUBBER),
    Fibred(**PLY),
    Waning(**FADES),
]
FAULTS = Faults()
plant = FAULTS.plant


def failing(law):
    """Checks that a law fails, but for the one that it is installed."""
    return failing_checks(law) - {"check_registered"}


@cache
def failing_by_name(fault):
    return failing(FAULTS[fault][0])


class Spoilt(Yielding):
    """A law that yields, whose answer goes through `spoil`."""

    def update(self, strain, before, step):
        return self.spoil(super().update(strain, before, step), strain, before, step)

    def spoil(self, found, strain, before, step):
        return found


def with_variable(found, **changes):
    return replace(found, variables=dict(found.variables) | changes)


@plant("check_tangent", **STEEL)
class ElasticTangent(Spoilt):
    """Right until it yields."""

    def spoil(self, found, strain, before, step):
        stiffness = isotropic_stiffness(self.young_modulus, self.poisson_ratio)
        return replace(found, tangent=np.broadcast_to(stiffness[..., None], found.tangent.shape).copy())


@plant("check_tangent", **STEEL)
class TangentOfAFirstIncrement(Spoilt):
    """Right at rest, wrong with a history."""

    def spoil(self, found, strain, before, step):
        return replace(found, tangent=Yielding.update(self, strain, self.at_rest(strain), step).tangent)

    def at_rest(self, strain):
        return {"plastic_strain": np.zeros_like(strain), "hardening": np.zeros((1, strain.shape[1]))}


@plant("check_tangent", "check_tangent_symmetry", **STEEL)
class TangentALittleSkew(Spoilt):
    def spoil(self, found, strain, before, step):
        tangent = found.tangent.copy()
        tangent[0, 5] += 1e-4 * tangent[0, 0]
        return replace(found, tangent=tangent)


@plant("check_objectivity", **STEEL)
class PrefersAnAxis(Spoilt):
    """Stiffer along x, with a true tangent."""

    def spoil(self, found, strain, before, step):
        stress, tangent = found.stress.copy(), found.tangent.copy()
        stress[0] += 1e9 * strain[0]
        tangent[0, 0] += 1e9
        return replace(found, stress=stress, tangent=tangent)


@plant("check_objectivity", **STEEL)
class StrainNotAsTensor(Spoilt):
    """Remembers shear strains as engineers write them."""

    def spoil(self, found, strain, before, step):
        return with_variable(found, plastic_strain=np.array([1, 1, 1, 2, 2, 2.0])[:, None] * strain)


@plant("check_objectivity", **PLY)
class UnmarkedDirection(Fibred):
    """Neither isotropic nor with a direction."""

    direction: tuple[float, float, float] = (1.0, 0.0, 0.0)
    __annotations__ = {"direction": tuple[float, float, float]}


@plant("check_objectivity", **PLY)
class ClaimsToBeIsotropic(UnmarkedDirection):
    isotropic: ClassVar[bool] = True


@plant("check_objectivity", **PLY)
class TurnedTheOtherWay(Fibred):
    """Its z axis points out of the body."""

    def stiffness_matrix(self):
        x, y, z = self.direction
        mirror = Fibred(young_modulus=self.young_modulus, fibre_modulus=self.fibre_modulus, direction=(x, y, -z))
        return mirror.stiffness_matrix()


@plant("check_energy", **STEEL)
class GivesEnergy(Spoilt):
    """A dashpot of the wrong sign, with a true tangent."""

    variables: ClassVar = dict(Yielding.variables) | {
        "last_strain": Variable(unit="1", meaning="strain, Mandel components", components=6)
    }

    def spoil(self, found, strain, before, step):
        pushed = replace(found, stress=found.stress - 5e10 * (strain - before["last_strain"]))
        pushed = replace(pushed, tangent=found.tangent - 5e10 * np.eye(6)[..., None])
        return with_variable(pushed, last_strain=strain.copy())


@plant("check_energy", "check_stiffness", "check_tangent_symmetry", "check_factors", **PLY)
class SkewStiffness(Fibred):
    """The work of a loop depends on the way round."""

    def stiffness_matrix(self):
        matrix = super().stiffness_matrix()
        matrix[0, 1] *= 1.1
        return matrix


@plant("check_energy", "check_stiffness", **PLY)
class LosesEnergy(Fibred):
    """A linear law with a dashpot of its own."""

    variables: ClassVar = {"last_strain": Variable(unit="1", meaning="strain, Mandel components", components=6)}

    def update(self, strain, before, step):
        found = super().update(strain, before, step)
        stress = found.stress + 1e9 * (strain - before["last_strain"])
        tangent = found.tangent + 1e9 * np.eye(6)
        return Response(stress=stress, tangent=tangent, variables={"last_strain": strain.copy()})


@plant("check_rest", **STEEL)
class DividesByItsNorm(Spoilt):
    """Every yielding law's first fault."""

    def update(self, strain, before, step):
        with np.errstate(invalid="ignore"):
            direction = strain / np.linalg.norm(strain, axis=0)
        return self.spoil(super().update(strain + 0.0 * direction, before, step), strain, before, step)


@plant("check_rest", **RUBBER)
class StressAtRest(Stiffening):
    def update(self, strain, before, step):
        found = super().update(strain, before, step)
        return replace(found, stress=found.stress + 1.0)


@plant("check_rest", **STEEL)
class RemembersAtRest(Spoilt):
    """Hardening that begins at the yield stress."""

    def spoil(self, found, strain, before, step):
        return with_variable(found, hardening=np.maximum(found.variables["hardening"], 1.0))


@plant("check_response_shapes", "check_rest", **STEEL)
class NoTimeNoAnswer(Spoilt):
    """A rate in an increment without duration."""

    def spoil(self, found, strain, before, step):
        with np.errstate(divide="ignore", invalid="ignore"):
            return replace(found, stress=found.stress + 0.0 * (strain / np.float64(step.duration)))


@plant("check_response_shapes", **STEEL)
class PointsFirst(Spoilt):
    def spoil(self, found, strain, before, step):
        return replace(found, tangent=np.moveaxis(found.tangent, 2, 0).copy())


@plant("check_response_shapes", **RUBBER)
class SinglePrecision(Stiffening):
    def update(self, strain, before, step):
        found = super().update(strain, before, step)
        return replace(found, stress=found.stress.astype(np.float32))


@plant("check_response_shapes", **RUBBER)
class NeedsAPoint(Stiffening):
    def update(self, strain, before, step):
        strain.max()
        return super().update(strain, before, step)


@plant("check_response_shapes", **RUBBER)
class RemembersUnannounced(Stiffening):
    def update(self, strain, before, step):
        return with_variable(super().update(strain, before, step), energy=np.sum(strain * strain, axis=0)[None])


@plant("check_response_shapes", **STEEL)
class ForgetsAVariable(Spoilt):
    def spoil(self, found, strain, before, step):
        return replace(found, variables={"plastic_strain": found.variables["plastic_strain"]})


@plant("check_response_shapes", **STEEL)
class VariableOfAnotherShape(Spoilt):
    def spoil(self, found, strain, before, step):
        return with_variable(found, hardening=found.variables["hardening"][0])


@plant("check_variables", **STEEL)
class UnitOfNothing(Spoilt):
    variables: ClassVar = dict(Yielding.variables) | {"hardening": Variable(unit="GPsi", meaning="growth")}


@plant("check_variables", **STEEL)
class NoMeaning(Spoilt):
    variables: ClassVar = dict(Yielding.variables) | {"hardening": Variable(unit="Pa", meaning=" ")}


@plant("check_variables", **STEEL)
class NameThatIsTaken(Spoilt):
    variables: ClassVar = {"equivalent_eigenstrain": Variable(unit="1", meaning="strain", components=6)}

    def update(self, strain, before, step):
        found = super().update(strain, TangentOfAFirstIncrement.at_rest(self, strain), step)
        return replace(found, variables={"equivalent_eigenstrain": found.variables["plastic_strain"]})


@plant("check_update_pure", **STEEL)
class WritesToWhatItIsGiven(Spoilt):
    def spoil(self, found, strain, before, step):
        before["hardening"][:] = found.variables["hardening"]
        return found


@plant("check_update_pure", **RUBBER)
class HandsOutItsOwnArray(Stiffening):
    def update(self, strain, before, step):
        found = super().update(strain, before, step)
        kept = self.__dict__.setdefault("kept", {}).setdefault(strain.shape, np.empty_like(strain))
        kept[:] = found.stress
        return replace(found, stress=kept)


@plant("check_update_pure", **RUBBER)
class KeepsAMemoryOfItsOwn(Stiffening):
    def update(self, strain, before, step):
        calls = self.__dict__.setdefault("calls", [])
        calls.append(1)
        found = super().update(strain, before, step)
        return replace(found, stress=found.stress * (1 + 1e-12 * len(calls)))


@plant("check_points_alone", **STEEL)
class YieldsAllOrNone(Spoilt):
    """One test for all points."""

    def update(self, strain, before, step):
        most = np.linalg.norm(strain, axis=0).max(initial=0.0)
        law = Yielding(**STEEL | {"yield_stress": 2e8 if most > 5e-3 else 3e8})
        return law.update(strain, before, step)


@plant("check_law_at_places", young_modulus=1e9)
@dataclass(frozen=True, kw_only=True)
class ForgetsThePlaces(LinearLaw):
    """Softer below, as `at` says; `update` says nothing of it."""

    key: ClassVar[str] = "softer"
    references: ClassVar[tuple[str, ...]] = ("elementary",)
    isotropic: ClassVar[bool] = True

    young_modulus: Stress

    def __post_init__(self):
        Stiffening(shear_modulus=1.0, growth=0.0)
        if not 0 < self.young_modulus < np.inf:
            raise SceneError(f"{self.key}.young_modulus must be positive (got {self.young_modulus})")

    def stiffness_matrix(self):
        return self.young_modulus * np.eye(6)

    def at(self, x, y, z):
        return Points(moduli=self.young_modulus / (1.0 + np.abs(z) / 1e-5))


@dataclass(frozen=True, kw_only=True, eq=False)
class Points(LinearLaw):
    moduli: np.ndarray

    def stiffness_matrix(self):
        return self.moduli[:, None, None] * np.eye(6)


class Celled(Stiffening):
    """Linear for `growth` 0, with the answer of a cell in closed form."""

    def cell_answer(self, foreign, prestrain, around, before, step):
        deviator, mean = DEVIATOR @ foreign, foreign[:3].mean(axis=0)
        own, swelling = DEVIATOR @ prestrain, prestrain[:3].mean(axis=0)
        out = self.one(deviator, own, around.shear_stiffness, around.shear_give)
        out[:3] += self.one(mean, swelling, around.bulk_stiffness, around.bulk_give)
        return out, {}

    def one(self, foreign, own, taken, give):
        """The stress is 2G (f / κ - own) / (1 + 2G give), and e what is missing to it."""
        stress = 2 * self.shear_modulus * (foreign / taken - own) / (1 + 2 * self.shear_modulus * give)
        return (foreign - stress) / taken


@dataclass(frozen=True, kw_only=True)
class Mixture(LinearLaw):
    """Several laws strained alike; their directions are its own."""

    key: ClassVar[str] = "mixture"
    references: ClassVar[tuple[str, ...]] = ("elementary: a sum of energies",)

    solids: tuple[ConstitutiveLaw, ...]

    def stiffness_matrix(self):
        return sum(part.stiffness_matrix() for part in self.solids)


GOOD.append(Celled(shear_modulus=1e10, growth=0.0))


@plant("check_cell_answer", shear_modulus=1e10, growth=0.0)
class CellWithoutItsPrestrain(Celled):
    def cell_answer(self, foreign, prestrain, around, before, step):
        return super().cell_answer(foreign, 0 * prestrain, around, before, step)


@plant("check_cell_answer", shear_modulus=1e10, growth=0.0)
class CellAlmostRight(Celled):
    def one(self, foreign, own, taken, give):
        return (1 + 1e-5) * super().one(foreign, own, taken, give)


@plant("check_cell_answer", shear_modulus=1e10, growth=1e5)
class CellOfTheTangentAtRest(Celled):
    pass


@plant("check_law_of_body", **RUBBER)
class BodyBeforeItself(Stiffening):
    """Takes the modulus of the body where it was given one."""

    def of_body(self, young_modulus, poisson_ratio):
        return replace(self, shear_modulus=young_modulus / (2 * (1 + poisson_ratio)))


@plant("check_factors", **PLY)
class FactorsOfAnotherStiffness(Fibred):
    def factors(self, shear_modulus):
        return replace(self, fibre_modulus=1.01 * self.fibre_modulus).factors_of_own(shear_modulus)

    def factors_of_own(self, shear_modulus):
        return super().factors(shear_modulus)


@plant("check_factors", **PLY)
class FactorsNotComplete(Fibred):
    def factors(self, shear_modulus):
        soft, stiff = super().factors(shear_modulus)
        return 1.001 * soft, stiff


@plant("check_stiffness", **PLY)
class RefusesForNothing(Fibred):
    """A stiffness that is finite, as its factors show."""

    def stiffness_matrix(self):
        raise SceneError("fibred must not be asked")

    def factors(self, shear_modulus):
        return Fibred(**vars(self)).factors(shear_modulus)


@plant("check_stiffness", "check_factors", young_modulus=1e9, fibre_modulus=0.0)
class NegativeStiffness(Fibred):
    def stiffness_matrix(self):
        return np.diag([1e9, 1e9, -1e9, 1e9, 1e9, 1e9])


@plant("check_means", **FADES)
class DeafToMeans(Waning):
    """Acts by its own strain whatever it is told."""

    def update(self, strain, before, step):
        return super().update(strain, before, replace(step, means={}))


@plant("check_means", **FADES)
class MeansOfBefore(Waning):
    """Takes its own value from before the increment where it has no mean."""

    def update(self, strain, before, step):
        return super().update(strain, before, replace(step, means={"strained": before["strained"]} | dict(step.means)))


@plant("check_means", **FADES)
class MeansTwice(Waning):
    """Adds its own strain to the mean."""

    def update(self, strain, before, step):
        means = {name: values + np.linalg.norm(strain, axis=0) for name, values in step.means.items()}
        return super().update(strain, before, replace(step, means=means))


@plant("check_means", **FADES)
class AveragesWhatIsNot(Waning):
    averaged = property(lambda self: {"straind": self.radius})


@plant("check_means", **FADES)
class AveragesOverNothing(Waning):
    averaged: ClassVar = {"strained": 0.0}


@pytest.mark.parametrize("law", GOOD, ids=lambda law: law.key)
def test_correct_laws_pass(law):
    assert failing(law) == set()


@pytest.mark.parametrize("fault", FAULTS)
def test_planted_faults_are_noticed_by_name(fault):
    assert set(FAULTS[fault][1]) <= failing_by_name(fault)


#: Faults that leave all other promises kept.
ALONE = [
    "ElasticTangent", "TangentOfAFirstIncrement", "PrefersAnAxis", "StrainNotAsTensor", "TurnedTheOtherWay",
    "GivesEnergy", "RemembersAtRest", "NeedsAPoint", "UnitOfNothing", "KeepsAMemoryOfItsOwn", "YieldsAllOrNone",
    "FactorsNotComplete", "CellWithoutItsPrestrain", "CellAlmostRight", "BodyBeforeItself",
    "DeafToMeans", "MeansTwice", "AveragesOverNothing",
]  # fmt: skip


@pytest.mark.parametrize("fault", ALONE)
def test_nothing_else_is_blamed(fault):
    assert failing_by_name(fault) == set(FAULTS[fault][1])


def test_a_law_may_say_that_its_tangent_is_not_symmetric():
    law, _ = FAULTS["TangentALittleSkew"]
    told = type("Told", (type(law),), {"symmetric": False})(**STEEL)
    assert failing(told) == failing(law) - {"check_tangent_symmetry"}


def test_the_directions_of_parts_are_turned_with_the_law():
    """The table of its parts cannot be read back, as they are not installed; nothing else is amiss."""
    law = Mixture(solids=(Fibred(**PLY), Fibred(**PLY | {"direction": (0.0, 0.0, 1.0)})))
    assert failing(law) == {"check_fields_are_the_table"}
    blind = Mixture(solids=(FAULTS["TurnedTheOtherWay"][0], Fibred(**PLY)))
    assert failing(blind) == {"check_fields_are_the_table", "check_objectivity"}
