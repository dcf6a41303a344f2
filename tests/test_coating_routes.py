"""Coatings by three routes: exact layers, and cells of the coating or of the substrate under the exact half-space.

Cases CO-1, CO-2, CO-5, CO-6, PL-1 and PL-2. The enriched routes must reach the reference, and the layered route cell by
cell as the grid is refined: errors fall with the square of the cells' edges, and with the square of the depth to which
a substrate is enriched.
"""

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact_verification.oracles.coated_contact import coated_contact
from eigencontact_verification.oracles.coated_stress import sliding_stress

#: Thickness of the coating [m]; substrate; radius of the ball over the thickness.
H, E, NU, BALL = 1e-6, 210e9, 0.3, 10.0
MODULUS = E / (1 - NU**2)
ROUTES = ("coating", "substrate")
#: Half width of the window over the thickness at a load of a0 = H, by E1/E2: a little more than the contact.
HALF = {0.25: 2.0, 0.5: 1.75, 1.0: 1.25, 2.0: 1.25, 4.0: 1.0}


class Case:
    """A ball on a coating; lengths over the thickness, pressures over the largest on the bare substrate.

    `per_h` is the number of cells in the thickness, and in the same length along the surface; an enriched substrate
    reaches `depth` below the coating and as far aside, an enriched coating `width` to either side, or the whole window.
    """

    def __init__(
        self, ratio, *, a0=1.0, half=None, cells=None, per_h=6, depth=3.0, width=2.5, ball=BALL, numerics=None, **tables
    ):
        self.ratio, self.depth, self.width, self.ball = ratio, depth, width, ball * H
        half = half or HALF[ratio]
        self.half, self.load = half, 4.0 * MODULUS * (a0 * H) ** 3 / (3.0 * self.ball)
        self.p0 = 1.5 * self.load / (np.pi * (a0 * H) ** 2)
        cells = cells or round(2 * half * per_h)
        self.tables = {
            "body2": {"rigid": True},
            "geometry": {"type": "sphere", "radius": self.ball},
            "grid": {"cells": cells, "size": [2 * half * H, 2 * half * H]},
            "steps": {"normal-load": self.load},
            "output": {"pictures": False},
        } | tables
        self.numerics = {"inclusion-pitch": H / per_h, **(numerics or {})}

    @property
    def oracle(self):
        return coated_contact(self.load, self.ball, [(H, self.ratio * E, NU)], (E, NU))

    def run(self, route):
        coating = {"young-modulus": self.ratio * E, "poisson-ratio": NU}
        base = {"young-modulus": E, "poisson-ratio": NU}
        scene = dict(self.tables)
        if route == "layers":
            scene["body1"] = {
                "medium": {"type": "bonded-layers", "layers": [{"thickness": H, **coating}], "substrate": base}
            }
            scene["numerics"] = {key: value for key, value in self.numerics.items() if key != "inclusion-pitch"}
            return ec.run(scene)
        width = 2.0 * max(self.half, self.width if route == "coating" else self.depth) * H
        region = {"type": "layer", "size": [width, width]}
        if route == "coating":
            scene["body1"] = base
            scene["inclusions"] = [{**region, "thickness": H, "material": coating}]
        else:
            scene["body1"] = coating
            scene["inclusions"] = [{**region, "thickness": self.depth * H, "top": H, "material": base}]
        return ec.run(scene | {"numerics": self.numerics})

    def pressure(self, route):
        return self.run(route).dataset.pressure[-1].values / self.p0


# ---------------------------------------------------------------- CO-1


#: Odd numbers of cells, so that one has its middle on the axis. Tolerance of the largest pressure.
SMALL = {"layers": (4, 0.006), "coating": (6, 0.01), "substrate": (4, 0.012)}


@pytest.mark.parametrize("route", [pytest.param(r, marks=[pytest.mark.slow] * (r == "substrate")) for r in SMALL])
def test_a_stiff_coating_by_every_route(route):
    per_h, tolerance = SMALL[route]
    case = Case(2.0, cells=13, half=1.3, per_h=per_h, depth=2.0, width=2.0)
    assert case.oracle.max_pressure / case.p0 == close(1.4754, rel=1e-4)
    pressure = case.pressure(route)
    assert pressure.max() == pressure[6, 6] == close(1.4754, rel=tolerance)
    radius = 1.3 * 2 / 13 * np.sqrt(np.count_nonzero(pressure) / np.pi)
    assert radius == close(case.oracle.radius / H, abs=0.1)  # half a cell


