"""Every bundled scene runs, converges, agrees with something independent, and leaves files that open."""

import json
from math import isfinite

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

import eigencontact as ec
from close import close
from eigencontact.scene.loader import bundled_names
from eigencontact_verification.oracles import hertz
from eigencontact_verification.oracles.line_contact import hertz_cylinder

STEEL = 210e9 / (1 - 0.3**2)

#: Coarser cells, so that each scene takes about a second; the rough scene keeps the points of its measurement.
COARSER = {
    "hertz": ["grid.cells-per-contact-radius=40", "stress.0.depth-cells=60"],
    "hertz-ellipse": ["grid.cells-per-contact-radius=20", "stress.0.depth-cells=30", "stress.1.depth-cells=30"],
    "tilted-punch": ["grid.cells-per-contact-radius=32", "steps.1.increments=2", "stress.0.depth-cells=12"],
    "ribbed-roller": [
        "grid.cells=[128, 24]",
        "stress.0.depth-cells=20",
        "stress.1.depth-cells=8",
        "steps.1.increments=1",
    ],
    "rough-surface": [],
    "random-rough": ["steps.0.increments=3"],
    "dissimilar-spheres": ["grid.cells-per-contact-radius=24", "output.vtk=true"],
}
SUMMARY_KEYS = (
    "converged",
    "normal_load",
    "approach",
    "contact_area",
    "contact_radius",
    "max_pressure",
    "max_von_mises",
    "max_von_mises_depth",
    "iterations",
    "convolutions",
    "solve_seconds",
    "peak_memory_bytes",
    "gap_residual",
)


#: Scene whose pictures are drawn by default: they cost as much as the run.
DRAWN = "hertz"


def changes_of(name, *, drawn=False):
    return COARSER[name] if drawn or name == DRAWN else [*COARSER[name], "output.pictures=false"]


@pytest.fixture
def finished(finished):
    """Give the folder of a bundled scene on coarser cells."""
    return lambda name, **drawn: finished(name, *changes_of(name, **drawn), stored=True).folder


def read(folder):
    return json.loads((folder / "summary.json").read_text(encoding="utf-8"))


def test_every_bundled_contact_is_tested():
    """The others are in the files beside this one: test_gallery_eigenstrain.py, _friction.py and so on."""
    scenes = {name: ec.load_scene(name) for name in bundled_names()}
    smooth = [
        name
        for name, scene in scenes.items()
        if scene.geometry
        and not scene.grid.line
        and scene.friction is None
        and scene.body1.medium is None
        and not scene.inclusions
        and scene.body1.law is None
        and scene.wear is None
    ]
    assert smooth == sorted(COARSER) == sorted(PINS)


@pytest.mark.parametrize("name", COARSER)
def test_summary(name, finished):
    summary = read(finished(name))
    stressed = bool(ec.load_scene(name).stress)
    assert {key for key in SUMMARY_KEYS if stressed or "von_mises" not in key} <= set(summary)
    assert stressed or "max_von_mises" not in summary
    assert summary["converged"] is True
    for row in summary["history"]:
        assert max(row["gap_residual"], row["penetration_residual"], row["load_residual"]) <= 1e-6
    for key in SUMMARY_KEYS:
        assert key not in summary or isfinite(summary[key])
    assert summary["contact_radius"] == close(np.sqrt(summary["contact_area"] / np.pi), rel=1e-12)
    assert 5e7 < summary["peak_memory_bytes"] < 5e9
    assert set(summary["files"]) == {path.name for path in finished(name).iterdir()}


@pytest.mark.parametrize("name", COARSER)
def test_results_open_in_xarray_with_units_and_provenance(name, finished):
    import xarray

    with xarray.open_dataset(finished(name) / "results.nc") as data:
        assert data.sizes["step"] == read(finished(name))["load_steps"]
        for variable in ("pressure", "gap", "displacement_z"):
            assert data[variable].dims == ("step", "y", "x")
            assert data[variable].attrs["units"] in ("Pa", "m")
            assert data[variable].attrs["long_name"]
        assert data.x.attrs["units"] == "m"
        assert np.all(data.pressure.values >= 0)
        force = data.pressure.sum(("x", "y")) * (data.x[1] - data.x[0]) * (data.y[1] - data.y[0])
        np.testing.assert_allclose(force, data.normal_load, rtol=1e-5)
        assert {"scene", "scene_hash", "versions", "title"} <= set(data.attrs)
        again = ec.load_scene(_tables(data.attrs["scene"]))
    assert again == ec.load_scene(name, changes_of(name))


