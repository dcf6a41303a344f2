"""The benchmark of fatigue criteria measures each of them, and its judge sees what depends on the axes."""

import pytest

from eigencontact_verification.benchmarks.benchmark import Task
from eigencontact_verification.benchmarks.fatigue import BENCHMARK, CRITERIA, measure


@pytest.mark.parametrize(("name", "bound"), [("crossland", 1e-12), ("smith-watson-topper", 1e-3)])
def test_a_value_hardly_depends_on_the_axes(name, bound):
    sample = measure(BENCHMARK.methods[name], Task(benchmark="fatigue", code=name, n=1, case=BENCHMARK.cases[0]))
    assert sample["status"] == "ok"
    assert sample["turned"] < bound
    assert sample["first_cpu_s"] > 0


def test_all_bundled_criteria_are_measured():
    from eigencontact.scene.installed import installed_plugins

    bundled = {entry.key for entry in installed_plugins().of_kind("fatigue-criterion") if entry.bundled}
    assert set(CRITERIA) == bundled
