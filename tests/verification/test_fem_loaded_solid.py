"""Loaded bodies in three dimensions against closed forms and quadratures that share nothing with finite elements."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from eigencontact_verification.fem.loaded_body import Cells, LoadedBody, Tractions
from eigencontact_verification.fem.loaded_solid import RATIO, LoadedSolution, solve_loaded
from eigencontact_verification.fem.model import Layer, Region
from eigencontact_verification.fem.uncertainty import Estimate, estimate
from eigencontact_verification.oracles.boussinesq import rectangle
from eigencontact_verification.oracles.coated_stress import sliding_stress

FloatArray = NDArray[np.float64]

NU, YOUNG = 0.3, 2.6  # shear modulus 1
SHIFT = np.array([0.3, -0.2, 0.0])
SURFACE = np.array([(x, 0.0, 0.0) for x in (0.0, 0.35, 0.75, 1.5)])
BELOW = np.array(
    [(0.05, 0.05, z) for z in (0.2, 0.4, 0.6, 0.8, 1.0, 1.5, 2.0)] + [(0.5, 0.25, 0.3), (0.85, 0.05, 0.25)]
)


def hertz_patch(component: int, cells: int = 20) -> tuple[LoadedBody, FloatArray]:
    """Body under Hertz's profile of the radius 1 as one component of the traction on cells, off the origin."""
    edges = np.linspace(-1.0, 1.0, cells + 1)
    x, y = np.meshgrid(*2 * [(edges[1:] + edges[:-1]) / 2])
    values = np.zeros((3, cells, cells))
    values[component] = np.sqrt(np.maximum(1 - x**2 - y**2, 0.0))
    tractions = Tractions(x=edges + SHIFT[0], y=edges + SHIFT[1], values=values)
    return LoadedBody(young_modulus=YOUNG, poisson_ratio=NU, tractions=tractions), values[component]


def exact(load: str, values: FloatArray, points: FloatArray) -> FloatArray:
    """Displacement and stress (n, 9) of cells of a patch by quadrature of point forces."""
    count = len(values)
    half = 1.0 / count
    centre = -1 + half * (2 * np.arange(count) + 1)
    out = np.zeros((len(points), 9))
    for j, i in np.argwhere(values):
        for n, (x, y, z) in enumerate(points):
            out[n] += values[j, i] * rectangle(load, (x - centre[i], y - centre[j], z), (half, half), NU)
    return out


def six(stress: FloatArray) -> FloatArray:
    """Components xx, yy, zz, yz, xz, xy of (n, 3, 3)."""
    return np.stack([stress[:, a, b] for a, b in ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))], axis=1)


def audited(body: LoadedBody, surface: FloatArray, below: FloatArray, **options: Any) -> tuple[Estimate, Estimate]:
    """Displacement of the surface and stress below with their uncertainty, as an audit finds them."""
    found: dict[tuple[int, str], LoadedSolution] = {
        key: solve_loaded(body, level=key[0], outer=key[1], watched=np.concatenate([surface, below]), **options)
        for key in ((0, "fixed"), (1, "fixed"), (2, "fixed"), (1, "free"))
    }
    keys = [(level, "fixed") for level in (0, 1, 2)]

    def one(values: dict[tuple[int, str], FloatArray]) -> Estimate:
        return estimate(
            *(values[key] for key in keys), ratio=RATIO, formal_order=2.0, other_outer=values[1, "free"], other_level=1
        )

    displacement = one({key: solution.displacement(surface) for key, solution in found.items()})
    return displacement, one({key: six(solution.stress(below)) for key, solution in found.items()})


def contains(found: Estimate, truth: FloatArray, limit: float) -> None:
    """The truth lies within the uncertainty, which is small."""
    size = np.abs(truth).max()
    assert np.all(np.abs(found.value - truth) <= found.uncertainty)
    assert found.uncertainty.max() < limit * size
    assert found.parts["truncation"].max() < 0.002 * size


