"""Quantities with units, masks and odd values in the library: converted to SI units, or refused by one clear error."""

import numpy as np
import pint
import pytest
import xarray

import eigencontact as ec
from close import close

Q = pint.UnitRegistry(cache_folder=None).Quantity
STEEL = ec.HalfSpace("210 GPa", 0.3)
BALL = ec.make("sphere", radius="105 um")
INSIDE = ec.make("sphere", center=(0, 0, 2.0), radius=1.0)
AXIS = (np.arange(16) - 7.5) * 1e-6
GAP = (AXIS**2 + AXIS[:, None] ** 2) / (2 * 105e-6)
DISC = np.full((4, 4), 1e9)
POINT = [[0.0, 0.0, 1e-6]]
LABELS = np.zeros((2, 2, 2), dtype=int)
VOID = {"type": "sphere", "center": (0, 0, "4 um"), "radius": "2 um", "material": {"void": True}}
TABLES = {
    "body1": {"young-modulus": "210 GPa", "poisson-ratio": 0.3},
    "geometry": {"type": "sphere", "radius": "105 um"},
    "grid": {"cells": 8, "size": "16 um"},
    "steps": {"normal-load": 0.3},
}


def pressed(**options):
    return ec.solve_contact(BALL, STEEL, **{"load": 0.3, "cells": 8, "size": 16e-6} | options)


def of_gap(gap, **options):
    return ec.solve_contact(gap, STEEL, **{"load": 0.3, "spacing": 1e-6} | options)


def field(quantity=INSIDE, eigenstrain=1e-3, points=((0, 0, 1.0),)):
    return ec.inclusion_field(quantity, eigenstrain, points, young_modulus=210e9, poisson_ratio=0.3)


def rectangle(traction=(0, 0, 1e6), widths=(1e-6, 1e-6), points=POINT):
    return ec.rectangle_field(traction, widths, points, young_modulus=210e9, poisson_ratio=0.3)


#: A call with quantities, and the same call in SI units; each returns something that `np.asarray` takes.
CONVERTED = {
    "gap": lambda q: of_gap(q(GAP * 1e6, "um", GAP)).pressure,
    "gap, rows": lambda q: of_gap([q(row * 1e9, "nm", row) for row in GAP]).pressure,
    "gap, DataArray": lambda q: (
        of_gap(GAP if q is plain else xarray.DataArray(GAP * 1e6, attrs={"units": "um"})).pressure
    ),
    "spacing": lambda q: of_gap(GAP, spacing=q(1.0, "um", 1e-6)).pressure,
    "spacing, pair": lambda q: of_gap(GAP, spacing=q([1.0, 1.0], "um", [1e-6, 1e-6])).pressure,
    "size": lambda q: of_gap(GAP, spacing=None, size=q(16.0, "um", 16e-6)).pressure,
    "load": lambda q: pressed(load=q(300.0, "mN", 0.3)).pressure,
    "loads": lambda q: pressed(load=q([200.0, 300.0], "mN", [0.2, 0.3])).dataset.pressure,
    "load, 0-d": lambda q: pressed(load=0.3 if q is plain else np.array(0.3)).pressure,
    "approach": lambda q: pressed(load=None, approach=q(200.0, "nm", 2e-7)).pressure,
    "approach, 0-d": lambda q: pressed(load=None, approach=2e-7 if q is plain else np.array(2e-7)).pressure,
    "friction": lambda q: pressed(friction=q(30.0, "percent", 0.3), tangential_load=q(50.0, "mN", 0.05)).shear,
    "friction, 0-d": lambda q: pressed(friction=0.3 if q is plain else np.array(0.3), tangential_load=0.05).shear,
    "shift": lambda q: pressed(friction=0.3, shift=q([3.0, 1.0], "nm", [3e-9, 1e-9])).shear,
    "steps": lambda q: pressed(load=None, steps={"normal-load": q(300.0, "mN", 0.3)}).pressure,
    "cells, 0-d": lambda q: pressed(cells=8 if q is plain else np.array(8)).pressure,
    "body": lambda q: ec.HalfSpace(q(210.0, "GPa", 210e9), q(0.3, "", 0.3)).young_modulus,
    "layers": lambda q: (
        ec.Layered([(q(2.0, "um", 2e-6), q(420.0, "GPa", 420e9), 0.25)], substrate=STEEL).solid.interfaces
    ),
    "voxels": lambda q: ec.Voxels(LABELS, q(0.5, "um", 5e-7), {}, origin=q([0.0, 0, 1], "um", [0, 0, 1e-6])).origin,
    "inclusions": lambda q: (
        ec.solve_contact(
            BALL,
            ec.HalfSpace("210 GPa", 0.3, inclusions=VOID | {"center": q([0.0, 0, 4], "um", [0, 0, 4e-6])}),
            load=0.1,
            size="16 um",
            cells=16,
        ).pressure
    ),
    "stress": lambda q: STEEL.stress(
        q([[0.0, 0, 1]], "um", POINT), pressure=q(DISC * 1e-6, "MPa", DISC), spacing=q(1.0, "um", 1e-6)
    ),
    "displacement": lambda q: STEEL.displacement(
        POINT, shear=q(np.array([DISC, DISC]) * 1e-9, "GPa", np.array([DISC, DISC])), spacing=1e-6
    ),
    "inclusion field": lambda q: field(
        eigenstrain=q(0.1, "percent", 1e-3), points=q([[0.0, 0, 1000]], "mm", [[0, 0, 1.0]])
    ),
    "rectangle field": lambda q: rectangle(
        q([0.0, 0, 1], "MPa", [0, 0, 1e6]), q([1.0, 1], "um", [1e-6, 1e-6]), q([[0.0, 0, 1]], "um", POINT)
    ),
    "make": lambda q: ec.make("sphere", radius=q(2.0, "um", 2e-6), center=q([0.0, 0, 4], "um", [0, 0, 4e-6])).center,
    "scene": lambda q: ec.run(TABLES | {"steps": {"normal-load": q(300.0, "mN", 0.3)}}).dataset.pressure,
    "sweep": lambda q: ec.sweep(TABLES, {"steps.normal-load": [q(100.0, "mN", 0.1), 0.2]}).dataset.steps_normal_load,
    "result": lambda q: pressed().stress(q([[0.0, 0, 1]], "um", POINT)),
    "region": lambda q: pressed().region(name="s", shape="points", points=q([[0.0, 0, 1]], "um", POINT)).s_von_mises,
}


