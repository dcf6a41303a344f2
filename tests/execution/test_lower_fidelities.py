"""Scenes with each treatment of the free surface: answers within the price that the README's table names."""

from __future__ import annotations

import numpy as np
import pytest

import eigencontact as ec
from bodies import STEEL_TABLE as STEEL
from eigencontact.errors import EigencontactError, SceneError

CUBE = {
    "name": "cube",
    "type": "cuboid",
    "center": [0.0, 0.0, 2.25e-6],
    "edges": [1.5e-6, 1.5e-6, 1.5e-6],  # three by three by four cells
    "eigenstrain": [[1e-3, 2e-4, 3e-4], [2e-4, 0, 1e-4], [3e-4, 1e-4, -5e-4]],
}
SECTION = {"name": "section", "shape": "plane", "normal": "y", "depth-max": 6e-6, "depth-cells": 12}
LEVEL = {"name": "level", "shape": "plane", "normal": "z", "position": 1e-6, "fields": ["strain", "displacement"]}
LINE = {"name": "line", "shape": "line", "start": [-2e-6, 0, 1e-6], "end": [2e-6, 1e-6, 5e-6], "count": 7}
THERMAL = {"type": "thermal", "expansion": 1e-5, "temperature": 100.0, "times": [0.0, 2.0], "factors": [0.0, 1.0]}


def scene(space, **tables):
    numerics = {"half-space": space, "inclusion-cells": 4}
    base = {"body1": STEEL, "inclusions": [CUBE], "grid": {"cells": 33, "size": [16.5e-6, 16.5e-6]}}
    return base | {"numerics": numerics | tables.pop("numerics", {})} | tables


def difference(one, other, name):
    """Largest difference over the largest value; displacements less their means, which the periodic choice shifts."""
    a, b = (data[name].values for data in (one, other))
    apart = a - b
    if "displacement" in name:
        apart = apart - apart.mean(axis=(-2, -1), keepdims=True)
    return np.abs(apart).max() / np.abs(b).max()


#: Largest errors of u_z, of u_x and u_y (which fall only with the square of the distance: copies disturb them most), of
#: the stress in the section and of strain and displacement on the level; and the least that shows the choice was heard.
PRICES = {
    "image-pressure": ((0.03, 0.04, 0.02, 0.03), 1e-3),
    "periodic": ((0.03, 0.35, 0.02, 0.1), 1e-3),
    "full-space": ((0.7, 0.7, 0.3, 0.6), 0.05),
}


@pytest.mark.parametrize("space", PRICES)
def test_answers_are_within_the_price(space):
    regions = [SECTION | {"depth-max": 6.25e-6}, LEVEL]
    exact = ec.run(scene("exact", stress=regions)).dataset
    found = ec.run(scene(space, stress=regions)).dataset
    most, least = PRICES[space]
    errors = [difference(found, exact, f"residual_displacement_{c}") for c in "xyz"]
    errors = [errors[2], max(errors[:2]), difference(found, exact, "section_stress")]
    errors.append(max(difference(found, exact, f"level_{name}") for name in ("strain", "displacement")))
    for error, bound in zip(errors, most, strict=True):
        assert least < error < bound


def test_image_pressure_on_lines_and_on_planes_agree():
    line = {"name": "line", "shape": "line", "start": [0, 0, 0], "end": [0, 0, 6e-6], "count": 13}
    data = ec.run(scene("image-pressure", stress=[SECTION, line])).dataset
    np.testing.assert_allclose(data.line_stress[0].values, data.section_stress[0, :, :, 16].values, rtol=0, atol=1e-3)


def test_image_pressure_of_cells_is_that_of_the_shape():
    """A depth-dependent field that is uniform makes cells of the cube, on columns of the grid that fit its edges."""
    fine = {"grid": {"cells": 33, "size": [8.25e-6, 8.25e-6]}}
    shape = CUBE | {"center": [0.125e-6, 0.125e-6, 0.75e-6], "eigenstrain": 1e-3}
    uniform = {"type": "depth-profile", "depths": [0.0, 10e-6], "values": [1e-3, 1e-3]}
    one = ec.run(scene("image-pressure", inclusions=[shape], stress=SECTION, **fine)).dataset
    other = ec.run(scene("image-pressure", inclusions=[shape | {"eigenstrain": uniform}], stress=SECTION, **fine))
    for name in ("residual_displacement_x", "residual_displacement_z", "section_stress"):
        assert difference(other.dataset, one, name) < 1e-9


@pytest.mark.parametrize("space", ["image-pressure", "periodic"])
def test_history_scales_the_field(space):
    moving, still = (CUBE | {"eigenstrain": eigenstrain} for eigenstrain in (THERMAL, 1e-3))
    data = ec.run(scene(space, inclusions=[moving], steps=[{}, {}], stress=SECTION)).dataset
    full = ec.run(scene(space, inclusions=[still], stress=SECTION)).dataset
    for name in ("residual_displacement_z", "section_stress"):
        for step, factor in enumerate((0.5, 1.0)):
            expected = factor * full[name][0].values
            np.testing.assert_allclose(data[name][step], expected, rtol=0, atol=1e-13 * np.abs(expected).max())


def test_periodic_scene_repeats():
    """Moved by a part of the window, the region moves; what leaves on one side comes in on the other."""
    moved = CUBE | {"center": [8e-6, -4e-6, 2.25e-6]}
    one, other = (ec.run(scene("periodic", inclusions=[cube], stress=LEVEL)).dataset for cube in (CUBE, moved))
    for name, axes in (("residual_displacement_z", (1, 2)), ("level_strain", (-2, -1))):
        shifted = np.roll(one[name].values, (-8, 16), axis=axes)
        np.testing.assert_allclose(other[name], shifted, rtol=0, atol=1e-12 * np.abs(shifted).max())


@pytest.mark.parametrize("space", ["image-pressure", "periodic"])
def test_explain_names_the_price(space):
    text = ec.plan(scene(space, stress=SECTION)).explain()
    assert f'numerics.half-space = "{space}"' in text
    assert "approximate" in text if space == "image-pressure" else "repeats with the window" in text
    assert "the exact half-space" in text


def test_contact_over_repeated_eigenstrain():
    """A flat load over a periodic window: the contact opens where the eigenstrain repeats, too."""
    geometry = {"type": "sphere", "radius": 105e-6}
    tables = {"geometry": geometry, "steps": {"normal-load": 0.05}, "numerics": {"boundary": "periodic"}}
    both = ec.run(scene("periodic", **tables)).summary
    with pytest.raises(
        SceneError, match=r"numerics\.boundary must be 'non-periodic'.*half-space = \"periodic\" as well"
    ):
        ec.plan(scene("exact", **tables))
    assert both["max_uplift"] > 0


@pytest.mark.parametrize("region", [LINE, {"name": "spots", "shape": "points", "points": [[0, 0, 1e-6]]}])
def test_lines_and_points_of_a_periodic_half_space_are_refused(region):
    with pytest.raises(EigencontactError, match=r"must be 'exact' for fields on lines and at points.*use a plane"):
        ec.plan(scene("periodic", stress=region))


def test_regions_above_the_surface_are_refused():
    with pytest.raises(SceneError, match="must lie below the surface"):
        ec.plan(scene("image-pressure", inclusions=[CUBE | {"center": [0, 0, 0.2e-6]}]))
