"""Laws of strangers under the cross-check: known by their keys, asked by both methods, refused with a reason."""

from dataclasses import replace

import numpy as np
import pytest

import eigencontact as ec
from bodies import STEEL
from close import close
from eigencontact.execution.interiors.cells import Cells
from eigencontact_verification.crosscheck.case import error_key
from eigencontact_verification.crosscheck.judge import judge
from eigencontact_verification.crosscheck.laws import LawOfPlugin, law_cases
from eigencontact_verification.crosscheck.run import Solved, tasks_of
from eigencontact_verification.crosscheck.worker import Outcome, perform
from eigencontact_verification.fem.yielding_law import YieldingLaw, linear

MY_DAMAGE = """
from dataclasses import dataclass
from typing import ClassVar
import numpy as np
from eigencontact.plugin import PlasticDamage, hookimpl

@dataclass(frozen=True, kw_only=True)
class MyDamage(PlasticDamage):
    key: ClassVar[str] = "my-damage"
    references: ClassVar[tuple[str, ...]] = ("elementary",)
    {example}
    most: float
    strain: float

    def damage(self, p):
        part = np.tanh(p / self.strain)
        return self.most * part, self.most / self.strain * (1 - part**2)

@hookimpl
def eigencontact_register():
    return [MyDamage]
"""

MY_LAW = """
from dataclasses import dataclass
from typing import ClassVar
import toy_laws
from eigencontact.plugin import hookimpl

@dataclass(frozen=True, kw_only=True)
class MyLaw(toy_laws.{base}):
    key: ClassVar[str] = "my-law"
    references: ClassVar[tuple[str, ...]] = ("elementary",)
    example: ClassVar = {example}

@hookimpl
def eigencontact_register():
    return [MyLaw]
"""
STRONG = {"young_modulus": "70 GPa", "poisson_ratio": 0.25, "yield_stress": "1 GPa", "hardening_modulus": "5 GPa"}


@pytest.fixture
def my_damage(install):
    install(MY_DAMAGE.format(example='example: ClassVar = {"most": 0.3, "strain": 0.01}'))


def test_a_law_of_damage_is_put_into_metal_plasticity(my_damage):
    loaded, cycled = law_cases("my-damage")
    assert loaded.parameters["law"]["damage"] == {"type": "my-damage", "most": 0.3, "strain": 0.01}
    assert (loaded.quick, cycled.quick) == (True, False)
    assert [profile.components for profile in loaded.profiles if profile.quantity == "strain"] == [
        ("e_p",),
        ("damage",),
    ]
    assert loaded.problem.pressure == close(1.7 * 3e9 / 0.62, rel=2e-3)
    law = loaded.law_of(loaded.parameters["law"], 210e9, 0.3)
    assert law.law.damage.key == "my-damage"


def test_a_refined_law_has_finer_meshes_and_cells(my_damage):
    case = law_cases("my-damage")[0]
    finer = case.refined(1.5)
    assert finer.parameters["divisions"] == [6, 12, 24]
    assert (finer.cells, finer.coarser) == (24, (9, 12))
    assert {**finer.parameters, "divisions": None} == {**case.parameters, "divisions": None}
    assert case.refined(1.0).parameters == case.parameters


def test_an_inconclusive_law_names_the_largest_part_and_the_refinement(my_damage):
    """Cells that differ much are no reason to refine the elements alone, and the outer faces none at all."""
    case = law_cases("my-damage")[0]
    case = replace(case, profiles=tuple(profile for profile in case.profiles if profile.quantity == "strain"))
    points = case.profiles[0].points
    exact = np.exp(-points[:, 2:])
    outcomes = []
    for task in tasks_of(case):
        fields = {profile.name: exact for profile in case.profiles}
        if task.level is None:
            fields |= {error_key(profile.name): 0.05 + 0 * exact for profile in case.profiles}
        outcomes.append((task, Outcome(status="done", fields=fields)))
    row = judge(Solved(case=case, outcomes=tuple(outcomes))).rows[0]
    assert row.word == "inconclusive"
    assert "exceeds the limit of 2 %; its largest part is the cells of the semi-analytical model (" in row.reason
    assert row.reason.endswith("; repeat with --refine 2.5")
    assert case.remedy("truncation", 2.0) == ""


def test_the_error_of_cells_has_the_order_of_what_the_law_remembers(my_damage, monkeypatch):
    """Plastic strain has the order that it has in the cases of plasticity, damage a lower one."""
    case = law_cases("my-damage")[0]
    values = {16: 1.0, 8: 1.3, 6: 1.3}
    names = [profile.name for profile in case.profiles]
    made = {cells: {name: np.full((3, 1), value) for name in names} for cells, value in values.items()}
    monkeypatch.setattr(type(case), "by_cells", lambda _self, cells: made[cells])
    fields = case.judged()
    for name, order in (("axis-equivalent_plastic_strain", 2.0), ("axis-damage", 1.5), ("axis-stress", 1.5)):
        assert fields[error_key(name)].max() == close(0.3 / (2.0**order - 1.0), rel=1e-12)


