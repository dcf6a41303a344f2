"""Bundled scenes of inhomogeneities under a contact, on coarser cells, against references and against each other."""

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact.scene.loader import bundled_names
from eigencontact_verification.oracles import hertz
from eigencontact_verification.oracles.ball_under_contact import ball_under_contact
from eigencontact_verification.reporting.memory import PeakMemory

UM = 1e-6
#: Contact radius [m] and peak pressure [Pa] of the sphere of 105 um on steel under 0.65 N.
A, P0, _ = hertz.hertz_sphere(0.65, 105 * UM, 210e9 / 0.91)

#: Coarser cells, and the stress regions that are kept: by number, with depths that are looked at.
COARSER = {
    "ellipsoid-under-contact": (["grid.cells=30", "grid.spacing=['2.4 um', '2.4 um']"], {}),
    "inclusion-cluster": (
        ["grid.cells=24", "grid.spacing=['0.58 um', '0.58 um']", "numerics.inclusion-pitch='0.58 um'"], {}
    ),
    "inclusion-under-contact": (["grid.cells-per-contact-radius=20", "grid.margin=1.25"], {0: [1.0, 3.0267]}),
    "prestressed-concrete": (
        ["grid.cells=[16, 36]", "grid.spacing=['5 mm', '1.39 mm']", "numerics.inclusion-pitch='2.5 mm'"], {}
    ),
    "rolling-over-inclusion": (
        ["grid.cells=[91, 37]", "grid.spacing=['0.45 um', '0.45 um']", "steps.1.increments=8"], {1: None}
    ),
    "two-inclusions": (["grid.cells-per-contact-radius=20", "grid.margin=1.25"], {}),
    "void-under-contact": (["grid.cells-per-contact-radius=20", "grid.margin=1.25"], {0: [0.1, 1.7, 3.0267]}),
    "void-near-surface": (
        ["grid.cells-per-contact-radius=20", "grid.margin=1.25", "stress.0.position='0.154 um'"], {0: [0.1, 1.665, 4.0]}
    ),
}  # fmt: skip


def coarse(name, *changes):
    """Table of a coarser copy."""
    settings, kept = COARSER[name]
    table = ec.load_scene(name, [*settings, "output.pictures=false", "numerics.tolerance=1e-5", *changes]).resolved()
    regions = []
    for number, depths in kept.items():
        region = table["stress"][number]
        if depths is not None:
            region.pop("depth-max", None)
            region["depths"] = [depth * UM for depth in depths]
        regions.append(region)
    return {**table, "stress": regions}


@pytest.fixture
def finished(finished):
    """Run a bundled scene on coarser cells."""
    return lambda name: finished(ec.Scene(**coarse(name)))


def last(result):
    return result.dataset.pressure.isel(step=-1).values


def mirrored(field, *axes):
    np.testing.assert_allclose(field, np.flip(field, axes), rtol=0, atol=2e-4 * np.abs(field).max())


def test_every_bundled_inhomogeneity_is_tested():
    """Where all is elastic; what yields is in test_gallery_plastic.py."""

    def elastic(scene):
        return (
            scene.body1.law is None
            and scene.wear is None
            and not any("hardening" in (one.material or {}) for one in scene.inclusions)
        )

    scenes = {name: ec.load_scene(name) for name in bundled_names()}
    stiff = [name for name, scene in scenes.items() if any(one.material for one in scene.inclusions) and elastic(scene)]
    assert sorted(COARSER) == stiff


def test_inclusion_under_contact(finished):
    """IC-3; the ball carries more than the steel beside it; the homogeneous pressure stands beside."""
    result = finished("inclusion-under-contact")
    assert result.summary["max_pressure"] / P0 == close(1.054, rel=0.01)
    assert result.summary["inclusion_residual"] < 1e-4
    pressure = last(result)
    mirrored(pressure, 0)
    mirrored(pressure, 1)
    data = result.dataset.isel(step=-1)
    assert "reference_pressure" not in data
    assert float(data.homogeneous_pressure.max()) == close(P0, rel=0.002)
    row = data.section_von_mises.sel(section_z=3.0267 * UM, method="nearest")
    inside, beside = (float(row.sel(section_x=x, method="nearest")) for x in (0.0, 1.7 * UM))
    assert inside > 1.2 * beside


