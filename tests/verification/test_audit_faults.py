"""Planted faults in results: the audit of the true file does not disagree, that of the changed one does."""

from __future__ import annotations

import shutil
import tomllib

import h5netcdf
import numpy as np
import pytest

import eigencontact as ec
from eigencontact_verification.audit import engines
from verdicts import words_of_audit


def solved(folder, scene, *changes):
    """Run of a bundled scene."""
    ec.run(ec.load_scene(scene, ["output.pictures=false", *changes]), folder).dataset.close()
    return folder


def changed(run, target, change):
    """Copy of a run whose file a function has changed."""
    target.mkdir()
    shutil.copy(run / "results.nc", target / "results.nc")
    with h5netcdf.File(target / "results.nc", "r+") as file:
        change(file)
    return target


def length(text):
    """Length [m] of text in micrometres."""
    number, unit = text.split()
    assert unit == "um"
    return 1e-6 * float(number)


def other_text(old, new):
    """Change of the scene that a file says it has solved."""

    def change(file):
        scene = file.attrs["scene"]
        assert scene.count(old) == 1
        file.attrs["scene"] = scene.replace(old, new)

    return change


@pytest.fixture(autouse=True)
def light(monkeypatch):
    """One element to a cell, which is enough for the print."""
    monkeypatch.setattr(engines, "_FOLLOWING", (450_000, 450_000))


@pytest.fixture(scope="module")
def hertz(tmp_path_factory):
    return solved(tmp_path_factory.mktemp("hertz") / "run", "hertz", "grid.cells-per-contact-radius=16")


@pytest.fixture(scope="module")
def coated(tmp_path_factory):
    return solved(tmp_path_factory.mktemp("coated") / "run", "coated-sphere", "grid.cells-per-contact-radius=16")


@pytest.fixture(scope="module")
def ball(tmp_path_factory):
    return solved(tmp_path_factory.mktemp("ball") / "run", "sphere-near-surface")


@pytest.fixture(scope="module")
def printed(tmp_path_factory):
    return solved(tmp_path_factory.mktemp("printed") / "run", "plastic-hertz")


@pytest.fixture(scope="module")
def store(tmp_path_factory):
    return tmp_path_factory.mktemp("solutions")


@pytest.mark.slow
@pytest.mark.parametrize("name", ["hertz", "coated", "ball", "printed"])
def test_true_results_do_not_disagree(name, store, request):
    found = words_of_audit(request.getfixturevalue(name), store)
    assert "agrees" in found
    assert found <= {"agrees", "inconclusive"}


@pytest.mark.slow
def test_tractions_that_are_two_per_cent_too_large_disagree(hertz, store, tmp_path):
    def larger(file):
        file["pressure"][...] = 1.02 * np.asarray(file["pressure"])

    assert "disagrees" in words_of_audit(changed(hertz, tmp_path / "run", larger), store)


@pytest.mark.slow
def test_a_layer_that_is_five_per_cent_too_thin_disagrees(coated, store, tmp_path):
    thinner = other_text('thickness = "2 um"', 'thickness = "1.9 um"')
    assert "disagrees" in words_of_audit(changed(coated, tmp_path / "run", thinner), store)


@pytest.mark.slow
def test_an_inclusion_one_cell_deeper_disagrees(ball, store, tmp_path):
    with h5netcdf.File(ball / "results.nc") as file:
        cell = float(np.diff(file["x"][:2])[0])

    def deeper(file):
        table = tomllib.loads(file.attrs["scene"])["inclusions"][0]
        old = table["center"][2]
        new = f"{1e6 * length(old) + 1e6 * cell:.6f} um"
        text = file.attrs["scene"]
        assert text.count(f'    "{old}",\n') == 1  # the third coordinate, on a line of its own
        file.attrs["scene"] = text.replace(f'    "{old}",\n', f'    "{new}",\n')

    assert "disagrees" in words_of_audit(changed(ball, tmp_path / "run", deeper), store)


@pytest.mark.slow
def test_plastic_strain_that_is_dropped_disagrees(printed, store, tmp_path):
    def dropped(file):
        file["plastic_strain_1"][...] = 0.0 * np.asarray(file["plastic_strain_1"])

    assert "disagrees" in words_of_audit(changed(printed, tmp_path / "run", dropped), store)
