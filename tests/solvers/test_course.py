"""The course of a solve: refusals and their wording, boxes that grow, starts, odd sizes, the ends of the range."""

import numpy as np
import pytest

from close import close
from eigencontact.core.grid import Grid
from eigencontact.errors import DomainTooSmall, NotConverged, SceneError
from eigencontact.solvers.control import Control
from eigencontact.solvers.levels import coarse_factors, prolong, restrict
from eigencontact.solvers.report import Certificate
from solvers.contacts import halfspace, paraboloid, rounded_punch, solve, square_grid

GRID = square_grid(16)
BALL = paraboloid(GRID)
EDGE = {"allow_contact_at_edge": True}


def spoiled(value):
    h = BALL.copy()
    h[3, 4:7] = value
    return h


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: solve(GRID, spoiled(np.nan), normal_load=1.0), r"separation must be finite at every cell \(got 3 NaN"),
        (lambda: solve(GRID, spoiled(np.inf), normal_load=1.0), r"separation must be finite"),
        (lambda: solve(GRID, BALL[1:], normal_load=1.0), r"contact\.separation must be of shape \(42, 42\) \(got \(41"),
        (
            lambda: solve(GRID, BALL, normal_load=1.0, start=np.ones((3, 3))),
            r"contact\.start must be of shape \(42, 42\) \(got \(3, 3\)\)",
        ),
        (Control, r"step must give normal_load \[N\] or approach \[m\] \(got neither\)"),
        (lambda: Control(normal_load=1.0, approach=1.0), r"step must give approach or normal_load \(got both\)"),
        (lambda: Control(normal_load=1.0, tilt_x=0.1, moment_x=0.1), r"step must give tilt_x or moment_x \(got both\)"),
        (lambda: Control(normal_load=-1.0), r"step\.normal_load must be zero or positive \[N\] \(got -1\.0\)"),
        (lambda: Control(approach=np.nan), r"step\.approach must be finite \(got nan\)"),
        (
            lambda: solve(GRID, BALL, normal_load=1.0, moment_x=1.4),
            r"step\.moment_x must be smaller than the load times half the window, 1\.312 N m \(got 1\.4\)",
        ),
        (
            lambda: solve(GRID, BALL, normal_load=1.0, moment_x=1.3),
            r"step\.moment_x must be smaller than the load times the distance .* cells, 1\.281 N m \(got 1\.3\)",
        ),
        (lambda: solve(GRID, BALL, normal_load=1.0, moment_y=-1.4), r"step\.moment_y must be smaller than the load"),
        (lambda: solve(GRID, BALL, normal_load=0.0, moment_x=0.1), r"step\.moment must be zero where the normal load"),
        (lambda: solve(GRID, BALL, approach=-0.1, moment_x=0.1), r"a moment must be carried by contact"),
    ],
)
def test_refusals_say_what_is_wrong(call, message):
    with pytest.raises(SceneError, match=message):
        call()


@pytest.mark.parametrize("share", [0.9, 1.0 - 1e-9])
def test_the_largest_moment_that_cells_bear_is_carried(share):
    """In the end all but by the outermost column alone, which leaves the tilt open."""
    far = float(GRID.x.max())
    found = solve(GRID, BALL, normal_load=1.0, moment_y=-share * far, options={"allow_contact_at_edge": True})
    assert found.report.certificate is not None
    assert found.report.certificate.holds
    loads = GRID.cell_area * found.pressure.sum(axis=0)
    assert float(loads.sum()) == close(1.0, rel=1e-9)
    assert float(loads @ GRID.x) == close(share * far, rel=1e-9)
    assert (loads[-1] > 0.99) == (share > 0.99)


@pytest.mark.parametrize("control", [{"normal_load": 1.0}, {"approach": 0.8}], ids=str)
def test_no_half_result_and_a_report_that_tells_how_far_it_got(control):
    with pytest.raises(
        NotConverged, match=r"did not converge in \d+ iterations on 42 x 42 cells: gap .*raise max-iter"
    ) as caught:
        solve(GRID, BALL, options={"max_iterations": 1}, **control)
    report = caught.value.report
    assert report.certificate.worst > 1e-4
    assert not report.certificate.holds
    assert report.history[-1][0] == 42 * 42
    assert report.convolutions > 0
    assert report.seconds > 0


def test_precision_beyond_single_is_refused_with_the_advice():
    with pytest.raises(NotConverged, match="or use double precision"):
        solve(GRID, BALL, normal_load=1.0, tolerance=1e-9, options={"precision": "single"})