def test_what_the_law_remembers_is_compared(my_damage):
    """The elements' damage is that of their plastic strain where both are read, and what is left of it stays."""
    case = law_cases("my-damage")[0]
    case = replace(case, parameters={**case.parameters, "fine": 1.0, "divisions": [2, 2, 2]})
    found = case.reference(0, "fixed")
    strain, damage = found["axis-equivalent_plastic_strain"], found["axis-damage"]
    assert damage.shape == (len(case.profiles[-1].points), 1)
    assert strain.max() > 5e-3
    assert damage.max() == close(0.3 * np.tanh(strain.max() / 0.01), rel=0.05)


def test_a_law_of_a_material_brings_its_own_constants(install):
    install(MY_LAW.format(base="Yielding", example=STRONG))
    loaded, _ = law_cases("my-law")
    assert loaded.problem.young_modulus == close(70e9, rel=1e-9)
    assert loaded.problem.poisson_ratio == close(0.25, rel=1e-9)


def test_the_elements_ask_the_law_itself():
    """Components in a body of revolution, there and back, against the elements' own law."""
    asked = LawOfPlugin(
        law=ec.make("j2", hardening=[{"type": "linear", "yield_stress": 3e9, "modulus": 2e10}], **STEEL)
    )
    own = YieldingLaw(**STEEL, hardening=linear(3e9, 2e10))
    states = [law.state_at_rest(4, 30) for law in (asked, own)]
    strain = 0.02 * np.random.default_rng(2).normal(size=(4, 30))
    for factor in (1.0, -0.5, 0.7):
        found = [law.answer(factor * strain, state) for law, state in zip((asked, own), states, strict=True)]
        np.testing.assert_allclose(found[0][0], found[1][0], rtol=0, atol=1e-9 * np.abs(found[1][0]).max())
        np.testing.assert_allclose(found[0][1], found[1][1], rtol=0, atol=1e-6 * np.abs(found[1][1]).max())
        states = [answer[2] for answer in found]
    assert states[0]["equivalent_plastic_strain"][0] == close(states[1]["p"], rel=1e-9)


@pytest.mark.parametrize(
    ("source", "message"),
    [
        (MY_DAMAGE.format(example="pass"), r"'my-damage' must say with which parameters .* mapping with most, strain"),
        (MY_LAW.format(base="Fibred", example={"young_modulus": 1e9, "fibre_modulus": 1e11, "direction": [1, 0, 0]}),
         r"'my-law' must be more than elastic"),
        (MY_LAW.format(base="Stiffening", example={"shear_modulus": 1e9, "growth": 1e16}),
         r"'my-law' must be elastic under small strains"),
        (MY_LAW.format(base="Yielding", example=STRONG | {"yield_stress": 1e15}),
         r"'my-law' must leave elasticity within a strain of 0.2"),
    ],
)  # fmt: skip
def test_laws_that_cannot_be_judged_are_refused(install, source, message):
    install(source)
    with pytest.raises(ValueError, match=message):
        law_cases("my-law" if "my-law" in source else "my-damage")


def test_a_key_that_nobody_has_is_refused():
    with pytest.raises(ValueError, match=r"law must be one of .*j2.*perfect.* \(got 'swfit'\).*swift"):
        law_cases("swfit")


def test_another_text_of_the_law_is_another_problem(install):
    """Solutions that are kept are those of the text that was asked, whatever its version says."""
    texts = []
    for base in ("my-law", "other-law"):
        install(MY_LAW.format(base="Yielding", example=STRONG).replace("my-law", base), name=base, entry=base)
        texts.append(law_cases(base)[0].parameters["text"])
    assert texts[0] != texts[1]


@pytest.mark.slow
def test_a_stranger_agrees_and_a_fault_around_it_disagrees(my_damage, monkeypatch):
    case = law_cases("my-damage")[0]
    kept = tuple(profile for profile in case.profiles if profile.quantity != "strain")
    parameters = {**case.parameters, "fine": 1.0, "divisions": [1, 2, 4]}
    case = replace(case, profiles=kept, parameters=parameters, cells=6, coarser=(4,))
    found = Solved(case=case, outcomes=tuple((task, perform(task)) for task in tasks_of(case)))
    rows = judge(found).rows
    assert {row.word for row in rows} <= {"agrees", "inconclusive"}  # six cells a radius cannot say more
    assert max(row.difference for row in rows if row.quantity == "displacement") < 0.03
    whole = Cells.mean_displacement
    monkeypatch.setattr(Cells, "mean_displacement", lambda self, eigenstrain: 0.0 * whole(self, eigenstrain))
    outcomes = tuple((task, outcome if task.level is not None else perform(task)) for task, outcome in found.outcomes)
    assert judge(replace(found, outcomes=outcomes)).word == "disagrees"
