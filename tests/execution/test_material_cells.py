"""Cells of inhomogeneities: whose law fills them, how far, beside what, and which laws take whole cells only."""

from dataclasses import replace
from typing import ClassVar

import numpy as np
import pytest

from close import close
from eigencontact.core.grid import Grid
from eigencontact.errors import SceneError
from eigencontact.execution.interiors.material_cells import MaterialCells
from eigencontact.model.boxes import CellBox
from eigencontact.model.sources import Inhomogeneity, Lattice
from eigencontact_plugins.eigenstrain_fields.uniform import Uniform
from eigencontact_plugins.laws.isotropic import Isotropic
from eigencontact_plugins.laws.map import ElasticityMap
from eigencontact_plugins.laws.rigid import Rigid
from eigencontact_plugins.laws.void import Void
from eigencontact_plugins.shapes.cuboid import Cuboid
from eigencontact_plugins.shapes.sphere import SphericalInclusion
from toy_laws import Stiffening, Yielding

GRID = Grid(nx=8, ny=8, dx=1.0, dy=1.0)
WHOLE = Lattice(first=(0, 0, 0), shape=(6, 8, 8), edges=(1.0, 1.0, 1.0))
SOFT, HARD = Isotropic(young_modulus=1e9, poisson_ratio=0.3), Isotropic(young_modulus=3e9, poisson_ratio=0.3)
STEEL = Yielding(young_modulus=2e11, poisson_ratio=0.3, yield_stress=2e8, hardening_modulus=1e10)
RUBBER = Stiffening(shear_modulus=1e9, growth=1e5)


def block(law, low, high, name="block", strain=0.0):
    """Cuboid from one corner to another; cells are cubes of edge 1 about the origin, from the surface down."""
    low, high = np.array(low, dtype=float), np.array(high, dtype=float)
    shape = Cuboid(center=tuple(0.5 * (low + high)), edges=tuple(high - low))
    return Inhomogeneity(
        name=name, where="inclusions.0", key="cuboid", body=1, shape=shape, law=law, lattice=WHOLE,
        field=Uniform(value=strain),
    )  # fmt: skip


def cells_of(*sources):
    return MaterialCells(CellBox(tuple(sources), WHOLE), sources, GRID)


def test_whole_cells_know_their_law_and_others_the_matrix():
    content = cells_of(block(SOFT, (-2, -2, 1), (2, 2, 3)))
    expected = np.zeros((6, 8, 8), dtype=int)
    expected[1:3, 2:6, 2:6] = 1
    np.testing.assert_array_equal(content.index, expected)
    np.testing.assert_array_equal(content.fraction, 1.0)
    np.testing.assert_array_equal(content.beside, 0)
    assert content.laws == [SOFT]
    assert content.nonlinear == []


def test_cut_cells_know_their_share_and_the_way_out():
    content = cells_of(block(SOFT, (-2, -2, 1), (2, 2, 2.7)))
    np.testing.assert_allclose(content.fraction[2, 2:6, 2:6], 0.7, rtol=1e-12)
    np.testing.assert_array_equal(content.index[2, 2:6, 2:6], 1)
    x, y, z = content.normal[:, 2, 3, 3]
    assert (x, y) == (0.0, 0.0)
    assert z > 0.0  # towards the matrix, below


def test_two_laws_share_a_cell_and_the_later_one_wins_where_both_would_fill_it():
    content = cells_of(block(SOFT, (-2, -2, 1), (2, 2, 2.3)), block(HARD, (-2, -2, 2.3), (2, 2, 3)))
    np.testing.assert_array_equal(content.index[2, 2:6, 2:6], 2)
    np.testing.assert_array_equal(content.beside[2, 2:6, 2:6], 1)
    np.testing.assert_allclose(content.fraction[2, 2:6, 2:6], 0.7, rtol=1e-12)
    over = cells_of(block(SOFT, (-2, -2, 1), (2, 2, 3)), block(HARD, (0, -2, 1), (2, 2, 3)))
    np.testing.assert_array_equal(over.index[1, 3, 2:6], [1, 1, 2, 2])
    np.testing.assert_array_equal(over.beside, 0)


