"""Cells of any law: the linear answer, answers that satisfy the law, Newton's halvings, laws that do not answer."""

# ruff: noqa: ARG002, ARG005 - the interface of a law

from dataclasses import dataclass, field, replace
from typing import Any, ClassVar

import numpy as np
import pytest
from scipy.optimize import root

from eigencontact.core.material import Material
from eigencontact.errors import NotConverged, NotUnique, PluginError, SceneError
from eigencontact.plugin import LawStep, Response, Surroundings, Variable
from eigencontact.solvers import law_cells
from eigencontact.solvers.cell_conditions import compliance, condition_of, constraint_of_ball
from eigencontact.solvers.law_cells import LawCells
from eigencontact_plugins.hardening.kinematic import Prager
from eigencontact_plugins.hardening.linear import Linear
from eigencontact_plugins.laws.cubic import Cubic
from eigencontact_plugins.laws.isotropic import Isotropic
from eigencontact_plugins.laws.j2 import J2
from eigencontact_plugins.laws.map import IsotropicPoints
from eigencontact_plugins.laws.void import Void
from toy_laws import Fibred, Stiffening, Yielding

MATRIX = Material(young_modulus=2e11, poisson_ratio=0.3)
ALONE = -constraint_of_ball(MATRIX)
COUNT = 7
STEEL = Yielding(young_modulus=2e11, poisson_ratio=0.3, yield_stress=2e8, hardening_modulus=1e10)
RUBBER = Stiffening(shear_modulus=1e9, growth=1e5)


def step_of(count=COUNT):
    x = np.arange(count) * 1e-6
    return LawStep(x=x, y=2 * x, z=3 * x + 1e-6, time=1.0, duration=0.5)


def loads(count=COUNT, size=5e8, seed=0):
    """Stress of others in the cells, an eigenstrain that they have, and a prestrain."""
    rng = np.random.default_rng(seed)
    foreign = size * rng.standard_normal((6, count))
    return foreign, 1e-3 * rng.standard_normal((6, count)), 1e-3 * rng.standard_normal((6, count))


def answered(law, foreign, start, prestrain, before=None):
    """Eigenstrain and variables of cells of one law."""
    count = foreign.shape[1]
    known = before if before is not None else at_rest(law, count)
    cells = LawCells(MATRIX, ALONE, [(law, np.arange(count))])
    found, (after,) = cells.answer(start, foreign + ALONE @ start, prestrain, [known], [step_of(count)])
    return found, after


def at_rest(law, count=COUNT):
    return {name: np.zeros((item.components, count)) for name, item in law.variables.items()}


def strain_of(foreign, eigenstrain, prestrain):
    return compliance(MATRIX) @ (foreign + ALONE @ eigenstrain) + eigenstrain - prestrain


LINEAR = [
    Cubic(c11=2.4e11, c12=1.4e11, c44=1.2e11, x_axis=(1.0, 2.0, 2.0), y_axis=(2.0, 1.0, -2.0)),
    Isotropic(young_modulus=2e17, poisson_ratio=0.2),
    Isotropic(young_modulus=2e4, poisson_ratio=0.2),
    Void(),
    Fibred(young_modulus=1e9, fibre_modulus=1e12, direction=(1.0, 1.0, 0.0)),
]


@pytest.mark.parametrize("law", LINEAR, ids=lambda law: law.key)
def test_a_linear_law_answers_as_its_factors_do(law):
    foreign, start, prestrain = loads()
    found, after = answered(law, foreign, start, prestrain)
    stress, strain, own = condition_of(law, MATRIX)
    expected = np.linalg.solve(stress @ ALONE + strain, own @ prestrain - stress @ foreign)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9 * np.abs(expected).max())
    assert after == {}


def test_constants_of_each_cell():
    law = IsotropicPoints(young_modulus=np.geomspace(1e9, 1e13, COUNT), poisson_ratio=np.linspace(0, 0.4, COUNT))
    foreign, start, prestrain = loads()
    found, _ = answered(law, foreign, start, prestrain)
    for cell in range(COUNT):
        one = Isotropic(young_modulus=law.young_modulus[cell], poisson_ratio=law.poisson_ratio[cell])
        alone, _ = answered(one, *(values[:, cell : cell + 1] for values in (foreign, start, prestrain)))
        np.testing.assert_allclose(found[:, cell], alone[:, 0], rtol=0, atol=1e-9 * np.abs(alone).max())