def test_certificate_does_not_hold_for_nan():
    with np.errstate(all="ignore"):
        assert not Certificate(gap=np.nan, penetration=0.0, load=0.0, tolerance=1.0).holds


@pytest.mark.parametrize(
    ("load", "edges"), [({"normal_load": 5.0}, "along x and y"), ({"normal_load": 1.0, "moment_x": 0.3}, "along y;")]
)
def test_contact_at_the_edge_is_reported_unless_allowed(load, edges):
    h = rounded_punch(GRID) if "moment_x" in load else BALL
    with pytest.raises(DomainTooSmall, match=rf"reaches its edge {edges}.*enlarge grid size.*allow-contact-at-edge"):
        solve(GRID, h, **load)
    s = solve(GRID, h, options=EDGE, **load)
    assert s.normal_load == close(load["normal_load"], rel=1e-12)


def test_zero_load_just_touches():
    s = solve(GRID, BALL + 0.3, normal_load=0.0)
    assert np.all(s.pressure == 0)
    assert np.all(s.displacement == 0)
    assert s.gap.min() == 0
    assert s.approach == close(0.3 + BALL.min(), rel=1e-14)
    assert s.report.certificate.holds


@pytest.mark.parametrize("approach", [-0.2, 0.0, 0.299])
def test_an_approach_without_contact_is_no_load(approach):
    s = solve(GRID, BALL + 0.3, approach=approach)
    assert (s.normal_load, s.approach) == (0.0, approach)
    assert np.abs(s.gap - (BALL + 0.3 - approach)).max() < 1e-15


@pytest.mark.parametrize("approach", [1e-6, 0.002, 0.02, 0.4, 1.0])
def test_an_overlap_is_never_certified_as_free(approach):
    """Approach control starts from cells without pressure; every overlapping state must end loaded."""
    h = BALL - BALL.min()
    s = solve(GRID, h, approach=approach)
    assert s.normal_load > 0
    assert s.gap.min() > -1e-9 * s.displacement.max()
    assert s.displacement.max() >= 0.99 * approach


@pytest.mark.parametrize("load", [1e-25, 1e-15, 1e-9, 1e-6])
def test_tiny_loads_on_one_cell(load):
    """Less than the separation of neighbours needs: one cell carries all, by Love's formula."""
    grid = Grid(nx=41, ny=41, dx=0.05, dy=0.05)
    s = solve(grid, paraboloid(grid), normal_load=load, tolerance=1e-10)
    assert np.count_nonzero(s.pressure) == 1
    assert s.normal_load == close(load, rel=1e-12)
    love = 8 * np.arcsinh(1.0) * (load / grid.cell_area) * 0.025 / np.pi
    assert s.displacement.max() == close(love, rel=1e-10)
    assert s.approach == close(love, abs=1e-16)


# --- starts, boxes, coarse grids ---------------------------------------------------------------------------------


def single_cell(row, column):
    start = np.zeros(GRID.shape)
    start[row, column] = 1.0
    return start


@pytest.mark.parametrize("control", [{"normal_load": 1.0}, {"approach": 0.8}], ids=str)
@pytest.mark.parametrize(
    "start",
    [single_cell(20, 23), single_cell(0, 0), single_cell(41, 5), np.ones(GRID.shape), 1e-30 * single_cell(21, 21)],
    ids=["one cell", "corner", "edge", "everywhere", "faint"],
)
def test_the_answer_does_not_depend_on_the_start(control, start):
    """The box of a start too small, or in the wrong place, grows until the certificate holds on the whole window."""
    expected = solve(GRID, BALL, tolerance=1e-10, **control)
    kept = start.copy()
    s = solve(GRID, BALL, start=start, tolerance=1e-10, **control)
    assert np.array_equal(start, kept)
    assert np.abs(s.pressure - expected.pressure).max() < 1e-7 * expected.pressure.max()
    assert {cells for cells, _ in s.report.history} == {42 * 42}


def test_islands_far_apart_are_all_found():
    """Four summits, the lowest of them not resolved on the coarsest grids."""
    grid = Grid(nx=128, ny=96, dx=0.1, dy=0.1)
    y, x = grid.axes()
    summits = [(-4.0, -3.0, 0.0), (4.5, 3.1, 0.01), (-4.2, 3.3, 0.03), (5.0, -3.5, 0.028)]
    h = np.min([((x - a) ** 2 + (y - b) ** 2) / 2 + c for a, b, c in summits], axis=0)
    s = solve(grid, h, normal_load=0.2)
    for a, b, _ in summits:
        assert s.pressure[(np.abs(y - b) < 0.5) & (np.abs(x - a) < 0.5)].max() > 0
    assert s.report.certificate.holds