def test_one_law_in_two_regions_is_one():
    twice = Isotropic(young_modulus=1e9, poisson_ratio=0.3)
    content = cells_of(block(SOFT, (-2, -2, 1), (0, 2, 3)), block(twice, (0, -2, 1), (2, 2, 3)))
    assert content.laws == [SOFT]
    assert set(np.unique(content.index)) == {0, 1}


def test_prestrain_is_the_share_of_each_region_times_its_own():
    one, two = block(SOFT, (-2, -2, 1), (2, 2, 2.3), strain=1e-3), block(HARD, (-2, -2, 2.3), (2, 2, 3), strain=2e-3)
    own = cells_of(one, two).prestrain(1.0)
    assert own.shape == (6, 6, 8, 8)
    assert own[0, 1, 3, 3] == close(1e-3)
    assert own[2, 2, 3, 3] == close(0.3 * 1e-3 + 0.7 * 2e-3)
    assert not own[3:].any()
    assert not own[:, 3:].any()


def test_a_law_that_is_not_linear_fills_whole_cells_from_a_half_on():
    content = cells_of(block(STEEL, (-2, -2, 1), (2, 2, 2.6)), block(SOFT, (-2, -2, 3.2), (2, 2, 5)))
    ((law, filled),) = content.nonlinear
    assert law is STEEL
    expected = np.zeros((6, 8, 8), dtype=bool)
    expected[1:3, 2:6, 2:6] = True
    np.testing.assert_array_equal(filled, expected)
    linear = content.linear
    assert linear.laws == [SOFT]
    np.testing.assert_array_equal(linear.index[:3], 0)
    np.testing.assert_array_equal(linear.fraction[:3], 1.0)
    np.testing.assert_allclose(linear.fraction[3, 2:6, 2:6], 0.8, rtol=1e-12)
    np.testing.assert_array_equal(linear.index[3:5, 2:6, 2:6], 1)


def test_beside_a_law_that_is_not_linear_a_rigid_material_has_the_matrix():
    """A cell of 60 % rigid and 40 % steel that yields: rigid cut against the matrix, and no cell of the steel."""
    content = cells_of(block(STEEL, (-2, -2, 1), (2, 2, 3.4)), block(Rigid(), (-2, -2, 3.4), (2, 2, 5)))
    np.testing.assert_array_equal(content.linear.index[3, 2:6, 2:6], 1)
    np.testing.assert_array_equal(content.linear.beside, 0)
    assert not content.nonlinear[0][1][3].any()
    assert not content.cut.any()


def test_two_materials_share_a_cell_beside_a_law_that_is_not_linear():
    """Void in 60 % of a layer of cells above, steel in 40 % of them: neither fills them."""
    content = cells_of(block(STEEL, (-2, -2, 1), (2, 2, 3.4)), block(Void(), (-2, -2, 3.4), (2, 2, 5)))
    expected = np.zeros((6, 8, 8), dtype=bool)
    expected[3, 2:6, 2:6] = True
    np.testing.assert_array_equal(content.cut, expected)
    ((first, second, cells),) = content.cuts()
    assert (first, second) == (Void(), STEEL)
    np.testing.assert_array_equal(cells, np.flatnonzero(expected))
    np.testing.assert_allclose(content.fraction[content.cut], 0.6, rtol=1e-12)
    middle = content.across(cells)[:, cells == np.ravel_multi_index((3, 3, 3), expected.shape)]
    np.testing.assert_allclose(middle[:, 0], [0.0, 0.0, 1.0], atol=1e-15)
    assert not content.linear.index[content.cut].any()
    assert not content.nonlinear[0][1][content.cut].any()


def test_the_matrix_is_beside_a_law_only_if_it_has_one():
    steel = block(STEEL, (-2, -2, 1), (2, 2, 2.6))
    assert not cells_of(steel).cut.any()
    content = MaterialCells(CellBox((steel,), WHOLE), [steel], GRID, SOFT)
    ((first, second, cells),) = content.cuts()
    assert (first, second, cells.size) == (STEEL, SOFT, 16)


