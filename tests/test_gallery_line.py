"""Bundled scenes of line contacts: run, certified, and close to the closed forms that their descriptions name."""

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact.scene.loader import bundled_names
from eigencontact.viz.surface import displacement_profiles
from eigencontact_verification.oracles.bulk_slip import moved_stick_zone
from eigencontact_verification.oracles.line_contact import (
    cattaneo_shear,
    cattaneo_stick,
    hertz_cylinder,
    hertz_pressure,
    hertz_stress,
    rounded_punch_pressure,
    stress_under,
)


def turns(increments, parts):
    """Changes of a scene whose third table is a cycle: increments of each of its parts."""
    return [f"steps.2.cycle.{part}.increments={increments}" for part in range(parts)]


#: Coarser cells and fewer increments, so that each scene takes a part of a second.
COARSER = {
    "cylinder-fretting": ["grid.cells-per-contact-radius=64", *(f"steps.{k}.increments=4" for k in (1, 2, 3))],
    "cylinder-fretting-plastic": [
        "grid.cells-per-contact-radius=12",
        "stress.0.depth-max=300 um",
        "steps.0.increments=6",
        *(f"steps.1.cycle.{part}.increments={count}" for part, count in ((0, 2), (1, 4), (2, 2))),
        "steps.1.repeat=1",
        "steps.2.increments=2",
    ],
    "cylinder-on-bone": [
        "grid.cells-per-contact-radius=10",
        "numerics.inclusion-pitch=40 um",
        "stress.0.depth-max=880 um",
        "steps.1.increments=4",
        "steps.2.increments=2",
    ],
    "fretting-fatigue": [
        "grid.cells-per-contact-radius=64",
        "stress.0.depth-cells=30",
        "steps.1.increments=4",
        *turns(6, 2),
    ],
    "fretting-fatigue-out-of-phase": [
        "grid.cells-per-contact-radius=64",
        "stress.0.depth-cells=6",
        "steps.1.increments=4",
        *turns(3, 4),
        "steps.2.repeat=1",
    ],
    # 24 cells per contact radius, written out: the search for them takes longer than all the rest with layers.
    "coated-cylinder": [
        "grid={length='infinite', cells=72, spacing=4.026624891493055e-06}",
        "stress.0.depth-cells=6",
    ],
    "plastic-line-contact": [
        "grid.cells-per-contact-radius=10",
        "numerics.inclusion-pitch=20 um",
        *(f"steps.{k}.increments={n}" for k, n in ((0, 1), (1, 4), (2, 2))),
    ],
    "rolling-line": ["grid.cells=81", "grid.spacing=26.25 um", "stress.0.depth-cells=30"],
    "rounded-line-punch": ["grid.cells=256", "stress.0.depth-cells=40"],
}
#: Scenes that run with the slow tests: each takes a second or more.
LONG = {"coated-cylinder", "cylinder-fretting-plastic", "cylinder-on-bone"}


def test_every_bundled_line_contact_is_tested():
    assert [name for name in bundled_names() if ec.load_scene(name).grid.line] == sorted(COARSER)


#: Scene whose pictures are drawn by default: they cost as much as the run.
DRAWN = "cylinder-fretting"


@pytest.fixture
def finished(finished):
    """Run a bundled scene on coarser cells, in a folder."""

    def run(name, *changes, drawn=False):
        plain = [] if drawn or name == DRAWN else ["output.pictures=false"]
        return finished(name, *COARSER[name], *changes, *plain, stored=True)

    return run


@pytest.mark.parametrize("name", [pytest.param(n, marks=[pytest.mark.slow] * (n in LONG)) for n in COARSER])
def test_certificates_and_units(name, finished):
    summary = finished(name).summary
    assert max(summary[f"{residual}_residual"] for residual in ("gap", "penetration", "load")) <= 1e-6
    assert (summary["units"]["normal_load"], summary["units"]["contact_area"]) == ("N/m", "m")


@pytest.mark.usefixtures("small_pictures")
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


def bulk_slip_shear(x, a, p0, stick, middle):
    """Shear at full load, 0.8 p less that of the stick zone, whose middle lies beside that of the contact."""
    return 0.8 * (hertz_pressure(x, a, p0) - hertz_pressure(np.asarray(x) - middle, stick * a, stick * p0))


