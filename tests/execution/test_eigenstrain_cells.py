"""Regions cut into cells: the same numbers as the closed form where both exist, by every way; layers; convergence."""

import numpy as np
import pytest

import eigencontact as ec
from bodies import STEEL_TABLE as STEEL
from eigencontact.execution.routes import cells as cells_route

E, NU = 210e9, 0.3
CUBOID = {"type": "cuboid", "center": [0.5e-6, 0.0, 2e-6], "edges": [4e-6, 3e-6, 2e-6]}
STRAIN = np.array([[1e-3, 2e-4, 3e-4], [2e-4, -3e-4, 1e-4], [3e-4, 1e-4, 5e-4]])
BOTH = ["stress", "displacement"]
REGIONS = [
    {
        "name": "cut",
        "shape": "plane",
        "position": 0.3e-6,
        "depths": [0.0, 0.2e-6, 2.3e-6, 4e-6],
        "fields": [*BOTH, "strain"],
    },
    {"name": "across", "shape": "plane", "normal": "x", "position": -0.7e-6, "depths": [0.0, 1.9e-6], "fields": BOTH},
    {"name": "level", "shape": "plane", "normal": "z", "position": 2.1e-6},
    {"name": "vol", "shape": "volume", "depths": [0.0, 0.25e-6, 0.75e-6, 1.25e-6, 1.75e-6], "fields": BOTH},
    {
        "name": "line",
        "shape": "line",
        "start": [0.1e-6, 0.2e-6, 0.0],
        "end": [0.1e-6, 0.2e-6, 5e-6],
        "count": 7,
        "fields": BOTH,
    },
    {
        "name": "spots",
        "shape": "points",
        "points": [[0.1e-6, 0.2e-6, 0.0], [3e-6, 1e-6, 0.3e-6], [0.1e-6, 0.2e-6, 2.1e-6]],
    },
]


@pytest.fixture
def stored(tmp_path):
    """The uniform eigenstrain in a file, so that nobody knows it is uniform."""
    axis = np.linspace(-20e-6, 20e-6, 3)
    plain = np.array([STRAIN[i, j] for i, j in ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))])
    values = np.broadcast_to(plain[:, None, None, None], (6, 3, 3, 3))
    np.savez(tmp_path / "e.npz", x=axis, y=axis, z=axis, eigenstrain=values)
    return {"type": "from-file", "file": str(tmp_path / "e.npz")}


@pytest.mark.parametrize("space", ["exact", "full-space"])
def test_a_cuboid_of_whole_cells_has_the_field_of_its_closed_form(stored, space):
    """Surface, planes along and across, a volume by FFT in space, a line, points: to round-off."""
    scene = {"body1": STEEL, "grid": {"cells": 9, "size": [9e-6, 9e-6]}, "stress": REGIONS}
    scene |= {"numerics": {"inclusion-cells": 4, "half-space": space}}
    closed = ec.run({**scene, "inclusions": {**CUBOID, "eigenstrain": STRAIN}}).dataset
    planned = ec.plan({**scene, "inclusions": {**CUBOID, "eigenstrain": stored}})
    kernels = "\n".join(map(str, planned.kernels))
    for words in ("FFT in space", "layer by layer", "point by point", "4 x 3 x 4 cells"):
        assert words in kernels
    cells = ec.run(planned).dataset
    names = [name for name, variable in closed.data_vars.items() if variable.attrs["role"] in ("field", "region")]
    assert len(names) == 3 + 3 + 2 + 1 + 2 + 2 + 1 + len(REGIONS)
    for name in names:
        largest = float(np.abs(closed[name]).max())
        np.testing.assert_allclose(cells[name], closed[name], rtol=0, atol=1e-13 * largest, err_msg=name)


