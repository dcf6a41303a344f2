"""Numbers that laws give with every step: their meaning, energy, certificates, and nothing where nothing yields."""

import numpy as np
import pytest

import eigencontact as ec
from bodies import pressed
from close import close
from eigencontact.core.peaks import peak_of_means

LOADS = [{"normal_load": "0.65 N", "increments": 8}, {"normal_load": "0 N", "increments": 8}]
ONCE = [{"normal_load": "0.65 N"}, {"normal_load": "0 N"}]
PERFECT = {"type": "perfect", "yield-stress": "3 GPa"}
BOTH = [{"type": "linear", "yield-stress": "2 GPa", "modulus": "20 GPa"}, {"type": "prager", "modulus": "40 GPa"}]


def scene(hardening, steps=LOADS, **more):
    return ec.Scene(**pressed({"type": "j2", "hardening": hardening, **more}, steps, 12))


@pytest.fixture(
    scope="module", params=[pytest.param(PERFECT, marks=pytest.mark.slow), BOTH], ids=["perfect", "both kinds"]
)
def run(request, tmp_path_factory):
    return ec.run(scene(request.param), tmp_path_factory.mktemp("results"))


def volume_of_a_cell(data):
    return np.prod([float(np.diff(data[f"cells_1_{name}"])[0]) for name in "xyz"])


@pytest.mark.slow
def test_numbers_are_those_of_the_stored_fields(run):
    data, summary = run.dataset, run.summary
    strain = data["equivalent_plastic_strain_1"].values[-1]
    volume = volume_of_a_cell(data)
    assert summary["max_plastic_strain"] == strain.max() > 0.0
    assert summary["plastic_volume"] == close(np.count_nonzero(strain) * volume, rel=1e-12)
    work = float(data["plastic_work_density_1"].values[-1].sum() * volume)
    assert summary["plastic_work"] == close(work, rel=1e-12)
    imprint = data["residual_displacement_z"].values[-1]
    assert summary["print_depth"] == peak_of_means(imprint) > summary["max_sink"] == imprint.max() > 0.0
    assert summary["pile_up"] == peak_of_means(-imprint) >= summary["max_uplift"] == -imprint.min() > 0.0
    units = {"max_plastic_strain": "1", "plastic_volume": "m3", "plastic_work": "J", "print_depth": "m"}
    assert {name: summary["units"][name] for name in units} == units
    assert {name: data[name].attrs["units"] for name in units} == units


def test_work_of_the_load_is_dissipated_or_stored(run):
    """Work of the load = plastic work + elastic energy of the residual stress, -½ ∫ σ : e.

    To 1 % of the work of loading: what the load gives and takes back is summed by steps.
    """
    data = run.dataset
    load, depth = (np.concatenate([[0.0], data[name].values]) for name in ("normal_load", "approach"))
    given, loading = float(np.trapezoid(load, depth)), float(np.trapezoid(load[:9], depth[:9]))
    eigenstrain = data["equivalent_eigenstrain_1"][-1]
    seen = ec.region(run.folder, {"name": "all", "shape": "volume", "depths": eigenstrain["cells_1_z"].values.tolist()})
    # The box of cells and the window have cells in common; nothing yields in the others.
    stress = seen["all_stress"][-1]
    for axis in "yx":
        cells, points = (np.rint(values * 1e9) for values in (eigenstrain[f"cells_1_{axis}"], stress[f"all_{axis}"]))
        assert not eigenstrain[{f"cells_1_{axis}": ~np.isin(cells, points)}].values.any()
        eigenstrain = eigenstrain[{f"cells_1_{axis}": np.isin(cells, points)}]
        stress = stress[{f"all_{axis}": np.isin(points, cells)}]
    eigenstrain, stress = eigenstrain.values, stress.values
    plain = np.array([1.0, 1.0, 1.0, *3 * [np.sqrt(2.0)]])[:, None, None, None] * stress
    stored = -0.5 * volume_of_a_cell(data) * float(np.sum(plain * eigenstrain))
    assert stored > 0.0
    assert abs(float(data["plastic_work"][-1]) + stored - given) < 0.01 * loading
    assert np.all(np.diff(data["plastic_work"]) >= 0.0)


def test_every_step_has_the_certificate_of_its_law(run):
    """Stress of every cell is what its law answers to its strain, so that none is beyond what the law bears."""
    assert np.all(run.dataset["law_residual"].values < 1e-5)
    assert run.summary["law_residual"] < 1e-5


def test_numbers_are_zero_where_nothing_yields():
    summary = ec.run(scene({"type": "perfect", "yield-stress": "9 GPa"}, ONCE)).summary
    names = ("max_plastic_strain", "plastic_volume", "plastic_work", "print_depth", "pile_up")
    assert [summary[name] for name in names] == [0.0] * 5
    assert "law_residual" not in summary


def test_damage_has_its_largest_value():
    damage = {"type": "exponential", "saturation": 0.6, "strain": 0.02}
    run = ec.run(scene(PERFECT, ONCE, damage=damage))
    assert run.summary["max_damage"] == float(run.dataset["damage_1"][-1].max()) > 0.0