@pytest.mark.slow
@pytest.mark.parametrize(("load", "component"), [("p", 2), ("q_x", 0), ("q_y", 1)])
def test_uncertainty_contains_what_cells_of_a_hertz_patch_do(load: str, component: int) -> None:
    body, values = hertz_patch(component)
    displacement, stress = audited(body, SURFACE + SHIFT, BELOW + SHIFT, budget=155_000)
    contains(displacement, exact(load, values, SURFACE)[:, :3], 0.01)
    contains(stress, exact(load, values, BELOW)[:, 3:], 0.02)


@pytest.mark.slow
def test_without_planes_of_symmetry_the_answer_is_the_same() -> None:
    body, _ = hertz_patch(2)
    points = np.concatenate([SURFACE, BELOW]) + SHIFT
    quarter, whole = (
        solve_loaded(body, level=0, outer="fixed", watched=points, budget=budget, symmetric=symmetric)
        for budget, symmetric in ((155_000, True), (1_200_000, False))
    )
    assert quarter.solution.model.symmetry == ("even", "even")
    assert whole.solution.model.symmetry == ("none", "none")
    for one, other, limit in (
        (quarter.displacement(points), whole.displacement(points), 0.005),
        (quarter.stress(points)[4:], whole.stress(points)[4:], 0.02),
    ):
        assert np.abs(one - other).max() < limit * np.abs(one).max()


def test_an_odd_pair_of_loads_is_found_and_mirrored() -> None:
    values = np.zeros((3, 4, 8))
    values[2, :, :4], values[2, :, 4:] = 1.0, -1.0
    edges = (np.linspace(-2.0, 2.0, 9) + 5.0, np.linspace(-1.0, 1.0, 5))
    body = LoadedBody(young_modulus=1.0, poisson_ratio=0.3, tractions=Tractions(x=edges[0], y=edges[1], values=values))
    at = np.array([(6.0, 0.3, 0.0), (4.0, 0.3, 0.0), (6.0, 0.3, 0.5), (4.0, 0.3, 0.5)])
    found = solve_loaded(body, level=0, outer="free", watched=at, budget=25_000)
    assert found.solution.model.symmetry == ("odd", "even")
    np.testing.assert_allclose(found.origin, (5.0, 0.0, 0.0), atol=1e-12)
    u, stress = found.displacement(at), found.stress(at)
    np.testing.assert_allclose(u[0, 2], -u[1, 2])
    np.testing.assert_allclose(stress[2, 2, 2], -stress[3, 2, 2])
    assert u[1, 2] > 0.5 > 0 > stress[3, 2, 2]


def block(values: FloatArray, edges: tuple[FloatArray, ...], kept: FloatArray | None = None) -> Cells:
    """Cells of one eigenstrain."""
    shape = tuple(e.size - 1 for e in reversed(edges))
    return Cells(
        x=edges[0], y=edges[1], z=edges[2], eigenstrain=np.broadcast_to(values[..., None, None, None], (3, 3, *shape)),
        stiffness_factor=kept,
    )  # fmt: skip


BOUNDS = ((-1.0, -1.0, 0.5), (1.0, 1.0, 1.5))
STRAIN = np.diag([1e-3, 1e-3, -2e-3])


def inside_box(x: FloatArray, y: FloatArray, z: FloatArray) -> NDArray[np.bool_]:
    """Whether points lie in the box."""
    at = np.stack([x, y, z], axis=-1)
    return np.asarray(((at >= BOUNDS[0]) & (at <= BOUNDS[1])).all(axis=-1))


CENTRES = np.array([(0.05, 0.05, z) for z in (0.55, 0.75, 1.05, 1.45)] + [(0.55, 0.25, 0.75), (0.55, 0.25, 0.25)])


