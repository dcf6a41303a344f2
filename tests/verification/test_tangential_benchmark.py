"""The benchmark of tangential contact: its judge, against quadrature and closed form, and its sentences."""

import numpy as np
import pytest

from close import close
from eigencontact_verification.benchmarks import tangential
from eigencontact_verification.benchmarks.__main__ import main
from eigencontact_verification.benchmarks.benchmark import Task
from eigencontact_verification.benchmarks.process import perform
from eigencontact_verification.benchmarks.sliding import ShearConvolution, SlidingProblem, judge_sliding
from eigencontact_verification.benchmarks.tangential import growth, prepare_eigencontact


def point_force(x, y, nu):
    """Tangential displacement of unit shear forces along x and y, contact modulus 1 (Johnson, eq. 3.75 at z = 0)."""
    r = np.hypot(x, y)
    straight = [[1 / r + nu / (1 - nu) * x**2 / r**3, nu / (1 - nu) * x * y / r**3]]
    straight.append([straight[0][1], 1 / r + nu / (1 - nu) * y**2 / r**3])
    return np.array(straight) / np.pi


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.5])
def test_judge_moves_cells_as_quadrature_does(nu):
    problem = SlidingProblem(n=8, poisson_ratio=nu)
    shear = np.zeros((2, 8, 8))
    shear[:, 2, 5] = 0.7, -0.4
    found = ShearConvolution(problem)(shear)
    nodes, weights = np.polynomial.legendre.leggauss(40)
    axis, half = problem.hertz.axis, 0.5 * problem.hertz.cell
    area = half**2 * weights[:, None] * weights
    for row, column in [(2, 7), (0, 0), (5, 4), (7, 5)]:
        x = axis[column] - axis[5] - half * nodes[None, :]
        y = axis[row] - axis[2] - half * nodes[:, None]
        expected = np.einsum("ijyx,yx->ij", point_force(x, y, nu), area) @ [0.7, -0.4]
        np.testing.assert_allclose(found[:, row, column], expected, rtol=1e-10)


def test_closed_form_passes_the_judge_the_better_the_finer():
    found = []
    for n in (32, 64, 128):
        problem = SlidingProblem(n=n, poisson_ratio=0.0)
        shear = np.stack([problem.shear, np.zeros((n, n))])
        found.append(judge_sliding(problem, problem.hertz.pressure, shear))
        assert found[-1].shear_error == 0.0
    residuals = [one.residual for one in found]
    slope = np.polyfit(np.log([32, 64, 128]), np.log(residuals), 1)[0]
    assert -1.7 < slope < -0.7  # the pressure of the rim cells is off by the root of the cell
    assert residuals[-1] < 0.02
    assert found[-1].stick_radius == close(problem.stick_radius, abs=0.01)


@pytest.mark.parametrize(
    ("spoil", "least"),
    [
        (lambda q: 1.2 * q, 0.1),
        (lambda q: np.stack([q[0], q[1] + 0.02 * (q[0] != 0)]), 0.02),
        (lambda q: q + 1e-3 * np.random.default_rng(1).normal(size=q.shape) * (q[0] != 0), 1e-3),
    ],
)
def test_wrong_shear_is_seen(spoil, least):
    problem = SlidingProblem(n=32, poisson_ratio=0.3)
    answer = prepare_eigencontact(problem, 1).solve()
    assert judge_sliding(problem, answer.pressure, answer.shear).residual < 1e-6
    assert judge_sliding(problem, answer.pressure, spoil(answer.shear)).residual > least


@pytest.mark.parametrize(
    ("pressure", "shear", "words"),
    [
        (np.ones((3, 4)), np.ones((2, 4, 4)), "must be of shape"),
        (np.ones((4, 4)), np.full((2, 4, 4), np.nan), "must be finite"),
        (np.ones((4, 4)), np.ones((2, 4, 4)), "below its bound somewhere"),
    ],
)
def test_what_cannot_be_judged_is_refused(pressure, shear, words):
    with pytest.raises(ValueError, match=words):
        judge_sliding(SlidingProblem(n=4, poisson_ratio=0.3), pressure, shear)


def test_one_process_measures_ours(monkeypatch):
    monkeypatch.setattr(tangential, "CYCLE_SIZE", 32)
    monkeypatch.setattr(tangential, "CYCLE_STEPS", 4)
    task = Task(benchmark="tangential", code="eigencontact", n=32, warm=1, case="nu-0.5")
    sample = perform(task)
    assert sample["status"] == "ok"
    assert sample["residual"] < 1e-6
    assert sample["cycle_applications"] > sample["applications"] > 5
    row = tangential.BENCHMARK.summarise(task, [sample])
    assert row["again_per_application"] > 1
    assert row["stick_radius"] == close(0.5 ** (1 / 3), abs=0.05)


def test_growth_is_fitted_where_three_sizes_are_known():
    def row(n, code="ours", **changes):
        return {"case": "nu-0.3", "code": code, "n": n, "applications": n**0.5, "again_s": 1e-6 * n**2.5,
                "cycle_s": None, "cycle_applications": None, **changes}  # fmt: skip

    rows = [row(64), row(128, cycle_s=3.0, cycle_applications=900), row(256), row(64, "other"), row(128, "other")]
    assert growth(rows) == [
        "nu-0.3, ours: applications grow as N^0.50 from N = 64 to 256",
        "nu-0.3, ours: seconds grow as N^2.50 from N = 64 to 256",
        "nu-0.3, ours: a cycle of 40 load steps, |Q| up to 0.9 of friction, at N = 128 takes 3 s and 900 applications",
    ]


@pytest.mark.slow
def test_command_prints_a_table(capsys):
    arguments = ["tangential", "--sizes", "16", "--cases", "nu-0.3", "--repeats", "1", "--warm", "1"]
    assert main(arguments) == 0
    out = capsys.readouterr().out
    assert out.splitlines()[2].split("|")[1:4] == [" nu-0.3 ", "   16 ", " eigencontact "]
    assert "FrictionalContact, x with y coupled" in out
