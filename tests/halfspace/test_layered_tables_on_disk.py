"""Coefficients of layers that are kept on disk: the same to the last bit, and only where all is the same."""

from dataclasses import dataclass

import numpy as np
import pytest

from eigencontact.core.table_cache import TableCache
from eigencontact.halfspace.layered_influence import LayeredInfluence
from eigencontact.plugin import COMPONENTS
from eigencontact_plugins.layered.stack import BondedLayers, Layer, Substrate
from eigencontact_plugins.surface_loads import PressureLoad, ShearLoadX, ShearLoadY

LOADS = {"p": PressureLoad(), "q_x": ShearLoadX(), "q_y": ShearLoadY()}
X, Y = np.arange(9) * 0.06, np.arange(7) * 0.05
HALF = (0.03, 0.025)
DEPTHS = (2.0, 0.0, 0.3, 0.9, 0.3)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("EIGENCONTACT_CACHE", str(tmp_path / "tables"))
    return tmp_path / "tables"


@dataclass(frozen=True, kw_only=True)
class Counting(BondedLayers):
    """It counts how often it is asked for waves; a hidden medium may answer, which its fields do not tell."""

    asked = 0
    hidden = None

    def response_at_depths(self, *arguments, **options):
        type(self).asked += 1
        return (self.hidden or super()).response_at_depths(*arguments, **options)


def body(thickness=0.5, modulus=3.0):
    layer = Layer(thickness=thickness, young_modulus=modulus, poisson_ratio=0.2)
    return Counting(layers=(layer,), substrate=Substrate(young_modulus=1.0, poisson_ratio=0.3))


def tables(traction="p", quantity="stress", medium=None, *, depths=DEPTHS, half_widths=HALF, side="below", reach=0.6):
    """Coefficients and bounds of an influence that remembers nothing, on a lattice and about points."""
    names = COMPONENTS if quantity == "stress" else ("x", "y", "z")
    influence = LayeredInfluence(LOADS[traction], side=side)
    found = influence.at_depths(quantity, names, np.array(depths), half_widths, reach, medium or body())
    numbers = range(len(depths))
    lattice = [found.on_lattice(number, X, Y) for number in numbers]
    return np.array(lattice), np.array([found.about_points(number, X[:7], Y) for number in numbers]), found.bounds


def alike(one, other):
    return all(np.array_equal(a, b) for a, b in zip(one, other, strict=True))


@pytest.mark.parametrize("traction", ["p", "q_x", "q_y"])
@pytest.mark.parametrize(("quantity", "half_widths"), [("stress", HALF), ("displacement", (0.011, 0.007))])
def test_kept_tables_are_fresh_ones_to_the_last_bit(folder, monkeypatch, traction, quantity, half_widths):
    """The cells of the displacement are so small that closed kernels ride on the nodes."""
    kept = tables(traction, quantity, half_widths=half_widths)
    asked = Counting.asked
    again = tables(traction, quantity, half_widths=half_widths)
    bands = len(TableCache(folder).entries())
    assert Counting.asked == asked + bands  # for the address itself
    monkeypatch.setenv("EIGENCONTACT_CACHE", "off")
    fresh = tables(traction, quantity, half_widths=half_widths)
    assert alike(kept, again)
    assert alike(kept, fresh)


CHANGES = {
    "traction": {"traction": "q_x"},
    "quantity": {"quantity": "displacement"},
    "thickness": {"medium": body(thickness=0.5 + 1e-12)},
    "modulus": {"medium": body(modulus=3.0 * (1 + 1e-15))},
    "depths": {"depths": (2.0, 0.0, 0.3, 0.9, 0.3 + 1e-12)},
    "cells": {"half_widths": (0.03, 0.0251)},
    "side": {"side": "above"},
    "window": {"reach": 0.61},
}


@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES)
def test_each_change_has_tables_of_its_own(folder, change):
    before = tables()
    known = {entry.path for entry in TableCache(folder).entries()}
    changed = tables(**change)
    assert {entry.path for entry in TableCache(folder).entries()} > known
    assert alike(tables(), before)
    assert alike(tables(**change), changed)


def test_a_medium_that_answers_otherwise_has_other_tables_though_its_fields_are_the_same(folder, monkeypatch):
    before = tables()
    known = len(TableCache(folder).entries())
    plain = body()
    softer = Substrate(young_modulus=0.2, poisson_ratio=0.3)
    monkeypatch.setattr(Counting, "hidden", BondedLayers(layers=plain.layers, substrate=softer))
    after = tables()
    assert len(TableCache(folder).entries()) == 2 * known
    substrate, was = after[0][0], before[0][0]
    assert np.abs(substrate - was).max() > 0.1 * np.abs(was).max()


def test_damaged_tables_are_computed_again(folder):
    before = tables()
    for entry in TableCache(folder).entries():
        entry.path.write_bytes(entry.path.read_bytes()[:-100])
    with pytest.warns(UserWarning, match="computes it anew"):
        assert alike(tables(), before)
    asked = Counting.asked
    assert alike(tables(), before)
    assert Counting.asked == asked + len(TableCache(folder).entries())  # they are whole again


@pytest.mark.parametrize(
    "alter",
    [lambda a: 1.01 * a, lambda a: a[..., :1], lambda a: np.full_like(a, np.nan), lambda a: a.astype(str)],
    ids=["values", "shape", "nan", "text"],
)
def test_altered_tables_are_computed_again(folder, alter):
    """A valid file with other arrays gives neither other stresses nor an error of numpy."""
    before = tables()
    for entry in TableCache(folder).entries():
        with np.load(entry.path) as stored:
            arrays = {name: stored[name] for name in stored.files}
        np.savez(entry.path, **(arrays | {"radial": alter(arrays["radial"])}))
    with pytest.warns(UserWarning, match="computes it anew"):
        assert alike(tables(), before)


@dataclass(frozen=True, kw_only=True)
class Untold(Counting):
    """A medium with a part that no address can tell."""

    part: object = None


def test_a_medium_that_cannot_be_told_is_computed_each_time(folder):
    plain = body()
    untold = Untold(layers=plain.layers, substrate=plain.substrate, part=object())
    assert alike(tables(medium=untold), tables(medium=plain))
    known = TableCache(folder).entries()
    tables(medium=untold)
    assert TableCache(folder).entries() == known
