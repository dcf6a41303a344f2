"""Index of the thesis: complete, every name exists, every claim can be judged; verdicts, messages, the command."""

import json
from pathlib import Path

import pytest

from close import close
from eigencontact.errors import SceneError
from eigencontact.scene.loader import bundled_names
from eigencontact_verification.studies.catalogue import STUDIES
from eigencontact_verification.studies.formula import Context, evaluate
from eigencontact_verification.thesis.entries import DRAWN, Claim, Rule
from eigencontact_verification.thesis.judge import VERDICTS, verdict_of, wanted_rows
from eigencontact_verification.thesis.reading import index_of, thesis_index
from eigencontact_verification.thesis.rules import Row, error_of, number_of

ROOT = Path(__file__).parents[2]
#: Last figure and last table of each chapter of the text; its scan has no list of figures.
LAST = {1: (21, 0), 2: (49, 5), 3: (44, 3), 4: (61, 6)}
ENTRIES = thesis_index().entries()
RULES = [(one.number, claim.rule) for one in ENTRIES for claim in one.claim if claim.rule is not None]
OF_STUDIES = [pytest.param(rule, id=f"{number} {rule.read}") for number, rule in RULES if rule.study]
ABOUT = Claim(says="about two", value=2.0, tolerance=0.1, rule=Rule(formula="2"))
WRONG = Claim(
    says="wrong", value=2.0, tolerance=0.1, right=[4.0, 5.0], erratum="printed twice", rule=Rule(formula="4.5")
)
TREND = Claim(says="grows", rule=Rule(study="bone", read="depth [m]", take="rising", along="lost"), differs="by design")


@pytest.mark.parametrize("chapter", LAST)
def test_every_figure_and_table_has_one_entry(chapter):
    index, (figures, tables) = thesis_index(), LAST[chapter]
    for entries, last in ((index.figure, figures), (index.table, tables)):
        numbers = [one.number for one in entries if one.chapter == chapter]
        assert numbers == [f"{chapter}.{n}" for n in range(1, last + 1)]


def test_studies_scenes_and_tests_exist():
    assert {one.study for one in ENTRIES} - {""} <= set(STUDIES.names())
    assert {rule.study for _, rule in RULES} - {""} <= set(STUDIES.names())
    assert {one.scene for one in ENTRIES} - {""} <= set(bundled_names())
    assert {rule.scene for _, rule in RULES} - {""} <= set(bundled_names())
    assert [one.test for one in ENTRIES if one.test and not (ROOT / one.test).is_file()] == []


def test_every_study_after_the_thesis_has_a_figure_in_the_index():
    used = {one.study for one in ENTRIES} | {rule.study for _, rule in RULES}
    after = {
        name for name in STUDIES.names()
        if any(source["authors"] == "B. Fulleringer" for source in STUDIES.find(name).sources)
    }  # fmt: skip
    assert after <= used


@pytest.mark.parametrize("rule", OF_STUDIES)
def test_rules_read_numbers_and_rows_that_the_study_has(rule):
    study = STUDIES.find(rule.study)
    assert {rule.read, rule.per} - {""} <= set(study.readings)
    assert {*rule.at, *rule.over, rule.along} - {""} <= {one.name for one in study.parameters}
    one = rule.take in ("at", "ratio", "difference")
    for coarse in (True, False):
        row = dict.fromkeys((rule.read, rule.per), 1.0)
        rows = [Row(values, row) for values in wanted_rows(study, [rule], coarse=coarse)]
        number_of(rule, rows)  # refuses rows that are missing or too many
        assert len(rows) == (1 + bool(rule.over) if one else len(rows))


def test_errata_of_formulas_are_shown_by_their_formulas():
    shown = [(one.number, claim) for one in ENTRIES for claim in one.claim
             if claim.rule is not None and claim.rule.formula and not claim.rule.scene]  # fmt: skip
    assert len(shown) > 5
    for number, claim in shown:
        found = float(evaluate(claim.rule.formula, Context(claim.rule.constants)))
        assert verdict_of(claim, found)[0] == ("erratum" if claim.erratum else "agrees"), (number, claim.says, found)


@pytest.mark.parametrize(
    ("claim", "found", "verdict"),
    [
        (ABOUT, 2.19, "agrees"),
        (ABOUT, 2.21, "disagrees"),
        (WRONG, 4.5, "erratum"),
        (WRONG, 2.0, "agrees"),
        (WRONG, 3.0, "disagrees"),
        (TREND, True, "agrees"),
        (TREND, False, "differs"),
        (Claim(says="more", value=1.0, side="above", rule=Rule(formula="1")), 1.0, "disagrees"),
        (Claim(says="less", value=1.0, side="below", rule=Rule(formula="1")), 0.9, "agrees"),
    ],
)
def test_verdict_follows_from_the_number(claim, found, verdict):
    assert verdict in VERDICTS
    assert verdict_of(claim, found)[0] == verdict


