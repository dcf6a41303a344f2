"""By which meshes elements are asked in an audit."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from eigencontact_verification.audit.engines import (
    CAUSES,
    effects,
    known_tractions,
    less,
    ratio_for,
    single_effect,
    smoothed,
    solved_bodies,
)
from eigencontact_verification.fem.loaded_body import Cells, LoadedBody, Tractions
from eigencontact_verification.fem.loaded_parity import parities
from eigencontact_verification.fem.loaded_symmetry import centred
from eigencontact_verification.fem.model import Region

STRAIN = 1e-3 * np.array([[1.0, 0.4, 0.3], [0.4, -0.5, 0.2], [0.3, 0.2, 0.7]])


def inside(x: Any, y: Any, z: Any) -> Any:
    """Whether points lie in a box about x = 0.2."""
    return (np.abs(x - 0.2) <= 1.0) & (np.abs(y) <= 1.0) & (np.abs(z - 1.0) <= 0.5)


def box(strain: Any) -> LoadedBody:
    """A half-space with an eigenstrain in that box."""
    region = Region(contains=inside, bounds=((-0.8, -1.0, 0.5), (1.2, 1.0, 1.5)), eigenstrain=strain)
    return LoadedBody(young_modulus=2.6, poisson_ratio=0.3, regions=(region,))


def test_only_small_cells_ask_for_the_ratio_two() -> None:
    def cells(count: int) -> LoadedBody:
        edges = np.linspace(0.0, 1.0, count + 1)
        strain = np.ones((3, 3, count, count, count))
        return LoadedBody(
            young_modulus=1.0, poisson_ratio=0.3, cells=(Cells(x=edges, y=edges, z=edges, eigenstrain=strain),)
        )

    assert ratio_for("solid", [box(STRAIN), cells(3)]) == 1.5
    assert ratio_for("solid", [box(STRAIN), cells(8)]) == 2.0
    assert ratio_for("revolution", [box(STRAIN)]) == 2.0


def rough(seed: int = 3) -> LoadedBody:
    """A homogeneous half-space under random tractions on 14 x 10 cells."""
    values = np.random.default_rng(seed).random((3, 10, 14))
    tractions = Tractions(x=np.linspace(1.0, 2.4, 15), y=np.linspace(-0.5, 0.5, 11), values=values)
    return LoadedBody(young_modulus=1.0, poisson_ratio=0.3, tractions=tractions)


def test_smoothed_tractions_and_what_is_left_are_the_whole() -> None:
    whole = rough().tractions
    assert whole is not None
    carried = smoothed(whole)
    left = less(whole, carried)
    np.testing.assert_allclose(carried.force, whole.force, rtol=1e-12)
    np.testing.assert_allclose(left.force, 0.0, atol=1e-12)
    both = carried.values + left.values
    reach = [(line.size - inner.size) // 2 for line, inner in ((carried.x, whole.x), (carried.y, whole.y))]
    assert reach == [3, 2]
    np.testing.assert_allclose(both[:, 2:-2, 3:-3], whole.values, rtol=1e-12)
    np.testing.assert_allclose(carried.x[3:-3], whole.x, rtol=1e-12)
    assert np.abs(np.diff(carried.values, axis=2)).max() < 0.25 * np.abs(np.diff(whole.values, axis=2)).max()


def test_elements_and_closed_form_share_the_tractions_of_a_homogeneous_body() -> None:
    """What the parts add up to, and what is known, is what acts."""
    body = rough()
    parts = solved_bodies(body)
    assert {sign for sign, _ in parts} == {1.0}
    assert {centred(part).symmetry for _, part in parts} == {(a, b) for a in ("even", "odd") for b in ("even", "odd")}
    known = known_tractions(body)
    assert known is not None
    assert body.tractions is not None
    total = known.values + sum(part.tractions.values for _, part in parts if part.tractions is not None)
    np.testing.assert_allclose(
        total, less(body.tractions, smoothed(body.tractions)).values + smoothed(body.tractions).values, atol=1e-12
    )


@pytest.mark.parametrize("coupling", sorted(CAUSES))
def test_every_kind_of_traction_acts_once(coupling: str) -> None:
    found = effects(CAUSES[coupling])
    assert sorted("".join(kinds for kinds, _ in found)) == ["x", "y", "z"]
    body = rough()
    assert body.tractions is not None
    forces = [single_effect(body, kinds).tractions for kinds, _ in found]
    np.testing.assert_allclose(sum(one.force for one in forces if one), body.tractions.force, rtol=1e-12)
    for kinds, moved in found:
        assert all(set(kinds) <= set(CAUSES[coupling]["xyz".index(name[-1])]) for name in moved)


def test_eigenstrain_without_planes_of_symmetry_is_a_sum_of_even_and_odd_ones() -> None:
    parts = parities(box(STRAIN))
    assert sorted(centred(part).symmetry for part in parts) == sorted(
        [("even", "even"), ("odd", "odd"), ("odd", "even"), ("even", "odd")]
    )
    np.testing.assert_allclose(sum(part.regions[0].eigenstrain for part in parts), STRAIN, atol=1e-18)
    edges, rng = np.linspace(-0.4, 0.8, 7), np.random.default_rng(1)
    strain = rng.random((3, 3, 6, 6, 6))
    cells = Cells(x=edges, y=edges, z=edges + 1.0, eigenstrain=strain + np.swapaxes(strain, 0, 1))
    body = LoadedBody(young_modulus=1.0, poisson_ratio=0.3, cells=(cells,))
    parts = parities(body)
    assert len(parts) == 4
    np.testing.assert_allclose(sum(part.cells[0].eigenstrain for part in parts), cells.eigenstrain, rtol=1e-12)
    for part in parts:
        np.testing.assert_allclose(part.cells[0].x, edges, rtol=1e-12)
        assert "none" not in centred(part).symmetry


def test_other_moduli_are_solved_as_they_are() -> None:
    """No plane reflects what is stiffer onto what is not: parts of its load are not loads of the same body."""
    region = Region(contains=inside, bounds=((-0.8, -1.0, 0.5), (1.2, 1.0, 1.5)), eigenstrain=STRAIN, young_modulus=5.2)
    body = LoadedBody(young_modulus=2.6, poisson_ratio=0.3, regions=(region,))
    assert parities(body) == (body,)
