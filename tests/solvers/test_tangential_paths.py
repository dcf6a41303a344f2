"""Normal and tangential loads that vary together: Mindlin and Deresiewicz, and where the work goes.

Where both loads rise in one step, the ring that comes into contact meets all of the step at once: the shear then has an
error of the first power of the step. At constant or falling load a step of any size is exact.
"""

import numpy as np
import pytest

from close import close
from eigencontact_verification.oracles import cattaneo, mindlin_paths
from solvers.frictional import Sphere

#: (P, Q) over the load of a = 1.
EXACT = {
    "shear at constant load": [(1.0, 0.0), (1.0, 0.3)],
    "there and back": [(1.0, 0.0), (1.0, 0.4), (1.0, -0.1), (1.0, 0.2)],
    "both rise, slip": [(0.5, 0.0), (1.0, 0.45)],
    "load rises on a sheared contact": [(0.5, 0.0), (0.5, 0.2), (1.0, 0.2), (1.0, 0.35)],
    "load falls under constant shear": [(1.0, 0.0), (1.0, 0.2), (0.6, 0.2)],
    "load falls and shear rises": [(1.0, 0.0), (1.0, 0.2), (0.7, 0.3)],
}
STEPPED = {
    "both rise, no slip": [(0.3, 0.0), (1.0, 0.25)],
    "load falls after growth without slip": [(0.2, 0.0), (1.0, 0.2), (0.7, 0.2)],
    "both fall, slip backward": [(0.2, 0.0), (1.0, 0.2), (0.5, 0.0)],
}


def walk(path, parts, n=32):
    """Follow a path; the state of the oracle at its end."""
    s = Sphere(n, along="x", size=2.4, centre=(0.31 * 2.4 / n, 0.11 * 2.4 / n))
    exact = mindlin_paths.SphereOnPath(friction=0.5, stretch=1.0 / s.load, compliance=s.compliance)
    for load, shear in path:
        begin, end = np.array([exact.load, exact.tangential_load]), s.load * np.array([load, shear])
        for share in np.arange(1, parts + 1) / parts:
            now = begin + share * (end - begin)
            s.to(now[0] / s.load, tangential_load_x=now[1])
        exact = exact.to(*end)
    return s, exact


def errors(s, exact):
    """Of the shear in the mean square over the contact, over μ p0; of the shift, over that of sliding."""
    shear = exact.shear(s.radii)
    inside = s.radii < exact.radius
    unit = cattaneo.shift_of_sliding(0.5, s.load, 1.0, s.compliance)
    difference = (s.last.tangential.shear[0] - shear)[inside]
    return (
        np.sqrt(np.mean(difference**2)) / (0.5 * s.pressure),
        abs(s.last.tangential.rigid[0] - exact.shift) / unit,
    )


@pytest.mark.parametrize("path", EXACT.values(), ids=EXACT)
def test_large_steps_where_they_are_exact(path):
    s, exact = walk(path, 1)
    shear, shift = errors(s, exact)
    assert shear < 0.4 * s.grid.dx
    assert shift < 1e-3
    expected = exact.stick_radius / exact.radius
    assert abs(s.stick_ratio() - expected) < s.grid.dx / exact.radius


@pytest.mark.slow
@pytest.mark.parametrize("path", STEPPED.values(), ids=STEPPED)
def test_steps_converge_where_the_contact_grows_under_shear(path):
    parts = (4, 8, 16)
    found = [errors(*walk(path, count, 24)) for count in parts]
    shifts = [shift for _, shift in found]
    order = -np.polyfit(np.log(parts), np.log(shifts), 1)[0]
    assert 0.75 < order < 1.4
    assert shifts[-1] < 3e-3
    assert found[-1][0] < 0.04  # 0.4 of a cell


def test_no_slip_where_the_load_rises_faster():
    s, _ = walk([(0.3, 0.0), (1.0, 0.25)], 8, 24)
    slipped = (s.last.normal.pressure > 0) & ~s.last.tangential.stick
    assert s.radii[slipped].min() > 1 - s.grid.dx  # the outermost ring, which a step of finite size loads at once
    s, _ = walk([(0.3, 0.0), (1.0, 0.45)], 8, 24)
    assert s.last.tangential.stick.sum() < 0.8 * np.count_nonzero(s.last.normal.pressure)