def plain(magnitude, unit, si):
    return si


@pytest.mark.parametrize("case", CONVERTED)
def test_quantities_are_converted(case):
    call = CONVERTED[case]
    given = np.asarray(call(lambda magnitude, unit, _: Q(magnitude, unit)))
    assert np.asarray(call(plain)) == close(given, rel=1e-9, abs=1e-9 * float(np.max(np.abs(given))))


MASKED = np.ma.masked_less(GAP, 1e-8)
#: A call that is refused, and the beginning of the message.
REFUSED = {
    "gap, masked": (lambda: of_gap(MASKED), r"solve_contact\.gap must be .* none of them masked \(got 4 masked\)"),
    "gap, masked rows": (lambda: of_gap(list(MASKED)), r"solve_contact\.gap must be .* none of them masked"),
    "gap, masked quantity": (lambda: of_gap(Q(MASKED, "m")), r"solve_contact\.gap must be .* none of them masked"),
    "gap, stress": (lambda: of_gap(Q(GAP, "Pa")), r"solve_contact\.gap must be .* in a unit like m \(got .* in Pa\)"),
    "gap, booleans": (lambda: of_gap(GAP > 0), r"solve_contact\.gap must be .* booleans"),
    "load, length": (lambda: pressed(load=Q(1.0, "m")), r"solve_contact: load must be a force \[N\]"),
    "load, no dimension": (lambda: pressed(load=Q(1.0, "")), r"solve_contact: load must be a force \[N\]: give a unit"),
    "load, masked": (
        lambda: pressed(load=np.ma.array([0.1, 0.2], mask=[0, 1])), r"solve_contact\.load must be .* masked"
    ),
    "load, a generator": (lambda: pressed(load=(0.1 for _ in [1])), r"solve_contact\.load must be a number"),
    "friction, length": (
        lambda: pressed(friction=Q(0.3, "m"), shift=1e-9), r"solve_contact: friction must be a number"
    ),
    "shift, force": (lambda: pressed(friction=0.3, shift=Q(1.0, "N")), r"solve_contact: shift must be a length"),
    "spacing, force": (lambda: of_gap(GAP, spacing=Q(1.0, "N")), r"solve_contact\.spacing must be a length \[m\]"),
    "numerics": (lambda: pressed(numerics="a"), r"solve_contact\.numerics must be a table"),
    "numerics, key": (lambda: pressed(numerics={1: 2}), r"solve_contact: numerics must have keys that are text"),
    "steps": (lambda: pressed(load=None, steps=3), r"solve_contact\.steps must be a sequence of tables"),
    "steps, text": (lambda: pressed(load=None, steps="abc"), r"solve_contact\.steps must be a sequence of tables"),
    "body": (lambda: ec.HalfSpace(Q(210.0, "m"), 0.3), r"HalfSpace\.young_modulus must be a stress \[Pa\]"),
    "ratio": (lambda: ec.HalfSpace("1 GPa", Q(0.3, "m")), r"HalfSpace\.poisson_ratio must be in"),
    "inclusions": (lambda: ec.HalfSpace("1 GPa", 0.3, inclusions="abc"), r"HalfSpace\.inclusions must be a sequence"),
    "inclusions, 3": (lambda: ec.HalfSpace("1 GPa", 0.3, inclusions=3), r"HalfSpace\.inclusions must be a sequence"),
    "inclusion": (lambda: ec.HalfSpace("1 GPa", 0.3, inclusions=[1]), r"HalfSpace\.inclusions\[0\] must be a table"),
    "layer": (
        lambda: ec.Layered([(Q(2.0, "kg"), "1 GPa", 0.25)], substrate=STEEL),
        r"Layered\.layers\.0\.thickness must be a length",
    ),
    "labels, masked": (
        lambda: ec.Voxels(np.ma.masked_equal(LABELS, 0), 1e-6, {}), r"Voxels\.labels must be .* none of them masked"
    ),
    "labels, lengths": (lambda: ec.Voxels(Q(LABELS, "m"), 1e-6, {}), r"Voxels\.labels must be .* in m"),
    "labels, ragged": (lambda: ec.Voxels([[[1]], [[1, 2]]], 1e-6, {}), r"Voxels\.labels must be .* no one shape"),
    "pressure": (lambda: STEEL.stress(POINT, pressure=Q(DISC, "m"), spacing=1e-6), r"HalfSpace\.stress\.pressure must"),
    "points": (lambda: STEEL.stress(Q(POINT, "s"), pressure=DISC, spacing=1e-6), r"HalfSpace\.stress\.points must be"),
    "eigenstrain": (lambda: field(eigenstrain=Q(1e-3, "m")), r"inclusion_field\.eigenstrain must be"),
    "traction": (lambda: rectangle(Q([0.0, 0, 1], "m")), r"rectangle_field\.traction must be"),
    "half widths": (lambda: rectangle(widths=Q([1.0, 1], "Pa")), r"rectangle_field\.half_widths must be"),
    "modulus": (
        lambda: ec.rectangle_field((0, 0, 1), (1, 1), POINT, young_modulus=Q(210.0, "GPa"), poisson_ratio=0.3),
        r"material\.young_modulus must be",
    ),
    "make": (lambda: ec.make("isotropic", young_modulus=Q(1.0, "m"), poisson_ratio=0.3), r"isotropic\.young-mod"),
    "make, masked": (
        lambda: ec.make("sphere", kind="geometry", radius=1.0, center=np.ma.masked_equal([0.0, 1.0], 1.0)),
        r"sphere\.center must be given without masked values",
    ),
    "scene, key": (lambda: ec.load_scene({1: 2}), r"scene must have keys that are text \(got 1\)"),
    "scene, inner key": (lambda: ec.load_scene({"body1": {1: 2}}), r"body1 must have keys that are text"),
    "scene, object": (
        lambda: ec.load_scene(TABLES | {"geometry": {"type": "sphere", "radius": object()}}),
        r"geometry\.radius must be a number, a text, an array or a table",
    ),
    "result, body": (lambda: pressed().stress(POINT, body=np.array([1, 2])), r"ContactResult\.stress\.body must be 1"),
    "region": (lambda: ec.region("nowhere", 3), r"region must be a table like those of \[\[stress\]\]"),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_what_makes_no_sense_is_refused(case):
    call, words = REFUSED[case]
    with pytest.raises(ec.EigencontactError, match=f"^{words}"):
        call()


class Metres(np.ndarray):
    """Quantity as astropy and unyt make them: an array with a unit, which `np.asarray` drops."""

    unit = "um"

    @property
    def value(self):
        return np.asarray(self)


def test_arrays_with_a_unit_of_other_libraries_are_converted():
    found = of_gap((GAP * 1e6).view(Metres)).max_pressure
    assert found == close(of_gap(GAP).max_pressure, rel=1e-9)