@pytest.mark.slow
@pytest.mark.parametrize("changes", [(), None], ids=["coarse", "as bundled"])
def test_inclusion_cluster(changes, finished):
    """IC-1: 22 % above the peak of a homogeneous body, within 10 %; a peak above the ball in the middle."""
    if changes is None:
        table = ec.load_scene("inclusion-cluster", ["output.pictures=false"]).resolved()
        memory = PeakMemory()  # the summary's figure is that of this process and all that it ran before
        result = ec.run(ec.Scene(**{**table, "stress": []}))
        assert (memory.peak() or 0) < 1.5e9
    else:
        result = finished("inclusion-cluster")
    assert result.summary["max_pressure"] / P0 == close(1.22, rel=0.10)
    assert result.summary["contact_radius"] < 0.98 * A
    pressure = last(result)
    np.testing.assert_allclose(pressure, pressure.T, rtol=0, atol=2e-4 * pressure.max())
    data = result.dataset
    above, between = (float(data.pressure.isel(step=-1).sel(x=x, y=0.2 * UM, method="nearest")) for x in (0.2 * UM, UM))
    assert above > 1.05 * between


def test_two_inclusions(finished):
    """IC-10: the peak above the ball hardly feels the void beside it; it is 1.20 of that of a homogeneous body."""
    result = finished("two-inclusions")
    table = coarse("two-inclusions")
    alone = ec.run(ec.Scene(**{**table, "inclusions": table["inclusions"][:1]}))
    assert alone.summary["max_pressure"] / P0 == close(1.20, rel=0.02)
    assert result.summary["max_pressure"] == close(alone.summary["max_pressure"], rel=0.02)
    mirrored(last(result), 0)
    along = result.dataset.pressure.isel(step=-1).sel(y=0.0, method="nearest")
    assert float(along.sel(x=1.77 * UM, method="nearest")) < 0.6 * P0


def middle_of(pressure):
    """Pressure on the axis, from means over cells around it: a polynomial of degree 4 in the distance, in cells."""
    ny, nx = pressure.shape
    y, x = np.ogrid[:ny, :nx]
    squared = (x - (nx - 1) / 2) ** 2 + (y - (ny - 1) / 2) ** 2 + 1 / 6  # mean over a cell
    near = squared < 10.0
    (value, _, _), *_ = np.linalg.lstsq(np.vander(squared[near], 3, increasing=True), pressure[near])
    return value


@pytest.mark.slow
@pytest.mark.parametrize(("changes", "bound"), [((), 0.015), (None, 8e-3)], ids=["coarse", "as bundled"])
def test_void_near_surface(changes, bound, finished):
    """The roof carries 0.1767 of p0 in the middle, by the oracle of degree 16; nothing is stressed within the void."""
    if changes is None:
        result = ec.run(ec.load_scene("void-near-surface", ["output.pictures=false"]))
    else:
        result = finished("void-near-surface")
    pressure = last(result)
    mirrored(pressure, 0)
    mirrored(pressure, 1)
    oracle = ball_under_contact(radius=0.25, depth=0.3, nu=0.3, ratio=0.0, degree=16)
    assert abs(middle_of(pressure) / P0 - oracle.central_pressure) < bound
    assert pressure.max() / P0 == close(oracle.pressure(np.linspace(0.0, 1.0, 401)).max(), rel=5e-3)
    total = pressure.sum() * float(np.prod(result.dataset.attrs["cell_size"]))
    assert total == close(0.65, rel=1e-6)
    field = result.dataset.section_von_mises.isel(step=-1)
    assert np.isfinite(field.values).all()
    z, x = np.meshgrid(field.section_z.values, field.section_x.values, indexing="ij")
    inside = np.hypot(x, z - 1.816 * UM) < 1.5 * UM
    assert inside.any()
    assert not field.values[inside].any()


