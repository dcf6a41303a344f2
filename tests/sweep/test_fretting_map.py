"""Fretting map: regimes against the closed form, numbers of the last cycle, refusals."""

import numpy as np
import pytest
import xarray

import eigencontact as ec
from close import close

SMALL = ["grid.cells-per-contact-radius=8", "observers=[]"]
SMALL += [f"steps.{k}.increments={n}" for k, n in ((1, 2), (2, 3), (3, 3))]


@pytest.fixture(scope="module")
def answer():
    return ec.fretting_map(
        ec.load_scene("fretting-mode-1", SMALL), load=["6 N", "12 N"], amplitude=["0.05 um", "0.5 um", "1.1 um"]
    )


def test_regimes_are_those_of_mindlin(answer):
    """All of the contact slips from the shift 3 mu P (2 - nu) / (16 a G) on."""
    G = 210e9 / 2.6
    for load, row in zip((6.0, 12.0), answer.dataset["regime"].values, strict=True):
        radius = (0.75 * load * 200e-6 * 0.91 / 210e9) ** (1 / 3)
        slides = 3 * 0.5 * load * 1.7 / (16 * radius * G)
        expected = [0, *(2 if shift > slides else 1 for shift in (0.5e-6, 1.1e-6))]
        assert row.tolist() == expected
    assert set(answer.dataset["regime"].values.ravel()) == {0, 1, 2}


def test_energy_of_gross_slip(answer):
    """4 mu P (d - d_1) and the loop of the last moment before sliding, as Mindlin and Deresiewicz have it."""
    load, shift = 6.0, 1.1e-6
    radius = (0.75 * load * 200e-6 * 0.91 / 210e9) ** (1 / 3)
    slides = 3 * 0.5 * load * 1.7 / (16 * radius * 210e9 / 2.6)
    sliding = 4 * 0.5 * load * (shift - slides)
    onset = 0.8 * 0.5 * load * slides  # loop at Q = mu P: 4 Q d / 5
    np.testing.assert_allclose(answer.dataset["cycle_energy"].values[0, 2], sliding + onset, rtol=0.04)


def test_coordinates_have_units(answer):
    np.testing.assert_allclose(answer.dataset["amplitude"].values, [0.05e-6, 0.5e-6, 1.1e-6], rtol=1e-12)
    assert answer.dataset["load"].attrs["units"] == "N"
    assert answer.lines()[0].startswith("6 variants: ")


@pytest.mark.parametrize(
    ("scene", "changes", "words"),
    [
        ("hertz", {}, "steps of a map must have one motion of shift-x, "),
        ("fretting-loop-evolution", {}, "steps of a map must prescribe normal-load"),
        ("fretting-mode-1", {"load": "5 m"}, "load of a map must be a number [N]; '5 m' has the dimension"),
        ("fretting-mode-1", {"amplitude": ["2 um", "1 um"]}, "amplitude of a map must be positive values that ascend"),
    ],
)
def test_refusals(scene, changes, words):
    with pytest.raises(ec.EigencontactError) as caught:
        ec.fretting_map(scene, **{"load": ["5 N"], "amplitude": ["1 um"], **changes})
    assert words in str(caught.value)


def test_command_stores_the_map_with_fatigue_and_arrest(tmp_path):
    """A criterion that nothing reaches, and a threshold below which every crack stops."""
    from eigencontact.sweeps.map_command import fretting_map

    section = 'stress=[{name="section", shape="plane", normal="y", depth-max="20 um", depth-cells=8}]'
    fretting_map(
        "fretting-mode-1",
        load="6 N,12 N",
        amplitude="0.5 um,1.1 um",
        changes=[*SMALL, "grid.cells-per-contact-radius=4", section],
        criterion='type = "crossland", slope = 0.3, limit-amplitude = "100 GPa"',
        crack='at = [0, 0], angle = 0, length = "10 um", threshold = "1 GPa sqrt(m)"',
        region="section",
        output=tmp_path,
        quiet=True,
    )
    assert (tmp_path / "map.png").stat().st_size > 10_000
    with xarray.open_dataset(tmp_path / "map.nc", engine="h5netcdf") as data:
        assert 0 < float(data["utilisation"].min()) <= float(data["utilisation"].max()) < 1
        assert not data["arrest_length"].values.any()


