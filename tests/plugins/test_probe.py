"""The probe: values, names, refusals."""

import numpy as np
import pytest

from close import close
from eigencontact.plugin import Grid, SceneError, StepView
from eigencontact_plugins.probe import Probe

GRID = Grid(nx=6, ny=5, dx=2e-6, dy=3e-6, center=(1e-6, -4e-6))


def step(grid=GRID, **fields):
    y, x = grid.axes()
    linear = 4.0 + 2e6 * x - 1e6 * y
    linear.flags.writeable = False
    return StepView(index=1, grid=grid, fields={"pressure": linear, **fields}, scalars={})


def test_a_linear_field_is_read_exactly_between_the_centres():
    points = ((1e-6, -4e-6), (2.3e-6, -6.1e-6), (-1.7e-6, 0.4e-6))
    found = Probe(points=points).observe(step())
    assert list(found) == ["pressure_1", "pressure_2", "pressure_3"]
    assert list(found.values()) == close([4 + 2e6 * x - 1e6 * y for x, y in points], rel=1e-8)


def test_cell_centres_are_exact_and_other_fields_can_be_read():
    gap = np.random.default_rng(1).random(GRID.shape)
    points = tuple((float(x), float(y)) for y in GRID.y for x in GRID.x)
    found = Probe(points=points, field="gap").observe(step(gap=gap))
    assert list(found) == [f"gap_{n}" for n in range(1, 31)]
    assert list(found.values()) == gap.ravel().tolist()


def test_the_outer_half_cell_is_constant():
    corner = (GRID.center[0] + 0.5 * GRID.size[0], GRID.center[1] - 0.5 * GRID.size[1])
    view = step()
    assert Probe(points=(corner,)).observe(view) == {"pressure_1": float(view.fields["pressure"][0, -1])}


@pytest.mark.parametrize(("nx", "ny"), [(1, 1), (1, 4), (3, 1)])
def test_degenerate_grids(nx, ny):
    grid = Grid(nx=nx, ny=ny, dx=1.0, dy=1.0)
    field = np.full(grid.shape, 7.0)
    assert Probe(points=((0.1, -0.2),)).observe(step(grid, pressure=field)) == {"pressure_1": 7.0}


def test_values_are_plain_floats():
    assert all(type(value) is float for value in Probe(points=((0.0, 0.0),)).observe(step()).values())


POINTS_RULE = "probe.points must be at least one point of two finite lengths (x, y)"


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"points": ()}, f"{POINTS_RULE} (got ())"),
        ({"points": ((1.0,),)}, f"{POINTS_RULE} (got ((1.0,),))"),
        ({"points": ((0.0, float("nan")),)}, f"{POINTS_RULE} (got ((0.0, nan),))"),
        ({"points": ((0.0, 0.0),), "field": ""}, "probe.field must be the name of a surface field (got '')"),
    ],
)
def test_wrong_tables_are_refused(table, message):
    with pytest.raises(SceneError) as caught:
        Probe(**table)
    assert str(caught.value) == message


def test_an_unknown_field_names_the_known_ones():
    with pytest.raises(SceneError) as caught:
        Probe(points=((0.0, 0.0),), field="presure").observe(step(gap=np.zeros(GRID.shape)))
    assert str(caught.value) == "probe.field must be one of 'gap', 'pressure' (got 'presure')"


def test_a_point_outside_names_itself_and_the_window():
    with pytest.raises(SceneError) as caught:
        Probe(points=((0.0, 0.0), (7.1e-6, 0.0))).observe(step())
    assert str(caught.value) == (
        "probe.points must be inside the window, 1.2e-05 m x 1.5e-05 m about (1e-06, -4e-06)"
        " (got (7.1e-06, 0.0) as point 2); move the point or enlarge the window"
    )
