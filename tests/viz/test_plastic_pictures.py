"""Pictures of what yields, from made-up results: a ball of plastic strain that reaches the surface."""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import pyvista as pv
from matplotlib.colors import to_hex
from matplotlib.contour import ContourSet

from close import close
from eigencontact.model.model import build_model
from eigencontact.model.outlines import outlines
from eigencontact.model.regions import region_lattice
from eigencontact.results.records import HistoryRecord
from eigencontact.scene.installed import installed_plugins
from eigencontact.scene.schema import Scene
from eigencontact.viz.figures import draw_all
from eigencontact.viz.plastic import (
    load_depth,
    loaded_step,
    plastic_history,
    plastic_section,
    plastic_surfaces,
    surface_of,
    unloads,
)
from eigencontact.viz.profile import mean_profile
from eigencontact.viz.remembered import SHARE, plastic_strains
from eigencontact.viz.rolling import coverage_map, impacts, strikes, struck
from eigencontact.viz.section import stress_section
from eigencontact.viz.vtk import write_vtk
from results import synthetic

EDGE, RADIUS, TOP = 0.5e-6, 3.4e-6, 0.02
LOADS = (0.3, 0.65, 0.0)


def ball():
    """Strain in a ball about (0, 0, 2 um): from 2 % in its middle to 1 % at its edge, nothing beyond."""
    x = (np.arange(20) - 9.5) * EDGE
    z = (np.arange(16) + 0.5) * EDGE
    away = np.sqrt(x**2 + x[:, None] ** 2 + (z[:, None, None] - 2e-6) ** 2)
    return np.where(away < RADIUS, TOP * (1 - 0.5 * away / RADIUS), 0.0), {"z": z, "y": x, "x": x}


@pytest.fixture(scope="module")
def yielded():
    info = synthetic.info(steps=len(LOADS), nx=8, ny=8)
    strain, coords = ball()
    tensor = np.zeros((6, *strain.shape))
    tensor[2], tensor[4] = strain, np.sqrt(2) * strain
    kept = {
        "equivalent_plastic_strain_1": (strain[None], "equivalent plastic strain"),
        "plastic_strain_1": (tensor, "plastic strain"),
        "damage_1": (20.0 * strain[None], "part of the stiffness that is lost"),
    }
    records = [synthetic.step(info, number, load, ("plane", "volume")) for number, load in enumerate(LOADS, 1)]
    for number, record in enumerate(records, 1):
        record.observed.update({"plastic_zone_max_strain": 0.01 * number, "plastic_zone_volume": 1e-16 * number})
        for name, (values, meaning) in kept.items():
            record.history[name] = HistoryRecord(
                name=name, body=1, values=values, coords=coords, unit="1", meaning=meaning
            )
    return synthetic.opened(info, records)


def test_strain_is_known_after_the_steps_whose_history_was_kept(yielded):
    (field,) = plastic_strains(yielded, -1)
    assert field.body == 1
    assert not list(plastic_strains(yielded, 0))
    top, at = field.largest
    assert top == close(TOP * (1 - 0.5 * np.sqrt(3) * 0.5 * EDGE / RADIUS), rel=1e-12)
    assert abs(at["x"]) == close(0.5 * EDGE, rel=1e-9)
    assert field.cut("y", 6e-6) is None


def test_line_around_the_zone_lies_on_the_faces_of_its_cells(yielded):
    """On stress sections too: here the plane y = 0, micrometres."""
    (field,) = plastic_strains(yielded, -1)
    for figure in (plastic_section(yielded, field), stress_section(yielded, "plane_0")):
        (line,) = [item for item in figure.axes[0].collections if item.get_linewidth()[0] == 1.1]
        around = np.concatenate([path.vertices for path in line.get_paths()])
        away = np.hypot(around[:, 0], around[:, 1] - 2.0)
        below = around[:, 1] > 0.3
        assert np.all(np.abs(away[below] - 1e6 * RADIUS) < 1e6 * EDGE)
        assert around[:, 1].min() <= 0.0
    assert not [
        item for item in stress_section(yielded, "plane_0", 1).axes[0].collections
        if item.get_linewidth()[0] == 1.1
    ]  # fmt: skip


