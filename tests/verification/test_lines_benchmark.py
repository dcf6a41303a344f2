"""The benchmark of line contacts measures a run, and its judge knows Hertz's pressure."""

from eigencontact_verification.benchmarks.benchmark import Task
from eigencontact_verification.benchmarks.lines import BENCHMARK, measure


def test_a_hertz_line_is_measured_and_judged():
    code = BENCHMARK.methods["eigencontact"]
    sample = measure(code, Task(benchmark="lines", code="eigencontact", n=1, case="Hertz", warm=1))
    assert sample["status"] == "ok"
    assert 0 < sample["error"] < 1e-4
    assert sample["first_s"] > 0
    assert len(sample["again_s"]) == 1
