"""The table of a history: which steps and columns it shows, of what, how wide it is."""

import numpy as np
import pytest

from eigencontact.results.course import course_table, driven_motions

STEPS = 41


def loop(**more):
    """Pressed, then a loop in forty steps: to 200 nm, to -200 nm, to 200 nm; forces and work of any size."""
    shift = 200e-9 * np.interp(np.arange(STEPS), [0, 8, 24, 40], [0, 1, -1, 1])
    rows = [
        {
            "step": n + 1, "time": 1.0 + n, "normal_load": 12.307, "shift_x": shift[n], "shift_y": 1e-16,
            "tangential_load_x": 3e7 * shift[n], "tangential_load_y": 1e-12, "twist": 0.0, "torsion_moment": 1e-20,
            "contact_radius": 2e-5, "slip_fraction": 0.01 * n, "dissipated_energy": 1e-9 * n,
        }
        for n in range(STEPS)
    ]  # fmt: skip
    for row in rows[1:]:
        row["time"] = 2.5
    rows[-1]["time"] = 3.0
    return [row | more for row in rows]


def cells(table):
    return [line.split() for line in table.splitlines()]


def test_a_long_loop_shows_its_first_and_last_step_and_its_turns():
    heading, units, *rows = cells(course_table(loop()))
    assert heading == ["step", "load", "shift", "x", "force", "x", "stick", "work"]
    assert units == ["N", "nm", "N", "%", "nJ"]
    assert {"1", "9", "25", "41"} <= {row[0] for row in rows}
    assert rows[-1] == ["41", "12.31", "200.0", "6.000", "60.0", "40.00"]
    assert next(row for row in rows if row[0] == "25")[2] == "-200.0"
    assert len(rows) <= 12


def test_of_many_turns_the_outer_ones_are_shown():
    turns = enumerate(3 * loop(), start=1)
    rows = [row | {"step": n, "time": float(n), "shift_x": (-1) ** n * 1e-7} for n, row in turns]
    lines = course_table(rows).splitlines()
    assert len(lines) == 2 + 12 + 1
    assert lines[8].strip() == "..."
    assert [line.split()[0] for line in lines[2:8]] == [*"123456"]
    assert lines[-1].split()[0] == str(3 * STEPS)


def test_columns_follow_what_is_there():
    sizes = {"approach": 1e-7, "contact_radius": 1e-6, "max_pressure": 1e9}
    pressed = [{"step": n, "time": n / 2, "normal_load": n - 1.0} | sizes for n in (1, 2)]
    assert cells(course_table(pressed))[0] == ["step", "load", "approach", "radius", "pressure"]
    stuck = [row | {"slip_fraction": 0.0, "dissipated_energy": 0.0} for row in pressed]
    assert cells(course_table(stuck))[0] == ["step", "load", "radius", "stick", "work"]
    assert cells(course_table(stuck))[2:] == [["1", "0.000", "1.000", "-", "0"], ["2", "1.000", "1.000", "100.0", "0"]]
    worn = loop(max_worn_depth=2e-9, cycles=30.0)
    assert cells(course_table(worn))[0][1] == "cycle"
    assert cells(course_table(worn))[0][-1] == "worn"
    assert cells(course_table(worn))[-1][-1] == "2.000"


@pytest.mark.parametrize("rows", [[], loop()[:1], [{"step": 1}, {"step": 2}]], ids=["none", "one", "no contact"])
def test_nothing_is_shown_of_runs_without_a_course(rows):
    assert course_table(rows) == ""


def test_all_motions_fit_on_a_narrow_terminal():
    turned = {"shift_y": -1.23456e-7, "tangential_load_y": 3.21, "twist": -1e-3, "torsion_moment": 4e-6}
    table = course_table(loop(max_worn_depth=1e-9, cycles=1e9, **turned))
    first, second = (part.splitlines() for part in table.split("\n\n"))
    assert [line.split()[0] for line in first[2:]] == [line.split()[0] for line in second[2:]]
    assert all(name in table for name in ("shift x", "force y", "torsion", "worn"))
    assert max(map(len, table.splitlines())) <= 80


def test_by_products_are_no_motions():
    columns = {name: np.array([row[name] for row in loop()]) for name in loop()[0]}
    assert driven_motions(columns) == ["x"]
    assert driven_motions(columns | {"tangential_load_x": 1e-9 * columns["tangential_load_x"]}) == []
