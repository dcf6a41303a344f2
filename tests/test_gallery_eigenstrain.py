"""Every bundled scene without a contact runs, agrees with something independent, and leaves files that open."""

import json

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact.scene.loader import bundled_names

#: Changes that make a scene quick where that matters; regions keep a point where they are compared.
CHANGES = {
    "sphere-near-surface": ["grid.cells=33", "grid.size=[33e-6, 33e-6]", "stress.0.depth-cells=16"],
    "buried-cuboid": ["grid.cells=21", "stress.0.depth-cells=8"],
    "prestressed-bars": [
        "grid={cells=[48, 96], spacing=['5 mm', '1 mm']}",
        "stress.0.position='2.5 mm'",
        "stress.1={name='along', shape='plane', normal='z', position='16 mm'}",
    ],
    "peened-layer": [
        "stress.0={name='section', shape='plane', normal='z', position='60 um'}",
        "stress.1.end=[0, 0, '530 um']",
        "stress.1.count=14",
    ],
}


#: Scenes that run with the slow tests: each takes a second or more.
LONG = {"peened-layer", "prestressed-bars"}
#: Scene whose pictures are drawn by default: they cost as much as the run.
DRAWN = "sphere-near-surface"


@pytest.fixture
def finished(finished):
    """Give the folder of a bundled scene on coarser cells."""

    def folder(name, *, drawn=False):
        plain = [] if drawn or name == DRAWN else ["output.pictures=false"]
        return finished(name, *CHANGES[name], *plain, stored=True).folder

    return folder


def read(folder):
    return json.loads((folder / "summary.json").read_text(encoding="utf-8"))


def test_every_bundled_scene_without_contact_is_tested():
    assert [name for name in bundled_names() if not ec.load_scene(name).geometry] == sorted(CHANGES) == sorted(PINS)


@pytest.mark.parametrize("name", [pytest.param(n, marks=[pytest.mark.slow] * (n in LONG)) for n in CHANGES])
def test_summary_and_results(name, finished):
    folder = finished(name)
    summary = read(folder)
    assert summary["converged"] is True
    assert summary["max_von_mises"] > 0
    assert max(summary["max_uplift"], summary["max_sink"]) > 0
    assert not {"normal_load", "max_pressure"} & set(summary)
    assert set(summary["files"]) == {path.name for path in folder.iterdir()}
    with ec.open_results(folder) as data:
        assert data.sizes["step"] == summary["load_steps"]
        assert "pressure" not in data
        for axis in "xyz":
            variable = data[f"residual_displacement_{axis}"]
            assert variable.dims == ("step", "y", "x")
            assert variable.attrs["units"] == "m"
            assert np.isfinite(variable).all()
        down = data.residual_displacement_z[-1]
        assert summary["max_uplift"] == max(0.0, -float(down.min()))
        assert summary["max_sink"] == max(0.0, float(down.max()))


@pytest.mark.parametrize(
    "name", [DRAWN, *(pytest.param(name, marks=pytest.mark.slow) for name in CHANGES if name != DRAWN)]
)
def test_pictures_open_and_show_something(name, finished):
    from matplotlib.image import imread

    pictures = {path.name: path for path in finished(name, drawn=True).glob("*.png")}
    expected = {f"{request.label}.png" for request in ec.load_scene(name).stress if request.shape != "points"}
    assert set(pictures) == {"uplift.png", "uplift-profiles.png"} | expected
    for path in pictures.values():
        image = imread(path)
        assert min(image.shape[:2]) > 200, path.name
        assert image[..., :3].std() > 0.01, path.name


def test_vtk_files_open(finished):
    import pyvista

    folder = finished("sphere-near-surface")
    surface = pyvista.read(folder / "surface_0001.vti")
    assert surface["residual_displacement"].shape == (33 * 33, 3)
    assert -surface["residual_displacement"][:, 2].min() == close(read(folder)["max_uplift"], rel=1e-6, abs=0)
    section = pyvista.read(folder / "section_0001.vti")
    assert section["strain"].shape == section["stress"].shape == (section.n_points, 6)
    assert section["displacement"].shape == (section.n_points, 3)


# ---------------------------------------------------------------- one pinned number each, beside an independent one

PINS = {
    "sphere-near-surface": ("max_uplift", 1.7333333e-8),
    "buried-cuboid": ("max_sink", 1.14688e-11),
    "prestressed-bars": ("max_sink", 4.11196e-6),
    "peened-layer": ("max_uplift", 1.07901e-7),
}


@pytest.mark.parametrize("name", PINS)
def test_pins(name, finished):
    key, value = PINS[name]
    assert read(finished(name))[key] == close(value, rel=1e-4, abs=0)


