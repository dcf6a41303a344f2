"""The slow part of the conformance kit: a shape whose potentials are not those of its region is found out."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact.plugin import InclusionShape, Place
from eigencontact_verification.conformance import ConformanceError, checks_for, parametrize_with_checks
from eigencontact_verification.conformance import finite_elements as kit
from eigencontact_verification.crosscheck.cell_errors import from_coarser, widened
from eigencontact_verification.crosscheck.inclusions import _CELL_RATIOS, SAFETY

BALL = ec.make("sphere", kind="inclusion-shape", center=(0.3e-6, 0.0, 2e-6), radius=1e-6)


@dataclass(frozen=True, kw_only=True)
class Wrong(InclusionShape):
    """A ball with the right region and potentials that are too large by a factor."""

    key: ClassVar[str] = "wrong-ball"
    references: ClassVar[tuple[str, ...]] = ("none: a planted fault",)

    center: Place
    factor: float = 1.0

    @property
    def ball(self):
        return ec.make("sphere", kind="inclusion-shape", center=self.center, radius=1.0)

    @property
    def bounds(self):
        return self.ball.bounds

    def contains(self, x, y, z):
        return self.ball.contains(x, y, z)

    def phi(self, orders, x, y, z):
        return self.factor * self.ball.phi(orders, x, y, z)

    def psi(self, orders, x, y, z):
        return self.factor * self.ball.psi(orders, x, y, z)


def names(component, **options):
    return [check.__name__ for check in checks_for(component, **options)]


def test_it_is_there_only_when_asked_for():
    assert "check_against_finite_elements" not in names(BALL)
    assert names(BALL, finite_elements=True) == [*names(BALL), "check_against_finite_elements"]
    bowl = ec.make("sphere", kind="geometry", radius=1.0)
    assert names(bowl, finite_elements=True) == names(bowl)


def test_it_carries_the_marks_of_the_suite():
    found = parametrize_with_checks([BALL], finite_elements=True, slow_marks=[pytest.mark.slow])
    marked = [case.values[1].__name__ for case in found.args[1] if case.marks]
    assert marked == ["check_against_finite_elements"]


def test_what_is_compared_stands_on_the_axis_and_off_the_surface():
    placed = kit._placed(Wrong(center=(0.3, -0.2, 1.0)))
    assert placed.center == close((0.0, 0.0, 1.5), abs=1e-12)
    assert kit._placed(Wrong(center=(0.0, 0.0, 3.0))).center == (0.0, 0.0, 3.0)


def test_a_missing_library_is_named(monkeypatch):
    monkeypatch.setattr(kit, "find_spec", lambda name: None if name == "pyamg" else object())
    with pytest.raises(ConformanceError, match=r"libraries of the finite elements \(got no pyamg\); pip install pyamg"):
        kit.check_against_finite_elements(BALL)


def test_cells_that_share_an_error_do_not_hide_it():
    """The nearest cutting alone would say that there is none."""
    truth = np.linspace(1.0, 2.0, 11)[:, None]
    fine, same, other = 1.01 * truth, 1.01 * truth, 1.02 * truth
    assert widened(SAFETY * from_coarser(fine, [same, other], _CELL_RATIOS)).min() >= 0.01
    assert len(_CELL_RATIOS) == 2


@pytest.mark.slow
def test_a_right_shape_passes():
    kit.check_against_finite_elements(Wrong(center=(0.3, 0.0, 2.0)))


@pytest.mark.slow
@pytest.mark.parametrize("factor", [1.1, 0.9])
def test_a_wrong_one_does_not(factor):
    expected = (
        r"check_against_finite_elements of inclusion-shape 'wrong-ball': u_x .* must be that of the finite elements"
    )
    with pytest.raises(ConformanceError, match=expected):
        kit.check_against_finite_elements(Wrong(center=(0.3, 0.0, 2.0), factor=factor))