@pytest.mark.parametrize("route", ["coating", pytest.param("substrate", marks=pytest.mark.slow)])
def test_a_coating_of_the_same_material_changes_nothing(route):
    case = Case(1.0, per_h=3, depth=1.0, width=1.0, numerics={"tolerance": 1e-11})
    bare = case.run("layers").dataset
    assert (case.run(route).dataset.pressure - bare.pressure).pipe(abs).max() < 1e-10 * case.p0


def differences(ratio, route, levels, **more):
    """Largest pressure by a route relative to that by layers on the same cells, by level."""
    found = []
    for per_h in levels:
        case = Case(ratio, per_h=per_h, **{name: value(per_h) for name, value in more.items()})
        found.append(case.pressure(route).max() / case.pressure("layers").max() - 1.0)
    return np.array(found)


#: E1/E2, route, cells in the thickness, bound of the last difference.
TABLE = [
    (2.0, "coating", (4, 6, 8), 0.006),
    (0.5, "coating", (4, 6, 8), 0.002),
    (4.0, "coating", (4, 6, 8), 0.025),
    (0.25, "coating", (4, 6, 8), 0.003),
    (2.0, "substrate", (4, 6), 0.004),
    (0.5, "substrate", (4, 6), 0.004),
    (4.0, "substrate", (4, 6), 0.005),
    (0.25, "substrate", (4, 6), 0.008),
]


@pytest.mark.slow
@pytest.mark.parametrize(("ratio", "route", "levels", "bound"), TABLE)
def test_routes_agree_as_cells_are_refined(ratio, route, levels, bound):
    """Cells and the depth of an enriched substrate go together: D = per_h / 2 thicknesses."""
    found = np.abs(differences(ratio, route, levels, depth=lambda per_h: per_h / 2))
    rate = -np.polyfit(np.log(levels), np.log(found), 1)[0]
    assert rate == close(2.0, abs=0.5)
    assert found[-1] < bound


@pytest.mark.slow
@pytest.mark.parametrize("route", ROUTES)
def test_window_and_depth_that_enrichment_needs(route):
    """Past 2.5 thicknesses a wider coating changes nothing; a deeper substrate does, as the inverse square of depth."""
    whole = Case(2.0, cells=13, half=1.3).pressure("layers").max()
    reaches = (2.5, 5.0) if route == "coating" else (2.0, 3.0, 4.5)
    found = []
    for reach in reaches:
        more = {"width": reach} if route == "coating" else {"depth": reach}
        found.append(Case(2.0, cells=13, half=1.3, per_h=4, **more).pressure(route).max() / whole - 1.0)
    if route == "coating":
        assert abs(found[1] - found[0]) < 3e-4
    else:
        steps = -np.diff(found)
        expected = (1 / 2.0**2 - 1 / 3.0**2) / (1 / 3.0**2 - 1 / 4.5**2)
        assert steps[0] / steps[1] == close(expected, rel=0.25)
        assert 0 < found[-1] < 0.004


# ---------------------------------------------------------------- coatings that layers do not give, or only several


def enriched(case, *layers):
    """Pressure over the reference with layers in the substrate."""
    scene = {"body1": {"young-modulus": E, "poisson-ratio": NU}, "numerics": case.numerics}
    return ec.run(case.tables | scene | {"inclusions": list(layers)}).dataset.pressure[-1].values / case.p0


def layer(ratio, *, width=(5.0, 5.0), **shape):
    """A region of H, so many thicknesses wide along x and y."""
    material = {"young-modulus": ratio * E, "poisson-ratio": NU}
    return {"type": "layer", "size": [length * H for length in width], "material": material, **shape}


@pytest.mark.slow
def test_two_layers_on_a_substrate():
    """A stiff one on a soft one, as inhomogeneities and exactly."""
    case = Case(1.0, cells=13, half=1.56, per_h=8)
    whole = coated_contact(case.load, case.ball, [(0.5 * H, 2 * E, NU), (0.5 * H, 0.5 * E, NU)], (E, NU))
    found = enriched(case, layer(2.0, thickness=0.5 * H), layer(0.5, thickness=0.5 * H, top=0.5 * H))
    assert found.max() == close(whole.max_pressure / case.p0, rel=0.02)
    one = coated_contact(case.load, case.ball, [(H, 2 * E, NU)], (E, NU))
    assert whole.max_pressure < 0.8 * one.max_pressure  # and no other arrangement of the same layers
    swapped = enriched(case, layer(0.5, thickness=0.5 * H), layer(2.0, thickness=0.5 * H, top=0.5 * H))
    assert swapped.max() < 0.95 * found.max()


