"""Guesses of repeated increments: the same results in fewer rounds, nothing kept of a history without repeats."""

import numpy as np
import pytest

import eigencontact as ec
from eigencontact.execution.blocks.increment import Increment
from eigencontact.execution.blocks.surface import Surface
from eigencontact.execution.mechanics import repeats
from eigencontact.execution.mechanics.repeats import Change, Repeats
from eigencontact.solvers.control import Control
from eigencontact.solvers.joint_anderson import JointAnderson

RESULTS = ("pressure", "shear_x", "plastic_strain_1", "back_stress_1_1", "dissipated_energy", "plastic_work")


def rubbed(cycles, *, tolerance=1e-6):
    hardening = [{"type": "perfect", "yield-stress": "500 MPa"}, {"type": "prager", "modulus": "5 GPa"}]
    turns = [{"tangential-load-x": f"{sign}60 N/mm", "increments": 2} for sign in ("", "-")]
    return ec.load_scene(
        {
            "body1": {
                "young-modulus": "210 GPa", "poisson-ratio": 0.3, "law": {"type": "j2", "hardening": hardening},
            },
            "body2": {"rigid": True},
            "geometry": {"type": "cylinder", "radius": "10 mm"},
            "friction": {"type": "coulomb", "coefficient": 0.5},
            "grid": {"length": "infinite", "cells": 48, "size": "0.8 mm"},
            "steps": [{"normal-load": "250 N/mm", "increments": 2}, *turns * cycles],
            "numerics": {"tolerance": tolerance, "threads": 1},
            "output": {"pictures": False},
        }
    )  # fmt: skip


def distances(dataset, reference):
    return {
        name: float(np.linalg.norm(dataset[name] - reference[name]) / np.linalg.norm(reference[name]))
        for name in RESULTS
    }


@pytest.mark.slow
def test_cycles_take_two_thirds_of_the_rounds_and_have_the_same_results(monkeypatch):
    exact = ec.run(rubbed(8, tolerance=1e-9)).dataset
    guessed = ec.run(rubbed(8)).dataset
    monkeypatch.setattr(Repeats, "of", lambda *_: None)
    plain = ec.run(rubbed(8)).dataset
    rounds = [data["coupling_iterations"].values[2:].reshape(8, 4).sum(axis=1) for data in (guessed, plain)]
    np.testing.assert_array_equal(rounds[0][:3], rounds[1][:3])  # nothing is guessed before the fourth cycle
    assert rounds[0][4:].sum() < 0.7 * rounds[1][4:].sum()
    with_guesses, without = distances(guessed, exact), distances(plain, exact)
    for name in RESULTS:
        assert with_guesses[name] <= 1.5 * without[name] + 1e-6, name


@pytest.mark.slow
def test_a_guess_that_leads_nowhere_is_given_up(monkeypatch):
    """A guess of ten times the yield strain, on which the contact or the rounds may fail."""
    plain = ec.run(rubbed(5)).dataset
    asked = []

    def astray(self, start):
        asked.append(start.shape)
        return start + 0.05 * np.sin(np.arange(start.size)).reshape(start.shape)

    monkeypatch.setattr(Change, "end_from", astray)
    found = ec.run(rubbed(5)).dataset
    assert asked
    assert max(distances(found, plain).values()) < 1e-4


def test_the_guess_is_the_last_change_or_goes_along_a_line():
    change, start = None, np.ones((2, 3))
    for size in (1.0, 1.2, 1.36):  # the line overshoots less than the last change lags
        change = Change.of(size * np.eye(2, 3), change)
    assert change.along_line
    np.testing.assert_allclose(change.end_from(start), start + 1.52 * np.eye(2, 3))
    change = Change.of(1.2 * np.eye(2, 3), change)  # turns back, where the line did not lead
    assert not change.along_line
    np.testing.assert_allclose(change.end_from(start), start + 1.2 * np.eye(2, 3))
    assert change.entries.tolist() == [0, 4]
    assert change.older is not None
    assert change.older.older is None


def increment(load, separation):
    surface = Surface(separation=separation)
    return Increment(
        times=(0.0, 1.0), begin={}, control=Control(normal_load=load), tangential=None, surface=surface, progress=None
    )


@pytest.mark.parametrize(("shifted", "known"), [(0.0, True), (1e-4, True), (0.05, False)])
def test_an_increment_is_known_by_its_start_its_end_and_its_surfaces(shifted, known):
    parabola, kept = np.linspace(-1.0, 1.0, 9)[None] ** 2, Repeats()
    for load in (1.0, 2.0, 1.0, 2.0, 1.0, 2.0):
        assert kept.of(increment(load, parabola)) is None
        kept.store(increment(load, parabola), None, [np.ones(3)], JointAnderson(2), 0.1)
    assert kept.of(increment(2.0, parabola)) is None  # from 2 to 2 is new
    later = increment(1.0, (np.linspace(-1.0, 1.0, 9)[None] - shifted) ** 2)
    assert kept.of(later) is None  # from 2 to 1 has been stored once
    kept.store(later, None, [np.ones(3)], JointAnderson(2), 0.1)
    again = increment(2.0, later.surface.separation)
    assert (kept.of(again) is not None) is known
    if known:
        kept.forget(again)
        assert kept.of(again) is None


def test_what_does_not_fit_into_memory_is_left_out(monkeypatch):
    flat, kept = np.zeros((4, 4)), Repeats()
    monkeypatch.setattr(repeats, "_MOST", 30 * 8 * 16 + 100)
    for count in (3, 3, 3, 3, 50, 3, 3):
        mixer = JointAnderson(2)
        for _ in range(3):
            mixer.next([np.ones(20)], [np.arange(20.0)], [np.ones(1)])
        kept.store(increment(1.0, flat), None, [np.ones(count)], mixer, 0.1)
        stored = kept.of(increment(1.0, flat))
        assert stored is None or (stored.mixer is None and stored.changes[0].entries.size == 3)
    assert stored is not None