def test_the_sphere_is_case_dl_1(finished):
    """Stress at the touching point just outside, uplift above the centre; no traction on the surface."""
    E, nu, e, a = 210e9, 0.3, 1e-3, 10e-6
    assert read(finished("sphere-near-surface"))["max_uplift"] == close(4 / 3 * (1 + nu) * e * a, rel=1e-12, abs=0)
    with ec.open_results(finished("sphere-near-surface")) as data:
        z, stress = data.axis_z.values, data.axis_stress[0].values
        surface = data.section_stress[0].sel(section_z=0.0).values
    touching = 4 / 3 * E * e * (1 + nu) / (1 - nu)
    assert stress[0, 0] == close(touching, rel=1e-12)
    np.testing.assert_allclose(surface[[2, 3, 4]], 0.0, atol=1e-12 * touching)
    # theory of the tangent sphere in units E e/(1 - nu), nu = 0.3: (xx, zz) on the axis
    unit, printed = (
        E * e / (1 - nu),
        {0.5: (-0.449383, -0.074074), 1.0: (-0.616667, -0.333333), 2.5: (0.098099, -0.115343)},
    )
    for depth, values in printed.items():
        at = int(np.argmin(np.abs(z - depth * a)))
        np.testing.assert_allclose(stress[[0, 2], at] / unit, values, atol=2e-6)


def test_the_cuboid_is_case_cb_2(finished):
    """Displacement per unit eigenstrain, in edges, at (-2, -1, -5) edges from the middle (six printed columns)."""
    columns = {
        (0, 0): (-6.1503e-4, -7.949e-5, -8.9707e-4),
        (2, 2): (-4.79138e-3, -2.39557e-3, -1.206067e-2),
        (0, 1): (-9.3376e-4, -8.0886e-4, -1.68445e-3),
        (0, 2): (-3.90016e-3, -1.90961e-3, -9.58275e-3),
        (1, 2): (-1.90961e-3, -1.03598e-3, -4.79113e-3),
    }
    strain = ec.load_scene("buried-cuboid").inclusions[0].eigenstrain
    expected = 1e-6 * sum(strain[i][j] * np.array(column) for (i, j), column in columns.items())
    with ec.open_results(finished("buried-cuboid")) as data:
        found = [
            float(data[f"residual_displacement_{axis}"][0].sel(x=-2e-6, y=-1e-6, method="nearest")) for axis in "xyz"
        ]
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-17)  # printed to 1e-8 edges, times the eigenstrain


@pytest.mark.slow
def test_the_bars_are_case_pb(finished):
    """In the middle of each bar: the infinite cylinder with an axial eigenstrain in a full space (Eshelby 1957)."""
    E, nu, e = 50e9, 0.3, -2e-3
    axial, across = -E * e / (1 - nu**2), -nu * E * e / (2 * (1 - nu**2))
    assert (axial, across) == close((109.89e6, 16.48e6), rel=1e-3)
    with ec.open_results(finished("prestressed-bars")) as data:
        for y in (-9.5e-3, 10.5e-3):
            for z in (16e-3, 35e-3):
                stress = data.across_stress[0].sel(across_y=y, across_z=z, method="nearest").values
                assert stress[0] == close(axial, rel=0.04)  # bars of 16 diameters, near the surface
                np.testing.assert_allclose(stress[1:3], across, atol=0.02 * axial)
                np.testing.assert_allclose(stress[3:], 0.0, atol=0.02 * axial)
        between = data.across_stress[0].sel(across_y=0.5e-3, across_z=26e-3, method="nearest").values
        assert between[0] < 0  # pressed concrete
        surface = data.across_stress[0].sel(across_z=0.0).values
        np.testing.assert_allclose(surface[[2, 3, 4]], 0.0, atol=1e-12 * axial)


@pytest.mark.slow
def test_the_peened_layer_is_pressed_by_its_own_stretch(finished):
    """Stress minus -E e/(1 - nu), that of an endless layer, is a smooth tension that balances it."""
    E, nu, width = 210e9, 0.3, 150e-6
    with ec.open_results(finished("peened-layer")) as data:
        z, stress = data.middle_z.values, data.middle_stress[0].values
    strain = np.where(z < 400e-6, 3e-3 * np.exp(-2 * ((z - 60e-6) / width) ** 2), 0.0)
    peak = E * 3e-3 / (1 - nu)
    for component in (0, 1):
        rest = stress[component] + E * strain / (1 - nu)
        assert 0.05 * peak < rest.min() < rest.max() < 0.12 * peak
        assert np.all(np.diff(rest) < 0)
        assert np.abs(np.diff(rest)).max() < 0.004 * peak  # of points 40 um apart
    np.testing.assert_allclose(stress[3:], 0.0, atol=1e-9 * peak)
    assert stress[0].min() == close(-793e6, rel=2e-3)