def _tables(text):
    import tomllib

    return tomllib.loads(text)


@pytest.mark.parametrize(
    "name", [DRAWN, *(pytest.param(name, marks=pytest.mark.slow) for name in COARSER if name != DRAWN)]
)
def test_pictures_open_and_show_something(name, finished):
    from matplotlib.image import imread

    pictures = sorted(finished(name, drawn=True).glob("*.png"))
    assert {"pressure.png", "pressure-profiles.png"} <= {path.name for path in pictures}
    for request in ec.load_scene(name).stress:
        assert f"{request.label}.png" in {path.name for path in pictures}
    for path in pictures:
        image = imread(path)
        assert min(image.shape[:2]) > 200, path.name
        assert image[..., :3].std() > 0.01, path.name


@pytest.mark.parametrize("name", ["hertz", "dissimilar-spheres"])
def test_vtk_files_open(name, finished):
    import pyvista

    with ec.open_results(finished(name)) as data:
        largest = float(data.pressure.max())
    surface = pyvista.read(finished(name) / "surface_0001.vti")
    assert surface["pressure"].max() == close(largest, rel=1e-6)
    for path in finished(name).glob("*.pvd"):
        assert pyvista.read(path).n_blocks >= 1


# ---------------------------------------------------------------- one pinned number each, beside an independent one

# Values of the coarser scenes. They hold to 2e-4: with another FFT library the contact's edge may gain or lose a cell.
PINS = {
    "hertz": ("max_pressure", 8.4683e9),
    "hertz-ellipse": ("max_pressure", 4.5776e9),
    "tilted-punch": ("max_pressure", 9.5462e8),
    "ribbed-roller": ("max_pressure", 1.4640e9),
    "rough-surface": ("approach", 2.5763e-7),
    "random-rough": ("approach", 4.3883e-7),
    "dissimilar-spheres": ("max_von_mises", 4.2538e8),
}


@pytest.mark.parametrize("name", PINS)
def test_pins(name, finished):
    key, value = PINS[name]
    assert read(finished(name))[key] == close(value, rel=2e-4)


def test_hertz_is_hertz(finished):
    """Case HZ-1, and HZ-3 below the surface; 38 cells per contact radius."""
    summary = read(finished("hertz"))
    a, p0, approach = hertz.hertz_sphere(0.65, 105e-6, STEEL)
    stress, depth = hertz.max_von_mises(0.3)
    assert summary["max_pressure"] == close(p0, rel=5e-3)
    assert summary["approach"] == close(approach, rel=5e-3)
    assert summary["contact_radius"] == close(a, rel=5e-3)
    assert summary["max_von_mises"] == close(stress * p0, rel=1e-2)
    assert abs(summary["max_von_mises_depth"] - depth * a) <= 15e-6 / 60


def test_the_ellipse_is_that_of_hertz(finished):
    summary = read(finished("hertz-ellipse"))
    a, b, p0, approach = hertz.hertz_ellipse(2.0, 1e-3, 0.25e-3, STEEL)
    assert summary["max_pressure"] == close(p0, rel=5e-3)
    assert summary["approach"] == close(approach, rel=5e-3)
    assert summary["contact_area"] == close(np.pi * a * b, rel=1e-2)
    with ec.open_results(finished("hertz-ellipse")) as data:
        y, x = np.meshgrid(data.y, data.x, indexing="ij")
        closed = hertz.pressure(x, y, a, b, p0)
        difference = np.linalg.norm(data.pressure[-1] - closed) / np.linalg.norm(closed)
        np.testing.assert_allclose(data.reference_pressure[-1], closed, atol=1e-9 * p0)
    assert difference < 0.02  # cells at the edge of contact, where the slope is infinite