@pytest.mark.parametrize(
    "law", [STEEL, replace(STEEL, hardening_modulus=0.0), RUBBER], ids=["steel", "ideal", "rubber"]
)
def test_what_is_found_satisfies_the_law_and_is_what_others_find(law):
    foreign, start, prestrain = loads()
    found, after = answered(law, foreign, start, prestrain)
    stress = law.update(strain_of(foreign, found, prestrain), at_rest(law), step_of()).stress
    np.testing.assert_allclose(stress, foreign + ALONE @ found, rtol=0, atol=1e-9 * np.abs(foreign).max())
    if law is not RUBBER:
        assert after["plastic_strain"].any()
    for cell in range(2):
        part = [values[:, cell : cell + 1] for values in (foreign, prestrain)]

        def missing(e, part=part):
            response = law.update(strain_of(part[0], e[:, None], part[1]), at_rest(law, 1), step_of(1))
            return (response.stress - part[0] - ALONE @ e[:, None])[:, 0] / 1e8

        other = root(missing, start[:, cell], tol=1e-12)
        np.testing.assert_allclose(found[:, cell], other.x, rtol=0, atol=1e-7 * np.abs(other.x).max())


def test_a_history_is_taken_up_and_left_as_it_was():
    foreign, start, prestrain = loads()
    _, after = answered(STEEL, foreign, start, prestrain)
    kept = {name: values.copy() for name, values in after.items()}
    none = np.zeros_like(start)
    unloaded, final = answered(STEEL, 0.1 * foreign, none, none, before=after)
    for name, values in kept.items():
        np.testing.assert_array_equal(after[name], values)
    assert np.abs(unloaded).max() > 1e-4
    assert not np.array_equal(final["plastic_strain"], 0 * kept["plastic_strain"])
    virgin, _ = answered(STEEL, 0.1 * foreign, none, none)
    assert np.abs(virgin - unloaded).max() > 1e-4


def test_several_laws_have_their_own_cells_variables_and_places():
    foreign, start, prestrain = loads(9)
    asked = []

    class Diary(Stiffening):
        def update(self, strain, before, step):
            asked.append((strain.shape[1], step.x))
            return super().update(strain, before, step)

    groups = [(STEEL, np.array([8, 1, 4])), (Diary(shear_modulus=1e9, growth=1e5), np.array([0, 7]))]
    cells = LawCells(MATRIX, ALONE, groups)
    assert cells.cells.tolist() == [8, 1, 4, 0, 7]
    part = [values[:, cells.cells] for values in (foreign, start, prestrain)]
    steps = [step_of(3), replace(step_of(2), x=np.array([5.0, 6.0]))]
    found, after = cells.answer(
        part[1], part[0] + ALONE @ part[1], part[2], [at_rest(STEEL, 3), {}], steps
    )  # fmt: skip
    for law, where in ((STEEL, slice(0, 3)), (RUBBER, slice(3, 5))):
        alone, _ = answered(law, *(values[:, where] for values in part))
        np.testing.assert_allclose(found[:, where], alone, rtol=0, atol=1e-12)
    assert set(after[0]) == set(STEEL.variables)
    assert after[1] == {}
    assert all(count == 2 and x.tolist() == [5.0, 6.0] for count, x in asked)


AROUND = Surroundings(young_modulus=2e11, poisson_ratio=0.3)


@pytest.mark.parametrize("threads", [1, 2])
def test_cells_that_are_asked_in_parts_answer_as_all_at_once(monkeypatch, threads):
    hardening = (Linear(yield_stress=2e8, modulus=1e10), Prager(modulus=5e9))
    law = J2(hardening=hardening, young_modulus=2e11, poisson_ratio=0.3)
    foreign, start, prestrain = loads(31, 1.5e8)
    start, prestrain = 0.1 * start, 0.1 * prestrain
    before = at_rest(law, 31)
    before["equivalent_plastic_strain"] += np.linspace(0.0, 1e-2, 31)
    answers = []
    for size in (31, 7):
        monkeypatch.setattr(law_cells, "_ANSWER_CHUNK", size)
        cells = LawCells(MATRIX, ALONE, [(law, np.arange(31))], AROUND, threads=threads)
        found, (after,) = cells.answer(start, foreign, prestrain, [before], [step_of(31)])
        answers.append(np.concatenate([found, *after.values()]))
    np.testing.assert_allclose(answers[1], answers[0], rtol=1e-12, atol=0.0)
    flowed = answers[0][6] > before["equivalent_plastic_strain"][0]
    assert 0 < flowed.sum() < 31


