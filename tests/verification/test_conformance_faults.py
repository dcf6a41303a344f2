"""The conformance kit can fail: each planted fault is caught by the check that is meant for it."""

from dataclasses import dataclass, fields, replace
from typing import Any, ClassVar

import numpy as np
import pytest

import eigencontact as ec
from eigencontact.plugin import EigenstrainField, FrictionLaw, Geometry, InclusionShape, Length, Place, require
from eigencontact_plugins.shapes.cuboid import Cuboid
from eigencontact_verification.conformance import ConformanceError, checks_for, parametrize_with_checks
from planted import Faults, assert_noticed

DEEP = {"center": (0.1, 0.2, 3.0), "edges": (1.0, 2.0, 3.0)}
FLUSH = {"center": (0.1, 0.2, 1.5), "edges": (1.0, 2.0, 3.0)}
FAULTS = Faults()
plant = FAULTS.plant


def scaled(values, orders, chosen, factor):
    """Rows of `chosen` orders times a factor."""
    return values * np.array([factor if order in chosen else 1.0 for order in orders]).reshape(
        -1, *[1] * (values.ndim - 1)
    )


def seen_from(z):
    return np.where(z == 0, np.where(np.signbit(z), -1.0, 1.0), 0.0)


class Block(Cuboid):
    """The cuboid of an author who reads the side of the surface off the sign of zero."""

    takes_side = False

    def phi(self, orders, x, y, z):
        return super().phi(orders, x, y, z, seen_from(z))

    def psi(self, orders, x, y, z):
        return super().psi(orders, x, y, z, seen_from(z))


@plant("check_psi_derivatives", "check_psi_laplacian", "check_quadrature", **DEEP)
class PsiOrderScaled(Block):
    def psi(self, orders, x, y, z):
        return scaled(super().psi(orders, x, y, z), orders, {(2, 1, 0)}, 1.01)


@plant("check_psi_derivatives", "check_psi_laplacian", **DEEP)
class PsiFifthOrderSign(Block):
    def psi(self, orders, x, y, z):
        return scaled(super().psi(orders, x, y, z), orders, {(3, 1, 1)}, -1.0)


@plant("check_equilibrium", "check_psi_derivatives", "check_psi_laplacian", **DEEP)
class PsiFourthOrderScaled(Block):
    def psi(self, orders, x, y, z):
        return scaled(super().psi(orders, x, y, z), orders, {(2, 1, 1)}, 1.0 + 1e-6)


@plant("check_phi_laplacian", "check_psi_laplacian", "check_quadrature", "check_volume", "check_decay", **DEEP)
class PhiSign(Block):
    def phi(self, orders, x, y, z):
        return -super().phi(orders, x, y, z)


@plant("check_phi_laplacian", "check_volume", "check_quadrature", "check_far_field", **DEEP)
class EverythingScaled(Block):
    def phi(self, orders, x, y, z):
        return 1.001 * super().phi(orders, x, y, z)

    def psi(self, orders, x, y, z):
        return 1.001 * super().psi(orders, x, y, z)


@plant("check_continuity", **DEEP)
class HarmonicInside(Block):
    """Inside, Phi + x² - y² and Psi + (x⁴ - y⁴) / 6: every identity holds, only the boundary tells."""

    def more(self, gradient, curvature, orders, x, y, z):
        """Rows of a function of x less the same of y: `gradient` (1 or 3 derivatives) and `curvature` (one more)."""
        lowest = 1 if gradient == 2 else 3
        rows = {
            (lowest, 0, 0): gradient * x,
            (0, lowest, 0): -gradient * y,
            (lowest + 1, 0, 0): curvature + 0 * x,
            (0, lowest + 1, 0): -curvature + 0 * x,
        }
        return np.where(self.contains(x, y, z), np.array([rows.get(order, 0 * x) for order in orders]), 0.0)

    def phi(self, orders, x, y, z):
        return super().phi(orders, x, y, z) + self.more(2, 2, orders, x, y, z)

    def psi(self, orders, x, y, z):
        return super().psi(orders, x, y, z) + self.more(4, 4, orders, x, y, z)


@plant("check_decay", "check_quadrature", **DEEP)
class HarmonicEverywhere(Block):
    """Phi + xy / 1000: no identity notices, the distance does."""

    def phi(self, orders, x, y, z):
        extra = {(1, 0, 0): 1e-3 * y, (0, 1, 0): 1e-3 * x, (1, 1, 0): 1e-3 + 0 * x}
        return super().phi(orders, x, y, z) + np.array([extra.get(order, 0 * x) for order in orders])


@plant("check_face_means", **DEEP)
class InnerValueOnFaces(Block):
    def phi(self, orders, x, y, z):
        return super().phi(orders, *(c + (t - c) * (1 - 1e-12) for t, c in zip((x, y, z), self.center, strict=True)))


