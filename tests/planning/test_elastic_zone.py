"""The search for the zone in which a body yields: bounded work, right bounds, and clear words where it is too large."""

import re

import numpy as np
import pytest

import eigencontact as ec
from bodies import STEEL_TABLE as STEEL
from close import close
from eigencontact.core.grid import Grid
from eigencontact.core.material import Material
from eigencontact.errors import SceneError
from eigencontact.model import sizes, yielding
from eigencontact.solvers.elastic_zone import ElasticStress, elastic_zone, overload
from eigencontact_plugins.surface_loads import PressureLoad

#: Places that a search may ask a law about: four boxes of 48 x 48 x 24 for each load, and what finds the ratio.
MOST_PLACES = 400_000


def scene(law, **more):
    return ec.Scene(
        body1=STEEL | {"law": law},
        body2={"rigid": True},
        geometry={"type": "sphere", "radius": "200 um"},
        steps=[{"normal-load": "0.3 N"}],
        **more,
    )


def yields_at(stress):
    return {"type": "j2", "hardening": {"type": "perfect", "yield-stress": stress}}


FAR_ABOVE = {
    "1 MPa": (yields_at("1 MPa"), "2.6e+03 times", "yield-stress = '1 MPa'"),
    "1 Pa": (yields_at(1), "2.6e+09 times", "yield-stress = 1 "),
    "a curve in MPa": (
        {"type": "j2", "hardening": {"type": "tabulated", "strain": [0, 0.1], "stress": [350, 420]}},
        "7.5e+06 times",
        "stress = [350, 420]",
    ),
}


@pytest.fixture
def places(monkeypatch):
    """Number of places about which laws are asked; more than `MOST_PLACES` end the test."""
    asked = []
    yields = yielding._Trial.yields

    def counted(trial, stress, z):
        asked.append(z.size)
        assert sum(asked) < MOST_PLACES
        return yields(trial, stress, z)

    monkeypatch.setattr(yielding._Trial, "yields", counted)
    return asked


@pytest.mark.parametrize(
    ("law", "ratio", "limit"),
    [
        pytest.param(*case, id=name, marks=[pytest.mark.slow] * (name in ("1 MPa", "1 Pa")))
        for name, case in FAR_ABOVE.items()
    ],
)
def test_a_body_pressed_far_above_its_yield_stress_is_refused_after_bounded_work(law, ratio, limit, places):
    with pytest.raises(SceneError) as refusal:
        ec.plan(scene(law))
    words = str(refusal.value)
    assert words.startswith("body1.law must yield only near the contact (got an elastic stress of ")
    assert f"an elastic stress of {ratio} the yield stress" in words
    assert "the plastic zone is larger than 287 um x 287 um x 143 um" in words
    assert f"check the unit of {limit}" in words


@pytest.mark.parametrize(
    ("law", "ratio"),
    [
        (yields_at("200 MPa"), "13 times"),
        pytest.param(
            {"type": "brittle", "damage": {"type": "mazars", "threshold": 1e-4, "A": 0.9, "B": 8e3}},
            "50 times",
            marks=pytest.mark.slow,
        ),
        (
            {
                "type": "by-depth",
                "interfaces": ["2 um"],
                "laws": [
                    {"type": "brittle", "damage": {"type": "mazars", "threshold": 1e-4, "A": 0.9, "B": 8e3}},
                    yields_at("300 MPa"),
                ],
            },
            "49 times",
        ),
    ],
    ids=["j2", "brittle", "brittle over j2"],
)
def test_a_zone_of_more_cells_than_memory_holds_is_refused_before_cells_are_made(law, ratio, places, monkeypatch):
    monkeypatch.setattr(sizes, "machine_bytes", lambda: 24e9)
    with pytest.raises(SceneError, match=r"^body1.law must make at most 7.2e\+06 cells") as refusal:
        ec.plan(scene(law))
    assert f"an elastic stress of {ratio} the yield stress" in str(refusal.value)
    assert "; check the unit of " in str(refusal.value)
    assert "use a coarser grid" in str(refusal.value)


def test_the_pitch_that_a_refusal_names_fits():
    with pytest.raises(SceneError, match=r"numerics.inclusion-pitch must make at most") as refusal:
        ec.plan(scene(yields_at("600 MPa"), numerics={"inclusion-pitch": "1 nm"}))
    (pitch,) = re.findall(r"; (\S+) would do", str(refusal.value))
    plan = ec.plan(scene(yields_at("600 MPa"), numerics={"inclusion-pitch": float(pitch)}))
    assert plan.model.cells.inhomogeneities[0].lattice.edges[0] == float(pitch)


# a uniform pressure on some cells: where does the normal stress exceed a part of it?
EDGE, PRESSURE = 1e-6, 1e9
STEEL_HALF = Material(young_modulus=210e9, poisson_ratio=0.3)


def pressed(shape):
    nx, ny = shape
    window = Grid(nx=nx + 4, ny=ny + 4, dx=EDGE, dy=EDGE, center=(3e-6, -2e-6))
    return window, {"p": np.pad(np.full((ny, nx), PRESSURE), 2)}


@pytest.mark.parametrize("shape", [(16, 16), (15, 13), (1, 1)])
@pytest.mark.parametrize("part", [0.2, 0.02, 0.006])
def test_the_bounds_of_a_zone_hold_it_in_any_box(shape, part):
    """Below the middle of a loaded rectangle the normal stress is known in closed form."""
    a, b = (0.5 * side * EDGE for side in shape)

    def normal(z):
        root = np.sqrt(a**2 + b**2 + z**2)
        corner = np.arctan(a * b / (z * root)) + a * b * z / root * (1 / (a**2 + z**2) + 1 / (b**2 + z**2))
        return 2 / np.pi * corner

    elastic = ElasticStress({"p": PressureLoad()}, STEEL_HALF)
    zone = elastic_zone(lambda stress, _: np.abs(stress[2]) > part * PRESSURE, pressed(shape), elastic, 1.0)
    depths = np.linspace(0.01 * EDGE, 250 * EDGE, 100_000)
    deepest = depths[normal(depths) > part].max()
    assert zone.closed
    # The bounds are those of whole cells, in boxes twice as coarse where the zone reaches twice as far.
    coarse = EDGE * max(1.0, 2 ** np.ceil(np.log2(deepest / (24 * EDGE))))
    assert deepest - coarse <= zone.high[2] <= deepest + coarse
    assert zone.low[2] == 0.0
    np.testing.assert_allclose(0.5 * (zone.low + zone.high)[:2], (3e-6, -2e-6), atol=0.5 * coarse)


def test_a_zone_without_end_is_told_after_four_boxes():
    elastic, asked = ElasticStress({"p": PressureLoad()}, STEEL_HALF), []

    def exceeds(stress, z):
        asked.append(z.size)
        return np.ones(z.shape, dtype=bool)

    zone = elastic_zone(exceeds, pressed((16, 16)), elastic, 1.0)
    assert not zone.closed
    assert sum(asked) == 4 * 48 * 48 * 24
    assert zone.high[2] == 24 * 8 * EDGE


def test_the_ratio_of_load_to_limit():
    elastic = ElasticStress({"p": PressureLoad()}, STEEL_HALF)
    for limit in (8e8, 3e8, 4e3):
        ratio = overload(lambda stress, _, limit=limit: np.abs(stress[2]) > limit, pressed((16, 16)), elastic)
        # The pressure itself acts at the surface; the first places lie half a cell below it.
        assert ratio == close(PRESSURE / limit, rel=0.1)
