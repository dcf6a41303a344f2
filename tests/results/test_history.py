"""What bodies remember: stored beside the steps, joined, read back to the last bit, continued from or not."""

from dataclasses import replace

import numpy as np
import pytest

from eigencontact.errors import ResultsError
from eigencontact.results.reader import open_results
from eigencontact.results.records import HistoryRecord
from eigencontact.results.store import ResultStore
from results import synthetic

SHAPE = (2, 3, 4)
COORDS = {"z": np.arange(2) * 0.3 + 0.1, "y": np.arange(3) * 0.3, "x": np.arange(4) * 0.3}


GRID = synthetic.info().grid


def remembered(index, grid=GRID):
    rng = np.random.default_rng(index)
    cells = {"body": 1, "coords": COORDS}
    surface = {"body": 1, "coords": {"y": grid.y, "x": grid.x}}
    records = [
        HistoryRecord(name="strain_1", values=rng.normal(size=(6, *SHAPE)), unit="1", meaning="a strain", **cells),
        HistoryRecord(name="damage_1", values=rng.random((1, *SHAPE)), unit="1", meaning="a damage", **cells),
        HistoryRecord(name="pair_1", values=rng.random((2, *SHAPE)), unit="Pa", meaning="two stresses", **cells),
        HistoryRecord(name="lost_1", values=rng.random((1, *grid.shape)), unit="m", meaning="of a surface", **surface),
        HistoryRecord(name="strain_2", values=rng.random((6, 5)), body=2, coords={}, unit="1", meaning="of inclusions"),
    ]
    return {record.name: record for record in records}


def step(info, index):
    return replace(synthetic.step(info, index), history=remembered(index))


def filled(folder, steps, *, every=False, count=3):
    info = replace(synthetic.info(steps=count), every_history=every)
    store = ResultStore.create(folder, info)
    for index in range(1, steps + 1):
        store.write_step(step(info, index))
    return store


def assert_same(found, expected):
    assert found.keys() == expected.keys()
    for name, record in expected.items():
        assert np.array_equal(found[name].values, record.values)
        assert (found[name].body, found[name].unit, found[name].meaning) == (record.body, record.unit, record.meaning)
        assert list(found[name].coords) == list(record.coords)
        assert all(np.array_equal(found[name].coords[axis], values) for axis, values in record.coords.items())


def test_history_is_read_back_to_the_last_bit_from_steps_and_from_results(tmp_path):
    store = filled(tmp_path, 3)
    assert_same(store.load_step(3).history, remembered(3))
    store.finish()
    assert_same(store.load_step(3).history, remembered(3))
    assert store.load_step(2).history == {}


@pytest.mark.parametrize(("every", "kept"), [(False, [2, 3]), (True, [1, 2, 3])])
def test_an_unfinished_run_keeps_the_last_two_or_all(tmp_path, every, kept):
    store = filled(tmp_path, 3, every=every, count=4)
    assert sorted(path.name for path in (tmp_path / "steps").glob("*.history.step")) == [
        f"{index:04d}.history.step" for index in kept
    ]
    assert [bool(store.load_step(index).history) for index in (1, 2, 3)] == [index in kept for index in (1, 2, 3)]
    assert store.accepted() == [1, 2, 3]


@pytest.mark.parametrize(("every", "kept"), [(False, [3]), (True, [1, 2, 3])])
def test_results_open_with_names_units_and_coordinates(tmp_path, every, kept):
    filled(tmp_path, 3, every=every).finish()
    with open_results(tmp_path) as data:
        assert data["history_step"].values.tolist() == kept
        strain = data["strain_1"]
        assert strain.dims == ("history_step", "mandel", "cells_1_z", "cells_1_y", "cells_1_x")
        assert (strain.attrs["units"], strain.attrs["long_name"], strain.attrs["role"]) == ("1", "a strain", "history")
        assert data["mandel"].values.tolist() == ["xx", "yy", "zz", "sqrt2 yz", "sqrt2 xz", "sqrt2 xy"]
        assert np.array_equal(data["cells_1_z"], COORDS["z"])
        assert data["damage_1"].dims == ("history_step", "cells_1_z", "cells_1_y", "cells_1_x")
        assert data["lost_1"].dims == ("history_step", "y", "x")
        assert data["pair_1"].dims[1] == "pair_1_component"
        assert data["strain_2"].dims == ("history_step", "mandel", "inclusion_2")
        last = data["damage_1"].sel(history_step=3).sel(cells_1_x=0.6, method="nearest")
        assert np.array_equal(last.values, remembered(3)["damage_1"].values[0][..., 2])
    assert not (tmp_path / "steps").exists()


@pytest.mark.parametrize(
    ("harm", "usable", "message"),
    [
        (lambda folder: (folder / "0003.history.step").unlink(), [1, 2], "after step 3 is missing"),
        (
            lambda folder: (folder / "0003.history.step").write_text("no"),
            [1, 2],
            "0003.history.step must be a results",
        ),
        (lambda folder: (folder / "0003.step").unlink(), [1, 2], None),
        (lambda folder: (folder / "0002.history.step").write_text("no"), [1, 2, 3], None),
        (
            lambda folder: [path.unlink() for path in folder.glob("*.history.step")],
            [],
            "after step 1 is missing",
        ),
        (lambda folder: (folder / "0003.step").write_text("no"), [1, 2], "0003.step must be a results file"),
    ],
    ids=["missing", "damaged", "no step", "of one before", "none left", "step damaged"],
)
def test_a_run_continues_from_the_last_step_with_a_history(tmp_path, harm, usable, message):
    store = filled(tmp_path, 3, count=4)
    harm(tmp_path / "steps")
    assert store.accepted() == usable
    if message is not None:
        assert message in store.problems[-1]
    if usable:
        assert_same(store.load_step(usable[-1]).history, remembered(usable[-1]))


def test_a_history_of_another_scene_is_not_used(tmp_path):
    info = synthetic.info(scene_hash="b" * 64)
    ResultStore.create(tmp_path / "other", info).write_step(step(info, 2))
    store = filled(tmp_path / "run", 2)
    name = "steps/0002.history.step"
    (tmp_path / "run" / name).write_bytes((tmp_path / "other" / name).read_bytes())
    assert store.accepted() == [1]
    assert "of this scene" in store.problems[0]


def test_a_name_that_another_result_has_is_refused(tmp_path):
    info = synthetic.info()
    clash = replace(remembered(1)["damage_1"], name="pressure")
    store = ResultStore.create(tmp_path, info)
    with pytest.raises(ResultsError, match=r"name of a result must be unique.*'pressure'"):
        store.write_step(replace(synthetic.step(info), history={"pressure": clash}))
    assert not list((tmp_path / "steps").glob("*.step"))