@pytest.mark.slow
@pytest.mark.parametrize("counts", [(1, 1, 1), (20, 20, 10)])
def test_cells_of_one_eigenstrain_are_a_region(counts: tuple[int, int, int]) -> None:
    edges = tuple(np.linspace(low, high, count + 1) for low, high, count in zip(*BOUNDS, counts, strict=True))
    one_cell = counts == (1, 1, 1)
    # the lines of the mesh follow the faces of many cells: otherwise the strain jumps within an element
    mesh: dict[str, Any] = {"level": 0} if one_cell else {"level": 1, "ratio": 2.0}
    empty = LoadedBody(young_modulus=YOUNG, poisson_ratio=NU)
    cells = replace(empty, cells=(block(STRAIN, edges),))
    region = replace(empty, regions=(Region(contains=inside_box, bounds=BOUNDS, eigenstrain=STRAIN),))
    one, other = (
        solve_loaded(body, outer="fixed", watched=CENTRES, budget=1_200_000, **mesh) for body in (cells, region)
    )
    limit = 1e-6 if one_cell else 0.002
    for a, b in (
        (one.displacement(SURFACE), other.displacement(SURFACE)),
        (one.stress(CENTRES), other.stress(CENTRES)),
    ):
        assert np.abs(a - b).max() < limit * np.abs(b).max()


@pytest.mark.slow
def test_damage_of_many_cells_is_a_region_of_lower_modulus() -> None:
    edges = tuple(np.linspace(low, high, 11) for low, high in zip(*BOUNDS, strict=True))
    body = hertz_patch(2)[0]
    loads = body.tractions
    assert loads is not None
    body = replace(body, tractions=replace(loads, x=loads.x - SHIFT[0], y=loads.y - SHIFT[1]))
    kept = np.full((10, 10, 10), 0.5)
    damaged = replace(body, cells=(block(STRAIN, edges, kept),))
    region = Region(contains=inside_box, bounds=BOUNDS, eigenstrain=STRAIN, young_modulus=0.5 * YOUNG, poisson_ratio=NU)
    softer = replace(body, regions=(region,))
    one, other, sound = (
        solve_loaded(b, level=1, outer="fixed", watched=CENTRES, budget=600_000) for b in (damaged, softer, body)
    )
    difference = np.abs(one.displacement(SURFACE) - other.displacement(SURFACE)).max()
    assert difference < 0.03 * np.abs(other.displacement(SURFACE) - sound.displacement(SURFACE)).max()
    # away from the faces: there the mesh, which does not follow many cells, smears the modulus over sub-cells
    middle = np.array([(0.05, 0.05, 0.95), (0.05, 0.05, 1.05), (0.35, 0.25, 0.95), (0.55, 0.25, 0.25)])
    assert np.abs(one.stress(middle) - other.stress(middle)).max() < 0.03 * np.abs(other.stress(middle)).max()


@dataclass(frozen=True)
class HertzOnLayers:
    """What the oracle of layered stress asks of a contact, of Hertz's pressure with the radius 1."""

    layers: tuple[tuple[float, float, float], ...]
    substrate: tuple[float, float]
    radius: float = 1.0

    def hankel(self, k: FloatArray) -> FloatArray:
        """Hankel transform of the pressure, ``∫ p r J_0(kr) dr``."""
        return np.asarray((np.sin(k) - k * np.cos(k)) / k**3)


@pytest.mark.slow
def test_stress_under_a_coating_is_the_oracles() -> None:
    body, values = hertz_patch(2, 40)
    scale = 2 * np.pi / 3 / (values.sum() * 0.05**2)  # the load of the profile that the cells stand for
    loads = body.tractions
    assert loads is not None
    coated = replace(
        body,
        layers=(Layer(thickness=0.5, young_modulus=3 * YOUNG, poisson_ratio=0.25),),
        tractions=replace(loads, values=scale * loads.values),
    )
    found = solve_loaded(coated, level=2, outer="fixed", watched=BELOW + SHIFT, budget=300_000)
    oracle = HertzOnLayers(layers=((0.5, 3 * YOUNG, 0.25),), substrate=(YOUNG, NU))
    at = np.array([(x, 0.0, z) for x in (0.05, 0.5) for z in (0.2, 0.4, 0.6, 1.0, 2.0)])
    exact = np.array([sliding_stress(oracle, x, y, z) for x, y, z in at])  # type: ignore[arg-type]
    assert np.abs(six(found.stress(at + SHIFT)) - exact).max() < 0.01 * np.abs(exact).max()