def test_cells_without_a_unique_answer_are_all_counted_and_the_first_is_named(monkeypatch):
    monkeypatch.setattr(law_cells, "_ANSWER_CHUNK", 4)
    steep = Linear(yield_stress=2e8, modulus=-1e12)
    law = J2(hardening=(steep,), young_modulus=2e11, poisson_ratio=0.3)
    stress = np.zeros((6, 11))
    stress[3, [5, 6, 10]] = 1e9
    cells = LawCells(MATRIX, ALONE, [(law, np.arange(11))], AROUND)
    with pytest.raises(NotUnique, match=r"3 of 11 cells have no unique answer, first cell 5 at x = 5e-06 m") as caught:
        cells.answer(np.zeros((6, 11)), stress, np.zeros((6, 11)), [at_rest(law, 11)], [step_of(11)])
    assert list(caught.value.points) == [5, 6, 10]


def test_nothing_is_the_answer_to_nothing():
    zero = np.zeros((6, COUNT))
    for law in (STEEL, RUBBER, LINEAR[0]):
        found, after = answered(law, zero, zero, zero)
        assert not found.any()
        assert not any(values.any() for values in after.values())
    assert LawCells(MATRIX, ALONE, []).cells.size == 0


def test_a_prestrain_alone_is_answered():
    zero = np.zeros((6, COUNT))
    found, _ = answered(LINEAR[0], zero, zero, zero + 1e-3)
    expected, _ = answered(LINEAR[0], zero, zero + 1e-3, zero + 1e-3)
    np.testing.assert_allclose(found, expected, rtol=1e-9)


def test_cells_that_are_done_are_not_asked_for_more():
    """Rounding that no step lowers halves nothing: six Newton steps take no twenty questions."""
    asked = []

    class Counted(Yielding):
        def update(self, strain, before, step):
            asked.append(1)
            return super().update(strain, before, step)

    answered(Counted(**vars(STEEL)), *loads(20000))
    assert len(asked) <= 8


@dataclass(frozen=True)
class Saturating(Stiffening):
    """Stress that saturates at 1 GPa: from far away Newton's whole steps go to and fro and never arrive."""

    key: ClassVar[str] = "saturating"
    end: float = np.inf
    beyond: list = field(default_factory=list)

    def update(self, strain, before, step):
        size, modulus = np.linalg.norm(strain, axis=0), 1e14
        chord = 1 / (1 + size / 1e-5)
        unit = strain / np.where(size > 0, size, 1.0)
        outer = unit[:, None] * unit[None]
        stress = modulus * chord * strain
        self.beyond.append((size > self.end).any())
        tangent = modulus * (chord**2 * outer + chord * (np.eye(6)[..., None] - outer))
        return Response(stress=np.where(size > self.end, np.nan, stress), tangent=tangent)


def test_steps_are_halved_where_whole_ones_do_not_arrive(monkeypatch):
    law, (foreign, start, prestrain) = Saturating(shear_modulus=1.0, growth=0.0), loads(size=1e6)
    found, _ = answered(law, foreign, start, prestrain)
    stress = law.update(strain_of(foreign, found, prestrain), {}, step_of()).stress
    np.testing.assert_allclose(stress, foreign + ALONE @ found, rtol=0, atol=1e-7 * np.abs(stress).max())
    monkeypatch.setattr(law_cells, "_HALVINGS", 1)
    with pytest.raises(NotConverged, match="constitutive law 'saturating' found no stress for the strain at x = "):
        answered(law, foreign, start, prestrain)


def test_a_step_to_where_a_law_has_no_numbers_is_halved():
    """The law ends close to the largest strain at the start; some whole step goes beyond."""
    foreign, start, prestrain = loads(size=1e6)
    expected, _ = answered(Saturating(shear_modulus=1.0, growth=0.0), foreign, start, prestrain)
    end = 1.01 * np.linalg.norm(strain_of(foreign, start, prestrain), axis=0).max()
    law = Saturating(shear_modulus=1.0, growth=0.0, end=end)
    found, _ = answered(law, foreign, start, prestrain)
    assert any(law.beyond)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9 * np.abs(expected).max())


@dataclass(frozen=True)
class Odd(Stiffening):
    """A law with a change to its answer."""

    key: ClassVar[str] = "odd"
    variables: ClassVar = {"mark": Variable(unit="1", meaning="anything", components=2)}
    change: Any = None

    def update(self, strain, before, step):
        found = super().update(strain, before, step)
        good = replace(found, variables={"mark": np.ones((2, strain.shape[1]))})
        return self.change(good, strain) if self.change else good


def raises(problem):
    def change(found, strain):
        raise problem

    return change