@plant("check_flush_face", "check_surface_traction", **FLUSH)
class BlindToTheSignOfZero(Block):
    def psi(self, orders, x, y, z):
        return super().psi(orders, x, y, np.where(z == 0, 0.0, z))


@plant("check_flush_face", "check_surface_traction", **FLUSH)
class DeafToTheSide(Cuboid):
    def phi(self, orders, x, y, z, side):  # noqa: ARG002
        return super().phi(orders, x, y, z)


@plant("check_parity", "check_phi_derivatives", **DEEP)
class WrongSignAcrossTheMiddle(Block):
    def phi(self, orders, x, y, z):
        values = super().phi(orders, x, y, z)
        return np.array([np.abs(v) if order == (1, 1, 1) else v for order, v in zip(orders, values, strict=True)])


@plant("check_quadrature", "check_bounds", **DEEP)
class ContainsShifted(Block):
    def contains(self, x, y, z):
        return super().contains(x - 0.02, y, z)


@plant("check_phi_laplacian", "check_quadrature", "check_volume", **DEEP)
class EdgesTakenForHalfEdges(Block):
    def contains(self, x, y, z):
        return replace(self, edges=tuple(edge / 2 for edge in self.edges)).contains(x, y, z)


@plant("check_bounds", **DEEP)
class BoundsTooTight(Block):
    @property
    def bounds(self):
        (x, y, z), high = super().bounds
        return (x, y, z + 0.1), high


@plant("check_bounds", **DEEP)
class BoundsReversed(Block):
    @property
    def bounds(self):
        return super().bounds[::-1]


@plant("check_in_body", center=(0.0, 0.0, 1.0), edges=(1.0, 1.0, 3.0))
class AboveTheSurface(Block):
    pass


@plant("check_potentials_pure", **DEEP)
class WritesToItsInput(Block):
    def phi(self, orders, x, y, z):
        values = super().phi(orders, x, y, z)
        x += 0.0 if np.ndim(x) == 0 else 1e-3
        return values


@plant("check_potentials_pure", **DEEP)
class KeepsState(Block):
    def psi(self, orders, x, y, z):
        calls = self.__dict__.setdefault("calls", [])
        calls.append(1)
        return super().psi(orders, x, y, z) * (1 + 1e-9 * len(calls))


@plant("check_contains_pure", **DEEP)
class ContainsWrites(Block):
    def contains(self, x, y, z):
        if isinstance(x, np.ndarray) and x.size:
            x *= 1.0
        return super().contains(x, y, z)


@plant("check_contains_arrays", **DEEP)
class ContainsCounts(Block):
    def contains(self, x, y, z):
        return 1 * super().contains(x, y, z)


@plant("check_contains_arrays", **DEEP)
class ContainsReduces(Block):
    def contains(self, x, y, z):
        held = super().contains(x, y, z)
        return np.full(held.shape, bool(np.any(held)))


@plant("check_potentials_finite", **DEEP)
class NanOnTheAxis(Block):
    def psi(self, orders, x, y, z):
        on_axis = (x == self.center[0]) & (y == self.center[1]) & (z > 5)
        return np.where(on_axis, np.nan, super().psi(orders, x, y, z))


@plant("check_potentials_finite", **DEEP)
class DividesByZero(Block):
    def phi(self, orders, x, y, z):
        offset = x - self.center[0]
        return super().phi(orders, x, y, z) + 0.0 * np.nan_to_num(1.0 / offset)


@plant("check_potential_arrays", **DEEP)
class ForgetsTheShape(Block):
    def phi(self, orders, x, y, z):
        return super().phi(orders, x, y, z).reshape(len(orders), -1)


@plant("check_potential_arrays", **DEEP)
class SortsTheOrders(Block):
    def psi(self, orders, x, y, z):
        return super().psi(sorted(orders), x, y, z)


@plant("check_chi", "check_equilibrium", **DEEP)
class ChiScaled(Block):
    def chi(self, orders, x, y, z):
        return scaled(super().chi(orders, x, y, z), orders, {(1, 1, 1), (2, 2, 0)}, 1.01)


@plant("check_chi", **DEEP)
class ChiOfTheRealSide(Block):
    def chi(self, orders, x, y, z):
        return super().chi(orders, x, y, z + 0.01)


@plant("check_psi_laplacian", **DEEP)
class WrongAboveTheSurface(Block):
    def psi(self, orders, x, y, z):
        return super().psi(orders, x, y, z) * np.where(z < 0, 1.001, 1.0)


@plant("check_far_field", **DEEP)
class FarFieldTooNear(Block):
    def far_field(self):
        return replace(super().far_field(), distance=3.0)


@plant("check_far_field", **DEEP)
class FarFieldTooHeavy(Block):
    def far_field(self):
        sources = super().far_field()
        return replace(sources, volumes=1.0001 * sources.volumes)


