"""Stored scenes of the error bars: a later call goes on, and the table counts what holds."""

import gzip
import json

import pytest

from close import close
from eigencontact.errors import NotConverged
from eigencontact_verification.benchmarks import error_bars
from eigencontact_verification.benchmarks.error_bars import BENCHMARK, collect, coverage


def solved_row(true):
    """A length of 1 m on cells of edges 1, 2 and 2.5, of first order with an error of 0.1 m; `true` is the judge's."""
    length = {"name": "length", "unit": "m", "meaning": "length", "role": "result", "headline": True}
    others = [[size, {"length": 1.0 + 0.1 * (size - 1.0)}] for size in (2.0, 2.5)]
    return {
        "edge": 0.05,
        "numbers": {"length": length},
        "warnings": [],
        "values": {"length": 1.0},
        "judge": {"length": true},
        "comparisons": [{"source": "cells", "values": {"length": 1.0}, "others": others, "seconds": 0.5}],
        "left out": {},
        "seconds": {"run": 1.0, "bars": 0.5, "judge": 3.0},
    }


def test_a_later_call_goes_on(monkeypatch, tmp_path):
    calls = []

    def solved(tables, factor):
        calls.append(factor)
        if len(calls) == 2:
            raise NotConverged("no convergence")
        return solved_row(0.9)

    monkeypatch.setattr(error_bars, "solved", solved)
    file = tmp_path / "elastic.jsonl.gz"
    assert len(collect("elastic", 2, file, 60.0)) == 2
    rows = collect("elastic", 3, file, 60.0)
    assert len(calls) == 3
    assert [row["scene"] for row in rows] == ["hertz", "hertz-ellipse", "dissimilar-spheres"]
    assert rows[1]["failed"] == "no convergence"
    with gzip.open(file, "rt") as lines:
        assert [json.loads(line)["seed"] for line in lines] == [0, 1, 2]
    assert collect("elastic", 9, file, -1.0) == rows  # no time, no further scene
    with gzip.open(file, "wt") as lines:  # a row that is taken out is solved again
        lines.writelines(json.dumps(row) + "\n" for row in rows if row["seed"] != 1)
    assert [row["seed"] for row in collect("elastic", 3, file, 60.0)] == [0, 1, 2]
    assert len(calls) == 4
    rows = collect("elastic", 3, file, 60.0)
    assert collect("elastic", 1, file, 60.0) == rows  # all that are stored


def test_the_table_counts_bars_that_hold():
    good, bad = solved_row(0.9), solved_row(0.8)
    found = coverage([good, bad])
    assert found["scenes"] == found["numbers"] == 2
    assert found["share"] == close(0.5)  # the bar is 1.25 times 0.1 m
    assert found["ratio"] == close(0.5 * (1.25 + 0.625))
    assert found["missed"] == "length 1"


def test_a_size_that_is_counted_has_the_least_error_of_its_row():
    """No run changes it: the bar is a part of the edge of a cell, half of it for a width, and the judge is off."""
    row = solved_row(1.0 + 0.01)
    row["numbers"]["length"]["scatters"] = True
    row["comparisons"][0]["others"] = [[size, {"length": 1.0}] for size in (2.0, 2.5)]
    assert coverage([row])["ratio"] == close(0.05 * (0.05 / 6.0) ** 0.5 / 0.01)
    assert coverage([row])["share"] == 0.0
    row["numbers"]["length"]["of_widths"] = True
    assert coverage([row])["ratio"] == close(0.025 / 0.01)
    assert coverage([row])["share"] == 1.0


@pytest.mark.parametrize("share", [1.0, 0.5])
def test_all_physics_are_counted_together(share):
    rows = [
        {"case": "elastic", "scenes": 2, "numbers": 30, "share": 1.0},
        {"case": "wear", "scenes": 1, "numbers": 10, "share": share, "failed": ["pin-on-disc (3): no convergence"]},
        {"case": "damage"},
    ]
    whole, refused = BENCHMARK.remarks(rows)
    assert whole == f"all physics: 3 scenes, 40 numbers, bars hold for {0.75 + 0.25 * share:.3f}"
    assert refused == "wear: not solved: pin-on-disc (3): no convergence"