def test_fretting_fatigue_in_phase(finished):
    """Shear and stick zone by Nowell and Hills, and the stress of their tractions near the hot spot, at both turns."""
    result = finished("fretting-fatigue")
    data, modulus = result.dataset, 119e9 / (1 - 0.3**2)
    a, p0 = hertz_cylinder(400e3, 0.01, 0.5 * modulus)
    c = cattaneo_stick(400.0, 150.0, 0.8)
    middle = moved_stick_zone(200e6 / modulus, a, 0.8, p0, modulus)
    assert (c, middle / a) == (close(0.7289, abs=5e-5), close(0.0685, abs=5e-5))
    x, full, back = data.x.values, 4, 10
    for step, sign in ((full, 1.0), (back, -1.0), (16, 1.0)):
        assert data.bulk_stress_xx.values[step] == sign * 200e6
        error = sign * data.shear_x.values[step, 0] - bulk_slip_shear(x, a, p0, c, middle)
        assert np.sqrt(np.mean(error**2)) < 1e-2 * 0.8 * p0
        sticks = x[data.contact_zone.values[step, 0] == 2]
        assert 0.5 * (sticks[0] + sticks[-1]) == close(middle, abs=a / 64)
    assert result.summary["fatigue_crossland_x"] == close(-a, rel=0.05)  # the trailing edge while the machine pulls
    column = int(np.argmin(np.abs(x + a)))
    for step, sign in ((full, 1.0), (back, -1.0)):
        expected = stress_under(
            lambda s: hertz_pressure(s, a, p0), lambda s, sign=sign: sign * bulk_slip_shear(s, a, p0, c, middle),
            float(x[column]), 20e-6, (-a, middle - c * a, middle + c * a, a),
        )  # fmt: skip
        expected[0] += sign * 200e6
        stress = data.section_stress.values[step][[0, 2, 4], 2, column]
        np.testing.assert_allclose(stress, expected, rtol=0, atol=0.01 * p0)


def test_fretting_fatigue_out_of_phase(finished):
    """The stick zone while the fretting load passes through zero: partial unloading at twice the friction."""
    data = finished("fretting-fatigue-out-of-phase").dataset
    modulus = 119e9 / (1 - 0.3**2)
    a, p0 = hertz_cylinder(400e3, 0.01, 0.5 * modulus)
    middle, half_width = moved_stick_zone(200e6 / modulus, a, 2 * 0.8, p0, modulus), np.sqrt(1 - 150 / (2 * 320))
    assert (half_width, middle / a) == (close(0.875, abs=5e-5), close(0.0342, abs=6e-5))
    x = data.x.values
    for step, bulk in ((7, 200e6), (13, -200e6)):  # the change of bulk stress opposes that of the load
        assert abs(data.tangential_load_x.values[step]) < 1e-6
        assert data.bulk_stress_xx.values[step] == bulk
        sticks = x[data.contact_zone.values[step, 0] == 2]
        assert 0.5 * (sticks[0] + sticks[-1]) == close(-middle, abs=a / 64)
        assert np.ptp(sticks) / (2 * a) == close(half_width, abs=1.5 / 64)


@pytest.mark.slow
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
    yield_stress = 500e6 + 5e9 * float(data.max_plastic_strain[-1])
    assert float(data.section_von_mises[-1].max()) < yield_stress  # at cell centres; on their faces strain steps


@pytest.mark.slow
def test_fretting_beyond_yield(finished):
    """The surface flows at both ends of the stick zone, and most in the first strokes; the loop takes up all work."""
    result = finished("cylinder-fretting-plastic")
    data = result.dataset
    loads, strain = data.tangential_load_x.values, data.max_plastic_strain.values
    pressed, pulled = 5, int(np.argmax(loads))
    assert strain[pressed] < 2e-4 < 20 * strain[pressed] < strain[pulled]
    cells, x = data.equivalent_plastic_strain_1.values[-1, 0, 0], data.cells_1_x.values
    peaks = [float(x[x < 0][cells[x < 0].argmax()]), float(x[x > 0][cells[x > 0].argmax()])]
    a, _ = hertz_cylinder(400e3, 0.01, 0.5 * 119e9 / (1 - 0.3**2))
    assert np.abs(peaks) == close([0.75 * a, 0.75 * a], abs=0.15 * a)
    assert float(data.plastic_zone_volume[-1]) == close(float(data.plastic_volume[-1]), rel=1e-6)  # per metre
    assert float(data.plastic_work[-1]) > 0.0 < float(data.dissipated_energy[-1])
    (panel,) = displacement_profiles(data).axes
    assert panel.get_legend_handles_labels()[1] == ["uplift $-u_z$", "$u_x$"]  # u_y is zero in plane strain