@pytest.mark.slow
def test_a_map_of_the_thickness(tmp_path):
    """A map of one thickness is a layer of it; a wedge lies between its thinnest and its thickest place."""
    case = Case(2.0, cells=13, half=1.3, per_h=4)
    np.save(tmp_path / "even.npy", np.ones((3, 4)))
    np.save(tmp_path / "wedge.npy", np.tile(np.linspace(0.5, 1.0, 5), (2, 1)))
    even, wedge = (
        enriched(case, layer(2.0, file=str(tmp_path / f"{name}.npy"), **{"thickness-unit": H}))
        for name in ("even", "wedge")
    )
    full, half = (enriched(case, layer(2.0, thickness=thickness * H)) for thickness in (1.0, 0.5))
    np.testing.assert_allclose(even, full, rtol=0, atol=1e-5)
    assert half.max() < wedge.max() < full.max()
    np.testing.assert_allclose(wedge, wedge[::-1], rtol=0, atol=1e-4)  # along y nothing changes
    assert wedge[6, 7:].sum() > wedge[6, :6].sum()  # more pressure over the thicker side


@pytest.mark.slow
def test_a_coating_that_ends_under_the_contact():
    """It covers x < 0 only: stiffer there."""
    case = Case(2.0, cells=12, half=1.3, per_h=4)
    found = enriched(case, layer(2.0, width=(2.5, 5.0), thickness=H, center=[-1.25 * H, 0.0]))
    whole, bare = enriched(case, layer(2.0, thickness=H)), enriched(case)
    left, right = found[:, :6].sum(), found[:, 6:].sum()
    assert left > 1.3 * right
    assert found.sum() == close(bare.sum(), rel=1e-5)
    assert found.max() > whole.max()  # at the end, where the substrate beside gives way
    np.testing.assert_allclose(found, found[::-1], rtol=0, atol=1e-4)


# ---------------------------------------------------------------- PL-1, PL-2


#: h/sqrt(A0), E1/E2, largest pressure and area of the contact relative to the bare substrate; cells in the thickness
#: and across the window of the enriched coating.
PLANAR = [
    (0.05, 0.5, 0.957, 1.099, 4, 33),
    (0.2, 0.5, 0.855, 1.261, 4, 25),
    (0.5, 0.5, 0.721, 1.434, 6, 25),
    (1.5, 0.5, 0.638, 1.568, 12, 21),
]


@pytest.mark.slow
@pytest.mark.parametrize(("thickness", "ratio", "peak", "area", "per_h", "cells"), PLANAR)
def test_thin_and_thick_coatings(thickness, ratio, peak, area, per_h, cells):
    """Case PL-2 within 2 %; cells of a thick enriched coating must be small beside the contact."""
    a0 = 1.0 / (thickness * np.sqrt(np.pi))
    half = 1.2 * a0 * np.sqrt(area)
    case = Case(ratio, a0=a0, half=half, cells=cells, per_h=per_h, ball=1000.0 * a0)
    assert case.oracle.max_pressure / case.p0 == close(peak, abs=1e-3)
    assert (case.oracle.radius / (a0 * H)) ** 2 == close(area, abs=1e-3)
    for route in ("layers", "coating"):
        pressure = case.pressure(route)
        assert pressure.max() == close(case.oracle.max_pressure / case.p0, rel=0.02 if route == "coating" else 0.004)


@pytest.mark.parametrize(
    ("ratio", "peak", "area"), [(0.5, 0.62996, 1.5874), pytest.param(2.0, 1.5874, 0.62996, marks=pytest.mark.slow)]
)
def test_a_thick_coating_is_all_there_is(ratio, peak, area):
    """Case PL-1, by layers: the contact is a fortieth of the thickness."""
    case = Case(ratio, a0=1 / 40, half=1.2 * np.sqrt(area) / 40, cells=21)
    data = case.run("layers").dataset
    assert float(data.pressure.max()) / case.p0 == close(peak, rel=0.01)


# ---------------------------------------------------------------- HZ-5