def test_the_punch_tilts_as_a_flat_punch_of_its_contact_radius(finished):
    """Contact radius from the profile alone by quadrature; tilt from the stiffness of a flat punch, 4 E* a^3 / 3."""
    b, R, load = 100e-6, 1e-3, 10.0

    def depth(t):  # approach at which the contact radius is t: t times the integral of h'(r)/sqrt(t^2 - r^2)
        return t / R * quad(lambda s: t * np.cos(s) - b, 0.0, np.arccos(b / t))[0] if t > b else 0.0

    def force(a):
        return 2 * STEEL * (a * depth(a) - quad(depth, b, a)[0])

    a = brentq(lambda a: force(a) - load, 1.01 * b, 1.5 * b, xtol=1e-12)
    assert a == close(107.635e-6, rel=1e-5)  # what the scene's description says
    first, second, third = read(finished("tilted-punch"))["history"]
    assert first["contact_radius"] == close(a, rel=1e-2)
    assert first["approach"] == close(depth(a), rel=5e-3)
    assert first["tilt_y"] == 0.0
    slope = 3.0 / (4.0 * STEEL * a**3)
    assert second["moment_y"] == close(120e-6, rel=1e-6)
    assert second["tilt_y"] == close(slope * 120e-6, rel=1e-2)
    assert third["tilt_y"] == close(slope * 240e-6, rel=2e-2)
    with ec.open_results(finished("tilted-punch")) as data:
        moment = -float((data.pressure[-1] * data.x).sum()) * float((data.x[1] - data.x[0]) * (data.y[1] - data.y[0]))
    assert moment == close(240e-6, rel=1e-6)


def test_ribs_of_a_roller_grow_together(finished):
    """The bundled scene: one rib alone at first; at last a smooth roller in the mean, and one period below it."""
    modulus, period = 0.5 * STEEL, 100e-6
    with ec.open_results(finished("ribbed-roller")) as data:
        x, pressure, peaks = data.x.values, data.pressure.values[-1], data.max_pressure.values
        depth, stress = data.across_z.values, data.across_stress.values[-1, 2]
    along, across, alone, _ = hertz.hertz_ellipse(0.1, 10e-3, 5e-3, modulus)
    assert (along, across, alone) == (close(20.80e-6, rel=1e-3), close(13.12e-6, rel=1e-3), close(175.0e6, rel=1e-3))
    assert peaks[0] == close(alone, rel=0.03)  # three cells to the shorter semi-axis
    a, p0 = hertz_cylinder(40.0 / period, 10e-3, modulus)
    mean = pressure.mean(axis=0)
    smooth = p0 * np.sqrt(np.maximum(0.0, 1.0 - (x / a) ** 2))
    assert np.sqrt(np.mean((mean - smooth) ** 2)) < 0.03 * p0
    assert pressure[:, 64].min() < 0.4 * p0 < 1.15 * p0 < pressure[:, 64].max()
    below = depth > period
    assert np.abs(stress[below].mean(axis=1) + p0 / np.sqrt(1.0 + (depth[below] / a) ** 2)).max() < 0.01 * p0
    assert np.ptp(stress[below], axis=1).max() < 0.01 * p0 < np.ptp(stress[depth < 0.3 * period], axis=1).min()


def test_the_rough_contact_obeys_the_laws_of_contact(finished):
    """Gap at 300 cells by superposing Love's rectangles (no FFT, no plugin): open, or closed and loaded."""
    with np.load(_bundled("rough_surface.npz")) as file:
        heights, edge = file["heights"].astype(float), float(file["dx"])
    with ec.open_results(finished("rough-surface")) as data:
        pressure, approach = data.pressure.values[-1], float(data.approach[-1])
        y, x = np.meshgrid(data.y, data.x, indexing="ij")
    separation = heights.max() - heights + (x**2 + y**2) / 2e-3
    loaded = np.flatnonzero(pressure > 0)
    random = np.random.default_rng(7)
    targets = np.concatenate([random.choice(loaded, 150), random.choice(pressure.size, 150)])
    x, y, load = x.ravel(), y.ravel(), pressure.ravel()[loaded]
    deflection = np.array([_love(x[k] - x[loaded], y[k] - y[loaded], edge / 2) @ load for k in targets])
    gap = (separation.flat[targets] + deflection / (np.pi * STEEL) - approach) / approach
    closed = pressure.flat[targets] > 0
    assert closed.sum() >= 150
    assert np.abs(gap[closed]).max() < 3e-6
    assert gap[~closed].min() > -3e-6
    assert pressure.sum() * edge**2 == close(0.5, rel=1e-9)