@pytest.mark.parametrize(
    ("changes", "bound"), [((), 0.03), pytest.param(None, 0.01, marks=pytest.mark.slow)], ids=["coarse", "as bundled"]
)
def test_void_under_contact(changes, bound, finished):
    """The theory page's 0.23068 in the middle; the void bears nothing up to its border, and the section mirrors."""
    if changes is None:
        result = ec.run(ec.load_scene("void-under-contact", ["output.pictures=false"]))
    else:
        result = finished("void-under-contact")
    pressure = last(result)
    mirrored(pressure, 0)
    np.testing.assert_allclose(pressure, pressure.T, rtol=0, atol=2e-4 * pressure.max())
    assert middle_of(pressure) / P0 == close(0.23068, rel=bound)
    assert 1e-4 < result.summary["degree_pressure_error"] / P0 < 2e-3  # degrees 6 and 16 differ by 2e-4
    field = result.dataset.section_von_mises.isel(step=-1)
    mirrored(field.values, 1)
    z, x = np.meshgrid(field.section_z.values, field.section_x.values, indexing="ij")
    outside = np.hypot(x, z - 3.0267 * UM) > 1.9977 * UM
    assert np.array_equal(field.values > 0.0, outside)


@pytest.mark.slow
def test_void_under_contact_of_cells_without_end():
    """Second order in the cells: twice as many leave what degree 6 leaves."""
    coarse, fine = (
        middle_of(last(ec.run(ec.load_scene("void-under-contact", [*changes, "stress=[]", "output.pictures=false"]))))
        for changes in (["grid.cells-per-contact-radius=20"], [])
    )
    assert (4 * fine - coarse) / 3 / P0 == close(0.23068, rel=0.002)


@pytest.mark.slow
def test_ellipsoid_under_contact(finished):
    """A body of revolution under another: the same along x and y; stiffer, so a higher peak on a smaller contact."""
    result = finished("ellipsoid-under-contact")
    pressure = last(result)
    mirrored(pressure, 0)
    np.testing.assert_allclose(pressure, pressure.T, rtol=0, atol=2e-4 * pressure.max())
    assert 1.1 < result.summary["max_pressure"] / 14.691e9 < 2**0.5  # less than twice the modulus everywhere would give
    assert 0.85 < result.summary["contact_radius"] / 20e-6 < 1.0


@pytest.mark.slow
def test_prestressed_concrete(finished):
    """As in PB-2 two extrema of the pressure across the bars, one along them."""
    pressure = last(finished("prestressed-concrete"))
    mirrored(pressure, 0)
    mirrored(pressure, 1)
    ny, nx = pressure.shape
    across, along = pressure[:, nx // 2], pressure[ny // 2]

    def peaks(line):
        return int(np.sum((line[1:-1] > line[:-2]) & (line[1:-1] > line[2:]) & (line[1:-1] > 0.5 * line.max())))

    assert peaks(across) == 2
    assert np.all(np.diff(along[nx // 2 :]) <= 0)
    assert 1.1 < pressure.max() / 55.96e6 < 1.5  # stresses that concrete bears


@pytest.mark.slow
def test_rolling_over_inclusion(finished):
    """The history there mirrors that away; above the ball it is the sphere at rest on it (IC-3), far away Hertz."""
    result = finished("rolling-over-inclusion")
    data = result.dataset
    places, peaks = data.travel_x.values, data.max_pressure.values
    np.testing.assert_allclose(places, np.linspace(-12 * UM, 12 * UM, 9), rtol=0, atol=1e-12)
    np.testing.assert_allclose(peaks, peaks[::-1], rtol=1e-4)
    history = data.ball_von_mises.values
    np.testing.assert_allclose(history[:, :3], history[::-1, :3], rtol=2e-4)
    assert not np.allclose(history[:, 3], history[::-1, 3], rtol=0.1, atol=0)  # the point before the ball
    assert peaks[[0, -1]] / P0 == close([1.0, 1.0], rel=0.005)
    assert peaks[4] / P0 == close(1.054, rel=0.01)
    table = coarse("rolling-over-inclusion")
    still = ec.run(ec.Scene(**{**table, "steps": [{"normal-load": 0.65}]}))
    assert peaks[4] == close(still.summary["max_pressure"], rel=1e-4)
    np.testing.assert_allclose(history[4], still.dataset.ball_von_mises.values[-1], rtol=1e-4)
