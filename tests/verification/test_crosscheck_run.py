"""The runner: tasks in processes, kept by content, limits and failures reported."""

import dataclasses
import functools
import json
import sys

import numpy as np
import pytest

from analytic_cases import analytic
from eigencontact_verification.crosscheck import store as stores
from eigencontact_verification.crosscheck.run import Limits, in_processes, run_cases, tasks_of
from eigencontact_verification.crosscheck.store import Store, content_hash
from eigencontact_verification.crosscheck.worker import Outcome, perform


def here(tasks):
    """Executor without processes."""
    for task in tasks:
        yield task, perform(task)


class Counter:
    def __init__(self):
        self.planned, self.performed = [], []

    def started(self, tasks):
        self.planned = list(tasks)

    def finished(self, task, outcome):
        self.performed.append((task, outcome))


def test_a_campaign_in_processes_and_its_resumption(tmp_path):
    cases, store = [analytic("plain"), analytic("sharp", error=0.001)], Store(tmp_path)
    executor = functools.partial(in_processes, workers=2)
    first = run_cases(cases, store, executor=executor)
    assert [solved.case.name for solved in first] == ["plain", "sharp"]
    for solved in first:
        assert [task.label for task, _ in solved.outcomes] == [
            "semi-analytical", *(f"elements, {mesh} mesh, fixed outer faces" for mesh in ("coarse", "medium", "fine")),
            "elements, medium mesh, free outer faces",
        ]  # fmt: skip
        for task, outcome in solved.outcomes:
            assert outcome.status == "done"
            assert not outcome.cached
            assert outcome.seconds > 0.0
            if sys.platform == "linux":
                assert 1e7 < outcome.memory < 1e9
            wanted = task.case.judged() if task.level is None else task.case.reference(task.level, task.outer)
            for name, values in wanted.items():
                np.testing.assert_array_equal(outcome.fields[name], values)

    counter = Counter()
    again = run_cases(cases, store, executor=here, progress=counter)
    assert [task.label for task in counter.planned] == ["semi-analytical"] * 2  # nothing else is computed again
    for before, after in zip(first, again, strict=True):
        for (_, one), (task, two) in zip(before.outcomes, after.outcomes, strict=True):
            assert two.cached == (task.level is not None)
            np.testing.assert_array_equal(one.fields["below"], two.fields["below"])


def test_an_interrupted_campaign_goes_on_where_it_was(tmp_path):
    case, store = analytic("plain"), Store(tmp_path)

    def interrupted(tasks):
        for k, task in enumerate(tasks):
            if k == 2:
                raise KeyboardInterrupt
            yield task, perform(task)

    with pytest.raises(KeyboardInterrupt):
        run_cases([case], store, executor=interrupted)
    counter = Counter()
    run_cases([case], store, executor=here, progress=counter)
    assert sorted(task.label for task in counter.planned) == [
        "elements, coarse mesh, fixed outer faces", "elements, medium mesh, free outer faces", "semi-analytical"
    ]  # fmt: skip


#: Faults, the limits of their tasks, and how they are reported; those of equal limits are run together.
FAILURES = [
    ({"raises": "mesh is tangled", "dies": "ended with 3", "shape": "one column a component"}, {}, "failed"),
    ({"sleeps": "not done within 4 s"}, {"seconds": 4.0}, "time"),
    pytest.param(
        {"eats": "more than 0.30 GB"}, {"memory": 3e8}, "memory",
        marks=[
            pytest.mark.slow,
            pytest.mark.skipif(sys.platform != "linux", reason="memory of a process is read from /proc"),
        ],
    ),
]  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize(("faults", "limits", "status"), FAILURES)
def test_a_task_that_fails_is_reported_and_the_others_are_done(tmp_path, faults, limits, status):
    executor = functools.partial(in_processes, workers=1, limits=Limits(**limits))
    kept = []
    for solved in run_cases([analytic(fault, fault) for fault in faults], Store(tmp_path), executor=executor):
        bad = [outcome for _, outcome in solved.outcomes if outcome.status != "done"]
        assert {outcome.status for outcome in bad} == {status}
        assert all(faults[solved.case.name] in outcome.reason for outcome in bad)
        assert all(outcome.fields is None for outcome in bad)
        assert any(outcome.status == "done" for _, outcome in solved.outcomes)
        kept += [task for task, outcome in solved.outcomes if task.level is not None and outcome.status == "done"]
    assert len(list(tmp_path.rglob("*.json"))) == len(kept)