@pytest.mark.parametrize("shape", [(33, 33), (37, 61), (127, 64), (97, 35), (32, 200), (200, 17)], ids=str)
def test_coarse_to_fine_on_odd_and_prime_sizes(shape):
    """The same answer as from a start on the finest grid alone."""
    ny, nx = shape
    grid = Grid(ny=ny, nx=nx, dx=2.7 / nx, dy=2.7 / ny)
    h = paraboloid(grid)
    coarse_first = solve(grid, h, normal_load=1.0, tolerance=1e-10)
    directly = solve(grid, h, normal_load=1.0, tolerance=1e-10, start=np.ones(shape))
    assert len({cells for cells, _ in coarse_first.report.history}) > 1
    assert np.abs(coarse_first.pressure - directly.pressure).max() < 1e-7 * directly.pressure.max()


@pytest.mark.parametrize(
    ("grid", "factors"),
    [
        (Grid(nx=64, ny=64, dx=1, dy=1), (2, 2)),
        (Grid(nx=33, ny=31, dx=1, dy=1), (1, 2)),
        (Grid(nx=31, ny=31, dx=1, dy=1), None),
        (Grid(nx=64, ny=64, dx=1, dy=1000), (1, 2)),
        (Grid(nx=64, ny=64, dx=1000, dy=1), (2, 1)),
    ],
)
def test_only_fine_and_many_cells_are_merged(grid, factors):
    assert coarse_factors(grid) == factors


@pytest.mark.parametrize("shape", [(8, 10), (9, 11), (7, 8), (3, 5)], ids=str)
@pytest.mark.parametrize("factors", [(2, 2), (1, 2), (2, 1)], ids=str)
def test_merging_and_refining_cells(shape, factors):
    rng = np.random.default_rng(3)
    field = rng.random(shape)
    merged = restrict(field, factors)
    ny, nx = shape[0] // factors[0], shape[1] // factors[1]
    blocks = field[: ny * factors[0], : nx * factors[1]].reshape(ny, factors[0], nx, factors[1])
    assert np.abs(merged - blocks.mean((1, 3))).max() < 1e-15
    fine = prolong(np.ones((ny, nx)), factors, shape)
    assert fine.shape == shape
    assert np.all(fine >= 0)
    inner = fine[factors[0] : (ny - 1) * factors[0], factors[1] : (nx - 1) * factors[1]]
    assert np.abs(inner - 1).max(initial=0.0) < 1e-15
    assert np.all(prolong(np.zeros((ny, nx)), factors, shape) == 0)


@pytest.mark.parametrize("shape", [(1, 1), (1, 2), (2, 1), (1, 37), (31, 1), (2, 3)], ids=str)
def test_grids_of_a_few_cells(shape):
    grid = Grid(ny=shape[0], nx=shape[1], dx=0.1, dy=0.1)
    s = solve(grid, paraboloid(grid), normal_load=0.05, options=EDGE)
    assert s.normal_load == close(0.05, rel=1e-12)
    again = solve(grid, paraboloid(grid), approach=s.approach, options=EDGE)
    assert again.normal_load == close(0.05, rel=1e-6)


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("precision", ["double", "single"])
def test_threads_do_not_change_the_answer(threads, precision):
    grid = square_grid(48)
    options = {"threads": threads, "precision": precision}
    s = solve(grid, paraboloid(grid), normal_load=1.0, tolerance=1e-5, options=options)
    one = solve(grid, paraboloid(grid), normal_load=1.0, tolerance=1e-5, options={**options, "threads": 1})
    assert np.array_equal(s.pressure, one.pressure)


def test_progress_is_told_and_inputs_are_left_alone():
    told = []
    h = BALL.copy()
    h.setflags(write=False)
    from eigencontact.solvers.normal import NormalSolver

    s = NormalSolver(GRID, halfspace()).solve(h, Control(normal_load=1.0), progress=lambda *args: told.append(args))
    assert len(told) == s.report.iterations
    assert told[-1][0] == "42 x 42 cells"
    assert told[-1][1] <= told[-1][2]
    assert s.pressure.dtype == np.float64