@pytest.mark.parametrize(("share", "cut"), [(0.04, False), (0.06, True), (0.94, True), (0.96, False)])
def test_slivers_are_merged(share, cut):
    content = cells_of(block(STEEL, (-2, -2, 1), (2, 2, 2 + share)), block(SOFT, (-2, -2, 2 + share), (2, 2, 4)))
    np.testing.assert_array_equal(content.cut[2, 2:6, 2:6], cut)


def test_a_law_of_a_neighbourhood_has_whole_cells():
    class Wide(Yielding):
        averaged: ClassVar = {"hardening": 2.0}

    wide = Wide(young_modulus=2e11, poisson_ratio=0.3, yield_stress=2e8, hardening_modulus=1e10)
    content = cells_of(block(wide, (-2, -2, 1), (2, 2, 2.6)), block(SOFT, (-2, -2, 2.6), (2, 2, 4)))
    assert not content.cut.any()
    assert content.nonlinear[0][1][2, 3, 3]


def test_normals_of_a_ball_are_its_radii():
    """Within 5 degrees in every cell that is cut, 2 in the mean; cells are flat: 1 x 1 x .7."""
    lattice = Lattice(first=(0, 0, 0), shape=(14, 8, 8), edges=(0.7, 1.0, 1.0))
    around, ball = (
        replace(block(law, (-4, -4, 0), (4, 4, 9.8)), shape=shape, lattice=lattice)
        for law, shape in (
            (STEEL, Cuboid(center=(0, 0, 4.9), edges=(8, 8, 9.8))),
            (SOFT, SphericalInclusion(center=(0.2, 0.1, 4.5), radius=3.3)),
        )
    )
    content = MaterialCells(CellBox((around, ball), lattice), [around, ball], GRID)
    for _, _, cells in content.cuts():
        k, j, i = np.unravel_index(cells, lattice.shape)
        away = np.stack([i - 3.5 - 0.2, j - 3.5 - 0.1, 0.7 * (k + 0.5) - 4.5])
        away /= np.linalg.norm(away, axis=0)
        angles = np.degrees(np.arccos(np.minimum(np.abs(np.sum(away * content.across(cells), axis=0)), 1.0)))
        assert cells.size > 30
        assert angles.max() < 5.0
        assert angles.mean() < 2.0


def test_the_difference_of_prestrains_is_that_of_the_materials():
    one, two = block(STEEL, (-2, -2, 1), (2, 2, 2.3), strain=1e-3), block(HARD, (-2, -2, 2.3), (2, 2, 3), strain=3e-3)
    content = cells_of(one, two)
    ((first, _, cells),) = content.cuts()
    assert first == HARD
    np.testing.assert_allclose(content.difference(cells, 1.0)[:3], 2e-3, rtol=1e-12)


@pytest.mark.parametrize("law", [STEEL, RUBBER], ids=["steel", "rubber"])
def test_a_law_that_fills_no_cell_is_refused_by_name(law):
    words = rf"inclusions.0.cells must be fine enough for 'film' to fill half of a cell: '{law.key}' has no part of one"
    with pytest.raises(SceneError, match=words):
        cells_of(block(law, (-2, -2, 1.2), (2, 2, 1.6), name="film"))
    cells_of(block(SOFT, (-2, -2, 1.2), (2, 2, 1.6), name="film"))


def test_what_later_regions_cover_is_not_missed():
    content = cells_of(block(STEEL, (-1, -1, 1), (1, 1, 2)), block(SOFT, (-2, -2, 0.5), (2, 2, 3)))
    assert content.nonlinear == []


def test_a_map_of_linear_constants_is_linear(tmp_path):
    axis = np.array([0.0, 1.0])
    ones = np.ones((2, 2, 2))
    np.savez(tmp_path / "map.npz", x=axis, y=axis, z=axis, young_modulus=1e9 * ones, poisson_ratio=0.3 * ones)
    assert ElasticityMap(file=str(tmp_path / "map.npz")).linear
    assert Void().linear
    assert not STEEL.linear