def test_utilisation_at_a_critical_distance():
    """The variant with the scene's load and amplitude has the value of the scene's own run."""
    section = 'stress=[{name="section", shape="plane", normal="y", depth-max="20 um", depth-cells=8}]'
    scene = ec.load_scene("fretting-mode-1", [*SMALL, "grid.cells-per-contact-radius=4", section])
    table = {"type": "crossland", "slope": 0.3, "limit-amplitude": "2 GPa"}
    near = {**table, "distance": "5 um", "method": "line"}
    answer = ec.fretting_map(scene, load=["12.307 N"], amplitude=["0.5 um"], criterion=near, region="section")
    summary = ec.fatigue(ec.run(scene), table, region="section", distance="5 um", method="line").summary
    assert float(answer.dataset["utilisation"][0, 0]) == close(summary["at_distance"], rel=1e-9)
    assert summary["at_distance"] < 0.9 * summary["utilisation"]
    assert near["distance"] == "5 um"  # the table of the caller stays whole


def test_variants_of_one_load_share_its_window(answer):
    """They have the numbers of maps of their own, and the window is chosen once for each load."""
    scene = ec.load_scene("fretting-mode-1", SMALL)
    for j, amplitude in enumerate(("0.05 um", "0.5 um", "1.1 um")):
        alone = ec.fretting_map(scene, load=["12 N"], amplitude=[amplitude]).dataset
        for name in ("regime", "cycle_energy", "energy_ratio", "max_pressure", "contact_radius"):
            assert float(alone[name][0, 0]) == close(float(answer.dataset[name][1, j]), rel=1e-12)


def test_windows_of_a_map_are_chosen_once_for_a_load(monkeypatch):
    from eigencontact.model import contact_window as chosen

    loads, choose = [], chosen.contact_window
    monkeypatch.setattr(chosen, "contact_window", lambda *scene: loads.append(scene) or choose(*scene))
    ec.fretting_map(ec.load_scene("fretting-mode-1", SMALL), load=["6 N", "12 N"], amplitude=["0.3 um", "0.5 um"])
    assert len(loads) == 2


def test_a_scene_with_a_fatigue_table_keeps_its_region():
    table = {"type": "crossland", "slope": 0.3, "limit-amplitude": "2 GPa"}
    section = {"name": "section", "shape": "plane", "normal": "y", "depth-max": "20 um", "depth-cells": 8}
    tables = ec.load_scene("fretting-mode-1", [*SMALL, "grid.cells-per-contact-radius=4"]).resolved()
    scene = {**tables, "stress": [section], "fatigue": [table]}
    answer = ec.fretting_map(scene, load=["12 N"], amplitude=["0.5 um"], criterion=table).dataset
    assert float(answer["fatigue_crossland_utilisation"][0, 0]) == close(float(answer["utilisation"][0, 0]), rel=1e-12)
    without = ec.fretting_map(scene, load=["12 N"], amplitude=["0.5 um"]).dataset
    assert float(without["fatigue_crossland_utilisation"][0, 0]) == close(float(answer["utilisation"][0, 0]), rel=1e-12)


@pytest.mark.parametrize("worn", [True, False])
def test_picture_has_worn_depths_of_a_scene_that_wears(answer, tmp_path, worn):
    from eigencontact.viz.fretting_map import draw_fretting_map

    depth = 1e-6 * answer.dataset["cycle_energy"] / float(answer.dataset["cycle_energy"].max())
    dataset = answer.dataset.assign(max_worn_depth=depth) if worn else answer.dataset
    words = draw_fretting_map(dataset, tmp_path / "map.png")
    assert ("dotted lines of equal worn depth" in words) is worn
