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
    "rounded-line-punch": ["grid.cells=256", "stress.0.depth-cells=40"],
}


def test_every_bundled_line_contact_is_tested():
    assert [name for name in bundled_names() if ec.load_scene(name).grid.line] == sorted(COARSER)


@pytest.mark.parametrize("name", COARSER)
def test_certificates_units_and_pictures(name, finished):
    result = finished(name, *COARSER[name], stored=True)
    summary = result.summary
    assert max(summary[f"{residual}_residual"] for residual in ("gap", "penetration", "load")) <= 1e-6
    assert (summary["units"]["normal_load"], summary["units"]["contact_area"]) == ("N/m", "m")
    pictures = {path.name for path in result.folder.glob("*.png")}
    assert {"pressure-profiles.png", "section.png"} <= pictures
    assert not {"pressure.png", "shear.png"} & pictures  # one row of cells has curves, no maps


def test_fretting_of_a_cylinder(finished):
    """Hertz, and Cattaneo's shear at the first turn; the stress of the description is that of `test_line_contacts`."""
    result = finished("cylinder-fretting", *COARSER["cylinder-fretting"], stored=True)
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


def test_punch_with_rounded_edges(finished):
    result = finished("rounded-line-punch", *COARSER["rounded-line-punch"], stored=True)
    b, load, pressure = 1e-3, 2834.7e3, result.dataset.pressure.values[-1, 0]
    x = result.dataset.x.values
    inside = np.abs(x) < 1.9 * b
    expected = rounded_punch_pressure(x[inside] / b, np.arcsin(0.5)) * load / b
    assert result.summary["contact_radius"] == close(2.0 * b, rel=1e-3)
    np.testing.assert_allclose(pressure[inside], expected, rtol=0, atol=0.01 * expected.max())
    assert pressure.max() == close(0.3352 * load / b, rel=1e-3)
