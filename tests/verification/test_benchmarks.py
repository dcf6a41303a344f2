"""The benchmarks: the outside measure, the fresh processes, what is said of codes left out, the table."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import dblquad

from close import close
from eigencontact_verification.benchmarks import (
    cloud,
    eigenstrain,
    hertz,
    layers,
    plasticity,
    predictions,
    start,
    store,
    trade,
    wear,
)
from eigencontact_verification.benchmarks.__main__ import main, parser
from eigencontact_verification.benchmarks.benchmark import Benchmark, Task, Trial
from eigencontact_verification.benchmarks.codes import CODES, PEERS, find_code
from eigencontact_verification.benchmarks.measure import Convolution, HertzProblem, judge, love_influence
from eigencontact_verification.benchmarks.measurements import measure_all
from eigencontact_verification.benchmarks.process import perform, run_fresh
from eigencontact_verification.benchmarks.stress import axis_error, axis_stress, depths_of
from eigencontact_verification.reporting.memory import PeakMemory
from eigencontact_verification.reporting.table import replace_section

FAKE = """
import os, time
import numpy as np
from eigencontact_verification.benchmarks.codes import Code
from eigencontact_verification.benchmarks.measure import HertzProblem
from eigencontact_verification.benchmarks.stress import axis_stress

def solve(n, threads, precision):
    return HertzProblem(n=n).pressure, 7, 15

def hungry(n, threads, precision):
    np.ones(10_000_000).sum()
    return solve(n, threads, precision)

def crash(n, threads, precision):
    os._exit(3)

def fail(n, threads, precision):
    raise RuntimeError("no convergence")

def sleep(n, threads, precision):
    time.sleep(60)

def stress(n, depths, threads, precision):
    radial, axial = axis_stress(depths)
    values = np.stack([radial, radial, axial, 0 * axial, 0 * axial, 0 * axial])
    return lambda pressure: np.broadcast_to(values[..., None, None], (6, len(depths), n, n))

def code(name, function, modules=()):
    return Code(name=name, distribution="numpy", modules=modules, settings="closed form", solve=function, stress=stress)