def test_load_and_depth_are_told_apart(yielded):
    """Loading begins at the first touch; what falls in one increment is joined by dots."""
    assert unloads(yielded)
    assert not unloads(yielded.isel(step=slice(0, 2)))
    assert loaded_step(yielded) == 1
    axes = load_depth(yielded).axes[0]
    assert [line.get_label() for line in axes.lines] == ["loading", "unloading"]
    assert [line.get_linestyle() for line in axes.lines] == ["-", ":"]
    loads = 1e3 * yielded["normal_load"].values
    np.testing.assert_allclose(axes.lines[0].get_ydata(), [0.0, *loads[:2]], rtol=1e-12)
    np.testing.assert_allclose(axes.lines[1].get_ydata(), loads[1:], rtol=1e-12)
    touch, first = axes.lines[0].get_xdata()[:2]
    assert 1e-9 * first == close(float(yielded["approach"][0]), rel=1e-12)
    assert 0.0 <= 1e-9 * touch < 0.05 * float(yielded["approach"][0])
    assert axes.get_xlabel() == "Approach [nm]"


def test_the_largest_load_is_the_first_that_also_pulls_most(yielded):
    """Loads of steps that hold the normal load differ by its tolerance."""
    loads = {
        "normal_load": [0.3, 0.65, 0.65 + 1e-8, 0.65 + 3e-8, 0.65, 0.0],
        "tangential_load_x": [0, 0, 0.1, -0.1, 0, 0],
    }
    data = yielded.isel(step=[0, 1, 1, 1, 1, 2]).assign({name: ("step", values) for name, values in loads.items()})
    assert loaded_step(data) == 2
    assert loaded_step(data.drop_vars("tangential_load_x")) == 1


@pytest.mark.parametrize(("line", "label"), [(0, "Volume [µm³]"), (1, "Area [µm²]")])
def test_the_size_of_the_zone_has_its_unit(yielded, line, label):
    factor = 1e6 if line else 1.0
    data = yielded.assign(plastic_zone_volume=yielded["plastic_zone_volume"] * factor).assign_attrs(line=line)
    axes = plastic_history(data, "plastic_zone").axes[1]
    assert axes.get_ylabel() == label
    assert axes.lines[0].get_ydata() == close([100.0, 200.0, 300.0], rel=1e-12)


def test_a_load_that_is_held_is_neither_loading_nor_unloading(yielded):
    """Loads that agree to the tolerance of the solver, as in wear under a constant load."""
    held = yielded.isel(step=[0, 1, 1, 1, 1, 2])
    factors = np.array([1, 1, 1 + 1e-9, 1 - 1e-9, 1 + 1e-9, 1])
    lines = load_depth(held.assign(normal_load=held["normal_load"] * factors)).axes[0].lines
    assert [(line.get_label(), len(line.get_xdata())) for line in lines] == [
        ("loading", 3), ("load held", 4), ("unloading", 2),
    ]  # fmt: skip


def test_a_history_of_loads_is_drawn_once(yielded, monkeypatch):
    monkeypatch.setattr("eigencontact.viz.figures.save", lambda *_: None)
    names = set(draw_all(yielded, Path()))
    assert "load-depth.png" in names
    assert "history.png" not in names


def test_means_over_depth(yielded):
    line = mean_profile(yielded, "volume_1", 1).axes[0].lines[0]
    expected = yielded["volume_1_stress"][1].sel(component="xx").mean(["volume_1_y", "volume_1_x"])
    scale = line.get_xdata()[0] / float(expected[0])
    assert scale in (close(1e-6, rel=1e-9), close(1e-9, rel=1e-9))
    np.testing.assert_allclose(line.get_xdata(), scale * expected, rtol=1e-9)


def test_surfaces_are_those_of_the_strain(yielded):
    (field,) = plastic_strains(yielded, -1)
    figure = plastic_surfaces(yielded, field)
    assert [part.get_label() for part in figure.legends[0].legend_handles] == ["0.037 %", "0.47 %", "1.4 %"]
    points = 1e6 * surface_of(field, 0.75 * field.largest[0], field.largest[1]["y"]).reshape(-1, 3)
    away = np.linalg.norm(points[points[:, 2] > 0.5] - [0, 0, 2], axis=1)  # in the uppermost half cell it is upright
    expected = 2 * RADIUS * (1 - 0.75 * field.largest[0] / TOP)
    assert abs(away - 1e6 * expected).max() < 0.1 * 1e6 * EDGE
    assert points[:, 1].min() >= 1e6 * field.largest[1]["y"] - 1e-3


