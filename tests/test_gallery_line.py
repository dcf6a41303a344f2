"""Bundled scenes of line contacts: run, certified, and close to the closed forms that their descriptions name."""

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact.scene.loader import bundled_names
from eigencontact_verification.oracles.line_contact import (
    cattaneo_shear,
    cattaneo_stick,
    hertz_cylinder,
    rounded_punch_pressure,
)

#: Coarser cells and fewer increments, so that each scene takes a part of a second.
COARSER = {
    "cylinder-fretting": ["grid.cells-per-contact-radius=64", *(f"steps.{k}.increments=4" for k in (1, 2, 3))],
    "coated-cylinder": ["grid.cells-per-contact-radius=24", "stress.0.depth-cells=6"],
    "plastic-line-contact": [
        "grid.cells-per-contact-radius=10",
        "numerics.inclusion-pitch=20 um",
        "stress.0.depth-cells=15",
        *(f"steps.{k}.increments={n}" for k, n in ((0, 1), (1, 4), (2, 2))),
    ],
    "rounded-line-punch": ["grid.cells=256", "stress.0.depth-cells=40"],
}


def test_every_bundled_line_contact_is_tested():
    assert [name for name in bundled_names() if ec.load_scene(name).grid.line] == sorted(COARSER)


#: Scene whose pictures are drawn by default: they cost as much as the run.
DRAWN = "cylinder-fretting"


@pytest.fixture
def finished(finished):
    """Run a bundled scene on coarser cells, in a folder."""

    def run(name, *, drawn=False):
        plain = [] if drawn or name == DRAWN else ["output.pictures=false"]
        return finished(name, *COARSER[name], *plain, stored=True)

    return run


@pytest.mark.parametrize("name", COARSER)
def test_certificates_and_units(name, finished):
    summary = finished(name).summary
    assert max(summary[f"{residual}_residual"] for residual in ("gap", "penetration", "load")) <= 1e-6
    assert (summary["units"]["normal_load"], summary["units"]["contact_area"]) == ("N/m", "m")


@pytest.mark.parametrize(
    "name", [DRAWN, *(pytest.param(name, marks=pytest.mark.slow) for name in COARSER if name != DRAWN)]
)
def test_pictures(name, finished):
    result = finished(name, drawn=True)
    pictures = {path.name for path in result.folder.glob("*.png")}
    assert {"pressure-profiles.png", "section.png"} <= pictures
    assert not {"pressure.png", "shear.png"} & pictures  # one row of cells has curves, no maps


def test_fretting_of_a_cylinder(finished):
    """Hertz, and Cattaneo's shear at the first turn; the stress of the description is that of `test_line_contacts`."""
    result = finished("cylinder-fretting")
    summary, data = result.summary, result.dataset
    a, p0 = hertz_cylinder(400e3, 0.01, 0.5 * 119e9 / (1 - 0.3**2))
    assert (a, p0) == (close(279.09e-6, rel=1e-5), close(912.42e6, rel=1e-5))
    assert summary["contact_radius"] == close(a, rel=2e-3)
    assert summary["max_pressure"] == close(p0, rel=1e-4)
    c = cattaneo_stick(1.0, 0.6 * 0.8, 0.8)
    turn = int(np.argmax(data.tangential_load_x.values))
    expected = cattaneo_shear(data.x.values, a, p0, 0.8, c)
    error = data.shear_x.values[turn, 0] - expected
    assert np.sqrt(np.mean(error**2)) < 5e-3 * 0.8 * p0
    assert float(data.stick_radius[turn]) == close(c * a, abs=a / 64)


def test_coated_cylinder_lies_between_its_materials(finished):
    summary = finished("coated-cylinder").summary
    substrate, coating = (hertz_cylinder(200e3, 0.01, E / (1 - nu**2)) for E, nu in ((210e9, 0.3), (400e9, 0.25)))
    assert substrate == (close(105.0e-6, rel=1e-3), close(1212e6, rel=1e-3))
    assert coating == (close(77.3e-6, rel=1e-3), close(1648e6, rel=1e-3))
    assert 1.02 * coating[0] < summary["contact_radius"] < 0.98 * substrate[0]
    assert 1.02 * substrate[1] < summary["max_pressure"] < 0.98 * coating[1]


def test_a_print_stays_below_a_cylinder(finished):
    """The first step is elastic, at 109 of 109.5 N/mm; unloading leaves a print."""
    data = finished("plastic-line-contact").dataset
    a, p0 = hertz_cylinder(109e3, 0.01, 210e9 / (1 - 0.3**2))
    assert p0 == close(1.7936 * 500e6, rel=5e-3)
    assert float(data.max_plastic_strain[0]) == 0.0
    assert float(data.max_pressure[0]) == close(p0, rel=0.01)
    assert float(data.contact_radius[0]) == close(a, rel=0.02)
    assert float(data.normal_load[-1]) == 0.0
    assert 0.2 < float(data.print_depth[-1] / data.approach.max()) < 0.6
    depth, stress = data.section_z.values, data.section_stress.values[-1]
    middle = 0.5 * (stress[0][:, stress.shape[2] // 2] + stress[0][:, (stress.shape[2] - 1) // 2])
    assert middle.min() < -50e6 < 0.0  # compressed along x where the body has flowed most
    assert depth[int(middle.argmin())] > 0.0


def test_punch_with_rounded_edges(finished):
    result = finished("rounded-line-punch")
    b, load, pressure = 1e-3, 2834.7e3, result.dataset.pressure.values[-1, 0]
    x = result.dataset.x.values
    inside = np.abs(x) < 1.9 * b
    expected = rounded_punch_pressure(x[inside] / b, np.arcsin(0.5)) * load / b
    assert result.summary["contact_radius"] == close(2.0 * b, rel=1e-3)
    np.testing.assert_allclose(pressure[inside], expected, rtol=0, atol=0.01 * expected.max())
    assert pressure.max() == close(0.3352 * load / b, rel=1e-3)