def beyond(limit, value=np.nan):
    """Numbers that are not finite where the strain is larger than a limit."""

    def change(found, strain):
        far = np.linalg.norm(strain, axis=0) > limit
        return replace(found, stress=np.where(far, value, found.stress))

    return change


BAD = {
    "stress of one point": (lambda f, e: replace(f, stress=f.stress[:, :1]), r"stress .* shape \(6, 7\) .*\(6, 1\)"),
    "stress of no array": (lambda f, e: replace(f, stress="none"), "stress of .* must be an array, real numbers"),
    "complex": (lambda f, e: replace(f, stress=1j * f.stress), "must be an array, real numbers .got complex"),
    "points first": (lambda f, e: replace(f, tangent=f.tangent.T), r"tangent .*\(6, 6, 7\) or \(6, 6\)"),
    "no response": (lambda f, e: None, "failed with AttributeError"),
    "no variable": (lambda f, e: replace(f, variables={}), r"that it declares, \['mark'\] \(got \[\]\)"),
    "one more": (
        lambda f, e: replace(f, variables=dict(f.variables) | {"sum": e[0]}), r"got \['mark', 'sum'\]",
    ),
    "shape of variable": (
        lambda f, e: replace(f, variables={"mark": e}), r"variable 'mark' .*\(2, 7\) \(got shape \(6, 7\)\)",
    ),
    "variable not finite": (
        lambda f, e: replace(f, variables={"mark": np.full((2, 7), np.nan)}), "finite numbers .* at 7 of 7 points",
    ),
    "tangent not finite": (lambda f, e: replace(f, tangent=np.inf * f.tangent), "finite numbers"),
    "stress not finite": (beyond(0.0), r"finite numbers \(got others at x = .* at a strain of \["),
    "fails": (raises(ZeroDivisionError("of mine")), "without an exception .got ZeroDivisionError: of mine"),
    "leaves": (raises(SystemExit(0)), "without an exception .got SystemExit: 0"),
    "masked": (lambda f, e: replace(f, stress=np.ma.masked_less(f.stress, np.inf)), "stress of .* none of them masked"),
    "booleans": (lambda f, e: replace(f, stress=f.stress > 0), "stress of .* real numbers .got booleans"),
}  # fmt: skip


@pytest.mark.parametrize("case", BAD)
def test_a_law_that_answers_what_it_must_not_is_named(case):
    change, message = BAD[case]
    with np.errstate(invalid="ignore"), pytest.raises(PluginError, match=message) as caught:
        answered(Odd(shear_modulus=1e9, growth=0.0, change=change), *loads())
    assert "constitutive law 'odd'" in str(caught.value)


@pytest.mark.parametrize("problem", [SceneError("mine"), NotConverged("mine")], ids=lambda p: type(p).__name__)
def test_its_own_refusals_go_through(problem):
    with pytest.raises(type(problem), match=r"^mine$"):
        answered(Odd(shear_modulus=1e9, growth=0.0, change=raises(problem)), *loads())


def test_no_finite_answer_beyond_all_strains_means_that_the_step_is_too_large():
    law = Odd(shear_modulus=1e9, growth=0.0, change=beyond(1.0))
    foreign, start, prestrain = loads()
    with pytest.raises(NotConverged, match=r"constitutive law 'odd' .* strains beyond 1\); take smaller load steps"):
        answered(law, foreign, 1e6 * start, prestrain)


class Jumping(Stiffening):
    """Stress that jumps from push to pull: in between there is none."""

    key: ClassVar[str] = "jumping"

    def update(self, strain, before, step):
        return Response(stress=1e9 * np.where(strain > 0, 1.0, -1.0), tangent=np.zeros((6, 6)))


def test_a_cell_without_answer_is_named_with_its_law_and_place():
    foreign, start, prestrain = loads(size=1e3)
    with pytest.raises(NotConverged, match=r"law 'jumping' found no stress .* at x = [0-6]e-06 m.* smaller load steps"):
        answered(Jumping(shear_modulus=1.0, growth=0.0), foreign, start, prestrain)


def test_cells_whose_strain_is_not_determined_are_no_error_of_numpy():
    """A body around that bears nothing in one component, and a cell that does not either."""
    cells = LawCells(MATRIX, np.diag([-1e11] * 5 + [0.0]), [(Void(), np.arange(COUNT))])
    foreign, start, prestrain = loads()
    with pytest.raises(NotConverged, match="law 'void': cells are so soft that their strain is not determined"):
        cells.answer(start, foreign, prestrain, [{}], [step_of()])