@pytest.mark.slow
def test_a_body_that_is_enriched_all_over_is_the_other_body():
    """Case HZ-5: a box of 0.8 E, so many contact radii deep and twice as wide."""
    case = Case(1.0, cells=13, half=1.3, per_h=4)
    found = []
    for depth in (1.5, 2.0, 3.0, 4.0):
        box = {
            "type": "cuboid",
            "center": [0.0, 0.0, 0.5 * depth * H],
            "edges": [2 * depth * H, 2 * depth * H, depth * H],
            "material": {"young-modulus": 0.8 * E, "poisson-ratio": NU},
        }
        scene = {"body1": {"young-modulus": E, "poisson-ratio": NU}, "inclusions": [box], "numerics": case.numerics}
        result = ec.run(case.tables | scene)
        found.append(float(result.dataset.pressure.max()) / case.p0 / 0.8618 - 1.0)
        assert result.summary["contact_radius"] / H == close(1.0772, abs=0.03)
    assert 0.03 > found[0] > found[1] > found[2] > found[3] > 0
    assert found[3] < 0.006


# ---------------------------------------------------------------- CO-5, CO-6


@pytest.mark.slow
@pytest.mark.parametrize(("route", "cells", "per_h"), [("layers", 13, 6), ("coating", 27, 8), ("substrate", 13, 6)])
def test_stress_on_both_sides_of_the_interface(route, cells, per_h):
    """Case CO-6: what pulls across the interface is continuous, what pulls along it jumps.

    A softer substrate in cells is read by its own law, so that less of what the cells miss is left in it than above.
    """
    places = np.array([0.0, 0.4, 0.8])
    sides = [
        {"name": name, "shape": "points", "points": [[x * H, 0.0, z * H] for x in places]}
        for name, z in (("above", 1 - 1e-6), ("below", 1 + 1e-6))
    ]
    half = {13: 1.3, 27: 1.35}[cells]
    case = Case(2.0, cells=cells, half=half, per_h=per_h, stress=sides)
    data, contact = case.run(route).dataset, case.oracle
    above, below = (data[f"{name}_stress"].isel(step=-1).values / case.p0 for name in ("above", "below"))
    across = [2, 3, 4]
    if route != "substrate":
        np.testing.assert_allclose(above[across], below[across], rtol=0, atol=1e-4)
    tolerance = 0.002 if route == "layers" else 0.03
    for found, side in ((above, "above"), (below, "below")):
        expected = sliding_stress(contact, places * H, 0.0, H, side=side) / case.p0
        np.testing.assert_allclose(found[[0, 2, 4]], expected[[0, 2, 4]], rtol=0, atol=tolerance)
        if route == "substrate" and side == "below":
            np.testing.assert_allclose(found[across], expected[across], rtol=0, atol=0.003)


#: Friction, von Mises maximum, depth (thicknesses), largest in the substrate.
SLIDING = [(0.25, 0.916, 0.38, 0.511), (0.5, 1.273, 0.01, 0.526)]


@pytest.mark.slow
@pytest.mark.parametrize("route", ["layers", *ROUTES])
@pytest.mark.parametrize(("friction", "peak", "depth", "below"), SLIDING)
def test_sliding(route, friction, peak, depth, below):
    """Case CO-5: under friction of 0.5 the von Mises stress is largest at the surface, of 0.25 in the coating.

    Stress next to the surface is a mean over each cell, and at the trailing edge slow: its maximum is 1.332, 1.288 p0
    at 13, 27 cells (layers, friction .5), which tends to 1.275 with the square of the cell.
    """
    depths = [0.01, 0.3125, 0.3751, 0.4375, 1 + 1e-6, 1.0625]
    cells = {"layers": 33, "coating": 13, "substrate": 27}[route] if friction == 0.5 else 13
    case = Case(
        2.0, cells=cells, half=1.3, per_h=4 if route == "substrate" else 8, numerics={"coupling": "partial"},
        friction={"type": "coulomb", "coefficient": friction}, steps=[{"normal-load": 0.0}, {"shift-x": H}],
        stress=[{"name": "cut", "shape": "plane", "normal": "y", "depths": [z * H for z in depths]}],
    )  # fmt: skip
    case.tables["steps"][0]["normal-load"] = case.load
    result = case.run(route)
    assert result.summary["slip_fraction"] == 1.0
    field = result.dataset.cut_von_mises.values[-1] / case.p0
    tolerance = 0.015 if route == "layers" else 0.03  # of p0, as for the interface
    assert field.max() == close(peak, abs=tolerance)
    assert depths[int(field.max(axis=1).argmax())] == close(depth, abs=0.08)
    assert field[4:].max() == close(below, abs=tolerance)