GOOD, HUNGRY, CRASH, FAIL, SLEEP = (code(f.__name__, f) for f in (solve, hungry, crash, fail, sleep))
ABSENT = code("absent", solve, ("a_module_that_is_not_there",))
"""


@pytest.fixture
def fake(tmp_path, monkeypatch):
    """A module of pretended codes that child processes find too; its name."""
    name = "pretended_codes"
    (tmp_path / f"{name}.py").write_text(FAKE)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path), prepend=os.pathsep)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, name, raising=False)
    return name


def dense_influence(problem):
    """Displacement of every cell by unit pressure on every other, written without a transform."""
    y, x = (axis.ravel() for axis in np.meshgrid(problem.axis, problem.axis, indexing="ij"))
    return love_influence(x[:, None] - x[None, :], y[:, None] - y[None, :], 0.5 * problem.cell)


def solve_dense(problem):
    """Discrete solution by an active set and a direct solver: no gap but rounding."""
    influence, h = dense_influence(problem), problem.separation.ravel()
    active = problem.squared_radius.ravel() < 1.0
    for _ in range(50):
        m = int(active.sum())
        matrix = np.block(
            [
                [influence[np.ix_(active, active)], -np.ones((m, 1))],
                [np.full((1, m), problem.cell**2), np.zeros((1, 1))],
            ]
        )
        unknown = np.linalg.solve(matrix, np.append(-h[active], problem.load))
        p = np.zeros(h.size)
        p[active] = unknown[:-1]
        changed = (p > 0) | (influence @ p + h - unknown[-1] < 0) & ~active
        if (changed == active).all():
            return p.reshape(problem.n, problem.n)
        active = changed
    raise AssertionError("the active set does not settle")


@pytest.fixture(scope="module")
def discrete():
    problem = HertzProblem(n=16)
    return problem, solve_dense(problem)


# --- the outside measure -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(("x", "y"), [(1.7, 0.2), (-0.4, 2.5), (3.0, -3.0)])
def test_influence_agrees_with_quadrature_of_boussinesq(x, y):
    expected, _ = dblquad(lambda t, s: 1.0 / np.hypot(x - s, y - t) / np.pi, -1, 1, -1, 1, epsabs=1e-12, epsrel=1e-12)
    assert float(love_influence(np.array(x), np.array(y), 1.0)) == close(expected, rel=1e-10)


@pytest.mark.parametrize("n", [1, 2, 5, 8])
@pytest.mark.parametrize("workers", [1, 2])
def test_convolution_is_the_dense_sum(n, workers):
    problem = HertzProblem(n=n)
    field = np.random.default_rng(n).standard_normal((n, n))
    expected = (dense_influence(problem) @ field.ravel()).reshape(n, n)
    np.testing.assert_allclose(Convolution(problem)(field, workers), expected, rtol=0, atol=1e-13)


def test_gap_of_the_exact_pressure_is_that_of_the_grid():
    sizes = np.array([32, 64, 128, 256])
    gaps = [judge(HertzProblem(n=n), HertzProblem(n=n).pressure).gap for n in sizes]
    rate = -np.polyfit(np.log(sizes), np.log(gaps), 1)[0]
    assert abs(rate - 1.15) < 0.1
    assert gaps[-1] < 3.1e-4


def test_discrete_solution_has_no_gap(discrete):
    problem, pressure = discrete
    found = judge(problem, pressure)
    assert found.gap < 1e-13
    assert found.tension == 0.0
    assert abs(found.load_error) < 1e-13


def test_bump_in_one_cell_is_measured_exactly(discrete):
    problem, pressure = discrete
    bump, cell = 1e-5, (7, 8)
    bumped = pressure.copy()
    bumped[cell] += bump
    moved = bump * dense_influence(problem)[:, np.ravel_multi_index(cell, pressure.shape)].reshape(pressure.shape)
    loaded = pressure > 0
    approach = (Convolution(problem)(bumped) + problem.separation)[loaded].mean()
    expected = np.abs(moved - moved[loaded].mean())[loaded].max() / approach
    assert judge(problem, bumped).gap == close(expected, rel=1e-6)


def unload_the_middle(problem, p):
    p[problem.n // 2, problem.n // 2] = 0.0


def load_the_corner(problem, p):
    p[0, 0] = 1e-3


def pull_the_corner(problem, p):
    p[0, 0] = -0.1 * problem.peak


def press_less(problem, p):
    p *= 0.99


@pytest.mark.parametrize(
    ("change", "field", "least", "most"),
    [
        (unload_the_middle, "gap", 0.05, 0.5),  # penetration of an unloaded cell
        (load_the_corner, "gap", 1.0, 4.0),  # a loaded cell far from contact
        (pull_the_corner, "tension", 0.1 - 1e-12, 0.1 + 1e-12),
        (press_less, "gap", 1e-3, 1e-2),
    ],
)
def test_wrong_pressure_is_caught(discrete, change, field, least, most):
    problem, pressure = discrete
    wrong = pressure.copy()
    change(problem, wrong)
    assert least < getattr(judge(problem, wrong), field) < most


def test_lost_load_is_measured(discrete):
    problem, pressure = discrete
    assert judge(problem, 0.99 * pressure).load_error == close(-0.01, rel=1e-9)


@pytest.mark.parametrize(
    ("pressure", "words"),
    [
        (np.ones((4, 5)), r"pressure must be of shape \(4, 4\) \(got \(4, 5\)\)"),
        (np.full((4, 4), np.nan), "pressure must be finite"),
        (-np.ones((4, 4)), "pressure must be positive somewhere"),
    ],
)
def test_what_cannot_be_judged_is_refused(pressure, words):
    with pytest.raises(ValueError, match=words):
        judge(HertzProblem(n=4), pressure)


def test_the_judge_loads_nothing_of_the_judged():
    script = (
        "import sys, eigencontact_verification.benchmarks.measure; "
        "sys.exit(any(m.split('.')[0] in ('eigencontact', 'eigencontact_plugins') for m in sys.modules))"
    )
    assert subprocess.run([sys.executable, "-c", script], check=False).returncode == 0


def test_stresses_on_the_axis():
    z = np.linspace(0.001, 2.0, 2000)
    radial, axial = axis_stress(z) / HertzProblem(n=1).peak
    difference = radial - axial  # K. L. Johnson 1985, section 4.2: shear 0.31 p0 at 0.48 a for nu = 0.3
    assert difference.max() / 2 == close(0.310, abs=5e-4)
    assert z[difference.argmax()] == close(0.481, abs=2e-3)
    np.testing.assert_allclose(axis_stress(np.array([0.0]))[:, 0] / HertzProblem(n=1).peak, [-0.8, -1.0], rtol=1e-14)


@pytest.mark.parametrize("n", [4, 5])
@pytest.mark.parametrize("component", range(3))
def test_axis_error_sees_each_normal_stress(n, component):
    z = depths_of(3)
    stress = np.zeros((6, 3, n, n))
    stress[:3] = axis_stress(z)[[0, 0, 1]][..., None, None]
    assert axis_error(stress, z) < 1e-15
    stress[component, 1] += 1e-3 * HertzProblem(n=1).peak
    assert axis_error(stress, z) == close(1e-3, rel=1e-9)


# --- the peers, where they are installed --------------------------------------------------------------------------


@pytest.mark.parametrize("name", PEERS)
def test_peer_solves_the_same_problem(name):
    code = CODES[name]
    for module in code.modules:
        pytest.importorskip(module)
    pressure, _, _ = code.solve(128, 1, "double")
    found = judge(HertzProblem(n=128), pressure)
    assert found.gap <= 1e-6
    assert found.pressure_error == close(4.525e-3, abs=2e-6)  # that of the grid, whoever solves


def test_periodic_answer_of_tamaas_is_caught():
    tamaas = pytest.importorskip("tamaas")
    problem = HertzProblem(n=64)
    model = tamaas.ModelFactory.createModel(tamaas.model_type.basic_2d, [problem.side] * 2, [64, 64])
    model.E, model.nu = 1.0, 0.0
    tamaas.ModelFactory.registerNonPeriodic(model, "non-periodic")  # registered, but not chosen
    tamaas.PolonskyKeerRey(model, -problem.separation, 1e-6).solve(problem.load / problem.side**2)
    assert 5e-3 < judge(problem, np.array(model.traction)).gap < 2e-2


# --- processes ----------------------------------------------------------------------------------------------------


def task(fake, code, **changes):
    return Task(**{"benchmark": "hertz", "code": f"{fake}:{code}", "n": 32, "warm": 2, **changes})


def test_one_process_measures_one_code(fake):
    sample = run_fresh(task(fake, "GOOD"), 60.0)
    assert sample["status"] == "ok"
    assert (sample["iterations"], sample["convolutions"], len(sample["again_s"])) == (7, 15, 2)
    assert sample["gap"] == close(judge(HertzProblem(n=32), HertzProblem(n=32).pressure).gap, rel=1e-9)
    assert min(sample["first_s"], *sample["again_s"], sample["convolution_1_s"]) > 0


@pytest.mark.slow
@pytest.mark.skipif(PeakMemory().peak() is None, reason="the system does not tell the memory of a process")
def test_peak_memory_is_that_of_the_solve_alone(fake):
    ballast = np.ones(40_000_000)  # 320 MB in this process must not count
    few = run_fresh(task(fake, "GOOD"), 60.0)["peak_bytes"]
    many = run_fresh(task(fake, "HUNGRY"), 60.0)["peak_bytes"]
    assert ballast[0] == 1.0
    assert few < 10e6
    assert many - few == close(80e6, abs=2e6)  # the kernel counts pages in batches, thread by thread


@pytest.mark.parametrize(
    ("code", "limit", "status", "words"),
    [
        ("ABSENT", 60.0, "absent", "No module named 'a_module_that_is_not_there'"),
        ("FAIL", 60.0, "failed", "RuntimeError: no convergence"),
        ("CRASH", 60.0, "failed", "process ended with 3"),
        ("SLEEP", 2.0, "slow", "not done within 2 s"),
    ],
)
def test_what_went_wrong_is_told(fake, code, limit, status, words):
    sample = run_fresh(task(fake, code), limit)
    assert sample["status"] == status
    assert words in sample["reason"]


def test_interpreter_that_does_not_start(fake, tmp_path):
    sample = run_fresh(task(fake, "GOOD"), 60.0, str(tmp_path / "none"))
    assert sample["status"] == "absent"
    assert "interpreter does not start" in sample["reason"]


@pytest.mark.parametrize(
    ("budget", "always", "wanted"),
    [
        (60.0, 0, "set call floor call floor call floor"),
        (-1.0, 0, "set call floor"),
        (-1.0, 1, "set call call floor"),
        (60.0, 1, "set call call floor call floor"),
    ],
)
def test_calls_alternate_with_floors_until_the_time_is_over(budget, always, wanted):
    order = []

    def floor():
        order.append("floor")
        return [2.0, 4.0, 9.0]

    def call():
        order.append("call")
        return len(order)

    trial = Trial(
        setup=lambda: order.append("set"),
        call=call,
        floors=lambda: {"bare": floor},
        judge=lambda answer: {"answer": answer},
        always=always,
    )
    sample = trial.run(Task(benchmark="hertz", code="", n=1, warm=2, budget=budget))
    assert order == wanted.split()
    assert (sample["answer"], sample["bare_s"]) == (2, 4.0)
    assert len(sample["again_s"]) == order.count("call") - 1


def test_row_has_medians_of_times_largest_errors_and_last_counts():
    benchmark = Benchmark(name="", help="", measure=lambda *_: {}, columns=(), floors=("bare",), worst=("error",))
    samples = [
        {"first_s": first, "first_cpu_s": 2 * first, "again_s": again, "bare_s": 0.5, "peak_bytes": peak, **found}
        for first, again, peak, found in (
            (3.0, [1.0, 2.0], None, {"error": 0.3, "count": 7}),
            (1.0, [], 20, {"error": 0.1, "count": 8}),
            (8.0, [4.0], 10, {"error": 0.2, "count": 9}),
        )
    ]
    row = benchmark.summarise(Task(benchmark="", code="one", n=4), samples)
    assert (row["first_s"], row["first_min_s"], row["again_s"], row["again_min_s"]) == (3.0, 1.0, 2.0, 1.0)
    assert (row["first_per_bare"], row["again_per_bare"], row["cores"]) == (6.0, 5.5, 2.0)
    assert (row["peak_bytes"], row["error"], row["count"], row["processes"]) == (20, 0.3, 9, 3)


# --- all measurements -------------------------------------------------------------------------------------------------

SAMPLE = {"status": "ok", "first_s": 0.1, "first_cpu_s": 0.1, "again_s": [0.05], "peak_bytes": 10, "settings": "none"}
SAMPLE |= dict.fromkeys(("convolution_1_s", "convolution_threads_s"), 0.01)
SAMPLE |= dict.fromkeys(("gap", "tension", "load_error", "peak_error", "radius_error", "pressure_error"), 0.0)
SAMPLE |= {"iterations": None, "convolutions": None}


def measured(run, codes=("one", "two"), sizes=(64, 32), repeats=3, limit=60.0):
    template = Task(benchmark="hertz", code="", n=0)
    return measure_all(template, codes=codes, sizes=sizes, repeats=repeats, limit=limit, run=run)


def test_median_and_minimum_over_fresh_processes():
    times = {"one": iter([0.5, 0.1, 0.2, 3, 1, 2]), "two": iter([1.0] * 6)}
    out = measured(lambda task, _: {**SAMPLE, "first_s": next(times[task.code])})
    found = [(row["n"], row["code"], row["first_s"], row["first_min_s"], row["processes"]) for row in out.rows]
    assert found == [(32, "one", 0.2, 0.1, 3), (32, "two", 1.0, 1.0, 3), (64, "one", 2, 1, 3), (64, "two", 1.0, 1.0, 3)]
    assert out.rows[0]["first_per_convolution_1"] == close(20.0)
    assert out.rows[0]["again_per_convolution_1"] == close(5.0)
    assert out.notes == []


@pytest.mark.parametrize(
    ("status", "words"),
    [
        ("absent", "two: skipped, absent (because)"),
        ("slow", "two: skipped from N = 32 on, slower than the limit (because)"),
        ("failed", "two: skipped from N = 32 on, failed (because)"),
    ],
)
def test_code_left_out_is_said_once_and_not_tried_again(status, words):
    asked = []

    def run(task, limit):
        asked.append((task.code, task.n))
        return {"status": status, "reason": "because"} if task.code == "two" else SAMPLE

    out = measured(run)
    assert out.notes == [words]
    assert asked.count(("two", 32)) == 1
    assert ("two", 64) not in asked
    assert {row["code"] for row in out.rows} == {"one"}


def test_code_past_its_limit_runs_no_larger_size(monkeypatch):
    clock = iter(range(0, 10_000, 100))
    monkeypatch.setattr("time.perf_counter", lambda: next(clock))
    asked = []

    def run(task, limit):
        asked.append(task.n)
        return SAMPLE

    out = measured(run, codes=("one",))
    assert asked == [32]
    assert out.notes == ["one: larger than N = 32 skipped, slower than the limit of 60 s there"]


@pytest.mark.parametrize(("cost", "verdict"), [(1.4, "within 1.5"), (1.6, "beyond 1.5")])
def test_growth_of_the_cost_per_point(cost, verdict):
    rows = [
        {"code": "one", "n": n, "first_ns_per_point_log": value, "again_ns_per_point_log": None}
        for n, value in ((512, 10.0), (1024, 11.0), (2048, 10.0 * cost))
    ]
    assert hertz.scaling(rows) == [
        f"one, first call: cost per point and log2 N at 2048 is {cost:.2f} times that at 512 ({verdict})"
    ]
    assert hertz.scaling(rows[:2]) == []


# --- the command --------------------------------------------------------------------------------------------------


def test_command_from_end_to_end(fake, tmp_path, capsys):
    readme, raw = tmp_path / "README.md", tmp_path / "raw.json"
    readme.write_text("before\n<!-- benchmark:hertz -->\nold\n<!-- /benchmark:hertz -->\nafter\n")
    arguments = ["--sizes", "32", "64", "--repeats", "1", "--warm", "1", "--threads", "2"]
    files = ["--json", str(raw), "--markdown", str(readme), "--columns", "n", "code", "peak_error"]
    assert main(["hertz", "--codes", f"{fake}:GOOD", f"{fake}:ABSENT", *arguments, *files]) == 0
    content = json.loads(raw.read_text())
    assert [row["n"] for row in content["rows"]] == [32, 64]
    assert content["machine"]["cores"] >= 1
    absent = f"{fake}:ABSENT: skipped, absent (No module named 'a_module_that_is_not_there')"
    assert content["notes"] == [absent]
    printed, written = capsys.readouterr().out, readme.read_text()
    assert absent in printed
    assert absent in written
    assert "old" not in written
    assert written.startswith("before\n<!-- benchmark:hertz -->\n\n|")
    assert [cell.strip() for cell in written.splitlines()[3].split("|")[1:-1]] == ["N", "code", "p0 error"]
    assert written.endswith("\n\n<!-- /benchmark:hertz -->\nafter\n")
    assert str(tmp_path) not in json.dumps(content["machine"]) + printed


def test_stress_command(fake, capsys):
    assert main(["stress", "--codes", f"{fake}:GOOD", "--size", "32", "--depths", "4", "--repeats", "1"]) == 0
    row = capsys.readouterr().out.splitlines()[2].split("|")
    assert [cell.strip() for cell in row[1:4]] == ["32", "4", f"{fake}:GOOD"]
    assert perform(task(fake, "GOOD", benchmark="stress", depths=4))["axis_error"] < 1e-15


@pytest.mark.parametrize(
    "case", [pytest.param(case, marks=[pytest.mark.slow] * (case == "line, friction")) for case in layers.CASES]
)
def test_stress_in_layers_is_measured_beside_that_in_the_bare_body(case):
    asked = Task(benchmark="layers", code="eigencontact", n=12, depths=3, case=case, warm=1)
    sample = perform(asked)
    assert sample["status"] == "ok", sample
    row = layers.BENCHMARK.summarise(asked, [sample, sample])
    assert row["depths"] == (64 if case.startswith("line") else 3)
    assert min(row[name] for name in ("coated_step_s", "bare_step_s", "first", "again")) > 0


@pytest.mark.slow
def test_load_steps_of_a_body_that_yields_are_counted_and_timed():
    asked = Task(benchmark="plasticity", code="eigencontact", n=4, case="EP-2")
    sample = perform(asked)
    assert sample["status"] == "ok", sample
    row = plasticity.BENCHMARK.summarise(asked, [sample])
    assert 0 < row["loading"] <= 8
    assert row["unloading"] <= 1
    assert row["depth"] > row["print"] > 0
    assert min(row["step_s"], row["bare_s"]) > 0
    assert row["kept_bytes"] > 0
    if row["operator_bytes"] and row["peak_bytes"]:  # beside other tests the memory is there already
        assert min(row["by_kept"], row["by_built"]) > 0


def test_a_surface_that_wears_is_timed():
    asked = Task(benchmark="wear", code="eigencontact", n=24, case="gross sliding")
    sample = perform(asked)
    assert sample["status"] == "ok", sample
    row = wear.BENCHMARK.summarise(asked, [sample])
    assert row["volume"] == close(100 * np.pi * 20e-6**4 / (4 * 200e-6), rel=1e-9)
    assert row["peak"] == close(0.067 * 1.5 * 12.307 / (np.pi * 20e-6**2), rel=0.05)
    assert 0 < row["solve_s"] + row["move_s"] < row["run_s"]
    assert 0 < row["stored"] < 1


@pytest.mark.slow
def test_a_command_is_timed_in_turn_with_bare_imports():
    asked = Task(benchmark="start", code="eigencontact", n=1, case="help", warm=0)
    sample = perform(asked)
    assert sample["status"] == "ok", sample
    assert len(sample["again_s"]) == 3
    row = start.BENCHMARK.summarise(asked, [sample])
    assert row["again_per_imports"] == close(row["again_s"] / row["imports_s"], rel=1e-12)
    assert min(row["again_min_s"], row["imports_s"]) > 0.01  # an interpreter was started


def test_a_command_that_fails_is_no_measurement(monkeypatch):
    monkeypatch.setitem(start._COMMANDS, "help", ("no-such-command",))
    with pytest.raises(subprocess.CalledProcessError):
        start.measure(start.METHODS["eigencontact"], Task(benchmark="start", code="eigencontact", n=1, case="help"))


def test_the_largest_contact_of_a_memory_fits_in_it_and_the_next_does_not():
    import eigencontact as ec
    from eigencontact.core.memory import resident_bytes
    from eigencontact_verification.benchmarks.largest import largest

    memory = resident_bytes() + 3e8
    cells, plan = largest("hertz", ["stress=[]", "output.pictures=false"], memory)
    assert plan.cost.peak <= memory - resident_bytes() + 5e7  # what planning itself leaves in this process
    beyond = ec.plan(ec.load_scene("hertz", ["stress=[]", f"grid.cells-per-contact-radius={int(1.2 * cells)}"]))
    assert beyond.cost.peak > 0.9 * 3e8
    with pytest.raises(ValueError, match="memory must hold 8 cells"):
        largest("hertz", ["stress=[]"], resident_bytes())


def test_nothing_measured_is_a_failure(fake, capsys):
    assert main(["hertz", "--codes", f"{fake}:ABSENT", "--sizes", "32"]) == 1
    assert "skipped, absent" in capsys.readouterr().out


def test_defaults():
    options = parser().parse_args(["hertz"])
    assert (options.sizes, options.repeats, options.limit) == ([256, 512, 1024, 2048], 3, 120.0)
    assert not options.peers
    options = parser().parse_args(["stress", "--interpreter", "tamaas=venv/bin/python"])
    assert (options.size, options.depths, options.interpreter) == (256, 32, [("tamaas", "venv/bin/python")])


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["hertz", "--sizes", "0"], "must be at least 1 (got 0)"),
        (["hertz", "--limit", "nan"], "must be positive and finite (got nan)"),
        (["hertz", "--codes", "tammas"], "or package.module:OBJECT (got tammas)"),
        (["hertz", "--interpreter", "tamaas"], "must be CODE=PYTHON (got tamaas)"),
        (["stress", "--peers"], "unrecognized arguments: --peers"),
        ([], "required: benchmark"),
    ],
)
def test_wrong_arguments_are_refused(arguments, words, capsys):
    with pytest.raises(SystemExit) as stop:
        parser().parse_args(arguments)
    assert stop.value.code == 2
    assert words in capsys.readouterr().err


def test_unknown_code_names_the_known_ones():
    with pytest.raises(ValueError, match=r"code must be one of \['aspher', .*'tamaas'\] .*\(got 'tammas'\)"):
        find_code("tammas")


# --- the table of a README ----------------------------------------------------------------------------------------


def test_section_is_replaced_again_and_again(tmp_path):
    path = tmp_path / "README.md"
    path.write_text(
        "a\n<!-- benchmark:one -->\n<!-- /benchmark:one -->\nb\n<!-- benchmark:two -->\nkept\n<!-- /benchmark:two -->\n"
    )
    replace_section(path, "one", r"| \1 |")
    once = path.read_text()
    assert once == (
        "a\n<!-- benchmark:one -->\n\n| \\1 |\n\n<!-- /benchmark:one -->\nb\n"
        "<!-- benchmark:two -->\nkept\n<!-- /benchmark:two -->\n"
    )
    replace_section(path, "one", r"| \1 |")
    assert path.read_text() == once


@pytest.mark.parametrize(
    "text",
    [
        "nothing here\n",
        "<!-- benchmark:hertz -->\n",
        "<!-- /benchmark:hertz -->\n<!-- benchmark:hertz -->\n",
        "<!-- benchmark:hertz -->\n<!-- /benchmark:hertz -->\n" * 2,
        "`<!-- benchmark:hertz -->` in a sentence\n<!-- /benchmark:hertz -->\n",
    ],
)
def test_file_without_its_markers_is_left_alone(tmp_path, text):
    path = Path(tmp_path) / "README.md"
    path.write_text(text)
    with pytest.raises(ValueError, match=r"README.md must have the lines .* add both where the table belongs"):
        replace_section(path, "hertz", "new")
    assert path.read_text() == text


# --- eigenstrain -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("precision", ["double", "single"])
@pytest.mark.parametrize("case", list(eigenstrain.CASES))
def test_eigenstrain_is_measured_and_judged(case, precision):
    task = Task(benchmark="eigenstrain", code="eigencontact", n=8, case=case, warm=2, precision=precision)
    sample = perform(task)
    assert sample["status"] == "ok", sample
    assert len(sample["again_s"]) == len(sample["transforms_1_s"]) == 2
    low, high = (0.0, 1e-11) if precision == "double" else (1e-9, 1e-5)
    assert low < sample["error"] < high
    row = eigenstrain.BENCHMARK.summarise(task, [sample, sample])
    assert row["again_per_transforms_1"] == min(sample["again_s"]) / min(sample["transforms_1_s"])
    assert row["kernels"] == (58 if case == "stress" else 144)


def test_growth_of_eigenstrain_is_told():
    sizes = {"again_ns_per_point_log": (10.0, 20.0), "setup_ns_per_point_log": (3.0, 3.0)}
    rows = [
        {"case": "stress", "n": n, "peak_bytes_per_point": None, **{key: value[k] for key, value in sizes.items()}}
        for k, n in enumerate((16, 128))
    ]
    said = eigenstrain.scaling(rows)
    assert said[0] == "stress, again, per N³ log2 N: 2.00 times from 16 to 128 (beyond 1.5)"
    assert "1.00 times from 16 to 128 (within 1.5)" in said[1]
    assert len(said) == 2


# --- clouds ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("case", cloud.CASES)
def test_a_cloud_is_measured_and_judged(case):
    task = Task(benchmark="cloud", code="eigencontact", n=5, case=case)
    sample = cloud.measure(cloud.METHODS["eigencontact"], task, points=(12, 10, 6))
    assert sample["error"] < 1e-12
    row = cloud.BENCHMARK.summarise(task, [sample, sample])
    assert row["points"] == 720
    assert row["ns_per_pair"] > 0


# --- finite elements against the semi-analytical ways ------------------------------------------------------------


@pytest.mark.slow
def test_the_trade_is_measured_judged_and_drawn(tmp_path):
    rows = []
    for name, low, high in (
        (trade.POINTWISE, 0.0, 1e-12),
        ("exact", 0.0, 1e-12),
        ("image-pressure", 1e-4, 0.05),
        ("FE, linear, h = 1/2", 0.02, 0.3),
    ):
        task = Task(benchmark="trade", code=name, n=1)
        sample = trade.measure(trade.METHODS[name], task)
        assert low <= sample["error"] <= high
        rows.append(trade.BENCHMARK.summarise(task, [sample]))
    trade.draw(rows, tmp_path / "trade.png")
    assert (tmp_path / "trade.png").stat().st_size > 10_000


# --- storing, and predictions ------------------------------------------------------------------------------------


@pytest.mark.parametrize("layout", ["used", *store.LAYOUTS])
@pytest.mark.parametrize("case", store.BENCHMARK.cases[:2])
def test_every_layout_gives_back_what_was_stored(layout, case):
    task = Task(benchmark="store", code=layout, n=1, case=case)
    sample = store.measure(store.BENCHMARK.methods[layout], task)
    assert sample["same"]
    assert (sample["step_ms"] is None) == (layout != "used")


def test_steps_with_friction_differ_and_slip_outside_of_the_stick_circle():
    first, last = (store.fields_of(40, step, friction=True) for step in (1, 51))
    assert not np.array_equal(first["shear_x"], last["shear_x"])
    for fields in (first, last):
        sticks = fields["contact_zone"] == 2.0
        assert np.all(fields["slip_x"][sticks] == 0)
        assert np.all(fields["shear_x"][fields["slip_x"] > 0] == fields["pressure"][fields["slip_x"] > 0])


def test_predictions_are_set_against_what_a_scene_takes_block_by_block():
    bundled = predictions.BENCHMARK.cases
    assert "hertz" in bundled
    assert len(bundled) > 40
    sample = perform(Task(benchmark="predictions", code="eigencontact", n=1, case="rough-surface"))
    assert sample["status"] == "ok"
    assert sample["factor"] == sample["predicted_s"] / sample["took_s"]
    predicted, took = sample["blocks"]["normal-contact"]
    assert 0 < predicted <= sample["predicted_s"]
    assert 0 < took <= sample["took_s"]
    rows = [{"factor": 0.6}, {"factor": 1.9}, {"factor": 2.1}, {"factor": 0.4}]
    assert predictions.BENCHMARK.remarks(rows) == ["predicted within a factor of 2: 2 of 4 scenes"]