@plant("check_references", **DEEP)
class NoSources(Block):
    references: ClassVar[tuple[str, ...]] = ()


@plant("check_registered", **DEEP)
class OnlyASubclass(Block):
    key: ClassVar[str] = "only-a-subclass"


class Box(InclusionShape):
    """Box by an indicator alone."""

    key: ClassVar[str] = "box"
    references: ClassVar[tuple[str, ...]] = ("elementary",)

    @property
    def bounds(self):
        half = self.edge / 2
        return (-half, -half, self.depth - half), (half, half, self.depth + half)

    def contains(self, x, y, z):
        return np.maximum(np.maximum(np.abs(x), np.abs(y)), np.abs(z - self.depth)) <= self.edge / 2


@plant("check_frozen", depth=2.0, edge=1.0)
@dataclass(kw_only=True)
class Thawed(Box):
    depth: Length
    edge: Length


@plant("check_bad_numbers_refused", "check_bad_lengths_refused", depth=2.0, edges=1.0)
@dataclass(frozen=True, kw_only=True)
class TakesAnything(Box):
    depth: Length
    edges: Length

    @property
    def edge(self):
        return self.edges


@plant("check_bad_numbers_refused", depth=2.0, edge=1.0)
@dataclass(frozen=True, kw_only=True)
class RefusesWithoutAName(Box):
    depth: Length
    edge: Length

    def __post_init__(self):
        require(self.depth > 0 and self.edge > 0, self.key, "input", "?", "good")


@plant("check_fields_are_the_table", depth=2.0, edge=1.0, spread=(1.0, 2.0))
@dataclass(frozen=True, kw_only=True)
class FieldOfNoType(Box):
    depth: Length
    edge: Length
    spread: Any


@plant("check_files_are_marked", depth=2.0, edge=1.0, drawing=__file__)
@dataclass(frozen=True, kw_only=True)
class FileWithoutMark(Box):
    depth: Length
    edge: Length
    drawing: str | None


@plant("check_volume_fractions", depth=2.0, edge=1.0)
@dataclass(frozen=True, kw_only=True)
class FractionsFromTheBottom(Box):
    """In the order of the lattice, but for the layers: they are counted upwards."""

    depth: Length
    edge: Length

    def volume_fractions(self, low, edges, shape):
        overlaps = []
        for axis, count in zip((2, 1, 0), shape, strict=True):
            at = low[axis] + edges[axis] * np.arange(count + 1)
            inside = np.clip(at, self.bounds[0][axis], self.bounds[1][axis])
            overlaps.append(np.diff(inside) / edges[axis])
        return np.einsum("k,j,i->kji", overlaps[0][::-1], *overlaps[1:])


@plant("check_place", corner=(-0.5, -0.5, 1.5), edge=1.0)
@dataclass(frozen=True, kw_only=True)
class MovesHalfTheWay(Box):
    corner: Place
    edge: Length

    depth = 2.0

    @property
    def bounds(self):
        return self.corner, tuple(value + 1.0 for value in self.corner)


class Growth(EigenstrainField):
    """A correct field, to spoil."""

    key: ClassVar[str] = "growth"
    references: ClassVar[tuple[str, ...]] = ("elementary",)

    def eigenstrain(self, x, y, z, time):  # noqa: ARG002
        out = np.zeros((6, *np.broadcast_shapes(np.shape(x), np.shape(y), np.shape(z))))
        out[:3] = self.amplitude * np.exp(-z)
        return out


@plant("check_declarations", amplitude=1.0)
@dataclass(frozen=True, kw_only=True)
class ClaimsToBeUniform(Growth):
    uniform: ClassVar[bool] = True
    amplitude: float


@plant("check_declarations", amplitude=1.0)
@dataclass(frozen=True, kw_only=True)
class ChangesUnannounced(Growth):
    amplitude: float

    def eigenstrain(self, x, y, z, time):
        return time * super().eigenstrain(x, y, z, time)


@plant("check_declarations", amplitude=1.0)
@dataclass(frozen=True, kw_only=True)
class NeverZero(Growth):
    amplitude: float

    def eigenstrain(self, x, y, z, time):
        return 1.0 + super().eigenstrain(x, y, z, time)


@plant("check_eigenstrain_arrays", amplitude=1.0)
@dataclass(frozen=True, kw_only=True)
class NotMandel(Growth):
    amplitude: float

    def eigenstrain(self, x, y, z, time):
        return super().eigenstrain(x, y, z, time)[:3]


@plant("check_eigenstrain_pure", amplitude=1.0)
@dataclass(frozen=True, kw_only=True)
class HandsOutItsOwnArray(Growth):
    amplitude: float

    def eigenstrain(self, x, y, z, time):
        return self.__dict__.setdefault("kept", super().eigenstrain(x, y, z, time))