# --- where the work goes -------------------------------------------------------------------------------------------

LOADING = [(load, 0.0) for load in (np.arange(1, 7) / 6) ** 3]
FRETTING = [*LOADING, *((1.0, turn) for turn in (0.4, 0.8, 1.2, 0.6, 0.0, -0.6, -1.0))]
UNLOADING = [*FRETTING, (0.9, -1.0), (0.75, -0.8), (0.6, -0.6)]


def dissipated(s):
    return float(s.sliding.dissipated.sum() * s.grid.cell_area)


def balance(s, path):
    """Work put in; elastic energy; work of the mean shear on the slip; that of the pressure on gaps that close.

    The last is what steps of finite size lose: the pressure of a cell that comes into contact within a step.
    """
    unit = cattaneo.shift_of_sliding(s.friction, s.load, 1.0, s.compliance)
    forces, places, work, rubbed, closed = np.zeros(4), np.zeros(4), 0.0, 0.0, 0.0
    shear, pressure, gap = np.zeros((2, *s.grid.shape)), np.zeros(s.grid.shape), s.separation
    for load, ratio in path:
        step = s.to(load, shift_x=ratio * unit, shift_y=0.2 * ratio * unit, twist=0.4 * ratio * unit)
        before = forces, places, shear, pressure, gap
        forces = np.array([*step.tangential.forces, load * s.load])
        places = np.array([*step.tangential.rigid, step.normal.approach])
        shear, pressure = step.tangential.shear, step.normal.pressure
        lifted = step.normal.displacement + s.contact.lift(shear)
        gap = s.separation + lifted - step.normal.approach
        work += 0.5 * (forces + before[0]) @ (places - before[1])
        rubbed -= 0.5 * float(np.sum((shear + before[2]) * step.tangential.slip)) * s.grid.cell_area
        closed -= 0.5 * float(np.sum((pressure + before[3]) * (gap - before[4]))) * s.grid.cell_area
    along = step.tangential.displacement + step.tangential_by_pressure
    stored = 0.5 * float(np.sum(pressure * lifted) + np.sum(shear * along)) * s.grid.cell_area
    return work, stored, rubbed, closed


@pytest.mark.parametrize(
    ("path", "coupling"),
    [
        (FRETTING, "full"),
        (UNLOADING, "partial"),
        pytest.param(FRETTING, "partial", marks=pytest.mark.slow),
        pytest.param(UNLOADING, "full", marks=pytest.mark.slow),
    ],
    ids=["fretting, full", "unloading, partial", "fretting, partial", "unloading, full"],
)
def test_work_is_stored_or_taken_by_friction_to_rounding(coupling, path):
    """With the mean of the tractions at the ends of each step the balance is an identity, whatever the step."""
    s = Sphere(24, coupling=coupling, friction=0.3, tolerance=1e-9)
    work, stored, rubbed, closed = balance(s, path)
    assert work == close(stored + rubbed + closed, rel=1e-7)
    assert min(stored, rubbed) > 0


@pytest.mark.parametrize("coupling", ["partial", pytest.param("full", marks=pytest.mark.slow)])
def test_work_is_stored_or_dissipated_to_one_per_cent_of_it(coupling):
    """The step's own account of friction, pressed in ten steps, sheared and sheared back in steps of a tenth."""
    s = Sphere(24, coupling=coupling, friction=0.3)
    turns = [*np.arange(1, 13) / 10, *(1.2 - np.arange(1, 25) / 10)]
    path = [*((load, 0.0) for load in (np.arange(1, 11) / 10) ** 3), *((1.0, turn) for turn in turns)]
    work, stored, *_ = balance(s, path)
    assert work == close(stored + dissipated(s), rel=0.01)
    assert dissipated(s) > 0.1 * stored


@pytest.mark.slow
def test_what_steps_of_finite_size_lose_falls_with_their_square():
    lost, parts = [], (4, 8, 16)
    for count in parts:
        s = Sphere(24, coupling="full", friction=0.3)
        work, stored, *_ = balance(s, [(load, 0.0) for load in (np.arange(1, count + 1) / count) ** 3])
        lost.append(abs(work - stored - dissipated(s)) / work)
    order = -np.polyfit(np.log(parts), np.log(lost), 1)[0]
    assert 1.7 < order < 2.3
    assert lost[-1] < 0.01
