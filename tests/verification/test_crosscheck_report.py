"""Verdicts of cases, and the report that says them."""

import dataclasses
import json
import re
from functools import cache

import numpy as np
import pytest

from analytic_cases import analytic, gaps
from close import close
from eigencontact.results.ownership import is_ours
from eigencontact_verification.crosscheck.brief import brief, totals
from eigencontact_verification.crosscheck.judge import coverage, judge
from eigencontact_verification.crosscheck.report import Report, write_report
from eigencontact_verification.crosscheck.run import Solved, tasks_of
from eigencontact_verification.crosscheck.worker import Outcome, perform


@cache
def outcomes(fault, error):
    """What the cross-check finds of the made-up case; its name changes nothing."""
    return tuple(perform(task) for task in tasks_of(analytic("case", fault, error=error)))


def solved(case):
    found = outcomes(case.fault, case.parameters["error"])
    return Solved(case=case, outcomes=tuple(zip(tasks_of(case), found, strict=True)))


VERDICTS = [
    ("", 0.002, ["agrees"] * 5),
    ("", 0.02, ["inconclusive"] * 5),
    ("sign", 0.002, ["agrees", "agrees", "agrees", "agrees", "disagrees"]),
    ("factor", 0.002, ["disagrees", "agrees", "disagrees", "agrees", "agrees"]),
    ("factor", 0.02, ["disagrees", "inconclusive", "disagrees", "inconclusive", "inconclusive"]),
    ("raises", 0.002, ["failed"] * 5),
]


@pytest.mark.parametrize(("fault", "error", "words"), VERDICTS)
def test_each_component_gets_its_verdict(fault, error, words):
    found = judge(solved(analytic("case", fault, error=error)))
    expected = dict(zip(["u_x", "u_y", "u_z", "s_xx", "s_xz"], words, strict=True))
    if error == 0.02:  # zero by symmetry and free of error: the mesh says so
        expected["u_y"] = "agrees"
        expected["s_xz"] = {row.component: row.word for row in found.rows}["s_xz"]
    assert {row.component: row.word for row in found.rows} == expected
    worst = next(word for word in ("disagrees", "failed", "inconclusive", "agrees") if word in expected.values())
    assert found.word == worst


def test_numbers_of_a_verdict():
    found = judge(solved(analytic("case")))
    row = found.rows[0]
    assert row.order == close(2.0, abs=0.01)
    assert row.credible
    assert row.scale == close(1.0, abs=0.01)
    # index 1.25 times the fine mesh's error 0.002 and half of the bracket, 0.0005
    assert row.discretisation == close(0.0025, rel=0.02)
    assert row.truncation == close(0.0005, rel=0.02)
    assert row.uncertainty == close(row.discretisation + row.truncation, rel=1e-3)
    assert row.difference < 1e-6


def test_a_missing_judged_solution_is_no_agreement():
    whole = solved(analytic("case"))
    (task, _), *rest = whole.outcomes
    broken = (task, Outcome(status="failed", reason="ValueError: no such depth"))
    found = judge(dataclasses.replace(whole, outcomes=(broken, *rest)))
    assert {row.word for row in found.rows} == {"failed"}
    assert "no such depth" in found.rows[0].reason


def test_coverage_takes_the_worst_and_counts():
    rows = [row for fault in ("", "sign") for row in judge(solved(analytic(f"case{fault}", fault))).rows]
    table = {one.component: one for one in coverage(rows)}
    assert table["s_xz"].word == "disagrees"
    assert table["s_xz"].counts == {"disagrees": 1, "failed": 0, "inconclusive": 0, "agrees": 1}
    assert table["u_x"].word == "agrees"
    assert table["s_xz"].difference == close(1.0, abs=0.01)


@pytest.mark.parametrize(
    ("cases", "code"),
    [
        ([("plain", "", 0.002)], 0),
        ([("plain", "", 0.002), ("blunt", "", 0.02)], 0),
        ([("plain", "", 0.002), ("wrong", "sign", 0.002)], 1),
        ([("plain", "", 0.002), ("broken", "raises", 0.002)], 1),
    ],
)
def test_exit_codes(cases, code):
    judged = [judge(solved(analytic(name, fault, error=error))) for name, fault, error in cases]
    assert Report(cases=tuple(judged)).exit_code == code


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    cases = [analytic("plain"), analytic("blunt", error=0.02), analytic("wrong", "sign"), analytic("broken", "raises")]
    report = Report(
        cases=tuple(judge(solved(case)) for case in cases), gaps=gaps(), seconds=1.5, quick=True, notes=("a <note>",)
    )
    folder = tmp_path_factory.mktemp("report")
    return report, folder, write_report(report, folder)


