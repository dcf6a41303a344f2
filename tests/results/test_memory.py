"""A run in memory gives what the same run gives that is stored and opened again."""

import pickle
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from eigencontact.errors import ResultsError
from eigencontact.results.memory import MemoryStore
from eigencontact.results.store import ResultStore
from results import synthetic
from results.test_history import remembered


def with_history(info):
    return [replace(synthetic.step(info, n), history=remembered(n, info.grid)) for n in (1, 2, 3)]


def growing(info):
    """The box of body 1 grows by a layer of cells on both sides before the last step."""
    records = with_history(info)
    for record in records[:-1]:
        for name, item in record.history.items():
            if item.body == 1:
                coords = {**item.coords, "x": item.coords["x"][1:-1]}
                record.history[name] = replace(item, values=item.values[..., 1:-1], coords=coords)
    return records


def single(info):
    records = [synthetic.step(info, n, n * 0.3, ()) for n in (1, 2, 3)]
    for record in records:
        record.fields["pressure"] = record.fields["pressure"].astype(np.float32)
    return records


CASES = {
    "one step": lambda info: [synthetic.step(info)],
    "regions": lambda info: [
        synthetic.step(info, n, 0.2 * n, ("plane", "depth", "volume", "line", "points"), observed=True) for n in (1, 2)
    ],
    "missing": lambda info: [synthetic.step(info, n, reference=n > 1, observed=n == 1) for n in (1, 2, 3)],
    "single precision": single,
    "history": with_history,
    "growing": growing,
}


def stores(tmp_path, info, records):
    folder, memory = ResultStore.create(tmp_path, info), MemoryStore(info)
    for record in records:
        folder.write_step(record)
        memory.write_step(record)
    folder.finish()
    return folder, memory


@pytest.mark.parametrize(
    ("case", "every"),
    [
        *((case, False) for case in CASES),
        # Whether all histories are kept plays no part without any.
        *(pytest.param(case, True, marks=[pytest.mark.slow] * (case not in ("history", "growing"))) for case in CASES),
    ],
)
def test_both_ways_are_identical(tmp_path, case, every):
    info = replace(
        synthetic.info(nx=7, ny=5, steps=3),
        every_history=every,
        outlines={"": np.arange(8.0).reshape(2, 2, 2), "plane_0": np.zeros((0, 2, 2))},
    )
    folder, memory = stores(tmp_path, info, CASES[case](info))
    with folder.dataset() as stored:
        held = memory.dataset()
        stored.attrs.pop("created")
        held.attrs.pop("created")
        xr.testing.assert_identical(stored.load(), held)
        for name, variable in stored.variables.items():
            assert variable.dtype == held.variables[name].dtype, name
            assert {key: type(value) for key, value in variable.attrs.items()} == {
                key: type(value) for key, value in held.variables[name].attrs.items()
            }
        assert list(stored.data_vars) == list(held.data_vars)
        assert {key: type(value) for key, value in stored.attrs.items()} == {
            key: type(value) for key, value in held.attrs.items()
        }


def test_histories_of_numbers_are_the_same(tmp_path):
    info = synthetic.info(steps=3)
    records = CASES["missing"](info)
    folder, memory = stores(tmp_path, info, records)
    for stored, held in zip(folder.history(records[-1]), memory.history(records[-1]), strict=True):
        assert set(stored) == set(held)
        np.testing.assert_array_equal([stored[name] for name in held], list(held.values()))


@pytest.mark.slow
def test_a_stored_dataset_is_written_again_without_loss(tmp_path):
    info = synthetic.info(nx=7, ny=5, steps=3)
    memory = MemoryStore(info)
    for record in CASES["regions"](info):
        memory.write_step(record)
    held = memory.dataset()
    held.to_netcdf(tmp_path / "again.nc", engine="h5netcdf")
    with xr.open_dataset(tmp_path / "again.nc", engine="h5netcdf") as again:
        xr.testing.assert_identical(again.load(), held)


def test_steps_are_copies_that_can_be_sent_to_another_process():
    info = synthetic.info()
    record = synthetic.step(info)
    expected = record.fields["pressure"].copy()
    store = MemoryStore(info)
    store.write_step(record)
    record.fields["pressure"][:] = 0.0
    found = pickle.loads(pickle.dumps(store)).dataset()["pressure"][0]
    np.testing.assert_array_equal(found, expected)
    assert found.values.flags.writeable


def test_results_replaced_by_those_of_another_scene_are_not_taken_for_them(tmp_path):
    info, other = synthetic.info(), synthetic.info(scene_hash="b" * 64)
    mine, _ = stores(tmp_path, info, [synthetic.step(info)])
    again = ResultStore.create(tmp_path, other, overwrite=True)
    again.write_step(synthetic.step(other))
    again.finish()
    with pytest.raises(ResultsError, match=r"must hold the results of 'synthetic' \(got those of another scene\)"):
        mine.dataset()