ROWS = [Row({"r": r}, {"p": p, "q": 2.0}, {"p": 0.1, "q": 0.5}) for r, p in ((0.1, 1.0), (0.2, 4.0), (0.3, 3.0))]


@pytest.mark.parametrize(
    ("rule", "number"),
    [
        ({"at": {"r": 0.2}}, 4.0),
        ({"at": {"r": 0.2}, "per": "q"}, 2.0),
        ({"at": {"r": 0.2}, "over": {"r": 0.1}, "take": "ratio"}, 4.0),
        ({"at": {"r": 0.2}, "over": {"r": 0.3}, "take": "difference"}, 1.0),
        ({"take": "max"}, 4.0),
        ({"take": "min"}, 1.0),
        ({"take": "place-of-max", "along": "r"}, 0.2),
        ({"take": "spread", "at": {"r": [0.2, 0.3]}}, 2 / 7),
        ({"take": "rising", "along": "r"}, False),
        ({"take": "rising", "along": "r", "at": {"r": [0.1, 0.2]}}, True),
        ({"take": "falling", "along": "r", "at": {"r": [0.2, 0.3]}}, True),
    ],
)
def test_reductions(rule, number):
    found = number_of(Rule(study="bone", read="p", **rule), ROWS)[0]
    assert found is number if isinstance(number, bool) else found == close(number)


@pytest.mark.parametrize(
    ("rule", "error"),
    [
        ({"at": {"r": 0.2}}, 0.1),
        ({"at": {"r": 0.2}, "per": "q"}, 0.1 / 2 + 4 * (1 / 2 - 1 / 2.5)),
        ({"at": {"r": 0.2}, "over": {"r": 0.1}, "take": "ratio"}, 0.1 + 4 * (1 - 1 / 1.1)),
        ({"at": {"r": 0.2}, "over": {"r": 0.3}, "take": "difference"}, 0.2),
        ({"take": "max"}, 0.1),
        ({"take": "rising", "along": "r"}, None),
    ],
)
def test_errors_of_rules_add_those_of_their_rows(rule, error):
    found = error_of(Rule(study="bone", read="p", **rule), ROWS)
    assert found == (error if error is None else close(error))


def test_a_number_without_error_bar_leaves_the_rule_without():
    bare = [ROWS[0], Row(ROWS[1].values, ROWS[1].numbers, {"q": 0.5}), ROWS[2]]
    assert error_of(Rule(study="bone", read="p", at={"r": 0.2}), bare) is None
    assert error_of(Rule(study="bone", read="p", at={"r": 0.1}), bare) == close(0.1)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"kind": "drawing"}, r"3\.1 kind must be one of sketch.*got 'drawing'"),
        ({"study": "bone"}, r"3\.1 kind must be a result if a study computes it"),
        ({"kind": "curve"}, r"3\.1 lacks must say what keeps it from being computed"),
        ({"studdy": "bone"}, r"3\.1 must have the keys .*got 'studdy'\); did you mean 'study'"),
        ({"claim": [{"says": "more"}]}, r"claim.lacks must say what a claim without rule needs"),
        ({"claim": [{"says": "more", "rule": {"formula": "1"}}]}, r"claim.value must be given"),
        ({"claim": [{"says": "m", "rule": {"formula": "1", "take": "most"}}]}, r"rule.take must be one of at"),
        (
            {"claim": [{"says": "m", "value": 1.0, "right": [1, 2], "rule": {"formula": "1"}}]},
            r"claim.erratum must say",
        ),
    ],
)
def test_faulty_entries_say_what_is_wrong(change, message):
    entry = {"number": "3.1", "kind": DRAWN[0], "place": "3.1.1", "shows": "an ellipsoid"}
    with pytest.raises(SceneError, match=message):
        index_of({"figure": [{**entry, **change}]})


def test_command_judges_a_figure(command, tmp_path):
    shown = command("study", "thesis", "--figure", "3.19", "--output", tmp_path).out
    assert "2 claims: 1 agrees, 1 erratum" in shown
    assert json.loads((tmp_path / "thesis.json").read_text("utf-8"))["claims"][0]["verdict"] == "erratum"


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("thesis", "--figure", "3.200"), "--figure must be one of the thesis (got '3.200')"),
        (("thesis", "--chapter", "7"), "--chapter must be one of 1, 2, 3, 4 (got 7)"),
        (
            ("bone", "--figure", "3.20"),
            "--chapter, --figure and --pictures must be used with the study thesis (got 'bone')",
        ),
    ],
)
def test_command_refuses(command, tmp_path, words, message):
    outcome = command("study", *words, "--output", tmp_path)
    assert outcome.code == 2
    assert message in outcome.err


@pytest.mark.slow
def test_command_runs_the_study_of_a_figure(command, tmp_path):
    words = ("study", "thesis", "--figure", "4.7", "--quick", "--output", tmp_path)
    assert "2 claims: 2 agrees" in command(*words).out