@pytest.mark.slow
def test_damage_below_a_cylinder(finished):
    """The first step is elastic, at 49 of 49.5 N/mm; damage is that of the strain; it leaves less stress and print."""
    modulus = 18.6e9 / (1 - 0.3**2)
    p0 = hertz_cylinder(49.45e3, 0.01, modulus)[1]
    assert p0 == close(1.7936 * 100e6, rel=1e-3)
    damaged, sound = finished("cylinder-on-bone"), finished("cylinder-on-bone", "body1.law.damage.saturation=0")
    data = damaged.dataset
    assert float(data.max_plastic_strain[0]) == 0.0
    a = hertz_cylinder(49e3, 0.01, modulus)[0]
    assert float(data.contact_radius[0]) == close(a, rel=0.01)  # a twentieth of a cell
    assert data.damage_1.values == close(0.6 * (1 - np.exp(-data.equivalent_plastic_strain_1.values / 0.02)), abs=1e-9)
    assert float(data.max_pressure.max()) == close(234e6, rel=0.02)  # by 12 increments, not 4
    assert 0.8 < damaged.summary["print_depth"] / sound.summary["print_depth"] < 0.95
    deepest = [run.dataset.section_stress.values[-1, 0, 4:].min() for run in (damaged, sound)]  # away from the edge
    assert 0.8 < deepest[0] / deepest[1] < 0.92


def test_criteria_below_a_rolling_cylinder(finished):
    """Converged values of a whole passage; the shear of each step in closed form; no warning of an edge far away."""
    result = finished("rolling-line")
    data = result.dataset
    a, p0 = hertz_cylinder(400e3, 0.01, 0.5 * 210e9 / (1 - 0.3**2))
    assert (a, p0) == (close(210.1e-6, rel=5e-4), close(1212e6, rel=5e-4))
    middle, depth = data.section_x.size // 2, data.section_z.values / a
    assert abs(data.section_x.values[middle]) < 1e-12
    for row, crossland, dang_van in ((6, 0.2362, 0.1523), (10, 0.2500, 0.1692), (18, 0.2268, 0.1617)):
        assert depth[row] == close(row / 20, rel=1e-3)
        values = [data[f"section_fatigue_{key}"].values[row, middle] * 400e6 / p0 for key in ("crossland", "dang_van")]
        assert values[0] == close(crossland, rel=2e-3)
        assert values[1] == close(dang_van, rel=2e-2)
        place = np.linspace(630e-6, -630e-6, 49) / a
        expected = p0 * hertz_stress(place, depth[row])[2]
        np.testing.assert_allclose(data.section_stress.values[1:, 4, row, middle], expected, rtol=0, atol=2e-3 * p0)
    assert result.summary["fatigue_crossland_depth"] == close(0.5 * a, rel=0.06)
    assert not [warning for warning in result.summary["warnings"] if warning["code"].startswith("fatigue")]


def test_punch_with_rounded_edges(finished):
    result = finished("rounded-line-punch")
    b, load, pressure = 1e-3, 2834.7e3, result.dataset.pressure.values[-1, 0]
    x = result.dataset.x.values
    inside = np.abs(x) < 1.9 * b
    expected = rounded_punch_pressure(x[inside] / b, np.arcsin(0.5)) * load / b
    assert result.summary["contact_radius"] == close(2.0 * b, rel=1e-3)
    np.testing.assert_allclose(pressure[inside], expected, rtol=0, atol=0.01 * expected.max())
    assert pressure.max() == close(0.3352 * load / b, rel=1e-3)