def test_the_report_as_json(written):
    report, folder, files = written
    data = json.loads(files["json"].read_text(encoding="utf-8"), parse_constant=pytest.fail)
    assert data["counts"] == report.counts
    assert sum(data["counts"].values()) == 20
    assert data["exit_code"] == 1
    assert data["not_covered"] == [
        {"subject": "other", "what": "stress inside", "reason": "the exact field is singular there"}
    ]
    tasks = data["cases"][3]["tasks"]
    assert [task["status"] for task in tasks] == ["done", "done", "done", "failed", "done"]
    assert "mesh is tangled" in tasks[3]["reason"]
    assert all(task["seconds"] >= 0.0 for task in tasks)
    written_files = [*folder.glob("*.*"), *files["figures"].iterdir()]
    assert len(written_files) == 11
    assert all(map(is_ours, written_files))
    curves = json.loads((files["figures"] / "analytic-plain.json").read_text(encoding="utf-8"))
    np.testing.assert_allclose(curves["x axis"]["semi_analytical"], curves["x axis"]["finite_elements"], atol=1e-9)
    broken = json.loads((files["figures"] / "analytic-broken.json").read_text(encoding="utf-8"))
    assert broken["below"]["finite_elements"] is None


def test_the_report_in_words(written):
    _, folder, files = written
    text = files["markdown"].read_text(encoding="utf-8")
    for line in (
        "| analytic | displacement | u_x | ! failed |",
        "| analytic | stress | s_xz | ✗ disagrees |",
        "| other | stress inside | the exact field is singular there |",
        "### analytic/plain: agrees",
        "### analytic/wrong: disagrees",
    ):
        assert line in text
    for name in re.findall(r"!\[.*?\]\((.*?)\)", text):
        assert (folder / name).read_bytes().startswith(b"\x89PNG")
    widths = {}
    for block in text.split("\n\n"):
        rows = [line for line in block.splitlines() if line.startswith("|")]
        widths |= {row: len(re.findall(r"(?<!\\)\|", row)) == len(re.findall(r"(?<!\\)\|", rows[0])) for row in rows}
    assert all(widths.values())


def test_the_page_stands_alone(written):
    _, _, files = written
    text = files["html"].read_text(encoding="utf-8")
    assert not re.findall(r"(?:src|href)=[\"'](?!data:)", text)
    assert text.count("data:image/png;base64,") == 4
    assert text.count("<details>") == 1  # what agrees is folded
    assert text.count("<details open>") == 3
    assert "a &lt;note&gt;" in text
    assert text.count("<table") == text.count("</table>")
    assert 'class="disagrees">✗ disagrees</td>' in text


# --- the table of a README --------------------------------------------------------------------------------------------


def rows_of(text):
    """Cells of the Markdown table by kernel and component."""
    head, _, *rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in text.splitlines() if line[:1] == "|"]
    return {row[0]: dict(zip(head[1:], row[1:], strict=True)) for row in rows}


def test_one_row_a_kernel_one_column_a_component(written):
    report, *_ = written
    other = judge(solved(analytic("alone", subject="second")))
    narrow = dataclasses.replace(other, rows=tuple(row for row in other.rows if row.component != "s_xx"))
    table = rows_of(brief(dataclasses.replace(report, cases=(*report.cases, narrow))))
    assert list(table) == ["analytic", "second"]
    assert list(table["analytic"]) == ["u_x", "u_y", "u_z", "s_xx", "s_xz"]
    assert table["analytic"]["u_x"].startswith("! 2/4 · 2")
    assert table["analytic"]["s_xz"] == "✗ 2/4 · 0.5 %"
    assert table["second"]["u_x"] == "✓ 1/1 · 0.3 %"
    assert table["second"]["s_xx"] == ""


def test_the_sentence_before_the_table(written):
    report, *_ = written
    text = totals(report)
    part = 100 * report.counts["inconclusive"] / 20
    assert text.startswith("4 cases (quick), 20 verdicts: 1 disagrees, 5 failed, ")
    assert f"{part:.1f} % inconclusive; 1.5 s. 16 finite-element solves, together " in text
    assert "peak memory of the largest" in text
    assert ("More than 15 %" in text) == (part > 15)
    plain = dataclasses.replace(report, cases=report.cases[:1], quick=False, seconds=4000.0)
    assert totals(plain).startswith("1 case (full), 5 verdicts: 0 disagrees, 5 agrees; 0.0 % inconclusive; 67 min.")
    assert "More than" not in totals(plain)
    blunt = dataclasses.replace(report, cases=report.cases[1:2])
    assert "More than 15 % is inconclusive" in totals(blunt)


def test_what_is_not_covered_is_listed_and_where_it_was_measured(written):
    report, _, files = written
    text = brief(report)
    assert "- other: stress inside (the exact field is singular there)" in text
    assert re.search(r"Measured \d{4}-\d\d-\d\d on .*numpy .*scikit-fem ", text)
    data = json.loads(files["json"].read_text(encoding="utf-8"))
    assert data["inconclusive"] == close(report.inconclusive)
    assert data["longest_solve_seconds"] == max(seconds for seconds, _ in report.solves)
    assert totals(report) in files["markdown"].read_text(encoding="utf-8")