def test_the_random_surface_touches_in_proportion_to_the_load(finished):
    """Between the theories of Persson and of Bush, Gibson and Thomas; and 2.042 on cells of a quarter (once).

    The contact itself by a transform that is nothing of the program's: a wave of pressure p deflects 2 p / (E* q).
    """
    modulus, slope, side = 10e6 / (1 - 0.5**2), 0.1, 64e-6
    with ec.open_results(finished("random-rough")) as data:
        pressure, gap = data.pressure.values[-1], data.gap.values[-1]
        displacement, mean = data.displacement_z.values[-1], data.pressure.values.mean((1, 2))
    share = np.array([row["contact_area"] for row in read(finished("random-rough"))["history"]]) / side**2
    factor = share * modulus * slope / mean
    assert mean * side**2 == close(273e-6 * np.arange(1, 4) / 3, rel=1e-6)
    assert (factor > np.sqrt(8 / np.pi)).all()
    assert (factor < np.sqrt(2 * np.pi)).all()
    assert (np.diff(factor) < 0).all()
    assert factor[-1] == close(2.042, rel=0.02)
    q = 2 * np.pi / side * np.hypot(np.fft.fftfreq(256, 1 / 256)[:, None], np.fft.fftfreq(256, 1 / 256)[None, :])
    surface = np.fft.fft2(gap - displacement)
    assert np.sqrt(np.sum(np.abs(q * surface / q.size) ** 2)) == close(slope, rel=1e-9)
    q[0, 0] = np.inf
    assert displacement == close(np.fft.ifft2(2 * np.fft.fft2(pressure) / (modulus * q)).real, abs=1e-6 * gap.max())
    assert np.abs(gap[pressure > 0]).max() < 1e-6 * displacement.max()
    assert gap.min() > -1e-6 * displacement.max()


def _love(x, y, c):
    """Integral of 1/r over squares of half side c at offsets x, y (A. E. H. Love 1929; Johnson 1985, eq. 3.25)."""
    total = np.zeros_like(x)
    for sx in (1, -1):
        for sy in (1, -1):
            u, v = x + sx * c, y + sy * c
            total += sx * sy * (u * np.arcsinh(v / np.abs(u)) + v * np.arcsinh(u / np.abs(v)))
    return total


def _bundled(name):
    from importlib.resources import files

    return files("eigencontact") / "gallery" / name


def test_dissimilar_spheres(finished):
    modulus = 1 / ((1 - 0.3**2) / 210e9 + (1 - 0.22**2) / 70e9)
    a, p0, approach = hertz.hertz_sphere(5.0, 1 / (1 / 5e-3 + 1 / 10e-3), modulus)
    summary = read(finished("dissimilar-spheres"))
    assert summary["contact_modulus"] == close(modulus, rel=1e-12)
    assert summary["max_pressure"] == close(p0, rel=5e-3)
    assert summary["approach"] == close(approach, rel=5e-3)
    assert summary["contact_radius"] == close(a, rel=1e-2)
    assert summary["max_von_mises"] == close(hertz.max_von_mises(0.22)[0] * p0, rel=1e-2)
    with ec.open_results(finished("dissimilar-spheres")) as data:
        for name, ratio in (("steel", 0.3), ("glass", 0.22)):
            largest = data[f"{name}_von_mises"][-1]
            stress, depth = hertz.max_von_mises(ratio)
            assert float(largest.max()) == close(stress * p0, rel=1e-2)
            row, _ = np.unravel_index(int(np.argmax(largest.values)), largest.shape)
            found = float(data[f"{name}_z"][row])
            assert abs(found - depth * a) <= 120e-6 / 80
        # Outside the contact each surface moves inwards by (1 - 2 nu)(1 + nu) p0 a^2 / (3 E r) (Johnson 1985, 3.4).
        inward = [(1 - 2 * nu) * (1 + nu) / (3 * E) * p0 * a**2 for E, nu in ((210e9, 0.3), (70e9, 0.22))]
        y, x = np.meshgrid(data.y, data.x, indexing="ij")
        r = np.hypot(x, y)
        outside = r > 1.1 * a
        radial = (data.displacement_x[-1].values * x + data.displacement_y[-1].values * y) / r
        np.testing.assert_allclose(radial[outside] * r[outside], inward[1] - inward[0], rtol=5e-3)