class Bowl(Geometry):
    """A correct geometry, to spoil."""

    key: ClassVar[str] = "bowl"
    references: ClassVar[tuple[str, ...]] = ("elementary",)

    def separation(self, x, y):
        return (x**2 + y**2) / (2 * self.bend)


@plant("check_separation_pure", bend=1.0)
@dataclass(frozen=True, kw_only=True)
class BowlThatWrites(Bowl):
    bend: float

    def separation(self, x, y):
        x *= 2.0
        return super().separation(x, y)


@plant("check_separation_arrays", bend=1.0)
@dataclass(frozen=True, kw_only=True)
class BowlWithAHole(Bowl):
    bend: float

    def separation(self, x, y):
        return np.where(x > 0, np.inf, super().separation(x, y))


@plant("check_shear_bound")
@dataclass(frozen=True, kw_only=True)
class OneNumber(FrictionLaw):
    key: ClassVar[str] = "one-number"

    def shear_bound(self, state):
        return state.pressure.max()


@plant("check_shear_bound")
@dataclass(frozen=True, kw_only=True)
class UnboundedAtRest(FrictionLaw):
    key: ClassVar[str] = "unbounded"

    def shear_bound(self, state):
        return np.where(state.slip_distance > 0, state.pressure, np.inf)


@plant("check_shear_bound")
@dataclass(frozen=True, kw_only=True)
class Pulling(FrictionLaw):
    key: ClassVar[str] = "pulling"

    def shear_bound(self, state):
        return 0.1 * (state.pressure - 1e5)


@plant("check_shear_bound_pure")
@dataclass(frozen=True, kw_only=True)
class Remembering(FrictionLaw):
    key: ClassVar[str] = "remembering"

    def shear_bound(self, state):
        held = self.__dict__.get("highest", 0.0)
        object.__setattr__(self, "highest", max(held, state.pressure.max()))
        return np.full(state.pressure.shape, self.highest)


@plant("check_shear_bound_pure")
@dataclass(frozen=True, kw_only=True)
class BoundThatWrites(FrictionLaw):
    key: ClassVar[str] = "writing"

    def shear_bound(self, state):
        state.pressure[...] *= 0.5
        return state.pressure


@pytest.mark.parametrize("name", FAULTS)
def test_the_check_that_is_meant_for_it_notices(name):
    component, noticed = FAULTS[name]
    checks = {check.__name__: check for check in checks_for(component)}
    for expected in noticed:
        assert_noticed(component, checks[expected])


def test_every_check_is_seen_to_fail():
    """No check without a fault that it catches: a check that cannot fail proves nothing."""
    assert FAULTS.noticed == {check.__name__ for component, _ in FAULTS.values() for check in checks_for(component)}


def test_a_message_names_order_point_values_and_advice():
    (component, _) = FAULTS["PsiOrderScaled"]
    (check,) = (check for check in checks_for(component) if check.__name__ == "check_psi_derivatives")
    with pytest.raises(
        ConformanceError, match=r"Psi,x+y+z* at \(.*\) must be the derivative of .*got .*relative error"
    ):
        check(component)


def test_checks_follow_what_a_shape_offers():
    names = {check.__name__ for check in checks_for(FAULTS["TakesAnything"][0])}
    assert "check_bounds" in names
    assert not names & {"check_phi_laplacian", "check_chi", "check_far_field"}
    assert {"check_phi_laplacian", "check_chi", "check_far_field"} <= {
        check.__name__ for check in checks_for(Cuboid(**DEEP))
    }


def test_waivers_are_strict_and_reasoned():
    cube = Cuboid(**DEEP)
    (names, cases) = parametrize_with_checks([cube], waive={"check_chi": "no closed form"}).args
    assert names == ("component", "check")
    marks = {case.id: case.marks for case in cases}
    (mark,) = marks.pop("cuboid0-check_chi")
    assert (mark.name, mark.kwargs) == ("xfail", {"reason": "no closed form", "strict": True})
    assert not any(marks.values())
    with pytest.raises(ValueError, match=r"got 'check_ch'\); did you mean 'check_chi'\?"):
        parametrize_with_checks([cube], waive={"check_ch": "?"})
    with pytest.raises(ValueError, match=r"waive\['check_chi'\] must be the reason"):
        parametrize_with_checks([cube], waive={"check_chi": " "})


def test_a_component_is_given_back_as_it_was():
    """Checks neither change the component nor need it hashable."""
    ball = ec.make("sphere", kind="inclusion-shape", center=(0.0, 0.0, 2.0), radius=1.0)
    before = [getattr(ball, item.name) for item in fields(ball)]
    for check in checks_for(ball)[:12]:
        check(ball)
    assert before == [getattr(ball, item.name) for item in fields(ball)]
