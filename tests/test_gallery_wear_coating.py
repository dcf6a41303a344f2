"""Bundled scene coating-worn-through, on coarser cells: load and path, friction by what is exposed, where steel is."""

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact.viz.figures import draw_all
from eigencontact.viz.surface import exposed_map, several_exposed

LOAD, THICKNESS = 12.307, 1e-6

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def data():
    changes = ["grid.cells=21", "steps.1.increments=12", "stress=[]", "output.pictures=false"]
    return ec.run(ec.load_scene("coating-worn-through", changes)).dataset


def test_load_and_path_give_the_volume_while_the_coating_holds(data):
    holds = data.max_worn_depth.values[1:] < THICKNESS
    path = 600.0 * (data.time.values[1:] - 1.0)
    assert 6 <= holds.sum() < holds.size - 2
    np.testing.assert_allclose(data.worn_volume.values[1:][holds], 0.2 * LOAD * 1e-18 * path[holds], rtol=1e-3)


def test_steel_is_where_the_coating_is_gone(data):
    """Sliding all over the contact wears on the way to a step, whose contact meets what is exposed then."""
    steel = data.exposed_material.values == 0
    np.testing.assert_array_equal(steel, data.worn_depth.values > THICKNESS)
    assert steel[-1].sum() > 9
    assert steel[-1].sum() < 0.5 * (data.pressure.values[-1] > 0).sum()


def test_the_tangential_load_is_that_of_each_material(data):
    area = float(np.prod(data.attrs["cell_size"]))
    coefficient = np.where(data.exposed_material.values == 0, 0.6, 0.2)
    carried = (coefficient * data.pressure.values).sum(axis=(1, 2)) * area
    np.testing.assert_allclose(data.tangential_load.values[1:], carried[1:], rtol=1e-6)
    assert data.tangential_load.values[-1] > 1.05 * 0.2 * LOAD


def test_the_end_is_that_of_finer_cells(data):
    """With 41 cells and 20, 30 and 60 increments 1712, 1714 and 1721 um^3, and 1.746, 1.747 and 1.753 um deep."""
    assert float(data.worn_volume[-1]) == close(1721e-18, rel=0.03)
    assert float(data.max_worn_depth[-1]) == close(1.753e-6, rel=0.03)


def test_what_is_exposed_is_drawn_by_name(data, monkeypatch, tmp_path):
    """Before the coating is gone there is nothing to tell apart."""
    monkeypatch.setattr("eigencontact.viz.figures.save", lambda *_: None)
    assert "exposed-materials.png" in draw_all(data, tmp_path)
    assert [several_exposed(data, step) for step in (0, -1)] == [False, True]
    figure = exposed_map(data)
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == ["substrate", "coating"]
    drawn = np.asarray(figure.axes[0].images[0].get_array())
    steel = data.exposed_material.values[-1] == 0
    assert (drawn == 0).sum() == steel.sum()