def test_all_pictures_and_nothing_of_vtk_without_being_asked(yielded, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyvista", None)
    monkeypatch.setattr("eigencontact.viz.figures.save", lambda figure, path, *_: made.append((figure, path.name)))
    made = []
    drawn = draw_all(yielded, tmp_path)
    assert {"plastic-strain.png", "damage.png", "load-depth.png", "plastic-history.png", "plane_0-loaded.png"} <= set(
        drawn
    )
    assert "volume_1-means.png" in drawn
    assert [name for _, name in made] == list(drawn)
    assert all(figure.axes for figure, _ in made)


def test_cells_are_stored_for_paraview(yielded, tmp_path):
    names = [path.name for path in write_vtk(yielded, tmp_path)]
    assert names[-2:] == ["cells_1_0003.vti", "cells_1.pvd"]
    mesh, strain = pv.read(tmp_path / "cells_1_0003.vti"), ball()[0]
    np.testing.assert_allclose(mesh.bounds, np.array([-5, 5, -5, 5, 0, 8]) * 1e-6, rtol=1e-9, atol=1e-15)
    np.testing.assert_array_equal(mesh.cell_data["equivalent_plastic_strain_1"], strain.ravel())
    tensor = mesh.cell_data["plastic_strain_1"]  # xx, yy, zz, xy, yz, xz
    np.testing.assert_allclose(tensor[:, 2], strain.ravel())
    np.testing.assert_allclose(tensor[:, 5], strain.ravel())


def scene(stress, **steel):
    return build_model(
        Scene(
            body1={"young_modulus": 210e9, "poisson_ratio": 0.3, **steel},
            geometry={"type": "sphere", "radius": 105e-6},
            steps={"normal_load": 0.65},
            grid={"cells": 16, "size": [22e-6, 22e-6]},
            stress={"shape": "plane", "depth_max": 7e-6, **stress},
        ),
        installed_plugins(),
    )


@pytest.mark.parametrize(
    ("law", "stress", "depths"),
    [
        (True, {}, None),
        (True, {"depth_cells": 2}, [0, 3.5e-6, 7e-6]),
        (False, {}, np.linspace(0, 7e-6, 49)),
    ],
)
def test_depths_are_the_middles_of_cells_where_a_body_yields(law, stress, depths):
    steel = {"law": {"type": "j2", "hardening": {"type": "perfect", "yield_stress": 3e9}}} if law else {}
    model = scene(stress, **steel)
    if depths is None:
        (source,) = model.cells.inhomogeneities
        depths = source.lattice.axes(model.grid)[0]
        depths = depths[depths < 7e-6]
    np.testing.assert_allclose(region_lattice(model.cells.requests[0], model.grid).depths, depths, rtol=1e-9)
    assert not outlines(model), "the box around what yields is no inclusion"


def test_impacts_are_told_apart_by_what_lies_between_them(yielded):
    """One of the four grows in two steps, its last counts; every cell that the smallest touches has felt all."""
    rows = yielded.isel(step=[0, 2, 1, 2, 0, 1, 2, 0, 2])
    loads = rows["pressure"].max(["y", "x"])
    rows = rows.assign(max_pressure=loads, travel_x=("step", np.arange(9) * 1e-6), travel_y=("step", np.zeros(9)))
    assert struck(rows)
    assert impacts(rows) == [0, 2, 5, 7]
    count, small, large = strikes(rows), yielded["pressure"][0].values > 0, yielded["pressure"][1].values > 0
    np.testing.assert_array_equal(count == 4, small)
    np.testing.assert_array_equal(count == 2, large & ~small)
    axes = coverage_map(rows).axes[0]
    assert axes.get_title().startswith("4 impacts cover ")
    drawn = axes.images[0].get_array()
    rows_shown = 6 * (axes.get_ylim()[1] - axes.get_ylim()[0]) / (1e6 * rows.attrs["cell_size"][1])
    assert drawn.shape[0] == close(rows_shown, rel=1e-9)
    for n, cells in ((2, 32), (4, 16)):  # a print of 4 x 4 cells is drawn with round corners
        assert int((count >= n).sum()) == cells
        assert 0.7 * cells < float((drawn >= n).sum()) / 36 <= cells


def test_the_map_of_plastic_strain_has_no_colour_outside_of_the_line(yielded):
    """Strain of less than 5 % of the largest at a single cell is neither in the zone nor coloured."""
    (field,) = plastic_strains(yielded, -1)
    values = field.values.copy()
    values[12, 9:11, 2] = 0.03 * values.max()
    axes = plastic_section(yielded, replace(field, values=values)).axes[0]
    filled = next(item for item in axes.collections if isinstance(item, ContourSet) and item.filled)
    assert filled.levels[1] == close(100 * SHARE * values.max(), rel=1e-12)
    assert to_hex(filled.cmap(filled.norm(0.5 * filled.levels[1]))) == to_hex(axes.get_facecolor())
    lines = [item for item in axes.collections if isinstance(item, ContourSet) and not item.filled]
    assert lines
    assert all(len(item.get_paths()[0].to_polygons()) == 1 for item in lines)