def scattered(stored, cells, points):
    """Stress of the cuboid at points, with so many cells to the window."""
    scene = {
        "body1": STEEL,
        "grid": {"cells": cells, "size": [9e-6, 9e-6]},
        "numerics": {"inclusion-cells": 4 * cells // 9},
    }
    scene["inclusions"] = {**CUBOID, "eigenstrain": stored}
    scene["stress"] = {"name": "many", "shape": "points", "points": np.asarray(points).tolist()}
    data = ec.run(scene).dataset
    return data["many_stress"].values


def test_many_points_are_interpolated_between_the_middles_of_cells(stored, monkeypatch):
    """In the middles and on the surface above them to round-off; where the field is smooth, with second order."""
    axis = np.array([-3e-6, 2e-6])
    middles = np.stack([v.ravel() for v in np.meshgrid(axis, axis, [0.0, 0.25e-6, 0.75e-6, 2.25e-6])], axis=-1)
    beside = np.random.default_rng(5).uniform((-4e-6, -4e-6, 6e-6), (4e-6, 4e-6, 7e-6), (10, 3))
    exact = [scattered(stored, 9, points) for points in (middles, beside)]
    monkeypatch.setattr(cells_route, "_PLACES", 3)
    found = scattered(stored, 9, middles)
    np.testing.assert_allclose(found, exact[0], rtol=0.0, atol=1e-12 * np.abs(exact[0]).max())
    errors = [np.linalg.norm(scattered(stored, cells, beside) - exact[1]) for cells in (9, 18)]
    assert 2.5 < errors[0] / errors[1] < 5.5
    assert errors[0] < 0.1 * np.linalg.norm(exact[1])


def test_precision_and_time_reach_the_cells(stored):
    field = {**stored, "times": [0.0, 2.0], "factors": [0.0, 1.0]}
    scene = {"body1": STEEL, "grid": {"cells": 9, "size": [9e-6, 9e-6]}, "steps": {"increments": 2}}
    scene |= {"inclusions": {**CUBOID, "eigenstrain": field}}
    double, single = (
        ec.run({**scene, "numerics": {"inclusion-cells": 4, "precision": precision}}).dataset.residual_displacement_z
        for precision in ("double", "single")
    )
    np.testing.assert_allclose(double[0], 0.5 * double[1], rtol=1e-13)
    error = float(np.abs(single - double).max() / np.abs(double).max())
    assert 1e-9 < error < 1e-5


def test_cells_of_a_ball_converge_to_its_closed_form():
    """Uniform in the ball but said to be a profile; 6, 12, 24 cells across: displacement of the surface."""
    ball = {"type": "sphere", "center": [0.0, 0.0, 1.5e-6], "radius": 1e-6}
    constant = {"type": "depth-profile", "depths": [0.0, 1.0], "values": [1e-3, 1e-3]}
    errors = []
    for across in (6, 12, 24):
        scene = {
            "body1": STEEL,
            "grid": {"cells": 3 * across, "size": [6e-6, 6e-6]},
            "numerics": {"inclusion-cells": across},
        }
        exact = ec.run({**scene, "inclusions": {**ball, "eigenstrain": 1e-3}}).dataset.residual_displacement_z
        cells = ec.run({**scene, "inclusions": {**ball, "eigenstrain": constant}}).dataset.residual_displacement_z
        errors.append(float(np.abs(cells - exact).max() / np.abs(exact).max()))
    assert errors[-1] < 1e-3
    assert errors[0] > errors[1] > errors[2]


def test_a_wide_peened_patch_is_in_biaxial_compression():
    """sigma_xx = sigma_yy = -E e(z)/(1 - nu) in the middle of a wide patch, sigma_zz = 0 (the mean over each layer)."""
    depth, layers, width = 8e-6, 8, 400e-6
    patch = {"type": "peened-layer", "peak": 1e-3, "peak-depth": 2e-6, "width": 4e-6, "depth": depth, "layers": layers}
    depths = [(k + 0.5) * depth / layers for k in range(layers)]
    scene = {"body1": STEEL, "grid": {"cells": 21, "size": [width, width]}, "eigenstrain": patch}
    scene |= {"stress": {"name": "middle", "shape": "points", "points": [[0.0, 0.0, z] for z in depths]}}
    stress = ec.run(scene).dataset.middle_stress[0].values
    z = np.array(depths)
    expected = -E * 1e-3 * np.exp(-2 * ((z - 2e-6) / 4e-6) ** 2) / (1 - NU)
    for component in (0, 1):
        np.testing.assert_allclose(stress[component], expected, rtol=0, atol=0.04 * abs(expected).max())
    np.testing.assert_allclose(stress[2:], 0.0, atol=5e-3 * abs(expected).max())


def test_overlapping_regions_add_up(stored):
    scene = {"body1": STEEL, "grid": {"cells": 9, "size": [9e-6, 9e-6]}, "numerics": {"inclusion-cells": 4}}
    twice = ec.run({**scene, "inclusions": [{**CUBOID, "eigenstrain": stored}] * 2}).dataset.residual_displacement_z
    once = ec.run({**scene, "inclusions": {**CUBOID, "eigenstrain": stored}}).dataset.residual_displacement_z
    np.testing.assert_allclose(twice, 2 * once, rtol=1e-13)


def test_cells_under_a_contact(stored):
    """The same contact whether the inclusion below it is a closed form or cells."""
    scene = {"body1": STEEL, "geometry": {"type": "sphere", "radius": 105e-6}, "steps": {"normal-load": 0.5}}
    scene |= {"grid": {"cells": 32, "size": [16e-6, 16e-6]}, "numerics": {"tolerance": 1e-10, "inclusion-cells": 4}}
    scene |= {"stress": {"shape": "plane", "depth-max": 5e-6, "depth-cells": 4}}
    closed = ec.run({**scene, "inclusions": {**CUBOID, "eigenstrain": STRAIN}}).dataset
    cells = ec.run({**scene, "inclusions": {**CUBOID, "eigenstrain": stored}}).dataset
    for name in ("pressure", "gap", "plane_y1_stress", "residual_displacement_z"):
        largest = float(np.abs(closed[name]).max())
        np.testing.assert_allclose(cells[name], closed[name], rtol=0, atol=1e-8 * largest)


def test_a_field_that_answers_wrongly_is_named(install):
    install(
        """
        from dataclasses import dataclass
        from typing import ClassVar
        import numpy as np
        from eigencontact.plugin import EigenstrainField, hookimpl

        @dataclass(frozen=True, kw_only=True)
        class Bad(EigenstrainField):
            key: ClassVar[str] = "bad"
            fill: float = 1.0

            def eigenstrain(self, x, y, z, time):
                return np.full((5, 1, 1, 1) if self.fill else (6, 1, 1, 1), np.nan)

        @hookimpl
        def eigencontact_register():
            return [Bad]
        """
    )
    scene = {"body1": STEEL, "grid": {"cells": 9, "size": [9e-6, 9e-6]}}
    for fill, words in (
        (1.0, "'bad' must be an array that broadcasts to shape (6,"),
        (0.0, "eigenstrain must be finite in every cell"),
    ):
        inclusion = {**CUBOID, "eigenstrain": {"type": "bad", "fill": fill}}
        with pytest.raises(ec.EigencontactError) as caught:
            ec.run({**scene, "inclusions": inclusion})
        assert words in str(caught.value)