def test_a_case_that_cannot_be_pickled_is_a_failed_task(tmp_path):
    case = dataclasses.replace(analytic("odd"), fault=lambda: None)
    (solved,) = run_cases([case], Store(tmp_path), executor=functools.partial(in_processes, workers=1))
    assert {outcome.status for _, outcome in solved.outcomes} == {"failed"}
    assert "cannot be sent" in solved.outcomes[0][1].reason


def test_equal_problems_are_solved_once(tmp_path):
    counter = Counter()
    solved = run_cases([analytic("one"), analytic("two")], Store(tmp_path), executor=here, progress=counter)
    assert len(counter.planned) == 2 + 4
    first, second = (dict(enumerate(outcome for _, outcome in one.outcomes)) for one in solved)
    assert all(first[k].fields["below"] is second[k].fields["below"] for k in (1, 2, 3, 4))


def test_two_cases_of_one_name_are_refused(tmp_path):
    with pytest.raises(ValueError, match="analytic/plain twice"):
        run_cases([analytic("plain"), analytic("plain")], Store(tmp_path), executor=here)


CHANGES = {
    "parameters": lambda case: dataclasses.replace(case, parameters={**case.parameters, "error": 0.1}),
    "subject": lambda case: dataclasses.replace(case, subject="another"),
    "points": lambda case: dataclasses.replace(
        case,
        profiles=(dataclasses.replace(case.profiles[0], points=case.profiles[0].points + 1e-9), *case.profiles[1:]),
    ),
    "ratio": lambda case: dataclasses.replace(case, ratio=1.5),
}


@pytest.mark.parametrize("change", CHANGES)
def test_the_hash_follows_what_decides_a_solution(change):
    case = analytic("plain")
    assert content_hash(CHANGES[change](case), 1, "fixed") != content_hash(case, 1, "fixed")


def test_the_hash_follows_level_boundary_and_code_but_not_the_name(monkeypatch):
    case = analytic("plain")
    hashes = {content_hash(case, level, outer) for level in (0, 1, 2) for outer in ("fixed", "free")}
    assert len(hashes) == 6
    renamed = dataclasses.replace(case, name="other", quick=False)
    assert content_hash(renamed, 1, "fixed") == content_hash(case, 1, "fixed")
    before = content_hash(case, 1, "fixed")
    monkeypatch.setattr(stores, "fem_digest", lambda: "another version")
    assert content_hash(case, 1, "fixed") != before


def test_the_digest_follows_the_finite_element_code(tmp_path, monkeypatch):
    file = tmp_path / "mesh.py"
    monkeypatch.setattr(stores.fem, "__path__", [str(tmp_path)])
    found = []
    for text in ("a = 1\n", "a = 2\n"):
        file.write_text(text)
        stores.fem_digest.cache_clear()
        found.append(stores.fem_digest())
    (tmp_path / "uncertainty.py").write_text("reads finished solutions only\n")
    stores.fem_digest.cache_clear()
    assert found[0] != found[1] == stores.fem_digest()
    stores.fem_digest.cache_clear()


def test_parameters_that_are_no_json_are_refused():
    case = dataclasses.replace(analytic("plain"), parameters={"shape": object()})
    with pytest.raises(ValueError, match="parameters must be JSON"):
        content_hash(case, 0, "fixed")


@pytest.mark.parametrize("text", ["", "{", "[]", '{"fields": {}}', '{"fields": {"a": "x"}, "facts": {}}'])
def test_a_damaged_file_counts_as_absent(tmp_path, text):
    store = Store(tmp_path)
    store.write("abcd", {"a": np.array([[1.0, 1e-300], [np.nan, 0.1]])}, {"seconds": 1.0, "memory": None})
    (file,) = tmp_path.rglob("*.json")
    fields, facts = store.read("abcd")
    np.testing.assert_array_equal(fields["a"], [[1.0, 1e-300], [np.nan, 0.1]])
    assert facts["seconds"] == 1.0
    assert json.loads(file.read_text())
    file.write_text(text)
    assert store.read("abcd") is None


def test_workers_below_one_are_refused():
    with pytest.raises(ValueError, match="workers must be at least 1"):
        list(in_processes(tasks_of(analytic("plain")), workers=0))


@pytest.mark.slow
def test_a_campaign_on_a_cluster(tmp_path):
    pytest.importorskip("distributed")
    from eigencontact.engines.cluster import Cluster
    from eigencontact_verification.crosscheck.cluster import on_cluster

    executor = functools.partial(on_cluster, engine=Cluster("local:1"))
    good, bad = run_cases([analytic("plain"), analytic("bad", "raises")], Store(tmp_path), executor=executor)
    assert all(isinstance(outcome, Outcome) and outcome.status == "done" for _, outcome in good.outcomes)
    assert [outcome.status for _, outcome in bad.outcomes] == ["done", "done", "done", "failed", "done"]
